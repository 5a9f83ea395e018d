//! Robot files out of URDF: the shipped five-wheeled robot comes out as it is, a skid-steer as computed by hand, and
//! what is no robot is refused with its reason.

use std::fmt::Write as _;
use std::time::Duration;

use grouser_files::robot::RobotFile;
use grouser_files::urdf::{Converted, UrdfError, robot_file};
use grouser_files::{Document, robot};
use grouser_slip::WheelRole;

use crate::processor_time::ThreadTime;

const FIVE_WHEEL: &str = include_str!("../../../examples/robots/five-wheel.urdf");
const SHIPPED: &str = include_str!("../../../examples/robots/five-wheel.toml");

fn read(text: &str) -> RobotFile {
    robot::parse(&Document::from_text("robot.toml", text.to_owned()).unwrap()).unwrap()
}

fn made(urdf: &str) -> (Converted, RobotFile) {
    let made = robot_file(urdf).unwrap();
    let file = read(&made.text);
    (made, file)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

#[test]
fn the_five_wheeled_robot_comes_out_as_it_is_shipped() {
    let (converted, found) = made(FIVE_WHEEL);
    let shipped = read(SHIPPED);
    assert_eq!(converted.name, shipped.robot.name());
    assert_eq!(converted.wheels, 6);
    let (body, own) = (found.body.unwrap(), shipped.body.unwrap());
    let wheels = found.robot.wheels().iter().zip(&body.wheels);
    let expected = shipped.robot.wheels().iter().zip(&own.wheels);
    for ((wheel, mount), (truth, held)) in wheels.zip(expected) {
        let name = &truth.name;
        assert_eq!(wheel.name, *name);
        for (a, b) in [
            (wheel.x, truth.x),
            (wheel.y, truth.y),
            (wheel.heading.rad(), truth.heading.rad()),
            (wheel.radius, truth.radius),
            (wheel.width.unwrap(), truth.width.unwrap()),
            (mount.z.unwrap(), held.z.unwrap_or(truth.radius)),
            (mount.mass, held.mass),
            (mount.spin_inertia.unwrap(), held.spin_inertia.unwrap()),
            (mount.camber, held.camber),
        ] {
            assert!(near(a, b), "{name}: {a} and {b}");
        }
        assert_eq!(wheel.role, truth.role, "{name}");
        assert_eq!(mount.on, held.on, "{name}");
        // the URDF has knuckles in front only
        if name.starts_with("front") {
            assert!(
                near(mount.steer_range, held.steer_range)
                    && near(mount.steer_rate, held.steer_rate)
            );
        } else {
            assert!(mount.steer_range < 1e-12);
        }
    }
    let reversed: Vec<&str> = found
        .robot
        .wheels()
        .iter()
        .filter(|wheel| wheel.encoder.reversed)
        .map(|wheel| wheel.name.as_str())
        .collect();
    // turned half a turn about x, −y is to the left again: no wheel counts backwards
    assert!(reversed.is_empty(), "{reversed:?}");
    assert_eq!(
        found.topics.joints[0].joint.as_deref(),
        Some("front_left_wheel_joint")
    );
    let near3 = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| near(a[i], b[i]));
    for (mass, truth) in [(body.chassis, own.chassis)].into_iter().chain(
        body.links
            .iter()
            .zip(&own.links)
            .map(|(a, b)| (a.mass, b.mass)),
    ) {
        assert!(near(mass.mass, truth.mass), "{mass:?} {truth:?}");
        assert!(near3(mass.centre, truth.centre), "{mass:?} {truth:?}");
        assert!(near3(mass.inertia, truth.inertia), "{mass:?} {truth:?}");
    }
    for (link, truth) in body.links.iter().zip(&own.links) {
        assert_eq!(
            (&link.name, &link.on, &link.opposite),
            (&truth.name, &truth.on, &truth.opposite)
        );
        assert!(near3(link.pivot, truth.pivot));
        assert!(
            near(link.range, truth.range) || truth.name == "right_rocker",
            "{link:?}"
        );
        let of_one_side = truth.name == "right_rocker";
        assert!(near(link.damping, truth.damping) || of_one_side, "{link:?}");
    }
}

