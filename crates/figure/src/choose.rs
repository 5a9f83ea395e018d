//! One candidate for each label, such that no two touch, at the least cost: branch and bound.

use super::geometry::{Point, Rect, cross};

/// Nodes visited at most.
const MAX_NODES: usize = 20_000;
/// What standing on another side than a neighbour costs.
const OTHER_SIDE_COST: f64 = 0.35;

/// Where a label stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) rect: Rect,
    /// A thin line to what it names, where it does not stand beside it.
    pub(super) leader: Option<[Point; 2]>,
}

/// A place that a label could take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) placed: Placed,
    pub(super) cost: f64,
    pub(super) side: Side,
}

/// On which side of its target a label stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Above,
    Below,
    Left,
    Right,
    /// At a spot, or in free space with a leader.
    Free,
}

/// The best choice of one candidate for each label such that no two touch.
pub(super) fn choose(candidates: &[Vec<Candidate>], gap: f64) -> Option<Vec<Placed>> {
    // The label with the fewest candidates first.
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by_key(|index| candidates[*index].len());
    let mut min_rest = vec![0.0; order.len() + 1];
    for (depth, index) in order.iter().enumerate().rev() {
        min_rest[depth] = min_rest[depth + 1] + candidates[*index].first()?.cost;
    }
    let mut choice = Choice {
        candidates,
        order,
        min_rest,
        best: None,
        effort: MAX_NODES,
        gap,
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
    min_rest: Vec<f64>,
    best: Option<(f64, Vec<usize>)>,
    effort: usize,
    gap: f64,
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
            if cost + candidate.cost + self.min_rest[depth + 1] >= bound || self.effort == 0 {
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
                leader.is_some_and(|[from, to]| rect.distance_to_segment(from, to) < self.gap)
            };
            let leaders_cross = match (candidate.placed.leader, other.leader) {
                (Some([a, b]), Some([c, d])) => cross(a, b, c, d),
                _ => false,
            };
            if rect.grown(self.gap).overlaps(&other.rect)
                || touch(other.leader, rect)
                || touch(candidate.placed.leader, &other.rect)
                || leaders_cross
            {
                return None;
            }
            // Labels in one column, on the same side of their curves, read best.
            cost += (rect.centre()[0] - other.rect.centre()[0]).abs() / 400.0;
            if candidate.side != others.side {
                cost += OTHER_SIDE_COST;
            }
        }
        Some(cost)
    }
}
