//! `drive`: its report stands alone and takes no markup from a file; its logs say what the drive was.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

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
    // names are data: none is in the page's text, and what is embedded has them as they are
    for name in ["onerror", "a()", "<img"] {
        assert!(!page.contains(name), "{name}");
    }
    let report = embedded(&page);
    assert_eq!(
        report["title"],
        "</title><img src='x' onerror='c()'> & more"
    );
    let run = &report["runs"][1];
    assert_eq!(run["robot"], "<script>a()</script>");
    assert_eq!(run["wheels"][0]["name"], "<img src=x onerror=b()>");
    // nothing is fetched, and only the page's own script runs
    for address in [
        "http:",
        "https:",
        " src=\"",
        "url(",
        "@import",
        "<link rel=\"stylesheet",
    ] {
        let mut rest = page
            .replace("http://www.w3.org/2000/svg", "")
            .replace("https://github.com/stipub/stixfonts", "")
            .replace("https://openfontlicense.org", "")
            .replace("url(\"data:font/woff2;base64,", "");
        rest.retain(|letter| letter != '\n');
        assert!(!rest.contains(address), "{address}");
    }
    let policy = "default-src 'none'; img-src data: blob:; font-src data:; base-uri 'none'; \
                  form-action 'none'; object-src 'none'; script-src 'sha256-";
    assert!(page.contains(policy));
    assert!(!page.contains("unsafe-inline"));
    let drivers: Vec<_> = [0, 1].map(|i| &report["drives"][i]["controller"]).into();
    assert_eq!(drivers, ["open-loop", "controller"]);
    let said = report.to_string();
    for known in ["SHA-256", "dry-sand", "2012", "heat of motors and gears"] {
        assert!(said.contains(known), "{known}");
    }
    // the columns of a run are of one length, and its numbers are those of the command
    let columns = ["x_m", "y_m", "used_energy_j", "speed_m_per_s"];
    let moments = run["time_s"].as_array().unwrap().len();
    assert!(moments >= 29, "{moments}");
    for column in columns {
        assert_eq!(run[column].as_array().unwrap().len(), moments, "{column}");
    }
    let ground = &run["ground"];
    let heights = ground["height_m"].as_array().unwrap().len() as u64;
    assert_eq!(heights % ground["columns"].as_u64().unwrap(), 0);
    assert_eq!(ground["soil"].as_array().unwrap().len() as u64, heights);
    let went: f64 = run["energy_went_into"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row[1].as_f64().unwrap())
        .sum();
    assert!((went - run["energy_j"].as_f64().unwrap()).abs() < 1e-9 * went);
}

/// Open loop compares with the controller where it has the mean speed of that drive, alone or next to it.
#[test]
fn open_loop_has_the_mean_speed_of_the_controllers_drive() {
    let folder = Folder::new();
    let scenario = hostile_scenario(&folder);
    let drives = |drivers: &str| {
        let said = grouser(["drive", &scenario, "--compare", drivers, "--json"]);
        said.assert_done().json()["runs"].clone()
    };
    let both = drives("controller,open-loop");
    assert_eq!(both[0]["controller"], "controller");
    assert_eq!(both[0]["speed_share"], 1.0);
    let share = both[1]["speed_share"].as_f64().unwrap();
    assert!(share > 0.0 && share != 1.0, "{share}");
    let alone = drives("open-loop");
    assert_eq!(alone.as_array().unwrap().len(), 1);
    assert_eq!(alone[0], both[1]);
    let refused = grouser(["drive", &scenario, "--compare", "known-soil"]);
    refused.assert_refused("a driver of before");
}

