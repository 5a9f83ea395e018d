"""Recorded logs (MCAP, ROS 1 bags, tables) and live streams through the slip estimator.

Examples
--------
>>> from grouser import logs
>>> robot = logs.Robot.read("examples/five-wheel/robot.toml")
>>> result = logs.estimate("examples/five-wheel/log.csv", robot, columns="examples/five-wheel/columns.toml")
>>> len(result.rows.slip)
10005
>>> result.summary["wheels"][0]["slip"]["p95"] > 0.33
True
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import check_kind, flag, number, path_of
from ._core import Robot
from ._errors import InputError
from ._frames import is_frame, write_csv
from ._declared import Sample
from ._tables import Table

__all__ = ["Engine", "Result", "Robot", "Rows", "Sample", "Samples", "estimate", "read"]

Paths = Union[str, "os.PathLike[str]", Iterable[Union[str, "os.PathLike[str]"]]]
AnyRobot = Union[Robot, str, "os.PathLike[str]"]


class Rows(Table):
    """A row for every wheel whenever it was read, as columns."""

    time_s: npt.NDArray[np.float64]
    """Seconds from the log's start."""
    wheel: npt.NDArray[np.uint32]
    """The wheel's index in the robot's order."""
    slip: npt.NDArray[np.float64]
    """NaN where there is none."""
    slip_sigma: npt.NDArray[np.float64]
    """Standard deviation of the slip's error."""
    side_slip_angle_deg: npt.NDArray[np.float64]
    """From the wheel's heading to the way of its centre, to the left."""
    motion: list[str]
    health: list[str]
    """How far the slip can be trusted, with the reason."""


class Result(NamedTuple):
    """A log's rows and its summary."""

    rows: Rows
    summary: dict[str, Any]
    """Status, reference, the wheels' slips, ways, and `doubts`: empty where all checks passed."""


class Samples(NamedTuple):
    """The samples of a log in the order of time, as columns."""

    time_ns: npt.NDArray[np.int64]
    kind: npt.NDArray[np.uint8]
    """An index in `kinds`."""
    wheel: npt.NDArray[np.int64]
    """An index in `wheels`; -1 for a sensor of the robot."""
    numbers: npt.NDArray[np.float64]
    """Shape (n, 6): the numbers of each sample, then NaN."""
    kinds: list[str]
    wheels: list[str]
    """The log's wheels."""
    notes: list[str]
    """What is worth knowing of the log."""

    def of_kind(self, kind: str) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.float64]]:
        """Times (ns), wheels and numbers of one kind of sample."""
        if kind not in self.kinds:
            raise InputError(f"kind is `{kind}`, but must be one of {', '.join(self.kinds)}", "kind", kind)
        here = self.kind == self.kinds.index(kind)
        return self.time_ns[here], self.wheel[here], self.numbers[here]


def _paths(paths: Paths) -> list[str]:
    if isinstance(paths, (str, os.PathLike)):
        return [os.fspath(paths)]
    check_kind("paths", paths, Iterable, "a path or several")
    found = [path_of("paths", each) for each in paths]
    if not found:
        raise InputError("paths is empty, but one path is needed at least", "paths", 0, (1, np.inf), "1")
    return found


@contextmanager
def _files(log: Any) -> Iterator[list[str]]:
    """The files of a log; of a frame a table `log.csv`, which lasts as long as the context."""
    if is_frame(log):
        import tempfile  # not with the package: importing it stays fast

        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "log.csv"
            write_csv(log, table)
            yield [str(table)]
    else:
        yield _paths(log)


def _robot(robot: AnyRobot) -> Robot:
    if isinstance(robot, (str, os.PathLike)):
        return Robot.read(robot)
    check_kind("robot", robot, Robot, "a robot or the path of a robot file")
    return robot


def _map_path(columns: str | os.PathLike[str] | None) -> str | None:
    return None if columns is None else path_of("columns", columns)


def _choices(
    reference: str | None,
    wheel_sensor: str | None,
    from_s: float | None,
    to_s: float | None,
    offline: bool,
) -> dict[str, Any]:
    words = {"reference": reference, "wheel_sensor": wheel_sensor}
    for field, word in words.items():
        check_kind(field, word, (str, type(None)), "text")
    numbers = {"from_s": from_s, "to_s": to_s}
    given = {field: None if value is None else number(field, value) for field, value in numbers.items()}
    return {**words, **given, "offline": offline}


