//! Speed from the times of single pulses, extrapolated to now and bounded by the pulse that has not
//! come.

use core::f64::consts::TAU;

use super::Measured;
use crate::fault::Fault;
use crate::history::seconds_between;

/// The speed of an encoder's shaft from the time of each edge.
///
/// N edges per turn; pulse k starts at t_k, lasts Δt_k, ω_k = 2π/(N Δt_k), middle m_k = t_k + Δt_k/2;
/// the last edge is t_i = t_{i−1} + Δt_{i−1}.
///
/// |ω|(t) = min(max(0, ω_{i−1} + (ω_{i−1} − ω_{i−2}) · min(t − m_{i−1}, H)/(m_{i−1} − m_{i−2})), B),
/// with B = 2π/(N (t − t_i)) for t > t_i and H = 2 Δt_{i−1}.
///
/// B bounds the mean speed since the last edge, so the estimate decays to zero at standstill. No edge
/// yet, or one: no speed. One pulse: hold (within B). A reversal restarts; two edges at one time are
/// rejected.
///
/// Source: ours; the paper's formula (P24) is lost.
/// Variance: the change of speed over the stretch of extrapolation, as uniform in ± its size; the
/// clock's resolution δ in Δt, ω² δ²/(6 Δt²); and, where B binds, B²/12: all that is known is that the
/// speed lies in [0, B].
/// Assumes: edges equally spaced; the acceleration of the last two pulses goes on for at most H.
///
/// ```
/// use grouser_slip::PeriodSpeed;
/// let mut law = PeriodSpeed::new(100.0, 0.0)?; // edges per turn, clock resolution in s
/// for edge in 0..=3 {
///     law.edge(edge * 10_000_000, true)?; // every 10 ms: 2π rad/s
/// }
/// let now = law.speed_at(30_000_000).unwrap();
/// assert!((now.value - core::f64::consts::TAU).abs() < 1e-12);
/// let later = law.speed_at(130_000_000).unwrap(); // 100 ms without a pulse
/// assert!((later.value - core::f64::consts::TAU / 10.0).abs() < 1e-12);
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PeriodSpeed {
    angle_per_edge: f64,
    clock_resolution: f64,
    forward: bool,
    /// Newest last; `None` before it.
    edges: [Option<i64>; 3],
}

impl PeriodSpeed {
    /// An encoder of `edges_per_turn` edges, timed to `clock_resolution` seconds.
    ///
    /// # Errors
    /// [`Fault::OutOfRange`] for edges outside [1, 1e9] or a resolution outside [0, 1] s.
    pub fn new(edges_per_turn: f64, clock_resolution: f64) -> Result<Self, Fault> {
        Fault::check_range("edges_per_turn", edges_per_turn, 1.0, 1e9, "1")?;
        Fault::check_range("clock_resolution", clock_resolution, 0.0, 1.0, "s")?;
        Ok(Self {
            angle_per_edge: TAU / edges_per_turn,
            clock_resolution,
            forward: true,
            edges: [None; 3],
        })
    }

    /// Takes an edge; the direction comes from the quadrature or the command.
    ///
    /// # Errors
    /// [`Fault::NotLater`] for an edge not later than the last one (Δt = 0 included).
    pub fn edge(&mut self, time_ns: i64, forward: bool) -> Result<(), Fault> {
        if let Some(last_ns) = self.edges[2]
            && time_ns <= last_ns
        {
            return Err(Fault::NotLater { time_ns, last_ns });
        }
        if forward != self.forward {
            self.edges = [None; 3];
            self.forward = forward;
        }
        self.edges = [self.edges[1], self.edges[2], Some(time_ns)];
        Ok(())
    }

    /// The speed at `time_ns`, rad/s, signed; `None` before the first whole pulse and before the last
    /// edge.
    #[must_use]
    pub fn speed_at(&self, time_ns: i64) -> Option<Measured> {
        let [before, Some(start), Some(end)] = self.edges else {
            return None;
        };
        if time_ns < end {
            return None;
        }
        let period = seconds_between(start, end);
        let omega_1 = self.angle_per_edge / period;
        let since_edge = seconds_between(end, time_ns);
        let mut value = omega_1;
        let clock = omega_1 * self.clock_resolution / period;
        let mut variance = clock * clock / 6.0;
        if let Some(before) = before {
            let period_2 = seconds_between(before, start);
            let omega_2 = self.angle_per_edge / period_2;
            let between_middles = 0.5 * (period + period_2);
            let ahead = (since_edge + 0.5 * period).min(2.0 * period);
            let change = (omega_1 - omega_2) * ahead / between_middles;
            value = (omega_1 + change).max(0.0);
            variance += change * change / 3.0;
        }
        // infinite at the edge itself
        let bound = self.angle_per_edge / since_edge;
        if value >= bound {
            value = bound;
            variance = variance.max(bound * bound / 12.0);
        }
        let signed = if self.forward { value } else { -value };
        Some(Measured {
            value: signed,
            variance,
        })
    }
}
