"""The two scorers agree, and both are right where the answer is known."""

from __future__ import annotations

import math
from typing import Dict, List

import numpy as np
import pytest

from slipbench import score, second
from slipbench.log import Series, Truth


def drawn(seed: int) -> tuple[Truth, Series, float]:
    """Points with gaps, slips that dig at times, estimates with gaps, missing intervals and all sizes of errors."""
    random = np.random.default_rng(seed)
    time_s = np.arange(3.0, 40.0, 0.1)
    time_s = time_s[random.random(len(time_s)) < random.choice([1.0, 0.98, 0.9])]
    slip = np.clip(random.choice([0.1, 0.7]) + 0.5 * np.sin(time_s / random.uniform(1, 4)) + 0.05 * random.normal(size=len(time_s)), -1, 1)
    at = np.sort(random.uniform(0, 42, int(random.choice([0, 40, 400, 1200]))))
    answer = np.interp(at, time_s, slip) + random.choice([0.0, 0.05, 0.3]) * random.normal(size=len(at))
    answer[random.random(len(at)) < 0.05] = np.nan
    half = random.choice([0.02, 0.1, 0.3]) * random.random(len(at))
    low, high = answer - half, answer + 0.7 * half
    unknown = random.random(len(at)) < random.choice([0.0, 0.2, 1.0])
    low[unknown] = high[unknown] = np.nan
    return Truth(time_s, slip), Series(at, answer, low, high), float(random.choice([0.0, 0.02]))


def by_second(truth: Truth, series: Series, sigma: float) -> Dict[str, float]:
    points = [(float(t), float(s)) for t, s in zip(truth.time_s, truth.slip)]
    estimates = [tuple(map(float, row)) for row in zip(series.time_s, series.slip, series.low, series.high)]
    return second.judge(points, estimates, sigma)  # type: ignore[arg-type]


def test_both_scorers_agree_to_1e_9() -> None:
    everything: Dict[str, float] = {}
    ones, others = [], []
    for seed in range(300):
        truth, series, sigma = drawn(seed)
        one, other = score.of_wheel(truth, series, sigma), by_second(truth, series, sigma)
        for key, value in other.items():
            assert getattr(one, key) == pytest.approx(value, rel=1e-9, abs=1e-9), f"{key} of seed {seed}"
            everything[key] = everything.get(key, 0) + value
        ones.append(one)
        others.append(other)
    # the cases hold something of each
    assert all(value > 0 for value in everything.values()), everything
    pooled = score.of_world([score.Outcome({"wheel": one}, 0.0, 1) for one in ones])
    for key, value in second.pool(others).items():
        assert getattr(pooled, key) == pytest.approx(value, rel=1e-9), key


def steady(slip: List[float], half: float, offset: float = 0.0) -> score.WheelScore:
    time_s = 3 + 0.1 * np.arange(len(slip))
    true = np.array(slip)
    answer = true + offset
    return score.of_wheel(Truth(time_s, true), Series(time_s, answer, answer - half, answer + half), 0.0)


def test_known_answers() -> None:
    exact = steady([0.1] * 50, 0.05, 0.03)
    assert (exact.points, exact.answered, exact.held) == (50, 50, 50)
    assert math.sqrt(exact.square / 50) == pytest.approx(0.03)
    # 0.03 is beyond 4 sigma of a half-width of 0.01, at all points: 5 s
    wrong = steady([0.1] * 50, 0.01, 0.03)
    assert wrong.held == 0
    assert wrong.overconfident_s == pytest.approx(5.0)


def test_a_dig_is_called_after_half_a_second_and_a_false_call_counts() -> None:
    dig = [0.1] * 20 + [0.8] * 30 + [0.1] * 20
    found = steady(dig, 0.05)
    assert (found.digs, found.called, found.false_calls) == (1, 1, 0)
    assert found.call_s == pytest.approx(0.4)
    # the same estimate on ground that does not slip
    time_s = 3 + 0.1 * np.arange(len(dig))
    answer = np.array(dig)
    wrong = score.of_wheel(Truth(time_s, np.full(len(dig), 0.1)), Series(time_s, answer, answer - 0.05, answer + 0.05), 0.0)
    assert (wrong.digs, wrong.false_calls) == (0, 1)


def test_an_old_estimate_is_no_answer() -> None:
    truth = Truth(np.array([3.0, 3.2, 3.6]), np.array([0.1, 0.1, 0.1]))
    one = np.array([3.0]), np.array([0.1]), np.array([0.0]), np.array([0.2])
    assert score.of_wheel(truth, Series(*one), 0.0).answered == 2
