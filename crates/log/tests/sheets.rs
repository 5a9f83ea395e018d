//! What a table holds without a column map: layouts, columns, times and counters, counted by hand.

use std::fmt::Write as _;

use grouser_files::columns::Meaning;
use grouser_log::{Error, Sheet, SheetColumn};

use crate::scratch::Folder;

fn sheet(text: &str) -> Result<Sheet, Error> {
    let folder = Folder::new("sheet");
    Sheet::read(&folder.file("log.csv", text.as_bytes()), |_| ())
}

fn names(sheet: &Sheet) -> Vec<&str> {
    sheet.columns.iter().map(|c| c.name.as_str()).collect()
}

fn why(text: &str) -> String {
    sheet(text).unwrap_err().to_string()
}

#[test]
fn columns_are_counted() {
    let text = "time_s,left_ticks,yaw_rate,label\n0,65530,0.5,\n0.1,65534,-0.25,ok\n\n0.2,2,0.5,\n0.3,6,,7\n\
                0.4,10,\n0.6,18\n\"0.5\",14,1.5,x\n";
    let found = sheet(text).unwrap();
    assert_eq!((found.separator, found.decimal), (b',', b'.'));
    assert_eq!((found.header_lines, found.names_line), (1, 1));
    assert_eq!((found.rows, found.ragged), (5, 2));
    let counts = |c: &SheetColumn| (c.numbers, c.empty, c.others, c.falls, c.whole);
    let [time, ticks, rate, label] = &found.columns[..] else {
        panic!("{found:?}")
    };
    assert_eq!(counts(time), (5, 0, 0, 0, false));
    assert_eq!(counts(ticks), (5, 0, 0, 1, true));
    assert_eq!(counts(rate), (4, 1, 0, 1, false));
    assert_eq!(counts(label), (1, 2, 2, 0, true));
    assert_eq!((rate.min, rate.max, rate.max_step), (-0.25, 1.5, 1.0));
    assert_eq!(
        (ticks.min, ticks.max, ticks.max_step),
        (2.0, 65534.0, 65532.0)
    );
    assert_eq!((rate.first.as_str(), label.first.as_str()), ("0.5", "ok"));
    assert_eq!(ticks.wraps_at_bits(), Some(16));
    assert_eq!(found.wheels(), ["left"]);
    assert!(found.has(Meaning::WheelCount) && found.has(Meaning::YawRate));
    assert!(!found.has(Meaning::WheelRate));
    assert_eq!(time.guess, None);
    assert_eq!(label.guess, None);
}

#[test]
fn a_column_that_is_no_number_means_nothing() {
    let found = sheet("t,left_angle,right_angle,yaw_rate\n0,1,x,\n1,2,3,\n").unwrap();
    let guessed: Vec<bool> = found.columns.iter().map(|c| c.guess.is_some()).collect();
    assert_eq!(guessed, [false, true, false, false]);
}

#[test]
fn one_column_has_a_meaning_and_none_is_alone() {
    use Meaning as M;
    let text = "t,odom_x,odom_y,odom_yaw,pose_x,dx,left_angle,left_position\n0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n";
    let found = sheet(text).unwrap();
    let meanings: Vec<_> = found
        .columns
        .iter()
        .map(|c| Some(c.guess.as_ref()?.meaning))
        .collect();
    let pose = [Some(M::PoseX), Some(M::PoseY), Some(M::PoseYaw)];
    assert_eq!(meanings[..4], [[None].as_slice(), &pose].concat());
    // a second pose, a way without its part to the left, a second angle of the wheel
    assert_eq!(meanings[4..], [None, None, Some(M::WheelAngle), None]);
    // nor is a part of a pose whose other parts are not there
    let found = sheet("t,odom_y,odom_yaw\n0,1,2\n1,1,2\n").unwrap();
    assert!(found.columns.iter().all(|column| column.guess.is_none()));
}

