//! Mistakes that owners make when they describe a robot: each must be named in the first lines, or end with 3, and logs without a mistake
//! must raise none.
//!
//! `cargo test -p grouser --test all owners_mistakes_as_a_table -- --ignored --nocapture` prints the table of all mistakes on three logs.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use crate::repository::{Folder, grouser};

/// Its name, place (m), and radius (m).
#[derive(Clone, Debug)]
struct Wheel {
    name: String,
    place: [f64; 2],
    radius: f64,
}

/// The sensors' readings at one time; angles of the wheels in rad.
#[derive(Clone, Debug, Default)]
struct Row {
    time: f64,
    angles: Vec<f64>,
    gyro: Option<f64>,
    acceleration: Option<[f64; 2]>,
    pose: Option<[f64; 3]>,
}

/// A log, and what its owner writes of it.
#[derive(Clone, Debug)]
struct Run {
    wheels: Vec<Wheel>,
    rows: Vec<Row>,
    /// Ticks of a turn, where the wheels are counted.
    ticks: Option<f64>,
    /// Seconds by which poses are stamped late.
    lag: f64,
}

/// A mistake, and the words of which one names it.
struct Mistake {
    name: &'static str,
    words: &'static [&'static str],
    make: fn(&mut Run),
}

fn scale_angles(run: &mut Run, scale: f64) {
    for angle in run.rows.iter_mut().flat_map(|row| &mut row.angles) {
        *angle *= scale;
    }
}

/// The motion by the wheels between two rows: speed and turn times the time, of a robot that turns by its sides.
fn by_wheels(run: &Run, from: &Row, to: &Row) -> [f64; 2] {
    let n = run.wheels.len() as f64;
    let passed = |index: usize| run.wheels[index].radius * (to.angles[index] - from.angles[index]);
    let all = 0..run.wheels.len();
    let forward: f64 = all.clone().map(passed).sum::<f64>() / n;
    let square: f64 = run
        .wheels
        .iter()
        .map(|wheel| wheel.place[1] * wheel.place[1])
        .sum();
    let turn = all
        .map(|index| -run.wheels[index].place[1] * (passed(index) - forward))
        .sum::<f64>()
        / square;
    [forward, turn]
}

/// Poses of odometry, whose turn is the gyro's or the wheels'.
fn odometry(run: &mut Run, is_filter: bool) {
    let mut pose = [0.0; 3];
    let mut speed = 0.0;
    for index in 1..run.rows.len() {
        let (before, row) = (run.rows[index - 1].clone(), run.rows[index].clone());
        let [mut forward, mut turn] = by_wheels(run, &before, &row);
        let dt = row.time - before.time;
        if is_filter {
            // a filter follows the wheels' speed with a time constant of 0.1 s
            speed += (forward / dt - speed) * (dt / 0.1).min(1.0);
            forward = speed * dt;
            turn = row.gyro.unwrap_or(0.0) * dt;
        }
        let half = pose[2] + 0.5 * turn;
        pose = [
            pose[0] + forward * half.cos(),
            pose[1] + forward * half.sin(),
            pose[2] + turn,
        ];
        if row.pose.is_some() {
            run.rows[index].pose = Some(pose);
        }
    }
}

