//! A batch against one point at a time, machine against portable, a lane against itself alone.
#![no_main]

mod bytes;
mod point;

use bytes::Bytes;
use grouser_terra::{BatchKernel, BatchOutcome, BatchPoints, Kinematics, RigidWheel, Settings, Slip, Soil, SoilParams, WheelOnSoil};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let Some(point) = point::point(&mut bytes) else {
        return;
    };
    let count = usize::from(bytes.u8() % 12);
    let (mut radius, mut width, mut rebound, mut slip, mut sinkage) =
        (vec![], vec![], vec![], vec![], vec![]);
    for _ in 0..count {
        let wild = bytes.u8() % 16 == 0;
        let mut number = |from: f64, to: f64| {
            if wild && bytes.u8() % 3 == 0 { bytes.any() } else { bytes.within(from, to) }
        };
        radius.push(number(0.02, 0.6));
        width.push(number(0.02, 0.5));
        let back = number(-1.0, 1.0);
        rebound.push(if back < 0.0 { 0.0 } else { back });
        slip.push(number(-0.3, 1.0));
        sinkage.push(number(0.0, 0.6) * radius.last().copied().unwrap_or(0.1));
    }
    let points = BatchPoints { radius: &radius, width: &width, rebound: &rebound, slip: &slip };
    let kernel = BatchKernel::new(point.soil);
    let mut out = vec![BatchOutcome::default(); count];
    kernel.forces(&points, &sinkage, &mut out).expect("equal lengths");
    let mut portable = vec![BatchOutcome::default(); count];
    let plain = BatchKernel::new(point.soil).portable();
    plain.forces(&points, &sinkage, &mut portable).expect("equal lengths");
    for i in 0..count {
        let alone = BatchPoints {
            radius: &radius[i..=i],
            width: &width[i..=i],
            rebound: &rebound[i..=i],
            slip: &slip[i..=i],
        };
        let mut one = [BatchOutcome::default()];
        kernel.forces(&alone, &sinkage[i..=i], &mut one).expect("equal lengths");
        // NaN in an error's payload is not equal to itself: compared as text.
        assert_eq!(format!("{:?}", one[0]), format!("{:?}", out[i]), "lane {i} of {count}");
        let scalar = (|| {
            let soil = SoilParams { rebound: rebound[i], ..*point.soil.params() };
            let wheel = RigidWheel::new(radius[i], width[i])?;
            let pair = WheelOnSoil::new(wheel, Soil::new(soil)?, Settings::default())?;
            pair.at_sinkage(sinkage[i], &Kinematics::straight(Slip::new(slip[i])?))
        })();
        match (&out[i], &portable[i], scalar) {
            (BatchOutcome::Done(a), BatchOutcome::Done(b), Ok(c)) => {
                let c = c.forces;
                let size = c.vertical_force.abs().max(c.drawbar_pull.abs()).max(c.torque.abs() / radius[i]);
                for (x, y, z) in [
                    (a.vertical_force, b.vertical_force, c.vertical_force),
                    (a.drawbar_pull, b.drawbar_pull, c.drawbar_pull),
                    (a.torque / radius[i], b.torque / radius[i], c.torque / radius[i]),
                ] {
                    assert!(x.is_finite() && y.is_finite() && z.is_finite());
                    assert!((x - z).abs() <= 3e-9 * size + 1e-300, "lanes {x:e}, alone {z:e} of {size:e}");
                    assert!((y - z).abs() <= 3e-9 * size + 1e-300, "portable {y:e}, alone {z:e} of {size:e}");
                }
            }
            (BatchOutcome::Bad(_), BatchOutcome::Bad(_), Err(_)) => {}
            (a, b, c) => panic!("lanes {a:?}, portable {b:?}, alone {c:?}"),
        }
    }
});
