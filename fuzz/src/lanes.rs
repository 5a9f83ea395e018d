//! A batch against one point at a time, machine against portable, a lane against itself alone.

use crate::bytes::Bytes;
use grouser_terra::{
    BatchColumns, BatchKernel, BatchPoints, Kinematics, RigidWheel, Settings, Slip, Soil,
    SoilParams, SolveStatus, WheelOnSoil,
};

/// Status, vertical force, drawbar pull and torque of each point.
fn forces(
    kernel: &BatchKernel,
    points: &BatchPoints<'_>,
    sinkage: &[f64],
) -> Vec<(SolveStatus, [f64; 3])> {
    let n = sinkage.len();
    let [mut z, mut w, mut pull, mut torque] = [(); 4].map(|()| vec![0.0; n]);
    let mut status = vec![SolveStatus::default(); n];
    let mut out = BatchColumns {
        sinkage: &mut z,
        vertical_force: &mut w,
        drawbar_pull: &mut pull,
        torque: &mut torque,
        status: &mut status,
    };
    kernel
        .forces(points, sinkage, &mut out)
        .expect("equal lengths");
    (0..n)
        .map(|i| (status[i], [w[i], pull[i], torque[i]]))
        .collect()
}

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let Some(point) = crate::point::point(&mut bytes) else {
        return;
    };
    let count = usize::from(bytes.u8() % 12);
    let (mut radius, mut width, mut rebound, mut slip, mut sinkage) =
        (vec![], vec![], vec![], vec![], vec![]);
    for _ in 0..count {
        let wild = bytes.u8() % 16 == 0;
        let mut number = |from: f64, to: f64| {
            if wild && bytes.u8() % 3 == 0 {
                bytes.any()
            } else {
                bytes.within(from, to)
            }
        };
        radius.push(number(0.02, 0.6));
        width.push(number(0.02, 0.5));
        let back = number(-1.0, 1.0);
        rebound.push(if back < 0.0 { 0.0 } else { back });
        slip.push(number(-0.3, 1.0));
        sinkage.push(number(0.0, 0.6) * radius.last().copied().unwrap_or(0.1));
    }
    let points = BatchPoints {
        radius: (&radius).into(),
        width: (&width).into(),
        rebound: (&rebound).into(),
        slip: (&slip).into(),
    };
    let kernel = BatchKernel::new(point.soil);
    let out = forces(&kernel, &points, &sinkage);
    let portable = forces(&BatchKernel::new(point.soil).portable(), &points, &sinkage);
    for i in 0..count {
        let alone = BatchPoints {
            radius: radius[i].into(),
            width: width[i].into(),
            rebound: rebound[i].into(),
            slip: slip[i].into(),
        };
        let one = forces(&kernel, &alone, &sinkage[i..=i]);
        // NaN is not equal to itself: compared as text.
        assert_eq!(
            format!("{:?}", one[0]),
            format!("{:?}", out[i]),
            "lane {i} of {count}"
        );
        let scalar = (|| {
            let soil = SoilParams {
                rebound: rebound[i],
                ..*point.soil.params()
            };
            let wheel = RigidWheel::new(radius[i], width[i])?;
            let contact = WheelOnSoil::new(wheel, Soil::new(soil)?, Settings::default())?;
            contact.at_sinkage(sinkage[i], &Kinematics::straight(Slip::new(slip[i])?))
        })();
        match (out[i], portable[i], scalar) {
            ((SolveStatus::Solved, a), (SolveStatus::Solved, b), Ok(c)) => {
                let c = c.forces;
                let size = c
                    .vertical_force
                    .abs()
                    .max(c.drawbar_pull.abs())
                    .max(c.torque.abs() / radius[i]);
                for (x, y, z) in [
                    (a[0], b[0], c.vertical_force),
                    (a[1], b[1], c.drawbar_pull),
                    (a[2] / radius[i], b[2] / radius[i], c.torque / radius[i]),
                ] {
                    assert!(x.is_finite() && y.is_finite() && z.is_finite());
                    assert!(
                        (x - z).abs() <= 3e-9 * size + 1e-300,
                        "lanes {x:e}, alone {z:e} of {size:e}"
                    );
                    assert!(
                        (y - z).abs() <= 3e-9 * size + 1e-300,
                        "portable {y:e}, alone {z:e} of {size:e}"
                    );
                }
            }
            ((SolveStatus::BadInput, _), (SolveStatus::BadInput, _), Err(_)) => {}
            (a, b, c) => panic!("lanes {a:?}, portable {b:?}, alone {c:?}"),
        }
    }
}
