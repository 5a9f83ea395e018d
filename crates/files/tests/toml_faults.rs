//! TOML that is deep, large, twice, unknown, too big a number, or no number.

use std::fmt::Write;

use grouser_files::robot::Revision;
use grouser_files::{Document, Error, columns, robot};

const WHEEL: &str =
    "[[wheel]]\nname = \"a\"\nx_m = 0\ny_m = 0\nradius_m = 0.1\ndrive = \"powered\"\n";

fn robot(text: &str) -> Result<robot::RobotFile, Error> {
    robot::parse(&Document::from_text("r.toml", text.into())?)
}

fn with(wheel: &str) -> Result<robot::RobotFile, Error> {
    robot(&format!("format = 1\nname = \"r\"\n{WHEEL}{wheel}\n"))
}

fn line(error: &Error) -> usize {
    match error {
        Error::NotText { at }
        | Error::Syntax { at, .. }
        | Error::TooDeep { at, .. }
        | Error::Format { at, .. }
        | Error::MissingKey { at, .. }
        | Error::UnknownKey { at, .. }
        | Error::RemovedKey { at, .. }
        | Error::WrongType { at, .. }
        | Error::OutOfRange { at, .. }
        | Error::BadChoice { at, .. }
        | Error::Robot { at, .. }
        | Error::Contradiction { at, .. } => at.line,
        _ => 0,
    }
}

#[test]
fn nesting() {
    for depth in [65_usize, 79, 81, 1000, 100_000] {
        let arrays = format!("format = 1\nx = {}{}", "[".repeat(depth), "]".repeat(depth));
        let tables = format!("format = 1\n[{}]\n", vec!["a"; depth].join("."));
        let inline = format!(
            "format = 1\nx = {}1{}",
            "{a=".repeat(depth),
            "}".repeat(depth)
        );
        for text in [arrays, tables, inline] {
            let error = robot(&text).unwrap_err();
            assert!(
                matches!(error, Error::TooDeep { limit: 64, .. }),
                "{depth}: {error}"
            );
        }
    }
    // 60 deep is merely an unknown key.
    let text = format!(
        "format = 1\nname = \"r\"\n{WHEEL}x = {}{}",
        "[".repeat(60),
        "]".repeat(60)
    );
    assert!(matches!(robot(&text), Err(Error::UnknownKey { .. })));
}

#[test]
fn size() {
    let text = format!("format = 1\n# {}", "x".repeat(1 << 20));
    assert!(matches!(
        robot(&text),
        Err(Error::TooLarge {
            limit: 1_048_576,
            ..
        })
    ));
}

#[test]
fn keys_twice_and_unknown() {
    let twice = with("x_m = 1").unwrap_err();
    assert!(matches!(twice, Error::Syntax { .. }), "{twice}");
    assert_eq!(line(&twice), 9);
    let unknown = with("width = 0.1").unwrap_err();
    assert!(
        matches!(&unknown, Error::UnknownKey { key, meant: Some("width_m"), .. } if key == "width"),
        "{unknown}"
    );
    assert_eq!(line(&unknown), 9);
    assert!(matches!(
        with("colour = 1"),
        Err(Error::UnknownKey { meant: None, .. })
    ));
    let section = robot(&format!("format = 1\nname = \"r\"\n[estimater]\n{WHEEL}")).unwrap_err();
    assert_eq!(section.hint().unwrap(), "did you mean `estimator`?");
}

#[test]
fn numbers_that_are_none() {
    for bad in [
        "nan",
        "-nan",
        "inf",
        "-inf",
        "1e999",
        "0",
        "-0.05",
        "1e300",
        "9223372036854775808",
    ] {
        let error = with(&format!("width_m = {bad}")).unwrap_err();
        assert!(
            matches!(
                error,
                Error::OutOfRange { .. } | Error::Robot { .. } | Error::Syntax { .. }
            ),
            "{bad}: {error}"
        );
    }
    for bad in ["\"nan\"", "\"0.1\"", "true", "[0.1]", "2020-01-01", "0x10"] {
        assert!(
            matches!(
                with(&format!("width_m = {bad}")),
                Err(Error::WrongType { .. })
            ),
            "{bad}"
        );
    }
    for bad in [
        "9223372036854775808",
        "-99999999999999999999",
        "16.0",
        "\"16\"",
    ] {
        let error = with(&format!("counter_bits = {bad}")).unwrap_err();
        assert!(matches!(error, Error::WrongType { .. }), "{bad}: {error}");
    }
    for bad in ["0", "7", "65", "-16", "4294967312"] {
        assert!(
            matches!(
                with(&format!("counter_bits = {bad}")),
                Err(Error::Robot { .. })
            ),
            "{bad}"
        );
    }
}

