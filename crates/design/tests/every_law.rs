//! Every variant of every law through every kernel, compared with the general contact, and the table of cases that the tests
//! of Python and the page read (`every_law/cases.csv`; `GROUSER_WRITE_CASES=1` writes it).

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::Path;

use grouser_design::{Design, State};
use grouser_files::{Document, soil};
use grouser_opt::{CertifySettings, Variable};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::wheel_loads;
use grouser_terra::catalogue::Completion;
use grouser_terra::{
    Accuracy, Angle, BatchColumns, BatchKernel, BatchPoints, Bekker, BestOf, BestSlipColumns,
    Bulldozing, GrouserRule, Grousers, Kernel, Kinematics, LawChoice, Pressure, Reece, RigidWheel,
    Settings, ShearLaw, Slip, SlipNorm, SlipSinkage, SlopeOutcome, Soil, SoilColumns, SoilParams,
    SolveStatus, StressPosition, WheelOnSoil,
};
use grouser_terrain::{Demand, DemandSolver, Envelope, SlipTable};

const LOAD_N: f64 = 60.0;
/// Forces over max(load, |pull|, |torque|/r): both sides of a comparison are accurate to 1e-9.
const CLOSE: f64 = 1e-8;
/// The same for forces to 1e-6 (`Accuracy::Simulation`).
const ROUGH: f64 = 3e-6;

/// A law on a soil and under a wheel that make it count.
struct Case {
    name: String,
    soil: Soil,
    wheel: RigidWheel,
}

fn smooth() -> RigidWheel {
    RigidWheel::new(0.125, 0.1).unwrap()
}

/// Each pressure law; a further one does not compile without an example here.
fn pressures() -> [Pressure; 2] {
    let of = |law: Option<Pressure>| match law {
        None => Pressure::Bekker(Bekker {
            k_c: 900.0,
            k_phi: 1.5284e6,
        }),
        Some(Pressure::Bekker(_) | Pressure::Reece(_)) => Pressure::Reece(Reece {
            k_c_prime: 10.0,
            k_phi_prime: 300.0,
        }),
    };
    [of(None), of(Some(of(None)))]
}

/// Each rule of grousers, likewise.
fn rules() -> [GrouserRule; 3] {
    let after = |rule: GrouserRule| match rule {
        GrouserRule::Tips => GrouserRule::AreaShare { tips: 0.3 },
        GrouserRule::AreaShare { .. } | GrouserRule::Lugs { .. } => GrouserRule::Lugs {
            count: 18.0,
            thickness: 0.002,
        },
    };
    let tips = GrouserRule::Tips;
    [tips, after(tips), after(after(tips))]
}

/// The keys in soil files and names of every law that a soil file chooses, with the choice.
fn choices() -> Vec<(&'static str, &'static str, LawChoice)> {
    let own = LawChoice::default();
    let mut out = Vec::new();
    for law in ShearLaw::ALL {
        let shear = Some(law);
        out.push(("shear", law.key(), LawChoice { shear, ..own }));
    }
    for law in Bulldozing::ALL {
        let bulldozing = Some(law);
        out.push(("bulldozing", law.key(), LawChoice { bulldozing, ..own }));
    }
    for slip_norm in SlipNorm::ALL {
        let own = LawChoice { slip_norm, ..own };
        out.push(("slip_norm", slip_norm.key(), own));
        for stress_position in StressPosition::ALL {
            let laws = LawChoice {
                stress_position,
                ..own
            };
            out.push(("stress_position", stress_position.key(), laws));
        }
        for slip_sinkage in SlipSinkage::ALL {
            let laws = LawChoice {
                slip_sinkage,
                ..own
            };
            out.push(("slip_sinkage", slip_sinkage.key(), laws));
        }
    }
    out
}

fn soil_with(lines: &str) -> Soil {
    let text = include_str!("every_law/soil.toml").to_owned() + lines;
    let document = Document::from_text("soil.toml", text).unwrap();
    let file = soil::parse(&document).unwrap();
    file.completed(&Completion::default()).unwrap()
}

/// Every law on a soil with all numbers, and on one with those alone that lanes and the proved remainder serve.
fn cases() -> Vec<Case> {
    let mut out = Vec::new();
    let full = *soil_with("").params();
    let plain = SoilParams {
        n_1: 0.0,
        n_2: 0.0,
        rear_driving: 0.0,
        transport_layer: 0.0,
        rebound: 0.0,
        ..full
    };
    for base in [full, plain] {
        let mut add = |name: String, params: SoilParams, wheel: RigidWheel| {
            let soil = Soil::new(params).unwrap();
            out.push(Case { name, soil, wheel });
        };
        for (of, name, laws) in choices() {
            let name = format!("{of} {name}, {}", laws.slip_norm.key());
            add(name, SoilParams { laws, ..base }, smooth());
        }
        for pressure in pressures() {
            let name = format!("pressure {}", pressure.key());
            add(name, SoilParams { pressure, ..base }, smooth());
        }
        for rule in rules() {
            let height = 0.01;
            let wheel = smooth().with_grousers(Grousers { height, rule }).unwrap();
            add(format!("grousers {rule:?}"), base, wheel);
        }
    }
    out
}

