use grouser_rover::drive::*;
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let sc = read_scenario(Path::new(&format!(
        "/work/wt/rover/examples/scenarios/{}.toml",
        a[1]
    )))
    .unwrap_or_else(|e| {
        println!("{e}");
        std::process::exit(1)
    });
    let opt: f64 = a.get(3).and_then(|s| s.parse().ok()).unwrap_or(0.3);
    let seeds: u64 = a.get(4).and_then(|s| s.parse().ok()).unwrap_or(1);
    let verbose = a.get(5).is_some();
    for pilot in Pilot::ALL {
        if a[2] != "all" && a[2] != pilot.name() {
            continue;
        }
        for seed in 0..seeds {
            let seed = sc.seed + seed;
            let t = std::time::Instant::now();
            let mut d = Drive::new(&sc, pilot, opt, seed).unwrap();
            let mut k = 0;
            let r=d.run(|f|{ k+=1; if verbose && k%100==0 { print!("{:.0}s {:?} ({:.2},{:.2},{:.2}) v {:.3}/{:?} yaw {:.0} pitch {:.1} roll {:.1}|",f.time,f.mode,f.place[0],f.place[1],f.place[2],f.speed,f.speed_seen.map(|s|(s*1e3).round()/1e3),f.angles[2].to_degrees(),f.angles[1].to_degrees(),f.angles[0].to_degrees()); for w in f.wheels {print!(" {:.2}/{:.2} {:.0}N {:.0}mm {:.1}Nm",w.slip.unwrap_or(9.0),w.seen.slip.unwrap_or(9.0),w.load,w.sinkage*1e3,w.torque)} println!();} true});
            println!(
                "{} seed {seed}: {:?} {:.1}s dist {:.2} way {:.2} E {:.0} J/m {:.1?} err {:.4} slip {:?} worst {:.2} dec {} refused {} | {:.1}x",
                pilot.name(),
                r.outcome,
                r.duration,
                r.distance,
                r.way,
                r.energy,
                r.energy_per_metre(),
                r.energy_error,
                r.slip,
                r.worst_slip,
                r.decision_count,
                r.refused,
                r.duration / t.elapsed().as_secs_f64()
            );
            if verbose {
                for d in &r.decisions {
                    println!(
                        "  {:.2} {} wheel {:?}",
                        d.time, d.decision, d.decision.wheel
                    );
                }
            }
        }
    }
}