#[test]
fn formats() {
    for (text, ok) in [
        ("format = 1", true),
        ("format = 0x1", true),
        ("format = 2", false),
    ] {
        let read = robot(&format!("{text}\nname = \"r\"\n{WHEEL}"));
        assert_eq!(read.is_ok(), ok, "{text}");
    }
    let newer = robot("format = 7\nwhatever = 1").unwrap_err();
    assert!(matches!(
        newer,
        Error::Format {
            found: 7,
            newest: 1,
            ..
        }
    ));
    assert!(matches!(robot("format = 0"), Err(Error::OutOfRange { .. })));
    assert!(matches!(
        robot("name = \"r\""),
        Err(Error::MissingKey { key: "format", .. })
    ));
    assert!(matches!(
        robot(""),
        Err(Error::MissingKey { key: "format", .. })
    ));
}

#[test]
fn a_robot_is_read_as_it_is_written() {
    let file = with("gear = 16\nencoder_on = \"motor\"\nticks_per_turn = 2_000\ncounter_bits = 16\nheading_deg = 90").unwrap();
    let wheel = &file.robot.wheels()[0];
    assert_eq!(
        (wheel.encoder.gear, wheel.encoder.ticks_per_turn),
        (16.0, Some(2000.0))
    );
    assert!((wheel.heading.rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    let contradiction = with("encoder_on = \"motor\"").unwrap_err();
    assert!(matches!(contradiction, Error::Contradiction { .. }));
    let choice =
        robot("format = 1\nname = \"r\"\n[estimator]\nreference = \"free wheel\"").unwrap_err();
    assert_eq!(choice.hint().unwrap(), "did you mean \"free-wheel\"?");
}

#[test]
fn wheels_are_counted() {
    let mut text = String::from("format = 1\nname = \"r\"\n");
    assert!(matches!(robot(&text), Err(Error::Robot { .. })));
    for wheel in 0..65 {
        let _ = write!(text, "{}", WHEEL.replace("\"a\"", &format!("\"w{wheel}\"")));
    }
    assert!(matches!(robot(&text), Err(Error::Robot { .. })));
    assert!(matches!(
        robot(&format!("format = 1\nname = \"r\"\n{WHEEL}{WHEEL}")),
        Err(Error::Robot { .. })
    ));
}

#[test]
fn column_maps_that_contradict_themselves() {
    let map = |table: &str| {
        columns::parse(&Document::from_text("c.toml", format!("format = 1\n{table}")).unwrap())
    };
    let time = "time = { column = \"t\", unit = \"s\" }";
    let rate = "{ column = \"g\", meaning = \"yaw_rate\", unit = \"deg/s\" }";
    let pose = "{ column = \"x\", meaning = \"pose_x\", unit = \"m\" }, { column = \"y\", meaning = \"pose_y\", unit = \"m\" }";
    let good = map(&format!("[[table]]\n{time}\ncolumns = [{rate}]")).unwrap();
    assert!((good.tables[0].columns[0].factor - 0.017_453_292_519_943_295).abs() < 1e-17);
    for (table, what) in [
        (String::new(), "no table"),
        (format!("[[table]]\ncolumns = [{rate}]"), "no time"),
        (format!("[[table]]\n{time}"), "no columns"),
        (format!("[[table]]\n{time}\ncolumns = []"), "no columns"),
        (
            format!("[[table]]\n{time}\ncolumns = [{rate}, {rate}]"),
            "twice",
        ),
        (
            format!("[[table]]\n{time}\nseparator = \",\"\ndecimal = \",\"\ncolumns = [{rate}]"),
            "marks",
        ),
        (
            format!("[[table]]\n{time}\nseparator = \"ab\"\ncolumns = [{rate}]"),
            "separator",
        ),
        (
            format!("[[table]]\n{time}\nseparator = \"\\n\"\ncolumns = [{rate}]"),
            "separator",
        ),
        (
            format!("[[table]]\n{time}\nheader_lines = -1\ncolumns = [{rate}]"),
            "lines before the header",
        ),
        (
            format!("[[table]]\n{time}\nheader_lines = 0\nnames_line = 1\ncolumns = [{rate}]"),
            "names without a header",
        ),
        (
            format!(
                "[[table]]\n{time}\ncolumns = [{pose}, {{ column = \"w\", meaning = \"orientation_w\", unit = \"1\" }}]"
            ),
            "a part of a quaternion alone",
        ),
        (
            format!(
                "[[table]]\n{time}\ncolumns = [{pose}, {{ column = \"a\", meaning = \"pose_yaw\", unit = \"rad\" }}, \
                 {{ column = \"z\", meaning = \"orientation_z\", unit = \"1\" }}, \
                 {{ column = \"w\", meaning = \"orientation_w\", unit = \"1\" }}]"
            ),
            "two headings",
        ),
        (
            format!("[[table]]\n{time}\nnames_line = 2\ncolumns = [{rate}]"),
            "names beyond header",
        ),
        (
            format!(
                "[[table]]\n{time}\ncolumns = [{{ column = \"g\", meaning = \"yaw_rate\", unit = \"m\" }}]"
            ),
            "unit",
        ),
        (
            format!(
                "[[table]]\n{time}\ncolumns = [{{ column = \"g\", meaning = \"wheel_rate\", unit = \"rpm\" }}]"
            ),
            "no wheel",
        ),
        (
            format!(
                "[[table]]\n{time}\ncolumns = [{{ column = \"g\", meaning = \"pose_y\", unit = \"m\" }}]"
            ),
            "half a pose",
        ),
        (
            format!(
                "[[table]]\n{time}\ncolumns = [{{ column = \"g\", meaning = \"wheel_count\", wheel = \"a\", unit = \"tick\", scale = 2 }}]"
            ),
            "scaled ticks",
        ),
    ] {
        assert!(map(&table).is_err(), "{what}");
    }
}

#[test]
fn calibrated_radii_are_written_and_nothing_else() {
    let free = WHEEL.replace("\"a\"", "\"f\"").replace("powered", "free");
    let text = format!(
        "format = 1 # one\nname = \"r\"\n[estimator]\nwheel_sensor = \"rate\"\n{WHEEL}# two\n{free}"
    );
    let document = Document::from_text("r.toml", text.clone()).unwrap();
    let scaled_by = |factor| {
        let radius = Some(factor);
        let revision = Revision {
            radius,
            ..Revision::default()
        };
        robot::revised(&document, &revision)
    };
    let scaled = scaled_by(0.8822).unwrap();
    assert_eq!(
        scaled,
        text.replacen("radius_m = 0.1", "radius_m = 0.088220", 1)
    );
    for bad in [f64::NAN, 0.0, -1.0, 1e9] {
        assert!(scaled_by(bad).is_err(), "{bad}");
    }
}

#[test]
fn a_key_that_the_filter_no_longer_has_is_refused_with_what_replaced_it() {
    let of = |line: &str| {
        format!("format = 1\nname = \"r\"\n{WHEEL}[filter]\nslip_mean = 0.2\n{line}\n")
    };
    for key in [
        "wheel_window_s",
        "speed_walk_m_per_s_sqrt_s",
        "accelerometer_noise_m_per_s_sqrt_s",
        "accelerometer_bias_m_per_s2",
        "yaw_walk_deg_per_s_sqrt_s",
        "gyro_bias_deg_per_s",
        "slip_memory_s",
        "wheel_slip_sigma",
        "wheel_slip_memory_s",
        "radius_sigma",
    ] {
        let text = of(&format!("{key} = 0.1"));
        let error = robot(&text).unwrap_err();
        assert!(
            matches!(&error, Error::RemovedKey { key: found, .. } if *found == key),
            "{error}"
        );
        assert_eq!(line(&error), 11, "{error}");
        let document = Document::from_text("r.toml", text).unwrap();
        let revised = robot::revised(&document, &Revision::default());
        assert!(matches!(revised, Err(Error::RemovedKey { .. })));
    }
    for key in [
        "window_s",
        "max_slip_sigma",
        "yaw_rate_sigma_deg_per_s",
        "lateral_sigma_m_per_s",
    ] {
        let error = robot(&format!(
            "format = 1\nname = \"r\"\n{WHEEL}[estimator]\n{key} = 0.5\n"
        ));
        let error = error.unwrap_err().to_string();
        let says = format!("[estimator] no longer has the key `{key}`: ");
        assert!(error.contains(&says), "{error}");
    }
    let error = robot(&of("radius_sigma = 0.01")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "r.toml:11:16: [filter] no longer has the key `radius_sigma`: radii are not learnt online; `estimate --calibrate-radius` finds them"
    );
    assert_eq!(error.hint().as_deref(), Some("remove the key"));
    assert!(robot(&of("")).is_ok());
}
