//! The JSON schema of every verb holds what the verb prints.

use std::path::Path;

use serde_json::Value;

use super::program::{Folder, grouser, line};

/// Each verb with an example; `OUT` is a folder.
const EXAMPLES: &[(&str, &str)] = &[
    ("soils", "soils"),
    (
        "wheel",
        "wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65 --slip 0.25",
    ),
    (
        "wheel",
        "wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65 --slip 0.25 --slope-deg 5",
    ),
    (
        "wheel",
        "wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 1e9 --slip 0.25",
    ),
    (
        "wheel",
        "wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 40 --slip 0:0.9 --points 5",
    ),
    ("batch", "batch examples/batch/points.csv -o OUT/solved.csv"),
    (
        "paper slip-model",
        "paper slip-model --theta-deg 32 --sinkage-m 0.01 --radius-m 0.1",
    ),
    (
        "paper slip-model",
        "paper slip-model --theta-deg 0:40 --points 4 --sinkage-m 0.01 --radius-m 0.1",
    ),
    (
        "estimate",
        "estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml --soil dry-sand",
    ),
    ("optimize", "optimize examples/problems/running-slip.toml"),
    (
        "optimize",
        "optimize examples/problems/pull-against-torque.toml",
    ),
    (
        "map",
        "map examples/terrain/dunes.asc --robot examples/robots/skid-steer.toml --soil sandy-loam --headings 4 -o OUT/map.tif",
    ),
    (
        "plan",
        "plan OUT/map.tif --from 3,3 --to 20,9 -o OUT/way.csv -o OUT/way.svg",
    ),
    (
        "plan",
        "plan OUT/map.tif --from 3,3 --to 20,9 --min-tip-over-deg 80",
    ),
    (
        "design",
        "design examples/robots/five-wheel.toml --soil dry-sand --slope-deg 0=0.9,4=0.1 --radius-m 0.15 --points 2",
    ),
    ("robot", "robot examples/robots/five-wheel.urdf"),
    ("identify", "identify examples/bevameter/tests.toml"),
    ("log info", "log info examples/five-wheel/log.mcap"),
    (
        "log info",
        "log info examples/five-wheel/log.csv --suggest-robot",
    ),
    (
        "log convert",
        "log convert examples/five-wheel/log.mcap OUT/imu.csv --topic /imu",
    ),
    (
        "log recover",
        "log recover examples/five-wheel/log.mcap OUT/whole.mcap",
    ),
    (
        "climb",
        "climb --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65",
    ),
    ("drive", "drive examples/scenarios/slope.toml"),
    ("paper", "paper -o OUT/paper"),
    ("paper", "paper --end-to-end -o OUT/end"),
    (
        "robot",
        "robot examples/robots/five-wheel.toml --stance --pitch-deg 15",
    ),
    (
        "fmu",
        "fmu --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65 --slip 0.25 -o OUT/wheel.fmu",
    ),
    ("init", "init robot"),
];

/// Verbs that take minutes or need another program.
const NOT_RUN: [&str; 2] = ["validate", "view"];

/// What is wrong with `value`, by the keywords that the schemas use.
fn fault(value: &Value, schema: &Value, place: &str) -> Option<String> {
    if let Some(several) = schema["anyOf"].as_array() {
        let faults: Vec<String> = several
            .iter()
            .filter_map(|one| fault(value, one, place))
            .collect();
        return (faults.len() == several.len()).then(|| faults.join("; or "));
    }
    let kinds: Vec<&str> = match &schema["type"] {
        Value::String(kind) => vec![kind],
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        _ => return None,
    };
    let fits = |kind: &&str| match *kind {
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    };
    if !kinds.iter().any(fits) {
        return Some(format!("{place} is {value}, but must be {kinds:?}"));
    }
    if let Some(items) = value.as_array() {
        let mut items = items.iter().enumerate();
        return items
            .find_map(|(index, item)| fault(item, &schema["items"], &format!("{place}[{index}]")));
    }
    let object = value.as_object()?;
    let required = schema["required"].as_array().into_iter().flatten();
    if let Some(missing) = required
        .filter_map(Value::as_str)
        .find(|key| !object.contains_key(*key))
    {
        return Some(format!("{place} lacks {missing}"));
    }
    object.iter().find_map(|(key, item)| {
        let place = format!("{place}.{key}");
        match (
            schema["properties"].get(key),
            &schema["additionalProperties"],
        ) {
            (Some(own), _) => fault(item, own, &place),
            (None, Value::Bool(false)) => Some(format!("{place} is not in the schema")),
            (None, others) => fault(item, others, &place),
        }
    })
}

fn schema(verb: &str) -> Value {
    line(&format!("help {verb} --schema")).assert_done().json()
}

#[test]
fn what_a_verb_prints_fits_its_schema() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap();
    let folder = Folder::new();
    for (verb, words) in EXAMPLES.iter().copied() {
        let words = words
            .replace("OUT", &folder.path("").display().to_string())
            .replace("examples/", &format!("{}/examples/", root.display()));
        let said = grouser(words.split_whitespace().chain(["--json"]));
        assert!(matches!(said.code, Some(0 | 1 | 3)), "{words}: {said:?}");
        assert_eq!(fault(&said.json(), &schema(verb), verb), None, "{words}");
    }
}

#[test]
fn every_verb_with_a_schema_has_an_example() {
    // the refusal lists all of them
    let refused = line("help help --schema").err;
    let names = refused.split("verbs with one are ").nth(1).unwrap();
    let names: Vec<&str> = names.trim().split(", ").collect();
    assert!(names.len() >= 20, "{names:?}");
    for name in &names {
        let schema = schema(name);
        for keyword in ["anyOf", "required"] {
            let list = schema.get(keyword);
            assert!(
                list.is_none_or(Value::is_array),
                "{name}: {keyword} {list:?}"
            );
        }
    }
    for name in names.into_iter().filter(|name| !NOT_RUN.contains(name)) {
        assert!(EXAMPLES.iter().any(|(verb, _)| *verb == name), "{name}");
    }
}

#[test]
fn a_wrong_object_does_not_fit() {
    let schema = schema("wheel");
    let words = "wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65 --slip 0.25 --json";
    let mut object = line(words).json();
    object["sinkage_m"] = "deep".into();
    assert!(
        fault(&object, &schema, "wheel")
            .unwrap()
            .contains("sinkage_m")
    );
    object["sinkage_m"] = Value::Null;
    object["depth"] = 1.into();
    assert!(fault(&object, &schema, "wheel").unwrap().contains("depth"));
    object.as_object_mut().unwrap().remove("depth");
    object.as_object_mut().unwrap().remove("radius_m");
    assert!(
        fault(&object, &schema, "wheel")
            .unwrap()
            .contains("radius_m")
    );
}

#[test]
fn keys_carry_their_units() {
    let wheel = &schema("wheel")["anyOf"][0];
    assert_eq!(wheel["properties"]["sinkage_m"]["unit"], "m");
    assert_eq!(
        wheel["properties"]["drawbar_pull_n"]["description"],
        "drawbar pull"
    );
    assert!(
        wheel["required"]
            .as_array()
            .unwrap()
            .contains(&"provenance".into())
    );
    assert!(
        !wheel["required"]
            .as_array()
            .unwrap()
            .contains(&"slip_demand".into())
    );
}
