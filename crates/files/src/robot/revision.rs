//! A robot file with some numbers changed, its comments and everything else as they stand.

use std::fmt::Write as _;
use std::ops::Range;

use grouser_real::Real;
use grouser_slip::SensorSettings;
use grouser_slip::WheelRole;
use grouser_slip::filter::FilterSettings;

use super::{
    Corrections, REFERENCE_LATENCY_KEY, WheelSensor, parse, read_estimator, read_filter_fields,
    read_meanings, read_wheel,
};
use crate::body;
use crate::document::Document;
use crate::error::{Error, Place, Result};
use crate::section::Section;
use crate::steering::read_section;

/// What a calibration changes in a robot file; `None` leaves it as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Revision {
    /// Factor on the radii of all powered wheels.
    pub radius: Option<f64>,
    /// Factor on the distance of left and right wheels: on `y_m` of all wheels.
    pub track: Option<f64>,
    /// Factor on `yaw_rate_scale`.
    pub yaw_rate: Option<f64>,
    /// The new `interval_factor`.
    pub interval: Option<f64>,
    /// The new `reference_latency_s`.
    pub reference_latency: Option<f64>,
}

/// The document's text with numbers changed; comments and everything else stay as they are. Lengths are rounded to a
/// micrometre, factors to 1e-5, times to a millisecond.
///
/// # Errors
/// As [`read`](super::read), of the document and of the text that results; [`Error::Contradiction`] where a new key of
/// `[estimator]` or `[filter]` has no place because the table is written in one line.
///
/// ```
/// use grouser_files::Document;
/// use grouser_files::robot::{Revision, parse, revised};
///
/// let document = Document::read("../../examples/five-wheel/robot.toml".as_ref())?;
/// let before = parse(&document)?.robot.wheels()[0].radius;
/// let text = revised(&document, &Revision { radius: Some(1.02), ..Revision::default() })?;
/// let after = parse(&Document::from_text("scaled.toml", text)?)?.robot.wheels()[0].radius;
/// assert!((after / before - 1.02).abs() < 1e-5);
/// # Ok::<(), grouser_files::Error>(())
/// ```
pub fn revised(document: &Document, revision: &Revision) -> Result<String> {
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    let mut added = String::new();
    let mut at: Option<Place> = None;
    let mut added_to_filter = String::new();
    let mut filter_at: Option<Place> = None;
    document.parse(|root| {
        root.text("name")?;
        let mut corrections = Corrections::default();
        root.section("estimator", |section| {
            corrections = read_estimator(section, &mut SensorSettings::default())?.1;
            // The names of sensors are checked where the robot is read, below.
            section.optional_choice("wheel_sensor", &WheelSensor::NAMES)?;
            at = Some(section.place());
            put_factors(section, revision, corrections, &mut edits, &mut added);
            Ok::<_, Error>(())
        })?;
        if at.is_none() {
            for (key, value) in factors(revision, corrections) {
                // Writing to a string cannot fail.
                let _ = writeln!(added, "{key} = {value:.5}");
            }
        }
        root.section("steering", read_section)?;
        let mut latency_span = None;
        root.section("filter", |section| {
            filter_at = Some(section.place());
            latency_span = section.span_of(REFERENCE_LATENCY_KEY);
            read_filter_fields(section, &mut FilterSettings::default())
        })?;
        if let Some(latency_s) = revision.reference_latency {
            match latency_span {
                Some(span) => edits.push((span, format!("{latency_s:.3}"))),
                None => added_to_filter = format!("{REFERENCE_LATENCY_KEY} = {latency_s:.3}\n"),
            }
        }
        read_meanings(root)?;
        root.sections("wheel", |section| {
            section.optional_text("joint")?;
            // Checked where the robot is read, below.
            section.optional_number("torque_per_ampere_nm", (0.0, f64::MAX))?;
            let wheel = read_wheel(section)?;
            body::read_wheel(section)?;
            let mut put = |key: &str, value: f64| {
                if let Some(span) = section.span_of(key) {
                    edits.push((span, format!("{value:.6}")));
                }
            };
            if let (Some(factor), WheelRole::Powered) = (revision.radius, wheel.role) {
                let roller = section.optional_number("roller_deg", (-80.0, 80.0))?;
                let share = Real::cos(roller.unwrap_or(0.0).to_radians());
                put("radius_m", wheel.radius / share * factor);
            }
            if let Some(factor) = revision.track {
                put("y_m", wheel.y * factor);
            }
            Ok(())
        })?;
        body::read(root, Vec::new())
    })?;
    let mut text = document.text().to_owned();
    for (header, at, added) in [
        ("[estimator]", at, added),
        ("[filter]", filter_at, added_to_filter),
    ] {
        if added.is_empty() {
            continue;
        }
        match at {
            None => {
                let end = text.len();
                edits.push((end..end, format!("\n{header}\n{added}")));
            }
            Some(at) => {
                let place = header_end(&text, header).ok_or_else(|| Error::Contradiction {
                    at,
                    message: format!(
                        "add to it by hand, since it is no table with a header of its own: {}",
                        added.trim_end().replace('\n', ", ")
                    ),
                })?;
                edits.push((place..place, added));
            }
        }
    }
    // From the end, so that the places before stay right.
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    for (span, value) in edits {
        text.replace_range(span, &value);
    }
    let rewritten = Document::from_text(document.name(), text)?;
    parse(&rewritten)?;
    Ok(rewritten.text().to_owned())
}

/// The factors of `[estimator]` that change, with their new values.
fn factors(
    revision: &Revision,
    corrections: Corrections,
) -> impl Iterator<Item = (&'static str, f64)> {
    let yaw_rate = revision
        .yaw_rate
        .map(|factor| factor * corrections.yaw_rate_scale);
    let all = [
        ("yaw_rate_scale", yaw_rate),
        ("interval_factor", revision.interval),
    ];
    all.into_iter()
        .filter_map(|(key, value)| Some((key, value?)))
}

fn put_factors(
    section: &Section<'_>,
    revision: &Revision,
    corrections: Corrections,
    edits: &mut Vec<(Range<usize>, String)>,
    added: &mut String,
) {
    for (key, value) in factors(revision, corrections) {
        match section.span_of(key) {
            Some(span) => edits.push((span, format!("{value:.5}"))),
            None => {
                // Writing to a string cannot fail.
                let _ = writeln!(added, "{key} = {value:.5}");
            }
        }
    }
}

/// The byte behind the line of a header.
fn header_end(text: &str, header: &str) -> Option<usize> {
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        offset += line.len();
        let bare = line.split('#').next().unwrap_or("").trim();
        if bare == header && line.ends_with('\n') {
            return Some(offset);
        }
    }
    None
}