def estimate(
    paths: Any,
    robot: AnyRobot,
    *,
    columns: str | os.PathLike[str] | None = None,
    reference: str | None = None,
    wheel_sensor: str | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    online: bool = False,
) -> Result:
    """The slip of every wheel over a log.

    Parameters
    ----------
    paths : path, paths, or frame
        Files of one log, or folders of them; a data frame, or a mapping of columns, counts as the table `log.csv`.
    robot : Robot or path
    columns : path, optional
        The column map of tables; by default the robot file's own, or `columns.toml` beside it.
    reference : str, optional
        `displacement`, `pose`, `speed`, `free-wheel` or `grip`; the best in the log by default.
    wheel_sensor : str, optional
        `count`, `angle` or `rate`.
    from_s, to_s : float, optional
        The span of the log, s from its start.
    online : bool
        Slips as the robot would have known them at their time; otherwise each slip uses the whole log.

    Returns
    -------
    Result
        Read `summary["doubts"]`: a doubtful result is not an exception.

    Raises
    ------
    OSError
        A file cannot be read.
    InputError
        A file that is damaged or does not fit the robot; a choice that does not exist.
    """
    choices = _choices(reference, wheel_sensor, from_s, to_s, not flag("online", online))
    with _files(paths) as files:
        rows, summary = _core.estimate(files, _robot(robot), _map_path(columns), choices)
    return Result(Rows(**rows), summary)


def read(paths: Any, robot: AnyRobot, *, columns: str | os.PathLike[str] | None = None) -> Samples:
    """The samples of a log in the order of time, on their own clocks.

    Examples
    --------
    >>> from grouser import logs
    >>> robot = logs.Robot.read("examples/five-wheel/robot.toml")
    >>> samples = logs.read("examples/five-wheel/log.csv", robot, columns="examples/five-wheel/columns.toml")
    >>> time_ns, _, numbers = samples.of_kind("yaw-rate")
    >>> bool(abs(numbers[:, 0].sum() * 0.02 - 0.94) < 0.01)  # 0.15 rad/s for 6 s, and the gyro's bias
    True
    """
    with _files(paths) as files:
        found = _core.read_samples(files, _robot(robot), _map_path(columns))
    found["numbers"] = found["numbers"].reshape(-1, 6)
    return Samples(**found)


class Engine:
    """Samples of a live source through the estimator, in the order of time.

    Parameters
    ----------
    robot : Robot
    reference : str
        What measures how fast the robot travels: `displacement`, `pose`, `speed`, `free-wheel` or `grip`.
    wheel_sensor : str
        `count`, `angle` or `rate`.

    Examples
    --------
    >>> from grouser import logs
    >>> robot = logs.Robot.read("examples/five-wheel/robot.toml")
    >>> engine = logs.Engine(robot, reference="free-wheel", wheel_sensor="count")
    >>> for k in range(100):
    ...     for wheel in range(5):
    ...         engine.push(logs.Sample.wheel_count(time_ns=k * 20_000_000, wheel=wheel, count=40 * k))
    >>> summary = engine.finish()
    >>> len(engine.rows().slip)
    500
    """

    def __init__(self, robot: Robot, *, reference: str, wheel_sensor: str = "count") -> None:
        choices = _choices(None, None, None, None, False)
        self._core = _core.Engine(robot, reference, wheel_sensor, choices)

    def push(self, sample: Sample) -> None:
        """Takes a sample, not earlier than those before; its wheel is an index in the robot's order."""
        self._core.push(sample)

    def rows(self) -> Rows:
        """The rows since the last call."""
        return Rows(**self._core._rows())

    def finish(self) -> dict[str, Any]:
        """Ends the run: the summary. The last rows are in `rows`."""
        return self._core._finish()

    def run(self, samples: Iterable[Sample]) -> Iterator[Rows]:
        """Pushes samples; yields their rows as they come."""
        for sample in samples:
            self.push(sample)
            rows = self.rows()
            if len(rows.slip):
                yield rows
