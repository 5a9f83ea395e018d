"""Scores of estimates against the truth. `slipbench.second` computes the same by other code; a test compares both."""

from __future__ import annotations

import dataclasses
import math
from typing import Dict, List, Optional, Sequence

import numpy as np

from slipbench.log import Estimates, Floats, Run, Series, Truth
from slipbench.motion import POINT_S

MAX_AGE_S = 0.3  # an estimate older than this is no answer
# An interval of 90 % that were normal has 4 sigma at 2.43 half-widths: beyond it the estimate is overconfident.
BEYOND = 4 / 1.645
# A dig: a slip above 0.6 for 1 s, from which wheels sink in faster than they drive out. An entrant calls it where its one-sided 90 %
# bound (1.28 of 1.645 half-widths; its slip, where it states no interval) is above 0.6 for 0.5 s.
DIG_SLIP, DIG_S, CALL_S = 0.6, 1.0, 0.5
ONE_SIDED = 1.28 / 1.645
# A call is false where the slip was below this during the last second; what lies between is nobody's fault.
SURELY_NOT = 0.5
Z_90 = 1.645


@dataclasses.dataclass(frozen=True)
class WheelScore:
    """Of one wheel of one run. Sums, so that runs can be pooled."""

    points: int
    answered: int
    square: float  # sum of squared errors
    stated: int  # points with an interval
    held: int
    half: float  # sum of half-widths
    overconfident_s: float  # longest stretch
    digs: int
    called: int
    call_s: float  # sum of the times from the begin of a dig to its call
    false_calls: int


@dataclasses.dataclass(frozen=True)
class Score:
    """Of one entrant in one world. Rates are NaN where there is nothing to divide by."""

    runs: int
    failed: int
    points: int
    answered: float
    rmse: float
    stated: float
    held: float
    half: float
    overconfident_s: float
    overconfident_runs: float
    digs: int
    called: int
    call_s: float
    false_calls: int
    us_per_row: float


def at_points(series: Series, time_s: Floats) -> Series:
    """The last estimate at or before each point, NaN where it is too old."""
    if not len(series.time_s):
        nothing = np.full(len(time_s), np.nan)
        return Series(time_s, nothing, nothing, nothing)
    last = np.searchsorted(series.time_s, time_s + 1e-6, side="right") - 1
    at = np.maximum(last, 0)
    is_fresh = (last >= 0) & (time_s - series.time_s[at] <= MAX_AGE_S)
    pick = lambda values: np.where(is_fresh, values[at], np.nan)
    return Series(time_s, pick(series.slip), pick(series.low), pick(series.high))


def longest(time_s: Floats, is_on: Sequence[bool]) -> float:
    """The longest stretch of neighbouring points that are on, each as long as the distance of points."""
    best = current = 0
    for k, on in enumerate(is_on):
        follows = k > 0 and time_s[k] - time_s[k - 1] < 1.5 * POINT_S
        current = (current + 1 if follows else 1) if on else 0
        best = max(best, current)
    return best * POINT_S


def digs_of(truth: Truth) -> List[List[int]]:
    """First and last point of each true dig."""
    found, begin = [], None
    time_s, slip = truth.time_s, truth.slip
    for k in range(len(slip) + 1):
        goes_on = k < len(slip) and slip[k] > DIG_SLIP and (begin is None or time_s[k] - time_s[k - 1] < 1.5 * POINT_S)
        if goes_on:
            begin = k if begin is None else begin
            continue
        if begin is not None and time_s[k - 1] - time_s[begin] + POINT_S >= DIG_S - 1e-9:
            found.append([begin, k - 1])
        begin = k if k < len(slip) and slip[k] > DIG_SLIP else None
    return found


def calls_of(time_s: Floats, bound: Floats) -> List[int]:
    """Points at which a call begins to hold."""
    found, count = [], 0
    for k, one in enumerate(bound):
        follows = k > 0 and time_s[k] - time_s[k - 1] < 1.5 * POINT_S
        is_on = bool(one > DIG_SLIP)
        count = (count + 1 if follows else 1) if is_on else 0
        if count == round(CALL_S / POINT_S):
            found.append(k)
    return found


