//! Tables that are empty, ragged, foreign or broken. Each gives an error that names line and
//! column, and never a part of the log as if it were the whole.

use std::io::Write;

use grouser_log::csv::{LINE_LIMIT, Lines, finite};
use grouser_log::{Cell, Error, Log};
use grouser_slip::Measurement;

use crate::scratch::{Folder, map, read};

const GOOD: &str = "t,n,g\n0,1,0.5\n0.1,2,0.25\n";

fn at(error: &Error) -> (u64, Option<usize>) {
    let cell: &Cell = match error {
        Error::Unreadable { at, .. }
        | Error::LongLine { at, .. }
        | Error::Malformed { at, .. }
        | Error::Ragged { at, .. }
        | Error::NoColumn { at, .. }
        | Error::TwoColumns { at }
        | Error::NotANumber { at, .. }
        | Error::OutOfOrder { at, .. } => at,
        _ => return (0, None),
    };
    (cell.line, cell.column)
}

#[test]
fn the_good_one_is_read() {
    let records = read("good", "", GOOD.as_bytes()).unwrap();
    let readings: Vec<_> = records.iter().map(|r| (r.time_ns, r.measurement)).collect();
    assert_eq!(
        readings,
        [
            (0, Measurement::WheelCount { wheel: 0, raw: 1 }),
            (0, Measurement::YawRate { rate: 0.5 }),
            (100_000_000, Measurement::WheelCount { wheel: 0, raw: 2 }),
            (100_000_000, Measurement::YawRate { rate: 0.25 }),
        ]
    );
}

#[test]
fn empty_and_header_only() {
    for (text, what) in [
        ("", "nothing"),
        ("t,n,g\n", "a header and no data"),
        ("t,n,g", "a header and no data"),
        ("t,n,g\n\n\n", "a header and no data"),
    ] {
        match read("empty", "", text.as_bytes()).unwrap_err() {
            Error::Empty { what: found, .. } => assert_eq!(found, what),
            other => panic!("{text:?}: {other}"),
        }
    }
    let short = read("short", "header_lines = 3\nnames_line = 1", b"t,n,g\n").unwrap_err();
    assert!(matches!(
        short,
        Error::Empty {
            what: "less than its header",
            ..
        }
    ));
}

#[test]
fn byte_order_marks() {
    let marked = format!("\u{feff}{GOOD}");
    assert_eq!(read("bom", "", marked.as_bytes()).unwrap().len(), 4);
    let utf_16: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let error = read("utf16", "", &utf_16).unwrap_err();
    assert!(matches!(error, Error::Malformed { .. }), "{error}");
    assert_eq!(at(&error), (1, None));
}

#[test]
fn line_ends_mixed() {
    let mixed = "t,n,g\r\n0,1,0.5\n0.1,2,0.25\r\n0.2,3,0";
    assert_eq!(read("crlf", "", mixed.as_bytes()).unwrap().len(), 6);
    let old_mac = "t,n,g\n0,1,0.5\r0.1,2,0.25\r";
    let error = read("cr", "", old_mac.as_bytes()).unwrap_err();
    assert!(matches!(error, Error::Malformed { .. }));
    assert_eq!(at(&error).0, 2);
}

#[test]
fn semicolons_and_decimal_commas_only_where_declared() {
    let german = "t;n;g\n0;1;0,5\n0,1;2;0,25\n";
    let declared = "separator = \";\"\ndecimal = \",\"";
    let records = read("german", declared, german.as_bytes()).unwrap();
    assert_eq!(records, read("english", "", GOOD.as_bytes()).unwrap());
    // Not declared: the separator is missed in the header, the decimal mark in its cell.
    let error = read("undeclared", "", german.as_bytes()).unwrap_err();
    assert!(matches!(error, Error::NoColumn { .. }));
    let error = read("comma", "separator = \";\"", german.as_bytes()).unwrap_err();
    assert!(matches!(error, Error::NotANumber { .. }));
    assert_eq!(at(&error), (2, Some(3)));
    assert!(error.hint().unwrap().contains("decimal"));
    // Declared, and the other way round.
    let english = "t;n;g\n0;1;0.5\n";
    let error = read("point", declared, english.as_bytes()).unwrap_err();
    assert_eq!(at(&error), (2, Some(3)));
}

