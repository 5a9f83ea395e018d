//! A robot as the text of a robot file.

use grouser_slip::SensorSettings;
use grouser_slip::{Shaft, Wheel, WheelRole};
use grouser_terra::{GrouserRule, Grousers};

use super::{
    POSITION_SIGMA_KEY, REFERENCE_LATENCY_KEY, REFERENCE_PLACE_KEYS, RobotFile,
    default_contact_sigmas, filter_of,
};
use crate::actuator::{AXES as ACTUATOR_AXES, ActuatedFile, ActuatorFile};
use crate::body::{BodyFile, LinkFile, MassFile, MotorFile, WheelBody};
use crate::columns::{meaning, write_table};
use crate::fields::write_fields;
use crate::steering::SteeringKind;
use crate::toml_text::TomlText;
use crate::topics::{AXES, MOUNTING_KEYS, Topics};

/// The text of a robot file that reads back to the same robot; values that the reader assumes are left out.
///
/// ```
/// use grouser_files::{Document, robot};
///
/// let file = robot::read(std::path::Path::new("../../examples/kobuki/robot.toml"))?;
/// let again = robot::parse(&Document::from_text("again.toml", robot::to_toml(&file))?)?;
/// assert_eq!(again, file);
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[must_use]
pub fn to_toml(file: &RobotFile) -> String {
    let mut out = TomlText::new(&[]);
    out.text("name", file.robot.name());
    if let Some(gravity) = file.gravity {
        out.number("gravity_m_per_s2", gravity);
    }
    out.header("[estimator]");
    out.optional_text(
        "reference",
        file.reference.map(grouser_slip::Reference::name),
    );
    out.optional_text(
        "wheel_sensor",
        file.wheel_sensor.map(super::WheelSensor::name),
    );
    let corrections = &file.corrections;
    if corrections.pose_yaw_offset != 0.0 {
        out.degrees("pose_yaw_offset_deg", corrections.pose_yaw_offset);
    }
    for (key, place) in REFERENCE_PLACE_KEYS
        .into_iter()
        .zip(corrections.reference_place)
    {
        if place != 0.0 {
            out.number(key, place);
        }
    }
    for (key, factor) in [
        ("yaw_rate_scale", corrections.yaw_rate_scale),
        ("interval_factor", corrections.interval_factor),
    ] {
        if factor != 1.0 {
            out.number(key, factor);
        }
    }
    let [usual_depth, usual_angle] = default_contact_sigmas();
    let [depth, angle] = file.contact_sigmas;
    if depth != usual_depth {
        out.number("sinkage_sigma_m", depth);
    }
    if angle != usual_angle {
        out.degrees("entry_angle_sigma_deg", angle);
    }
    let usual = SensorSettings::default();
    write_fields(&mut out, &file.settings, &usual, SensorSettings::FIELDS);
    let sigma = file.settings.position_sigma;
    if file.topics.position_sigma.is_some() && sigma == usual.position_sigma {
        out.number(POSITION_SIGMA_KEY, sigma);
    }
    out.header("[filter]");
    let usual = filter_of(&file.settings, file.topics.position_sigma);
    write_fields(
        &mut out,
        &file.filter,
        &usual,
        grouser_slip::filter::FilterSettings::FIELDS,
    );
    let latency = file.filter.reference_latency;
    if file.is_reference_latency_stated && latency == usual.reference_latency {
        out.number(REFERENCE_LATENCY_KEY, latency);
    }
    if let Some(steering) = &file.steering {
        out.header("[steering]");
        let wheels = file.robot.wheels();
        let names: Vec<String> = steering
            .wheels
            .iter()
            .map(|index| wheels[*index].name.clone())
            .collect();
        match steering.kind {
            SteeringKind::Ackermann => out.text("kind", "ackermann"),
            SteeringKind::Articulated { joint_x } => {
                out.text("kind", "articulated");
                out.number("joint_x_m", joint_x);
            }
        }
        out.texts("wheels", &names);
    }
    write_topics(&mut out, &file.topics);
    for table in file.columns.iter().flat_map(|map| &map.tables) {
        write_table(&mut out, table);
    }
    if let Some(body) = &file.body {
        write_body(&mut out, body);
    }
    for (index, wheel) in file.robot.wheels().iter().enumerate() {
        write_wheel(&mut out, wheel);
        if let Some(torque) = file.torque_per_ampere.get(index).copied().flatten() {
            out.number("torque_per_ampere_nm", torque);
        }
        let joint = file.topics.joints.get(index);
        out.optional_text("joint", joint.and_then(|joint| joint.joint.as_deref()));
        if let Some(body) = file.body.as_ref().and_then(|body| body.wheels.get(index)) {
            write_wheel_body(&mut out, body);
        }
    }
    out.finish()
}

