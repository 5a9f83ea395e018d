"""Speeds and turns that a robot is commanded, drawn at random."""

from __future__ import annotations

from typing import Callable, Sequence, Tuple

import numpy as np

from slipbench.log import Floats


def levels(random: np.random.Generator, time_s: Floats, gap_s: Tuple[float, float], draw: Callable[[], float], lag_s: float) -> Floats:
    """Zero for 2 s, then levels that last for a random time, followed with a lag."""
    target = np.zeros(len(time_s))
    at = 2.0
    while at < time_s[-1]:
        until = at + random.uniform(*gap_s)
        target[(time_s >= at) & (time_s < until)] = draw()
        at = until
    return lagged(target, time_s, lag_s)


def lagged(target: Floats, time_s: Floats, lag_s: float) -> Floats:
    share = min(1.0, (time_s[1] - time_s[0]) / lag_s)
    out, now = np.empty_like(target), float(target[0])
    for i, one in enumerate(target):
        now += share * (one - now)
        out[i] = now
    return out


def drives(random: np.random.Generator, time_s: Floats, top: float, shares: Sequence[float] = (1.0, 0.6, 0.0)) -> Floats:
    """Mostly at speed, at times slower, seldom a stop."""
    chances = np.array([0.65, 0.25, 0.1, 0.1][: len(shares)])
    return levels(random, time_s, (5, 12), lambda: top * float(random.choice(shares, p=chances / chances.sum())), 0.4)


def bends(random: np.random.Generator, time_s: Floats, most: float, share: float = 0.6) -> Floats:
    """Turns for a share of the time."""
    return levels(random, time_s, (3, 8), lambda: float(random.uniform(-most, most) * (random.random() < share)), 0.4)
