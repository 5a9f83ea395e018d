use super::*;

#[test]
fn names_are_understood_as_people_write_them() {
    let of = |name, whole| guess(name, None, whole).map(|g| (g.meaning, g.wheel, g.unit));
    let wheel = |name: &str| Some(name.to_owned());
    assert_eq!(
        of("front_left_ticks", true),
        Some((Meaning::WheelCount, wheel("front_left"), "tick"))
    );
    assert_eq!(
        of("field.left_encoder", true),
        Some((Meaning::WheelCount, wheel("left"), "tick"))
    );
    assert_eq!(
        of("leftWheelRpm", false),
        Some((Meaning::WheelRate, wheel("left"), "rpm"))
    );
    assert_eq!(
        of("right_wheel_angle_deg", false),
        Some((Meaning::WheelAngle, wheel("right"), "deg"))
    );
    assert_eq!(
        of("gyro_z_rad_per_s", false),
        Some((Meaning::YawRate, None, "rad/s"))
    );
    assert_eq!(
        of("field.angular_velocity.z", false),
        Some((Meaning::YawRate, None, "rad/s"))
    );
    assert_eq!(of("vicon_x", false), Some((Meaning::PoseX, None, "m")));
    for nothing in [
        "imu_acc_z",
        "field.angular_velocity_covariance8",
        "left_motor_current",
        "angle",
    ] {
        assert_eq!(of(nothing, false), None, "{nothing}");
    }
}

#[test]
fn wheels_are_numbered() {
    let numbered = ["m1", "w23"].map(is_numbered);
    let others = ["m", "1", "m1a", "mm1", "x1", ""].map(is_numbered);
    assert_eq!((numbered, others), ([true; 2], [false; 6]));
}

#[test]
fn every_meaning_has_its_names() {
    use Meaning as M;
    for (name, unit, whole, meaning, own) in [
        ("left_ticks", None, true, M::WheelCount, "tick"),
        ("left", Some("ticks"), true, M::WheelCount, "tick"),
        ("m1enc", None, true, M::WheelCount, "tick"),
        ("right_motor_speed", None, false, M::WheelRate, "rad/s"),
        ("left_rate_deg", None, false, M::WheelRate, "deg/s"),
        ("left_rate_rad", None, false, M::WheelRate, "rad/s"),
        ("w2_omega", None, true, M::WheelRate, "rad/s"),
        ("m1pos", None, false, M::WheelAngle, "rad"),
        ("left_angle", None, true, M::WheelAngle, "rad"),
        ("left_angle", Some(""), false, M::WheelAngle, "rad"),
        ("left_angle", Some("turn"), false, M::WheelAngle, "turn"),
        ("gyro_z_dps", None, false, M::YawRate, "deg/s"),
        ("ang_vel_z", None, false, M::YawRate, "rad/s"),
        ("gyro_rad[2]", None, false, M::YawRate, "rad/s"),
        ("enc1_rad", None, false, M::WheelAngle, "rad"),
        ("left_rad", None, false, M::WheelAngle, "rad"),
        ("rear_right_wheel_deg", None, false, M::WheelAngle, "deg"),
        ("enc2", None, true, M::WheelCount, "tick"),
        ("vel3_rad_s", None, false, M::WheelRate, "rad/s"),
        ("imu.z", None, false, M::YawRate, "rad/s"),
        ("angular_rate_z", None, false, M::YawRate, "rad/s"),
        ("yaw_velocity", None, false, M::YawRate, "rad/s"),
        ("yawrate", None, false, M::YawRate, "rad/s"),
        ("cmd_x", None, false, M::CommandForward, "m/s"),
        ("target_speed", None, false, M::CommandForward, "m/s"),
        ("dx", None, false, M::DisplacementForward, "m"),
        ("dy", None, false, M::DisplacementLeft, "m"),
        ("dang", None, false, M::DisplacementTurn, "rad"),
        ("dyaw", None, false, M::DisplacementTurn, "rad"),
        ("pose_heading_deg", None, false, M::PoseYaw, "deg"),
        ("odom_x", None, false, M::PoseX, "m"),
        ("gps.y", None, false, M::PoseY, "m"),
        ("gps_fix", None, true, M::FixType, "1"),
        ("fixtype", None, true, M::FixType, "1"),
        ("gps_quality", None, true, M::FixType, "1"),
        ("gps_status", None, true, M::FixStatus, "1"),
    ] {
        let found = guess(name, unit, whole).map(|guess| (guess.meaning, guess.unit));
        assert_eq!(found, Some((meaning, own)), "{name}");
    }
    for (name, unit, whole) in [
        ("left_ticks", None, false),
        ("left", Some("ticks"), false),
        ("left", None, true),
        ("wheel_ticks", None, true),
        ("yaw_rate", Some("m"), false),
        ("gyro_x", None, false),
        ("ang_vel_x", None, false),
        ("ang_z", None, false),
        ("vel_z", None, false),
        ("gyro_rad[1]", None, false),
        ("temperature[2]", None, false),
        // the axes of a place may point north and east
        ("pose[0]", None, false),
        ("left_arm_rad", None, false),
        ("enc1", None, false),
        ("current1", None, false),
        ("angular_z", None, false),
        ("velocity_z", None, false),
        ("yaw", None, false),
        ("rate", None, false),
        ("speed", None, false),
        ("left_speed_m", None, false),
        ("left_temperature", None, false),
        ("cmd", None, false),
        ("cmd_speed_left", None, false),
        ("cmd_angular_x", None, false),
        ("cmd_wheel_speed", None, false),
        ("cmd_v_m1", None, false),
        ("dz", None, false),
        ("x_dx", None, false),
        ("x", None, false),
        ("pose_z", None, false),
        ("pose_x_covariance", None, false),
        ("pose_quat_x", None, false),
        ("imu_quat_z", None, false),
        ("gps", None, true),
        ("quality", None, true),
        ("status", None, true),
    ] {
        assert_eq!(guess(name, unit, whole), None, "{name}");
    }
}

