//! Proof logs beside the checker: it accepts what was written, and refuses every log in which a part was changed.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test stops at the first surprise, prints what it measured, and picks places in lists"
)]

use std::fmt::Write as _;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Command;

use grouser_opt::{
    CertifySettings, CertifyStatus, Exact, Functions, Method, Problem, ProblemParams, Variable,
    certify_with,
};
use grouser_real::Scalar;

use crate::certified_fronts::{BinhKorn, Grouped, Nowhere, boxed, certified};
use crate::random_starts::Stream;

/// Charalambous & Conn 1978.
struct Cb2;
impl Functions for Cb2 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let two = R::from_f64(2.0);
        f[0] = x[0].square() + x[1].powi(4);
        f[1] = (two - x[0]).square() + (two - x[1]).square();
        f[2] = two * (x[1] - x[0]).exp();
    }
}

/// Every operation of a tape at least once, and a constraint.
struct Everything;
impl Functions for Everything {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let (a, b, one) = (x[0], x[1], R::ONE);
        let smooth =
            a.sin() * b.cos() + (a * R::from_f64(0.3)).tan() + (b * R::from_f64(0.4)).asin();
        let more =
            (b * R::from_f64(0.3)).acos() + a.atan() + b.sinh() * R::from_f64(0.1) + a.cosh();
        let roots =
            (a + R::from_f64(2.5)).sqrt() + (b + R::from_f64(3.0)).ln() + a.tanh() + a.exp_m1();
        let powers =
            (a + R::from_f64(3.0)).powf(b * R::from_f64(0.2)) + (a + R::from_f64(4.0)).powi(-2);
        let kinks = (a - b).abs() + a.max(b * b) - a.min(b) + (b * R::from_f64(0.1)).ln_1p();
        f[0] = smooth
            + more
            + roots
            + powers
            + kinks
            + (a + R::from_f64(3.0)).atan2(b + R::from_f64(4.0));
        f[1] = -(a / (b + R::from_f64(5.0))) - (-one).exp();
        f[2] = a + b * b - one;
    }
}

/// The distance of a quotient with a pole in the box from three numbers.
struct Quotients;
impl Functions for Quotients {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (f, (t, y)) in f.iter_mut().zip([(0.5, 0.3), (1.0, 0.5), (2.0, 0.6)]) {
            let t = R::from_f64(t);
            *f = (x[0] + t) / (x[1] + t * t) - R::from_f64(y);
        }
    }
}

/// sin(x y)/x, whose dividend vanishes with its divisor, beside a plane.
struct Limit;
impl Functions for Limit {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[1] / x[0] * (x[0] * x[1]).sin() - R::ONE;
        f[1] = x[1] / (x[0] * x[0]) * x[0].powi(3) - x[1];
    }
}

/// Poles in objectives without their opposites, which cancel in a pair of them.
struct Poles;
impl Functions for Poles {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let pole = x[0] / (x[0] + R::from_f64(0.1));
        f[0] = x[0].square() + x[1].square() + pole;
        f[1] = (x[1] - R::ONE).square() - pole;
    }
}

fn quotients() -> Problem<'static> {
    let params = ProblemParams::new(&[0.1, 0.2], 3, Exact(Quotients)).absolute(3);
    let sides = ["x", "y"].map(|name| Variable::bounded(name, 0.1, -6.0, 6.0));
    Problem::new(params.variables(sides)).unwrap()
}

fn problem(
    functions: impl Functions + 'static,
    side: f64,
    limits: usize,
    objectives: usize,
) -> Problem<'static> {
    let params = ProblemParams::new(&[0.1, 0.2], objectives, Exact(functions))
        .variables(["x", "y"].map(|name| Variable::bounded(name, 0.1, -side, side)))
        .inequalities((0..limits).map(|i| format!("limit {i}")));
    Problem::new(params).unwrap()
}

fn proof(problem: &Problem<'_>, gap: f64) -> (CertifyStatus, Vec<String>) {
    let mut lines = Vec::new();
    let mut settings = CertifySettings::default();
    settings.gap = gap;
    settings.max_boxes = 20_000;
    let certificate = certify_with(
        problem,
        &Method::Minimax,
        &settings,
        &mut |_| ControlFlow::Continue(()),
        Some(&mut |line: &str| {
            lines.push(line.to_owned());
            ControlFlow::Continue(())
        }),
    )
    .unwrap();
    (certificate.status, lines)
}

/// Is there a Python? Under CI there must be one.
pub(crate) fn python() -> bool {
    let found = Command::new("python3")
        .arg("--version")
        .output()
        .is_ok_and(|o| o.status.success());
    assert!(
        found || std::env::var("CI").is_err(),
        "the checker needs python3"
    );
    if !found {
        println!("skipped: no python3");
    }
    found
}

