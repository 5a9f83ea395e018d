"""Several objectives at once: minimax, goal attainment, weighted sums, Pareto fronts, robust problems.

Functions are Python callables of a point (a float64 array), or formulas in a problem file. Exceptions of
a callable end the solve and pass through; Ctrl-C interrupts it. Derivatives are finite differences that
never leave the bounds, or your own `gradients`.

A solve that finds no answer is a status, not an exception: read `Solution.is_solved`.

Examples
--------
>>> import numpy as np
>>> from grouser import optimize
>>> def cb2(x):  # Charalambous & Conn 1978: the optimum is 1.9522245
...     return [x[0]**2 + x[1]**4, (2 - x[0])**2 + (2 - x[1])**2, 2 * np.exp(x[1] - x[0])]
>>> solution = optimize.minimax(cb2, start=[2.0, 2.0])
>>> solution.is_solved, round(solution.maximum, 6)
(True, 1.952224)
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence, Sized
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import FloatArray, as_floats, check_kind, flag, number, path_of, threads_of, whole
from ._errors import InputError, InputTypeError

__all__ = [
    "Counts",
    "Front",
    "Linear",
    "Optimum",
    "Settings",
    "Solution",
    "attain",
    "chebyshev",
    "minimax",
    "pareto",
    "robust",
    "solve_file",
    "solve_text",
    "weighted",
]

Functions = Callable[..., Any]


@dataclass(frozen=True)
class Settings:
    """Tolerances and limits of one solve."""

    optimality_tolerance: float = 1e-8
    constraint_tolerance: float = 1e-8
    step_tolerance: float = 1e-14
    max_iterations: int = 1000
    max_values: int = 10_000
    probes: int = 64
    """Pairs of random probes around a point before it is called a solution."""


@dataclass(frozen=True)
class Linear:
    """A linear constraint: coefficients @ x <= bound, or == where `equal`. No iterate leaves it."""

    coefficients: Sequence[float]
    bound: float
    equal: bool = False
    name: str | None = None


@dataclass(frozen=True)
class Counts:
    """What a solve cost."""

    iterations: int
    values: int
    """Points at which the functions were evaluated."""
    jacobians: int
    """Points at which derivatives were evaluated."""
    probes: int
    """Points that confirmed a solution."""


@dataclass(frozen=True)
class Optimum:
    """A local optimum among several starts."""

    x: FloatArray
    utility: float
    starts: int
    """How many starts led here."""


@dataclass(frozen=True)
class Solution:
    """Where a solve ended, and what holds the point there."""

    status: str
    """`converged`, `small_step`, `stalled`, `limit`, `no_feasible_point`, `not_finite`, ..."""
    is_solved: bool
    """Is the point a solution?"""
    x: FloatArray
    objectives: FloatArray
    """Every objective at `x`, signed; in robust problems per world where they count separately."""
    maximum: float
    """The greatest objective."""
    utility: float
    """What was minimised."""
    inequalities: FloatArray
    equalities: FloatArray
    multipliers: dict[str, Any]
    """The price of each objective, constraint and bound."""
    active: list[str]
    """The names of what holds the point."""
    stationarity: float
    violation: float
    violations: list[tuple[str, float]]
    """The constraints that no point was found to meet, and by how much."""
    counts: Counts
    optima: list[Optimum] = field(default_factory=list)
    """The different local optima of several starts, best first."""
    is_ambiguous: bool = False
    """Are there different points equally good?"""
    names: tuple[str, ...] = ()
    """The names of the variables."""


@dataclass(frozen=True)
class Front:
    """Compromises none of which beats another, ordered by the first objective."""

    x: FloatArray
    """One point a row."""
    objectives: FloatArray
    """One point a row."""
    multipliers: list[FloatArray | None]
    """The local trade-off, where the polishing solve converged."""
    knee: int | None
    """The row at which the front bends most."""
    violation: float
    """The least violation seen; above 0 nothing feasible was found."""
    counts: Counts
    names: tuple[str, ...] = ()
    """The names of the variables."""

    @property
    def status(self) -> str:
        """`converged`, or `no_feasible_point` where the front is empty."""
        return "converged" if len(self.x) else "no_feasible_point"


def _vector(name: str, value: Any) -> FloatArray:
    array = as_floats(name, value)
    if array.ndim != 1:
        raise InputError(f"{name} has the shape {array.shape}, but must be a list of numbers", name)
    return np.ascontiguousarray(array)


def _bounds(name: str, value: Any, count: int, default: float) -> FloatArray:
    if value is None:
        return np.full(count, default)
    array = as_floats(name, value)
    if array.ndim == 0:
        return np.full(count, float(array))
    return _sized(name, array, count)


def _sized(name: str, value: Any, count: int) -> FloatArray:
    array = _vector(name, value)
    if array.size != count:
        raise InputError(
            f"{name} has {array.size} entries, but {count} are needed", name, array.size, count, "1"
        )
    return array


def _callable(name: str, function: Any) -> None:
    if function is not None and not callable(function):
        raise InputTypeError(f"{name} is {type(function).__name__}, but must be callable", name)


def _names(name: str, given: Sequence[str] | None, prefix: str, count: int) -> list[str]:
    if given is None:
        return [f"{prefix}{k + 1}" for k in range(count)]
    names = [str(word) for word in given]
    if len(names) != count:
        raise InputError(f"{name} has {len(names)} names, but {count} are needed", name, len(names), count, "1")
    return names


class _Problem:
    """The callables of a problem as one, with the number of functions counted at the start."""

    def __init__(
        self,
        objectives: Functions,
        start: Any,
        lower: Any,
        upper: Any,
        inequalities: Functions | None,
        equalities: Functions | None,
        gradients: Functions | None,
        linear: Sequence[Linear],
        absolute: int = 0,
        names: Sequence[str] | None = None,
        objective_names: Sequence[str] | None = None,
        worlds: Sequence[Any] = (),
    ) -> None:
        for name, function in (
            ("objectives", objectives),
            ("inequalities", inequalities),
            ("equalities", equalities),
            ("gradients", gradients),
        ):
            _callable(name, function)
        if objectives is None:
            raise InputTypeError("objectives is missing, but must be callable", "objectives")
        self.parts = [("objectives", objectives), ("inequalities", inequalities), ("equalities", equalities)]
        self.given_gradients = gradients
        self.worlds = list(worlds)
        self.start = _vector("start", start)
        count = self.start.size
        self.lower = _bounds("lower", lower, count, -np.inf)
        self.upper = _bounds("upper", upper, count, np.inf)
        self.linear = list(linear)
        self.absolute = absolute
        self.names = _names("names", names, "x", count)
        first = np.clip(self.start, self.lower, self.upper)
        arguments = (first, self.worlds[0]) if self.worlds else (first,)
        self.sizes = [
            0 if function is None else self._call(name, function, *arguments).size
            for name, function in self.parts
        ]
        self.objective_names = _names("objective_names", objective_names, "f", self.sizes[0])

    @staticmethod
    def _call(name: str, function: Functions, *arguments: Any) -> FloatArray:
        return np.atleast_1d(as_floats(name, function(*arguments))).reshape(-1)

    def functions(self, x: FloatArray, world: int | None = None) -> FloatArray:
        arguments = (x,) if world is None else (x, self.worlds[world])
        found = [
            self._call(name, function, *arguments) for name, function in self.parts if function is not None
        ]
        return np.ascontiguousarray(np.concatenate(found))

    def gradients(self, x: FloatArray, world: int | None = None) -> FloatArray:
        arguments = (x,) if world is None else (x, self.worlds[world])
        assert self.given_gradients is not None
        return np.ascontiguousarray(np.atleast_2d(as_floats("gradients", self.given_gradients(*arguments))))

    def as_parts(
        self,
        settings: Settings,
        method: tuple[str, list[float], list[float]] = ("minimax", [], []),
        measure: tuple[str, float] = ("worst-case", 0.0),
        world_names: Sequence[str] = (),
    ) -> dict[str, Any]:
        check_kind("settings", settings, Settings)
        for row in self.linear:
            check_kind("linear", row, Linear)
        check_kind("measure", measure[0], str, "text")
        _, inequalities, equalities = self.sizes
        count = self.start.size
        return {
            "functions": self.functions,
            "gradients": None if self.given_gradients is None else self.gradients,
            "variables": list(
                zip(self.names, self.start.tolist(), self.lower.tolist(), self.upper.tolist())
            ),
            "objectives": self.objective_names,
            "inequalities": [f"c{k + 1}" for k in range(inequalities)],
            "equalities": [f"h{k + 1}" for k in range(equalities)],
            "linear": [
                (
                    row.name or f"linear{k + 1}",
                    _sized("linear", row.coefficients, count).tolist(),
                    flag("equal", row.equal),
                    number("bound", row.bound),
                )
                for k, row in enumerate(self.linear)
            ],
            "absolute": whole("absolute", self.absolute),
            "worlds": list(world_names),
            "measure": measure,
            "method": method,
            "tolerances": (
                number("optimality_tolerance", settings.optimality_tolerance),
                number("constraint_tolerance", settings.constraint_tolerance),
                number("step_tolerance", settings.step_tolerance),
            ),
            "limits": (
                whole("max_iterations", settings.max_iterations),
                whole("max_values", settings.max_values),
                whole("probes", settings.probes),
            ),
        }


def _solution(found: dict[str, Any], names: Sequence[str]) -> Solution:
    found = dict(found)
    for key in ("x", "objectives", "inequalities", "equalities"):
        found[key] = np.asarray(found[key], dtype=np.float64)
    found["counts"] = Counts(**found["counts"])
    found["optima"] = [Optimum(np.asarray(x), utility, starts) for x, utility, starts in found["optima"]]
    return Solution(**found, names=tuple(names))


def _solve(
    problem: _Problem,
    parts: dict[str, Any],
    starts: int,
    seed: int,
    progress: Callable[..., Any] | None,
) -> Solution:
    starts, seed = whole("starts", starts, 1), whole("seed", seed)
    _callable("progress", progress)
    if starts == 1:
        return _solution(_core.solve(parts, progress), problem.names)
    # Python runs one callable at a time: more threads would wait for each other
    return _solution(_core.solve_many(parts, starts, seed, 1), problem.names)


def minimax(
    objectives: Functions,
    *,
    start: npt.ArrayLike,
    lower: npt.ArrayLike | None = None,
    upper: npt.ArrayLike | None = None,
    inequalities: Functions | None = None,
    equalities: Functions | None = None,
    gradients: Functions | None = None,
    linear: Sequence[Linear] = (),
    absolute: int = 0,
    names: Sequence[str] | None = None,
    objective_names: Sequence[str] | None = None,
    starts: int = 1,
    seed: int = 1,
    settings: Settings = Settings(),
    progress: Callable[..., Any] | None = None,
) -> Solution:
    """Minimises the greatest of several objectives.

    Parameters
    ----------
    objectives : callable
        Of a point, shape (n,), to m numbers.
    start : array_like, shape (n,)
    lower, upper : array_like, optional
        Bounds, one for all variables or one each; finite where there are several starts.
    inequalities, equalities : callable, optional
        c(x) <= 0 and h(x) = 0, of a point to numbers.
    gradients : callable, optional
        Of a point to the gradients of objectives, inequalities and equalities, one a row; otherwise finite
        differences.
    linear : sequence of Linear
        Linear constraints, which no iterate leaves.
    absolute : int
        So many of the first objectives count with their absolute value.
    starts, seed : int
        The problem's own start and points of a Sobol sequence.
    progress : callable, optional
        Called with iteration, point, utility and violation; returning False ends the solve. With one start
        only.

    Raises
    ------
    InputError, InputTypeError
        Bounds that contradict each other, lists of the wrong length, what is not callable.

    Examples
    --------
    >>> from grouser import optimize
    >>> s = optimize.minimax(lambda x: [x[0] - 3.0, 1.0 - x[0]], start=[0.0], lower=0.0, upper=10.0, starts=4)
    >>> s.x.round(6), round(s.maximum, 6)
    (array([2.]), -1.0)
    """
    problem = _Problem(
        objectives, start, lower, upper, inequalities, equalities, gradients, linear, absolute, names, objective_names
    )
    return _solve(problem, problem.as_parts(settings), starts, seed, progress)


def attain(
    objectives: Functions,
    *,
    goals: npt.ArrayLike,
    weights: npt.ArrayLike,
    start: npt.ArrayLike,
    lower: npt.ArrayLike | None = None,
    upper: npt.ArrayLike | None = None,
    inequalities: Functions | None = None,
    equalities: Functions | None = None,
    gradients: Functions | None = None,
    linear: Sequence[Linear] = (),
    starts: int = 1,
    seed: int = 1,
    settings: Settings = Settings(),
) -> Solution:
    """Minimises g subject to f_i(x) - weights_i g <= goals_i; a weight of 0 makes the goal a hard limit.

    Parameters as in `minimax`.
    """
    problem = _Problem(objectives, start, lower, upper, inequalities, equalities, gradients, linear)
    method = ("attain", _vector("goals", goals).tolist(), _vector("weights", weights).tolist())
    return _solve(problem, problem.as_parts(settings, method), starts, seed, None)


def weighted(
    objectives: Functions,
    *,
    weights: npt.ArrayLike,
    start: npt.ArrayLike,
    lower: npt.ArrayLike | None = None,
    upper: npt.ArrayLike | None = None,
    inequalities: Functions | None = None,
    equalities: Functions | None = None,
    gradients: Functions | None = None,
    linear: Sequence[Linear] = (),
    starts: int = 1,
    seed: int = 1,
    settings: Settings = Settings(),
) -> Solution:
    """Minimises the weighted sum of the objectives; one objective with the weight 1 is a plain problem.

    Parameters as in `minimax`.
    """
    problem = _Problem(objectives, start, lower, upper, inequalities, equalities, gradients, linear)
    method: tuple[str, list[float], list[float]] = ("weighted", [], _vector("weights", weights).tolist())
    return _solve(problem, problem.as_parts(settings, method), starts, seed, None)


def chebyshev(
    objectives: Functions,
    *,
    ideal: npt.ArrayLike,
    weights: npt.ArrayLike,
    start: npt.ArrayLike,
    lower: npt.ArrayLike | None = None,
    upper: npt.ArrayLike | None = None,
    inequalities: Functions | None = None,
    equalities: Functions | None = None,
    gradients: Functions | None = None,
    linear: Sequence[Linear] = (),
    starts: int = 1,
    seed: int = 1,
    settings: Settings = Settings(),
) -> Solution:
    """Minimises the greatest weights_i (f_i(x) - ideal_i).

    Parameters as in `minimax`.
    """
    problem = _Problem(objectives, start, lower, upper, inequalities, equalities, gradients, linear)
    method = ("chebyshev", _vector("ideal", ideal).tolist(), _vector("weights", weights).tolist())
    return _solve(problem, problem.as_parts(settings, method), starts, seed, None)


def _front(found: dict[str, Any], names: Sequence[str]) -> Front:
    multipliers = [None if row is None else np.asarray(row) for row in found["multipliers"]]
    return Front(
        # an empty front has its columns, too
        x=np.asarray(found["x"], dtype=np.float64).reshape(-1, len(names)),
        objectives=np.asarray(found["objectives"], dtype=np.float64).reshape(-1, found["objective_count"]),
        multipliers=multipliers,
        knee=found["knee"],
        violation=found["violation"],
        counts=Counts(**found["counts"]),
        names=tuple(names),
    )


def pareto(
    objectives: Functions,
    *,
    start: npt.ArrayLike,
    lower: npt.ArrayLike,
    upper: npt.ArrayLike,
    inequalities: Functions | None = None,
    equalities: Functions | None = None,
    gradients: Functions | None = None,
    linear: Sequence[Linear] = (),
    population: int = 100,
    generations: int = 250,
    polish: bool = True,
    seed: int = 1,
    settings: Settings = Settings(),
) -> Front:
    """The Pareto front of two or more objectives, each point polished by a goal-attainment solve.

    Parameters as in `minimax`; every variable needs finite bounds. NSGA-II for two objectives, NSGA-III for
    more.

    Examples
    --------
    >>> from grouser import optimize
    >>> front = optimize.pareto(lambda x: [x[0]**2, (x[0] - 2.0)**2], start=[1.0], lower=-4.0, upper=4.0,
    ...                         population=20, generations=20)
    >>> bool((front.x >= -1e-6).all() and (front.x <= 2.0 + 1e-6).all())
    True
    """
    problem = _Problem(objectives, start, lower, upper, inequalities, equalities, gradients, linear)
    found = _core.solve_front(
        problem.as_parts(settings),
        whole("population", population),
        whole("generations", generations),
        flag("polish", polish),
        whole("seed", seed),
        1,
    )
    return _front(found, problem.names)


def robust(
    objectives: Functions,
    *,
    worlds: Sequence[Any],
    start: npt.ArrayLike,
    measure: str = "worst-case",
    parameter: float = 0.0,
    lower: npt.ArrayLike | None = None,
    upper: npt.ArrayLike | None = None,
    inequalities: Functions | None = None,
    equalities: Functions | None = None,
    gradients: Functions | None = None,
    linear: Sequence[Linear] = (),
    world_names: Sequence[str] | None = None,
    starts: int = 1,
    seed: int = 1,
    settings: Settings = Settings(),
) -> Solution:
    """Minimises the greatest objective over many possible worlds; constraints must hold in each.

    Parameters
    ----------
    objectives : callable
        Of a point and a world to m numbers; the constraints and gradients take a world, too.
    worlds : sequence
        The worlds: soils, loads, anything.
    measure : str
        `worst-case`; `mean-plus-deviations` (mean + parameter times the deviation over the worlds);
        `cvar` (mean over the worst share 1 - parameter of the worlds). Problem files write them with `_`, which is
        accepted here, too.
    parameter : float
        Of the measure.

    Examples
    --------
    >>> from grouser import optimize
    >>> s = optimize.robust(lambda x, a: [(x[0] - a)**2], worlds=[0.0, 1.0, 4.0], start=[0.5])
    >>> s.x.round(6)
    array([2.])
    """
    check_kind("worlds", worlds, Sized, "a list")
    if len(worlds) == 0:
        raise InputError("worlds is empty, but one is needed at least", "worlds", 0, 1, "1")
    problem = _Problem(
        objectives, start, lower, upper, inequalities, equalities, gradients, linear, worlds=worlds
    )
    names = _names("world_names", world_names, "world ", len(worlds))
    parts = problem.as_parts(settings, measure=(measure, number("parameter", parameter)), world_names=names)
    return _solve(problem, parts, starts, seed, None)


def _answer(found: dict[str, Any]) -> Solution | Front:
    names = found.pop("variables")
    if "status" not in found:
        return _front(found, names)
    for key in ("objective_multipliers", "constraint_multipliers"):
        found[key] = dict(found[key])
    bounds = found.pop("bound_multipliers")
    multipliers = {
        "objectives": found.pop("objective_multipliers"),
        "constraints": found.pop("constraint_multipliers"),
        "lower": [pair[0] for pair in bounds],
        "upper": [pair[1] for pair in bounds],
        "attainment": found.pop("attainment"),
    }
    found["objectives"] = [value for _, value in found["objectives"]]
    return _solution({**found, "multipliers": multipliers, "inequalities": [], "equalities": []}, names)


def solve_file(path: str | os.PathLike[str], *, threads: int | None = None) -> Solution | Front:
    """Solves a problem file (TOML): formulas over what a wheel on soil does, with exact derivatives.

    The same numbers as the command `grouser optimize`.
    """
    return _answer(_core.solve_file(path_of("path", path), None, threads_of(threads)))


def solve_text(text: str, *, threads: int | None = None) -> Solution | Front:
    """Solves the text of a problem file, as `solve_file`."""
    check_kind("text", text, str, "text")
    return _answer(_core.solve_file(None, text, threads_of(threads)))
