//! `drive`: its report stands alone and takes no markup from a file; its logs say what the drive was.

use std::collections::BTreeMap;

use super::program::{Folder, grouser, line};

/// The first seconds of the sandbox, with a robot whose names and title are markup.
fn hostile_scenario(folder: &Folder) -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let read = |name: &str| std::fs::read_to_string(format!("{root}/{name}")).unwrap();
    let robot = read("robots/five-wheel.toml")
        .replace("name = \"five wheels\"", "name = \"<script>a()</script>\"")
        .replace("front_left", "<img src=x onerror=b()>");
    std::fs::write(folder.path("robot.toml"), robot).unwrap();
    let scenario = read("scenarios/sandbox.toml")
        .replace("../robots/five-wheel.toml", "robot.toml")
        .replace("duration_s = 120.0", "duration_s = 3.0")
        .replace(
            "title = \"The sandbox: driving and braking on dry sand\"",
            "title = \"</title><img src='x' onerror='c()'> & more\"",
        );
    let path = folder.path("scenario.toml");
    std::fs::write(&path, scenario).unwrap();
    path.display().to_string()
}

#[test]
fn a_report_stands_alone_and_takes_no_markup() {
    let folder = Folder::new();
    let scenario = hostile_scenario(&folder);
    let page = folder.path("page.html");
    let page_name = page.display().to_string();
    let drivers = "open-loop,controller";
    grouser([
        "drive",
        &scenario,
        "--compare",
        drivers,
        "--report",
        &page_name,
    ])
    .assert_done();
    let page = std::fs::read_to_string(page).unwrap();
    for shown in [
        "&lt;script&gt;a()&lt;/script&gt;",
        "&lt;img src=x onerror=b()&gt;",
        "&lt;/title&gt;&lt;img src=&#39;x&#39; onerror=&#39;c()&#39;&gt; &amp; more",
    ] {
        assert!(page.contains(shown), "{shown}");
    }
    for markup in ["<script", "<img"] {
        assert!(!page.contains(markup), "{markup}");
    }
    // nothing is fetched: the only address with a scheme is the name of SVG's own language
    let mut rest = page.replace("http://www.w3.org/2000/svg", "");
    rest.retain(|letter| letter != '\n');
    for address in ["http:", "https:", "src=\"", "url(//", "@import", "<link"] {
        assert!(!rest.contains(address), "{address}");
    }
    let policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:";
    assert!(page.contains(policy));
    // what is named twice is the same twice: figures share a page without taking each other's clips
    let mut shapes: BTreeMap<&str, &str> = BTreeMap::new();
    let mut named = 0;
    for part in page.split("<clipPath id=\"").skip(1) {
        let (name, rest) = part.split_once('"').unwrap();
        let (shape, _) = rest.split_once("</clipPath>").unwrap();
        assert_eq!(*shapes.entry(name).or_insert(shape), shape, "{name}");
        named += 1;
    }
    assert!(
        named > shapes.len(),
        "no clip was shared: nothing was compared"
    );
    for part in page.split("clip-path=\"url(#").skip(1) {
        let (name, _) = part.split_once(')').unwrap();
        assert!(shapes.contains_key(name), "{name}");
    }
    for said in [
        "SHA-256",
        "dry-sand",
        "2012",
        "open-loop",
        "Energy of each driver",
    ] {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn a_log_has_a_kind_that_is_known() {
    let folder = Folder::new();
    let scenario = hostile_scenario(&folder);
    let log = folder.path("log.xyz").display().to_string();
    let said = grouser(["drive", &scenario, "-o", &log]);
    said.assert_refused("log.xyz");
    assert!(said.err.contains(".csv"), "{said:?}");
    line("drive nothing.toml").assert_refused("no file");
}

/// The first seconds of the sandbox; what they show must not depend on how it was written down.
#[test]
fn a_recording_and_a_table_of_one_drive_give_the_same_slips() {
    let folder = Folder::new();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let robot = format!("{root}/robots/five-wheel.toml");
    let sandbox = std::fs::read_to_string(format!("{root}/scenarios/sandbox.toml")).unwrap();
    let short = sandbox
        .replace("../robots/five-wheel.toml", &robot)
        .replace("duration_s = 120.0", "duration_s = 15.0");
    let scenario = folder.file("short.toml", short).display().to_string();
    let logs = ["drive.csv", "drive.mcap"].map(|name| folder.path(name).display().to_string());
    for log in &logs {
        grouser(["drive", &scenario, "-o", log]).assert_done();
    }
    let estimate = |log: &str, sensor: &str, method: &str| {
        let arguments = [
            "estimate",
            log,
            "--robot",
            &robot,
            "--wheel-sensor",
            sensor,
            "--method",
            method,
            "--json",
        ];
        grouser(arguments).assert_done().json()
    };
    let [table, recording] = [&logs[0], &logs[1]].map(|log| estimate(log, "count", "filter"));
    // the joints' angles are the counters', unwrapped: the same to rounding where nobody asks how finely they come
    let [counts, angles] = ["count", "angle"].map(|sensor| estimate(&logs[1], sensor, "window"));
    let wheels = table["wheels"].as_object().unwrap();
    assert_eq!(wheels.len(), 6);
    let mut compared = 0;
    for (name, wheel) in wheels {
        for key in ["median", "p5", "p95"] {
            let Some(slip) = wheel[key].as_f64() else {
                continue;
            };
            let same = recording["wheels"][name][key].as_f64().unwrap();
            let [count, angle] =
                [&counts, &angles].map(|found| found["wheels"][name][key].as_f64().unwrap());
            assert!(
                (slip - same).abs() < 1e-12,
                "{name} {key}: {slip} and {same}"
            );
            assert!(
                (count - angle).abs() < 1e-6,
                "{name} {key}: {count} and {angle}"
            );
            compared += 1;
        }
    }
    assert!(compared >= 15, "{compared}");
    let driving = table["wheels"]["front_left"]["median"].as_f64().unwrap();
    assert!((0.1..0.7).contains(&driving), "{driving}");
    // what the simulation knows is in the file and is not believed
    let info = grouser(["log", "info", &logs[1], "--json"]).assert_done();
    assert!(info.out.contains("/simulation/truth/pose"), "{}", info.out);
    for reference in ["pose", "displacement"] {
        let arguments = [
            "estimate",
            &logs[1],
            "--robot",
            &robot,
            "--reference",
            reference,
        ];
        grouser(arguments).assert_refused(reference);
    }
}