/// A skid-steer whose wheels are drawn as meshes and collide as cylinders, with a plate, a mast and a caster.
const CART: &str = r#"<robot name="field cart">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base_link"/>
  <link name="hull">
    <inertial><origin xyz="0.05 0 0.1"/><mass value="30"/>
      <inertia ixx="0.8" iyy="1.2" izz="1.6" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://cart/hull.dae"/></geometry></visual>
  </link>
  <joint name="hull_joint" type="fixed"><parent link="base_link"/><child link="hull"/></joint>
  <link name="mast"><inertial><origin xyz="0 0 0.5"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="mast_joint" type="fixed"><parent link="hull"/><child link="mast"/><origin xyz="-0.3 0 0.2"/></joint>
  WHEELS
  <link name="fork"/>
  <joint name="fork_swivel" type="continuous"><parent link="hull"/><child link="fork"/>
    <origin xyz="-0.5 0 0"/><axis xyz="0 0 1"/></joint>
  <link name="caster"><inertial><mass value="1"/></inertial><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="caster_joint" type="continuous"><parent link="fork"/><child link="caster"/>
    <origin xyz="-0.05 0 -0.1"/><axis xyz="0 1 0"/></joint>
</robot>"#;

fn cart() -> String {
    let mut wheels = String::new();
    for (name, x, y) in [
        ("front_left", 0.26, 0.28),
        ("front_right", 0.26, -0.28),
        ("rear_left", -0.26, 0.28),
        ("rear_right", -0.26, -0.28),
    ] {
        // the right ones are mounted turned round: their joint's axis points to the right
        let (yaw, axis) = if y > 0.0 {
            (0.0, "0 1 0")
        } else {
            (std::f64::consts::PI, "0 1 0")
        };
        let _ = write!(
            wheels,
            r#"<link name="{name}_wheel_link">
              <inertial><mass value="2.5"/><inertia ixx="0.02" iyy="0.04" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
              <visual><geometry><mesh filename="package://cart/wheel.dae"/></geometry></visual>
              <collision><origin rpy="1.5707963267948966 0 0" xyz="0 0 0"/>
                <geometry><cylinder length="0.11" radius="0.17"/></geometry></collision></link>
            <joint name="{name}_wheel" type="continuous"><parent link="hull"/><child link="{name}_wheel_link"/>
              <origin xyz="{x} {y} 0.03" rpy="0 0 {yaw:?}"/><axis xyz="{axis}"/></joint>
            <transmission name="{name}_trans"><type>transmission_interface/SimpleTransmission</type>
              <joint name="{name}_wheel"><hardwareInterface>v</hardwareInterface></joint></transmission>"#
        );
    }
    CART.replace("WHEELS", &wheels)
}

#[test]
fn a_skid_steer_is_what_one_computes_by_hand() {
    let (converted, file) = made(&cart());
    let names: Vec<&str> = file
        .robot
        .wheels()
        .iter()
        .map(|wheel| wheel.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["front_left", "front_right", "rear_left", "rear_right"]
    );
    let body = file.body.unwrap();
    for (index, (wheel, mount)) in file.robot.wheels().iter().zip(&body.wheels).enumerate() {
        let (x, y) = (
            [0.26, 0.26, -0.26, -0.26][index],
            [0.28, -0.28, 0.28, -0.28][index],
        );
        assert!(near(wheel.x, x) && near(wheel.y, y));
        assert!(near(wheel.heading.rad(), 0.0));
        assert_eq!(wheel.encoder.reversed, y < 0.0);
        assert!(near(wheel.radius, 0.17) && near(wheel.width.unwrap(), 0.11));
        assert!(near(mount.z.unwrap(), 0.17) && near(mount.mass, 2.5));
        assert!(near(mount.spin_inertia.unwrap(), 0.04));
        assert_eq!(wheel.role, WheelRole::Powered);
    }
    // the ground lies 0.14 m below the root: hull 30 kg at (0.05, 0, 0.24), mast 2 kg at (−0.3, 0, 0.84), the caster
    // that is left out 1 kg at (−0.55, 0, 0.04)
    let chassis = body.chassis;
    let x = (30.0 * 0.05 - 2.0 * 0.3 - 0.55) / 33.0;
    let z = (30.0 * 0.24 + 2.0 * 0.84 + 0.04) / 33.0;
    assert!(near(chassis.mass, 33.0) && near(chassis.centre[0], x) && near(chassis.centre[2], z));
    let steiner = |a: fn(f64, f64) -> f64| {
        30.0 * a(0.05 - x, 0.24 - z) + 2.0 * a(-0.3 - x, 0.84 - z) + a(-0.55 - x, 0.04 - z)
    };
    assert!(near(chassis.inertia[0], 0.9 + steiner(|_, z| z * z)));
    assert!(near(
        chassis.inertia[1],
        1.3 + steiner(|x, z| x * x + z * z)
    ));
    assert!(near(chassis.inertia[2], 1.61 + steiner(|x, _| x * x)));
    assert!(
        converted
            .notes
            .iter()
            .any(|note| note.contains("\"caster_joint\" swivels")),
        "{:?}",
        converted.notes
    );
}