#[test]
fn a_unit_in_the_name_counts() {
    use Meaning as M;
    for (name, meaning, wheel, unit) in [
        ("pose_x_mm", M::PoseX, None, "mm"),
        ("pose_x_ft", M::PoseX, None, "ft"),
        ("odo_left_m", M::WheelDistance, Some("left"), "m"),
        ("rl_odometer [ft]", M::WheelDistance, Some("rl"), "ft"),
        ("RPM_FL", M::WheelRate, Some("fl"), "rpm"),
        ("pos_x_cm", M::PoseX, None, "cm"),
        ("position_x_in", M::PoseX, None, "in"),
        ("WheelSpeed_FL [km/h]", M::WheelSpeed, Some("fl"), "km/h"),
        ("wheel_speed_fl_kmh", M::WheelSpeed, Some("fl"), "km/h"),
        ("fr_wheel_speed_mm_s", M::WheelSpeed, Some("fr"), "mm/s"),
        ("fl_speed_m_s", M::WheelSpeed, Some("fl"), "m/s"),
        (
            "left_speed_forward_m_s",
            M::WheelSpeed,
            Some("left_forward"),
            "m/s",
        ),
        ("left_vel (in/s)", M::WheelSpeed, Some("left"), "in/s"),
        ("v_l(ips)", M::WheelSpeed, Some("l"), "in/s"),
        ("v_r [m/s]", M::WheelSpeed, Some("r"), "m/s"),
        ("wheel_speed_rl_ft_s", M::WheelSpeed, Some("rl"), "ft/s"),
        (
            "axis0_left_vel (turns/s)",
            M::WheelRate,
            Some("axis0_left"),
            "turn/s",
        ),
        ("left_motor_rps", M::WheelRate, Some("left"), "turn/s"),
        ("gps_speed_mph", M::SpeedSize, None, "mph"),
        ("left_vel_mps", M::WheelSpeed, Some("left"), "m/s"),
        ("wheel_rate_fl_deg_s", M::WheelRate, Some("fl"), "deg/s"),
        ("fl_rpm", M::WheelRate, Some("fl"), "rpm"),
        ("rpm_left", M::WheelRate, Some("left"), "rpm"),
        (
            "/joint_states/left/velocity_rad_s",
            M::WheelRate,
            Some("left"),
            "rad/s",
        ),
        ("gyro_z_deg_s", M::YawRate, None, "deg/s"),
        ("wz_rad_s", M::YawRate, None, "rad/s"),
        ("yaw_rate [deg/s]", M::YawRate, None, "deg/s"),
        ("steering_angle_deg", M::SteeringAngle, None, "deg"),
        ("SteeringAngle [deg]", M::SteeringAngle, None, "deg"),
        ("fl_steering_deg", M::WheelSteering, Some("fl"), "deg"),
        ("GPS_Speed [km/h]", M::SpeedSize, None, "km/h"),
        ("ground_speed_kmh", M::SpeedSize, None, "km/h"),
        ("speed_forward_kmh", M::SpeedForward, None, "km/h"),
        ("acc_x_g", M::AccelerationForward, None, "g"),
        ("acceleration_y [m/s²]", M::AccelerationLeft, None, "m/s2"),
        ("left_torque_nm", M::WheelTorque, Some("left"), "N m"),
        ("left_torque [Nm]", M::WheelTorque, Some("left"), "N m"),
        ("fl_current_A", M::MotorCurrent, Some("fl"), "A"),
        (
            "right_motor_current_ma",
            M::MotorCurrent,
            Some("right"),
            "mA",
        ),
        ("cmd_speed_kmh", M::CommandForward, None, "km/h"),
    ] {
        let found = guess(name, None, false);
        let found = found.map(|guess| (guess.meaning, guess.wheel, guess.unit));
        let wheel = wheel.map(str::to_owned);
        assert_eq!(found, Some((meaning, wheel, unit)), "{name}");
    }
    // a channel of an encoder
    let found = guess("left_enc_a", None, true).unwrap();
    assert_eq!((found.meaning, found.unit), (M::WheelCount, "tick"));
    // units that no column map has, or that do not fit
    for name in [
        "yaw_rate_mrad_s",
        "pose_x_km",
        "odo_left_km",
        "left_distance_m",
        "wheel_speed_fl (furlong/h)",
        "left_vel [wheel/s]",
        "left_camera_fps",
        "acc_x_mg",
        "acc_z_m_s2",
        "go_speed_m_s",
        "speed_m_s",
        "forward_m_s",
        "left_load_nm",
        "arm_torque_nm",
        "pose_x_deg",
        "pose_heading_mm",
    ] {
        assert_eq!(guess(name, None, false), None, "{name}");
    }
    let of_line = guess("wheel_speed_fl", Some("kmh"), false).unwrap();
    assert_eq!((of_line.meaning, of_line.unit), (M::WheelSpeed, "km/h"));
}
