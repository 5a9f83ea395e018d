//! Where labels go: beside what they name, and touching nothing.
//!
//! Every label has candidates, each with a cost; a candidate that would touch a line, a box or the frame
//! is none. The labels of a panel are then chosen together, so that no two touch, by branch and bound.
//! The effort is bounded and the answer depends on nothing but the input.

use super::choose::{Candidate, Placed, Side, choose};
use super::geometry::{Point, Rect, cross, distance};

/// Free space between a label and any line, and between two labels, in points: as a rule, and where
/// curves stand close.
const GAPS_PT: [f64; 2] = [2.4, 1.6];
/// A label this near to a strange line might seem to name it.
const AMBIGUOUS_PT: f64 = 9.0;
/// Candidates kept for each label.
const MAX_CANDIDATES: usize = 64;
/// What a leader costs before its length counts.
const LEADER_COST: f64 = 6.0;
/// Leaders tried from one place, the shortest first.
const MAX_LEADERS: usize = 8;
/// The longest leader, in points.
const MAX_LEADER_PT: f64 = 90.0;

/// What labels must not touch.
#[derive(Clone, Debug, Default)]
pub(super) struct Obstacles {
    /// Lines, each with half its width.
    pub(super) lines: Vec<(Vec<Point>, f64)>,
    /// Markers, error bars, other text.
    pub(super) boxes: Vec<Rect>,
}

impl Obstacles {
    /// Does nothing come nearer to the box than the gap?
    pub(super) fn leave_free(&self, rect: &Rect, gap: f64) -> bool {
        // A hair less than the gap, which the candidates keep exactly.
        let gap = gap - 1e-6;
        !self
            .boxes
            .iter()
            .any(|other| other.grown(gap).overlaps(rect))
            && self.lines.iter().all(|(line, half)| {
                let room = half + gap;
                let near = rect.grown(room);
                line.windows(2).all(|part| {
                    !could_meet(&near, part) || rect.distance_to_segment(part[0], part[1]) >= room
                })
            })
    }
}

/// What a label names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// A line of the obstacles.
    Line(usize),
    /// A spot and the radius of what is drawn there.
    Spot(Point, f64),
}

/// A label to be placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wanted {
    pub(super) target: Target,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// A place for each label inside `frame`, or `None` when there is none for all.
pub(super) fn place(frame: Rect, obstacles: &Obstacles, wanted: &[Wanted]) -> Option<Vec<Placed>> {
    for gap in GAPS_PT {
        let search = Search {
            frame,
            obstacles,
            wanted,
            gap,
        };
        let beside: Vec<Vec<Candidate>> = wanted.iter().map(|label| search.beside(label)).collect();
        if let Some(chosen) = choose(&beside, gap) {
            return Some(chosen);
        }
    }
    let gap = GAPS_PT[0];
    let search = Search {
        frame,
        obstacles,
        wanted,
        gap,
    };
    let with_leaders: Vec<Vec<Candidate>> = wanted
        .iter()
        .map(|label| {
            let mut candidates = search.beside(label);
            candidates.truncate(MAX_CANDIDATES / 2);
            candidates.extend(search.with_leader(label));
            candidates
        })
        .collect();
    choose(&with_leaders, gap)
}

struct Search<'a> {
    frame: Rect,
    obstacles: &'a Obstacles,
    wanted: &'a [Wanted],
    gap: f64,
}

