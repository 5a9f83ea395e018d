//! The frame of a map: places in metres on a page, with axes and marks.

use std::fmt::Write as _; // writing to a string cannot fail

use crate::page_text::png_address;
use crate::style::Colour;
use crate::ticks::even_ticks;

const TOP_MARGIN_PT: f64 = 12.0;
const RIGHT_MARGIN_PT: f64 = 24.0;
/// Beside the frame: the title of the axis, and each letter of the longest label.
const AXIS_TITLE_PT: f64 = 28.0;
const LETTER_PT: f64 = 7.5;
/// Below the frame: labels and the title of the axis; the key follows.
const AXIS_HEIGHT_PT: f64 = 60.0;
/// A side shorter than this has ticks in three intervals at most, a longer one in eight.
const SHORT_SIDE_PT: f64 = 200.0;

/// A rectangle of ground (m, x to the right, y upwards) on a page (points, y downwards).
///
/// ```
/// use grouser_figure::MapFrame;
///
/// let frame = MapFrame::new([0.0, 0.0], [20.0, 10.0], [400.0, 400.0]);
/// let ([left, bottom], [right, top]) = (frame.at([0.0, 0.0]), frame.at([20.0, 10.0]));
/// assert_eq!((right - left, bottom - top), (400.0, 200.0));
/// assert!(frame.axes().contains("(m)"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFrame {
    low: [f64; 2],
    high: [f64; 2],
    scale: f64,
    left: f64,
}

impl MapFrame {
    /// A frame from `low` to `high` (m) as large as fits into `max_size` (points).
    #[must_use]
    pub fn new(low: [f64; 2], high: [f64; 2], max_size: [f64; 2]) -> Self {
        let extent = [high[0] - low[0], high[1] - low[1]];
        let scale = (max_size[0] / extent[0]).min(max_size[1] / extent[1]);
        let mut frame = Self {
            low,
            high,
            scale,
            left: 0.0,
        };
        let labels = frame.ticks(1);
        let letters = labels.iter().map(|(_, label)| label.chars().count());
        frame.left = AXIS_TITLE_PT + LETTER_PT * letters.max().unwrap_or(1) as f64;
        frame
    }

    /// Width and height of the ground on the page, points.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.high[axis] - self.low[axis]) * self.scale)
    }

    /// Where a place (m) is on the page.
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.left + (x - self.low[0]) * self.scale,
            TOP_MARGIN_PT + (self.high[1] - y) * self.scale,
        ]
    }

    /// The upper left corner of the key, below the axes.
    #[must_use]
    pub fn key(&self) -> [f64; 2] {
        [self.left, TOP_MARGIN_PT + self.size()[1] + AXIS_HEIGHT_PT]
    }

    /// Width and height of the page, with a key of `width` and `height`.
    #[must_use]
    pub fn page(&self, [width, height]: [f64; 2]) -> [f64; 2] {
        let [left, top] = self.key();
        [
            left + self.size()[0].max(width) + RIGHT_MARGIN_PT,
            top + height,
        ]
    }

    /// The ground as a picture that fills the frame; `style` is that of the element, such as `image-rendering:pixelated`.
    #[must_use]
    pub fn ground(&self, png: &[u8], style: &str) -> String {
        let ([x, y], [width, height]) = (self.at([self.low[0], self.high[1]]), self.size());
        format!(
            "<image x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.2}\" height=\"{height:.2}\" preserveAspectRatio=\"none\" \
             style=\"{style}\" href=\"{}\"/>\n",
            png_address(png)
        )
    }

    /// The border with ticks, labels and titles.
    #[must_use]
    pub fn axes(&self) -> String {
        let ([left, bottom], [width, height]) = (self.at(self.low), self.size());
        let mut out = format!(
            "<rect x=\"{left:.1}\" y=\"{TOP_MARGIN_PT}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" \
             stroke=\"{0}\" stroke-width=\"1.2\"/>\n",
            Colour::INK
        );
        for (value, label) in self.ticks(0) {
            let [x, _] = self.at([value, self.low[1]]);
            let _ = writeln!(
                out,
                "<path d=\"M{x:.1} {bottom:.1}v-6\" stroke=\"{0}\"/>\
                 <text x=\"{x:.1}\" y=\"{1:.1}\" text-anchor=\"middle\">{label}</text>",
                Colour::INK,
                bottom + 19.0
            );
        }
        for (value, label) in self.ticks(1) {
            let [_, y] = self.at([self.low[0], value]);
            let _ = writeln!(
                out,
                "<path d=\"M{left:.1} {y:.1}h6\" stroke=\"{0}\"/>\
                 <text x=\"{1:.1}\" y=\"{2:.1}\" text-anchor=\"end\">{label}</text>",
                Colour::INK,
                left - 7.0,
                y + 4.5
            );
        }
        let _ = writeln!(
            out,
            "<text x=\"{0:.1}\" y=\"{1:.1}\" text-anchor=\"middle\"><tspan font-style=\"italic\">x</tspan> (m)</text>\
             <text x=\"14\" y=\"{2:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {2:.1})\">\
             <tspan font-style=\"italic\">y</tspan> (m)</text>",
            left + 0.5 * width,
            bottom + 40.0,
            TOP_MARGIN_PT + 0.5 * height,
        );
        out
    }

    /// A disc with a word of one or two letters at a place (m).
    #[must_use]
    pub fn mark(&self, place: [f64; 2], word: &str) -> String {
        let [x, y] = self.at(place);
        format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"9\" fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.6\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{word}</text>\n",
            Colour::INK,
            y + 4.5
        )
    }

    fn ticks(&self, axis: usize) -> Vec<(f64, String)> {
        let intervals = if self.size()[axis] < SHORT_SIDE_PT {
            3
        } else {
            8
        };
        even_ticks(self.low[axis], self.high[axis], intervals)
    }
}