#[test]
fn times_have_a_rate_gaps_and_jumps() {
    // 20 ms; back by 10 ms once, then 50; once exactly five times 20; a gap of 1.02 s
    let mut text = String::from("left_ticks,time_ms\n");
    let (mut time, mut last) = (1000, 0);
    for row in 0..101 {
        writeln!(text, "{row},{time}").unwrap();
        last = time;
        time += match row {
            59 => -10,
            60 => 50,
            70 => 100,
            80 => 1020,
            _ => 20,
        };
    }
    let found = sheet(&text).unwrap().time.unwrap();
    assert_eq!((found.column, found.unit), (1, "ms"));
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!(close(found.duration_s, f64::from(last - 1000) * 1e-3));
    assert!(close(found.rate_hz.unwrap(), 50.0));
    assert!(close(found.longest_s, 1.02));
    assert_eq!((found.gaps, found.jumps), (1, 1));
}

#[test]
fn a_clock_counts_on_nearly_always() {
    let table = |rows: usize| {
        let mut text = String::from("time\n");
        for row in 0..rows {
            // the second is before the first
            writeln!(text, "{}", if row == 1 { 0 } else { row + 1 }).unwrap();
        }
        sheet(&text).unwrap()
    };
    assert_eq!(table(49).time, None);
    let found = table(50).time.unwrap();
    assert_eq!((found.jumps, found.duration_s), (1, 49e-3));
    // one row has no interval
    assert_eq!(sheet("time\n1\n").unwrap().time, None);
    // and a time that stands still no rate, nor does it jump
    let still = sheet("time\n1\n1\n1\n2\n").unwrap().time.unwrap();
    assert_eq!((still.rate_hz, still.jumps), (None, 0));
    // the third of five intervals is their median
    let uneven = sheet("time\n0\n5\n7\n10\n11\n15\n").unwrap().time.unwrap();
    assert_eq!(uneven.rate_hz, Some(1.0 / (3.0 * 1e-3)));
    assert_eq!(
        sheet("time\n1\n1\n1\n").unwrap().time.unwrap().rate_hz,
        None
    );
    // what is no number on one row is no clock; the next candidate is
    let found = sheet("stamp,time\nx,0\n1,1\n2,2\n").unwrap();
    assert_eq!(found.time.unwrap().column, 1);
}

#[test]
fn counters_wrap_at_their_width() {
    for (values, bits) in [
        ("250\n3", Some(8)),
        ("3\n250", Some(8)),
        ("127\n-128", Some(8)),
        ("0\n128", None),
        ("0\n129", Some(8)),
        ("255\n0", Some(8)),
        // more than eight bits hold, and a step of less than half of sixteen
        ("256\n0", None),
        ("100\n-129", None),
        ("65535\n0", Some(16)),
        ("-32768\n32767", Some(16)),
        ("65536\n0", None),
        ("4294967295\n3", Some(32)),
        ("4294967296\n3", None),
        ("250.5\n3", None),
    ] {
        let found = sheet(&format!("left_ticks\n{values}\n")).unwrap();
        assert_eq!(found.columns[0].wraps_at_bits(), bits, "{values}");
    }
}

#[test]
fn layouts_are_seen() {
    for (text, separator, decimal) in [
        ("t;n;g\n0,5;1;0,25\n", b';', b','),
        ("t;n;g\n0.5;1;0.25\n", b';', b'.'),
        ("t\tn\n0,5\t1\n", b'\t', b','),
        ("t|n\n0.5|1\n", b'|', b'.'),
        ("t n\n0.5 1\n", b' ', b'.'),
        ("t,n\n0.5,1\n\n\n", b',', b'.'),
        ("t\n5\n", b',', b'.'),
    ] {
        let found = sheet(text).unwrap();
        assert_eq!(
            (found.separator, found.decimal),
            (separator, decimal),
            "{text}"
        );
        assert_eq!((found.header_lines, found.rows), (1, 1), "{text}");
    }
    // a title, names, units: names are the last line whose fields all differ
    let found = sheet("a log of 2012\n\nt,left,right\nms,ticks,ticks\n0,1,2\n20,3,4\n").unwrap();
    assert_eq!((found.header_lines, found.names_line), (4, 3));
    assert_eq!(names(&found), ["t", "left", "right"]);
    assert_eq!(found.wheels(), ["left", "right"]);
    let units: Vec<_> = found
        .columns
        .iter()
        .map(|c| Some(c.guess.as_ref()?.unit))
        .collect();
    assert_eq!(units, [None, Some("tick"), Some("tick")]);
    // a number of three names is a row, of four it is not
    assert!(why("t,2,x\n0,1,2\n").contains("no header line"));
    assert_eq!(sheet("t,2,x,y\n0,1,2,3\n").unwrap().header_lines, 1);
    // empty fields are no names
    assert!(why("t,2,,,\n0,1,2,3,4\n").contains("no header line"));
    assert_eq!(names(&sheet("t,x,\n0,1,2\n").unwrap()), ["t", "x", ""]);
    assert!(why("t,,\n0,1,2\n").contains("no header line"));
    assert!(why("t,x,x\n0,1,2\n").contains("no header line"));
    assert!(why("t,x\n0,1,2\n").contains("no header line"));
}

