//! Further published minimax problems, whose global optima over boxes of ±5 around their starts are proved.
//!
//! Lukšan & Vlček, TR V-798, 2000: the sets TEST06 (WF, EVD52, Bard, OET6, PBC1, Wong1), TEST19 (CB3, DEM, QL, LQ,
//! Mifflin1, Crescent) and TEST22 (MAD2).

use grouser_opt::{Functions, LinearConstraint, ProblemParams};
use grouser_real::Scalar;

use super::suite::{Case, absolute, at_most, plain};

/// A problem of variables alone: its functions in one closure-like type.
macro_rules! functions {
    ($name:ident, |$x:ident, $f:ident, $c:ident| $body:block) => {
        struct $name;
        impl Functions for $name {
            fn evaluate<R: Scalar>(&self, $x: &[R], $f: &mut [R]) {
                let $c = R::from_f64;
                $body
            }
        }
    };
}

functions!(Cb3, |x, f, c| {
    f[0] = x[0].powi(4) + x[1].square();
    f[1] = (c(2.0) - x[0]).square() + (c(2.0) - x[1]).square();
    f[2] = c(2.0) * (x[1] - x[0]).exp();
});

functions!(Dem, |x, f, c| {
    f[0] = c(5.0) * x[0] + x[1];
    f[1] = x[1] - c(5.0) * x[0];
    f[2] = x[0].square() + x[1].square() + c(4.0) * x[1];
});

functions!(Ql, |x, f, c| {
    let bowl = x[0].square() + x[1].square();
    f[0] = bowl;
    f[1] = bowl + c(10.0) * (c(4.0) - c(4.0) * x[0] - x[1]);
    f[2] = bowl + c(10.0) * (c(6.0) - x[0] - c(2.0) * x[1]);
});

functions!(Lq, |x, f, c| {
    f[0] = -x[0] - x[1];
    f[1] = x[0].square() + x[1].square() - x[0] - x[1] - c(1.0);
});

functions!(Mifflin1, |x, f, c| {
    f[0] = -x[0];
    f[1] = c(20.0) * (x[0].square() + x[1].square() - c(1.0)) - x[0];
});

functions!(Crescent, |x, f, c| {
    let circle = x[0].square() + (x[1] - c(1.0)).square();
    f[0] = circle + x[1] - c(1.0);
    f[1] = -circle + x[1] + c(1.0);
});

functions!(Wf, |x, f, c| {
    let pole = c(10.0) * x[0] / (x[0] + c(0.1));
    let bowl = c(2.0) * x[1].square();
    f[0] = c(0.5) * (x[0] + pole + bowl);
    f[1] = c(0.5) * (pole - x[0] + bowl);
    f[2] = c(0.5) * (x[0] - pole + bowl);
});

functions!(Evd52, |x, f, c| {
    let plane = x[0].square() + x[1].square();
    f[0] = plane + x[2].square() - c(1.0);
    f[1] = plane + (x[2] - c(2.0)).square();
    f[2] = x[0] + x[1] + x[2] - c(1.0);
    f[3] = x[0] + x[1] - x[2] + c(1.0);
    f[4] = c(2.0) * x[0].powi(3)
        + c(6.0) * x[1].square()
        + c(2.0) * (c(5.0) * x[2] - x[0] + c(1.0)).square();
    f[5] = x[0].square() - c(9.0) * x[2];
});

functions!(Bard, |x, f, c| {
    const Y: [f64; 15] = [
        0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.1, 4.39,
    ];
    for (i, (f, y)) in f.iter_mut().zip(Y).enumerate() {
        let u = (i + 1) as f64;
        let v = 16.0 - u;
        *f = c(y) - (x[0] + c(u) / (c(v) * x[1] + c(u.min(v)) * x[2]));
    }
});

functions!(Oet6, |x, f, c| {
    for (i, f) in f.iter_mut().enumerate() {
        let t = 0.05 * i as f64 - 0.5;
        *f = x[0] * (x[2] * c(t)).exp() + x[1] * (x[3] * c(t)).exp() - c(1.0 / (1.0 + t));
    }
});