fn write_topics(out: &mut TomlText, topics: &Topics) {
    out.header("[topics]");
    for (key, topic) in [
        ("wheels", &topics.wheels),
        ("contact", &topics.contact),
        ("yaw_rate", &topics.yaw_rate),
        ("pose", &topics.pose),
        ("pose_frame", &topics.pose_frame),
        ("pose_child_frame", &topics.pose_child_frame),
        ("speed", &topics.speed),
        ("fix", &topics.fix),
        ("command", &topics.command),
    ] {
        out.optional_text(key, topic.as_deref());
    }
    for (key, place) in ["antenna_x_m", "antenna_y_m"]
        .into_iter()
        .zip(topics.antenna)
    {
        if place != 0.0 {
            out.number(key, place);
        }
    }
    if let Some(angles) = topics.imu_mounting {
        for (key, angle) in MOUNTING_KEYS.into_iter().zip(angles) {
            out.degrees(key, angle);
        }
    }
    for (key, axis) in [
        ("imu_up", topics.imu_up),
        ("imu_forward", topics.imu_forward),
    ]
    .into_iter()
    .filter(|_| topics.imu_mounting.is_none())
    {
        let named = AXES.iter().find(|(_, own)| axis == Some(*own));
        out.optional_text(key, named.map(|(name, _)| *name));
    }
    if let Some(odometry) = &topics.wheel_odometry {
        out.text("wheel_odometry", &odometry.topic);
        out.number("wheel_odometry_track_m", odometry.track);
    }
    out.optional_text("time", topics.recorder_clock.then_some("log"));
    out.flag("align_clock", topics.align_clock);
    out.texts("ignore", &topics.ignore);
    for topic in &topics.fields {
        for field in &topic.fields {
            out.header("[[topics.field]]");
            out.text("topic", &topic.topic);
            out.text("field", &field.column);
            out.line(&meaning(field, "\n"));
        }
    }
}

fn write_wheel(out: &mut TomlText, wheel: &Wheel) {
    out.header("[[wheel]]");
    out.text("name", &wheel.name);
    out.number("x_m", wheel.x);
    out.number("y_m", wheel.y);
    out.degrees("heading_deg", wheel.heading.rad());
    out.number("radius_m", wheel.radius);
    out.text(
        "drive",
        match wheel.role {
            WheelRole::Powered => "powered",
            WheelRole::Free => "free",
        },
    );
    let encoder = &wheel.encoder;
    if encoder.shaft == Shaft::Motor {
        out.text("encoder_on", "motor");
    }
    if encoder.shaft == Shaft::Motor || encoder.gear != 1.0 {
        out.number("gear", encoder.gear);
    }
    out.optional_number("ticks_per_turn", encoder.ticks_per_turn);
    out.whole("counter_bits", encoder.counter.bits());
    out.flag("reversed", encoder.reversed);
    out.nonzero("rate_step_rad_per_s", encoder.rate_step);
    out.optional_number("width_m", wheel.width);
    if let Some(Grousers {
        height,
        rule: GrouserRule::Lugs { count, thickness },
    }) = wheel.grousers
    {
        out.number("grouser_height_m", height);
        out.number("grouser_count", count);
        out.nonzero("grouser_thickness_m", thickness);
    }
    out.optional_number("load_n", wheel.load);
}

