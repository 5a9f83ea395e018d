//! `--screen`: wheels, slips with their sigma, events and latencies on a terminal, also over ssh.
//!
//! A thread of its own draws the newest snapshot: a terminal that is slow never holds up the estimate.

use std::io::{self, IsTerminal as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use grouser_slip::{Health, WheelEstimate};
use ratatui::Frame;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyModifiers};
use ratatui::layout::{Constraint, Layout};
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph};

use crate::error::{Error, Result};

/// The screen is drawn this often, and keys are read: fast enough for an eye, and 30 kB/s at most over ssh.
const PERIOD: Duration = Duration::from_millis(100);
/// Characters of a bar from slip −1 to 1, with one for 0.
const BAR: usize = 41;
/// Events that are kept.
pub(crate) const MAX_EVENTS: usize = 50;

/// What is shown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Snapshot {
    pub(crate) title: String,
    pub(crate) names: Vec<String>,
    pub(crate) wheels: Vec<WheelEstimate>,
    /// Forward speed (m/s) and yaw rate (rad/s) with their sigmas.
    pub(crate) motion: Option<[f64; 4]>,
    /// Median, 99.9 % and longest, µs.
    pub(crate) latency_us: Option<[f64; 3]>,
    pub(crate) messages: u64,
    /// Share of the requested motion that passes, where commands are limited.
    pub(crate) command_share: Option<f64>,
    /// The newest last.
    pub(crate) events: Vec<String>,
    pub(crate) problems: Vec<String>,
}

/// A bar of a slip from −1 to 1: full up to the slip less its sigma, half within a sigma.
fn bar(slip: f64, sigma: f64) -> String {
    let middle = (BAR / 2) as f64;
    let low = slip.min(0.0).min(slip - sigma);
    let high = slip.max(0.0).max(slip + sigma);
    let cell = |index: usize| {
        let at = (index as f64 - middle) / middle;
        let half = 0.5 / middle;
        if (at - slip).abs() <= sigma + half && at >= low - half && at <= high + half {
            '▒'
        } else if at.abs() < half {
            '│'
        } else if at * slip > 0.0 && at.abs() < slip.abs() {
            '█'
        } else {
            '·'
        }
    };
    (0..BAR).map(cell).collect()
}

fn wheel_line<'a>(name: &'a str, width: usize, wheel: &WheelEstimate) -> Line<'a> {
    let colour = match wheel.health {
        Health::Ok => Color::Green,
        Health::Degraded(_) => Color::Yellow,
        _ => Color::Red,
    };
    let (bar, number) = match (wheel.slip, wheel.sigma) {
        (Some(slip), Some(sigma)) => (
            bar(slip.value(), sigma),
            format!("{:>6.3} ± {sigma:.3}", slip.value()),
        ),
        _ => (" ".repeat(BAR), format!("{:>14}", "–")),
    };
    let motion = wheel.motion.map_or("–", |motion| motion.name());
    Line::from(vec![
        Span::raw(format!("{name:width$} ")),
        Span::styled(bar, Style::new().fg(colour)),
        Span::raw(format!(" {number}  {motion:<10} ")),
        Span::styled(wheel.health.to_string(), Style::new().fg(colour)),
    ])
}

