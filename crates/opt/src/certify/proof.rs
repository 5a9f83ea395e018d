//! The proof as lines of JSON, which a checker of its own can replay.
//!
//! The first line holds the problem: the box, the operations of the tape, and the rows. Then comes one line per box:
//! either it is divided, at a place along one variable, into two boxes with numbers of their own, or it is a leaf with
//! its lower bound (`null`: no feasible point) and the multipliers that prove it. The last line holds the result.

use std::fmt::Write as _;
use std::ops::ControlFlow;

use super::bound::Weights;
use super::rows::Rows;
use super::{CertifySettings, WrittenProblem};
use crate::sqp::LinearKind;
use crate::tape::Op;

/// A bound is claimed a little lower than it was computed, so that a checker with another library of elementary
/// functions confirms it: by this, relative to 1 + |bound|, or by a share of the gap that is to be proved.
const CLAIM_SLACK: f64 = 1e-10;
const CLAIM_GAP_SHARE: f64 = 0.02;
/// A leaf with one multiplier.
const FIRST_LEAF_BYTES: u64 = 100;

/// Takes the lines of a proof, without line ends; [`ControlFlow::Break`] stops the search.
pub type ProofSink<'s> = dyn FnMut(&str) -> ControlFlow<()> + 's;

pub(super) struct Proof<'a, 's> {
    pub(super) sink: Option<&'a mut ProofSink<'s>>,
    pub(super) broken: bool,
    /// Written so far.
    pub(super) bytes: u64,
    /// Of the longest leaf.
    pub(super) leaf_bytes: u64,
}

/// A number as JSON reads it back without loss; `null` where it is not finite.
pub(super) fn number(x: f64) -> String {
    if x.is_finite() {
        format!("{x:?}")
    } else {
        "null".to_owned()
    }
}

pub(super) fn numbers(list: impl IntoIterator<Item = f64>) -> String {
    let list: Vec<String> = list.into_iter().map(number).collect();
    format!("[{}]", list.join(","))
}

/// A text as JSON.
fn text(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if (c as u32) < 0x20 => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// What a bound may be claimed as, where `gap` is to be proved.
pub(super) fn claim(bound: f64, gap: f64) -> f64 {
    if bound.is_finite() {
        bound - CLAIM_SLACK.min(CLAIM_GAP_SHARE * gap) * (1.0 + bound.abs())
    } else {
        bound
    }
}

/// A text with its hash as a member of a JSON object; nothing where there is none.
pub(super) fn written(problem: Option<&WrittenProblem>) -> String {
    problem.map_or_else(String::new, |problem| {
        let (hash, source) = (text(&problem.sha256), text(&problem.text));
        format!(",\"problem\":{{\"sha256\":{hash},\"text\":{source}}}")
    })
}

impl<'a, 's> Proof<'a, 's> {
    pub(super) fn new(sink: Option<&'a mut ProofSink<'s>>) -> Self {
        Self {
            sink,
            broken: false,
            bytes: 0,
            leaf_bytes: FIRST_LEAF_BYTES,
        }
    }

    fn line(&mut self, line: &str) {
        if let Some(sink) = &mut self.sink
            && !self.broken
        {
            self.broken = sink(line).is_break();
            self.bytes += line.len() as u64 + 1;
        }
    }

    pub(super) fn begin(&mut self, rows: &Rows, names: &[String], settings: &CertifySettings) {
        if self.sink.is_none() {
            return;
        }
        let ops: Vec<String> = rows
            .tape
            .ops
            .iter()
            .map(|op| match op {
                Op::Constant(value) => format!("[\"const\",{}]", number(*value)),
                Op::Variable(index) => format!("[\"var\",{index}]"),
                Op::Unary(function, a) => format!("[\"{}\",{a}]", function.name()),
                Op::Binary(function, a, b) => format!("[\"{}\",{a},{b}]", function.name()),
                Op::WholePower(a, n) => format!("[\"powi\",{a},{n}]"),
            })
            .collect();
        let kinds = |kind| match kind {
            LinearKind::Objective => "objective",
            LinearKind::AtMost => "at_most",
            LinearKind::Equal => "equal",
        };
        let list: Vec<String> = rows
            .list
            .iter()
            .map(|row| format!("[\"{}\",{},{}]", kinds(row.kind), row.node, text(&row.name)))
            .collect();
        let names: Vec<String> = names.iter().map(|name| text(name)).collect();
        self.line(&format!(
            "{{\"format\":\"grouser-certificate\",\"version\":1,\"gap\":{},\"variables\":[{}],\"lower\":{},\
             \"upper\":{},\"ops\":[{}],\"rows\":[{}]{}}}",
            number(settings.gap),
            names.join(","),
            numbers(rows.lower.iter().copied()),
            numbers(rows.upper.iter().copied()),
            ops.join(","),
            list.join(","),
            written(settings.written.as_ref())
        ));
    }

    pub(super) fn divided(&mut self, id: u64, variable: usize, at: f64, into: (u64, u64)) {
        if self.sink.is_some() {
            let (below, above) = into;
            self.line(&format!(
                "{{\"box\":{id},\"divide\":{variable},\"at\":{},\"into\":[{below},{above}]}}",
                number(at)
            ));
        }
    }

    pub(super) fn leaf(&mut self, id: u64, bound: f64, certificate: &Weights) {
        if self.sink.is_none() {
            return;
        }
        let weights: Vec<String> = certificate
            .rows
            .iter()
            .map(|(row, w)| format!("[{row},{}]", number(*w)))
            .collect();
        let bound = if bound.is_finite() {
            number(bound)
        } else if bound == f64::INFINITY {
            "null".to_owned()
        } else {
            "\"none\"".to_owned()
        };
        let tangent = certificate.tangent.as_ref().map_or_else(String::new, |t| {
            let at = numbers(t.at.iter().copied());
            format!(",\"tangent\":[{at},{}]", number(t.curvature))
        });
        let cleared = if certificate.is_cleared {
            ",\"cleared\":1"
        } else {
            ""
        };
        let line = format!(
            "{{\"box\":{id},\"bound\":{bound},\"weights\":[{}]{tangent}{cleared}}}",
            weights.join(",")
        );
        self.leaf_bytes = self.leaf_bytes.max(line.len() as u64 + 1);
        self.line(&line);
    }

    pub(super) fn end(&mut self, status: &str, lower: f64, upper: f64, x: &[f64], violation: f64) {
        if self.sink.is_none() {
            return;
        }
        self.line(&format!(
            "{{\"end\":{},\"lower\":{},\"upper\":{},\"x\":{},\"violation\":{}}}",
            text(status),
            number(lower),
            number(upper),
            numbers(x.iter().copied()),
            number(violation)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_lies_below_its_bound() {
        for (bound, less) in [(2.0, 3e-10), (-4.0, 5e-10), (0.0, 1e-10)] {
            assert!((bound - claim(bound, 1e-6) - less).abs() < 1e-15);
        }
        for bound in [f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(claim(bound, 1e-6), bound);
        }
    }

    #[test]
    fn names_of_any_characters_are_texts() {
        let found = text("a\"b\\c\n\u{1f} \u{7f}é");
        assert_eq!(found, "\"a\\\"b\\\\c\\u000a\\u001f \u{7f}é\"");
    }
}