#[test]
fn ragged_rows() {
    for (row, found) in [("0.2,3", 2), ("0.2,3,4,5", 4), ("0.2", 1), (",,,", 4)] {
        let error = read("ragged", "", format!("{GOOD}{row}\n").as_bytes()).unwrap_err();
        match error {
            Error::Ragged {
                at,
                found: f,
                expected: 3,
            } => assert_eq!((at.line, f), (4, found)),
            other => panic!("{other}"),
        }
    }
}

#[test]
fn a_row_whose_time_is_garbled_is_left_out_and_counted() {
    for bad in ["", "nan", "1e30", "9999999999999", "x", "0.1.5"] {
        let folder = Folder::new("garbled");
        let text = format!("{GOOD}{bad},3,0\n0.3,4,0.5\n");
        let log = Log::find(&[folder.file("log.csv", text.as_bytes())], map("")).unwrap();
        // as often as it is read
        for _ in 0..2 {
            let samples = log.samples(&[]).unwrap().map(Result::unwrap);
            assert_eq!(samples.count(), 6, "{bad}");
            let left_out = log.left_out();
            assert_eq!(left_out.undecoded, 1, "{bad}");
            let problem = left_out.problem.unwrap();
            assert!(problem.contains("line 4, column 1 `t`"), "{problem}");
        }
    }
    // another log in the same file is no garbled time
    let twice = format!("{GOOD}{GOOD}");
    assert_eq!(at(&read("twice", "", twice.as_bytes()).unwrap_err()).0, 4);
}

#[test]
fn a_last_line_that_is_cut_off_is_left_out() {
    for (end, is_row) in [
        ("0", false),
        ("0.2,3", false),
        ("0.2,\"3,0.1", false),
        ("0.2,3,-", false),
        ("0.2,3,0.\u{0}", false),
        ("0.2,3,0.5", true),
        ("", true),
    ] {
        let folder = Folder::new("cut");
        let file = folder.file("log.csv", format!("{GOOD}{end}").as_bytes());
        let log = Log::find(&[file], map("")).unwrap();
        // as often as it is read
        for _ in 0..2 {
            let times = log
                .samples(&[])
                .unwrap()
                .map(|sample| sample.unwrap().time_ns);
            let rows = times.filter(|time| *time <= 100_000_000).count();
            assert_eq!(rows, 4, "{end}");
            let cut: Vec<u64> = log.left_out().cut_off.iter().map(|at| at.line).collect();
            assert_eq!(cut, if is_row { vec![] } else { vec![4] }, "{end}");
        }
    }
    let cut = "t,n,g\n0,1,0.5\n0.1,\u{e4}";
    let cut = &cut.as_bytes()[..cut.len() - 1];
    assert_eq!(read("cut-letter", "", cut).unwrap().len(), 2);
    // in the middle it is damage, and so is a single row
    for text in ["t,n,g\n0,1,0.5\n0.1\n0.2,3,0.5", "t,n,g\n0,1"] {
        let error = read("middle", "", text.as_bytes()).unwrap_err();
        assert!(matches!(error, Error::Ragged { .. }), "{error}");
    }
}

#[test]
fn a_line_that_is_no_row_has_a_hint() {
    let hint = |line: &str| {
        let text = format!("{GOOD}{line}\n0.3,4,0.5\n");
        let error = read("hint", "", text.as_bytes()).unwrap_err();
        assert_eq!(at(&error).0, 4);
        error.hint().unwrap()
    };
    assert!(hint("t,n,g").contains("the header is repeated"));
    assert!(hint("# a comment").contains("comment"));
    assert!(hint("0.2,nan,0.5").contains("`missing`"));
    assert!(hint("0.2,3,NaN").contains("`missing`"));
}

