//! One list of fields as text, CSV, a JSON object and its schema. `cargo run -p grouser-report --example wheels`

use std::io::Write as _;

use grouser_report::fields;

#[derive(Clone, Copy)]
struct Wheel {
    load: f64,
    sinkage: Option<f64>,
}

fn main() -> std::io::Result<()> {
    let fields = fields! { |wheel: Wheel|
        "load_n" "load" .shown("N") = wheel.load;
        "sinkage_m" "sinkage" .shown("mm") = wheel.sinkage;
    };
    let front = Wheel {
        load: 80.0,
        sinkage: Some(0.0125),
    };
    let lifted = Wheel {
        load: 0.0,
        sinkage: None,
    };
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", fields.lines(front))?;
    writeln!(out, "{}", fields.csv([front, lifted]))?;
    writeln!(
        out,
        "{:#}",
        serde_json::Value::Object(fields.object(lifted))
    )?;
    writeln!(out, "{:#}", fields.schema())
}
