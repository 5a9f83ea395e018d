//! The work that the reference cases take, without a clock: nodes of an evaluation at a sinkage, evaluations of
//! a solve under a load. Compared with
//! `tests/snapshots/effort.txt` line by line: a change there is a change of the algorithm, to be reviewed.
//! `GROUSER_UPDATE=1 cargo test -p grouser-terra effort` writes it anew.

use std::cell::Cell;
use std::fmt::Write as _;
use std::string::String;
use std::{env, fs};

use super::integrals::{Nodes, OneByOne};
use super::{Contact, Integrals, Motion, Order, Panel, WheelSize};
use crate::quadrature::RuleView;
use crate::{
    Angle, Kinematics, RigidWheel, Settings, ShearLaw, Slip, SoilParams, WheelOnSoil, catalogue,
};

const SNAPSHOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/snapshots/effort.txt");

/// Nodes one by one, counted.
struct Counted(Cell<usize>);

impl Nodes<f64> for Counted {
    fn smooth(
        &self,
        contact: &Contact<f64>,
        friction: RuleView<'_>,
        cohesion: RuleView<'_>,
    ) -> Integrals<f64> {
        self.0
            .set(self.0.get() + 2 * friction.nodes.len() + cohesion.nodes.len());
        OneByOne.smooth(contact, friction, cohesion)
    }

    fn panel(&self, contact: &Contact<f64>, panel: Panel, rule: RuleView<'_>) -> Integrals<f64> {
        self.0.set(self.0.get() + rule.nodes.len());
        OneByOne.panel(contact, panel, rule)
    }
}

fn table() -> String {
    let cases = include_str!("../../tests/oracle/wheel_cases.csv");
    let mut table = String::from(
        "# what, soil, radius_m, width_m, rebound, slip, given | nodes, or evaluations\n",
    );
    for line in cases.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().expect("a number");
        let soil = catalogue::find(cells[1])
            .expect("in the catalogue")
            .soil()
            .and_then(|soil| soil.with_rebound(number(4)))
            .expect("complete");
        let wheel = RigidWheel::new(number(2), number(3)).expect("a wheel");
        let wheel_on_soil =
            WheelOnSoil::new(wheel, soil, Settings::default()).expect("a wheel on its soil");
        let slip = Slip::new(number(5)).expect("a slip");
        let motion = Kinematics::straight(slip);
        let given = if cells[0] == "sinkage" { 7 } else { 6 };
        let effort = if given == 7 {
            let general = wheel_on_soil
                .sinkage_under(number(7), &motion)
                .expect("a search");
            std::format!("{}", general.evaluations)
        } else {
            let theta_1 = super::entry_angle(number(6), number(2));
            let contact = wheel_on_soil.contact(theta_1, &motion);
            let nodes = Counted(Cell::new(0));
            contact.integrals(wheel_on_soil.tables(), wheel_on_soil.order(), &nodes);
            std::format!("{}", nodes.0.get())
        };
        let names = [
            cells[0],
            cells[1],
            cells[2],
            cells[3],
            cells[4],
            cells[5],
            cells[given],
        ];
        writeln!(table, "{} | {effort}", names.join(" ")).expect("to a string");
    }
    table
}

#[test]
fn effort_is_what_it_was() {
    let now = table();
    if env::var_os("GROUSER_UPDATE").is_some() {
        fs::write(SNAPSHOT, &now).expect("written");
    }
    let before = fs::read_to_string(SNAPSHOT).expect("the snapshot");
    let changed: Vec<_> = before
        .lines()
        .zip(now.lines())
        .filter(|(before, now)| before != now)
        .collect();
    assert!(changed.is_empty(), "{changed:#?}");
    assert_eq!(before.lines().count(), now.lines().count());
}