impl Search<'_> {
    /// Candidates that stand directly at what they name, the best first.
    fn beside(&self, label: &Wanted) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = match label.target {
            Target::Line(index) => {
                let (points, half) = &self.obstacles.lines[index];
                self.along(points, *half + self.gap, label)
            }
            Target::Spot(at, radius) => around(at, radius + self.gap, label),
        }
        .into_iter()
        .filter_map(|(rect, cost, side)| {
            let cost = cost + self.nearness_cost(&rect, label)?;
            Some(Candidate {
                placed: Placed { rect, leader: None },
                cost,
                side,
            })
        })
        .collect();
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        // The best of each side: the joint choice may want any of them.
        let mut room = [MAX_CANDIDATES / 4; 4];
        candidates.retain(|candidate| {
            let Some(room) = room.get_mut(candidate.side as usize) else {
                return true;
            };
            *room = room.saturating_sub(1);
            *room > 0
        });
        candidates
    }

    /// Boxes that touch the line from above, below, left and right, with what speaks against each.
    fn along(&self, line: &[Point], gap: f64, label: &Wanted) -> Vec<(Rect, f64, Side)> {
        let (w, h) = (label.width, label.height);
        let mut boxes = Vec::new();
        for anchor in anchors(line, &self.frame) {
            let [x, y] = anchor;
            // Towards the right, where curves have parted, but not at the very end.
            let place = (x - self.frame.left) / self.frame.width();
            let from_preferred = 1.2 * (place - 0.72).abs();
            // As wide as the gap beyond the box: a corner keeps its distance from a slanted line too.
            let window = [x - w / 2.0 - gap, x + w / 2.0 + gap];
            if let Some([highest, lowest]) = extent(line, window, 0) {
                let above = Rect::at([x - w / 2.0, highest - gap - h], w, h);
                boxes.push((above, from_preferred + (y - highest) / 6.0, Side::Above));
                let below = Rect::at([x - w / 2.0, lowest + gap], w, h);
                boxes.push((
                    below,
                    from_preferred + (lowest - y) / 6.0 + 0.3,
                    Side::Below,
                ));
            }
            let window = [y - h / 2.0 - gap, y + h / 2.0 + gap];
            if let Some([leftmost, rightmost]) = extent(line, window, 1) {
                let left = Rect::at([leftmost - gap - w, y - h / 2.0], w, h);
                boxes.push((
                    left,
                    from_preferred + (x - leftmost) / 6.0 + 0.6,
                    Side::Left,
                ));
                let right = Rect::at([rightmost + gap, y - h / 2.0], w, h);
                boxes.push((
                    right,
                    from_preferred + (rightmost - x) / 6.0 + 0.5,
                    Side::Right,
                ));
            }
        }
        boxes
    }

    /// Candidates in free space with a line to what they name, the best first.
    fn with_leader(&self, label: &Wanted) -> Vec<Candidate> {
        const STEP_PT: f64 = 5.0;
        let ends = match label.target {
            Target::Line(index) => anchors(&self.obstacles.lines[index].0, &self.frame),
            Target::Spot(at, _) => vec![at],
        };
        let mut candidates = Vec::new();
        let mut top = self.frame.top + self.gap;
        while top + label.height < self.frame.bottom {
            let mut left = self.frame.left + self.gap;
            while left + label.width < self.frame.right {
                let rect = Rect::at([left, top], label.width, label.height);
                left += STEP_PT;
                if self.is_free(&rect)
                    && let Some((leader, length)) = self.leader(&rect, &ends, label.target)
                {
                    let cost = LEADER_COST + length / 12.0;
                    let placed = Placed {
                        rect,
                        leader: Some(leader),
                    };
                    candidates.push(Candidate {
                        placed,
                        cost,
                        side: Side::Free,
                    });
                }
            }
            top += STEP_PT;
        }
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        candidates.truncate(MAX_CANDIDATES);
        candidates
    }

    /// The shortest line from the box to one of `ends` that crosses nothing but its own target.
    fn leader(&self, rect: &Rect, ends: &[Point], target: Target) -> Option<([Point; 2], f64)> {
        let start = |end: Point| rect.grown(1.0).nearest(end);
        let length = |end: Point| distance(start(end), end);
        let mut near: Vec<Point> = ends
            .iter()
            .copied()
            .filter(|end| length(*end) <= MAX_LEADER_PT)
            .collect();
        near.sort_by(|a, b| length(*a).total_cmp(&length(*b)));
        near.truncate(MAX_LEADERS);
        let crosses_nothing = |end: &Point| {
            let strange = |index: usize| target != Target::Line(index);
            !self
                .obstacles
                .lines
                .iter()
                .enumerate()
                .any(|(index, (line, _))| {
                    strange(index)
                        && line
                            .windows(2)
                            .any(|part| cross(start(*end), *end, part[0], part[1]))
                })
        };
        let end = near.into_iter().find(crosses_nothing)?;
        Some(([start(end), end], length(end)))
    }

    /// What the neighbours cost; `None` when the box touches something or seems to name another line.
    fn nearness_cost(&self, rect: &Rect, label: &Wanted) -> Option<f64> {
        if !self.is_free(rect) {
            return None;
        }
        let own = match label.target {
            Target::Line(index) => line_distance(rect, &self.obstacles.lines[index].0),
            Target::Spot(at, _) => rect.distance(at),
        };
        let mut cost = 0.0;
        for other in self.wanted {
            if let Target::Line(index) = other.target
                && label.target != other.target
            {
                let strange = line_distance(rect, &self.obstacles.lines[index].0);
                if matches!(label.target, Target::Line(_)) && strange < own + 0.5 {
                    return None;
                }
                cost += ((own + AMBIGUOUS_PT - strange) / AMBIGUOUS_PT).max(0.0);
            }
        }
        Some(cost)
    }

    fn is_free(&self, rect: &Rect) -> bool {
        self.frame.grown(-self.gap).contains(rect) && self.obstacles.leave_free(rect, self.gap)
    }
}

