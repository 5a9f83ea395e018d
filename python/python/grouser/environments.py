"""Drives as environments for learning controllers, with Gymnasium's interface: many robots side by side.

Needs Gymnasium (`pip install gymnasium`). Every environment is the drive that `grouser.drive` makes of the same seed and the
same commands, to the bit. A controller sees what the robot's own estimator knows, never the truth; progress and energy in
the reward are true, as a trainer may know them.

Examples
--------
>>> import numpy as np
>>> from grouser import drive, environments
>>> scenario = drive.read("examples/scenarios/sandbox.toml")
>>> robots = environments.DriveVectorEnv(scenario, num_envs=2)
>>> observation, _ = robots.reset(seed=7)
>>> action = np.full(robots.action_space.shape, [0.1, 0.0])  # 0.1 m/s at every rim, straight ahead
>>> observation, reward, terminated, truncated, info = robots.step(action)
>>> observation.shape == robots.observation_space.shape
True
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

try:
    import gymnasium
    from gymnasium import spaces
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space
except ModuleNotFoundError:  # pragma: no cover
    raise ModuleNotFoundError("grouser.environments needs Gymnasium: pip install gymnasium", name="gymnasium") from None

from . import _core
from ._arrays import as_floats, check_kind, number, threads_of, whole
from ._core import Scenario
from ._errors import InputError, InputTypeError
from .drive import PERIOD_S

__all__ = ["ROBOT_COLUMNS", "WHEEL_COLUMNS", "DriveVectorEnv", "progress_less_energy"]

ROBOT_COLUMNS = (
    "requested_speed_mps",
    "turn_to_requested_heading_rad",
    "pitch_rad",
    "roll_rad",
    "speed_mps",
    "speed_is_known",
)
"""The first columns of an observation; pitch with the nose down, roll with the right side down positive."""

WHEEL_COLUMNS = ("slip", "slip_sigma", "slip_is_known", "rim_speed_mps", "torque_share", "load_n")
"""The columns of each wheel after them. Numbers that are unknown are 0, and `slip_is_known` says so."""

_TRACTION = 1.0
"""Greatest torque, as the share of load times radius: the motor's own limit stays."""

Array = npt.NDArray[np.float64]


def progress_less_energy(progress_m: Array, energy_j: Array, failed: npt.NDArray[np.bool_]) -> Array:
    """The reward of a step: metres of progress, less a metre for every 500 J, less ten metres where the robot is lost.

    On firm sand the shipped robots need between 50 and 150 J/m.
    """
    return progress_m - energy_j / 500.0 - 10.0 * failed


