"""The scores again, by plain Python written apart from `slipbench.score`, as a check of both. No numpy."""

from __future__ import annotations

import bisect
import math
from typing import Dict, Iterable, List, Optional, Tuple

Estimate = Tuple[float, float, float, float]  # time, slip, low, high
Point = Tuple[float, float]  # time, true slip


def judge(points: List[Point], estimates: List[Estimate], sigma: float) -> Dict[str, float]:
    """Of one wheel of one run."""
    stamps = [estimate[0] for estimate in estimates]
    square, half = [], []
    answered = stated = held = 0
    beyond: List[bool] = []
    bounds: List[Optional[float]] = []
    for time_s, true in points:
        slip, low, high = latest(estimates, stamps, time_s)
        if math.isnan(slip):
            beyond.append(False)
            bounds.append(None)
            continue
        answered += 1
        square.append((slip - true) ** 2)
        bound, is_beyond = slip, False
        if not (math.isnan(low) or math.isnan(high)):
            stated += 1
            down, up = widened(slip - low, sigma), widened(high - slip, sigma)
            half.append((down + up) / 2)
            room = down if slip > true else up
            held += abs(slip - true) <= room + 1e-12
            is_beyond = abs(slip - true) > 4 / 1.645 * room + 1e-12
            bound = slip - 1.28 / 1.645 * (slip - low)
        beyond.append(is_beyond)
        bounds.append(bound)
    runs = stretches(points, [flag for flag in beyond])
    digs = [(points[a][0], points[b][0]) for a, b in stretches(points, [true > 0.6 for _, true in points]) if points[b][0] - points[a][0] + 0.1 >= 1.0 - 1e-9]
    calls = [points[a + 4][0] for a, b in stretches(points, [one is not None and one > 0.6 for one in bounds]) if b - a >= 4]
    waits = []
    for begin, end in digs:
        near = [call for call in calls if begin - 1.0 <= call <= end]
        if near:
            waits.append(max(near[0] - begin, 0.0))
    false = sum(all(true < 0.5 for time_s, true in points if call - 1.0 - 1e-9 <= time_s <= call + 1e-9) for call in calls)
    return {
        "points": len(points),
        "answered": answered,
        "square": math.fsum(square),
        "stated": stated,
        "held": held,
        "half": math.fsum(half),
        "overconfident_s": 0.1 * max((b - a + 1 for a, b in runs), default=0),
        "digs": len(digs),
        "called": len(waits),
        "call_s": math.fsum(waits),
        "false_calls": false,
    }


def widened(room: float, sigma: float) -> float:
    return math.sqrt(room * room + (1.645 * sigma) ** 2) if sigma > 0 else room


def latest(estimates: List[Estimate], stamps: List[float], time_s: float) -> Tuple[float, float, float]:
    """The last estimate that is not older than 0.3 s."""
    k = bisect.bisect_right(stamps, time_s + 1e-6)
    if k == 0 or time_s - stamps[k - 1] > 0.3:
        return math.nan, math.nan, math.nan
    return estimates[k - 1][1:]


def stretches(points: List[Point], flags: Iterable[bool]) -> List[Tuple[int, int]]:
    """First and last index of neighbouring points whose flag is set; points more than 0.15 s apart are no neighbours."""
    found: List[Tuple[int, int]] = []
    for k, flag in enumerate(flags):
        if not flag:
            continue
        if found and found[-1][1] == k - 1 and points[k][0] - points[k - 1][0] < 1.5 * 0.1:
            found[-1] = (found[-1][0], k)
        else:
            found.append((k, k))
    return found


def pool(wheels: List[Dict[str, float]]) -> Dict[str, float]:
    """Of a world: root mean square error, share held, mean half-width."""
    add = lambda key: math.fsum(wheel[key] for wheel in wheels)
    ratio = lambda a, b: add(a) / add(b) if add(b) else math.nan
    return {
        "rmse": math.sqrt(ratio("square", "answered")),
        "answered": ratio("answered", "points"),
        "stated": ratio("stated", "points"),
        "held": ratio("held", "stated"),
        "half": ratio("half", "stated"),
        "call_s": ratio("call_s", "called"),
        "overconfident_s": max(wheel["overconfident_s"] for wheel in wheels),
    }
