"""Simulated drives on soft ground, by our controller or by one written in Python.

A controller is a function of an `Observation` that returns one `WheelCommand` a wheel; it is called every
hundredth of a second with what the robot's own estimator knows, never with the truth.

Examples
--------
>>> from grouser import drive
>>> scenario = drive.read("examples/scenarios/sandbox.toml")
>>> def steady(seen):
...     return [drive.WheelCommand(seen.requested_speed_mps) for _ in seen.wheels]
>>> result = drive.run(scenario, controller=steady, duration_s=2.0)
>>> result.track["time_s"][-1].round(2)
np.float64(2.0)
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Union


from . import _core
from ._arrays import check_kind, number, whole
from ._core import Scenario
from ._errors import InputError, InputTypeError
from ._tables import Table
from .slip import WheelCommand, WheelObservation

__all__ = [
    "PERIOD_S",
    "Controller",
    "DriveResult",
    "Observation",
    "Scenario",
    "Simulation",
    "WheelCommand",
    "WheelObservation",
    "read",
    "run",
]

PERIOD_S = 0.01
"""The period of the control loop, s."""

read = Scenario.read

AnyScenario = Union[Scenario, str, "os.PathLike[str]"]


class Observation(NamedTuple):
    """What the robot's computer knows at one moment, and what is requested of it."""

    time_s: float
    wheels: list[WheelObservation]
    speed_mps: float | None
    """Forward speed by the estimator."""
    heading_rad: float
    pitch_rad: float
    """Nose down positive."""
    roll_rad: float
    """Right side down positive."""
    requested_speed_mps: float
    requested_heading_rad: float


Controller = Callable[[Observation], Sequence[Any]]


@dataclass(frozen=True)
class DriveResult:
    """What came of a drive."""

    outcome: str
    """`arrived`, `immobilised`, `tipped`, `sensors-lost`, `no-way`, `off-map` or `time-out`."""
    duration_s: float
    distance_m: float
    """Progress along the legs."""
    way_m: float
    """Length of the way."""
    energy_j: float
    energy_j_per_m: float | None
    worst_slip: float
    """The greatest true slip that lasted a second, weighted by load."""
    deep_share: float
    """The greatest share of the time that a loaded wheel was sunk by more than a sixth of its diameter."""
    undeclared_no_data: str | None
    """What of the ground's file was read as unknown, although the file does not declare it."""
    slip_rmse: float | None
    """Estimated against true slip."""
    slip_bias: float | None
    refused: int
    """Samples that the estimator refused."""
    end_m: tuple[float, float]
    decisions: list[tuple[float, str]]
    """Time (s) and text of the on-board controller's decisions."""
    decision_count: int
    track: Table
    """Columns over time, every 0.01 s; `slip` and `estimated_slip` have one column a wheel."""


class Simulation:
    """A drive under way, period by period.

    Parameters
    ----------
    scenario : Scenario or path
    pilot : str
        `controller`, `open-loop` or `fixed-chassis`. With commands of your own choose `open-loop`: its computer
        estimates and takes no decisions.
    seed : int, optional
        Of ground and noise; the scenario's by default.
    """

    def __init__(self, scenario: AnyScenario, *, pilot: str = "controller", seed: int | None = None) -> None:
        if isinstance(scenario, (str, os.PathLike)):
            scenario = Scenario.read(scenario)
        check_kind("scenario", scenario, Scenario, "a scenario or the path of its file")
        self._core = _core.Simulation(scenario, pilot, scenario.seed if seed is None else whole("seed", seed, 0, 2**64 - 1))

    def advance(self, *, duration_s: float = PERIOD_S) -> bool:
        """Runs for a time (whole periods, one at least); returns whether the drive goes on."""
        return self._core.run_periods(_periods("duration_s", duration_s))

    def command(self, commands: Sequence[Any]) -> None:
        """Sets one command a wheel for the next period: `WheelCommand`, or such a tuple.

        Raises
        ------
        InputError
            Not one a wheel; a number that is NaN or absurd.
        """
        self._core.set_commands([_command(command) for command in commands])

    def observation(self) -> Observation:
        """What the robot's computer knows now."""
        found = self._core._observation()
        wheels = [WheelObservation(**wheel) for wheel in found.pop("wheels")]
        return Observation(wheels=wheels, **found)

    def result(self) -> DriveResult:
        """What came of the drive so far."""
        track = self._core._track()
        wheels = track.pop("wheels")
        for key in ("slip", "estimated_slip"):
            track[key] = track[key].reshape(-1, wheels)
        return DriveResult(track=Table(**track), **self._core._result())


def _periods(field: str, duration_s: Any) -> int:
    found = number(field, duration_s)
    if not 0.0 < found <= 1e6:
        raise InputError(f"{field} is {duration_s}, but must lie in (0, 1e6] s", field, duration_s, (0.0, 1e6), "s")
    return max(1, round(found / PERIOD_S))


def _command(command: Any) -> tuple[float, float, float]:
    try:
        given = WheelCommand(*command)
    except TypeError:
        raise InputTypeError(
            f"a command is {command!r}, but must be a WheelCommand (rim_speed_mps, traction, steering_angle_rad)",
            "command",
            command,
        ) from None
    speed, traction, angle = (number(*pair) for pair in given._asdict().items())
    return speed, traction, angle


def run(
    scenario: AnyScenario,
    *,
    pilot: str = "controller",
    controller: Controller | None = None,
    seed: int | None = None,
    duration_s: float | None = None,
) -> DriveResult:
    """A whole drive.

    Parameters
    ----------
    scenario : Scenario or path
    pilot : str
        `controller` (ours) or `open-loop`; without effect where a controller is given.
    controller : callable, optional
        A function of an `Observation` to one `WheelCommand` a wheel. Its exceptions pass through.
    seed : int, optional
        Of ground and noise: the same seed is the same drive, whoever controls it.
    duration_s : float, optional
        Ends earlier than the scenario says.

    Examples
    --------
    >>> from grouser import drive
    >>> scenario = drive.read("examples/scenarios/sandbox.toml")
    >>> drive.run(scenario, pilot="open-loop", duration_s=1.5).outcome
    'time-out'
    """
    longest = None if duration_s is None else _periods("duration_s", duration_s)
    if controller is None:
        simulation = Simulation(scenario, pilot=pilot, seed=seed)
        simulation._core.run_periods(2**31 if longest is None else longest)
        return simulation.result()
    if not callable(controller):
        raise InputTypeError(
            f"controller is {type(controller).__name__}, but must be callable", "controller", controller
        )
    simulation = Simulation(scenario, pilot="open-loop", seed=seed)
    done = 0
    while (longest is None or done < longest) and simulation._core.run_periods(1):
        simulation.command(controller(simulation.observation()))
        done += 1
    return simulation.result()