class DriveVectorEnv(VectorEnv[Array, Array, npt.NDArray[Any]]):
    """Robots of one scenario side by side; Gymnasium's vector environment, with reset in the step after the end.

    Parameters
    ----------
    scenario : Scenario
    num_envs : int
        How many, 1 to 4096.
    step_s : float
        Time of a step, whole hundredths of a second; a command lasts for it.
    max_rim_speed_mps : float
        Bound of the actions.
    reward : callable
        Of progress (m), energy (J) and failure of a step to rewards, arrays of one value a robot.
    threads : int, optional
        As many as the machine runs by default. The results do not depend on it.

    Notes
    -----
    Actions are (wheels, 2): rim speed, m/s, and steering angle, rad; those of free wheels have no effect. Observations
    are the columns `ROBOT_COLUMNS`, then `WHEEL_COLUMNS` of each wheel. `info` has `outcome` (as
    `grouser.drive.DriveResult`, None while a drive goes on), `distance_m` and `energy_j`. A drive whose time is over
    is truncated; any other end is terminal.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        scenario: Scenario,
        *,
        num_envs: int = 64,
        step_s: float = 0.1,
        max_rim_speed_mps: float = 0.5,
        reward: Callable[[Array, Array, npt.NDArray[np.bool_]], Array] = progress_less_energy,
        threads: int | None = None,
    ) -> None:
        check_kind("scenario", scenario, Scenario)
        num_envs = whole("num_envs", num_envs, 1, 4096)
        if not callable(reward):
            raise InputTypeError("reward must be callable", "reward", reward)
        self._periods = round(_number("step_s", step_s, (PERIOD_S, 100.0), "s") / PERIOD_S)
        speed = _number("max_rim_speed_mps", max_rim_speed_mps, (1e-3, 100.0), "m/s")
        self.scenario, self.num_envs, self._reward, self._threads = scenario, num_envs, reward, threads_of(threads)
        wheels = len(scenario.wheels)
        columns = len(ROBOT_COLUMNS) + wheels * len(WHEEL_COLUMNS)
        bound = np.tile([speed, np.pi / 2.0], (wheels, 1))
        self.single_action_space = spaces.Box(-bound, bound, dtype=np.float64)
        self.single_observation_space = spaces.Box(-np.inf, np.inf, (columns,), dtype=np.float64)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._seed, self._episodes = scenario.seed, np.zeros(self.num_envs, dtype=np.int64)
        self._fleet: _core.Fleet | None = None

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begins all drives: robot k of episode e has the seed `seed + k + e · num_envs`."""
        super().reset(seed=None, options=options)
        if isinstance(seed, list):
            raise InputTypeError("seed must be one whole number: robot k has seed + k", "seed", seed)
        if seed is not None:
            self._seed = whole("seed", seed, 0, 2**62 - 1)
        self._episodes[:] = 0
        self._fleet = _core.Fleet(self.scenario, [self._seed_of(k) for k in range(self.num_envs)], self._threads)
        self._distance, self._energy = np.zeros(self.num_envs), np.zeros(self.num_envs)
        self._ended = np.zeros(self.num_envs, dtype=np.bool_)
        observation, distance, energy, outcomes = self._fleet.state()
        return _turned(observation), _info(distance, energy, outcomes)

    def step(
        self, actions: Any
    ) -> tuple[Array, Array, npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]:
        """One step of every robot. A robot that ended in the step before begins anew, its action without effect.

        Raises
        ------
        InputError
            Actions of another shape, or numbers that are not finite.
        """
        if self._fleet is None:
            raise gymnasium.error.ResetNeeded("reset() comes before step()")
        given = as_floats("actions", actions)
        if given.shape != self.action_space.shape:
            raise InputError(
                f"actions have the shape {given.shape}, but must have {self.action_space.shape}", "actions", given.shape
            )
        if not np.isfinite(given).all():
            raise InputError("actions must be finite", "actions")
        space = self.single_action_space
        assert isinstance(space, spaces.Box)
        given = np.clip(given, space.low, space.high)
        commands = np.stack([given[..., 0], np.full(given.shape[:2], _TRACTION), given[..., 1]], axis=-1)
        begins = self._ended.copy()
        if begins.any():
            self._episodes[begins] += 1
            indices = np.flatnonzero(begins).tolist()
            self._fleet.reset(indices, [self._seed_of(k) for k in indices])
            self._distance[begins] = self._energy[begins] = 0.0
        # a robot that begins anew shows its start, as Gymnasium wants it
        self._fleet.advance(np.ascontiguousarray(commands), self._periods, (~begins).tolist())
        observation, distance, energy, outcomes = self._fleet.state()
        self._ended = np.array([outcome is not None for outcome in outcomes], dtype=np.bool_)
        truncated = np.array([outcome == "time-out" for outcome in outcomes], dtype=np.bool_)
        terminated = self._ended & ~truncated
        failed = terminated & np.array([outcome != "arrived" for outcome in outcomes], dtype=np.bool_)
        reward = np.asarray(self._reward(distance - self._distance, energy - self._energy, failed), dtype=np.float64)
        reward = np.where(begins, 0.0, reward)
        self._distance, self._energy = distance, energy
        return _turned(observation), reward, terminated, truncated, _info(distance, energy, outcomes)

    def _seed_of(self, index: int) -> int:
        return self._seed + index + int(self._episodes[index]) * self.num_envs


def _turned(observation: Array) -> Array:
    """The turn to the requested heading the short way, in [−π, π)."""
    observation[:, 1] = (observation[:, 1] + np.pi) % (2.0 * np.pi) - np.pi
    return observation


def _info(distance: Array, energy: Array, outcomes: list[str | None]) -> dict[str, Any]:
    return {"outcome": np.array(outcomes, dtype=object), "distance_m": distance, "energy_j": energy}


def _number(field: str, value: Any, limits: tuple[float, float], unit: str) -> float:
    found = number(field, value)
    if not limits[0] <= found <= limits[1]:
        raise InputError(f"{field} is {value!r}, but must lie in {list(limits)} {unit}", field, value, limits, unit)
    return found
