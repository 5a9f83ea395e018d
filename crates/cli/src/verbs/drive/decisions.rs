//! The decisions of a drive for people: those about the whole robot numbered, those about wheels joined.

use grouser_rover::drive::NamedDecision;

use super::run::Run;

/// Decisions of one kind that follow each other within this time are one, s.
const MAX_GROUP_GAP_S: f64 = 1.0;

/// Decisions of one kind about the same time.
#[derive(Clone, Debug)]
pub(super) struct Group<'a> {
    pub(super) first: &'a NamedDecision,
    pub(super) end: f64,
    /// Wheels in the order of the decisions; none: the whole robot.
    pub(super) wheels: Vec<usize>,
    /// Least and greatest of what was seen.
    pub(super) values: [f64; 2],
    /// Its number on the map.
    pub(super) number: Option<usize>,
}

/// The decisions about the whole robot, numbered from 1.
pub(super) fn notable(run: &Run) -> impl Iterator<Item = (usize, &NamedDecision)> {
    let all = run.result.decisions.iter();
    (1..).zip(all.filter(|named| named.decision.wheel.is_none()))
}

/// All decisions in the order of time.
pub(super) fn groups(decisions: &[NamedDecision]) -> Vec<Group<'_>> {
    let mut out: Vec<Group<'_>> = Vec::new();
    let mut number = 0;
    for named in decisions {
        let decision = &named.decision;
        let alike = |group: &&mut Group<'_>| {
            let other = &group.first.decision;
            group.number.is_none()
                && other.action == decision.action
                && other.reason == decision.reason
                && named.time - group.end <= MAX_GROUP_GAP_S
        };
        let Some(wheel) = decision.wheel else {
            number += 1;
            out.push(Group {
                first: named,
                end: named.time,
                wheels: Vec::new(),
                values: [decision.value; 2],
                number: Some(number),
            });
            continue;
        };
        if let Some(group) = out.last_mut().filter(alike) {
            group.end = named.time;
            group.values[0] = group.values[0].min(decision.value);
            group.values[1] = group.values[1].max(decision.value);
            if !group.wheels.contains(&wheel) {
                group.wheels.push(wheel);
            }
        } else {
            out.push(Group {
                first: named,
                end: named.time,
                wheels: vec![wheel],
                values: [decision.value; 2],
                number: None,
            });
        }
    }
    out
}

impl Group<'_> {
    /// What was seen, and the limit that it passed.
    pub(super) fn values(&self) -> String {
        let [low, high] = self.values.map(|value| format!("{value:.3}"));
        if low == high {
            low
        } else {
            format!("{low} to {high}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grouser_slip::control::{Action, Decision, Reason};

    fn decided(time: f64, action: Action, wheel: Option<usize>, value: f64) -> NamedDecision {
        NamedDecision {
            time,
            decision: Decision {
                time_ns: 0,
                action,
                reason: Reason::SlipHigh,
                wheel,
                value,
                limit: 0.3,
            },
            place: (0.0, 0.0),
        }
    }

    #[test]
    fn wheels_that_decide_alike_at_once_are_one_line() {
        let list = [
            decided(1.0, Action::ReduceTorque, Some(0), 0.4),
            decided(1.1, Action::ReduceTorque, Some(2), 0.5),
            decided(1.2, Action::ReduceTorque, Some(0), 0.3),
            decided(5.0, Action::ReduceTorque, Some(0), 0.4),
            decided(5.1, Action::RaiseTorque, Some(1), 0.2),
            decided(5.2, Action::BackOut, None, 0.9),
            decided(5.3, Action::BackOut, None, 0.9),
        ];
        let groups = groups(&list);
        let lines: Vec<_> = groups
            .iter()
            .map(|group| (group.wheels.clone(), group.values(), group.number))
            .collect();
        assert_eq!(
            lines,
            [
                (vec![0, 2], "0.300 to 0.500".to_owned(), None),
                (vec![0], "0.400".to_owned(), None),
                (vec![1], "0.200".to_owned(), None),
                (vec![], "0.900".to_owned(), Some(1)),
                (vec![], "0.900".to_owned(), Some(2)),
            ]
        );
    }
}