const MISTAKES: [Mistake; 18] = [
    Mistake {
        name: "gear forgotten",
        words: &["gear"],
        make: |run| scale_angles(run, 30.0),
    },
    Mistake {
        name: "a gear of 100 forgotten",
        words: &["gear"],
        make: |run| scale_angles(run, 100.0),
    },
    Mistake {
        name: "ticks of the motor",
        words: &["ticks"],
        make: |run| {
            run.ticks = Some(256.0);
            scale_angles(run, 4.0);
        },
    },
    Mistake {
        name: "diameter for radius",
        words: &["diameter"],
        make: |run| run.wheels.iter_mut().for_each(|wheel| wheel.radius *= 2.0),
    },
    Mistake {
        name: "encoders without a sign",
        words: &["no sign"],
        make: |run| {
            // the robot drives the last third backwards
            let turn = run.rows.len() * 2 / 3;
            let (rows, back) = run.rows.split_at(turn);
            let forth = rows[rows.len() - back.len()..].iter().rev();
            let back: Vec<Row> = back
                .iter()
                .zip(forth)
                .map(|(row, of)| Row {
                    time: row.time,
                    gyro: of.gyro.map(|rate| -rate),
                    ..of.clone()
                })
                .collect();
            run.rows.truncate(turn);
            run.rows.extend(back);
            let mut last = run.rows[0].angles.clone();
            let mut angles = last.clone();
            for row in &mut run.rows {
                for ((angle, last), now) in angles.iter_mut().zip(&mut last).zip(&row.angles) {
                    *angle += (now - *last).abs();
                    *last = *now;
                }
                row.angles.clone_from(&angles);
            }
        },
    },
    Mistake {
        name: "a frozen reference",
        words: &["frozen"],
        make: |run| {
            let third = run.rows.len() / 3;
            let held = run.rows[third..].iter().find_map(|row| row.pose);
            for row in &mut run.rows[third..2 * third] {
                row.pose = row.pose.and(held);
            }
        },
    },
    Mistake {
        name: "commands published beside measurements",
        words: &["two programs publish on one topic"],
        make: |run| {
            let commanded = |row: &Row| Row {
                time: row.time + 0.01,
                angles: row.angles.iter().map(|angle| 1.1 * angle).collect(),
                ..Row::default()
            };
            let rows = run.rows.iter();
            run.rows = rows.flat_map(|row| [row.clone(), commanded(row)]).collect();
        },
    },
    Mistake {
        name: "the poses of another robot between those of this one",
        words: &["two programs publish on one topic"],
        make: |run| {
            let poses = run.rows.iter_mut().filter_map(|row| row.pose.as_mut());
            for [x, y, yaw] in poses.skip(1).step_by(2) {
                (*x, *y, *yaw) = (5.0 - 0.3 * *x, 3.0 + 0.5 * *x, *yaw + 1.0);
            }
        },
    },
    Mistake {
        name: "sides exchanged",
        words: &["exchanged"],
        make: |run| {
            for wheel in &mut run.wheels {
                wheel.place[1] *= -1.0;
            }
        },
    },
    Mistake {
        name: "a wheel by another's sensor",
        words: &["another wheel's sensor"],
        make: |run| {
            let index = run
                .wheels
                .iter()
                .position(|wheel| wheel.place[1] < 0.0)
                .unwrap();
            let other = run
                .wheels
                .iter()
                .position(|wheel| wheel.place[1] > 0.0)
                .unwrap();
            run.rows
                .iter_mut()
                .for_each(|row| row.angles[index] = row.angles[other]);
        },
    },
    Mistake {
        name: "wheel odometry as reference",
        words: &["derived from the wheels"],
        make: |run| odometry(run, false),
    },
    Mistake {
        name: "filter as reference",
        words: &["derived from the wheels"],
        make: |run| odometry(run, true),
    },
    Mistake {
        name: "axes of the IMU",
        words: &["IMU", "another axis"],
        make: |run| {
            let mut sign = 1.0;
            for row in &mut run.rows {
                sign = -sign;
                // the rate about x: noise
                row.gyro = row.gyro.map(|_| 0.003 * sign);
                row.acceleration = row.acceleration.map(|[forward, left]| [-left, forward]);
            }
        },
    },
    Mistake {
        name: "gyro in degrees",
        words: &["unit"],
        make: |run| {
            for row in &mut run.rows {
                row.gyro = row.gyro.map(f64::to_degrees);
            }
        },
    },
    Mistake {
        name: "lag of 0.4 s",
        words: &["lags by", "late"],
        make: |run| run.lag = 0.4,
    },
    Mistake {
        name: "two logs in one",
        words: &["more than one drive", "two drives"],
        make: |run| {
            let end = run.rows.last().unwrap().time;
            let mut again = run.rows.clone();
            for row in &mut again {
                row.time += end + 20.0;
            }
            run.rows.extend(again);
        },
    },
    Mistake {
        name: "mirrored frame (NED)",
        words: &["mirrored"],
        make: |run| {
            for row in &mut run.rows {
                row.gyro = row.gyro.map(|rate| -rate);
                row.acceleration = row.acceleration.map(|[forward, left]| [forward, -left]);
                row.pose = row.pose.map(|[x, y, yaw]| [x, -y, -yaw]);
            }
        },
    },
    Mistake {
        name: "half of the track",
        words: &["track"],
        make: |run| {
            for wheel in &mut run.wheels {
                wheel.place[1] *= 0.5;
            }
        },
    },
];