functions!(Pbc1, |x, f, c| {
    for (i, f) in f.iter_mut().enumerate() {
        let t = 2.0 * i as f64 / 29.0 - 1.0;
        let y = ((8.0 * t - 1.0).powi(2) + 1.0).sqrt() * (8.0 * t).atan() / (8.0 * t);
        let (t, one) = (c(t), c(1.0));
        *f = (x[0] + t * (x[1] + t * x[2])) / (one + t * (x[3] + t * x[4])) - c(y);
    }
});

functions!(Wong1, |x, f, c| {
    let from = |i: usize, centre: f64| (x[i] - c(centre)).square();
    let base = from(0, 10.0)
        + c(5.0) * from(1, 12.0)
        + x[2].powi(4)
        + c(3.0) * from(3, 11.0)
        + c(10.0) * x[4].powi(6)
        + c(7.0) * x[5].square()
        + x[6].powi(4)
        - c(4.0) * x[5] * x[6]
        - c(10.0) * x[5]
        - c(8.0) * x[6];
    let limits = [
        c(2.0) * x[0].square()
            + c(3.0) * x[1].powi(4)
            + x[2]
            + c(4.0) * x[3].square()
            + c(5.0) * x[4]
            - c(127.0),
        c(7.0) * x[0] + c(3.0) * x[1] + c(10.0) * x[2].square() + x[3] - x[4] - c(282.0),
        c(23.0) * x[0] + x[1].square() + c(6.0) * x[5].square() - c(8.0) * x[6] - c(196.0),
        c(4.0) * x[0].square() + x[1].square() - c(3.0) * x[0] * x[1]
            + c(2.0) * x[2].square()
            + c(5.0) * x[5]
            - c(11.0) * x[6],
    ];
    f[0] = base;
    for (f, limit) in f[1..].iter_mut().zip(limits) {
        *f = base + c(10.0) * limit;
    }
});

functions!(Mad2, |x, f, c| {
    f[0] = x[0].square() + x[1].square() + x[0] * x[1] - c(1.0);
    f[1] = x[0].sin();
    f[2] = -x[1].cos();
});

fn mad2() -> ProblemParams<'static> {
    let row: LinearConstraint = at_most(1, 2, &[(0, 3.0), (1, 1.0)], -2.5);
    plain(&[-2.0, -1.0], 3, Mad2).linear(vec![row])
}

pub(crate) fn all() -> Vec<Case> {
    let case = |name, optimum, params| Case {
        name,
        optimum,
        params,
    };
    vec![
        case("CB3", 2.0, || plain(&[2.0, 2.0], 3, Cb3)),
        case("DEM", -3.0, || plain(&[1.0, 1.0], 3, Dem)),
        case("QL", 7.2, || plain(&[-1.0, 5.0], 3, Ql)),
        case("LQ", -std::f64::consts::SQRT_2, || {
            plain(&[-0.5, -0.5], 2, Lq)
        }),
        case("Mifflin1", -1.0, || plain(&[0.8, 0.6], 2, Mifflin1)),
        case("Crescent", 0.0, || plain(&[-1.5, 2.0], 2, Crescent)),
        case("WF", 0.0, || plain(&[3.0, 1.0], 3, Wf)),
        case("EVD52", 3.599_719_3, || plain(&[1.0; 3], 6, Evd52)),
        case("Bard", 0.508_163_27e-1, || absolute(&[1.0; 3], 15, Bard)),
        case("OET6", 0.201_607_53e-2, || {
            absolute(&[1.0, 1.0, -3.0, -1.0], 21, Oet6)
        }),
        case("PBC1", 0.223_404_96e-1, || {
            absolute(&[0.0, -1.0, 10.0, 1.0, 10.0], 30, Pbc1)
        }),
        case("Wong1", 680.630_06, || {
            plain(&[1.0, 2.0, 0.0, 4.0, 0.0, 1.0, 1.0], 5, Wong1)
        }),
        case("MAD2", -0.330_357_14, mad2),
    ]
}