/// What the checker says of each log.
pub(crate) fn verdicts(folder: &Path, logs: &[Vec<String>]) -> Vec<String> {
    fs::create_dir_all(folder).unwrap();
    let paths: Vec<PathBuf> = logs
        .iter()
        .enumerate()
        .map(|(index, lines)| {
            let path = folder.join(format!("{index}.jsonl"));
            fs::write(&path, lines.join("\n") + "\n").unwrap();
            path
        })
        .collect();
    let checker = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../checker/check.py");
    let output = Command::new("python3")
        .arg(checker)
        .args(&paths)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let _ = fs::remove_dir_all(folder);
    text.lines().map(str::to_owned).collect()
}

pub(crate) fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("grouser-proofs-{name}-{}", std::process::id()))
}

#[test]
fn the_checker_accepts_what_is_proved() {
    if !python() {
        return;
    }
    let cases = [
        (problem(Cb2, 4.0, 0, 3), 1e-6, CertifyStatus::Proved),
        (problem(Cb2, 1.0, 1, 2), 1e-6, CertifyStatus::Infeasible),
        (problem(Everything, 1.5, 1, 2), 1e-3, CertifyStatus::Proved),
        (quotients(), 1e-6, CertifyStatus::Proved),
        (problem(Limit, 4.0, 0, 2), 1e-4, CertifyStatus::Proved),
        (problem(Poles, 4.0, 0, 2), 1e-6, CertifyStatus::Proved),
    ];
    let mut table = String::new();
    let logs: Vec<Vec<String>> = cases
        .iter()
        .map(|(problem, gap, expected)| {
            let (status, lines) = proof(problem, *gap);
            assert_eq!(status, *expected);
            let count = |part: &str| lines.iter().filter(|line| line.contains(part)).count();
            let _ = writeln!(
                table,
                "leaves {:>4}  by tangents {:>3}  without divisors {:>4}",
                count("\"weights\""),
                count("\"tangent\""),
                count("\"cleared\"")
            );
            lines
        })
        .collect();
    insta::assert_snapshot!(table);
    for verdict in verdicts(&folder("accepted"), &logs) {
        println!("{verdict}");
        assert!(verdict.starts_with("accepted"), "{verdict}");
    }
}

/// The number that follows `key` in a line, replaced.
fn with_number(line: &str, key: &str, change: impl Fn(f64) -> f64) -> Option<String> {
    let start = line.find(key)? + key.len();
    let length = line[start..].find([',', ']', '}'])?;
    let number: f64 = line[start..start + length].parse().ok()?;
    Some(format!(
        "{}{:?}{}",
        &line[..start],
        change(number),
        &line[start + length..]
    ))
}

/// One part of a log changed so that it proves less than it claims; `None` where this line has no such part.
fn mutilated(log: &[String], kind: usize, stream: &mut Stream) -> Option<Vec<String>> {
    let mut lines = log.to_vec();
    let pick = |stream: &mut Stream, count: usize| (stream.next() * count as f64) as usize;
    let inner = 1 + pick(stream, log.len() - 2);
    let last = log.len() - 1;
    let size = 0.01 + stream.next();
    match kind {
        // a box is missing
        0 => drop(lines.remove(inner)),
        // a box occurs twice
        1 => lines.insert(inner, lines[inner].clone()),
        // a bound is higher than its multipliers prove: those of limits alone exclude a box, whatever is claimed
        2 if !["[[0,", "[[1,"]
            .iter()
            .any(|objective| log[inner].contains(objective)) =>
        {
            return None;
        }
        2 => {
            lines[inner] = with_number(&log[inner], "\"bound\":", |b| {
                // a claim is capped at what the gap needs: the bound itself may be higher by far
                b + 1e6 * (1.0 + size)
            })?;
        }
        // a box is divided outside itself
        3 => lines[inner] = with_number(&log[inner], "\"at\":", |at| at + 100.0 * size)?,
        // a part of a divided box has the number of another
        4 => lines[inner] = with_number(&log[inner], "\"into\":[", |_| 0.0)?,
        // a multiplier of an inequality is negative
        5 => lines[inner] = with_number(&log[inner], "\"weights\":[[0,", |w| -w)?,
        // a bound without multipliers
        6 => {
            let start = log[inner].find("\"weights\":")?;
            lines[inner] = format!("{}\"weights\":[]}}", &log[inner][..start]);
        }
        // the end claims a better bound, a better point, another point
        7 => lines[last] = with_number(&log[last], "\"lower\":", |b| b + 1e-3 * size)?,
        8 => lines[last] = with_number(&log[last], "\"upper\":", |b| b - 1e-3 * size)?,
        9 => lines[last] = with_number(&log[last], "\"x\":[", |x| x + 0.1 * size)?,
        // another problem: a constant, an exponent
        10 => lines[0] = with_number(&log[0], "[\"const\",", |c| c + size)?,
        11 => lines[0] = log[0].replacen("[\"powi\",1,4]", "[\"powi\",1,2]", 1),
        // the log breaks off
        12 => lines.truncate(inner),
        // the curvature of a tangent is positive, its point none
        15 => lines[inner] = with_number(&log[inner], "],-", |c| c)?.replacen("],-", "],", 1),
        16 => lines[inner] = log[inner].replacen("\"tangent\":[[", "\"tangent\":[[null,", 1),
        // a bound of second order without its tangent
        17 => lines[inner] = log[inner].replacen("tangent", "secant", 1),
        // a bound without divisors that is said to be one of the rows themselves
        18 => lines[inner] = log[inner].replacen("cleared", "clear", 1),
        // a variable is none of the problem's
        13 => lines[inner] = with_number(&log[inner], "\"divide\":", |d| d + 7.0)?,
        // a box that never was
        _ => lines[inner] = with_number(&log[inner], "\"box\":", |id| id + 1e6)?,
    }
    (lines != log).then_some(lines)
}