impl Run {
    /// Writes tables and a robot file.
    fn write(&self, folder: &Folder) -> [String; 2] {
        let names: Vec<&str> = self
            .wheels
            .iter()
            .map(|wheel| wheel.name.as_str())
            .collect();
        let mut wheels = format!("t,{}\n", names.join(","));
        let (mut imu, mut pose) = ("t,rate,forward,left\n".to_owned(), "t,x,y,yaw\n".to_owned());
        for row in &self.rows {
            let time = row.time;
            write!(wheels, "{time:.4}").unwrap();
            for angle in &row.angles {
                match self.ticks {
                    Some(ticks) => write!(wheels, ",{:.0}", angle / TAU * ticks).unwrap(),
                    None => write!(wheels, ",{angle:.6}").unwrap(),
                }
            }
            wheels.push('\n');
            if let Some(rate) = row.gyro {
                let [forward, left] = row.acceleration.unwrap_or_default();
                writeln!(imu, "{time:.4},{rate:.6},{forward:.5},{left:.5}").unwrap();
            }
            if let Some([x, y, yaw]) = row.pose {
                writeln!(pose, "{:.4},{x:.5},{y:.5},{yaw:.6}", time + self.lag).unwrap();
            }
        }
        let log = folder.path("log");
        fs::create_dir_all(&log).unwrap();
        for (name, text) in [("wheels", wheels), ("imu", imu), ("pose", pose)] {
            fs::write(folder.path(&format!("log/{name}.csv")), text).unwrap();
        }
        let (meaning, unit) = if self.ticks.is_some() {
            ("wheel_count", "tick")
        } else {
            ("wheel_angle", "rad")
        };
        let mut robot =
            "format = 1\nname = \"robot\"\n[estimator]\nposition_sigma_m = 0.005\n".to_owned();
        for wheel in &self.wheels {
            let [x, y] = wheel.place;
            writeln!(
                robot,
                "[[wheel]]\nname = \"{}\"\nx_m = {x:?}\ny_m = {y:?}\nradius_m = {:?}\ndrive = \"powered\"",
                wheel.name, wheel.radius
            )
            .unwrap();
            if let Some(ticks) = self.ticks {
                writeln!(robot, "ticks_per_turn = {ticks}\ncounter_bits = 64").unwrap();
            }
        }
        let table = |file: &str, columns: &str| {
            format!(
                "[[table]]\nfile = \"{file}.csv\"\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n{columns}]\n"
            )
        };
        let column = |name: &str, meaning: &str, unit: &str| {
            format!("    {{ column = \"{name}\", meaning = \"{meaning}\", unit = \"{unit}\" }},\n")
        };
        let of_wheels = |name: &&str| {
            format!(
                "    {{ column = \"{name}\", meaning = \"{meaning}\", wheel = \"{name}\", unit = \"{unit}\" }},\n"
            )
        };
        let mut of_imu = column("rate", "yaw_rate", "rad/s");
        if self.rows.iter().any(|row| row.acceleration.is_some()) {
            of_imu += &column("forward", "acceleration_forward", "m/s2");
            of_imu += &column("left", "acceleration_left", "m/s2");
        }
        let of_pose = [
            column("x", "pose_x", "m"),
            column("y", "pose_y", "m"),
            column("yaw", "pose_yaw", "rad"),
        ];
        robot += &table("wheels", &names.iter().map(of_wheels).collect::<String>());
        robot += &table("imu", &of_imu);
        robot += &table("pose", &of_pose.concat());
        [log, folder.file("robot.toml", robot)]
    }

