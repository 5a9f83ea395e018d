//! What leaves the common case costs: `just cliffs` prints the table.

use std::hint::black_box;
use std::time::{Duration, Instant};

use grouser_terra::{
    Angle, GrouserRule, Grousers, Kinematics, LawPreset, RigidWheel, Settings, ShearLaw, Slip,
    Soil, SoilParams, WheelOnSoil, catalogue,
};

const RADIUS_M: f64 = 0.125;
const SOLVES: u32 = 60;
/// The least of so many rounds counts: others on the machine only add.
const ROUNDS: u32 = 15;

/// What a case has besides a smooth wheel that drives straight ahead on level, inelastic soil.
#[derive(Clone, Copy, Default)]
struct Case {
    name: &'static str,
    slip: f64,
    slip_angle_deg: f64,
    has_lugs: bool,
    rebound: f64,
    load_n: f64,
    shear: Option<ShearLaw>,
    preset: Option<LawPreset>,
    /// Cost over the common case at most.
    most: f64,
}

const COMMON: Case = Case {
    name: "driving, slip 0.3",
    slip: 0.3,
    slip_angle_deg: 0.0,
    has_lugs: false,
    rebound: 0.0,
    load_n: 80.0,
    shear: None,
    preset: None,
    most: 1.5,
};

const DRIVING: f64 = 5.0;
const BRAKING: f64 = 10.0;
const TOGETHER: f64 = 15.0;

#[rustfmt::skip]
fn cases() -> Vec<Case> {
    let one = Case { most: DRIVING, ..COMMON };
    let braking = Case { most: BRAKING, ..COMMON };
    let together = Case { most: TOGETHER, ..COMMON };
    vec![
        COMMON,
        Case { name: "slip 0", slip: 0.0, ..one },
        Case { name: "slip 0.9", slip: 0.9, ..one },
        Case { name: "half a radius deep", load_n: 800.0, ..one },
        Case { name: "lugs", has_lugs: true, ..one },
        Case { name: "rebound 0.3", rebound: 0.3, ..one },
        Case { name: "drift 20°", slip_angle_deg: 20.0, ..one },
        Case { name: "slip velocity", shear: Some(ShearLaw::SlipVelocity), ..one },
        Case { name: "preset `drift`", preset: Some(LawPreset::DRIFT), ..one },
        Case { name: "preset, drift 20°", preset: Some(LawPreset::DRIFT), slip_angle_deg: 20.0, ..together },
        Case { name: "braking, slip -0.005", slip: -0.005, ..braking },
        Case { name: "braking, slip -0.2", slip: -0.2, ..braking },
        Case { name: "braking, slip -0.7", slip: -0.7, ..braking },
        Case { name: "locked", slip: -1.0, ..braking },
        Case { name: "braking, lugs", slip: -0.2, has_lugs: true, ..together },
        Case { name: "braking, rebound", slip: -0.2, rebound: 0.3, ..together },
        Case { name: "braking, drift 20°", slip: -0.2, slip_angle_deg: 20.0, ..together },
        Case { name: "braking, preset", slip: -0.2, preset: Some(LawPreset::DRIFT), ..together },
        Case { name: "all", slip: -0.2, slip_angle_deg: 20.0, has_lugs: true, rebound: 0.3, ..together },
    ]
}

impl Case {
    fn solve(&self) -> impl Fn(f64) + use<> {
        let smooth = RigidWheel::new(RADIUS_M, 0.1).unwrap();
        let rule = GrouserRule::Lugs {
            count: 20.0,
            thickness: 0.002,
        };
        let wheel = if self.has_lugs {
            smooth
                .with_grousers(Grousers { height: 0.01, rule })
                .unwrap()
        } else {
            smooth
        };
        let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let params = SoilParams {
            rebound: self.rebound,
            unit_weight: Some(15e3),
            ..*sand.params()
        };
        let mut settings = Settings::default();
        if let Some(shear) = self.shear {
            settings.shear = shear;
        }
        let params = match self.preset {
            Some(preset) => SoilParams {
                laws: preset.laws,
                rear_drift: preset.rear_drift,
                sideways_support: preset.sideways_support,
                ..params
            },
            None => params,
        };
        let on_soil = WheelOnSoil::new(wheel, Soil::new(params).unwrap(), settings).unwrap();
        let angle = Angle::from_deg(self.slip_angle_deg);
        let motion = Kinematics::with_slip_angle(Slip::new(self.slip).unwrap(), angle).unwrap();
        let load = self.load_n;
        move |share| {
            let found = on_soil.sinkage_under(black_box(load * (1.0 + 1e-4 * share)), &motion);
            assert!(found.unwrap().sinkage().is_some());
        }
    }
}

/// The least time of a solve of each case: the rounds of all cases take turns, so that a busy machine hits all alike.
fn times(cases: &[Case]) -> Vec<Duration> {
    let solves: Vec<_> = cases.iter().map(Case::solve).collect();
    let mut least = vec![Duration::MAX; cases.len()];
    for _ in 0..ROUNDS {
        for (least, solve) in least.iter_mut().zip(&solves) {
            let began = Instant::now();
            for k in 0..SOLVES {
                solve(f64::from(k) / f64::from(SOLVES));
            }
            *least = (*least).min(began.elapsed() / SOLVES);
        }
    }
    least
}

#[test]
fn no_case_costs_many_times_the_common_one() {
    let cases = cases();
    let times = times(&cases);
    let common = times[0].as_secs_f64();
    println!("{:24} {:>8} {:>8} {:>8}", "case", "µs", "ratio", "at most");
    let mut beyond = Vec::new();
    for (case, time) in cases.iter().zip(&times) {
        let ratio = time.as_secs_f64() / common;
        let us = 1e6 * time.as_secs_f64();
        println!("{:24} {us:8.2} {ratio:8.1} {:8.1}", case.name, case.most);
        if ratio > case.most {
            beyond.push(format!("{}: {ratio:.1} of {}", case.name, case.most));
        }
    }
    assert!(beyond.is_empty(), "{beyond:?}");
}