/// Draws a snapshot; what does not fit is cut off.
pub(crate) fn draw(frame: &mut Frame<'_>, shown: &Snapshot) {
    let rows = |count: usize| Constraint::Length(u16::try_from(count + 2).unwrap_or(u16::MAX));
    let [wheels, node, problems, events] = Layout::vertical([
        rows(shown.wheels.len().max(1)),
        rows(3),
        rows(shown.problems.len().max(1)),
        Constraint::Min(3),
    ])
    .areas(frame.area());
    let width = shown.names.iter().map(|name| name.chars().count()).max();
    let lines = shown.names.iter().zip(&shown.wheels);
    let lines: Vec<Line<'_>> = lines
        .map(|(name, wheel)| wheel_line(name, width.unwrap_or(0), wheel))
        .collect();
    let title = format!(" {} · slip from -1 to 1 · q ends ", shown.title);
    frame.render_widget(
        Paragraph::new(lines).block(Block::bordered().title(title)),
        wheels,
    );

    let motion = shown.motion.map_or_else(
        || "motion: not known".to_owned(),
        |[v, v_sigma, rate, rate_sigma]| {
            format!("forwards {v:.3} ± {v_sigma:.3} m/s, turns {rate:.3} ± {rate_sigma:.3} rad/s")
        },
    );
    let latency = shown.latency_us.map_or_else(
        || "no latency yet".to_owned(),
        |[median, high, longest]| {
            format!("message to slip: median {median:.0} µs, 99.9 % {high:.0} µs, longest {longest:.0} µs")
        },
    );
    let command = shown.command_share.map_or_else(
        || "commands are not limited".to_owned(),
        |share| format!("of the requested motion {:.0} % passes", 100.0 * share),
    );
    let lines = vec![
        Line::from(motion),
        Line::from(format!("{} messages; {latency}", shown.messages)),
        Line::from(command),
    ];
    frame.render_widget(
        Paragraph::new(lines).block(Block::bordered().title(" robot and node ")),
        node,
    );

    let lines: Vec<Line<'_>> = if shown.problems.is_empty() {
        vec![Line::styled("none", Style::new().fg(Color::Green))]
    } else {
        let red = Style::new().fg(Color::Red);
        shown
            .problems
            .iter()
            .map(|problem| Line::styled(problem.as_str(), red))
            .collect()
    };
    frame.render_widget(
        Paragraph::new(lines).block(Block::bordered().title(" problems ")),
        problems,
    );

    // the newest first, so that it shows however low the terminal is
    let lines: Vec<Line<'_>> = shown
        .events
        .iter()
        .rev()
        .map(|event| Line::from(event.as_str()))
        .collect();
    frame.render_widget(
        Paragraph::new(lines).block(Block::bordered().title(" events, newest first ")),
        events,
    );
}

/// The terminal while it is the node's.
pub(crate) struct Screen {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    newest: Mutex<Option<Snapshot>>,
    ends: AtomicBool,
}

