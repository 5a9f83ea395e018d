//! Where labels go: beside what they name, and touching nothing.
//!
//! Every label has candidates, each with a cost; a candidate that would touch a line, a box or the frame
//! is none. The labels of a panel are then chosen together, so that no two touch, by branch and bound.
//! The effort is bounded and the answer depends on nothing but the input.

use super::geometry::{Point, Rect, distance, nearest_on_segment};

/// Free space between a label and any line, and between two labels, in points.
pub(super) const GAP: f64 = 2.4;
/// A label this near to a strange line might seem to name it.
const AMBIGUOUS: f64 = 9.0;
/// Candidates kept for each label.
const KEPT: usize = 64;
/// Nodes visited at most.
const EFFORT: usize = 200_000;
/// What a leader costs before its length counts.
const LEADER_COST: f64 = 6.0;
/// What standing on another side than a neighbour costs.
const OTHER_SIDE: f64 = 0.35;
/// The longest leader, in points.
const LONGEST_LEADER: f64 = 90.0;

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
    pub(super) fn leave_free(&self, rect: &Rect) -> bool {
        // A hair less than the gap, which the candidates keep exactly.
        let gap = GAP - 1e-6;
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

/// Where a label stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) rect: Rect,
    /// A thin line to what it names, where it does not stand beside it.
    pub(super) leader: Option<[Point; 2]>,
}

#[derive(Clone, Copy, Debug)]
struct Candidate {
    placed: Placed,
    cost: f64,
    side: Side,
}

/// On which side of its target a label stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Above,
    Below,
    Left,
    Right,
    /// At a spot, or in free space with a leader.
    Free,
}

/// A place for each label inside `frame`, or `None` when there is none for all.
pub(super) fn place(frame: Rect, obstacles: &Obstacles, wanted: &[Wanted]) -> Option<Vec<Placed>> {
    let search = Search {
        frame,
        obstacles,
        wanted,
    };
    let beside: Vec<Vec<Candidate>> = wanted.iter().map(|label| search.beside(label)).collect();
    if let Some(chosen) = choose(&beside) {
        return Some(chosen);
    }
    let with_leaders: Vec<Vec<Candidate>> = wanted
        .iter()
        .zip(beside)
        .map(|(label, mut candidates)| {
            candidates.truncate(KEPT / 2);
            candidates.extend(search.with_leader(label));
            candidates
        })
        .collect();
    choose(&with_leaders)
}

struct Search<'a> {
    frame: Rect,
    obstacles: &'a Obstacles,
    wanted: &'a [Wanted],
}

impl Search<'_> {
    /// Candidates that stand directly at what they name, the best first.
    fn beside(&self, label: &Wanted) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = match label.target {
            Target::Line(index) => {
                let (points, half) = &self.obstacles.lines[index];
                self.along(points, *half + GAP, label)
            }
            Target::Spot(at, radius) => around(at, radius + GAP, label),
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
        let mut room = [KEPT / 4; 4];
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
        const STEP: f64 = 5.0;
        let ends = match label.target {
            Target::Line(index) => anchors(&self.obstacles.lines[index].0, &self.frame),
            Target::Spot(at, _) => vec![at],
        };
        let mut candidates = Vec::new();
        let mut top = self.frame.top + GAP;
        while top + label.height < self.frame.bottom {
            let mut left = self.frame.left + GAP;
            while left + label.width < self.frame.right {
                let rect = Rect::at([left, top], label.width, label.height);
                left += STEP;
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
            top += STEP;
        }
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        candidates.truncate(KEPT);
        candidates
    }

    /// The shortest line from the box to one of `ends` that crosses nothing but its own target.
    fn leader(&self, rect: &Rect, ends: &[Point], target: Target) -> Option<([Point; 2], f64)> {
        let mut best: Option<([Point; 2], f64)> = None;
        for end in ends {
            let start = rect.grown(1.0).nearest(*end);
            let length = distance(start, *end);
            if length > best.map_or(LONGEST_LEADER, |(_, length)| length) {
                continue;
            }
            let strange = |index: usize| target != Target::Line(index);
            let crosses = self
                .obstacles
                .lines
                .iter()
                .enumerate()
                .any(|(index, (line, _))| {
                    strange(index)
                        && line
                            .windows(2)
                            .any(|part| cross(start, *end, part[0], part[1]))
                });
            if !crosses {
                best = Some(([start, *end], length));
            }
        }
        best
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
                cost += ((own + AMBIGUOUS - strange) / AMBIGUOUS).max(0.0);
            }
        }
        Some(cost)
    }

    fn is_free(&self, rect: &Rect) -> bool {
        self.frame.grown(-GAP).contains(rect) && self.obstacles.leave_free(rect)
    }
}