#[test]
fn quotes() {
    let quoted = "\"t\",\"n\",\"g\"\n\"0\",\"1\",\"0.5\"\n";
    assert_eq!(read("quoted", "", quoted.as_bytes()).unwrap().len(), 2);
    for (row, column) in [
        ("0.2,\"3,0.1", 2),
        ("\"0.2,3,0.1", 1),
        ("0.2,3,\"", 3),
        ("\"0\"2,3,1", 1),
    ] {
        let error = read("open", "", format!("{GOOD}{row}\n").as_bytes()).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{row}: {error}");
        assert_eq!(at(&error), (4, Some(column)), "{row}");
    }
    // Open until the end of the file: the line where it opened is named.
    let error = read("eof", "", b"t,n,g\n0,1,\"0.5\n0.1,2,0.25\n").unwrap_err();
    assert_eq!(at(&error), (2, Some(3)));
}

#[test]
fn nul_bytes_and_other_text() {
    let error = read("nul", "", b"t,n,g\n0,1,0.5\n0.1,2,0.\x005\n").unwrap_err();
    assert!(matches!(error, Error::Malformed { .. }));
    assert_eq!(at(&error).0, 3);
    let error = read("latin1", "", b"t,n,g\n0,1,0.5\n0.1,\xe4,0.5\n").unwrap_err();
    assert!(matches!(error, Error::Malformed { .. }));
    assert_eq!(at(&error).0, 3);
}

#[test]
fn a_line_of_100_mb_is_not_held() {
    let folder = Folder::new("long");
    let path = folder.0.join("log.csv");
    let mut file = std::fs::File::create(&path).unwrap();
    file.write_all(GOOD.as_bytes()).unwrap();
    let chunk = vec![b'7'; 1 << 20];
    for _ in 0..100 {
        file.write_all(&chunk).unwrap();
    }
    drop(file);
    let log = grouser_log::Log::find(&[path], map("")).unwrap();
    let before = allocation_counter::measure(|| {
        let error = log.samples(&[]).unwrap().find_map(Result::err).unwrap();
        assert!(matches!(
            error,
            Error::LongLine {
                limit: LINE_LIMIT,
                ..
            }
        ));
        assert_eq!(at(&error), (4, None));
    });
    // The line's buffer may have doubled past the limit, no further.
    assert!(
        before.bytes_max < 4 * LINE_LIMIT as u64,
        "{}",
        before.bytes_max
    );
}

#[test]
fn columns_twice_and_missing() {
    let error = read("twice", "", b"t,n,g,n\n0,1,0.5,2\n").unwrap_err();
    assert!(matches!(error, Error::TwoColumns { .. }));
    assert_eq!(at(&error), (1, Some(4)));
    // A column that nobody reads may be there twice.
    assert_eq!(
        read("other", "", b"t,n,g,x,x\n0,1,0.5,2,2\n")
            .unwrap()
            .len(),
        2
    );
    let error = read("missing", "", b"t,m,g\n0,1,0.5\n").unwrap_err();
    assert!(
        matches!(&error, Error::NoColumn { column, .. } if column == "n"),
        "{error}"
    );
    assert_eq!(at(&error).0, 1);
}

#[test]
fn numbers_that_are_none() {
    for bad in [
        "1e999", "-1e999", "nan", "NaN", "inf", "abc", "1,234.5", "1 000", "0x1F", "--1", "1e",
    ] {
        let row = format!("{GOOD}0.2,3,\"{bad}\"\n");
        let error = read("numbers", "", row.as_bytes()).unwrap_err();
        match &error {
            Error::NotANumber { found, .. } => assert_eq!(found, bad),
            other => panic!("{bad}: {other}"),
        }
        assert_eq!(at(&error), (4, Some(3)), "{bad}");
    }
    for bad in ["1.5", "1e3", "x", "99999999999999999999"] {
        let error = read("counts", "", format!("{GOOD}0.2,{bad},0\n").as_bytes()).unwrap_err();
        assert_eq!(at(&error), (4, Some(2)), "{bad}");
    }
    for bad in ["", "nan", "1e30", "9999999999999", "x"] {
        let error = read("times", "", format!("t,n,g\n{bad},3,0\n").as_bytes()).unwrap_err();
        assert_eq!(at(&error), (2, Some(1)), "{bad}");
    }
    // Declared as missing, or empty: no reading, and no error.
    let with_gaps = format!("{GOOD}0.2,nan,\n");
    assert_eq!(
        read("gaps", "missing = [\"nan\"]", with_gaps.as_bytes())
            .unwrap()
            .len(),
        4
    );
}