impl Case {
    fn by(&self, accuracy: Accuracy) -> WheelOnSoil {
        let settings = Settings {
            accuracy,
            ..Settings::default()
        };
        WheelOnSoil::new(self.wheel, self.soil, settings).unwrap()
    }

    /// Sinkage, pull and torque of the general contact; `None` where the load is not carried.
    fn exact(&self, slip: f64) -> Option<[f64; 3]> {
        numbers(&self.by(Accuracy::Reference), &straight(slip))
    }

    fn assert_near(&self, kernel: &str, found: [f64; 3], exact: [f64; 3], close: f64) {
        let radius = self.wheel.running_radius();
        let size = LOAD_N.max(exact[1].abs()).max(exact[2].abs() / radius);
        let units = [radius, size, size * radius];
        for ((found, exact), unit) in found.into_iter().zip(exact).zip(units) {
            assert!(
                (found - exact).abs() <= close * unit,
                "{}: {kernel} computes {found}, the general contact {exact}",
                self.name
            );
        }
    }

    fn one_by_one(&self) {
        for (slip, angle) in [(0.3, 0.0), (-0.3, 0.0), (0.2, 15.0), (-0.2, -15.0)] {
            let motion =
                Kinematics::with_slip_angle(Slip::new(slip).unwrap(), Angle::from_deg(angle));
            let motion = if angle == 0.0 {
                straight(slip)
            } else {
                motion.unwrap()
            };
            let exact = numbers(&self.by(Accuracy::Reference), &motion).unwrap();
            let standard = numbers(&self.by(Accuracy::Standard), &motion).unwrap();
            self.assert_near("one by one", standard, exact, CLOSE);
            let quick = self
                .by(Accuracy::Simulation)
                .forces_at(exact[0], &motion)
                .unwrap();
            let quick = [exact[0], quick.drawbar_pull, quick.torque];
            self.assert_near("a step in time", quick, exact, ROUGH);
        }
    }

    /// The same slips by `under_load`, `under_load_on` and `curve`.
    fn batch_and_range(&self) {
        let slip: Vec<f64> = (0..60).map(|i| 0.015 * f64::from(i)).collect();
        let kernel = BatchKernel::new(self.soil);
        if self.wheel.grousers().is_some() {
            let refused = columns(&slip, |out| kernel.curve(&self.wheel, LOAD_N, &slip, out));
            assert!(refused.is_err(), "{}", self.name);
            return;
        }
        let points = BatchPoints {
            radius: self.wheel.radius().into(),
            width: self.wheel.width().into(),
            rebound: self.soil.params().rebound.into(),
            slip: (&slip).into(),
        };
        let soils = SoilColumns::from_soil(&self.soil);
        let exact: Vec<_> = slip.iter().map(|slip| self.exact(*slip)).collect();
        for (name, found) in [
            (
                "a batch",
                columns(&slip, |out| kernel.under_load(&points, LOAD_N, out)),
            ),
            (
                "a batch of soils",
                columns(&slip, |out| {
                    kernel.under_load_on(&soils, &points, LOAD_N, out)
                }),
            ),
            (
                "a range",
                columns(&slip, |out| kernel.curve(&self.wheel, LOAD_N, &slip, out)),
            ),
        ] {
            for (found, exact) in found.unwrap().into_iter().zip(&exact) {
                match (found, *exact) {
                    (Some(found), Some(exact)) => self.assert_near(name, found, exact, CLOSE),
                    (found, exact) => assert_eq!(found, exact, "{}: {name}", self.name),
                }
            }
        }
    }

    /// What lanes look for over slip, compared with the general searches.
    fn searches(&self) {
        let (kernel, alone) = (BatchKernel::new(self.soil), self.by(Accuracy::Standard));
        let slope = Angle::from_deg(3.0);
        let (mut slip, mut value) = ([0.0], [0.0]);
        let mut status = [SolveStatus::default()];
        let slopes = [slope.rad()];
        kernel
            .slip_demand(&self.wheel, LOAD_N, &slopes, &mut slip, &mut status)
            .unwrap();
        let held = match alone.slip_demand(LOAD_N, slope).unwrap() {
            SlopeOutcome::Holds { slip } => slip.value(),
            _ => f64::NAN,
        };
        let near = |what, found: f64, exact: f64| {
            assert!(
                (found - exact).abs() < 1e-7 || found.is_nan() && exact.is_nan(),
                "{}: {what} {found} {exact}",
                self.name
            );
        };
        near("slip demand", slip[0], held);
        let mut out = BestSlipColumns {
            slip: &mut slip,
            value: &mut value,
            status: &mut status,
        };
        kernel
            .best_slip(&self.wheel, BestOf::Efficiency, LOAD_N, &mut out)
            .unwrap();
        let best = alone.slip_of_maximum_efficiency(LOAD_N).unwrap().unwrap();
        near("efficiency", value[0], best.value);
    }

