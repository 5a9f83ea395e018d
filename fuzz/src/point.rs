//! A wheel on a soil out of the bytes of a case.
use grouser_terra::{
    Accuracy, Angle, Kinematics, RigidWheel, Settings, Slip, Soil, SoilParams, WheelOnSoil,
};

use crate::bytes::Bytes;

/// Any numbers at all, or numbers of wheels and soils, by the first byte.
pub struct Point {
    pub wheel: RigidWheel,
    pub soil: Soil,
    pub contact: WheelOnSoil,
    pub motion: Kinematics,
}

pub fn point(bytes: &mut Bytes<'_>) -> Option<Point> {
    let wild = bytes.u8() % 4 == 0;
    let mut number = |from: f64, to: f64| {
        if wild && bytes.u8() % 4 == 0 {
            bytes.any()
        } else {
            bytes.within(from, to)
        }
    };
    let radius = number(0.01, 1.0);
    let width = number(0.005, 0.6);
    let (k_c, k_phi, n) = (number(0.0, 50e3), number(5e4, 3e6), number(0.1, 2.5));
    let cohesion = number(0.0, 2e4);
    let phi = Angle::from_deg(number(0.0, 50.0));
    let k_shear = 10_f64.powf(number(-6.0, -0.5));
    let (c_1, c_2) = (number(0.0, 0.6), number(0.0, 0.6));
    let rebound = number(0.0, 1.0);
    let (slip, beta) = (number(-1.0, 1.0), number(-89.0, 89.0));
    let reference = number(0.0, 1.0) > 0.9;
    let straight = number(0.0, 1.0) > 0.5;
    let params = SoilParams {
        rebound: if rebound < 0.5 { 0.0 } else { rebound },
        ..Soil::bekker(k_c, k_phi, n)
            .cohesion(cohesion)
            .phi(phi)
            .k_shear(k_shear)
            .stress_position(c_1, c_2)
            .params()
            .ok()?
    };
    let soil = Soil::new(params).ok()?;
    let wheel = RigidWheel::new(radius, width).ok()?;
    let accuracy = if reference {
        Accuracy::Reference
    } else {
        Accuracy::Standard
    };
    let settings = Settings {
        accuracy,
        ..Settings::default()
    };
    let contact = WheelOnSoil::new(wheel, soil, settings).ok()?;
    let given = Slip::new(slip).ok()?;
    let motion = if straight {
        Kinematics::straight(given)
    } else {
        Kinematics::with_slip_angle(given, Angle::from_deg(beta)).ok()?
    };
    Some(Point {
        wheel,
        soil,
        contact,
        motion,
    })
}
