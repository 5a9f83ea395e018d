//! What a solution reports of itself, recomputed from its point and its multipliers alone.

use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_opt::{
    Jacobian, LinearConstraint, Method, Model, Problem, ProblemParams, Settings, Variable, solve,
};
use proptest::prelude::*;

const N: usize = 3;

/// w_k |x − c_k|²/2 + b_k for two k, |x|² ≤ r², a·x = d; calls are counted.
#[derive(Debug)]
struct Drawn {
    bowls: [([f64; N], f64, f64); 2],
    radius: f64,
    plane: ([f64; N], f64),
    calls: [AtomicUsize; 2],
}

impl Drawn {
    fn gradient(&self, function: usize, x: &[f64], at: usize) -> f64 {
        match function {
            0 | 1 => self.bowls[function].1 * (x[at] - self.bowls[function].0[at]),
            2 => 2.0 * x[at],
            _ => self.plane.0[at],
        }
    }
}

impl Model for &Drawn {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.calls[0].fetch_add(1, Ordering::Relaxed);
        for (slot, (center, weight, base)) in values.iter_mut().zip(&self.bowls) {
            let square: f64 = x.iter().zip(center).map(|(x, c)| (x - c).powi(2)).sum();
            *slot = 0.5 * weight * square + base;
        }
        values[2] = x.iter().map(|x| x * x).sum::<f64>() - self.radius * self.radius;
        values[3] = dot(&self.plane.0, x) - self.plane.1;
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.values(x, values);
        self.calls[0].fetch_sub(1, Ordering::Relaxed);
        self.calls[1].fetch_add(1, Ordering::Relaxed);
        for function in 0..4 {
            (0..N).for_each(|at| jacobian.set(function, at, self.gradient(function, x, at)));
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

prop_compose! {
    /// A feasible problem about a point, with a start anywhere, and the linear row with its limit.
    fn drawn()(
        inside in prop::array::uniform3(-1.0..1.0_f64),
        start in prop::array::uniform3(-4.0..4.0_f64),
        bowls in prop::array::uniform2((prop::array::uniform3(-3.0..3.0_f64), 0.2..3.0_f64, -2.0..2.0_f64)),
        (margin, room, steep) in (0.05..2.0_f64, 0.05..2.0_f64, 0.0..4.0_f64),
        plane in prop::array::uniform3(-1.0..1.0_f64),
        row in prop::array::uniform3(-1.0..1.0_f64),
        bounds in prop::array::uniform6(prop_oneof![0.02..2.0_f64, Just(f64::INFINITY)]),
        equal in any::<bool>(),
    ) -> (Drawn, [f64; N], ([f64; N], f64, bool), [(f64, f64); N]) {
        // steep objectives make constraints expensive
        let steep = 10_f64.powf(steep);
        let model = Drawn {
            bowls: bowls.map(|(center, weight, base)| (center, steep * weight, base)),
            radius: dot(&inside, &inside).sqrt() + margin,
            plane: (plane, dot(&plane, &inside)),
            calls: Default::default(),
        };
        let bound = dot(&row, &inside) + if equal { 0.0 } else { room };
        let bounds = [0, 1, 2].map(|i| (inside[i] - bounds[2 * i], inside[i] + bounds[2 * i + 1]));
        (model, start, (row, bound, equal), bounds)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn the_reported_conditions_are_those_of_the_point((model, start, (row, bound, equal), bounds) in drawn(), attained in any::<bool>()) {
        // a plane and a row that nearly agree have no regular solution
        let cross = 1.0 - (dot(&model.plane.0, &row).powi(2) / (dot(&row, &row) * dot(&model.plane.0, &model.plane.0)));
        prop_assume!(cross > 0.05 && dot(&row, &row) > 0.05 && dot(&model.plane.0, &model.plane.0) > 0.05);
        let names = ["x", "y", "z"];
        let variables = (0..N).map(|i| Variable::bounded(names[i], start[i], bounds[i].0, bounds[i].1));
        let linear = if equal { LinearConstraint::equal } else { LinearConstraint::at_most };
        let params = ProblemParams::new(&start, 2, &model)
            .variables(variables)
            .inequalities(vec!["ball".to_owned()])
            .equalities(vec!["plane".to_owned()])
            .linear(vec![linear("row", row.to_vec(), bound)]);
        let problem = Problem::new(params).unwrap();
        let (goals, weights) = if attained { ([0.5, -1.0], [2.0, 0.5]) } else { ([0.0; 2], [1.0; 2]) };
        let method = if attained { Method::Attain { goals: goals.to_vec(), weights: weights.to_vec() } } else { Method::Minimax };
        let found = solve(&problem, &method, &Settings::default()).unwrap();
        prop_assert!(found.status.is_solved(), "{:?}", found.status);
        let counts = found.counts;
        // effort: of 3000 draws none took more than 16
        prop_assert!(counts.iterations <= 20, "{}", counts.iterations);
        prop_assert_eq!(counts.values + counts.probes, model.calls[0].load(Ordering::Relaxed) + 1);
        prop_assert_eq!(counts.jacobians + 1, model.calls[1].load(Ordering::Relaxed));

        let x = &found.x;
        let mut values = [0.0; 4];
        (&&model).values(x, &mut values);
        prop_assert_eq!(&found.objectives[..], &values[..2]);
        prop_assert_eq!((found.inequalities[0], found.equalities[0]), (values[2], values[3]));
        prop_assert_eq!(found.maximum, values[0].max(values[1]));
        let scaled = [0, 1].map(|k| (values[k] - goals[k]) / weights[k]);
        let level = scaled[0].max(scaled[1]);
        prop_assert!((found.utility - level).abs() < 1e-12);

        let prices = &found.multipliers;
        let sum: f64 = prices.objectives.iter().sum();
        prop_assert!((sum - 1.0).abs() < 1e-9);
        let gradients = |at: usize| {
            let objectives = (0..2).map(|k| prices.objectives[k] / weights[k] * model.gradient(k, x, at)).sum::<f64>();
            let constraints = prices.inequalities[0] * model.gradient(2, x, at) + prices.equalities[0] * model.gradient(3, x, at);
            objectives + constraints + prices.linear[0] * row[at] + prices.upper[at] - prices.lower[at]
        };
        let stationarity = (0..N).map(|at| gradients(at).abs()).fold(0.0, f64::max);
        prop_assert!((found.kkt.stationarity - stationarity).abs() < 1e-9, "{} {stationarity}", found.kkt.stationarity);
        let steepest = |k: usize| (0..N).map(|at| model.gradient(k, x, at).abs() / weights[k]).fold(0.0, f64::max);
        prop_assert!((found.kkt.gradient_scale - steepest(0).max(steepest(1))).abs() < 1e-9 * (1.0 + found.kkt.gradient_scale), "{} {} {}", found.kkt.gradient_scale, steepest(0), steepest(1));

        let off = dot(&row, x) - bound;
        let mut products = vec![
            prices.objectives[0] * (level - scaled[0]),
            prices.objectives[1] * (level - scaled[1]),
            prices.inequalities[0] * (-values[2]).max(0.0),
            if equal { 0.0 } else { prices.linear[0] * (-off).max(0.0) },
        ];
        for i in 0..N {
            products.push(if prices.lower[i] == 0.0 { 0.0 } else { prices.lower[i] * (x[i] - bounds[i].0) });
            products.push(if prices.upper[i] == 0.0 { 0.0 } else { prices.upper[i] * (bounds[i].1 - x[i]) });
        }
        let complementarity = products.iter().map(|p| p.abs()).fold(0.0, f64::max);
        prop_assert!((found.kkt.complementarity - complementarity).abs() < 1e-9, "{} {complementarity}", found.kkt.complementarity);
        let violation = [values[2], values[3].abs(), if equal { off.abs() } else { off }].into_iter().fold(0.0, f64::max);
        prop_assert!((found.kkt.violation - violation).abs() < 1e-12);
        // and they hold
        let size = 1.0 + found.kkt.gradient_scale + prices.inequalities[0] + prices.equalities[0].abs() + prices.linear[0].abs();
        prop_assert!(stationarity < 1e-6 * size && complementarity < 1e-6 * size && violation < 1e-6);
        let signs = [prices.inequalities[0], if equal { 0.0 } else { prices.linear[0] }];
        let others = [&prices.objectives, &prices.lower, &prices.upper];
        prop_assert!(signs.iter().chain(others.into_iter().flatten()).all(|price| *price >= 0.0));

        // what holds the point: priced objectives and limits that are met, in the problem's order
        let near = |slack: f64, size: f64| slack <= 1e-7 * (1.0 + size);
        let mut active = Vec::new();
        for (k, own) in scaled.iter().enumerate() {
            if prices.objectives[k] > 0.0 || near(level - own, level.abs()) {
                active.push(format!("f{}", k + 1));
            }
        }
        let others = [(near(-values[2], 0.0), "ball"), (true, "plane"), (equal || near(-off, bound.abs()), "row")];
        active.extend(others.iter().filter(|(is, _)| *is).map(|(_, name)| (*name).to_owned()));
        for i in 0..N {
            let (low, high) = bounds[i];
            if low.is_finite() && near(x[i] - low, low.abs()) {
                active.push(format!("{} >= lower", names[i]));
            }
            if high.is_finite() && near(high - x[i], high.abs()) {
                active.push(format!("{} <= upper", names[i]));
            }
        }
        prop_assert_eq!(&found.active, &active);
    }
}