/// Spots around a point, the best first: right, left, above, below, then the corners.
fn around(at: Point, gap: f64, label: &Wanted) -> Vec<(Rect, f64, Side)> {
    let (w, h) = (label.width, label.height);
    let corner = gap * 0.75;
    let spots = [
        ([gap, -h / 2.0], 0.2),
        ([corner, -corner - h], 0.0),
        ([corner, corner], 0.1),
        ([-w / 2.0, -gap - h], 0.3),
        ([-w / 2.0, gap], 0.4),
        ([-corner - w, -corner - h], 0.5),
        ([-corner - w, corner], 0.6),
        ([-gap - w, -h / 2.0], 0.7),
    ];
    let mut boxes = Vec::new();
    for (reach, cost) in [(1.0, 0.0), (1.8, 1.0), (2.8, 2.0)] {
        for ([dx, dy], own) in spots {
            // Further out along the same direction.
            let away = [
                (reach - 1.0) * gap * dx.signum(),
                (reach - 1.0) * gap * dy.signum(),
            ];
            let rect = Rect::at([at[0] + dx + away[0], at[1] + dy + away[1]], w, h);
            boxes.push((rect, own + cost, Side::Free));
        }
    }
    boxes
}

/// Points along a line, inside the frame, a few points apart.
fn anchors(line: &[Point], frame: &Rect) -> Vec<Point> {
    const STEP_PT: f64 = 4.0;
    let mut found = Vec::new();
    let mut since = STEP_PT;
    for part in line.windows(2) {
        let length = distance(part[0], part[1]);
        while length > 0.0 && since <= length && found.len() < 400 {
            let share = since / length;
            let point = [
                part[0][0] + share * (part[1][0] - part[0][0]),
                part[0][1] + share * (part[1][1] - part[0][1]),
            ];
            if frame.distance(point) == 0.0 {
                found.push(point);
            }
            since += STEP_PT;
        }
        since -= length.min(since);
    }
    found
}

/// The least and the greatest of the other coordinate where `axis` (0: x, 1: y) lies in `window`.
fn extent(line: &[Point], window: [f64; 2], axis: usize) -> Option<[f64; 2]> {
    let other = 1 - axis;
    let mut extent: Option<[f64; 2]> = None;
    for part in line.windows(2) {
        let (a, b) = (part[0], part[1]);
        let (low, high) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
        if high[axis] < window[0] || low[axis] > window[1] {
            continue;
        }
        let at = |value: f64| {
            let span = high[axis] - low[axis];
            if span > 0.0 {
                let share = ((value - low[axis]) / span).clamp(0.0, 1.0);
                low[other] + share * (high[other] - low[other])
            } else {
                value
            }
        };
        let ends = if high[axis] > low[axis] {
            [at(window[0]), at(window[1])]
        } else {
            [low[other], high[other]]
        };
        for end in ends {
            extent =
                Some(extent.map_or([end, end], |[least, most]| [least.min(end), most.max(end)]));
        }
    }
    extent
}

