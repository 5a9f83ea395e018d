//! The header against the library: constants, sizes, offsets and functions, by a C compiler.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::mem::{offset_of, size_of};

use crate::compiler::{header, needs_compiler, scratch};

macro_rules! constants {
    ($($name:ident)*) => { &[$((stringify!($name), grouser_c::$name as i64)),*] };
}

/// Every constant of the library.
const CONSTANTS: &[(&str, i64)] = constants!(
    GROUSER_ABI GROUSER_OK GROUSER_ERROR_POINTER GROUSER_ERROR_SIZE GROUSER_ERROR_VALUE
    GROUSER_ERROR_DESCRIPTION GROUSER_SAMPLE_REFUSED GROUSER_ERROR_WHEEL GROUSER_ERROR_INTERNAL
    GROUSER_POWERED GROUSER_FREE GROUSER_ENCODER_ON_MOTOR GROUSER_ENCODER_REVERSED
    GROUSER_START_REPORT GROUSER_START_OFF GROUSER_START_REFUSE
    GROUSER_WHEEL_COUNT GROUSER_WHEEL_EDGE GROUSER_WHEEL_ANGLE GROUSER_WHEEL_RATE GROUSER_YAW_RATE
    GROUSER_DISPLACEMENT GROUSER_POSE GROUSER_SPEED GROUSER_INERTIAL GROUSER_JOINT_ANGLE
    GROUSER_MOTOR_CURRENT GROUSER_WHEEL_TORQUE GROUSER_ACCELERATION GROUSER_POSITION
    GROUSER_STEERING_ANGLE GROUSER_SINKAGE GROUSER_ENTRY_ANGLE GROUSER_HAS_TURN GROUSER_HAS_LEFT
    GROUSER_HEALTH_UNINITIALISED GROUSER_HEALTH_OK GROUSER_HEALTH_DEGRADED GROUSER_HEALTH_INVALID
    GROUSER_REASON_NONE GROUSER_REASON_LOW_SPEED GROUSER_REASON_QUANTISED GROUSER_REASON_REFERENCE_LOST
    GROUSER_REASON_RELATIVE
    GROUSER_REASON_SUSPECT GROUSER_REASON_DROPOUT GROUSER_REASON_NO_REFERENCE
    GROUSER_REASON_INCONSISTENT GROUSER_REASON_OTHER
    GROUSER_MOTION_UNKNOWN GROUSER_MOTION_DRIVING GROUSER_MOTION_BRAKING GROUSER_MOTION_STANDSTILL
    GROUSER_MOTION_ROLL_BACK GROUSER_MOTION_LIFT_OFF GROUSER_MOTION_STALL
    GROUSER_MODE_FORWARD GROUSER_MODE_TRAVERSE GROUSER_MODE_BACK_OUT GROUSER_MODE_DETOUR
    GROUSER_MODE_STOPPED
    GROUSER_KNOWS_SLIP GROUSER_KNOWS_FORWARD_SPEED GROUSER_KNOWS_RIM_SPEED GROUSER_KNOWS_SIDE_SLIP
    GROUSER_KNOWS_LAST_GOOD_AGE GROUSER_KNOWS_REFERENCE_AGE
);

