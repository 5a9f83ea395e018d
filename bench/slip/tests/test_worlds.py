"""Truth, sensors, soft ground and a MuJoCo world."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from slipbench.log import Robot, Wheel, slip_of
from slipbench.motion import SAMPLE_S, Motion
from slipbench.sensors import FAULTS, Suite, record, with_play
from slipbench.worlds import SIMULATED, kinematic, vehicles
from slipbench.worlds.ground import Ground, Sand, Turf, stress_table
from slipbench.worlds.simulation import Plan, simulate


def test_slip_of_both_branches() -> None:
    assert slip_of(1.0, 0.75) == pytest.approx(0.25)
    assert slip_of(0.75, 1.0) == pytest.approx(-0.25)
    assert slip_of(-1.0, -0.75) == pytest.approx(0.25)
    assert slip_of(1.0, -0.2) > 1


def straight(slip: float) -> Motion:
    time_s = SAMPLE_S * np.arange(1000)
    ground = 0.3 * time_s
    rolled = ground / (1 - slip)
    wheel = Wheel("w", 0.0, 0.0, 0.1, 4000)
    zeros = np.zeros(len(time_s))
    rates = np.zeros((len(time_s), 3))
    one = {"w": rolled}
    return Motion(Robot("one", (wheel,)), time_s, ground, zeros, zeros, ground, zeros, rates, {"w": rolled / 0.1}, one, {"w": ground})


def test_truth_of_a_steady_motion() -> None:
    truth = straight(0.25).truth()["w"]
    assert len(truth.slip) == 60
    np.testing.assert_allclose(truth.slip, 0.25, atol=1e-12)


@pytest.mark.parametrize("kind", ["pose", "displacement", "speed"])
def test_a_log_without_fault_shows_the_motion(kind: str) -> None:
    suite = Suite(kind, 10.0, 1e-6, 1e-6)  # type: ignore[arg-type]
    run = record("w", 0, straight(0.25), suite, np.random.default_rng(1))
    assert run.fault == "none"
    log = run.log
    assert log.wheel_distance("w")[-1] - log.wheel_distance("w")[0] == pytest.approx(0.4 * (log.time_s[-1] - log.time_s[0]), abs=1e-3)
    first = log.reference.values[:, 0]
    travelled = {"pose": first[-1] - first[0], "displacement": first.sum(), "speed": first.mean() * (log.reference.time_s[-1] - log.reference.time_s[0])}
    expected = 0.3 * (log.reference.time_s[-1] - log.reference.time_s[0])
    assert travelled[kind] == pytest.approx(expected, rel=0.02)


def test_each_seed_has_its_fault() -> None:
    suite = Suite("pose", 10.0)
    found = {record("w", seed, straight(0.1), suite, np.random.default_rng(seed)).fault for seed in range(len(suite.faults))}
    assert found == set(suite.faults) <= set(FAULTS)


def test_faults_do_what_they_say() -> None:
    of = lambda fault: record("w", Suite("pose").faults.index(fault), straight(0.1), Suite("pose", 10.0, 0.001), np.random.default_rng(3)).log
    assert of("coarse-encoder").robot.wheels[0].ticks_per_turn == 90
    assert np.isnan(of("lost-rows").counts["w"]).sum() > 50
    late = of("late").reference
    assert np.interp(8.0, late.time_s, late.values[:, 0]) == pytest.approx(0.3 * 7.85, abs=0.01)
    assert np.diff(of("outage").reference.time_s).max() > 6
    assert np.median(np.diff(of("slow").reference.time_s)) == pytest.approx(0.2)
    more, same = (of(fault).wheel_distance("w") for fault in ("radius", "none"))
    assert (more[-1] - more[0]) / (same[-1] - same[0]) == pytest.approx(1.01, abs=1e-3)


def test_play_is_lost_at_each_reversal() -> None:
    angle = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)])
    shown = with_play(angle, 0.1)
    assert shown.max() == pytest.approx(0.9)
    assert shown[-1] == pytest.approx(0.0)


def test_sand_pulls_more_with_slip_and_does_work() -> None:
    sand = Sand(1.0)
    normal, pull, torque = stress_table(sand, 0.15, 0.12)
    depth = int(np.searchsorted(normal[:, 24], 32.0))
    slips = sand.table_slips
    assert (np.diff(pull[depth][slips >= 0]) > 0).all()
    assert pull[depth][slips == 0][0] < 0 < pull[depth][-1]
    # energy: the torque's work covers that of the pull at every driving slip
    driving = slips > 0.01
    assert (torque[depth][driving] / 0.15 >= pull[depth][driving] * (1 - slips[driving])).all()
    # normal forces of some dozens of newtons at 1 to 4 cm, as for wheels of this size in dry sand
    assert 0.005 < sand.table_depths[depth] * 0.15 < 0.04


def test_turf_has_a_peak_and_no_more() -> None:
    turf = Turf(0.4)
    turf.prepare([(0.15, 0.12)] * 101)
    slips = np.linspace(0, 1, 101)
    push = turf.forces(np.full(101, 0.003), np.zeros(101), slips, np.zeros(101))
    assert push.pull.max() == pytest.approx(0.4 * push.normal[0], rel=1e-3)
    assert 0.1 < slips[push.pull.argmax()] < 0.4


def test_a_robot_in_mujoco_rolls_on_flat_ground_and_spins_on_ice() -> None:
    count = 800
    speed = np.minimum(0.3, 0.003 * np.arange(count))
    robot = vehicles.four()
    rolls = simulate(robot, Ground(), Plan(speed, np.zeros(count)))
    assert rolls.x[-1] == pytest.approx(rolls.rolled["front_left"][-1], rel=0.01)
    assert all(np.abs(truth.slip).max() < 0.02 for truth in rolls.truth().values())
    # a sled of 30 N on ice of 0.1 (the robot's weight is 127 N) holds it back
    ice = Ground(bands=[(-math.inf, 0.1)])
    spins = simulate(robot, ice, Plan(speed, np.zeros(count), sled_n=np.full(count, 30.0)))
    assert all(truth.slip.min() > 0.8 for truth in spins.truth().values())


def test_soft_ground_carries_the_robot_and_a_sled_makes_it_slip() -> None:
    count = 700
    speed = np.minimum(0.25, 0.0025 * np.arange(count))
    medians = []
    for sled_n in (0.0, 20.0):
        motion = simulate(vehicles.four(), Ground(), Plan(speed, np.zeros(count), sled_n=np.full(count, sled_n)), Sand(1.0))
        medians.append(float(np.median(np.concatenate([truth.slip for truth in motion.truth().values()]))))
    assert 0.0 < medians[0] < medians[1] < 0.9


def test_a_run_depends_on_its_seed_alone() -> None:
    for make in (kinematic.random_camera, kinematic.random_free, SIMULATED["skid-turns"].make):
        one, other = make("w", 5), make("w", 5)
        np.testing.assert_array_equal(one.log.reference.values, other.log.reference.values)
        for name, counts in one.log.counts.items():
            np.testing.assert_array_equal(counts, other.log.counts[name])


def test_links_correct_a_wheel_on_a_rocker() -> None:
    """The five-wheeled robot on waves: a distance by counts and links is that of the wheel in the world, to the noise of the gyro."""
    count = 1500
    plan = Plan(np.minimum(0.2, 0.002 * np.arange(count)), np.zeros(count))
    ground = Ground(waves=[(0.12, 2 * math.pi / 4, 0.0, -math.pi / 2)])
    motion = simulate(vehicles.five(), ground, plan)
    log = record("w", 0, motion, Suite("free-wheel"), np.random.default_rng(1)).log
    for wheel in motion.robot.wheels:
        true = np.interp(log.time_s, motion.time_s, motion.rolled[wheel.name])
        with_links = log.wheel_distance(wheel.name) - true
        without = dataclasses.replace(log, links={}).wheel_distance(wheel.name) - true
        assert np.ptp(with_links[10:]) < 0.01
        if wheel.name == "front_left":
            assert np.ptp(without[10:]) > 2 * np.ptp(with_links[10:])


def test_there_are_twelve_worlds() -> None:
    assert len(SIMULATED) == 12
    assert all(world.what for world in SIMULATED.values())
