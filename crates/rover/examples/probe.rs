use grouser_rover::{dynamics::*, ground::*, robot::*};
use std::path::Path;
fn main() {
    let model =
        RobotModel::read(Path::new("/work/wt/rover/examples/robots/five-wheel.toml")).unwrap();
    println!("weight {}", model.weight());
    let soil = grouser_terra::catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap();
    let slope: f64 = std::env::args()
        .nth(1)
        .and_then(|s| s.parse().ok())
        .unwrap_or(0.0);
    let speed: f64 = std::env::args()
        .nth(2)
        .and_then(|s| s.parse().ok())
        .unwrap_or(0.2);
    let dt: f64 = std::env::args()
        .nth(3)
        .and_then(|s| s.parse().ok())
        .unwrap_or(0.001);
    let map =
        HeightMap::from_shape((20.0, 8.0), 0.05, |x, _| (x) * slope.to_radians().tan()).unwrap();
    let mut ground = Ground::new(map, vec![soil]).unwrap();
    let mut v = Vehicle::new(model, &ground, (2.0, 0.0, 0.0), dt).unwrap();
    let mut integ = vec![0.0; 6];
    let t0 = std::time::Instant::now();
    let e0 = v.energy();
    let total = 10.0;
    let n = (total / dt) as u64;
    for k in 0..n {
        let t = k as f64 * dt;
        let target = if t < 2.0 {
            0.0
        } else {
            speed * ((t - 2.0).min(1.0))
        };
        let cmds: Vec<WheelCommand> = v
            .wheels()
            .iter()
            .zip(&v.model().wheels)
            .enumerate()
            .map(|(i, (w, m))| {
                let e = target / m.wheel.radius() - w.encoder_rate;
                integ[i] += 20.0 * e * dt;
                WheelCommand {
                    torque: if t < 2.0 { 0.0 } else { 2.0 * e + integ[i] },
                    steer: 0.0,
                }
            })
            .collect();
        v.advance(&mut ground, &cmds);
        if k % (n / 20) == 0 {
            let s = v.state();
            let (r, p, y) = s.attitude.angles();
            print!(
                "t {:.2} x {:.4} z {:.4} v {:.4} p {:.2} r{:.2} y{:.2} j {:.2} {:.2} {:.2}|",
                v.time(),
                s.position.x,
                s.position.z,
                s.velocity().x,
                p.to_degrees(),
                r.to_degrees(),
                y.to_degrees(),
                s.joints[0].to_degrees(),
                s.joints[1].to_degrees(),
                s.joints[2].to_degrees()
            );
            for w in v.wheels() {
                print!(
                    " {:.1}N/{:.1}mm/{:.3}",
                    w.load.normal,
                    w.load.pressed * 1e3,
                    1.0 - w.velocity[0] / w.rim
                )
            }
            println!();
        }
    }
    let e1 = v.energy();
    let l = v.ledger();
    println!(
        "{:?} kin {:.3} pot {:.3} balance {:.4}",
        l,
        e1.0 - e0.0,
        e1.1 - e0.1,
        l.electric - l.motor_heat - l.soil - l.bearings - l.dampers - (e1.0 + e1.1 - e0.0 - e0.1)
    );
    let el = t0.elapsed().as_secs_f64();
    println!(
        "{:.1} x real time, {:.2} us/step",
        total / el,
        el / n as f64 * 1e6
    );
}
