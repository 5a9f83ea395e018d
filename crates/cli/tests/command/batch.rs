//! `batch` against the reference cases, and what it does with rows that cannot be solved.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::Stdio;

use super::program::{Folder, grouser, line, start, wait};
use grouser_terra::SolveStatus;

/// The cases that the laws are tested with: quadrature to 30 digits.
const REFERENCE: &str = include_str!("../../../terra/tests/oracle/wheel_cases.csv");

type Table = Vec<BTreeMap<String, String>>;

fn table(text: &str) -> Table {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let fields = line.split(',').map(str::to_owned);
        header
            .iter()
            .map(|name| (*name).to_owned())
            .zip(fields)
            .collect()
    };
    lines.map(row).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn solve(folder: &Folder, text: &str) -> (Table, String) {
    solve_to(folder, text, 0)
}

/// Solves a table; the program ends with this exit code.
fn solve_to(folder: &Folder, text: &str, code: i32) -> (Table, String) {
    let (input, output) = (folder.file("in.csv", text), folder.path("out.csv"));
    let arguments = [
        PathBuf::from("batch"),
        input,
        PathBuf::from("-o"),
        output.clone(),
    ];
    let said = grouser(arguments);
    assert_eq!(said.code, Some(code), "{said:?}");
    let text = std::fs::read_to_string(output).unwrap();
    (table(&text), text)
}