fn line_distance(rect: &Rect, line: &[Point]) -> f64 {
    let parts = line
        .windows(2)
        .map(|part| rect.distance_to_segment(part[0], part[1]));
    parts.fold(f64::INFINITY, f64::min)
}

fn could_meet(rect: &Rect, part: &[Point]) -> bool {
    let (a, b) = (part[0], part[1]);
    a[0].min(b[0]) <= rect.right
        && a[0].max(b[0]) >= rect.left
        && a[1].min(b[1]) <= rect.bottom
        && a[1].max(b[1]) >= rect.top
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Rect = Rect {
        left: 0.0,
        top: 0.0,
        right: 220.0,
        bottom: 150.0,
    };

    /// Smooth curves of all sorts: a sum of a line, a rise that saturates, and a wave.
    fn curve() -> impl Strategy<Value = Vec<Point>> {
        (
            0.0..150.0_f64,
            -1.0..1.0_f64,
            -80.0..80.0_f64,
            0.0..30.0_f64,
            0.01..0.1_f64,
        )
            .prop_map(|(start, slope, rise, wave, rate)| {
                let y = |x: f64| {
                    start
                        + slope * x
                        + rise * (1.0 - (-rate * x).exp())
                        + wave * (rate * 3.0 * x).sin()
                };
                (0..=110)
                    .map(|i| 2.0 * f64::from(i))
                    .map(|x| [x, y(x)])
                    .collect()
            })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_label_touches_a_curve_a_box_a_label_or_the_frame(
            curves in prop::collection::vec(curve(), 1..7),
            spots in prop::collection::vec((5.0..215.0_f64, 5.0..145.0_f64), 0..3),
            width in 12.0..60.0_f64,
        ) {
            let marker = |(x, y): &(f64, f64)| Rect::at([x - 2.0, y - 2.0], 4.0, 4.0);
            let obstacles = Obstacles {
                lines: curves.iter().map(|curve| (curve.clone(), 0.6)).collect(),
                boxes: spots.iter().map(marker).collect(),
            };
            let lines = (0..curves.len()).map(Target::Line);
            let marks = spots.iter().map(|(x, y)| Target::Spot([*x, *y], 2.0));
            let wanted: Vec<Wanted> = lines
                .chain(marks)
                .map(|target| Wanted { target, width, height: 7.0 })
                .collect();
            let Some(placed) = place(FRAME, &obstacles, &wanted) else {
                return Ok(()); // no room: the labels go outside the frame
            };
            prop_assert_eq!(placed.len(), wanted.len());
            // Tested point by point along each curve, not by the distances that the search uses.
            for (i, label) in placed.iter().enumerate() {
                let rect = label.rect;
                prop_assert!(FRAME.contains(&rect));
                for part in curves.iter().flat_map(|curve| curve.windows(2)) {
                    for step in 0..=20 {
                        let share = f64::from(step) / 20.0;
                        let at = [0, 1].map(|k| part[0][k] + share * (part[1][k] - part[0][k]));
                        let inside = at[0] > rect.left && at[0] < rect.right
                            && at[1] > rect.top && at[1] < rect.bottom;
                        prop_assert!(!inside, "{rect:?} over {at:?}");
                    }
                }
                prop_assert!(!obstacles.boxes.iter().any(|marker| marker.overlaps(&rect)));
                for other in &placed[..i] {
                    prop_assert!(!rect.overlaps(&other.rect), "{rect:?} {other:?}");
                }
            }
        }
    }

    #[test]
    fn a_lone_curve_gets_its_label_above_it_on_the_right() {
        let line = vec![[0.0, 100.0], [220.0, 90.0]];
        let obstacles = Obstacles {
            lines: vec![(line, 0.6)],
            boxes: Vec::new(),
        };
        let wanted = [Wanted {
            target: Target::Line(0),
            width: 40.0,
            height: 7.0,
        }];
        let placed = place(FRAME, &obstacles, &wanted).unwrap()[0];
        assert!(placed.leader.is_none() && placed.rect.bottom < 100.0);
        assert!(placed.rect.centre()[0] > 110.0);
    }
}