/// A drive over waves as long as a wheel has a balance of energy that is off by 3 %; one that leaves the map at once has turned over
/// next to nothing, which belies no balance.
#[test]
fn a_bad_balance_of_energy_is_said() {
    let folder = Folder::new();
    let robot = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/robots/five-wheel.toml"
    );
    let steep = "kind = \"fractal\"\nsize_x_m = 40\nsize_y_m = 10\nheight_m = 0.6\nlength_m = 0.5\nroughness = 0\n\
                 packing = 0.4\nscatter = 0.05\nscatter_length_m = 10\n";
    let level = "kind = \"flat\"\nsize_x_m = 6\nsize_y_m = 4\n";
    let drive = |start: f64, ground: &str| {
        let text = format!(
            "format = 1\ntitle = \"x\"\nrobot = \"{robot}\"\nseed = 1442528794\nduration_s = 15\nhotel_w = 5\n\
             [start]\nx_m = {start}\nheading_deg = 180\n[ground]\nsoil = \"lunar\"\n{ground}\
             [[leg]]\nspeed_m_per_s = 0.3\nduration_s = 3\n"
        );
        let path = folder.path("s.toml");
        std::fs::write(&path, text).unwrap();
        let page = folder.path("page.html").display().to_string();
        let path = path.display().to_string();
        let driver = ["--compare", "open-loop", "--json", "--report", &page];
        let said = grouser([&["drive", &path][..], &driver].concat()).assert_done();
        let off = said.json()["runs"][0]["energy_books_error"]
            .as_f64()
            .unwrap();
        let summaries = embedded(&std::fs::read_to_string(page).unwrap())["summaries"].to_string();
        (off, said.err, summaries)
    };
    let (off, err, summaries) = drive(20.0, steep);
    assert!(off.abs() > 0.02, "{off}");
    for said in [&err, &summaries] {
        assert!(
            said.contains("energy balance") && said.contains("step_s"),
            "{said}"
        );
    }
    let (off, err, summaries) = drive(-5.0, level);
    assert!(off.abs() < 0.02, "{off}");
    assert!(
        !err.contains("energy balance") && !summaries.contains("energy balance"),
        "{err}"
    );
}

/// The report in a page.
pub(super) fn embedded(page: &str) -> serde_json::Value {
    let (_, block) = page.split_once("id=\"embedded\"").unwrap();
    let (_, block) = block.split_once('>').unwrap();
    let (block, _) = block.split_once("</script>").unwrap();
    let packed = STANDARD.decode(block).unwrap();
    serde_json::from_reader(flate2::read::GzDecoder::new(&packed[..])).unwrap()
}

