//! What the slip model reports: text, a table, JSON.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_terra::Mobilised;

use super::point::Point;
use grouser_report::number::shown;
use grouser_report::{Fields, fields};

/// The points, and what is mobilised.
type Run<'a> = (&'a Vec<Point>, Option<Mobilised>);

/// One point has its keys at the top; several stand in `points`.
pub(super) fn fields<'a>() -> Fields<'a, Run<'a>> {
    let several = fields! { |points: &'a [Point]|
        "points" "the points" rows(point()) = points;
    };
    fields! { |run: Run<'a>|
        "model" "the model" = "Ani et al. 2012, S = 1 - v/(r w)";
        "mobilised" "share of the strength that is mobilised" = run.1.map_or(0.0, |mobilised| mobilised.share);
        "k_shear_m" "shear deformation modulus" = run.1.map(|mobilised| mobilised.k_shear);
        also(point()) = match run.0.as_slice() { [point] => Some(point), _ => None };
        also(several) = Some(run.0.as_slice()).filter(|points| points.len() != 1);
    }
}

fn point<'a>() -> Fields<'a, &'a Point> {
    fields! { |point: &'a Point|
        "theta_deg" "angle on the wheel" .shown("deg").label("θ").given() = point.theta_deg;
        "sinkage_m" "sinkage" .shown("mm").label("z").given() = point.sinkage_m;
        "radius_m" "radius of the wheel" .shown("mm").label("r").given() = point.radius_m;
        "status" "status" = point.status();
        "slip" "slip S = 1 - v/(r ω)" .shown("") = point.slip().map(|slip| slip.driving_formula);
        "slip_magnitude" "its magnitude" .shown("") = point.slip().map(|slip| slip.driving_formula.abs());
        "slip_ratio" "as a slip ratio s" .shown("") = point.slip().map(|slip| slip.slip.value());
        "theta_1_deg" "entry angle" .shown("deg") = point.slip().map(|slip| slip.theta_1.deg());
        "in_contact" "whether the angle lies in the contact" = point.slip().map(|slip| slip.in_contact);
        "most_mobilised" "maximum share that can be mobilised" = point.max_share();
        "cautions" "cautions" = point.cautions();
    }
}

/// One point, for people.
pub(super) fn single(point: &Point, share: f64) -> String {
    let mut text = format!(
        "θ {} deg, sinkage {} mm, radius {} mm, {} of the strength mobilised\n",
        shown(point.theta_deg),
        shown(1e3 * point.sinkage_m),
        shown(1e3 * point.radius_m),
        if share == 0.0 {
            "none".to_owned()
        } else {
            shown(share)
        }
    );
    if let Some(slip) = point.slip() {
        let keys = ["slip", "slip_magnitude", "slip_ratio", "theta_1_deg"];
        text.push_str(&self::point().pick(&keys).lines(point));
        if !slip.in_contact {
            let entry = shown(slip.theta_1.deg());
            let _ = writeln!(
                text,
                "caution: θ lies outside the contact, which ends at {entry} deg"
            );
        }
    }
    text
}

/// Several points, for people.
pub(super) fn table(points: &[Point]) -> String {
    let columns = fields! { |point: &'_ Point|
        join(self::point()) = point;
        remark "" = match point.slip() {
            None => point.status(),
            Some(slip) if !slip.in_contact => "outside the contact",
            Some(_) => "",
        };
    };
    let columns = columns
        .at("slip")
        .label("S")
        .at("slip_magnitude")
        .label("|S|")
        .at("slip_ratio")
        .label("s");
    let keys = "theta_deg,sinkage_m,radius_m,slip,slip_magnitude,slip_ratio,";
    let columns = columns.pick(&keys.split(',').collect::<Vec<_>>());
    columns.table(points)
}

/// All points as a table.
pub(super) fn csv(points: &[Point], share: f64) -> String {
    let columns = fields! { |point: &'_ Point|
        join(self::point()) = point;
        "mobilised" "share of the strength that is mobilised" .given() = share;
    };
    let keys = "theta_deg,sinkage_m,radius_m,mobilised,slip,slip_magnitude,slip_ratio,theta_1_deg,in_contact,status";
    columns
        .pick(&keys.split(',').collect::<Vec<_>>())
        .csv(points)
}