#[test]
fn an_axle_that_is_turned_is_a_heading_and_a_lean() {
    // an omnidirectional robot's wheel at 120°: its axle points outwards
    let turned = |yaw: f64, roll: f64| {
        format!(
            r#"<robot name="r"><link name="base"/><link name="w"><collision><origin rpy="1.5707963267948966 0 0"/>
            <geometry><cylinder radius="0.1" length="0.04"/></geometry></collision></link>
            <joint name="w_joint" type="continuous"><parent link="base"/><child link="w"/>
            <origin xyz="0.1 0.2 0.1" rpy="{roll:?} 0 {yaw:?}"/><axis xyz="0 2 0"/></joint></robot>"#
        )
    };
    for (yaw_deg, heading, reversed) in [
        (0.0, 0.0, false),
        (60.0, 60.0, false),
        (-90.0, -90.0, false),
        (150.0, -30.0, true),
        (-120.0, 60.0, true),
    ] {
        let (_, file) = made(&turned(f64::to_radians(yaw_deg), 0.0));
        let wheel = &file.robot.wheels()[0];
        assert!(
            (wheel.heading.deg() - heading).abs() < 1e-5,
            "{yaw_deg}: {}",
            wheel.heading.deg()
        );
        assert_eq!(wheel.encoder.reversed, reversed, "{yaw_deg}");
    }
    // rolled by 5° about x: the axle to the left rises, the top leans to the right
    let text = robot_file(&turned(0.0, 5_f64.to_radians())).unwrap().text;
    assert!(text.contains("camber_deg = -5.0"), "{text}");
}

#[test]
fn names_and_numbers_cannot_break_the_file() {
    let nasty = cart()
        .replace("field cart", "a&quot;b&#10;[chassis]&#92;")
        .replace("front_left_wheel\"", "x&#10;&quot;y\"");
    let (converted, file) = made(&nasty);
    assert_eq!(converted.wheels, 4);
    // attribute values know no line breaks of their own; what stands for one is kept
    assert_eq!(file.robot.name(), "a\"b\n[chassis]\\");
}

fn refused(text: &str) -> UrdfError {
    let error = robot_file(text).unwrap_err();
    assert!(!error.to_string().is_empty());
    error
}

#[test]
fn what_is_no_robot_is_refused_with_its_reason() {
    assert!(matches!(refused(""), UrdfError::Xml { .. }));
    assert!(matches!(
        refused("<robot><link></robot>"),
        UrdfError::Xml { line: 1, .. }
    ));
    assert!(
        matches!(refused("<sdf version='1.6'/>"), UrdfError::NotARobot { found } if found == "sdf")
    );
    let macros = r#"<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
        <xacro:include filename="wheel.xacro"/></robot>"#;
    let error = refused(macros);
    assert!(
        matches!(&error, UrdfError::Xacro { line: 2, what } if what == "<xacro:include>"),
        "{error}"
    );
    assert!(
        error
            .hint()
            .unwrap()
            .contains("xacro robot.urdf.xacro > robot.urdf")
    );
    let value = cart().replace("radius=\"0.17\"", "radius=\"${wheel_radius}\"");
    assert!(
        matches!(refused(&value), UrdfError::Xacro { what, .. } if what == "`${wheel_radius}`")
    );
    // a document type could define entities without end
    let bomb =
        "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]><robot name=\"&b;\"/>";
    assert!(matches!(refused(bomb), UrdfError::Xml { .. }));
}

/// As SDF, exporters of CAD programs and C++ write "no limit".
#[test]
fn a_limit_beyond_all_turns_is_none() {
    let free = robot_file(&cart()).unwrap().text;
    let limited = |lower: &str, upper: &str, velocity: &str| {
        let limit = format!(
            "type=\"revolute\"><limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"{velocity}\"/>"
        );
        cart().replace("type=\"continuous\">", &limit)
    };
    for end in ["1e16", "inf", "1e9", "1.797e308"] {
        let text = robot_file(&limited(&format!("-{end}"), end, end))
            .unwrap()
            .text;
        assert_eq!(text, free, "{end}");
    }
    // a limit on one side ends the turning, and a few turns are one
    for (lower, upper) in [("-1e16", "10"), ("0", "inf"), ("-1e8", "1e8")] {
        let error = refused(&limited(lower, upper, "1"));
        assert!(matches!(error, UrdfError::NoWheels { .. }), "{error}");
    }
    let error = refused(&limited("nan", "1e16", "1"));
    assert!(matches!(error, UrdfError::OutOfRange { .. }), "{error}");
}

