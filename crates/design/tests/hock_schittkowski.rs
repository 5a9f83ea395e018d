//! Hock & Schittkowski, Test Examples for Nonlinear Programming Codes, Lecture Notes in Economics and
//! Mathematical Systems 187, 1981: problems with nonlinear constraints, as problem files, from their starts.
//!
//! Number 13, whose optimum has no multipliers (the constraints' gradients vanish together there), is left out.

use grouser_design::{Answer, parse};
use grouser_files::Document;
use grouser_opt::Status;
use std::fmt::Write as _; // writing to a string cannot fail

struct Case {
    number: u32,
    objective: &'static str,
    /// (start, lower, upper) of x1, x2, …
    variables: &'static [(f64, f64, f64)],
    constraints: &'static [&'static str],
    /// As published, or exact where the book gives it in closed form.
    optimum: f64,
}

const NONE: f64 = f64::INFINITY;

const CASES: &[Case] = &[
    Case {
        number: 6,
        objective: "(1-x1)^2",
        variables: &[(-1.2, -NONE, NONE), (1.0, -NONE, NONE)],
        constraints: &["10*(x2-x1^2) = 0"],
        optimum: 0.0,
    },
    Case {
        number: 7,
        objective: "ln(1+x1^2)-x2",
        variables: &[(2.0, -NONE, NONE), (2.0, -NONE, NONE)],
        constraints: &["(1+x1^2)^2+x2^2 = 4"],
        optimum: -1.732_050_807_568_877_2,
    },
    Case {
        number: 10,
        objective: "x1-x2",
        variables: &[(-10.0, -NONE, NONE), (10.0, -NONE, NONE)],
        constraints: &["-3*x1^2+2*x1*x2-x2^2+1 >= 0"],
        optimum: -1.0,
    },
    Case {
        number: 12,
        objective: "0.5*x1^2+x2^2-x1*x2-7*x1-7*x2",
        variables: &[(0.0, -NONE, NONE), (0.0, -NONE, NONE)],
        constraints: &["25-4*x1^2-x2^2 >= 0"],
        optimum: -30.0,
    },
    Case {
        number: 14,
        objective: "(x1-2)^2+(x2-1)^2",
        variables: &[(2.0, -NONE, NONE), (2.0, -NONE, NONE)],
        constraints: &["-0.25*x1^2-x2^2+1 >= 0", "x1-2*x2+1 = 0"],
        optimum: 1.393_464_980_689_302,
    },
    Case {
        number: 15,
        objective: "100*(x2-x1^2)^2+(1-x1)^2",
        variables: &[(-2.0, -NONE, 0.5), (1.0, -NONE, NONE)],
        constraints: &["x1*x2-1 >= 0", "x1+x2^2 >= 0"],
        optimum: 306.5,
    },
    Case {
        number: 19,
        objective: "(x1-10)^3+(x2-20)^3",
        variables: &[(20.1, 13.0, 100.0), (5.84, 0.0, 100.0)],
        constraints: &[
            "(x1-5)^2+(x2-5)^2-100 >= 0",
            "-(x2-5)^2-(x1-6)^2+82.81 >= 0",
        ],
        optimum: -6_961.813_881_5,
    },
    Case {
        number: 23,
        objective: "x1^2+x2^2",
        variables: &[(3.0, -50.0, 50.0), (1.0, -50.0, 50.0)],
        constraints: &[
            "x1+x2 >= 1",
            "x1^2+x2^2-1 >= 0",
            "9*x1^2+x2^2-9 >= 0",
            "x1^2-x2 >= 0",
            "x2^2-x1 >= 0",
        ],
        optimum: 2.0,
    },
    Case {
        number: 26,
        objective: "(x1-x2)^2+(x2-x3)^4",
        variables: &[(-2.6, -NONE, NONE), (2.0, -NONE, NONE), (2.0, -NONE, NONE)],
        constraints: &["(1+x2^2)*x1+x3^4-3 = 0"],
        optimum: 0.0,
    },
    Case {
        number: 27,
        objective: "0.01*(x1-1)^2+(x2-x1^2)^2",
        variables: &[(2.0, -NONE, NONE), (2.0, -NONE, NONE), (2.0, -NONE, NONE)],
        constraints: &["x1+x3^2+1 = 0"],
        optimum: 0.04,
    },
    Case {
        number: 39,
        objective: "-x1",
        variables: &[
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
        ],
        constraints: &["x2-x1^3-x3^2 = 0", "x1^2-x2-x4^2 = 0"],
        optimum: -1.0,
    },
    Case {
        number: 40,
        objective: "-x1*x2*x3*x4",
        variables: &[
            (0.8, -NONE, NONE),
            (0.8, -NONE, NONE),
            (0.8, -NONE, NONE),
            (0.8, -NONE, NONE),
        ],
        constraints: &["x1^3+x2^2-1 = 0", "x1^2*x4-x3 = 0", "x4^2-x2 = 0"],
        optimum: -0.25,
    },
    Case {
        number: 43,
        objective: "x1^2+x2^2+2*x3^2+x4^2-5*x1-5*x2-21*x3+7*x4",
        variables: &[
            (0.0, -NONE, NONE),
            (0.0, -NONE, NONE),
            (0.0, -NONE, NONE),
            (0.0, -NONE, NONE),
        ],
        constraints: &[
            "8-x1^2-x2^2-x3^2-x4^2-x1+x2-x3+x4 >= 0",
            "10-x1^2-2*x2^2-x3^2-2*x4^2+x1+x4 >= 0",
            "5-2*x1^2-x2^2-x3^2-2*x1+x2+x4 >= 0",
        ],
        optimum: -44.0,
    },
    Case {
        number: 56,
        objective: "-x1*x2*x3",
        variables: &[
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (0.508_900_008_680_898_2, -NONE, NONE),
            (0.5089, -NONE, NONE),
            (0.5089, -NONE, NONE),
            (0.5, -NONE, NONE),
        ],
        constraints: &[
            "x1-4.2*sin(x4)^2 = 0",
            "x2-4.2*sin(x5)^2 = 0",
            "x3-4.2*sin(x6)^2 = 0",
            "x1+2*x2+2*x3-7.2*sin(x7)^2 = 0",
        ],
        optimum: -3.456,
    },
    Case {
        number: 63,
        objective: "1000-x1^2-2*x2^2-x3^2-x1*x2-x1*x3",
        variables: &[(2.0, 0.0, NONE), (2.0, 0.0, NONE), (2.0, 0.0, NONE)],
        constraints: &["8*x1+14*x2+7*x3-56 = 0", "x1^2+x2^2+x3^2-25 = 0"],
        optimum: 961.715_172_1,
    },
    Case {
        number: 65,
        objective: "(x1-x2)^2+(x1+x2-10)^2/9+(x3-5)^2",
        variables: &[(-5.0, -4.5, 4.5), (5.0, -4.5, 4.5), (0.0, -5.0, 5.0)],
        constraints: &["48-x1^2-x2^2-x3^2 >= 0"],
        optimum: 0.953_528_856_7,
    },
    Case {
        number: 71,
        objective: "x1*x4*(x1+x2+x3)+x3",
        variables: &[
            (1.0, 1.0, 5.0),
            (5.0, 1.0, 5.0),
            (5.0, 1.0, 5.0),
            (1.0, 1.0, 5.0),
        ],
        constraints: &["x1*x2*x3*x4 >= 25", "x1^2+x2^2+x3^2+x4^2 = 40"],
        optimum: 17.014_017_3,
    },
    Case {
        number: 77,
        objective: "(x1-1)^2+(x1-x2)^2+(x3-1)^2+(x4-1)^4+(x5-1)^6",
        variables: &[
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
        ],
        constraints: &["x1^2*x4+sin(x4-x5) = 2*sqrt(2)", "x2+x3^4*x4^2 = 8+sqrt(2)"],
        optimum: 0.241_505_13,
    },
    Case {
        number: 78,
        objective: "x1*x2*x3*x4*x5",
        variables: &[
            (-2.0, -NONE, NONE),
            (1.5, -NONE, NONE),
            (2.0, -NONE, NONE),
            (-1.0, -NONE, NONE),
            (-1.0, -NONE, NONE),
        ],
        constraints: &[
            "x1^2+x2^2+x3^2+x4^2+x5^2 = 10",
            "x2*x3-5*x4*x5 = 0",
            "x1^3+x2^3+1 = 0",
        ],
        optimum: -2.919_700_41,
    },
    Case {
        number: 79,
        objective: "(x1-1)^2+(x1-x2)^2+(x2-x3)^2+(x3-x4)^4+(x4-x5)^4",
        variables: &[
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (2.0, -NONE, NONE),
        ],
        constraints: &[
            "x1+x2^2+x3^3 = 2+3*sqrt(2)",
            "x2-x3^2+x4 = -2+2*sqrt(2)",
            "x1*x5 = 2",
        ],
        optimum: 0.078_776_820_9,
    },
    Case {
        number: 80,
        objective: "exp(x1*x2*x3*x4*x5)",
        variables: &[
            (-2.0, -2.3, 2.3),
            (2.0, -2.3, 2.3),
            (2.0, -3.2, 3.2),
            (-1.0, -3.2, 3.2),
            (-1.0, -3.2, 3.2),
        ],
        constraints: &[
            "x1^2+x2^2+x3^2+x4^2+x5^2 = 10",
            "x2*x3-5*x4*x5 = 0",
            "x1^3+x2^3+1 = 0",
        ],
        optimum: 0.053_949_847_8,
    },
    Case {
        number: 93,
        objective: "0.0204*x1*x4*(x1+x2+x3)+0.0187*x2*x3*(x1+1.57*x2+x4)+0.0607*x1*x4*x5^2*(x1+x2+x3)+0.0437*x2*x3*x6^2*(x1+1.57*x2+x4)",
        variables: &[
            (5.54, 0.0, NONE),
            (4.4, 0.0, NONE),
            (12.02, 0.0, NONE),
            (11.82, 0.0, NONE),
            (0.702, 0.0, NONE),
            (0.852, 0.0, NONE),
        ],
        constraints: &[
            "0.001*x1*x2*x3*x4*x5*x6-2.07 >= 0",
            "1-0.00062*x1*x4*x5^2*(x1+x2+x3)-0.00058*x2*x3*x6^2*(x1+1.57*x2+x4) >= 0",
        ],
        optimum: 135.075_961,
    },
    Case {
        number: 100,
        objective: "(x1-10)^2+5*(x2-12)^2+x3^4+3*(x4-11)^2+10*x5^6+7*x6^2+x7^4-4*x6*x7-10*x6-8*x7",
        variables: &[
            (1.0, -NONE, NONE),
            (2.0, -NONE, NONE),
            (0.0, -NONE, NONE),
            (4.0, -NONE, NONE),
            (0.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
        ],
        constraints: &[
            "127-2*x1^2-3*x2^4-x3-4*x4^2-5*x5 >= 0",
            "282-7*x1-3*x2-10*x3^2-x4+x5 >= 0",
            "196-23*x1-x2^2-6*x6^2+8*x7 >= 0",
            "-4*x1^2-x2^2+3*x1*x2-2*x3^2-5*x6+11*x7 >= 0",
        ],
        optimum: 680.630_057_3,
    },
    Case {
        number: 104,
        objective: "0.4*x1^0.67*x7^-0.67+0.4*x2^0.67*x8^-0.67+10-x1-x2",
        variables: &[
            (6.0, 0.1, 10.0),
            (3.0, 0.1, 10.0),
            (0.4, 0.1, 10.0),
            (0.2, 0.1, 10.0),
            (6.0, 0.1, 10.0),
            (6.0, 0.1, 10.0),
            (1.0, 0.1, 10.0),
            (0.5, 0.1, 10.0),
        ],
        constraints: &[
            "1-0.0588*x5*x7-0.1*x1 >= 0",
            "1-0.0588*x6*x8-0.1*x1-0.1*x2 >= 0",
            "1-4*x3/x5-2*x3^-0.71/x5-0.0588*x3^-1.3*x7 >= 0",
            "1-4*x4/x6-2*x4^-0.71/x6-0.0588*x4^-1.3*x8 >= 0",
            "0.4*x1^0.67*x7^-0.67+0.4*x2^0.67*x8^-0.67+10-x1-x2 >= 1",
            "0.4*x1^0.67*x7^-0.67+0.4*x2^0.67*x8^-0.67+10-x1-x2 <= 4.2",
        ],
        optimum: 3.951_163_439_6,
    },
    Case {
        number: 106,
        objective: "x1+x2+x3",
        variables: &[
            (5000.0, 100.0, 10_000.0),
            (5000.0, 1000.0, 10_000.0),
            (5000.0, 1000.0, 10_000.0),
            (200.0, 10.0, 1000.0),
            (350.0, 10.0, 1000.0),
            (150.0, 10.0, 1000.0),
            (225.0, 10.0, 1000.0),
            (425.0, 10.0, 1000.0),
        ],
        constraints: &[
            "1-0.0025*(x4+x6) >= 0",
            "1-0.0025*(x5+x7-x4) >= 0",
            "1-0.01*(x8-x5) >= 0",
            "x1*x6-833.33252*x4-100*x1+83333.333 >= 0",
            "x2*x7-1250*x5-x2*x4+1250*x4 >= 0",
            "x3*x8-1250000-x3*x5+2500*x5 >= 0",
        ],
        optimum: 7049.248,
    },
    Case {
        number: 108,
        objective: "-0.5*(x1*x4-x2*x3+x3*x9-x5*x9+x5*x8-x6*x7)",
        variables: &[
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, -NONE, NONE),
            (1.0, 0.0, NONE),
        ],
        constraints: &[
            "1-x3^2-x4^2 >= 0",
            "1-x9^2 >= 0",
            "1-x5^2-x6^2 >= 0",
            "1-x1^2-(x2-x9)^2 >= 0",
            "1-(x1-x5)^2-(x2-x6)^2 >= 0",
            "1-(x1-x7)^2-(x2-x8)^2 >= 0",
            "1-(x3-x5)^2-(x4-x6)^2 >= 0",
            "1-(x3-x7)^2-(x4-x8)^2 >= 0",
            "1-x7^2-(x8-x9)^2 >= 0",
            "x1*x4-x2*x3 >= 0",
            "x3*x9 >= 0",
            "-x5*x9 >= 0",
            "x5*x8-x6*x7 >= 0",
        ],
        optimum: -0.866_025_403_8,
    },
];