    /// The exit code, and the lines before the table of the wheels.
    fn estimate(&self) -> (i32, Vec<String>) {
        let folder = Folder::new("mistakes");
        let [log, robot] = self.write(&folder);
        let output = grouser(&["estimate", &log, "--robot", &robot]);
        let text = String::from_utf8(output.stdout).unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        let lines = text
            .lines()
            .skip(1)
            .take_while(|line| !line.starts_with("wheel "));
        let lines = errors.lines().chain(lines).filter(|line| !line.is_empty());
        (
            output.status.code().unwrap(),
            lines.map(str::to_owned).collect(),
        )
    }
}

/// Is it a line that names causes?
fn is_cause(line: &str) -> bool {
    [
        "WARNING: ",
        "NOTE: ",
        "POSSIBLE: ",
        "the reference lags",
        "error: ",
    ]
    .iter()
    .any(|start| line.starts_with(start))
}

/// Four wheels that slip by 0.3 from 15 s to 25 s, in bends of 0.15 rad/s at most, with an accelerometer.
fn made() -> Run {
    let wheels: Vec<Wheel> = [
        ("front_left", 0.25, 0.2),
        ("front_right", 0.25, -0.2),
        ("rear_left", -0.25, 0.2),
        ("rear_right", -0.25, -0.2),
    ]
    .map(|(name, x, y)| Wheel {
        name: name.into(),
        place: [x, y],
        radius: 0.1,
    })
    .to_vec();
    let dt = 0.05;
    let mut row = Row {
        angles: vec![0.0; 4],
        ..Row::default()
    };
    let (mut pose, mut speed) = ([0.0_f64; 3], 0.0);
    let mut noise = Noise(1);
    let mut rows = Vec::new();
    for step in 0..=800 {
        let time = f64::from(step) * dt;
        let target = if (1.0..=39.0).contains(&time) {
            0.4 + 0.1 * (0.7 * time).sin()
        } else {
            0.0
        };
        let turn = if time < 1.0 {
            0.0
        } else {
            0.15 * (0.35 * time).sin()
        };
        let before = speed;
        speed += (target - speed) * 0.2;
        row.time = time;
        row.gyro = Some(turn + noise.next(0.002));
        row.acceleration = Some([
            (speed - before) / dt + noise.next(0.02),
            speed * turn + noise.next(0.02),
        ]);
        let seen = |noise: &mut Noise, sigma: f64, value: f64| value + noise.next(sigma);
        row.pose = (step % 5 == 0).then(|| {
            [
                seen(&mut noise, 0.002, pose[0]),
                seen(&mut noise, 0.002, pose[1]),
                seen(&mut noise, 0.002, pose[2]),
            ]
        });
        rows.push(row.clone());
        let slip = if (15.0..25.0).contains(&time) {
            0.3
        } else {
            0.0
        };
        for (angle, wheel) in row.angles.iter_mut().zip(&wheels) {
            *angle += (speed - turn * wheel.place[1]) * dt / (1.0 - slip) / wheel.radius;
        }
        let half = pose[2] + 0.5 * turn * dt;
        pose = [
            pose[0] + speed * dt * half.cos(),
            pose[1] + speed * dt * half.sin(),
            pose[2] + turn * dt,
        ];
    }
    Run {
        wheels,
        rows,
        ticks: None,
        lag: 0.0,
    }
}

struct Noise(u64);

impl Noise {
    /// Nearly normal.
    fn next(&mut self, sigma: f64) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum * sigma
    }
}

fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let names = lines
        .next()
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let rows = lines.map(|line| {
        line.split(',')
            .map(|field| field.parse().unwrap_or(f64::NAN))
            .collect()
    });
    (names, rows.collect())
}

fn data() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let base = std::env::var_os("GROUSER_DATA").map_or_else(|| root.join("data"), PathBuf::from);
    let base = root.join(base);
    base.join("optiodom").is_dir().then_some(base)
}