    /// A pose of a slip map: its slip balances the pulls of the general contacts, and the table of the map has it.
    fn map(&self) {
        /// What an unrefined table may lack of a slip.
        const TABLE: f64 = 0.02;
        const PITCH: f64 = 0.05;
        let file = "../../examples/robots/skid-steer.toml";
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        let mut model = RobotModel::read(&file).unwrap();
        for mount in &mut model.wheels {
            mount.wheel = self.wheel;
        }
        let (weight, loads) = (model.weight(), wheel_loads(&model, PITCH, 0.0).loads);
        let solver = DemandSolver::new(model, self.soil).unwrap();
        let Demand::Drives(driving) = solver.demand(PITCH, 0.0).unwrap() else {
            panic!("{}: a pitch of {PITCH}", self.name);
        };
        let exact = self.by(Accuracy::Reference);
        let motion = straight(driving.slip);
        let pull = |load: &f64| {
            let point = exact.under_load(*load, &motion).unwrap().point();
            point.unwrap().forces.drawbar_pull
        };
        let lacking = loads.iter().map(pull).sum::<f64>() - weight * PITCH.sin();
        assert!(
            lacking.abs() < 1e-6 * weight,
            "{}: a map lacks {lacking} N",
            self.name
        );
        let envelope = Envelope::within(solver.model(), 0.3, 0.1).unwrap();
        let table = SlipTable::coarse(&solver, envelope).unwrap();
        let Demand::Drives(read) = table.demand(&solver, PITCH, 0.0).unwrap() else {
            panic!("{}: the table at a pitch of {PITCH}", self.name);
        };
        let off = (read.slip - driving.slip).abs();
        assert!(off < TABLE, "{}: a map's table is {off} off", self.name);
    }

    /// A certificate over a box as small as a point is the general contact's value, or names the law without bounds.
    fn tape(&self) {
        const SLIP: f64 = 0.3;
        let design = Design::builder(&self.wheel, &self.soil, State::under_load(LOAD_N))
            .variable(Variable::bounded("slip", SLIP, SLIP, SLIP + 1e-7))
            .minimise("sum", "drawbar_pull_n + torque_nm + 1e3 * sinkage_m")
            .build()
            .unwrap();
        let mut settings = CertifySettings::default();
        settings.time_limit_s = Some(30.0);
        let certified = design.certify(&settings, &mut |_| ControlFlow::Continue(()), None);
        let params = self.soil.params();
        let laws = params.unserved_by(Kernel::Tape);
        assert!(self.wheel.is_served_by(Kernel::Tape), "{}", self.name);
        if let Some((_, law)) = laws {
            let refused = certified.unwrap_err().to_string();
            assert!(refused.contains(law), "{}: {refused}", self.name);
            return;
        }
        let certificate = certified.unwrap();
        let [sinkage, pull, torque] = self.exact(SLIP).unwrap();
        let exact = pull + torque + 1e3 * sinkage;
        assert!(
            certificate.status.is_proved()
                && (certificate.lower - exact).abs() < 1e-4
                && (certificate.upper - exact).abs() < 1e-4,
            "{}: the general contact computes {exact}, {certificate:?}",
            self.name
        );
        let remainder = design.force_remainder().unwrap();
        let is_served = params.unserved_by(Kernel::Remainder).is_none() && params.rebound == 0.0;
        assert!(
            remainder.is_proved || !is_served,
            "{}: {remainder:?}",
            self.name
        );
    }
}

fn straight(slip: f64) -> Kinematics {
    Kinematics::straight(Slip::new(slip).unwrap())
}

fn numbers(on_soil: &WheelOnSoil, motion: &Kinematics) -> Option<[f64; 3]> {
    let point = on_soil.under_load(LOAD_N, motion).unwrap().point()?;
    let forces = point.forces;
    Some([point.sinkage, forces.drawbar_pull, forces.torque])
}