def of_wheel(truth: Truth, series: Series, sigma: float) -> WheelScore:
    here = at_points(series, truth.time_s)
    error = here.slip - truth.slip
    is_answered = np.isfinite(error)
    # the truth's own noise widens the interval: both are independent
    below, above = here.slip - here.low, here.high - here.slip
    if sigma > 0:
        below, above = np.hypot(below, Z_90 * sigma), np.hypot(above, Z_90 * sigma)
    is_stated = is_answered & np.isfinite(below) & np.isfinite(above)
    side = np.where(error > 0, below, above)
    # 1e-12: an interval of no width around the truth holds
    is_held = is_stated & (np.abs(error) <= side + 1e-12)
    is_beyond = is_stated & (np.abs(error) > BEYOND * side + 1e-12)
    bound = np.where(is_stated, here.slip - ONE_SIDED * (here.slip - here.low), here.slip)
    calls, digs = calls_of(truth.time_s, np.where(is_answered, bound, -np.inf)), digs_of(truth)
    times_s = [truth.time_s[k] for k in calls]
    called, call_s = 0, 0.0
    for begin, end in digs:
        # a call before the dig's begin counts where it still holds at its begin
        inside = [t for t in times_s if truth.time_s[begin] - DIG_S <= t <= truth.time_s[end]]
        if inside:
            called += 1
            call_s += max(inside[0] - truth.time_s[begin], 0.0)
    false = 0
    for k in calls:
        during = (truth.time_s >= truth.time_s[k] - 1.0 - 1e-9) & (truth.time_s <= truth.time_s[k] + 1e-9)
        false += bool((truth.slip[during] < SURELY_NOT).all())
    return WheelScore(
        points=len(truth.time_s),
        answered=int(is_answered.sum()),
        square=float((error[is_answered] ** 2).sum()),
        stated=int(is_stated.sum()),
        held=int(is_held.sum()),
        half=float((0.5 * (below + above))[is_stated].sum()),
        overconfident_s=longest(truth.time_s, is_beyond.tolist()),
        digs=len(digs),
        called=called,
        call_s=call_s,
        false_calls=false,
    )


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What an entrant did with a run: its wheels' scores, processor time, and what went wrong."""

    wheels: Dict[str, WheelScore]
    spent_s: float
    rows: int
    failure: Optional[str] = None


def of_run(run: Run, estimates: Estimates) -> Dict[str, WheelScore]:
    nothing = Series(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0))
    return {name: of_wheel(truth, estimates.get(name, nothing), run.sigma) for name, truth in run.truth.items() if len(truth.time_s)}


def of_world(outcomes: Sequence[Outcome]) -> Score:
    """Pooled: each point counts the same; a run is overconfident where any of its wheels is for over 1 s."""
    wheels = [wheel for outcome in outcomes for wheel in outcome.wheels.values()]
    total = lambda key: sum(getattr(wheel, key) for wheel in wheels)
    share = lambda a, b: a / b if b else math.nan
    judged = [outcome for outcome in outcomes if any(wheel.stated for wheel in outcome.wheels.values())]
    worst = [max(wheel.overconfident_s for wheel in outcome.wheels.values()) for outcome in judged]
    return Score(
        runs=len(outcomes),
        failed=sum(outcome.failure is not None for outcome in outcomes),
        points=total("points"),
        answered=share(total("answered"), total("points")),
        rmse=math.sqrt(share(total("square"), total("answered"))) if total("answered") else math.nan,
        stated=share(total("stated"), total("points")),
        held=share(total("held"), total("stated")),
        half=share(total("half"), total("stated")),
        overconfident_s=max(worst, default=math.nan),
        overconfident_runs=share(sum(one > 1.0 + 1e-9 for one in worst), len(worst)),
        digs=total("digs"),
        called=total("called"),
        call_s=share(total("call_s"), total("called")),
        false_calls=total("false_calls"),
        us_per_row=1e6 * share(sum(outcome.spent_s for outcome in outcomes), sum(outcome.rows for outcome in outcomes)),
    )