#[test]
fn the_checker_refuses_mutilated_logs() {
    if !python() {
        return;
    }
    // one box with a tangent, many boxes, and boxes with poles
    let originals = [
        proof(&problem(Cb2, 4.0, 0, 3), 1e-6),
        proof(&problem(Everything, 1.5, 1, 2), 1e-3),
        proof(&quotients(), 1e-6),
    ];
    let count = originals.len();
    assert!(originals.iter().all(|o| o.0 == CertifyStatus::Proved));
    assert!(originals[0].1.len() < 50 && originals[1].1.len() > 100);
    assert!(originals[0].1.iter().any(|line| line.contains("tangent")));
    assert!(originals[2].1.iter().any(|line| line.contains("cleared")));
    let mut stream = Stream(2012);
    let mut logs: Vec<Vec<String>> = originals.iter().map(|o| o.1.clone()).collect();
    let mut kinds = Vec::new();
    for (kind, (_, log)) in (0..19).cycle().zip(originals.iter().cycle()) {
        if logs.len() >= 100 + count {
            break;
        }
        // a part that this line does not have is looked for in another one
        if let Some(lines) = (0..50).find_map(|_| mutilated(log, kind, &mut stream)) {
            logs.push(lines);
            kinds.push(kind);
        }
    }
    let verdicts = verdicts(&folder("mutilated"), &logs);
    assert_eq!(verdicts.len(), 100 + count);
    for verdict in &verdicts[..count] {
        assert!(verdict.starts_with("accepted"), "{verdict}");
    }
    for (verdict, kind) in verdicts[count..].iter().zip(&kinds) {
        assert!(
            verdict.starts_with("refused"),
            "mutilation {kind}: {verdict}"
        );
    }
    println!(
        "100 of 100 mutilated logs refused, of {:?} lines",
        originals.iter().map(|o| o.1.len()).collect::<Vec<_>>()
    );
}

/// Logs of fronts: with constraints, with a group of objectives, without a feasible point.
fn fronts() -> Vec<Vec<String>> {
    let binh_korn = boxed(BinhKorn, &[(0.0, 5.0), (0.0, 3.0)], 2)
        .inequalities(["first".to_owned(), "second".to_owned()]);
    let grouped = boxed(Grouped, &[(-1.0, 3.0), (-2.0, 2.0)], 3);
    let nowhere = boxed(Nowhere, &[(0.0, 1.0); 2], 2).inequalities(["never".to_owned()]);
    let cases = [
        (binh_korn, vec![0, 1]),
        (grouped, vec![0, 0, 1]),
        (nowhere, vec![0, 1]),
    ];
    let logs = cases.into_iter().map(|(params, groups)| {
        let mut log = Vec::new();
        certified(&Problem::new(params).unwrap(), &groups, 0.1, &mut log);
        log
    });
    logs.collect()
}

