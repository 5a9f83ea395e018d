//! The parts of a robot as the text of a robot file.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_real::Real;

use super::mass::Mass;
use super::parts::Parts;
use super::tree::Tree;
use crate::toml_text::quoted;

/// Lengths and masses are written to seven digits behind the point: a tenth of a micrometre.
const DIGITS: i32 = 7;
/// Least mass (kg) and moment of inertia (kg m²) of a robot file.
const MIN_MASS: f64 = 1e-3;
const MIN_INERTIA: f64 = 1e-9;

pub(super) fn text(tree: &Tree, parts: &Parts) -> String {
    let mut out = String::from("# Made of a URDF.\n");
    for note in &parts.notes {
        let _ = writeln!(out, "# {}", plain(note));
    }
    let _ = writeln!(out, "format = 1\nname = {}", quoted(&tree.name));
    let ground = parts.ground;
    if parts.chassis.kilograms > 0.0 {
        out.push_str("\n[chassis]\n");
        mass(&mut out, &parts.chassis, ground);
        for rocker in &parts.rockers {
            let _ = writeln!(out, "\n[[link]]\nname = {}", quoted(&rocker.name));
            if let Some(on) = rocker.on {
                let _ = writeln!(out, "on = {}", quoted(&parts.rockers[on].name));
            }
            let [x, y, z] = rocker.pivot;
            for (key, value) in [
                ("pivot_x_m", x),
                ("pivot_y_m", y),
                ("pivot_z_m", z - ground),
            ] {
                number(&mut out, key, value);
            }
            let own = if rocker.mass.kilograms > 0.0 {
                rocker.mass
            } else {
                Mass {
                    kilograms: MIN_MASS,
                    centre: rocker.pivot,
                    ..Mass::default()
                }
            };
            mass(&mut out, &own, ground);
            if let Some(opposite) = opposite(parts, rocker.name.as_str()) {
                let _ = writeln!(out, "opposite = {}", quoted(opposite));
            }
            if rocker.damping > 0.0 {
                number(&mut out, "damping_nms_per_rad", rocker.damping);
            }
            if let Some(range) = rocker.range.filter(|range| *range > 0.0) {
                number(&mut out, "range_deg", range.to_degrees().clamp(0.1, 90.0));
            }
        }
    }
    for wheel in &parts.wheels {
        let _ = writeln!(out, "\n[[wheel]]\nname = {}", quoted(&wheel.name));
        if wheel.name != wheel.joint {
            let _ = writeln!(out, "joint = {}", quoted(&wheel.joint));
        }
        let [x, y, z] = wheel.centre;
        number(&mut out, "x_m", x);
        number(&mut out, "y_m", y);
        number(&mut out, "z_m", z - ground);
        for (key, angle) in [("heading_deg", wheel.heading), ("camber_deg", wheel.camber)] {
            if angle.abs() > 1e-6 {
                number(&mut out, key, angle.to_degrees());
            }
        }
        number(&mut out, "radius_m", wheel.radius);
        if let Some(width) = wheel.width {
            number(&mut out, "width_m", width);
        }
        if let Some(lugs) = wheel.lugs {
            number(&mut out, "grouser_height_m", lugs.height);
            let _ = writeln!(out, "grouser_count = {}", lugs.count);
            number(&mut out, "grouser_thickness_m", lugs.thickness);
        }
        let drive = if wheel.free { "free" } else { "powered" };
        let _ = writeln!(out, "drive = \"{drive}\"");
        if wheel.reversed {
            out.push_str("reversed = true\n");
        }
        if parts.chassis.kilograms > 0.0 {
            if let Some(on) = wheel.on {
                let _ = writeln!(out, "on = {}", quoted(&parts.rockers[on].name));
            }
            if wheel.mass.kilograms > 0.0 {
                number(&mut out, "mass_kg", wheel.mass.kilograms.max(MIN_MASS));
            }
            if wheel.spin_inertia > MIN_INERTIA {
                number(&mut out, "spin_inertia_kg_m2", wheel.spin_inertia);
            }
            if let Some([range, rate]) = wheel.steering.filter(|[range, _]| *range > 0.0) {
                number(&mut out, "steer_range_deg", range.to_degrees().min(180.0));
                if rate > 0.0 {
                    number(
                        &mut out,
                        "steer_rate_deg_per_s",
                        rate.to_degrees().clamp(0.1, 1e4),
                    );
                }
            }
        }
    }
    out
}

/// The other side of a differential, whichever of the two mimics the other.
fn opposite<'a>(parts: &'a Parts, name: &str) -> Option<&'a str> {
    let own = parts.rockers.iter().find(|rocker| rocker.name == name)?;
    let by_other = || {
        let other = parts
            .rockers
            .iter()
            .find(|other| other.opposite.as_deref() == Some(name))?;
        Some(other.name.as_str())
    };
    own.opposite.as_deref().or_else(by_other)
}

fn mass(out: &mut String, mass: &Mass, ground: f64) {
    number(out, "mass_kg", mass.kilograms.max(MIN_MASS));
    let [x, y, z] = mass.centre;
    for (key, value) in [("cg_x_m", x), ("cg_y_m", y), ("cg_z_m", z - ground)] {
        number(out, key, value);
    }
    let i = &mass.inertia;
    for (key, value) in [
        ("inertia_xx_kg_m2", i[0][0]),
        ("inertia_yy_kg_m2", i[1][1]),
        ("inertia_zz_kg_m2", i[2][2]),
    ] {
        number(out, key, value.max(MIN_INERTIA));
    }
}

fn number(out: &mut String, key: &str, value: f64) {
    let scale = Real::powi(10_f64, DIGITS);
    let rounded = (value * scale).round() / scale;
    // what is smaller than the last digit is written as it is
    let shown = if rounded == 0.0 && value.abs() > 1e-12 {
        value
    } else {
        rounded + 0.0
    };
    let _ = writeln!(out, "{key} = {shown:?}");
}

/// A note on one line of a comment.
fn plain(note: &str) -> String {
    note.chars().filter(|letter| !letter.is_control()).collect()
}
