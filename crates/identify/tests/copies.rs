//! Rows that repeat others, and rows whose noise lasts, do not make a result more certain than it is.

use std::fmt::Write;
use std::path::Path;

use grouser_files::Document;
use grouser_identify::{Identification, IdentifiedNumber, Job, identify};

use crate::coverage::{Noise, TRUTH, laboratory, wheel_tests};

/// The rows of a table of this name, each often.
type Repeat<'a> = &'a dyn Fn(&str, &[&str]) -> Vec<String>;

fn identified(folder: &Path) -> Identification {
    identify(&Job::read(&Document::read(&folder.join("tests.toml")).unwrap()).unwrap()).unwrap()
}

fn half_width(number: &IdentifiedNumber) -> f64 {
    let (low, high) = (number.interval.low, number.interval.high);
    0.5 * (high.unwrap() - low.unwrap())
}

/// Each row ten times, the whole table ten times, and plate tests under ten names.
#[test]
fn repeated_rows_leave_the_intervals_as_they_are() {
    let folder = laboratory(1, 0.03, &wheel_tests());
    let once = identified(&folder);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let tables = ["plates.csv", "shear.csv", "wheel.csv"].map(|name| (name, read(name)));
    let each_row = |_: &str, rows: &[&str]| -> Vec<String> {
        rows.iter()
            .flat_map(|row| vec![(*row).to_owned(); 10])
            .collect()
    };
    let each_table = |_: &str, rows: &[&str]| -> Vec<String> {
        (0..10)
            .flat_map(|_| rows.iter().map(|row| (*row).to_owned()))
            .collect()
    };
    let each_name = |name: &str, rows: &[&str]| -> Vec<String> {
        let renamed = |copy: usize| {
            let prefix = if name == "plates.csv" {
                copy.to_string()
            } else {
                String::new()
            };
            rows.iter().map(move |row| format!("{prefix}{row}"))
        };
        (0..10).flat_map(renamed).collect()
    };
    let ways: [Repeat<'_>; 3] = [&each_row, &each_table, &each_name];
    for (way, repeat) in ways.into_iter().enumerate() {
        let mut rows_of = Vec::new();
        for (name, text) in &tables {
            let lines: Vec<&str> = text.lines().collect();
            rows_of.push(lines.len() - 1);
            let rows = repeat(name, &lines[1..]).join("\n");
            std::fs::write(folder.join(name), format!("{}\n{rows}\n", lines[0])).unwrap();
        }
        let often = identified(&folder);
        for (one, ten) in once.numbers().iter().zip(often.numbers()) {
            let ratio = half_width(&ten) / half_width(one);
            assert!((ratio - 1.0).abs() < 0.05, "{way}: {} {ratio}", one.name);
        }
        // one in thirty rows of plates is shallower than is used
        let copies = [
            often.plates.unwrap().copies,
            often.shear.unwrap().copies,
            often.wheel.unwrap().copies,
        ];
        assert_eq!(
            copies,
            [9 * (rows_of[0] - 3), 9 * rows_of[1], 9 * rows_of[2]]
        );
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Six readings in a row at each slip, whose noise has a correlation of 0.9 from one to the next: without the effective
/// number of readings n_1, c_1, c_2 and the datum lie in their intervals in 29, 11, 23 and 14 of 40.
#[test]
fn wheel_readings_whose_noise_lasts_count_as_few() {
    const ROWS: usize = 6;
    const LABORATORIES: u64 = 40;
    let wheel = wheel_tests();
    let mut hits = [0_u32; 4];
    for seed in 1..=LABORATORIES {
        let folder = laboratory(seed, 0.01, &wheel);
        let mut noise = Noise(seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
        let mut table = String::from("slip,load_n,drawbar_pull_n,torque_nm,sinkage_m\n");
        let mut lasting = [0.0; 3];
        for [slip, load, pull, torque, sinkage] in &wheel {
            for _ in 0..ROWS {
                for own in &mut lasting {
                    *own = 0.9 * *own + (1.0_f64 - 0.81).sqrt() * noise.normal();
                }
                let [a, b, c] = lasting;
                let (pull, torque) = (pull + 0.5 * a, torque + 0.05 * b);
                let sinkage = sinkage + TRUTH[3] + 5e-4 * c;
                writeln!(table, "{slip},{load},{pull},{torque},{sinkage}").unwrap();
            }
        }
        std::fs::write(folder.join("wheel.csv"), table).unwrap();
        let stage = identified(&folder).wheel.unwrap();
        assert!(stage.redundancy > 2.0, "{}", stage.redundancy);

        for ((hits, truth), number) in hits.iter_mut().zip(TRUTH).zip(&stage.numbers) {
            let (low, high) = (number.interval.low.unwrap(), number.interval.high.unwrap());
            *hits += u32::from(low <= truth && truth <= high);
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
    println!("n_1, c_1, c_2 and datum in {hits:?} of {LABORATORIES}");
    // 38 ± 1.4 of 40; the correlation that 84 rows show is itself uncertain
    assert!(hits.iter().all(|hits| *hits >= 33), "{hits:?}");
}