fn write_body(out: &mut TomlText, body: &BodyFile) {
    out.header("[chassis]");
    write_mass(out, &body.chassis);
    for link in &body.links {
        write_link(out, link);
    }
    for motor in &body.motors {
        write_motor(out, motor);
    }
    for actuator in &body.actuators {
        write_actuator(out, actuator);
    }
}

fn write_actuator(out: &mut TomlText, actuator: &ActuatorFile) {
    out.header("[[actuator]]");
    out.text("name", &actuator.name);
    let (min, max) = actuator.range;
    match &actuator.moves {
        ActuatedFile::Link(link) => {
            out.text("kind", "link");
            out.text("link", link);
            out.degrees("min_deg", min);
            out.degrees("max_deg", max);
            out.degrees("speed_deg_per_s", actuator.speed);
        }
        ActuatedFile::Mass { axis, mass } => {
            out.text("kind", "mass");
            out.text("along", ACTUATOR_AXES[*axis].0);
            out.number("mass_kg", *mass);
            out.number("min_m", min);
            out.number("max_m", max);
            out.number("speed_m_per_s", actuator.speed);
        }
    }
    out.number("power_w", actuator.power);
    out.number("efficiency", actuator.efficiency);
}

fn write_mass(out: &mut TomlText, mass: &MassFile) {
    out.number("mass_kg", mass.mass);
    write_point(out, ["cg_x_m", "cg_y_m", "cg_z_m"], mass.centre);
    let keys = ["inertia_xx_kg_m2", "inertia_yy_kg_m2", "inertia_zz_kg_m2"];
    write_point(out, keys, mass.inertia);
}

fn write_point(out: &mut TomlText, keys: [&str; 3], point: [f64; 3]) {
    for (key, value) in keys.into_iter().zip(point) {
        out.number(key, value);
    }
}

fn write_link(out: &mut TomlText, link: &LinkFile) {
    out.header("[[link]]");
    out.text("name", &link.name);
    out.optional_text("on", link.on.as_deref());
    write_point(out, ["pivot_x_m", "pivot_y_m", "pivot_z_m"], link.pivot);
    write_mass(out, &link.mass);
    out.optional_text("opposite", link.opposite.as_deref());
    out.nonzero("stiffness_nm_per_rad", link.stiffness);
    out.nonzero("damping_nms_per_rad", link.damping);
    out.nonzero("preload_nm", link.preload);
    out.degrees("range_deg", link.range);
}

fn write_motor(out: &mut TomlText, motor: &MotorFile) {
    out.header("[[motor]]");
    out.text("name", &motor.name);
    out.number("resistance_ohm", motor.resistance);
    out.number("constant_nm_per_a", motor.constant);
    out.number("voltage_v", motor.voltage);
    out.number("current_a", motor.current);
    out.nonzero("rotor_inertia_kg_m2", motor.rotor_inertia);
    out.number("gear_efficiency", motor.gear_efficiency);
}

fn write_wheel_body(out: &mut TomlText, wheel: &WheelBody) {
    out.optional_text("on", wheel.on.as_deref());
    out.optional_number("z_m", wheel.z);
    out.number("mass_kg", wheel.mass);
    out.optional_number("spin_inertia_kg_m2", wheel.spin_inertia);
    out.optional_text("motor", wheel.motor.as_deref());
    out.nonzero("bearing_nm", wheel.bearing);
    out.degrees("camber_deg", wheel.camber);
    out.degrees("caster_deg", wheel.caster);
    out.degrees("steer_range_deg", wheel.steer_range);
    out.degrees("steer_rate_deg_per_s", wheel.steer_rate);
}
