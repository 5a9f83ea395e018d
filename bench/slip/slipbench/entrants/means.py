"""What anybody computes first: distances over a window of time."""

from __future__ import annotations

import numpy as np

from slipbench.entrants.distances import Distances, distances
from slipbench.log import Estimates, Floats, Log, Series, slip_of

Z_90 = 1.645
MIN_WHEEL_M_PER_S = 0.02


def window_mean(log: Log, span_s: float, is_centred: bool) -> Estimates:
    return {wheel.name: mean_of(distances(log, wheel), span_s, is_centred) for wheel in log.robot.powered}


def mean_of(both: Distances, span_s: float, is_centred: bool) -> Series:
    """The interval has the noise of both ends, and half of the difference between the window's halves: slip that changes."""
    last = np.arange(len(both.time_s))
    begin_s = both.time_s - span_s + 1e-6
    first = np.searchsorted(both.time_s, begin_s)
    middle = np.searchsorted(both.time_s, begin_s + 0.5 * span_s)
    is_known = (begin_s >= both.time_s[0]) & (first < middle) & (middle < last) & (both.piece[first] == both.piece[last])
    first, middle, last = first[is_known], middle[is_known], last[is_known]
    slip, sigma = slip_between(both, first, last)
    early, _ = slip_between(both, first, middle)
    late, _ = slip_between(both, middle, last)
    half = Z_90 * np.hypot(sigma, 0.5 * (late - early))
    time_s = both.time_s[last] - (0.5 * span_s if is_centred else 0.0)
    return Series(time_s, slip, slip - half, slip + half)


def slip_between(both: Distances, first: Floats, last: Floats) -> tuple[Floats, Floats]:
    wheel, ground = both.wheel[last] - both.wheel[first], both.ground[last] - both.ground[first]
    span_s = both.time_s[last] - both.time_s[first]
    slip = np.clip(slip_of(wheel, ground), -1, 1)
    faster = np.maximum(np.abs(wheel), np.abs(ground))
    ends = 2 * (both.wheel_sigma**2 + both.end_sigma**2)
    sigma = np.sqrt(ends + both.step_sigma**2 * (last - first)) / np.maximum(faster, 1e-9)
    slip = np.where(np.abs(wheel) >= MIN_WHEEL_M_PER_S * span_s, slip, np.nan)
    return slip, sigma


def ratio_of_counts(log: Log) -> Estimates:
    """Ani et al. (2012): the slip is the ratio of the counts of a powered wheel and of the free one. No gyro, no interval.

    Over 0.25 s, for logs with a free wheel; the paper states no window.
    """
    if log.reference.kind != "free-wheel":
        return {}
    turned = lambda wheel: log.wheel_distance(wheel.name)
    free, span_rows = turned(log.robot.free[0]), max(1, round(0.25 / float(np.median(np.diff(log.time_s)))))
    found = {}
    for wheel in log.robot.powered:
        rolled = turned(wheel)
        steps, ground = rolled[span_rows:] - rolled[:-span_rows], free[span_rows:] - free[:-span_rows]
        time_s = log.time_s[span_rows:]
        slip = np.where(np.abs(steps) >= MIN_WHEEL_M_PER_S * 0.25, np.clip(slip_of(steps, ground), -1, 1), np.nan)
        unknown = np.full(len(slip), np.nan)
        found[wheel.name] = Series(time_s, slip, unknown, unknown)
    return found
