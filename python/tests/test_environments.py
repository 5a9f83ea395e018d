"""Robots side by side: each is its own drive to the bit, and Gymnasium's own checks pass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from grouser import InputError, InputTypeError, drive, environments  # noqa: E402

SCENARIOS = Path(__file__).parents[2] / "examples" / "scenarios"


@pytest.mark.parametrize("name", ["sandbox", "slope"])
def test_every_robot_is_its_own_drive(name: str) -> None:
    scenario = drive.read(SCENARIOS / f"{name}.toml")
    robots = environments.DriveVectorEnv(scenario, num_envs=3, step_s=0.2, threads=2)
    observation, _ = robots.reset(seed=40)
    rng = np.random.default_rng(1)
    actions = rng.uniform(0.0, 0.2, (12, *(robots.action_space.shape or ())))
    actions[..., 1] = 0.0
    alone = [drive.Simulation(scenario, pilot="open-loop", seed=40 + k) for k in range(3)]
    for action in actions:
        observation, _, _, _, info = robots.step(action)
        for k, one in enumerate(alone):
            for _ in range(20):
                one.command([drive.WheelCommand(speed, 1.0, 0.0) for speed in action[k, :, 0]])
                one.advance()
            seen = one.observation()
            assert observation[k, 0] == seen.requested_speed_mps
            assert observation[k, 2] == seen.pitch_rad and observation[k, 3] == seen.roll_rad
            slips = [wheel.slip or 0.0 for wheel in seen.wheels]
            np.testing.assert_array_equal(observation[k, 6 :: len(environments.WHEEL_COLUMNS)], slips)
            result = one.result()
            assert (info["distance_m"][k], info["energy_j"][k]) == (result.distance_m, result.energy_j)
    # neither the number of threads nor the neighbours matter
    again = environments.DriveVectorEnv(scenario, num_envs=1, step_s=0.2, threads=1)
    again.reset(seed=41)
    for action in actions:
        single, *_ = again.step(action[1:2])
    np.testing.assert_array_equal(single[0], observation[1])


def test_an_ended_drive_begins_anew_with_another_seed() -> None:
    scenario = drive.read(SCENARIOS / "sandbox.toml")
    robots = environments.DriveVectorEnv(scenario, num_envs=2, step_s=50.0, max_rim_speed_mps=0.2)
    robots.reset(seed=5)
    rest = np.zeros(robots.action_space.shape)
    ended = np.zeros(2, dtype=bool)
    for _ in range(20):
        observation, reward, terminated, truncated, info = robots.step(rest)
        ended = terminated | truncated
        if ended.any():
            break
    assert ended.all() and all(outcome is not None for outcome in info["outcome"])
    observation, reward, terminated, truncated, info = robots.step(rest)
    assert (reward == 0.0).all() and not (terminated | truncated).any()
    assert (info["energy_j"] == 0.0).all() and list(info["outcome"]) == [None, None]
    fresh = environments.DriveVectorEnv(scenario, num_envs=2)
    start, _ = fresh.reset(seed=5 + 2)
    np.testing.assert_array_equal(observation, start)


def test_what_a_step_yields_lies_in_its_spaces() -> None:
    robots = environments.DriveVectorEnv(drive.read(SCENARIOS / "sandbox.toml"), num_envs=2)
    first, _ = robots.reset(seed=3)
    again, _ = robots.reset(seed=3)
    np.testing.assert_array_equal(first, again)
    robots.action_space.seed(1)
    for _ in range(5):
        observation, reward, terminated, truncated, info = robots.step(robots.action_space.sample())
        assert observation in robots.observation_space and observation.dtype == np.float64
        assert reward.shape == terminated.shape == truncated.shape == (2,)
        assert np.isfinite(observation).all() and np.isfinite(reward).all()


def test_bad_input_is_named() -> None:
    scenario = drive.read(SCENARIOS / "sandbox.toml")
    with pytest.raises(InputError, match="num_envs"):
        environments.DriveVectorEnv(scenario, num_envs=0)
    with pytest.raises(InputError, match="step_s"):
        environments.DriveVectorEnv(scenario, step_s=float("nan"))
    with pytest.raises(InputTypeError, match="reward"):
        environments.DriveVectorEnv(scenario, reward=3)  # type: ignore[arg-type]
    robots = environments.DriveVectorEnv(scenario, num_envs=1)
    with pytest.raises(Exception, match="reset"):
        robots.step(np.zeros(robots.action_space.shape))
    robots.reset(seed=1)
    with pytest.raises(InputError, match="shape"):
        robots.step(np.zeros(3))
    with pytest.raises(InputError, match="finite"):
        robots.step(np.full(robots.action_space.shape, np.nan))
    with pytest.raises(InputError, match="seed"):
        robots.reset(seed=-1)
