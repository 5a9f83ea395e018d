"""On the robot: the slip filter and the on-board computer, one sample at a time.

Examples
--------
>>> from grouser.slip import Robot, Sample, SlipFilter
>>> robot = Robot.from_toml('''
... format = 1
... name = "bicycle"
... [[wheel]]
... name = "drive"
... x_m = 0.3
... y_m = 0.0
... radius_m = 0.1
... drive = "powered"
... ticks_per_turn = 1000
... [[wheel]]
... name = "fifth"
... x_m = -0.3
... y_m = 0.0
... radius_m = 0.1
... drive = "free"
... ticks_per_turn = 1000
... ''')
>>> slip_filter = SlipFilter(robot)
>>> for step in range(300):  # the powered wheel turns 10 ticks a step, the free one 8: a slip of 0.2
...     time_ns = step * 10_000_000
...     for wheel, count in ((0, 10 * step), (1, 8 * step)):
...         refused = slip_filter.update(Sample.wheel_count(time_ns=time_ns, wheel=wheel, count=count))
...     refused = slip_filter.update(Sample.yaw_rate(time_ns=time_ns, rate_rad_per_s=0.0))
>>> wheel = slip_filter.latest().wheels[0]
>>> abs(wheel.slip - 0.2) < 2.0 * wheel.slip_sigma
True
"""

from __future__ import annotations

from typing import Any, NamedTuple

from . import _core
from ._core import Robot
from ._declared import Sample

__all__ = [
    "Estimate",
    "Measured",
    "OnBoard",
    "Robot",
    "Sample",
    "SlipFilter",
    "WheelCommand",
    "WheelEstimate",
    "WheelObservation",
]


class Measured(NamedTuple):
    """A value with its standard deviation."""

    value: float
    sigma: float


class WheelEstimate(NamedTuple):
    """What the filter knows of a wheel; None where it knows nothing."""

    slip: float | None
    slip_sigma: float | None
    motion: str | None
    """`Driving`, `Braking`, `Standstill`, `RollBack`, `LiftOff` or `Stall`."""
    health: str
    """`Ok`, `Uninitialised`, `Degraded(...)` or `Invalid(...)` with the reason."""
    forward_speed_mps: float | None
    """Speed of the wheel's centre along its heading."""
    rim_speed_mps: float | None


class Estimate(NamedTuple):
    """What the filter knows of the robot."""

    time_ns: int
    wheels: list[WheelEstimate]
    """In the robot's order."""
    forward_speed_mps: Measured
    left_speed_mps: Measured
    yaw_rate_rad_per_s: Measured
    common_slip: Measured
    """The common slip of the powered wheels."""
    pose: tuple[float, float, float]
    """x (m), y (m) and yaw (rad) from the start, corrected for slip."""
    pose_covariance: list[list[float]]
    distance_m: float
    distance_of_wheels_m: float
    """The distance by the wheels alone, without compensation of slip."""
    reference_age_s: float | None
    """Seconds since a trusted reference last measured the speed."""
    rejected: int
    """Samples that were refused."""
    dropped: int
    """Samples that are missing, by each sensor's usual period."""
    clock_steps: int


class WheelObservation(NamedTuple):
    """What the on-board computer knows of a wheel."""

    slip: float | None
    slip_sigma: float | None
    health: str
    motion: str | None
    forward_speed_mps: float | None
    rim_speed_mps: float | None
    torque_share: float | None
    """Torque over the motor's greatest, signed."""
    firmness: float | None
    """Torque over what the known soil would take: well below 1 on softer ground."""
    load_n: float


class WheelCommand(NamedTuple):
    """What a wheel is commanded."""

    rim_speed_mps: float
    """Speed of the rim, m/s."""
    traction: float = 1.0
    """Greatest torque over load and radius."""
    steering_angle_rad: float = 0.0
    """To the left of the wheel's heading in the robot's description."""


_MEASURED = ("forward_speed_mps", "left_speed_mps", "yaw_rate_rad_per_s", "common_slip")