/// A measured drive of a robot of two wheels; the gyro is the motion capture's turn.
fn measured() -> Option<Run> {
    let file = fs::File::open(data()?.join("optiodom/diff_030120210006_run-02.csv.gz")).unwrap();
    let mut text = String::new();
    flate2::read::GzDecoder::new(file)
        .read_to_string(&mut text)
        .unwrap();
    let (_, rows) = table(&text);
    let mut noise = Noise(2);
    let rows: Vec<Row> = rows
        .windows(2)
        .map(|pair| {
            let [time, x, y, yaw, right, left] = pair[1][..] else {
                panic!()
            };
            let turn = (yaw - pair[0][3] + 3.0 * PI).rem_euclid(TAU) - PI;
            Row {
                time,
                angles: [left, right]
                    .map(|ticks| ticks / (64.0 * 43.7) * TAU)
                    .to_vec(),
                gyro: Some(turn / (time - pair[0][0]) + noise.next(0.003)),
                acceleration: None,
                pose: Some([x, y, yaw]),
            }
        })
        .collect();
    let wheel = |name: &str, y: f64| Wheel {
        name: name.into(),
        place: [0.0, y],
        radius: 0.042,
    };
    Some(Run {
        wheels: vec![wheel("left", 0.1), wheel("right", -0.1)],
        rows,
        ticks: None,
        lag: 0.0,
    })
}

/// The corner wheels of the five-wheeled robot: forwards, to the left, m. Their encoders are on the motors.
const WHEELS: [(&str, f64, f64); 4] = [
    ("front_left", 0.3, 0.25),
    ("front_right", 0.3, -0.25),
    ("rear_left", -0.3, 0.25),
    ("rear_right", -0.3, -0.25),
];
const TICKS_PER_RADIAN: f64 = 64.0 * 60.0 / TAU;

/// A drive in the simulation, on another wheel model than the estimator's; the pose is the true one with noise at 5 Hz.
fn driven() -> Run {
    let folder = Folder::new("mistakes-drive");
    let mcap = folder.path("drive.mcap");
    let drive = grouser(&[
        "drive",
        "examples/scenarios/plan-and-learn.toml",
        "-o",
        &mcap,
    ]);
    assert!(drive.status.success());
    let topic = |name: &str| {
        let csv = folder.path(&format!("{}.csv", name.replace('/', "_")));
        let output = grouser(&["log", "convert", &mcap, &csv, "--topic", name]);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{errors}");
        table(&fs::read_to_string(csv).unwrap())
    };
    let column = |names: &[String], name: &str| names.iter().position(|own| own == name).unwrap();
    let [(ticks_names, ticks), (imu_names, imu), (pose_names, poses)] =
        ["/wheel_ticks", "/imu", "/simulation/truth/pose"].map(topic);
    let mut noise = Noise(3);
    let first = column(&ticks_names, "ticks[0]");
    let [rate, forward, left] = [
        "angular_velocity.z",
        "linear_acceleration.x",
        "linear_acceleration.y",
    ]
    .map(|name| column(&imu_names, name));
    let [x, y, z, w] = ["position.x", "position.y", "orientation.z", "orientation.w"]
        .map(|part| column(&pose_names, &format!("pose.{part}")));
    let count = ticks.len().min(imu.len()).min(poses.len());
    let rows = (0..count).step_by(2).map(|index| {
        let (ticks, imu, pose) = (&ticks[index], &imu[index], &poses[index]);
        let yaw = 2.0 * f64::atan2(pose[z], pose[w]);
        let seen = [pose[x], pose[y], yaw].map(|value| value + noise.next(0.005));
        Row {
            time: ticks[0] * 1e-9,
            angles: (first..first + 4)
                .map(|column| ticks[column] / TICKS_PER_RADIAN)
                .collect(),
            gyro: Some(imu[rate]),
            acceleration: Some([imu[forward], imu[left]]),
            pose: index.is_multiple_of(20).then_some(seen),
        }
    });
    Run {
        rows: rows.collect(),
        wheels: WHEELS
            .map(|(name, x, y)| Wheel {
                name: name.into(),
                place: [x, y],
                radius: 0.15,
            })
            .to_vec(),
        ticks: None,
        lag: 0.0,
    }
}