/// The joining of a front's proofs changed so that it proves less than it claims.
fn unjoined(log: &[String], kind: usize, stream: &mut Stream) -> Option<Vec<String>> {
    let mut lines = log.to_vec();
    let begins: Vec<usize> = (0..log.len())
        .filter(|at| log[*at].starts_with("{\"least\""))
        .collect();
    let last = log.len() - 1;
    let pick = |stream: &mut Stream, count: usize| (stream.next() * count as f64) as usize;
    // a cut, and where the next one begins
    let cut = 2 + pick(stream, begins.len() - 2);
    let ends = |cut: usize| begins.get(cut + 1).copied().unwrap_or(last);
    let (first, end) = (begins[cut], ends(cut));
    let size = 0.01 + stream.next();
    match kind {
        // a cut is missing, or one of the first two proofs
        0 => drop(lines.drain(first..end)),
        1 => drop(lines.drain(begins[cut % 2]..ends(cut % 2))),
        // the announcement of a cut is missing, or its proof
        2 => drop(lines.remove(first)),
        3 => drop(lines.drain(first + 1..end)),
        // a cut at another value, of another objective, of a corner that is none
        4 => lines[first] = with_number(&log[first], "\"at\":", |at| at + size)?,
        5 if log[first].contains("\"least\":0") => {
            lines[first] = log[first].replacen("\"least\":0", "\"least\":1", 1);
        }
        5 => lines[first] = log[first].replacen("\"least\":1", "\"least\":0", 1),
        6 => lines[first] = with_number(&log[first], "\"corner\":[", |c| c - size)?,
        // the proof of another cut
        7 => {
            let other = 2 + (cut - 1) % (begins.len() - 2);
            let proof = log[begins[other] + 1..ends(other)].to_vec();
            drop(lines.splice(first + 1..end, proof));
        }
        // the proof of one objective alone, which has no limit
        8 => {
            let proof = log[begins[1] + 1..ends(1)].to_vec();
            drop(lines.splice(first + 1..end, proof));
        }
        // a cut is said to be of the whole problem
        9 => {
            let least = &log[first][..log[first].find(",\"corner\"")?];
            lines[first] = format!("{least},\"corner\":null,\"at\":null}}");
        }
        // the proof of a cut without a constraint, in another box
        10 => lines[first + 1] = log[first + 1].replacen("[\"at_most\"", "[\"objective\"", 1),
        11 => {
            lines[first + 1] = with_number(&log[first + 1], "\"lower\":[", |low| low + 0.1 * size)?;
        }
        // the end: a corner is missing, or higher than what is proved
        12 => {
            let start = log[last].find("\"corners\":[")? + 11;
            let rest = &log[last][start + 1..];
            let next = rest.find("],[")? + 2;
            lines[last] = format!("{}{}", &log[last][..start], &rest[next..]);
        }
        13 => lines[last] = with_number(&log[last], "\"corners\":[[", |c| c + 1e-3 * size)?,
        // a point that is better than it can be, or elsewhere, or missing
        14 => lines[last] = with_number(&log[last], "],[", |level| level - 1e-3 * size)?,
        15 => lines[last] = with_number(&log[last], "\"points\":[[[", |x| x + 0.1 * size)?,
        16 => {
            let (start, end) = (
                log[last].find("\"points\":")?,
                log[last].find(",\"corners\"")?,
            );
            lines[last] = format!("{}\"points\":[]{}", &log[last][..start], &log[last][end..]);
        }
        // a smaller tolerance
        17 => lines[last] = with_number(&log[last], "\"tolerance\":[", |t| 0.5 * t)?,
        // no end, no beginning
        18 => drop(lines.pop()),
        19 => drop(lines.remove(0)),
        // another end
        _ => lines[last] = log[last].replacen("\"proved\"", "\"infeasible\"", 1),
    }
    (lines != log).then_some(lines)
}

#[test]
fn the_checker_replays_how_the_proofs_of_a_front_are_joined() {
    if !python() {
        return;
    }
    let originals = fronts();
    let count = originals.len();
    let mut stream = Stream(2012);
    let mut logs = originals.clone();
    let mut kinds = Vec::new();
    for (kind, log) in (0..21).cycle().zip(originals[..2].iter().cycle()) {
        if logs.len() >= 100 + count {
            break;
        }
        if let Some(lines) = (0..50).find_map(|_| unjoined(log, kind, &mut stream)) {
            logs.push(lines);
            kinds.push(kind);
        }
    }
    let verdicts = verdicts(&folder("fronts"), &logs);
    assert_eq!(verdicts.len(), 100 + count);
    for verdict in &verdicts[..count] {
        println!("{verdict}");
        assert!(verdict.starts_with("accepted"), "{verdict}");
    }
    for (verdict, kind) in verdicts[count..].iter().zip(&kinds) {
        println!("{kind}: {verdict}");
        assert!(
            verdict.starts_with("refused"),
            "mutilation {kind}: {verdict}"
        );
    }
}