#[test]
fn every_reference_case_comes_out_to_1e_9() {
    let reference = table(REFERENCE);
    assert!(reference.len() > 200);
    let mut text = String::from("kind,soil,radius_m,width_m,rebound,slip,sinkage_m,load_n\n");
    for case in &reference {
        let by_sinkage = case["kind"] == "forces";
        let column = |name: &str, wanted: bool| {
            if wanted {
                case[name].clone()
            } else {
                String::new()
            }
        };
        let shared = ["kind", "soil", "radius_m", "width_m", "rebound", "slip"]
            .map(|name| case[name].clone());
        writeln!(
            text,
            "{},{},{}",
            shared.join(","),
            column("sinkage_m", by_sinkage),
            column("vertical_force_n", !by_sinkage)
        )
        .unwrap();
    }
    let (solved, _) = solve(&Folder::new(), &text);
    assert_eq!(solved.len(), reference.len());
    let mut worst: f64 = 0.0;
    for (case, row) in reference.iter().zip(&solved) {
        assert_eq!(row["status"], "ok");
        // Columns of the input stand as they stood.
        assert_eq!(row["radius_m"], case["radius_m"]);
        let radius = number(case, "radius_m");
        let [w, dp, t] = ["vertical_force_n", "drawbar_pull_n", "torque_nm"]
            .map(|column| (number(case, column), number(row, column)));
        let scale = w.0.abs().max(dp.0.abs()).max(t.0.abs() / radius);
        for (off, scale) in [
            (w.1 - w.0, scale),
            (dp.1 - dp.0, scale),
            (t.1 - t.0, scale * radius),
        ] {
            worst = worst.max(off.abs() / scale);
        }
        let [there, here] = [case, row].map(|row| number(row, "sinkage_m"));
        worst = worst.max((here / there - 1.0).abs());
    }
    println!(
        "worst relative error of {} cases: {worst:.1e}",
        reference.len()
    );
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn numbers_survive_a_second_reading() {
    let (rows, _) = solve(
        &Folder::new(),
        "soil,radius_m,width_m,slip,sinkage_m,load_n\nlunar,0.1,0.1,0.2,,40\n",
    );
    for column in [
        "sinkage_m",
        "vertical_force_n",
        "drawbar_pull_n",
        "torque_nm",
    ] {
        let text = &rows[0][column];
        let value: f64 = text.parse().unwrap();
        assert_eq!(format!("{value:.16e}").parse::<f64>().unwrap(), value);
        let digits = text
            .trim_start_matches(['-', '0', '.'])
            .bytes()
            .filter(u8::is_ascii_digit)
            .count();
        assert!(digits <= 17, "{text}");
    }
}

#[test]
fn a_bad_row_stops_nothing() {
    let folder = Folder::new();
    let bad = [
        (
            "moon,0.1,0.1,0.2,,40",
            "bad-input: soil `moon` is not in the catalogue",
        ),
        ("lunar,nan,0.1,0.2,,40", "bad-input: `radius_m` is `nan`"),
        ("lunar,-0.1,0.1,0.2,,40", "bad-input: `radius_m` is -0.1 m"),
        ("lunar,0.1,0.1,2,,40", "bad-input: `slip` is 2"),
        (
            "lunar,0.1,0.1,0.2,0.01,40",
            "bad-input: both `sinkage_m` and `load_n`",
        ),
        (
            "lunar,0.1,0.1,0.2,,",
            "bad-input: neither `sinkage_m` nor `load_n`",
        ),
        ("lunar,0.1,0.1,0.2,,1e400", "bad-input: `load_n` is `1e400`"),
        ("lunar,0.1,0.1,0.2,0.2,", "bad-input: `sinkage_m` is 0.2 m"),
        ("lunar,0.1,0.1,0.2", "bad-input: 4 fields"),
        ("lunar,0.1,0.1,0.2,,40,7,8", "bad-input: 8 fields"),
        (
            "\"lunar,0.1,0.1,0.2,,40",
            "bad-input: field 1 has a quotation mark that is not closed",
        ),
        ("lunar,0.1,0.1,0.2,,1e11", "no-solution"),
        ("hit-lss1,0.1,0.1,0.2,,40", "bad-input: missing `--c-1`"),
    ];
    let good = "lunar,0.1,0.1,0.2,,40";
    let rows: Vec<&str> = bad.iter().flat_map(|(row, _)| [*row, good]).collect();
    let text = format!(
        "soil,radius_m,width_m,slip,sinkage_m,load_n\n{}\n",
        rows.join("\r\n")
    );
    let (_, out) = solve_to(&folder, &text, 3);
    let lines: Vec<&str> = out.lines().skip(1).collect();
    assert_eq!(lines.len(), 2 * bad.len());
    for (pair, (row, status)) in lines.chunks(2).zip(bad) {
        // The status stands before the cautions, in quotation marks where it holds a comma.
        let bad = pair[0].strip_suffix(',').unwrap();
        let found = bad.rsplit_once(",\"").map_or_else(
            || bad.rsplit(',').next().unwrap().to_owned(),
            |(_, quoted)| quoted.trim_end_matches('"').to_owned(),
        );
        assert!(found.starts_with(status), "{row}: {found}");
        assert!(pair[1].ends_with(",ok,"), "{}", pair[1]);
    }
}

#[test]
fn every_status_is_counted() {
    let schema = line("help batch --schema").assert_done().json();
    for status in SolveStatus::ALL {
        let key = status.key();
        let count = &schema["properties"][key.replace('-', "_")];
        assert!(count.is_object(), "{key} is not counted");
    }
}

#[test]
fn what_is_no_table_is_refused_with_its_place() {
    let folder = Folder::new();
    for (text, place) in [
        ("", "line 1: the file is empty"),
        (
            "soil,radius_m,width_m,slip,load_n\n",
            "line 2: there is a header but no row",
        ),
        (
            "soil;radius_m;width_m;slip;load_n\nlunar;0,1;0,1;0,2;40\n",
            "line 1: there is no column `soil`",
        ),
        (
            "soil,radius_m,width_m,slip\nlunar,1,1,0\n",
            "line 1: there is neither",
        ),
        (
            "soil,soil,radius_m,width_m,slip,load_n\n",
            "line 1: column 2 is `soil`",
        ),
        ("\"soil,radius_m\n", "line 1: column 1 has a quotation mark"),
        (
            "soil,radius_m,width_m,load_n\nlunar,1,1,1\n",
            "line 1: there is no column `slip`",
        ),
    ] {
        let arguments = [
            PathBuf::from("batch"),
            folder.file("in.csv", text),
            PathBuf::from("-o"),
            folder.path("out.csv"),
        ];
        let said = grouser(arguments);
        said.assert_refused(text);
        assert!(said.err.contains(place), "{text:?}: {said:?}");
        assert_eq!(folder.names(), ["in.csv"], "{text:?}");
    }
}

#[test]
fn a_table_of_another_format_is_refused_by_its_name() {
    let folder = Folder::new();
    let header = "soil,radius_m,width_m,slip,load_n\n";
    let (csv, parquet) = (
        folder.file("in.csv", header),
        folder.file("in.parquet", header),
    );
    let output = folder.path("out.Parquet");
    for (input, output) in [(&parquet, &folder.path("out.csv")), (&csv, &output)] {
        let words = ["batch".into(), input.clone(), "-o".into(), output.clone()];
        let said = grouser::<PathBuf>(words);
        said.assert_refused("Parquet");
        assert!(said.err.contains("not a CSV table"), "{said:?}");
    }
    assert_eq!(folder.names(), ["in.csv", "in.parquet"]);
}

#[test]
fn a_byte_order_mark_and_other_columns_do_no_harm() {
    let (rows, text) = solve(
        &Folder::new(),
        "\u{feff}id,soil,radius_m,width_m,slip,load_n,note\r\n7,lunar,0.1,0.1,0.2,40,\"fine\"\r\n",
    );
    assert!(
        text.starts_with("id,soil,radius_m,width_m,slip,load_n,note,sinkage_m,vertical_force_n,")
    );
    assert_eq!(
        (rows[0]["id"].as_str(), rows[0]["note"].as_str()),
        ("7", "\"fine\"")
    );
    assert!(number(&rows[0], "sinkage_m") > 0.0);
}

#[test]
fn standard_input_is_streamed_and_an_endless_line_is_refused() {
    let folder = Folder::new();
    let output = folder.path("out.csv");
    let arguments = ["batch".into(), "-".into(), "-o".into(), output.clone()];
    let mut child = start(&arguments, Stdio::piped());
    let mut pipe = child.stdin.take().unwrap();
    pipe.write_all(b"soil,radius_m,width_m,slip,load_n\n")
        .unwrap();
    // The program may refuse and go while we still write.
    let _ = pipe.write_all(&vec![b'7'; 3 << 20]);
    drop(pipe);
    let said = wait(child);
    said.assert_refused("a line of 3 MiB");
    assert!(
        said.err
            .contains("line 2: is longer than 1048576 bytes, the limit for a line"),
        "{said:?}"
    );
    assert!(folder.names().is_empty());

    let mut child = start(&arguments, Stdio::piped());
    let mut pipe = child.stdin.take().unwrap();
    pipe.write_all(b"soil,radius_m,width_m,slip,load_n\n")
        .unwrap();
    for i in 1..=10_000 {
        writeln!(pipe, "lunar,0.1,0.1,0.2,{i}").unwrap();
    }
    drop(pipe);
    // The greatest loads have no solution.
    assert_eq!(wait(child).code, Some(3));
    let rows = table(&std::fs::read_to_string(output).unwrap());
    let loads: Vec<u32> = rows
        .iter()
        .map(|row| row["load_n"].parse().unwrap())
        .collect();
    assert!(
        loads.iter().copied().eq(1..=10_000),
        "the order of the rows is kept"
    );
}

/// Rows of all lengths, so that the program's reads end at every place of a line; blank lines are no rows, and a row
/// that is not UTF-8 hides no other.
#[test]
fn lines_are_whole_wherever_a_read_ends() {
    let folder = Folder::new();
    for end in ["\n", "\r\n"] {
        let mut bytes =
            format!("soil,radius_m,width_m,slip,sinkage_m,load_n,note{end}").into_bytes();
        let count = 3000;
        for i in 0..count {
            let note = "n".repeat(i % 701);
            bytes.extend(format!("lunar,0.1,0.1,0.2,,40,{i} {note}").as_bytes());
            if i == 2000 {
                bytes.push(0xff);
            }
            bytes.extend(end.as_bytes());
            if i % 100 == 0 {
                bytes.extend(format!("  {end}{end}").as_bytes());
            }
        }
        bytes.truncate(bytes.len() - end.len()); // the last line has no end
        let input = folder.path("in.csv");
        std::fs::write(&input, &bytes).unwrap();
        let output = folder.path("out.csv");
        let arguments = ["batch".into(), input, "-o".into(), output.clone()];
        assert_eq!(grouser(arguments).code, Some(3));
        let text = std::fs::read_to_string(output).unwrap();
        let rows: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(rows.len(), count);
        for (i, row) in rows.iter().enumerate() {
            let note = format!(",40,{i} {},", "n".repeat(i % 701));
            let (middle, status) = if i == 2000 {
                ("\u{fffd}", ",bad-input: the row is not UTF-8,")
            } else {
                (note.as_str(), ",ok,")
            };
            assert!(row.contains(middle) && row.ends_with(status), "{row}");
        }
    }
}

#[test]
fn a_line_that_is_too_long_has_its_number_wherever_it_is() {
    let folder = Folder::new();
    let limit = 1 << 20;
    for before in [0, 10, 20_000] {
        for (length, end, fits) in [
            (limit, "\n", true),
            (limit, "\r\n", true),
            (limit, "", true),
            (limit + 1, "\n", false),
            (limit + 1, "\r\n", false),
            (limit + 1, "", false),
        ] {
            let rows = "lunar,0.1,0.1,0.2,40\n".repeat(before);
            let text = format!(
                "soil,radius_m,width_m,slip,load_n\n{rows}{}{end}",
                "x".repeat(length)
            );
            let output = folder.path("out.csv");
            let arguments = [
                "batch".into(),
                folder.file("in.csv", &text),
                "-o".into(),
                output,
            ];
            let said = grouser(arguments);
            let place = format!("line {}: is longer than 1048576 bytes", before + 2);
            assert_eq!(
                said.err.contains(&place),
                !fits,
                "{before} {length} {end:?}: {said:?}"
            );
        }
    }
}

/// A header that is refused is refused at once, though the pipe stays open.
#[test]
fn a_header_is_answered_before_the_rows_come() {
    let folder = Folder::new();
    let arguments = [
        "batch".into(),
        "-".into(),
        "-o".into(),
        folder.path("out.csv"),
    ];
    let mut child = start(&arguments, Stdio::piped());
    let mut pipe = child.stdin.take().unwrap();
    pipe.write_all(b"soil,radius_m,width_m,load_n\n").unwrap();
    let said = wait(child);
    said.assert_refused("a header without slips");
    assert!(said.err.contains("there is no column `slip`"), "{said:?}");
    drop(pipe);
}

/// A row with a slip angle is the operating point of `wheel --slip-angle-deg`, with its side force.
#[test]
fn a_slip_angle_is_read() {
    let folder = Folder::new();
    let text = "soil,radius_m,width_m,slip,slip_angle_deg,load_n\ndry-sand,0.1,0.1,0.3,20,40\n\
                dry-sand,0.1,0.1,0.3,,40\n";
    let (rows, out) = solve(&folder, text);
    assert!(
        out.lines()
            .next()
            .unwrap()
            .ends_with("torque_nm,side_force_n,status,cautions")
    );
    let wheel = line(
        "wheel --soil dry-sand --radius-m 0.1 --width-m 0.1 --load-n 40 --slip 0.3 --slip-angle-deg 20 --json",
    );
    let wheel = wheel.json();
    for key in ["drawbar_pull_n", "side_force_n", "sinkage_m", "torque_nm"] {
        assert_eq!(number(&rows[0], key), wheel[key].as_f64().unwrap(), "{key}");
    }
    assert_eq!(number(&rows[1], "side_force_n"), 0.0);
    assert!(number(&rows[1], "drawbar_pull_n") > number(&rows[0], "drawbar_pull_n"));
}

/// A column that another quantity or another unit names is refused, not ignored.
#[test]
fn a_quantity_that_is_not_read_is_refused_by_name() {
    let folder = Folder::new();
    for column in [
        "slope_deg",
        "slip_angle_rad",
        "radius_mm",
        "load_kn",
        "phi_rad",
        "n_1",
        "mass_kg",
        "beta_deg",
        "slip-angle-deg",
        "Slip_Angle_deg",
        "Load (N)",
        "wheelLoad_n",
        "lug_height_m",
        "camber_deg",
        "cohesion_pa",
        "K_mm",
        "omega_rad_per_s",
        "gravity_m_per_s2",
        "pressure_kpa",
    ] {
        let text =
            format!("soil,radius_m,width_m,slip,load_n,{column}\ndry-sand,0.1,0.1,0.3,40,1\n");
        let input = folder.file("in.csv", &text);
        let arguments = ["batch".into(), input, "-o".into(), folder.path("out.csv")];
        let said = grouser(arguments);
        said.assert_refused(column);
        assert!(said.err.contains(&format!("`{column}`")), "{said:?}");
    }
    let text = "soil,radius_m,width_m,slip,load_n,note,measured_pull_n,time_s,x_m,load_case\ndry-sand,0.1,0.1,0.3,40,x,1,2,3,4\n";
    let (rows, _) = solve(&folder, text);
    assert_eq!(rows[0]["measured_pull_n"], "1");
    let text =
        "soil,radius_m,width_m,slip,load_n,grouser_thickness_m\ndry-sand,0.1,0.1,0.3,40,0.002\n";
    let input = folder.file("in.csv", text);
    let said = grouser(["batch".into(), input, "-o".into(), folder.path("out.csv")]);
    said.assert_refused("lugs need both columns");
}

/// The fluctuations as lugs pass are those of `wheel`; a smooth wheel beside has none, and lugs without a height are
/// refused.
#[test]
fn lugs_have_their_fluctuation() {
    let folder = Folder::new();
    let text = "soil,radius_m,width_m,slip,load_n,grouser_height_m,grouser_count\n\
        dry-sand,0.1,0.1,0.3,40,0.01,20\ndry-sand,0.1,0.1,0.3,40,,\ndry-sand,0.1,0.1,0.3,40,,20\n";
    let (rows, _) = solve_to(&folder, text, 3);
    let wheel = grouser(
        "wheel --json --soil dry-sand --radius-m 0.1 --width-m 0.1 --slip 0.3 --load-n 40 --grouser-height-m 0.01 \
         --grouser-count 20"
            .split_whitespace(),
    );
    let wheel = wheel.json();
    for key in ["pull_fluctuation_n", "torque_fluctuation_nm"] {
        let (found, expected) = (number(&rows[0], key), wheel[key].as_f64().unwrap());
        assert!(expected > 0.0 && (found - expected).abs() < 1e-12, "{key}");
        assert_eq!(rows[1][key], "", "{key}");
    }
    assert!(rows[2]["status"].contains("grouser_height_m"));
}

/// Rows outside the tests of their soil are counted, on lanes and off them.
#[test]
fn rows_outside_a_fit_are_counted() {
    let folder = Folder::new();
    let soil = "format = 1\nname = \"fitted\"\nn = 1.1\nk_c_kn_per_m_n1 = 0.9\nk_phi_kn_per_m_n2 = 1528.4\n\
        cohesion_kpa = 1.0\nphi_deg = 30.0\nk_shear_m = 0.025\nc_1 = 0.18\nc_2 = 0.32\n\n[fitted]\n\
        slip_min = 0.0\nslip_max = 0.5\nslip_angle_min_deg = 0.0\nslip_angle_max_deg = 30.0\nwidth_min_m = 0.1\n\
        width_max_m = 0.1\nload_min_n = 20.0\nload_max_n = 60.0\n";
    let soil = folder.file("soil.toml", soil).display().to_string();
    let text = format!(
        "soil,radius_m,width_m,slip,slip_angle_deg,load_n\n{soil},0.1,0.1,0.3,0,40\n{soil},0.1,0.1,0.3,20,40\n\
         {soil},0.1,0.1,0.7,0,40\n{soil},0.1,0.2,0.3,0,40\n{soil},0.1,0.1,0.3,40,40\ndry-sand,0.1,0.2,0.9,0,90\n"
    );
    let input = folder.file("in.csv", &text);
    let said = grouser([
        "batch".into(),
        input,
        "-o".into(),
        folder.path("out.csv"),
        "--json".into(),
    ]);
    assert_eq!(said.json()["outside_fit"], 3, "{said:?}");
}

/// The cautions of a row are those of `wheel` at the same point: on lanes and off them, braked, drifting and with lugs.
#[test]
fn cautions_are_those_of_single_points() {
    let folder = Folder::new();
    let mut text = String::from(
        "soil,radius_m,width_m,rebound,slip,slip_angle_deg,load_n,sinkage_m,grouser_height_m,grouser_count\n",
    );
    let mut points = Vec::new();
    for soil in ["dry-sand", "clayey-soil"] {
        for slip in ["0.9", "0.2", "-0.7"] {
            for (load, sinkage) in [("200", ""), ("30", ""), ("", "0.04"), ("", "0.003")] {
                for (angle, lugs, rebound) in [
                    ("0", "", "0"),
                    ("20", "", "0"),
                    ("0", "0.01", "0"),
                    ("0", "", "0.4"),
                ] {
                    let count = if lugs.is_empty() { "" } else { "6" };
                    writeln!(
                        text,
                        "{soil},0.1,0.05,{rebound},{slip},{angle},{load},{sinkage},{lugs},{count}"
                    )
                    .unwrap();
                    let by = if load.is_empty() {
                        ["--sinkage-m", sinkage]
                    } else {
                        ["--load-n", load]
                    };
                    let mut words = vec![
                        "wheel",
                        "--json",
                        "--soil",
                        soil,
                        "--radius-m",
                        "0.1",
                        "--width-m",
                        "0.05",
                    ];
                    words.extend(by);
                    let numbers = [
                        format!("--slip={slip}"),
                        format!("--slip-angle-deg={angle}"),
                        format!("--rebound={rebound}"),
                    ];
                    let mut words: Vec<String> = words
                        .into_iter()
                        .map(str::to_owned)
                        .chain(numbers)
                        .collect();
                    if !lugs.is_empty() {
                        words.extend([
                            format!("--grouser-height-m={lugs}"),
                            format!("--grouser-count={count}"),
                        ]);
                    }
                    points.push(words);
                }
            }
        }
    }
    let input = folder.file("in.csv", &text);
    let output = folder.path("out.csv");
    let said = grouser([
        "batch".into(),
        input,
        "-o".into(),
        output.clone(),
        "--json".into(),
    ])
    .json();
    let rows = table(&std::fs::read_to_string(output).unwrap());
    assert_eq!(rows.len(), points.len());
    let mut cautioned = 0;
    let mut counts = BTreeMap::new();
    for (row, words) in rows.iter().zip(points) {
        let wheel = grouser(words.clone()).json();
        let keys: Vec<&str> = wheel["cautions"]
            .as_array()
            .unwrap()
            .iter()
            .map(|key| key.as_str().unwrap())
            .collect();
        assert_eq!(row["status"], wheel["status"], "{words:?}");
        assert_eq!(row["cautions"], keys.join(" "), "{words:?}");
        cautioned += u64::from(!keys.is_empty());
        for key in keys {
            *counts.entry(key.to_owned()).or_insert(0_u64) += 1;
        }
    }
    assert!(counts.len() >= 4, "{counts:?}");
    assert_eq!(said["with_cautions"], cautioned);
    let said: BTreeMap<String, u64> = serde_json::from_value(said["cautions"].clone()).unwrap();
    assert_eq!(said, counts);
}

/// A row of a table with a dozen soils, each named twice, is the row of a table that has its soil alone.
#[test]
fn a_row_is_solved_on_its_own_soil_among_many() {
    let folder = Folder::new();
    let header = "soil,radius_m,width_m,slip,load_n\n";
    let row = |number: usize| {
        let soil = format!(
            "format = 1\nname = \"soil\"\nn = 1.1\nk_c_kn_per_m_n1 = 0.9\nk_phi_kn_per_m_n2 = 1528.4\n\
             cohesion_kpa = {number}.5\nphi_deg = 30.0\nk_shear_m = 0.025\nc_1 = 0.18\nc_2 = 0.32\n"
        );
        let soil = folder.file(&format!("soil-{number}.toml"), &soil);
        format!("{},0.1,0.1,0.3,40\n", soil.display())
    };
    let rows: Vec<String> = (0..12).map(row).collect();
    let there_and_back: String = rows.iter().chain(rows.iter().rev()).cloned().collect();
    let (_, together) = solve(&folder, &format!("{header}{there_and_back}"));
    let solved: Vec<&str> = together.lines().skip(1).collect();
    assert_eq!(solved.len(), 24);
    for (place, row) in rows.iter().enumerate() {
        let (_, alone) = solve(&folder, &format!("{header}{row}"));
        let alone = alone.lines().nth(1).unwrap();
        assert_eq!((solved[place], solved[23 - place]), (alone, alone));
    }
}

/// Rows with numbers of the soil are the rows on soil files with these numbers; an empty field is the soil's own, and a bad one
/// concerns its row alone.
#[test]
fn a_row_may_have_its_own_numbers_of_the_soil() {
    let folder = Folder::new();
    let numbers = "n,cohesion_kpa,phi_deg,k_shear_m,k_c_kn_per_m_n1,k_phi_kn_per_m_n2,c_1,c_2";
    let rows = [
        // by load, by sinkage, braked, drifting: all but the first two by the general solver
        ("0.3,,40,0", "0.9,0.5,33,0.02,1.2,1400,0.2,0.3"),
        ("0.3,0.01,,0", "1.25,2,28,0.03,0.5,1600,0.25,0.25"),
        ("-0.2,,40,0", "1.2,1.5,31,0.021,0.8,1500,0.2,0.3"),
        ("0.3,,40,10", "1.05,1.5,31,0.021,0.8,1500,0.2,0.3"),
    ];
    let header = "soil,radius_m,width_m,slip,sinkage_m,load_n,slip_angle_deg";
    let mut columns = format!("{header},{numbers}\n");
    let mut files = format!("{header}\n");
    for (place, (point, own)) in rows.iter().enumerate() {
        let mut text = String::from("format = 1\nname = \"soil\"\n");
        for (key, value) in numbers.split(',').zip(own.split(',')) {
            writeln!(text, "{key} = {value}").unwrap();
        }
        let soil = folder.file(&format!("soil-{place}.toml"), &text);
        let point = format!("0.1,0.1,{point}");
        writeln!(files, "{},{point}", soil.display()).unwrap();
        writeln!(columns, "dry-sand,{point},{own}").unwrap();
    }
    let (files, _) = solve(&folder, &files);
    let (columns, _) = solve(&folder, &columns);
    for (there, here) in files.iter().zip(&columns) {
        assert_eq!((&*there["status"], &*here["status"]), ("ok", "ok"));
        assert_eq!(there["cautions"], here["cautions"]);
        for column in [
            "sinkage_m",
            "vertical_force_n",
            "drawbar_pull_n",
            "torque_nm",
        ] {
            let off = number(here, column) / number(there, column) - 1.0;
            assert!(off.abs() < 1e-9, "{column} {off:e}");
        }
    }
    assert!(number(&columns[2], "sinkage_m") > 1.2 * number(&columns[0], "sinkage_m"));

    let text = "soil,radius_m,width_m,slip,load_n,phi_deg\ndry-sand,0.1,0.1,0.3,40,\ndry-sand,0.1,0.1,0.3,40,95\n\
                dry-sand,0.1,0.1,0.3,40,30\n";
    let (rows, _) = solve_to(&folder, text, 3);
    assert_eq!(rows[0]["drawbar_pull_n"], rows[2]["drawbar_pull_n"]); // 30° are the sand's own
    assert!(
        rows[1]["status"].contains("`phi_deg` is 95 deg"),
        "{rows:?}"
    );
}