#[test]
fn a_substitution_that_was_not_made_is_not_taken_for_a_macro() {
    for value in [
        "$(optenv WHEEL_RADIUS 0.17)",
        "$(optenv RADIUS ${default})",
        "$(arg r)",
    ] {
        let error = refused(&cart().replace("radius=\"0.17\"", &format!("radius=\"{value}\"")));
        assert!(
            matches!(&error, UrdfError::Substitution { attribute: "radius", text, .. } if text == value),
            "{error}"
        );
        let hint = error.hint().unwrap();
        assert!(
            hint.contains("write the number") && !hint.contains("xacro"),
            "{hint}"
        );
    }
    // where no number is read nothing is to be filled in
    let mesh =
        "<visual><geometry><mesh filename=\"$(optenv MESH ${own})\"/></geometry></visual></link>";
    let seen = cart().replace("</link>", mesh);
    assert!(robot_file(&seen).is_ok());
}

#[test]
fn wheels_that_cannot_be_determined_are_refused_with_a_hint() {
    let error = refused(&cart().replace("continuous", "fixed"));
    assert!(
        matches!(&error, UrdfError::NoWheels { turning } if turning.is_empty()),
        "{error}"
    );
    assert!(error.hint().unwrap().contains("<cylinder>"));
    let mesh = cart().replace(
        "<geometry><cylinder length=\"0.11\" radius=\"0.17\"/></geometry>",
        "<geometry><mesh filename=\"w.stl\"/></geometry>",
    );
    let error = refused(&mesh);
    assert!(
        matches!(&error, UrdfError::MeshOnly { joint, link } if joint == "front_left_wheel" && link == "front_left_wheel_link"),
        "{error}"
    );
    assert!(error.hint().unwrap().contains("radius"));
    // a cylinder that stands across the axle is no wheel
    let upright = cart().replace("<origin rpy=\"1.5707963267948966 0 0\" xyz=\"0 0 0\"/>", "");
    assert!(matches!(refused(&upright), UrdfError::NoWheels { turning } if turning.len() == 6));
}

#[test]
fn trees_that_are_none_and_numbers_that_are_none() {
    let no_tree = |from: &str, to: &str| match refused(&cart().replace(from, to)) {
        UrdfError::NoTree { what } => what,
        other => panic!("{other}"),
    };
    assert!(
        no_tree("<child link=\"mast\"/>", "<child link=\"hull\"/>").contains("two joints carry")
    );
    assert!(
        no_tree(
            "<link name=\"fork\"/>",
            "<link name=\"fork\"/><link name=\"lost\"/>"
        )
        .contains("lost")
    );
    // base → hull turned round: the hull hangs on its own mast
    let looped = "<joint name=\"hull_joint\" type=\"fixed\"><parent link=\"mast\"/><child link=\"hull\"/></joint>";
    let straight = "<joint name=\"hull_joint\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"hull\"/></joint>";
    assert!(no_tree(straight, looped).contains("loop"));
    let error = refused(&cart().replace("<child link=\"mast\"/>", "<child link=\"mats\"/>"));
    assert!(
        matches!(&error, UrdfError::UnknownLink { meant: Some(meant), .. } if meant == "mast"),
        "{error}"
    );
    let twice = cart().replace("<link name=\"fork\"/>", "<link name=\"mast\"/>");
    assert!(matches!(
        refused(&twice),
        UrdfError::Twice {
            element: "link",
            ..
        }
    ));
    for (to, of) in [("0.1 0.2", 3), ("a b c", 3), ("1 2 3 4", 3)] {
        let error = refused(&cart().replace("xyz=\"-0.3 0 0.2\"", &format!("xyz=\"{to}\"")));
        assert!(
            matches!(&error, UrdfError::Number { attribute: "xyz", count, .. } if *count == of),
            "{error}"
        );
    }
    for (from, to) in [
        ("radius=\"0.17\"", "radius=\"-0.17\""),
        ("radius=\"0.17\"", "radius=\"nan\""),
        ("radius=\"0.17\"", "radius=\"0\""),
        ("mass value=\"30\"", "mass value=\"inf\""),
        ("ixx=\"0.8\"", "ixx=\"-1\""),
        ("xyz=\"-0.3 0 0.2\"", "xyz=\"1e9 0 0\""),
    ] {
        let error = refused(&cart().replace(from, to));
        assert!(
            matches!(&error, UrdfError::OutOfRange { range, .. } if !range.unit.is_empty()),
            "{to}: {error}"
        );
    }
    for from in [
        " value=\"30\"",
        "<child link=\"mast\"/>",
        " link=\"hull\"",
        " type=\"fixed\"",
    ] {
        assert!(
            matches!(
                refused(&cart().replacen(from, "", 1)),
                UrdfError::Missing { .. }
            ),
            "{from}"
        );
    }
}