/// Is one of the first three causes the mistake?
fn is_named(mistake: &Mistake, lines: &[String]) -> bool {
    let causes = lines.iter().filter(|line| is_cause(line)).take(3);
    let mut named = causes.flat_map(|line| {
        mistake
            .words
            .iter()
            .filter(move |word| line.contains(**word))
    });
    named.next().is_some()
}

#[test]
fn mistakes_of_owners_are_named_and_right_files_are_not() {
    let right = made();
    let (code, lines) = right.estimate();
    assert_eq!(code, 0, "{lines:?}");
    assert!(!lines.iter().any(|line| is_cause(line)), "{lines:?}");
    for mistake in &MISTAKES {
        let mut run = right.clone();
        (mistake.make)(&mut run);
        let (code, lines) = run.estimate();
        assert!(
            is_named(mistake, &lines),
            "{}: exit {code}, {lines:?}",
            mistake.name
        );
    }
}

/// The camera of [`made`] shows one place from 26 s to 34 s, with its noise: no slip of that time may be `Ok` and wrong.
#[test]
fn readings_of_a_frozen_reference_are_left_out() {
    let (mut run, mut noise, mut held) = (made(), Noise(7), None);
    for row in run
        .rows
        .iter_mut()
        .filter(|row| (26.0..34.0).contains(&row.time))
    {
        if let Some(pose) = &mut row.pose {
            let at = *held.get_or_insert(*pose);
            *pose = at.map(|value| value + noise.next(0.002));
        }
    }
    let folder = Folder::new("frozen-reference");
    let [log, robot] = run.write(&folder);
    let out = folder.path("out.csv");
    let output = grouser(&["estimate", &log, "--robot", &robot, "-o", &out]);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("was frozen or lost"));
    let text = fs::read_to_string(out).unwrap();
    let slips = text.lines().skip(1).filter_map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        let time: f64 = fields[0].parse().unwrap();
        let is_used = (26.5..33.5).contains(&time) && fields[5] == "Ok";
        is_used.then(|| fields[2].parse::<f64>().unwrap())
    });
    let wrong: Vec<f64> = slips.filter(|slip| slip.abs() > 0.1).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Habits of drivers by `bench/drivers.py`, which has more of them and other seeds.
#[test]
fn habits_of_drivers_leave_slips_right_or_are_named() {
    let Some(python) = std::env::var_os("GROUSER_PYTHON") else {
        eprintln!("skipped: GROUSER_PYTHON names no Python with numpy and mcap-ros2-support");
        return;
    };
    let cases = "pose without noise,three turns at 10 Hz,pose never changes,another robot's pose,wheels of 5 Hz in rows of 20";
    let output = std::process::Command::new(python)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .args([
            "bench/drivers.py",
            env!("CARGO_BIN_EXE_grouser"),
            cases,
            "0:1",
        ])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let found = text.lines().last().unwrap_or_default();
    assert_eq!(
        found,
        "10 of 10 with at most 0.01 of the Ok slips wrong, 10 named where they must be",
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

fn print(lines: &[String]) {
    for line in lines {
        println!("      {line}");
    }
}

#[test]
#[ignore = "a table of all mistakes on three logs"]
fn owners_mistakes_as_a_table() {
    let mut runs = vec![("made", made())];
    runs.extend(measured().map(|run| ("measured", run)));
    runs.push(("driven", driven()));
    let (mut named, mut total) = (0, 0);
    for (name, run) in &runs {
        let (code, lines) = run.estimate();
        println!("{name}: without a mistake: exit {code}");
        print(&lines);
        for mistake in &MISTAKES {
            let mut run = run.clone();
            (mistake.make)(&mut run);
            let (code, lines) = run.estimate();
            let is_named = is_named(mistake, &lines);
            named += i32::from(is_named);
            total += 1;
            let word = if is_named { "named" } else { "NOT NAMED" };
            println!("{name}: {}: exit {code}, {word}", mistake.name);
            print(&lines);
        }
    }
    println!("{named} of {total} named");
}
