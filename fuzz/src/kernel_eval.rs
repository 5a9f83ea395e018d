//! Forces at any sinkage of any wheel on any soil: an error, or numbers that are finite.

use crate::bytes::Bytes;

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let Some(point) = crate::point::point(&mut bytes) else {
        return;
    };
    let radius = point.wheel.radius();
    for _ in 0..4 {
        let sinkage = if bytes.u8() % 8 == 0 {
            bytes.any()
        } else {
            bytes.within(0.0, 1.1) * radius
        };
        let Ok(solution) = point.contact.at_sinkage(sinkage, &point.motion) else {
            continue;
        };
        let f = solution.forces;
        let all = [
            f.vertical_force,
            f.drawbar_pull,
            f.torque,
            f.energy_residual,
            f.side_shear,
        ];
        assert!(
            all.iter().all(|x| x.is_finite()),
            "{sinkage:e} of {radius:e}: {f:?}"
        );
        assert!(solution.error_estimate().is_finite());
    }
}