#[test]
fn every_truncation_is_an_error_or_the_rows_that_are_whole() {
    // Cut anywhere: what is read without an error is a prefix of the whole, but for a last number that
    // the cut has shortened, which no reader of text can know.
    let whole = read("whole", "", GOOD.as_bytes()).unwrap();
    for length in 0..GOOD.len() {
        if let Ok(records) = read("cut", "", &GOOD.as_bytes()[..length]) {
            let sure = records.len().saturating_sub(1);
            assert_eq!(records[..sure], whole[..sure], "{length}");
        }
    }
}

#[test]
fn lines_have_their_number_their_bytes_and_a_limit() {
    let longest = "a".repeat(LINE_LIMIT);
    for (end, more, is_read) in [
        ("\n", "", true),
        ("\r\n", "", true),
        ("", "", true),
        ("\n", "b", false),
    ] {
        let text = format!("first\r\n{longest}{more}{end}");
        let mut lines = Lines::over(text.as_bytes(), "lines");
        assert!(lines.advance().unwrap());
        assert_eq!(
            (lines.number(), lines.bytes(), lines.text().unwrap()),
            (1, 7, "first")
        );
        let done = lines.advance();
        assert_eq!(done.is_ok(), is_read, "{done:?}");
        assert_eq!((lines.number(), lines.bytes()), (2, text.len() as u64));
        if is_read {
            assert!(lines.text().unwrap() == longest);
        } else {
            assert!(matches!(
                done,
                Err(Error::LongLine {
                    limit: LINE_LIMIT,
                    ..
                })
            ));
        }
    }
}

#[test]
fn why_a_line_is_no_text() {
    let why = |bytes: &[u8]| {
        let mut lines = Lines::over(bytes, "lines");
        while lines.advance().unwrap() {
            if let Err(Error::Malformed { at, what }) = lines.text() {
                return (at.line, what);
            }
        }
        panic!("{bytes:?} is text")
    };
    for (bytes, line, what) in [
        (&b"\xff\xfea\0"[..], 1, "is UTF-16, but must be UTF-8"),
        (b"\xfe\xff\0a", 1, "is UTF-16, but must be UTF-8"),
        (b"a\n\xff\xfe\n", 2, "is not UTF-8 text"),
        (b"a\0b", 1, "holds a NUL byte"),
        (b"a\rb", 1, "holds a carriage return that does not end it"),
    ] {
        assert_eq!(why(bytes), (line, what));
    }
    let hint = |text, decimal| finite(text, decimal).unwrap_err().hint.unwrap_or_default();
    assert!(hint("1,5", b'.').contains("decimal comma"));
    assert!(hint("1.5", b',').contains("the column map says"));
    assert!(hint("nan", b'.').contains("missing"));
    assert_eq!(hint("fast", b'.'), "");
}

#[test]
fn a_bad_field_is_named_by_its_column() {
    let error = read("named", "", b"t,n,,g\n0,1,,x\n")
        .unwrap_err()
        .to_string();
    assert!(error.contains("line 2, column 4 `g`"), "{error}");
    // a mark that is open in a column without a name
    let error = read("nameless", "", b"t,n,,g\n0,1,\",1\n")
        .unwrap_err()
        .to_string();
    assert!(error.contains("line 2, column 3: "), "{error}");
}
