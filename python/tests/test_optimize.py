"""The optimiser with functions written in Python."""

from __future__ import annotations

import pickle
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from grouser import InputError, InputTypeError, optimize

EXAMPLES = Path(__file__).parents[2] / "examples" / "problems"


def rosen_suzuki(x: np.ndarray) -> list[float]:
    return [x[0] ** 2 + x[1] ** 2 + 2 * x[2] ** 2 + x[3] ** 2 - 5 * x[0] - 5 * x[1] - 21 * x[2] + 7 * x[3]]


def rosen_suzuki_constraints(x: np.ndarray) -> list[float]:
    return [
        x[0] ** 2 + x[1] ** 2 + x[2] ** 2 + x[3] ** 2 + x[0] - x[1] + x[2] - x[3] - 8,
        x[0] ** 2 + 2 * x[1] ** 2 + x[2] ** 2 + 2 * x[3] ** 2 - x[0] - x[3] - 10,
        2 * x[0] ** 2 + x[1] ** 2 + x[2] ** 2 + 2 * x[0] - x[1] - x[3] - 5,
    ]


def test_a_published_optimum_under_constraints() -> None:
    # Rosen & Suzuki 1965 (Hock & Schittkowski 43): (0, 1, 2, -1), -44
    found = optimize.weighted(
        rosen_suzuki, weights=[1.0], start=np.zeros(4), inequalities=rosen_suzuki_constraints
    )
    assert found.is_solved
    np.testing.assert_allclose(found.x, [0, 1, 2, -1], atol=1e-5)
    assert found.objectives[0] == pytest.approx(-44.0, abs=1e-7)
    assert found.active and found.counts.values > 0
    assert pickle.loads(pickle.dumps(found)).status == found.status


def test_gradients_of_the_user_replace_differences() -> None:
    calls = 0

    def functions(x: np.ndarray) -> list[float]:
        nonlocal calls
        calls += 1
        return [x[0] ** 2 + x[1] ** 4, (2 - x[0]) ** 2 + (2 - x[1]) ** 2, 2 * np.exp(x[1] - x[0])]

    def gradients(x: np.ndarray) -> list[list[float]]:
        e = 2 * np.exp(x[1] - x[0])
        return [[2 * x[0], 4 * x[1] ** 3], [-2 * (2 - x[0]), -2 * (2 - x[1])], [-e, e]]

    numeric = optimize.minimax(functions, start=[2.0, 2.0])
    by_differences, calls = calls, 0
    exact = optimize.minimax(functions, start=[2.0, 2.0], gradients=gradients)
    assert exact.maximum == pytest.approx(1.9522245, abs=1e-6) == numeric.maximum
    assert calls < by_differences
    assert sum(exact.multipliers["objectives"]) == pytest.approx(1.0)


def test_goals_weights_and_an_ideal() -> None:
    f = lambda x: [x[0] ** 2, (x[0] - 2.0) ** 2]  # noqa: E731
    attained = optimize.attain(f, goals=[0.0, 0.0], weights=[1.0, 1.0], start=[0.3])
    assert attained.x[0] == pytest.approx(1.0, abs=1e-6)
    assert optimize.weighted(f, weights=[3.0, 1.0], start=[0.3]).x[0] == pytest.approx(0.5, abs=1e-6)
    assert optimize.chebyshev(f, ideal=[0.0, 0.0], weights=[1.0, 1.0], start=[0.3]).x[0] == pytest.approx(1.0, abs=1e-6)


def test_a_front_in_closed_form() -> None:
    # Schaffer 1985: sqrt(f1) + sqrt(f2) = 2
    front = optimize.pareto(
        lambda x: [x[0] ** 2, (x[0] - 2.0) ** 2], start=[1.0], lower=-10.0, upper=10.0, population=24, generations=25
    )
    assert len(front.x) >= 12
    np.testing.assert_allclose(np.sqrt(front.objectives).sum(axis=1), 2.0, atol=1e-6)