/// The best choice of one candidate for each label such that no two touch.
fn choose(candidates: &[Vec<Candidate>]) -> Option<Vec<Placed>> {
    // The label with the fewest candidates first.
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by_key(|index| candidates[*index].len());
    let mut least_rest = vec![0.0; order.len() + 1];
    for (depth, index) in order.iter().enumerate().rev() {
        least_rest[depth] = least_rest[depth + 1] + candidates[*index].first()?.cost;
    }
    let mut choice = Choice {
        candidates,
        order,
        least_rest,
        best: None,
        effort: EFFORT,
    };
    choice.descend(&mut Vec::new(), 0.0);
    let (_, picked) = choice.best?;
    let mut placed: Vec<(usize, Placed)> = choice
        .order
        .iter()
        .zip(picked)
        .map(|(index, pick)| (*index, candidates[*index][pick].placed))
        .collect();
    placed.sort_by_key(|(index, _)| *index);
    Some(placed.into_iter().map(|(_, placed)| placed).collect())
}

struct Choice<'a> {
    candidates: &'a [Vec<Candidate>],
    order: Vec<usize>,
    /// The least that the labels from a depth on must cost.
    least_rest: Vec<f64>,
    best: Option<(f64, Vec<usize>)>,
    effort: usize,
}

impl Choice<'_> {
    fn descend(&mut self, picked: &mut Vec<usize>, cost: f64) {
        let depth = picked.len();
        if depth == self.order.len() {
            self.best = Some((cost, picked.clone()));
            return;
        }
        for pick in 0..self.candidates[self.order[depth]].len() {
            let candidate = self.candidates[self.order[depth]][pick];
            let bound = self.best.as_ref().map_or(f64::INFINITY, |(cost, _)| *cost);
            if cost + candidate.cost + self.least_rest[depth + 1] >= bound || self.effort == 0 {
                return; // the candidates after this one cost more
            }
            self.effort -= 1;
            if let Some(company) = self.company_cost(picked, &candidate) {
                picked.push(pick);
                self.descend(picked, cost + candidate.cost + company);
                picked.pop();
            }
        }
    }

    /// What standing with the labels already picked costs; `None` when they touch.
    fn company_cost(&self, picked: &[usize], candidate: &Candidate) -> Option<f64> {
        let mut cost = 0.0;
        let rect = &candidate.placed.rect;
        for (depth, pick) in picked.iter().enumerate() {
            let others = &self.candidates[self.order[depth]][*pick];
            let other = &others.placed;
            let touch = |leader: Option<[Point; 2]>, rect: &Rect| {
                leader.is_some_and(|[from, to]| rect.distance_to_segment(from, to) < GAP)
            };
            let leaders_cross = match (candidate.placed.leader, other.leader) {
                (Some([a, b]), Some([c, d])) => cross(a, b, c, d),
                _ => false,
            };
            if rect.grown(GAP).overlaps(&other.rect)
                || touch(other.leader, rect)
                || touch(candidate.placed.leader, &other.rect)
                || leaders_cross
            {
                return None;
            }
            // Labels in one column, on the same side of their curves, read best.
            cost += (rect.centre()[0] - other.rect.centre()[0]).abs() / 400.0;
            if candidate.side != others.side {
                cost += OTHER_SIDE;
            }
        }
        Some(cost)
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
    const STEP: f64 = 4.0;
    let mut found = Vec::new();
    let mut since = STEP;
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
            since += STEP;
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

/// Do two segments come nearer than half a point?
fn cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |from: Point, to: Point, point: Point| {
        (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0])
    };
    let parted = side(a, b, c) * side(a, b, d) > 0.0 || side(c, d, a) * side(c, d, b) > 0.0;
    let near = |point: Point, from: Point, to: Point| {
        distance(point, nearest_on_segment(point, from, to)) < 0.5
    };
    !parted || near(a, c, d) || near(b, c, d) || near(c, a, b) || near(d, a, b)
}
