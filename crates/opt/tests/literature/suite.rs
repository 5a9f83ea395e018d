//! What a test problem is, and the list of all of them.

use grouser_opt::{Exact, Functions, LinearConstraint, ProblemParams};

use super::{luksan_vlcek_linear, luksan_vlcek_unconstrained, other};

pub(crate) struct Case {
    pub(crate) name: &'static str,
    /// The best value published.
    pub(crate) optimum: f64,
    pub(crate) params: fn() -> ProblemParams<'static>,
}

/// The eighteen problems, in the order of the reference table.
pub(crate) fn all() -> Vec<Case> {
    use luksan_vlcek_linear as lin;
    use luksan_vlcek_unconstrained as lv;
    let case = |name, optimum, params| Case {
        name,
        optimum,
        params,
    };
    vec![
        case("CB2", 1.952_224_5, other::cb2),
        case("SPIRAL", 0.0, lv::spiral),
        case("RosenSuzuki", -44.0, lv::rosen_suzuki),
        case("PBC3", 0.420_214_27e-2, lv::pbc3),
        case("KowalikOsborne", 0.808_436_84e-2, lv::kowalik_osborne),
        case("Davidon2", 115.706_44, lv::davidon_2),
        case("OET5", 0.263_597_35e-2, lv::oet5),
        case("EXP", 0.122_371_25e-3, lv::exp),
        case("EVD61", 0.349_049_26e-1, lv::evd61),
        case("Filter", 0.618_528_48e-2, lv::filter),
        case("Wong2", 24.306_209, lv::wong2),
        case("Wong2-LC", 24.306_209, lin::wong2),
        case("MAD1", -0.389_659_52, lin::mad1),
        case("MAD4", -0.448_910_79, lin::mad4),
        case("PENTAGON", -1.859_618_7, lin::pentagon),
        case("MAD6", 0.101_830_89, lin::mad6),
        case("Polak3", 261.082_58, lv::polak3),
        case("MATLAB-doc", 0.0, other::matlab_page),
    ]
}

/// max f_i over m objectives.
pub(crate) fn plain(
    start: &[f64],
    m: usize,
    f: impl Functions + 'static,
) -> ProblemParams<'static> {
    ProblemParams::new(start, m, Exact(f))
}

/// max |f_i| over m objectives.
pub(crate) fn absolute(
    start: &[f64],
    m: usize,
    f: impl Functions + 'static,
) -> ProblemParams<'static> {
    plain(start, m, f).absolute(m)
}

/// Σ coefficient · x\[index\] ≤ bound, as row number `number`.
pub(crate) fn at_most(
    number: usize,
    n: usize,
    terms: &[(usize, f64)],
    bound: f64,
) -> LinearConstraint {
    let mut coefficients = vec![0.0; n];
    for &(index, coefficient) in terms {
        coefficients[index] = coefficient;
    }
    LinearConstraint::at_most(format!("row {number}"), coefficients, bound)
}
