//! The controller under any input: every command finite and bounded, every decision with a number.

use crate::bytes::Bytes;
use crate::{settings, stream};
use grouser_slip::control::{
    ControlInput, ControlSettings, Controller, Decides, Request, WheelObservation,
};
use grouser_slip::filter::SlipPrior;
use grouser_slip::{Degraded, Health, Invalid, Motion};

const HEALTH: [Health; 6] = [
    Health::Ok,
    Health::Uninitialised,
    Health::Degraded(Degraded::LowSpeed),
    Health::Degraded(Degraded::ReferenceLost),
    Health::Invalid(Invalid::Dropout),
    Health::Invalid(Invalid::Inconsistent),
];

fn number(bytes: &mut Bytes<'_>, from: f64, to: f64) -> Option<f64> {
    match bytes.u8() % 8 {
        0 => None,
        1 => Some(bytes.any()),
        _ => Some(bytes.within(from, to)),
    }
}

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let wheels = 3 + bytes.u8() % 4;
    let robot = stream::plain_robot(16, wheels);
    let mut settings: ControlSettings = settings::drawn(&mut bytes, ControlSettings::FIELDS);
    settings.decides = match bytes.u8() % 4 {
        0 => Decides::Nothing,
        1 => Decides::Stops,
        2 => Decides::BacksOut,
        _ => Decides::Everything,
    };
    let max_traction = settings.max_traction;
    let Ok(mut controller) = Controller::new(&robot, settings) else {
        return;
    };
    let mut time_ns = 0_i64;
    let mut seen = Vec::new();
    while !bytes.is_empty() {
        time_ns = stream::time(&mut bytes, time_ns);
        seen.clear();
        let reported = if bytes.u8() % 16 == 0 {
            bytes.u8() % 8
        } else {
            wheels
        };
        for _ in 0..reported {
            let kind = bytes.u8();
            seen.push(WheelObservation {
                slip: number(&mut bytes, -1.0, 1.0),
                sigma: number(&mut bytes, 0.0, 0.5),
                health: HEALTH[usize::from(kind) % HEALTH.len()],
                motion: Motion::ALL.get(usize::from(kind) % 8).copied(),
                forward_speed: number(&mut bytes, -2.0, 2.0),
                rim_speed: number(&mut bytes, -2.0, 2.0),
                torque_share: number(&mut bytes, -1.0, 1.0),
                load: number(&mut bytes, 0.0, 500.0).unwrap_or(f64::NAN),
                firmness: number(&mut bytes, 0.0, 2.0),
            });
        }
        let input = ControlInput {
            time_ns,
            wheels: &seen,
            speed: number(&mut bytes, -2.0, 2.0),
            heading: number(&mut bytes, -4.0, 4.0),
            pitch: number(&mut bytes, -0.7, 0.7),
            roll: number(&mut bytes, -0.7, 0.7),
            request: Request {
                speed: number(&mut bytes, -2.0, 2.0).unwrap_or(0.0),
                heading: number(&mut bytes, -4.0, 4.0).unwrap_or(0.0),
                yaw_rate: number(&mut bytes, -2.0, 2.0),
            },
            slip_demand: number(&mut bytes, -1.0, 1.0)
                .zip(number(&mut bytes, 0.0, 0.5))
                .map(|(mean, sigma)| SlipPrior { mean, sigma }),
        };
        let output = controller.step(&input);
        assert_eq!(output.commands.len(), usize::from(wheels));
        for command in output.commands {
            assert!(command.rim_speed.is_finite(), "{command:?} of {input:?}");
            assert!(
                (0.0..=max_traction).contains(&command.traction),
                "{command:?} of {input:?}"
            );
        }
        assert!(output.heading.is_finite(), "{output:?} of {input:?}");
        assert!(
            (-1.0..=1.0).contains(&output.slip),
            "{output:?} of {input:?}"
        );
        if let Some(decision) = output.decision {
            assert!(
                decision.value.is_finite() && decision.limit.is_finite(),
                "{decision:?}"
            );
            assert!(
                decision
                    .wheel
                    .is_none_or(|wheel| wheel < usize::from(wheels)),
                "{decision:?}"
            );
        }
    }
}
