//! Figures as files.

use std::path::{Path, PathBuf};

use super::program::{Folder, Said, grouser};

fn draw(words: &str, flag: &str, path: &Path) -> Said {
    let words = words.split_whitespace().map(PathBuf::from);
    grouser(words.chain([PathBuf::from(flag), path.to_owned()]))
}

const FIGURES: [(&str, &str); 4] = [
    (
        "wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2 --slip-angle-deg 9",
        "--figure",
    ),
    (
        "wheel --soil lunar --radius-m 0.125 --width-m 0.1 --load-n 80 --slip -0.4 --rebound 0.5",
        "--figure",
    ),
    (
        "wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 40 --load-n 90 --slip -0.3:0.9 --points 40",
        "-o",
    ),
    (
        "paper slip-model --theta-deg -5:40 --sinkage-m 0.01,0.014,0.02,0.03 --radius-m 0.1",
        "-o",
    ),
];

#[test]
fn the_svg_is_read_by_another_program_and_shows_the_same_picture_as_the_png() {
    for (words, flag) in FIGURES {
        let folder = Folder::new();
        let (svg, png) = (folder.path("a.svg"), folder.path("a.PNG"));
        draw(words, flag, &svg).assert_done();
        draw(words, flag, &png).assert_done();
        let text = std::fs::read_to_string(svg).unwrap();
        assert!(text.contains("<title>") && text.contains("aria-label"));
        // resvg is an SVG renderer that knows nothing of ours.
        let tree = resvg::usvg::Tree::from_str(&text, &resvg::usvg::Options::default()).unwrap();
        let ours = resvg::tiny_skia::Pixmap::load_png(png).unwrap();
        let mut theirs = resvg::tiny_skia::Pixmap::new(ours.width(), ours.height()).unwrap();
        // usvg counts in px of 1/96 inch.
        let scale = 300.0 / 96.0;
        let transform = resvg::tiny_skia::Transform::from_scale(scale, scale);
        resvg::render(&tree, transform, &mut theirs.as_mut());
        let far = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 64;
        let differ = ours
            .data()
            .iter()
            .zip(theirs.data())
            .filter(|pair| far(*pair))
            .count();
        // SVG rounds to a hundredth of a point: edges may differ by a shade.
        let share = differ as f64 / ours.data().len() as f64;
        assert!(share < 1e-3, "{words}: {share}");
        let ink = ours.data().chunks(4).filter(|pixel| pixel[0] < 128).count();
        assert!(ink > 10_000, "{words}: nothing drawn");
    }
}

#[test]
fn an_unknown_ending_is_refused_before_the_work() {
    let folder = Folder::new();
    for name in ["a.pdf", "a", ".svg", "a.svg.txt"] {
        for (words, flag) in FIGURES {
            draw(words, flag, &folder.path(name)).assert_refused(name);
        }
    }
    assert!(folder.names().is_empty());
}

#[test]
fn a_table_and_a_figure_in_one_run() {
    let folder = Folder::new();
    let (csv, svg) = (folder.path("c.csv"), folder.path("c.svg"));
    let words = FIGURES[2].0.split_whitespace().map(PathBuf::from);
    grouser(words.chain(["-o".into(), csv.clone(), "-o".into(), svg])).assert_done();
    assert_eq!(folder.names(), ["c.csv", "c.svg"]);
    let text = std::fs::read_to_string(csv).unwrap();
    assert!(text.starts_with(
        "soil,radius_m,width_m,rebound,slip,sinkage_m,load_n,vertical_force_n,drawbar_pull_n,torque_nm,status,cautions\n"
    ));
    assert_eq!(text.lines().count(), 1 + 2 * 40);
}