def _estimate(found: dict[str, Any]) -> Estimate:
    wheels = [WheelEstimate(**wheel) for wheel in found.pop("wheels")]
    measured: dict[str, Any] = {key: Measured(*found.pop(key)) for key in _MEASURED}
    return Estimate(wheels=wheels, **measured, **found)


class SlipFilter:
    """Slip of every wheel from all sensors together, one sample at a time.

    The settings are those of the robot file. The same samples give the same bits.

    Parameters
    ----------
    robot : Robot

    Raises
    ------
    InputError
        Settings outside their limits.
    """

    def __init__(self, robot: Robot) -> None:
        self._core = _core.SlipFilter(robot)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._core.robot

    def update(self, sample: Sample) -> str | None:
        """Uses a sample; returns why it was refused, or None. A refused sample changes nothing."""
        return self._core.update(sample)

    def latest(self) -> Estimate:
        """The estimate after the last sample."""
        return _estimate(self._core._latest())

    def estimate_at(self, *, now_ns: int) -> Estimate:
        """The estimate at a time without a sample: finds sensors that fell silent."""
        return _estimate(self._core._estimate_at(now_ns))

    def set_steering_angle(self, wheel: int, *, angle_rad: float) -> None:
        """A wheel is steered by this angle, to the left, from now on."""
        self._core.set_steering_angle(wheel, angle_rad)


class OnBoard:
    """The object that a robot's computer runs: filter, detector, attitude and slip controller.

    Call `update` with each sample and `tick` at a steady rate of 20 to 200 Hz.

    Parameters
    ----------
    robot : Robot
    heading_rad : float
        The heading at the start, from x towards y.
    **control : float
        Settings of the controller by the keys of a scenario's `[control]` (docs/drive.md has them all); `**scenario.control`
        are those of a scenario.

    Examples
    --------
    >>> from grouser.slip import OnBoard, Robot
    >>> robot = Robot.read("examples/five-wheel/robot.toml")
    >>> computer = OnBoard(robot, optimum=0.25, most_tilt_deg=20.0)
    >>> len(computer.tick(now_ns=0, speed_mps=0.2, heading_rad=0.0))
    5
    """

    def __init__(self, robot: Robot, *, heading_rad: float = 0.0, **control: float) -> None:
        self._core = _core.OnBoard(robot, heading_rad=heading_rad, **control)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._core.robot

    def update(self, sample: Sample, *, now_ns: int | None = None) -> None:
        """Takes a sample, which arrives now by the computer's clock or at its own time."""
        self._core.update(sample, now_ns=now_ns)

    def tick(self, *, now_ns: int, speed_mps: float, heading_rad: float) -> list[WheelCommand]:
        """Runs the control loop: a command for each wheel towards the requested motion.

        Raises
        ------
        InputError
            A speed or a heading that is NaN, infinite or absurd; nothing is commanded then, so stop the robot.
        """
        return [WheelCommand(*command) for command in self._core._tick(now_ns, speed_mps, heading_rad)]

    def observations(self) -> list[WheelObservation]:
        """What is known of the wheels since the last tick."""
        return [WheelObservation(**wheel) for wheel in self._core._observations()]

    def estimate(self) -> Estimate:
        """The filter's estimate."""
        return _estimate(self._core._estimate())

    def set_steering_angle(self, wheel: int, *, angle_rad: float) -> None:
        """A wheel is steered by this angle, to the left, from now on."""
        self._core.set_steering_angle(wheel, angle_rad)

    @property
    def speed_mps(self) -> float | None:
        """Forward speed of the robot; None while no wheel shows it."""
        return self._core.speed_mps

    @property
    def mode(self) -> str:
        """`Forward`, `Traverse`, `BackOut`, `Detour` or `Stopped`."""
        return self._core.mode

    @property
    def decision(self) -> str | None:
        """The decision of the last tick with its reason, and the wheel that it is about."""
        return self._core.decision

    @property
    def start_fault(self) -> str | None:
        """What in the sensors contradicts the robot's description."""
        return self._core.start_fault