/// Soil of a cohesion so small that its shear has no digits left, sheared aslant: as many nodes as with one that has.
#[test]
fn a_cohesion_below_the_smallest_normal_number_takes_no_longer() {
    const LEAST_COHESION_PA: f64 = 7.7e-313;
    let nodes = |cohesion: f64| {
        let params = crate::Soil::bekker(69.0, 2.1e6, 0.9)
            .cohesion(cohesion)
            .phi(Angle::from_deg(0.0))
            .k_shear(1e-6)
            .stress_position(0.0, 0.0);
        let soil = params.params().and_then(crate::Soil::new).expect("a soil");
        let wheel = RigidWheel::new(0.25, 0.6).expect("a wheel");
        let wheel_on_soil =
            WheelOnSoil::new(wheel, soil, Settings::default()).expect("a wheel on its soil");
        let motion =
            Kinematics::with_slip_angle(Slip::new(0.06).expect("a slip"), Angle::from_deg(-2.9));
        let theta_1 = super::entry_angle(0.08, 0.25);
        let contact = wheel_on_soil.contact(theta_1, &motion.expect("a motion"));
        let nodes = Counted(Cell::new(0));
        contact.integrals(wheel_on_soil.tables(), wheel_on_soil.order(), &nodes);
        nodes.0.get()
    };
    assert_eq!(nodes(LEAST_COHESION_PA), nodes(1.0));
}

/// A contact on dry sand, of 400 that a number names: braked and driven, some with one piece only.
fn contact(i: u32, drift: f64) -> Contact<f64> {
    let share = |factor: f64| (f64::from(i) * factor).fract();
    let params = *catalogue::find("dry-sand")
        .and_then(|open| open.soil().ok())
        .expect("a soil")
        .params();
    let soil = crate::Soil::new(SoilParams {
        k_shear: 5e-4 * 100.0_f64.powf(share(0.618_034)),
        rebound: 0.5 * share(0.754_878),
        ..params
    });
    let motion = Motion {
        slip: 0.8 - 1.5 * share(0.569_840),
        q_y: drift * 0.002 * 100.0_f64.powf(share(0.819_173)),
        slip_angle: 0.1 * drift,
    };
    let (size, law) = (WheelSize::smooth(0.1, 0.05), ShearLaw::Coupled);
    let theta_1 = 0.05 + 1.3 * share(0.671_044);
    let laws = soil.expect("a soil").laws();
    let mut contact = Contact::new(&size, &laws, law, &motion, theta_1);
    match i % 8 {
        0 => contact.angles.theta_m = contact.angles.theta_1,
        1 => contact.angles.theta_m = contact.angles.theta_2,
        _ => {}
    }
    contact
}

/// Nodes of 400 contacts panel by panel: a snapshot.
#[test]
fn nodes_of_panels() {
    let nodes = |order: Order, drift: f64| {
        let nodes = Counted(Cell::new(0));
        for i in 0..400 {
            contact(i, drift).split(order, &nodes);
        }
        nodes.0.get()
    };
    let straight = [
        Order::Standard,
        Order::Check,
        Order::Reference,
        Order::Beyond,
    ];
    assert_eq!(
        straight.map(|order| nodes(order, 0.0)),
        [25_744, 51_488, 70_560, 127_808]
    );
    // halved where the stress turns
    let turning = [Order::Standard, Order::Check];
    assert_eq!(turning.map(|order| nodes(order, 1.0)), [50_656, 96_576]);
}

/// Every rule finds the same shear, whatever the panel: no two halves agree with the whole.
struct Disagreeing(Cell<u32>);

impl Nodes<f64> for Disagreeing {
    fn smooth(&self, _: &Contact<f64>, _: RuleView<'_>, _: RuleView<'_>) -> Integrals<f64> {
        Integrals::zero()
    }

    fn panel(&self, _: &Contact<f64>, _: Panel, _: RuleView<'_>) -> Integrals<f64> {
        self.0.set(self.0.get() + 1);
        Integrals {
            tau: 1.0,
            tau_side: 1.0,
            ..Integrals::zero()
        }
    }
}

/// A panel is halved sixteen times below its first halves: 2¹⁸ − 1 panels for each.
#[test]
fn halving_ends() {
    let mut contact = contact(2, 1.0);
    // nothing to cut: a wheel that turns faster than it travels and is sheared to less than twice K
    contact.shear.k_shear = 1.0;
    contact.shear.displacement.q = 0.97;
    contact.shear.displacement.one_minus_q = 0.03;
    contact.shear.q_y = 0.01;
    assert!(contact.shear.swings(contact.arc()));
    let nodes = Disagreeing(Cell::new(0));
    let sum = contact.split(Order::Standard, &nodes);
    assert_eq!(nodes.0.get(), 2 * ((1 << 18) - 1));
    assert_eq!((sum.tau, sum.tau_side), (262_144.0, 262_144.0));
}