#[test]
fn headers_are_short() {
    let title = |lines: usize| format!("{}t,n\n0,1\n0,1\n", "title\n".repeat(lines - 1));
    let found = sheet(&title(20)).unwrap();
    assert_eq!(
        (found.header_lines, found.names_line, found.rows),
        (20, 20, 2)
    );
    assert!(why(&title(21)).contains("no header line"));
    assert!(why("").contains("nothing"));
    assert!(why("\n\n").contains("nothing"));
    assert!(why("t,n\n").contains("a header and no data"));
    // numbers alone are rows: the columns have their numbers for names
    let found = sheet("0,1\n0,2\n").unwrap();
    assert_eq!(
        (found.header_lines, found.names_line, found.rows),
        (0, 0, 2)
    );
    assert_eq!(names(&found), ["1", "2"]);
    // by the last two of the first 64 lines
    let rows = |rows: usize| format!("t,n\n{}a;b\na;b\n", "0,1\n".repeat(rows));
    assert!(sheet(&rows(61)).is_err());
    let found = sheet(&rows(62)).unwrap();
    assert_eq!((found.separator, found.rows, found.ragged), (b',', 62, 2));
}

#[test]
fn a_last_row_that_is_cut_off_does_not_decide_the_layout() {
    for (separator, decimal, names) in [
        (b',', b'.', "t,left,right"),
        (b';', b',', "t;left;right"),
        (b'\t', b',', "t\tleft\tright"),
        (b' ', b'.', "t left right"),
        // a row in quotation marks, which a cut leaves open
        (b';', b',', "\"t\";\"left\";\"right\""),
    ] {
        let mark = if names.starts_with('"') { "\"" } else { "" };
        let fields = |time: &str, left: &str, right: &str| {
            let all = [time, left, right].map(|text| {
                let text = text.replace('.', &(decimal as char).to_string());
                format!("{mark}{text}{mark}")
            });
            all.join(&(separator as char).to_string())
        };
        let begin = format!("{names}\n{}\n", fields("0.25", "1.5", "2.5"));
        let row = fields("0.50", "3.5", "4.5");
        for length in 0..=row.len() {
            let text = format!("{begin}{}", &row[..length]);
            let found = sheet(&text).unwrap();
            assert_eq!(
                (found.separator, found.decimal, found.header_lines),
                (separator, decimal, 1),
                "{text}"
            );
            // it is a row once its third field has begun and no quotation mark is open
            let marks = row[..length].matches('"').count();
            let ends = row[..length].matches(separator as char).count();
            // blanks at the end begin no field
            let ends_open = separator == b' ' && row[..length].ends_with(' ');
            let is_row = ends == 2 && marks % 2 == 0 && !ends_open;
            let ragged = u64::from(length > 0 && !is_row);
            assert_eq!(
                (found.rows, found.ragged),
                (1 + u64::from(is_row), ragged),
                "{text}"
            );
            assert_eq!(found.is_cut_off, ragged > 0, "{text}");
        }
    }
    // within a letter, or before the zeros that a disk left
    for end in [&b"0.5,\xc3"[..], b"0.5,1\0\0\0"] {
        let text = [b"t,left\n0.25,1\n", end].concat();
        let folder = Folder::new("cut-sheet");
        let found = Sheet::read(&folder.file("log.csv", &text), |_| ()).unwrap();
        assert_eq!((found.rows, found.ragged, found.is_cut_off), (1, 1, true));
    }
    assert!(!sheet("t,n\n0,1\n0\n0.2,3\n").unwrap().is_cut_off);
    // of two rows the first may be names with numbers in them
    let found = sheet("wheel 1 speed,wheel 2 speed\n0.5,0.75").unwrap();
    assert_eq!((found.separator, found.rows), (b',', 1));
}