impl Screen {
    /// Takes the terminal; `q`, Escape and Ctrl-C set `interrupted`.
    ///
    /// # Errors
    /// [`Error::Option`] where standard output is no terminal.
    pub(crate) fn open(interrupted: Arc<AtomicBool>) -> Result<Self> {
        let refused = |wanted: String| Error::Option {
            name: "--screen",
            value: "set".to_owned(),
            wanted,
        };
        if !io::stdout().is_terminal() || !io::stdin().is_terminal() {
            return Err(refused(
                "left out: standard input and output are no terminal".to_owned(),
            ));
        }
        let mut terminal = ratatui::try_init()
            .map_err(|error| refused(format!("left out: the terminal cannot be used ({error})")))?;
        let shared: Arc<Shared> = Arc::default();
        let own = Arc::clone(&shared);
        let thread = std::thread::spawn(move || {
            while !own.ends.load(Ordering::Relaxed) {
                let newest = own
                    .newest
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .take();
                if let Some(snapshot) = newest
                    && terminal.draw(|frame| draw(frame, &snapshot)).is_err()
                {
                    break;
                }
                // a terminal that is gone ends the screen, not the node
                let Ok(has_key) = event::poll(PERIOD) else {
                    break;
                };
                if has_key && event::read().is_ok_and(|event| is_end(&event)) {
                    interrupted.store(true, Ordering::Relaxed);
                }
            }
            ratatui::restore();
        });
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// Shows a snapshot with the next drawing.
    pub(crate) fn show(&self, snapshot: Snapshot) {
        let mut newest = self
            .shared
            .newest
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *newest = Some(snapshot);
    }

    /// How often a new snapshot is of use.
    pub(crate) const fn period() -> Duration {
        PERIOD
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn is_end(event: &Event) -> bool {
    matches!(event, Event::Key(key) if key.code == KeyCode::Char('q')
        || key.code == KeyCode::Esc
        || (key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use grouser_slip::filter::{FilterSettings, SlipFilter};
    use grouser_slip::{Measurement, Robot, Sample, Wheel};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    /// Wheels as an estimator gives them: one slips by 0.2, and one has no reading.
    fn wheels() -> Vec<WheelEstimate> {
        let wheels = vec![
            Wheel::powered("left")
                .at(0.0, 0.2)
                .radius(0.1)
                .ticks_per_turn(1000),
            Wheel::powered("right")
                .at(0.0, -0.2)
                .radius(0.1)
                .ticks_per_turn(1000),
            Wheel::free("fifth").radius(0.1).ticks_per_turn(1000),
        ];
        let robot = Robot::new("cart".into(), wheels).unwrap();
        let mut filter = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
        for step in 0..300_u64 {
            let time_ns = i64::try_from(step * 10_000_000).unwrap();
            for (wheel, raw) in [(0, 10 * step), (2, 8 * step)] {
                let _ = filter.update(Sample {
                    time_ns,
                    measurement: Measurement::WheelCount { wheel, raw },
                });
            }
        }
        filter.latest().wheels.to_vec()
    }

    fn screen(width: u16, height: u16, shown: &Snapshot) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| draw(frame, shown)).unwrap();
        let buffer = terminal.backend().buffer();
        let row = |y: u16| {
            (0..width)
                .map(|x| buffer[(x, y)].symbol())
                .collect::<String>()
        };
        (0..height).map(row).collect::<Vec<_>>().join("\n")
    }

    fn snapshot() -> Snapshot {
        Snapshot {
            title: "/grouser on zenoh".to_owned(),
            names: ["left", "right", "fifth"].map(str::to_owned).to_vec(),
            wheels: wheels(),
            motion: Some([0.2, 0.01, 0.0, 0.002]),
            latency_us: Some([180.0, 760.0, 1800.0]),
            messages: 4000,
            command_share: Some(0.62),
            events: vec![
                "high slip of left begins".to_owned(),
                "the wheels dig in begins".to_owned(),
            ],
            problems: vec!["`/imu` is silent".to_owned()],
        }
    }

    #[test]
    fn wheels_bars_events_latencies_and_problems_are_on_the_screen() {
        let text = screen(100, 24, &snapshot());
        for part in [
            "/grouser on zenoh",
            " 0.200 ± ",
            "Driving",
            "Ok",
            "99.9 % 760 µs",
            "62 % passes",
            "`/imu` is silent",
            "the wheels dig in begins",
        ] {
            assert!(text.contains(part), "no `{part}`:\n{text}");
        }
        let wheel = |name: &str| {
            text.lines()
                .find(|line| line.contains(name))
                .unwrap()
                .to_owned()
        };
        assert!(
            wheel("right").contains('–'),
            "a wheel without a slip has no number:\n{text}"
        );
        let newest = text.find("the wheels dig in").unwrap();
        assert!(
            newest < text.find("high slip of left").unwrap(),
            "the newest first"
        );
    }

    #[test]
    fn a_bar_ends_at_its_slip_and_shows_its_sigma() {
        let full = |slip, sigma| bar(slip, sigma).matches('█').count();
        assert_eq!(bar(0.3, 0.1).chars().count(), BAR);
        // 20 characters for a slip of 1
        assert_eq!(full(0.5, 0.1), 7);
        assert_eq!(full(1.0, 0.01), 19);
        assert_eq!(full(-0.5, 0.1), 7);
        assert_eq!(bar(0.5, 0.1).matches('▒').count(), 5);
        let negative: Vec<char> = bar(-0.5, 0.01).chars().collect();
        assert!(negative[10..19].contains(&'█') && !negative[21..].contains(&'█'));
        for slip in [-1.0, -0.2, 0.0, 0.7, 1.0] {
            assert!(bar(slip, 0.05).contains('▒'), "{slip}");
        }
    }

    #[test]
    fn any_size_of_a_terminal_is_drawn() {
        for (width, height) in [(1, 1), (5, 3), (20, 60), (300, 2), (80, 24)] {
            screen(width, height, &snapshot());
            screen(width, height, &Snapshot::default());
        }
    }
}
