//! Hypervolume: the size of what a front dominates, up to a reference point. Exact in two and three
//! dimensions.
//!
//! Source: Zitzler & Thiele 1998 (the indicator); Fonseca, Paquete & López-Ibáñez 2006 (dimension sweep).

/// The volume dominated by `points` (all objectives minimised) inside the box below `reference`.
/// Points beyond the reference in any objective count for nothing.
///
/// Two overlapping rectangles below (3, 3), from (1, 2) and (2, 1): 2·1 + 1·2 − 1·1 = 3.
///
/// # Errors
/// Not two or three objectives, points of another length, or a number that is not finite.
pub(crate) fn hypervolume(points: &[Vec<f64>], reference: &[f64]) -> Result<f64, &'static str> {
    let m = reference.len();
    if !(m == 2 || m == 3) {
        return Err("two or three objectives only");
    }
    for point in points.iter().map(Vec::as_slice).chain([reference]) {
        if point.len() != m || point.iter().any(|value| !value.is_finite()) {
            return Err("a point of another length, or not finite");
        }
    }
    let mut inside: Vec<&[f64]> = points
        .iter()
        .map(Vec::as_slice)
        .filter(|p| p.iter().zip(reference).all(|(p, r)| p < r))
        .collect();
    if m == 2 {
        return Ok(area(
            inside.iter().map(|p| (p[0], p[1])).collect(),
            (reference[0], reference[1]),
        ));
    }
    // Slabs between consecutive third coordinates: each is an area times a thickness.
    inside.sort_by(|a, b| a[2].total_cmp(&b[2]));
    let mut staircase = Staircase::default();
    let mut volume = 0.0;
    for (i, point) in inside.iter().enumerate() {
        staircase.insert(point[0], point[1]);
        let top = inside.get(i + 1).map_or(reference[2], |next| next[2]);
        if top > point[2] {
            volume += (top - point[2]) * staircase.area((reference[0], reference[1]));
        }
    }
    Ok(volume)
}

fn area(points: Vec<(f64, f64)>, reference: (f64, f64)) -> f64 {
    let mut staircase = Staircase::default();
    for (a, b) in points {
        staircase.insert(a, b);
    }
    staircase.area(reference)
}

/// Nondominated points in two dimensions, first coordinate rising, second falling.
#[derive(Default)]
struct Staircase {
    steps: Vec<(f64, f64)>,
}

impl Staircase {
    fn insert(&mut self, a: f64, b: f64) {
        let at = self.steps.partition_point(|step| step.0 < a);
        let dominated = (at > 0 && self.steps[at - 1].1 <= b)
            || self.steps.get(at).is_some_and(|s| s.0 == a && s.1 <= b);
        if dominated {
            return;
        }
        let beaten = self.steps[at..].iter().take_while(|s| s.1 >= b).count();
        self.steps.splice(at..at + beaten, [(a, b)]);
    }

    fn area(&self, reference: (f64, f64)) -> f64 {
        let mut sum = 0.0;
        for (i, &(a, b)) in self.steps.iter().enumerate() {
            let right = self.steps.get(i + 1).map_or(reference.0, |next| next.0);
            sum += (right - a) * (reference.1 - b);
        }
        sum
    }
}
