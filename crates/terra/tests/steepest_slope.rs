//! The steepest slope against halving with the greatest pull of each slope.

use std::time::Instant;

use grouser_terra::{
    Angle, GrouserRule, Grousers, RigidWheel, Settings, ShearLaw, Soil, SoilParams, WheelOnSoil,
    catalogue,
};

/// By its definition: 40 halvings of 85°, each with a whole search for the greatest pull.
fn halved(pair: &WheelOnSoil, weight: f64) -> Option<f64> {
    let left = |alpha: f64| {
        let best = pair.slip_of_maximum_pull(weight * alpha.cos()).unwrap();
        best.map(|best| best.value - weight * alpha.sin())
    };
    if !left(0.0).is_some_and(|left| left >= 0.0) {
        return None;
    }
    let (mut low, mut high) = (0.0, 85_f64.to_radians());
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if left(middle).is_some_and(|left| left >= 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

#[test]
fn agrees_with_halving() {
    let (mut count, mut none, mut inside) = (0, 0, 0);
    let (mut whole, mut quick) = (0.0, 0.0);
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let params = *catalogue::find(key).unwrap().soil().unwrap().params();
        let digging = SoilParams { n_1: 0.4, ..params };
        let rising = SoilParams {
            rebound: 0.2,
            ..params
        };
        for (params, shear) in [
            (params, ShearLaw::Coupled),
            (digging, ShearLaw::Coupled),
            (rising, ShearLaw::SlipVelocityRegular),
        ] {
            for (height, weight) in [(0.0, 20.0), (0.0, 80.0), (0.01, 80.0), (0.0, 900.0)] {
                let wheel = RigidWheel::new(0.125, 0.1).unwrap();
                let lugs = GrouserRule::Lugs {
                    count: 24.0,
                    thickness: 0.002,
                };
                let wheel = wheel
                    .with_grousers(Grousers { height, rule: lugs })
                    .unwrap();
                let settings = Settings {
                    shear,
                    max_slip: 1.0,
                    ..Settings::default()
                };
                let pair = WheelOnSoil::new(wheel, Soil::new(params).unwrap(), settings).unwrap();
                let begun = Instant::now();
                let truth = halved(&pair, weight);
                whole += begun.elapsed().as_secs_f64();
                let begun = Instant::now();
                let found = pair.steepest_slope(weight).unwrap();
                quick += begun.elapsed().as_secs_f64();
                count += 1;
                let case = format!("{key} n_1 {} lugs {height} {weight} N", params.n_1);
                let (Some(truth), Some(found)) = (truth, found) else {
                    assert!(
                        truth.is_none() && found.is_none(),
                        "{case}: {truth:?} {found:?}"
                    );
                    none += 1;
                    continue;
                };
                let off = found.slope.rad() - truth;
                // forces at standard accuracy are known to 1e-9, and a whole search picks the best of its noise; the pull of
                // lugs rises up to the slip that buries the hub, which both searches come to within 1e-6
                let close = if height > 0.0 { 1e-6 } else { 1e-8 };
                assert!(off.abs() < close, "{case}: {found:?} for {truth}, {off:e}");
                inside += u32::from(found.slip.value() < 0.99);
                // it holds the slope there
                let load = weight * found.slope.cos();
                let best = pair.slip_of_maximum_pull(load).unwrap().unwrap();
                let asked = weight * Angle::from_rad(truth).sin();
                assert!((best.value - asked).abs() < 1e-7 * weight, "{case}");
            }
        }
    }
    println!(
        "{count} slopes, {none} not even level, {inside} below slip 0.99: {:.0} times as fast",
        whole / quick
    );
    assert!(
        inside > 5 && none > 0 && none < count / 2,
        "{inside} {none}"
    );
}
