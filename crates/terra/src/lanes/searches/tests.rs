use core::cell::{Cell, RefCell};
use std::vec;
use std::vec::Vec;

use super::*;
use crate::{GrouserRule, Grousers, RigidWheel, Settings, catalogue};

/// More than are searched at a time.
const POINTS: usize = SEARCHES + 5;

/// A search that looks at three slips, and how often its load was carried.
struct Three {
    load: f64,
    carried: Vec<bool>,
}

impl SlipSearch for Three {
    type Found = Vec<bool>;

    fn next(&self) -> (f64, f64) {
        (0.2 * self.carried.len() as f64, self.load)
    }

    fn feed(&mut self, found: Option<Traction>) {
        if let Some(found) = found {
            assert!(found.torque > 0.0 && found.drawbar_pull < self.load);
        }
        self.carried.push(found.is_some());
    }

    fn end(&self) -> Option<End<Vec<bool>>> {
        (self.carried.len() == 3).then(|| End::Found(self.carried.clone()))
    }
}

#[test]
fn every_search_is_fed_until_it_ends() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let kernel = BatchKernel::new(soil);
    let smooth = RigidWheel::new(0.1, 0.05).unwrap();
    let rule = GrouserRule::Lugs {
        count: 24.0,
        thickness: 0.002,
    };
    let lugged = smooth
        .with_grousers(Grousers { height: 0.01, rule })
        .unwrap();
    let ends = |wheel: RigidWheel, kernel: &BatchKernel, load: fn(usize) -> f64| {
        let on_soil = WheelOnSoil::new(wheel, *kernel.soil(), Settings::default()).unwrap();
        let ends = RefCell::new(vec![None; POINTS]);
        let count = Cell::new(0);
        let begin = |i: usize| {
            // one point has no search
            (i != 9).then(|| Three {
                load: load(i),
                carried: Vec::new(),
            })
        };
        let done = |i: usize, end: End<Vec<bool>>| {
            count.set(count.get() + 1);
            ends.borrow_mut()[i] = Some(match end {
                End::Found(carried) => carried,
                End::NoSolution => panic!("no search ends so"),
                End::Unsure => Vec::new(),
            });
        };
        kernel.searches(&on_soil, POINTS, begin, done).unwrap();
        assert_eq!(count.get(), POINTS);
        ends.into_inner()
    };
    let carried = ends(smooth, &kernel, |i| 10.0 + i as f64);
    for (i, end) in carried.into_iter().enumerate() {
        let expected = if i == 9 { vec![] } else { vec![true; 3] };
        assert_eq!(end, Some(expected));
    }
    // more than the soil carries, and a load that is none
    let none = ends(smooth, &kernel, |_| 1e9);
    assert_eq!(none[8], Some(vec![false; 3]));
    let lost = ends(smooth, &kernel, |_| f64::NAN);
    assert_eq!(lost[8], Some(vec![]));
    // no lanes for lugs, nor for a soil whose exponent depends on slip
    assert_eq!(ends(lugged, &kernel, |_| 10.0), vec![Some(vec![]); POINTS]);
    let digging = crate::SoilParams {
        n_1: 0.1,
        ..*soil.params()
    };
    let digging = BatchKernel::new(crate::Soil::new(digging).unwrap());
    assert_eq!(ends(smooth, &digging, |_| 10.0), vec![Some(vec![]); POINTS]);
}