/// A cart of two wheels, each a cylinder about y with `bars` as further shapes of its link.
fn lugged(bars: &str) -> String {
    let wheel = |name: &str, y: f64| {
        format!(
            "<link name=\"{name}\"><collision><origin rpy=\"1.5707963267948966 0 0\"/><geometry><cylinder \
             radius=\"0.1\" length=\"0.08\"/></geometry></collision>{bars}</link>\
             <joint name=\"{name}_wheel_joint\" type=\"continuous\"><origin xyz=\"0 {y} 0.1\"/>\
             <parent link=\"base\"/><child link=\"{name}\"/><axis xyz=\"0 1 0\"/></joint>"
        )
    };
    format!(
        "<robot name=\"cart\"><link name=\"base\"/>{}{}</robot>",
        wheel("left", 0.2),
        wheel("right", -0.2)
    )
}

/// Boxes of 8 mm along the rim, 6 mm of them above it, at these angles about the axle (y), as `kind` of shape.
fn bars(angles: impl IntoIterator<Item = f64>, kind: &str) -> String {
    angles.into_iter().fold(String::new(), |mut out, angle| {
        // the box reaches from 0.096 to 0.106 m; turned about y by the angle, its x edge points outwards
        let (sin, cos) = angle.sin_cos();
        let _ = write!(
            out,
            "<{kind}><origin xyz=\"{} 0 {}\" rpy=\"0 {angle} 0\"/><geometry><box size=\"0.01 0.07 \
             0.008\"/></geometry></{kind}>",
            0.101 * cos,
            -0.101 * sin
        );
        out
    })
}

#[test]
fn boxes_around_a_rim_are_its_lugs() {
    let even = |count: u32| {
        (0..count).map(move |i| f64::from(i) * std::f64::consts::TAU / f64::from(count))
    };
    for kind in ["collision", "visual"] {
        let (converted, file) = made(&lugged(&bars(even(20), kind)));
        let truth = grouser_terra::Grousers {
            height: 0.006,
            rule: grouser_terra::GrouserRule::Lugs {
                count: 20.0,
                thickness: 0.008,
            },
        };
        for wheel in file.robot.wheels() {
            let rigid = wheel.rigid(0.08).unwrap();
            assert_eq!(rigid.grousers(), Some(truth), "{}", converted.text);
        }
        assert!(!converted.text.contains("wheels with lugs need"));
    }
    // none, too few, one that is missing: a smooth wheel and a note
    for (angles, note) in [
        (vec![], "wheels with lugs need"),
        (vec![0.0, 3.0], "wheels with lugs need"),
        (even(20).skip(1).collect(), "19 boxes on the circumference"),
    ] {
        let (converted, file) = made(&lugged(&bars(angles, "collision")));
        assert!(
            file.robot.wheels()[0]
                .rigid(0.08)
                .unwrap()
                .grousers()
                .is_none()
        );
        let reported = converted.notes.iter().any(|said| said.contains(note));
        assert!(reported, "{:?}", converted.notes);
    }
}

/// XML: nesting, size, every cut and turned bits.
#[test]
fn hostile_descriptions_end() {
    let begun = ThreadTime::now();
    let deep = format!(
        "{}{}",
        "<robot>".repeat(100_000),
        "</robot>".repeat(100_000)
    );
    refused(&deep);
    let wide = format!(
        "<robot name=\"r\">{}</robot>",
        "<link name=\"l\"/>".repeat(100_000)
    );
    refused(&wide);
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
    let whole = cart();
    let whole = whole.as_bytes();
    for end in (0..whole.len()).step_by(7) {
        let cut = String::from_utf8_lossy(&whole[..end]);
        let _ = robot_file(&cut);
    }
    for bit in (0..8 * whole.len()).step_by(11) {
        let mut bytes = whole.to_vec();
        bytes[bit / 8] ^= 1 << (bit % 8);
        if let Ok(converted) = robot_file(&String::from_utf8_lossy(&bytes)) {
            let document = Document::from_text("robot.toml", converted.text).unwrap();
            // what is made of it is a robot file, or is refused as one with words
            let _ = robot::parse(&document);
        }
    }
}