/// Sinkage, pull and torque at each slip by what fills the columns; `None` for a point that is not solved.
fn columns(
    slip: &[f64],
    fill: impl FnOnce(&mut BatchColumns<'_>) -> grouser_terra::Result<()>,
) -> grouser_terra::Result<Vec<Option<[f64; 3]>>> {
    let n = slip.len();
    let [mut sinkage, mut vertical_force, mut pull, mut torque] = [(); 4].map(|()| vec![0.0; n]);
    let mut status = vec![SolveStatus::default(); n];
    fill(&mut BatchColumns {
        sinkage: &mut sinkage,
        vertical_force: &mut vertical_force,
        drawbar_pull: &mut pull,
        torque: &mut torque,
        status: &mut status,
    })?;
    let of = |i: usize| [sinkage[i], pull[i], torque[i]];
    let solved = |i: usize| (status[i] == SolveStatus::Solved).then(|| of(i));
    Ok((0..n).map(solved).collect())
}

#[test]
fn every_law_is_the_same_in_every_kernel() {
    for case in cases() {
        case.one_by_one();
        case.batch_and_range();
        case.searches();
        case.map();
        case.tape();
    }
}

/// Each law that a soil file chooses has its rows in the table, and the numbers there are those of the general contact.
#[test]
fn every_law_has_its_rows_in_the_table_of_cases() {
    const HEADER: &str = "laws,slip,slip_angle_deg,sinkage_m,drawbar_pull_n,torque_nm\n";
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/every_law/cases.csv");
    let mut table = HEADER.to_owned();
    for (key, name, laws) in choices() {
        let norm = match key {
            "stress_position" | "slip_sinkage" => format!("slip_norm={} ", laws.slip_norm.key()),
            _ => String::new(),
        };
        let laws = format!("{norm}{key}={name}");
        let lines = laws
            .replace(' ', "\n")
            .replace('=', " = \"")
            .replace('\n', "\"\n");
        let soil = soil_with(&format!("{lines}\"\n"));
        let exact = WheelOnSoil::new(
            smooth(),
            soil,
            Settings {
                accuracy: Accuracy::Reference,
                ..Settings::default()
            },
        )
        .unwrap();
        for (slip, angle) in [(0.3, 0.0), (-0.3, 0.0), (0.2, 15.0)] {
            let slip_value = Slip::new(slip).unwrap();
            let motion = Kinematics::with_slip_angle(slip_value, Angle::from_deg(angle)).unwrap();
            let [sinkage, pull, torque] = numbers(&exact, &motion).unwrap();
            writeln!(
                table,
                "{laws},{slip},{angle},{sinkage:.9e},{pull:.9e},{torque:.9e}"
            )
            .unwrap();
        }
    }
    if std::env::var_os("GROUSER_WRITE_CASES").is_some() {
        std::fs::write(&file, &table).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    let (mut written, mut computed) = (written.lines(), table.lines());
    loop {
        match (written.next(), computed.next()) {
            (None, None) => break,
            (written, computed) => assert!(
                is_same_row(written.unwrap_or_default(), computed.unwrap_or_default()),
                "{}: {written:?}, computed {computed:?}; GROUSER_WRITE_CASES=1 writes the table",
                file.display()
            ),
        }
    }
}

/// The same names, and numbers to the digits that are written and the kernel keeps.
fn is_same_row(written: &str, computed: &str) -> bool {
    let same = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-8 * a.abs().max(1e-3),
        _ => a == b,
    };
    written.split(',').count() == computed.split(',').count()
        && written.split(',').zip(computed.split(',')).all(same)
}

/// A kernel asks a law what it is; a comparison with one variant is a refusal that a new variant passes unseen.
#[test]
fn no_kernel_compares_with_a_law() {
    let chosen = [
        "ShearLaw",
        "SlipNorm",
        "SlipSinkage",
        "StressPosition",
        "Bulldozing",
    ];
    let of_numbers = ["Pressure", "GrouserRule"];
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    for folder in ["terra/src", "design/src"] {
        for (file, text) in sources(&crates.join(folder)) {
            let is_kernel = file.contains("/lanes/") || folder == "design/src";
            let own = text.split("#[cfg(test)]").next().unwrap_or_default();
            for line in own
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"))
            {
                let names =
                    |law: &&str| line.contains(&format!("{law}::")) && !line.contains("::ALL");
                let compares = ["==", "!=", "matches!", "if let ", " else {"]
                    .iter()
                    .any(|by| line.contains(by));
                let is_named = chosen.iter().any(names);
                if is_kernel && is_named || compares && (is_named || of_numbers.iter().any(names)) {
                    found.push(format!("{file}: {}", line.trim()));
                }
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The Rust files of a folder but those of tests.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.to_string_lossy().replace('\\', "/");
        if path.is_dir() {
            out.extend(sources(&path));
        } else if path.extension().is_some_and(|of| of == "rs") && !name.ends_with("tests.rs") {
            out.push((name, std::fs::read_to_string(&path).unwrap()));
        }
    }
    out
}
