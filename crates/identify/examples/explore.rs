use grouser_identify::Parameter as P;
use grouser_identify::least_squares::*;
use grouser_identify::validate::{cmu, ding};
use grouser_identify::wheel::*;
use grouser_terra::{
    Angle, Bulldozing, LawChoice, ShearLaw, SlipSinkage, SoilParams, StressPosition,
};
#[allow(unused_imports)]
fn main() {
    let path = std::path::Path::new("/work/shared/data/cmu-wheel/trials.csv");
    let trials = cmu::trials(path, "smooth", 0.76).unwrap();
    let args: Vec<f64> = std::env::args()
        .skip(1)
        .map(|a| a.parse().unwrap())
        .collect();
    let (k, n) = (
        args.first().copied().unwrap_or(8000.0),
        args.get(1).copied().unwrap_or(1.46),
    );
    let soil = SoilParams {
        cohesion: 0.0,
        phi: Angle::from_deg(29.0),
        k_shear: 0.019,
        c_1: 0.17,
        c_2: 0.49,
        rebound: 0.25,
        n_1: 0.2,
        n_2: 0.3,
        unit_weight: Some(13e3),
        rear_drift: 1.0,
        rear_driving: args.get(2).copied().unwrap_or(0.0),
        laws: LawChoice {
            slip_sinkage: SlipSinkage::Whole,
            stress_position: StressPosition::Whole,
            shear: Some(ShearLaw::SlipVelocity),
            bulldozing: Some(Bulldozing::Chord),
        },
        ..SoilParams::bekker(0.0, k * 1e3, n)
    };
    let fixed = Fixed {
        wheel: cmu::smooth_wheel().unwrap(),
        soil,
        scatter: Scatter {
            pull: 0.5,
            side: 0.5,
            torque: 0.1,
            sinkage: 0.0007,
        },
    };
    let sets: Vec<(Vec<f64>, Vec<P>, Vec<(P, f64)>)> = {
        let b = vec![
            P::C1,
            P::C2,
            P::KShear,
            P::ExponentDriving,
            P::ExponentBraking,
            P::Rebound,
            P::SinkageDatum,
            P::SideDatum,
        ];
        let nl = vec![
            P::C1,
            P::C2,
            P::KShear,
            P::ExponentDriving,
            P::ExponentBraking,
            P::SinkageDatum,
            P::SideDatum,
        ];
        let with = |mut v: Vec<P>, more: &[P]| {
            v.extend(more);
            v
        };
        let nn = vec![
            P::C1,
            P::C2,
            P::KShear,
            P::ExponentBraking,
            P::Rebound,
            P::SinkageDatum,
            P::SideDatum,
        ];
        vec![
            (vec![0.0], b.clone(), vec![]),
            (vec![0.0], nl.clone(), vec![(P::Rebound, 0.25)]),
            (vec![0.0], nn, vec![(P::ExponentDriving, 0.0)]),
            (vec![0.0, 60.0], b.clone(), vec![]),
            (vec![0.0, 60.0], with(b.clone(), &[P::Cohesion]), vec![]),
        ]
    };
    for (betas, ps, set) in sets {
        let mut soil = soil;
        for (p, v) in set {
            p.put(&mut soil, v);
        }
        let fixed = Fixed { soil, ..fixed };
        println!(
            "== {betas:?} {:?}",
            ps.iter().map(|p| p.key()).collect::<Vec<_>>()
        );
        let straight: Vec<WheelTest> = trials
            .iter()
            .filter(|t| {
                betas
                    .iter()
                    .any(|b| (t.slip_angle.to_degrees() - b).abs() < 1e-6)
            })
            .map(|t| t.test)
            .collect();
        let model = WheelModel::new(fixed, &straight, &ps);
        let start: Vec<Bounded> = ps.iter().map(|p| p.bounded(&soil)).collect();
        let t0 = std::time::Instant::now();
        for loss in [Loss::Squares] {
            let settings = Settings {
                loss,
                steps: 200,
                ..Settings::default()
            };
            let (best, reached) = multi_start(
                &model,
                model.count(),
                &start,
                &settings,
                &StartSettings { starts: 6, seed: 1 },
            )
            .unwrap();
            println!(
                "{:?} cost {} reached {reached} evals {} jac {} {:?}",
                best.status,
                best.cost,
                best.evaluations,
                best.jacobians,
                t0.elapsed()
            );
            let u = Uncertainty::of(&best, loss);
            for (i, p) in ps.iter().enumerate() {
                println!(
                    "  {:20} {:9.4} ± {:8.4} {:?}",
                    p.key(),
                    p.to_key_unit(best.x[i]),
                    p.to_key_unit(u.standard_errors[i]),
                    u.verdicts[i]
                );
            }
            println!("  condition {:.1}", u.condition);
            for b in [0.0_f64, 15.0, 30.0, 60.0, 90.0] {
                let t: Vec<WheelTest> = trials
                    .iter()
                    .filter(|t| (t.slip_angle.to_degrees() - b).abs() < 1e-6)
                    .map(|t| t.test)
                    .collect();
                let p = predict(&fixed, &t, &ps, &best.x).unwrap();
                print!(
                    "  b {b:3} buried {:2} ",
                    p.iter().filter(|p| p.hub_buried).count()
                );
                for q in Quantity::ALL {
                    if t[0].read(q).is_some() {
                        let r: f64 = t
                            .iter()
                            .zip(&p)
                            .map(|(t, p)| (p.of(q) - t.read(q).unwrap()).powi(2))
                            .sum();
                        print!(
                            " {} {:.2}",
                            q.key(),
                            (r / t.len() as f64).sqrt() / q.scale()
                        );
                    }
                }
                println!();
            }
        }
    }
    let _ = ding::tests();
}