def test_a_front_without_a_feasible_point_is_empty_and_says_so() -> None:
    f = lambda x: [x[0], x[1]]  # noqa: E731
    box = {"start": [0.5, 0.5], "lower": 0.0, "upper": 1.0, "population": 12, "generations": 2}
    front = optimize.pareto(f, inequalities=lambda x: [1.0 + x[0]], **box)
    assert (front.status, front.x.shape, front.objectives.shape) == ("no_feasible_point", (0, 2), (0, 2))
    assert front.violation == pytest.approx(1.0, abs=0.5) and front.knee is None
    assert optimize.pareto(f, **box).status == "converged"
    text = """
    method = "pareto"
    [variables]
    x = { start = 0.5, lower = 0.0, upper = 1.0 }
    [objectives]
    f = "x"
    g = "1 - x"
    [constraints]
    c = "x >= 2"
    """
    found = optimize.solve_text(text)
    assert (found.status, found.x.shape, found.objectives.shape) == ("no_feasible_point", (0, 1), (0, 2))


def test_ctrl_c_ends_a_search_in_many_variables() -> None:
    """All 450 bounds hold at first and leave one by one, which takes half a minute without any call of the function."""
    main = threading.main_thread().ident
    assert main is not None
    fired: list[float] = []

    def interrupt() -> None:
        fired.append(time.monotonic())
        signal.pthread_kill(main, signal.SIGINT)

    timer = threading.Timer(2.0, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        optimize.minimax(lambda x: [float(((x - 0.1) ** 2).sum())], start=np.full(450, 0.5), lower=0.0, upper=1.0)
    assert time.monotonic() - fired[0] < 5.0
    timer.join()


def test_robust_measures_in_closed_form() -> None:
    f = lambda x, a: [(x[0] - a) ** 2]  # noqa: E731
    worst = optimize.robust(f, worlds=[0.0, 1.0, 4.0], start=[0.5])
    assert worst.x[0] == pytest.approx(2.0, abs=1e-6)
    mean = optimize.robust(f, worlds=[0.0, 1.0, 5.0], start=[0.5], measure="cvar", parameter=0.0)
    assert mean.x[0] == pytest.approx(2.0, abs=1e-6) and len(mean.x) == 1


def test_linear_constraints_and_bounds_are_never_left() -> None:
    seen: list[np.ndarray] = []

    def f(x: np.ndarray) -> list[float]:
        seen.append(x.copy())
        return [-x[0] - x[1]]

    found = optimize.minimax(
        f, start=[0.1, 0.1], lower=[0.0, 0.0], upper=[1.0, 1.0], linear=[optimize.Linear([1.0, 2.0], 2.0, name="budget")]
    )
    np.testing.assert_allclose(found.x, [1.0, 0.5], atol=1e-8)
    assert "budget" in found.active
    points = np.array(seen)
    assert points.min() >= 0.0 and points.max() <= 1.0


class Boom(Exception):
    pass


@pytest.mark.parametrize("verb", ["minimax", "starts", "pareto", "progress", "gradients"])
def test_an_exception_passes_through_with_its_type(verb: str) -> None:
    count = 0

    def f(x: np.ndarray) -> list[float]:
        nonlocal count
        count += 1
        if verb in ("minimax", "starts", "pareto") and count > 5:
            raise Boom("at call 6")
        return [x[0] ** 2, (x[0] - 1) ** 2]

    def bad(*_: object) -> None:
        raise Boom("elsewhere")

    box = {"start": [0.3], "lower": -1.0, "upper": 1.0}
    with pytest.raises(Boom):
        if verb == "pareto":
            optimize.pareto(f, **box)
        elif verb == "starts":
            optimize.minimax(f, **box, starts=5)
        elif verb == "progress":
            optimize.minimax(f, **box, progress=bad)
        elif verb == "gradients":
            optimize.minimax(f, **box, gradients=bad)
        else:
            optimize.minimax(f, **box)
    assert count < 50  # nothing is called after a failure


@pytest.mark.parametrize("starts", [1, 3])
def test_ctrl_c_ends_a_long_solve(starts: int) -> None:
    def slow(x: np.ndarray) -> list[float]:
        time.sleep(0.02)
        return [float(np.sin(50 * x[0]) + x[0] ** 2)]

    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.3, lambda: signal.pthread_kill(main, signal.SIGINT))
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        optimize.minimax(slow, start=[0.3], lower=-5.0, upper=5.0, starts=starts)
        time.sleep(10.0)
    assert time.monotonic() - began < 5.0
    timer.join()


