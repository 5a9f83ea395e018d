//! Sets of laws on tests that were left out of their fits.

use std::fmt::Write as _;

use grouser_files::{Document, soil};
use grouser_identify::wheel::{LawScore, Quantity};
use grouser_identify::{Job, compare_laws};
use grouser_terra::catalogue::Completion;
use grouser_terra::{Angle, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil};

const SOIL: &str = "n = 1.2\nk_c_kn_per_m_n1 = 0.0\nk_phi_kn_per_m_n2 = 3000.0\ncohesion_kpa = 0.3\nphi_deg = 29.0\n\
    unit_weight_n_per_m3 = 13000.0\nn_1 = 0.3\nn_2 = 0.4\nrebound = 0.4\nlaws = \"drift\"\n";
const FITTED: &str = "k_shear_m = 0.012\nc_1 = 0.35\nc_2 = 0.3\n";

/// The scores of tests at these slip angles that a soil with the preset's laws would give.
fn scores(name: &str, angles: &[f64]) -> Vec<LawScore> {
    let text = format!("format = 1\nname = \"made\"\n{SOIL}{FITTED}");
    let file = soil::parse(&Document::from_text("made.toml", text).unwrap()).unwrap();
    let soil = file.completed(&Completion::default()).unwrap();
    let wheel = RigidWheel::new(0.06, 0.05).unwrap();
    let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    let mut table =
        "slip,slip_angle_deg,load_n,drawbar_pull_n,side_force_n,sinkage_mm\n".to_owned();
    for angle in angles {
        for slip in [-0.3, 0.05, 0.2, 0.4, 0.6] {
            let motion =
                Kinematics::with_slip_angle(Slip::new(slip).unwrap(), Angle::from_deg(*angle));
            let point = on_soil
                .under_load(20.0, &motion.unwrap())
                .unwrap()
                .point()
                .unwrap();
            let (pull, side) = (point.forces.drawbar_pull, point.side_force);
            let depth = 1e3 * point.sinkage;
            writeln!(table, "{slip},{angle},20,{pull},{side},{depth}").unwrap();
        }
    }
    let folder = std::env::temp_dir();
    let csv = format!("grouser-laws-{name}-{}.csv", std::process::id());
    std::fs::write(folder.join(&csv), table).unwrap();
    let job = format!(
        "format = 1\nname = \"made\"\n[wheel]\ntable = \"{csv}\"\nradius_m = 0.06\nwidth_m = 0.05\n\
         fit = [\"k_shear_m\", \"c_1\", \"c_2\"]\nstarts = 2\n[soil]\n{SOIL}"
    );
    let place = folder.join("job.toml");
    let job = Job::read(&Document::from_text(place.to_str().unwrap(), job).unwrap()).unwrap();
    let found = compare_laws(&job).unwrap();
    std::fs::remove_file(folder.join(&csv)).unwrap();
    found
}

#[test]
fn the_laws_of_a_soil_predict_what_was_left_out() {
    let angles = scores("angles", &[0.0, 20.0, 40.0]);
    let single = scores("single", &[0.0]);
    let names = |scores: &[LawScore]| {
        let names = scores.iter();
        names
            .map(|score| format!("{} {} {}", score.left_out, score.laws, score.tests))
            .collect::<Vec<_>>()
    };
    let each = ["classical", "drift"].map(|laws| format!("each test {laws} 5"));
    assert_eq!(names(&single), each);
    assert_eq!(
        names(&angles)[2..4],
        ["classical", "drift"].map(|laws| format!("slip angle 20 {laws} 5"))
    );
    assert_eq!(angles.len(), 6);
    for pair in angles.chunks(2).chain(single.chunks(2)) {
        for (other, own) in pair[0].rmse.iter().zip(&pair[1].rmse) {
            assert_eq!((own.0, own.2), (other.0, 5));
            println!(
                "{} {:?}: {:.3e} {:.3e}",
                pair[0].left_out, own.0, other.1, own.1
            );
            // readings without noise: the laws that made them predict them, others do not
            let size = if own.0 == Quantity::Sinkage {
                1e-6
            } else {
                1e-3
            };
            assert!(own.1 < size, "{own:?}");
            let has_side = own.0 != Quantity::Side || pair[0].left_out != "slip angle 0";
            assert!(
                pair[1].left_out == "each test" || !has_side || other.1 > 20.0 * own.1,
                "{other:?} {own:?}"
            );
        }
    }
}
