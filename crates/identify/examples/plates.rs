use grouser_identify::plate::*;
use std::path::Path;
fn main() {
    let mut tests = Vec::new();
    for (n, d) in [(1, 0.06), (4, 0.1)] {
        let base = format!("/work/shared/data/cmu-wheel/f-d-large-box__force-displacement_{n}");
        let r = read_bag(
            &format!("{d}"),
            Plate::disc(d).unwrap(),
            &BagSource {
                bag: Path::new(&format!("{base}.bag")).into(),
                topic: None,
                force: "wrench.wrench.force.z".into(),
                stamp: Some("wrench.header.stamp".into()),
                sign: -1.0,
            },
            &DepthColumn {
                file: Path::new(&format!("{base}.txt")).into(),
                height: 5,
                height_unit: 1e-3,
                clock: 7,
                controller: Some((6, 1e-3)),
                surface: std::env::args()
                    .nth(1)
                    .map(|_| if n == 1 { -9.62e-3 } else { -9.0e-3 }),
            },
        )
        .unwrap();
        println!(
            "zone {} offset {:.3} zero {:.2} contact {:.2} mm n {} depth max {:.1}",
            r.zone_s,
            r.offset_s,
            r.zero_n,
            1e3 * r.contact_height,
            r.test.depth.len(),
            1e3 * r.test.depth.last().unwrap()
        );
        for datum in [false, true] {
            let f = fit_plates(
                &[r.test.clone()],
                &PlateSettings {
                    fit_datum: datum,
                    ..Default::default()
                },
            )
            .unwrap();
            println!(
                "  n {:.3} k {:.0} red {:.0} dev {:.3}",
                f.n,
                f.k_phi / 1e3,
                f.redundancy,
                f.relative_deviation
            );
            for p in &f.parameters {
                println!(
                    "     {} {:.4} ± {:.4} {:?} {:?}",
                    p.name, p.value, p.standard_error, p.interval, p.verdict
                );
            }
        }
        tests.push(r.test);
    }
    let f = fit_plates(&tests, &Default::default()).unwrap();
    println!(
        "joint n {} k_c {} k_phi {} at .05: {}",
        f.n,
        f.k_c,
        f.k_phi,
        f.k_c / 0.05 + f.k_phi
    );
    for p in &f.parameters {
        println!(
            "     {} {:.4} ± {:.4} {:?} {:?}",
            p.name, p.value, p.standard_error, p.interval, p.verdict
        );
    }
}