/// Name, size and the offset of each field.
type Layout = (&'static str, usize, &'static [(&'static str, usize)]);

macro_rules! layouts {
    ($($name:ident { $($field:ident)* })*) => {
        &[$((
            stringify!($name),
            size_of::<grouser_c::$name>(),
            &[$((stringify!($field), offset_of!(grouser_c::$name, $field))),*],
        )),*]
    };
}

/// Every struct of the library with its fields in their order.
const LAYOUTS: &[Layout] = layouts!(
    GrouserWheel { size role x_m y_m heading_rad radius_m load_n gear ticks_per_turn rate_step_rad_per_s
        max_torque_n_m max_steering_angle_rad counter_bits encoder_flags }
    GrouserFilterSetting { key value }
    GrouserSettings { size start_policy warm_up_s gravity_m_per_s2 heading_rad filter filter_count }
    GrouserSample { size kind time_ns wheel flags raw values }
    GrouserWheelEstimate { size known health reason motion reserved slip slip_sigma forward_speed_m_per_s
        forward_speed_sigma_m_per_s rim_speed_m_per_s rim_speed_sigma_m_per_s side_slip_angle_rad
        side_slip_angle_sigma_rad last_good_age_s }
    GrouserBodyEstimate { size known mode start_fault time_ns time_slip_s forward_m_per_s
        forward_sigma_m_per_s left_m_per_s left_sigma_m_per_s yaw_rate_rad_per_s yaw_rate_sigma_rad_per_s
        common_slip common_slip_sigma x_m y_m yaw_rad place_covariance distance_m distance_of_wheels_m
        roll_rad pitch_rad reference_age_s rejected_bad_value rejected_not_later rejected_jump
        rejected_unknown dropped clock_steps }
    GrouserCommand { size reserved rim_speed_m_per_s traction steering_angle_rad }
);

/// Words of `text` after `before`.
fn names<'a>(text: &'a str, before: &str) -> BTreeSet<&'a str> {
    let ends = |c: char| !(c.is_alphanumeric() || c == '_');
    text.split(before)
        .skip(1)
        .filter_map(|rest| rest.split(ends).next())
        .collect()
}

#[test]
fn sizes_offsets_and_constants_are_those_of_the_library() {
    let mut program = String::from("#include \"grouser.h\"\n");
    for (name, value) in CONSTANTS {
        writeln!(program, "_Static_assert({name} == {value}, \"{name}\");").unwrap();
    }
    for (name, size, fields) in LAYOUTS {
        writeln!(
            program,
            "_Static_assert(sizeof({name}) == {size}, \"{name}\");"
        )
        .unwrap();
        for (field, offset) in *fields {
            let at = format!("offsetof({name}, {field}) == {offset}");
            writeln!(program, "_Static_assert({at}, \"{name}.{field}\");").unwrap();
        }
    }
    let Some(cc) = needs_compiler("cc") else {
        return;
    };
    let folder = scratch("header");
    let source = folder.join("header.c");
    std::fs::write(&source, program).unwrap();
    cc.run(
        &[
            "-std=c11",
            "-pedantic",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-fsyntax-only",
        ],
        &[&source],
    );
}

#[test]
fn the_header_has_no_name_that_the_library_lacks_and_lacks_none() {
    let header = std::fs::read_to_string(header()).unwrap();
    let mut constants = names(&header, "#define ");
    constants.remove("GROUSER_H");
    assert_eq!(
        constants,
        CONSTANTS.iter().map(|constant| constant.0).collect()
    );
    let mut structs = names(&header, "typedef struct ");
    structs.remove("GrouserOnBoard");
    assert_eq!(structs, LAYOUTS.iter().map(|layout| layout.0).collect());

    let source = concat!(
        include_str!("../src/abi.rs"),
        include_str!("../src/create.rs"),
        include_str!("../src/run.rs"),
        include_str!("../src/copy_out.rs")
    );
    assert_eq!(
        names(source, "\npub const "),
        constants,
        "a constant is not compared"
    );
    let mut functions = names(&header, "\nint32_t ");
    functions.extend(names(&header, "\nuint32_t "));
    functions.extend(names(&header, "\nvoid "));
    let mut ours = names(source, "unsafe extern \"C\" fn ");
    ours.insert("grouser_abi");
    assert_eq!(functions, ours);
}

#[test]
fn the_header_is_one_for_cpp_too() {
    let Some(compiler) = needs_compiler("c++") else {
        return;
    };
    let source = scratch("header").join("header.cpp");
    std::fs::write(
        &source,
        "#include \"grouser.h\"\n#include \"grouser.hpp\"\nint main() { return 0; }\n",
    )
    .unwrap();
    let flags = [
        "-std=c++17",
        "-pedantic",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-fsyntax-only",
    ];
    compiler.run(&flags, &[&source]);
}