#[test]
fn constrained_problems_reach_their_optima() {
    for case in CASES {
        let mut text = String::from("method = \"minimax\"\n[variables]\n");
        for (i, (start, lower, upper)) in case.variables.iter().enumerate() {
            let _ = writeln!(
                text,
                "x{} = {{ start = {start:?}, lower = {lower:?}, upper = {upper:?} }}",
                i + 1
            );
        }
        let _ = writeln!(
            text,
            "[objectives]\nf = \"{}\"\n[constraints]",
            case.objective
        );
        for (j, constraint) in case.constraints.iter().enumerate() {
            let _ = writeln!(text, "g{} = \"{constraint}\"", j + 1);
        }
        let design = parse(&Document::from_text("hs.toml", text).unwrap()).unwrap();
        let Answer::Optimum(found) = design.solve().unwrap() else {
            panic!("minimax gives one point")
        };
        assert_eq!(found.status, Status::Converged, "HS{}", case.number);
        let error = (found.maximum - case.optimum).abs() / (1.0 + case.optimum.abs());
        assert!(
            error <= 1e-6,
            "HS{}: {} instead of {}",
            case.number,
            found.maximum,
            case.optimum
        );
        assert!(
            found.kkt.violation <= 1e-8,
            "HS{}: {:?}",
            case.number,
            found.kkt
        );
    }
}