def test_progress_may_stop_a_solve() -> None:
    seen: list[int] = []

    def stop(iteration: int, x: list[float], utility: float, violation: float) -> bool:
        seen.append(iteration)
        return iteration < 2

    found = optimize.minimax(lambda x: [x[0] ** 4, (x[0] - 3) ** 2], start=[10.0], progress=stop)
    assert found.status == "stopped" and seen[-1] == 2


def test_no_answer_is_a_status() -> None:
    impossible = optimize.minimax(
        lambda x: [x[0]], start=[0.5], lower=-2.0, upper=2.0, inequalities=lambda x: [x[0] ** 2 + 1.0]
    )
    assert impossible.status == "no_feasible_point" and not impossible.is_solved
    assert impossible.violations[0][0] == "c1"
    nan = optimize.minimax(lambda x: [np.nan], start=[0.0])
    assert nan.status == "not_finite" and not nan.is_solved


@pytest.mark.parametrize(
    ("change", "kind", "field"),
    [
        ({"start": [np.nan]}, InputError, "start"),
        ({"start": [[0.0]]}, InputError, "start"),
        ({"start": "zero"}, InputTypeError, "start"),
        ({"lower": 2.0, "upper": 1.0}, InputError, "x1"),
        ({"lower": [0.0, 0.0]}, InputError, "lower"),
        ({"starts": 0}, InputError, "starts"),
        ({"starts": 2.5}, InputTypeError, "starts"),
        ({"starts": 3}, InputError, "x1"),
        ({"inequalities": 3}, InputTypeError, "inequalities"),
        ({"names": ["a", "b"]}, InputError, "names"),
        ({"linear": [optimize.Linear([1.0, 1.0], 0.0)]}, InputError, "linear"),
        ({"settings": optimize.Settings(optimality_tolerance=7.0)}, InputError, "optimality_tolerance"),
        ({"settings": optimize.Settings(max_iterations=-1)}, InputError, "max_iterations"),
    ],
)
def test_bad_problems_are_refused(change: dict[str, object], kind: type[Exception], field: str) -> None:
    keys = {"start": [0.5], **change}
    with pytest.raises(kind) as caught:
        optimize.minimax(lambda x: [x[0] ** 2], **keys)  # type: ignore[arg-type]
    assert caught.value.field == field  # type: ignore[attr-defined]


def test_functions_that_change_their_length_or_type() -> None:
    lengths = iter([1, 1, 2, 2, 2, 2])
    with pytest.raises(InputError, match="2 values"):
        optimize.minimax(lambda x: [x[0] ** 2] * next(lengths), start=[0.5])
    with pytest.raises(InputTypeError):
        optimize.minimax(lambda x: "five", start=[0.5])
    with pytest.raises(InputError) as caught:
        optimize.minimax(lambda x: [x[0]], start=[0.5], gradients=lambda x: [[1.0, 2.0]])
    assert caught.value.field == "gradients"


def test_a_problem_file_is_solved() -> None:
    found = optimize.solve_file(EXAMPLES / "dry-sand-wheel.toml")
    assert isinstance(found, optimize.Solution) and found.is_solved
    assert len(found.names) == len(found.x)
    with pytest.raises(InputError):
        optimize.solve_text("format = 1\nmethod = \"minimax\"\n")
    with pytest.raises(FileNotFoundError):
        optimize.solve_file("/no/such/problem.toml")