/// The rows of a log's table and of its report are the same numbers; an answer's report has the command's numbers.
#[test]
fn reports_of_a_log_and_of_a_problem_have_the_numbers_of_the_command() {
    let folder = Folder::new();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let [page, table] = ["log.html", "log.csv"].map(|name| folder.path(name).display().to_string());
    let log = format!("{root}/five-wheel/log.csv");
    let robot = format!("{root}/five-wheel/robot.toml");
    let arguments = [
        "estimate", &log, "--robot", &robot, "--to-s", "18", "-o", &table, "--report", &page,
    ];
    grouser(arguments).assert_done();
    let report = embedded(&std::fs::read_to_string(&page).unwrap());
    let run = &report["runs"][0];
    let times = run["time_s"].as_array().unwrap();
    let rows = std::fs::read_to_string(&table).unwrap();
    let mut compared = 0;
    for row in rows.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let time: f64 = cells[0].parse().unwrap();
        // the reader of JSON is exact to the last digit but one
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * b.abs();
        let is_time = |other: &serde_json::Value| near(other.as_f64().unwrap(), time);
        let place = times.iter().position(is_time).unwrap();
        let wheels = run["wheels"].as_array().unwrap();
        let wheel = wheels.iter().find(|wheel| wheel["name"] == cells[1]);
        let slip = wheel.unwrap()["slip"][place].as_f64();
        let printed: Option<f64> = cells[2].parse().ok();
        assert_eq!(slip.is_some(), printed.is_some(), "{row}");
        let same = slip
            .zip(printed)
            .is_none_or(|(slip, printed)| near(slip, printed));
        assert!(same, "{row}: {slip:?}");
        compared += usize::from(slip.is_some());
    }
    assert!(compared > 1000, "{compared}");

    let page = folder.path("front.html").display().to_string();
    let problem = format!("{root}/problems/running-slip.toml");
    let said = grouser(["optimize", &problem, "--report", &page, "--json"]).assert_done();
    let report = embedded(&std::fs::read_to_string(&page).unwrap());
    assert_eq!(report["answer"]["x"], said.json()["x"]);
    assert_eq!(
        report["problem"],
        std::fs::read_to_string(&problem).unwrap()
    );
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
    let both = ["both.csv", "both.mcap"].map(|name| folder.path(name).display().to_string());
    let said = grouser(["drive", &scenario, "-o", &both[0], "-o", &both[1]]).assert_done();
    for (own, other) in both.iter().zip(&logs) {
        assert!(said.out.contains(&format!("wrote `{own}`")), "{said:?}");
        let [own, other] = [own, other].map(|path| std::fs::read(path).unwrap());
        assert!(own == other && own.len() > 1000, "one drive, two logs");
    }
    let estimate = |log: &str, sensor: &str| {
        let arguments = [
            "estimate",
            log,
            "--robot",
            &robot,
            "--wheel-sensor",
            sensor,
            "--json",
        ];
        grouser(arguments).assert_done().json()
    };
    let [table, recording] = [&logs[0], &logs[1]].map(|log| estimate(log, "count"));
    assert_eq!(recording["rejected"]["not_later"], 0);
    // the joints' angles are the counters', unwrapped: the same to rounding
    let angles = estimate(&logs[1], "angle");
    let wheels = table["wheels"].as_object().unwrap();
    assert_eq!(wheels.len(), 6);
    // the recording holds more sensors than the table
    for key in ["travel_wheels_m", "travel_reference_m", "overall"] {
        let [way, same, close] =
            [&table, &recording, &angles].map(|of| of["along"][key].as_f64().unwrap());
        assert!((way - same).abs() < 0.02 * way, "{key}: {way} and {same}");
        assert!((same - close).abs() < 1e-6, "{key}: {same} and {close}");
    }
    let mut compared = 0;
    for name in wheels.keys() {
        for key in ["median", "p5", "p95"] {
            let [slip, close] = [&recording, &angles].map(|of| of["wheels"][name][key].as_f64());
            let Some((slip, close)) = slip.zip(close) else {
                continue;
            };
            assert!(
                (slip - close).abs() < 1e-6,
                "{name} {key}: {slip} and {close}"
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
    let suggested = grouser(["log", "info", &logs[1], "--suggest-robot"]).assert_done();
    assert!(
        suggested.out.contains("/imu") && !suggested.out.contains("truth"),
        "{}",
        suggested.out
    );
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

/// A robot file made of a URDF is a robot to every verb; what is none is refused with what to do.
#[test]
fn a_description_becomes_a_robot_file() {
    let folder = Folder::new();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let urdf = format!("{examples}/robots/five-wheel.urdf");
    let robot = folder.path("robot.toml").display().to_string();
    let said = grouser(["robot", &urdf, "-o", &robot]).assert_done();
    assert!(
        said.out.contains("front_left") && said.out.contains("motors"),
        "{}",
        said.out
    );
    let log = folder.path("short.csv").display().to_string();
    let sandbox = std::fs::read_to_string(format!("{examples}/scenarios/sandbox.toml")).unwrap();
    let short = sandbox
        .replace("../robots", &format!("{examples}/robots"))
        .replace("duration_s = 120.0", "duration_s = 3.0");
    let scenario = folder.file("short.toml", short).display().to_string();
    // a robot without motors cannot be driven, and the message says so
    let without = std::fs::read_to_string(&scenario)
        .unwrap()
        .replace(&format!("{examples}/robots/five-wheel.toml"), &robot);
    let without = folder.file("without.toml", without).display().to_string();
    let said = grouser(["drive", &without]);
    said.assert_refused("no motor");
    assert!(said.err.contains("motor"), "{said:?}");
    // the angles of a recording need no more than the wheels; this one names its joints as the wheels are named
    let text = std::fs::read_to_string(&robot).unwrap();
    assert!(
        text.contains("joint = \"front_left_wheel_joint\""),
        "{text}"
    );
    let own = text.lines().filter(|line| !line.starts_with("joint = "));
    let robot = folder.file("own-names.toml", own.collect::<Vec<_>>().join("\n"));
    let robot = robot.display().to_string();
    let mcap = folder.path("short.mcap").display().to_string();
    for log in [&log, &mcap] {
        grouser(["drive", &scenario, "-o", log]).assert_done();
    }
    let read = [
        "estimate",
        &mcap,
        "--robot",
        &robot,
        "--wheel-sensor",
        "angle",
        "--json",
    ];
    let found = grouser(read).assert_done().json();
    assert_eq!(found["wheels"].as_object().unwrap().len(), 6);
    let json = grouser(["robot", &urdf, "--json"]).assert_done().json();
    assert_eq!(json["wheels"]["free"]["drive"], "free");
    assert!(json["provenance"]["input_sha256"].is_object());
    let text = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:wheel/></robot>";
    let xacro = folder.file("r.urdf", text);
    let said = grouser(["robot".as_ref(), xacro.as_os_str()]);
    said.assert_refused("xacro");
    assert!(said.err.contains("hint: expand macros"), "{said:?}");
}

/// A robot of a URDF keeps the names of its joints: a log of its drive names them so, and `estimate` finds its wheels.
#[test]
fn a_log_names_the_joints_of_the_robot_file() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let read = |name: &str| std::fs::read_to_string(format!("{root}/{name}")).unwrap();
    let folder = Folder::new();
    let mut robot = read("robots/five-wheel.toml");
    for wheel in [
        "front_left",
        "front_right",
        "rear_left",
        "rear_right",
        "fifth",
        "free",
    ] {
        let name = format!("name = \"{wheel}\"");
        robot = robot.replace(&name, &format!("{name}\njoint = \"{wheel}_wheel_joint\""));
    }
    let robot_file = folder.file("robot.toml", &robot);
    let scenario = read("scenarios/sandbox.toml")
        .replace("../robots/five-wheel.toml", "robot.toml")
        .replace("duration_s = 120.0", "duration_s = 4.0");
    let scenario = folder.file("scenario.toml", scenario);
    let log = folder.path("drive.mcap");
    let [scenario, log, robot] = [scenario, log, robot_file].map(|path| path.display().to_string());
    grouser(["drive", &scenario, "-o", &log]).assert_done();
    let said = grouser(["estimate", &log, "--robot", &robot, "--json"]);
    let wheels = &said.json()["wheels"];
    assert!(
        wheels["front_left"]["median"].is_number(),
        "{}{}",
        said.out,
        said.err
    );
}

/// What is learnt of the soil is in every output, and the table of its sensors is still a log.
#[test]
fn what_is_learnt_of_the_soil_is_in_json_text_report_and_logs() {
    let folder = Folder::new();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let robot = format!("{root}/robots/five-wheel.toml");
    let scenario = std::fs::read_to_string(format!("{root}/scenarios/unknown-soil.toml")).unwrap();
    let short = scenario
        .replace("../robots/five-wheel.toml", &robot)
        .replace("duration_s = 120.0", "duration_s = 12.0")
        .replace("world_laws = \"slip-velocity-regular\"\n", "");
    let path = folder.file("short.toml", short).display().to_string();
    let [table, recording, page] = ["drive.csv", "drive.mcap", "page.html"]
        .map(|name| folder.path(name).display().to_string());
    let arguments = ["drive", &path, "-o", &table, "--report", &page, "--json"];
    let runs = grouser(arguments).assert_done().json();
    let soil = &runs["runs"][0]["soil"];
    assert!(soil["readings"].as_u64().unwrap() >= 3, "{soil}");
    let number = |key: &str| soil[key].as_f64().unwrap();
    assert!(number("phi_low_deg") < number("phi_deg"), "{soil}");
    assert!(number("phi_deg") < number("phi_high_deg"), "{soil}");
    let report = embedded(&std::fs::read_to_string(&page).unwrap());
    assert_eq!(report["runs"][0]["soil"]["readings"], soil["readings"]);
    // the last row of the table has the last belief
    let rows = std::fs::read_to_string(&table).unwrap();
    let header: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    let column = header
        .iter()
        .position(|name| *name == "soil_phi_deg")
        .unwrap();
    let last: Vec<&str> = rows.lines().last().unwrap().split(',').collect();
    assert_eq!(last.len(), header.len());
    let shown: f64 = last[column].parse().unwrap();
    assert!((shown - number("phi_deg")).abs() < 1e-9, "{shown} {soil}");
    grouser(["estimate", &table, "--robot", &robot, "--json"]).assert_done();
    let said = grouser(["drive", &path, "-o", &recording]).assert_done();
    assert!(said.out.contains("soil learnt from"), "{said:?}");
    let topics = grouser(["log", "info", &recording, "--json"])
        .assert_done()
        .json();
    assert!(topics.to_string().contains("/grouser/soil"), "{topics}");
}

/// Sinkages and entry angles of a drive are in both logs, and `estimate` learns the soil from either; slips do not change.
#[test]
fn sinkages_are_learnt_from_in_the_drive_and_from_its_logs() {
    let folder = Folder::new();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let robot = format!("{root}/robots/five-wheel.toml");
    let scenario = std::fs::read_to_string(format!("{root}/scenarios/sinkage.toml")).unwrap();
    let short = scenario
        .replace("../robots/five-wheel.toml", &robot)
        .replace("duration_s = 120.0", "duration_s = 12.0");
    let path = folder.file("short.toml", short).display().to_string();
    let logs = ["drive.csv", "drive.mcap"].map(|name| folder.path(name).display().to_string());
    for log in &logs {
        let driven = grouser(["drive", &path, "-o", log, "--json"]).assert_done();
        let soil = driven.json()["runs"][0]["soil"].clone();
        assert_eq!(soil["contact_readings"], soil["readings"], "{soil}");
        assert_eq!(soil["contacts_refused"], 0, "{soil}");
    }
    let mut learnt = Vec::new();
    for log in &logs {
        let plain = grouser(["estimate", log, "--robot", &robot, "--json"]).assert_done();
        let soil = ["--soil", "dry-sand", "--learn-soil"];
        let arguments = ["estimate", log, "--robot", &robot, "--json"];
        let found = grouser(arguments.into_iter().chain(soil)).assert_done();
        let (plain, found) = (plain.json(), found.json());
        assert!(plain["soil"].is_null());
        for wheel in ["front_left", "rear_right"] {
            assert_eq!(
                plain["wheels"][wheel]["median"],
                found["wheels"][wheel]["median"]
            );
        }
        let output = folder.path("learnt.mcap").display().to_string();
        let arguments = ["estimate", log, "--robot", &robot, "-o", &output];
        grouser(arguments.into_iter().chain(soil)).assert_done();
        let topics = grouser(["log", "info", &output, "--json"]).assert_done();
        assert!(
            topics.json().to_string().contains("/grouser/soil"),
            "{topics:?}"
        );
        std::fs::remove_file(&output).unwrap();
        let soil = found["soil"].clone();
        assert!(soil["contact_readings"].as_u64().unwrap() >= 3, "{soil}");
        learnt.push(soil["stiffness"].as_f64().unwrap());
    }
    assert!((learnt[0] / learnt[1]).ln().abs() < 0.2, "{learnt:?}");
    let words = grouser([
        "estimate",
        &logs[1],
        "--robot",
        &robot,
        "--soil",
        "dry-sand",
        "--learn-soil",
    ]);
    assert!(words.assert_done().out.contains("with sinkages"));
}

/// What of a file's heights counts as unknown although the file does not say so is a warning, as in `map`.
#[test]
fn undeclared_no_data_is_a_warning() {
    let folder = Folder::new();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut grid = String::from("ncols 60\nnrows 40\ncellsize 0.5\nNODATA_value -1\n");
    for cell in 0..2400 {
        grid.push_str(if cell < 2 { "-9999 " } else { "0.5 " });
    }
    folder.file("flat.asc", grid);
    let scenario = format!(
        "format = 1\ntitle = \"flat\"\nrobot = \"{examples}/robots/skid-steer.toml\"\nseed = 1\nduration_s = 1.0\n\
         [start]\nx_m = 5.0\n[ground]\nkind = \"file\"\nfile = \"flat.asc\"\nsoil = \"sand\"\n[[soil]]\nname = \"sand\"\n\
         key = \"dry-sand\"\n[[leg]]\nduration_s = 1.0\nspeed_m_per_s = 0.1\n"
    );
    let path = folder.file("scenario.toml", scenario);
    let said = grouser(["drive".as_ref(), path.as_os_str()]).assert_done();
    assert!(
        said.err
            .contains("2 cells of the elevation model count as unknown: their height is -9999"),
        "{said:?}"
    );
}

/// Rough ground is a wall at the start of some seeds: they are rows of the sweep, and an error alone.
#[test]
fn a_seed_that_cannot_begin_is_a_row_of_the_sweep() {
    let folder = Folder::new();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let text = std::fs::read_to_string(format!("{root}/scenarios/plan-and-learn.toml")).unwrap();
    let rough = text
        .replace("../robots", &format!("{root}/robots"))
        .replace("duration_s = 240.0", "duration_s = 0.1")
        .replace("height_m = 0.02", "height_m = 0.6");
    let path = folder.file("rough.toml", rough).display().to_string();
    let swept = grouser(["drive", &path, "--sweep", "8", "--json"]).assert_done();
    let swept = swept.json();
    let rows = swept["runs"].as_array().unwrap();
    assert_eq!(rows.len(), 8);
    let (refused, driven): (Vec<_>, Vec<_>) =
        rows.iter().partition(|row| row["outcome"] == "refused");
    assert!(!refused.is_empty() && !driven.is_empty(), "{swept}");
    assert!(driven.iter().all(|row| row["refusal"].is_null()));
    let row = refused[0];
    assert!(
        row["refusal"].as_str().unwrap().contains("the start"),
        "{row}"
    );
    assert!(
        row["energy_j"] == 0.0 && row["slip_rmse"].is_null(),
        "{row}"
    );
    let seed = row["seed"].to_string();
    let text = grouser(["drive", &path, "--sweep", "8"]).assert_done();
    let line = format!("seed {seed} could not begin: the start");
    assert!(text.out.contains(&line), "{text:?}");
    grouser(["drive", &path, "--seed", &seed, "--json"]).assert_refused("a bad seed alone");
}
