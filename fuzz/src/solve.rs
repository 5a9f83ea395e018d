//! The sinkage under any load: an error, a status, or a sinkage that carries the load.

use crate::bytes::Bytes;

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let Some(point) = crate::point::point(&mut bytes) else {
        return;
    };
    for _ in 0..3 {
        let load = match bytes.u8() % 4 {
            0 => bytes.any(),
            1 => bytes.within(0.0, 1e6),
            _ => 10_f64.powf(bytes.within(-3.0, 5.0)),
        };
        let Ok(solution) = point.contact.under_load(load, &point.motion) else {
            continue;
        };
        let Some(found) = solution.point() else {
            continue;
        };
        let f = found.forces;
        assert!(
            (0.0..point.wheel.radius()).contains(&found.sinkage),
            "{solution:?}"
        );
        assert!(
            f.drawbar_pull.is_finite() && f.torque.is_finite(),
            "{solution:?}"
        );
        let off = (f.vertical_force - load).abs();
        assert!(off <= 1e-6 * load.abs() + 1e-9, "{load:e} N, but {f:?}");
    }
}
