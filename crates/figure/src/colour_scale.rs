//! Colours that stand for numbers.

use std::fmt::Write as _; // writing to a string cannot fail

use crate::style::Colour;

/// Colours of a quantity, mixed evenly between its stops.
///
/// ```
/// use grouser_figure::{Colour, ColourScale};
///
/// let scale = ColourScale(&[(0.0, Colour(0, 0, 0)), (2.0, Colour(200, 100, 0))]);
/// assert_eq!(scale.at(1.0), Colour(100, 50, 0));
/// assert_eq!(scale.at(7.0).to_string(), "#c86400");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ColourScale<'s>(pub &'s [(f64, Colour)]);

impl ColourScale<'_> {
    /// The colour of a value; beyond the last stop on either side that stop's, for NaN the first one's.
    #[must_use]
    pub fn at(&self, value: f64) -> Colour {
        let Some(next) = self.0.iter().position(|(at, _)| *at >= value) else {
            let end = if value.is_nan() {
                self.0.first()
            } else {
                self.0.last()
            };
            return end.map_or(Colour::GREY, |(_, colour)| *colour);
        };
        let ((from, low), (to, high)) = (self.0[next.saturating_sub(1)], self.0[next]);
        let share = if to > from {
            ((value - from) / (to - from)).max(0.0)
        } else {
            0.0
        };
        let mixed = |low: u8, high: u8| {
            let mixed = f64::from(low) + share * (f64::from(high) - f64::from(low));
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "between two bytes"
            )]
            let byte = mixed.round() as u8;
            byte
        };
        Colour(
            mixed(low.0, high.0),
            mixed(low.1, high.1),
            mixed(low.2, high.2),
        )
    }

    /// A bar of the colours with its upper left corner at `[x, top]`, labelled at `labels`; `id` names it on its page.
    #[must_use]
    pub fn bar(&self, id: &str, [x, top]: [f64; 2], width: f64, labels: &[(f64, &str)]) -> String {
        let (Some((from, _)), Some((to, _))) = (self.0.first(), self.0.last()) else {
            return String::new();
        };
        let share = |value: f64| (value - from) / (to - from);
        let mut out = format!("<defs><linearGradient id=\"{id}\">");
        for (value, colour) in self.0 {
            let _ = write!(
                out,
                "<stop offset=\"{:.3}\" stop-color=\"{colour}\"/>",
                share(*value)
            );
        }
        let _ = writeln!(
            out,
            "</linearGradient></defs>\n<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"11\" fill=\"url(#{id})\" \
             stroke=\"{}\" stroke-width=\"0.8\"/>",
            Colour::INK
        );
        for (value, label) in labels {
            let x = x + width * share(*value);
            let _ = writeln!(
                out,
                "<path d=\"M{x:.1} {:.1}v4\" stroke=\"{}\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                top + 11.0,
                Colour::INK,
                top + 30.0
            );
        }
        out
    }
}
