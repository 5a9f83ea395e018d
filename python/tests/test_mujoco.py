"""Wheels on soft ground in MuJoCo, compared with the package's own solutions under a load."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")

from grouser import InputError, soils, wheel  # noqa: E402
from grouser.mujoco import SoftGround, WheelStates  # noqa: E402

EXAMPLES = Path(__file__).parents[2] / "examples" / "mujoco"
ROVER = EXAMPLES / "rover.xml"
NAMES = [f"{place}_{side}" for side in ("left", "right") for place in ("front", "middle", "rear")]
LOAD_N = 80.0
SIZE = {"radius_m": 0.125, "width_m": 0.1}

# A carriage of 10^9 kg drives at a constant speed, a wheel with 10^9 kg m^2 spins at a constant rate; the mast is free.
RIG = """
<mujoco>
  <option timestep="0.002" gravity="{gravity}"/>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 1" pos="{floor}" quat="{turn}"/>
    <body quat="{turn}">
      <body>
        <joint name="drive" type="slide" axis="1 0 0" armature="1e9"/>
        <geom type="box" size="0.01 0.01 0.01" mass="0.001" contype="0" conaffinity="0"/>
        <body pos="0 0 0.125">
          <joint name="mast" type="slide" axis="0 0 1"/>
          <geom type="box" size="0.01 0.01 0.01" mass="{mass}" contype="0" conaffinity="0"/>
          <body name="wheel" euler="0 0 {yaw}">
            <joint name="spin" type="hinge" axis="0 {axis} 0" armature="1e9"/>
            <geom type="cylinder" size="0.125 0.05" zaxis="0 1 0" mass="1"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def steady(
    slip: float, *, yaw_deg: float = 0.0, tilt_deg: float = 0.0, axis: int = 1, ground: Any = "floor", **soft: Any
) -> WheelStates:
    """The wheel of the rig after 2 m of travel at 0.2 m/s and this slip; the rig leans sideways with its ground."""
    half = np.radians(tilt_deg) / 2.0
    down = -9.81 * np.array([0.0, -np.sin(2.0 * half), np.cos(2.0 * half)])
    text = RIG.format(
        mass=LOAD_N / 9.81 - 1.0,
        turn=f"{np.cos(half):.17g} {np.sin(half):.17g} 0 0",
        gravity=" ".join(map(repr, map(float, down))),
        floor="0 0 0",
        yaw=yaw_deg,
        axis=axis,
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    speed = 0.2
    data.joint("drive").qvel = speed
    data.joint("spin").qvel = axis * speed * np.cos(np.radians(yaw_deg)) / (1.0 - slip) / SIZE["radius_m"]
    soil = SoftGround(model, data, ground=ground, **{"soil": "dry-sand", "wheels": ["wheel"], **soft})
    with soil.installed():
        mujoco.mj_step(model, data, nstep=5000)
    # forces to 1e-6 leave a mast in 1 s at 1e-5 m
    assert abs(data.joint("mast").qvel[0]) < 1e-5
    return soil.wheels()


@pytest.mark.parametrize("slip", [0.05, 0.3, 0.6])
def test_a_driven_wheel_reaches_the_solution_under_its_load(slip: float) -> None:
    found = steady(slip)
    expected = wheel.under_load("dry-sand", **SIZE, load_n=LOAD_N, slip=slip)
    assert found.slip[0] == pytest.approx(slip, abs=1e-6)
    assert found.sinkage_m[0] == pytest.approx(expected.sinkage_m, rel=1e-3)
    assert found.normal_force_n[0] == pytest.approx(LOAD_N, rel=1e-3)
    assert found.pull_n[0] == pytest.approx(expected.drawbar_pull_n, abs=1e-3 * LOAD_N)
    assert found.torque_nm[0] == pytest.approx(expected.torque_nm, rel=1e-3)
    assert not found.is_buried[0]


@pytest.mark.parametrize("yaw_deg", [-25.0, 10.0])
def test_a_drifting_wheel_reaches_the_solution_under_its_load(yaw_deg: float) -> None:
    found = steady(0.2, yaw_deg=yaw_deg)
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), soils.find("dry-sand"))
    # turned to the left, the wheel drifts to its right
    expected = wheel.operating_points(contact, load_n=LOAD_N, slip=0.2, slip_angle_deg=-yaw_deg)
    assert found.slip_angle_deg[0] == pytest.approx(-yaw_deg, abs=1e-4)
    for name in ("drawbar_pull_n", "side_force_n"):
        own = found["pull_n" if name == "drawbar_pull_n" else name][0]
        assert own == pytest.approx(float(expected[name]), abs=1e-3 * LOAD_N)
    assert found.sinkage_m[0] == pytest.approx(float(expected.sinkage_m), rel=1e-3)


def test_lugs_count_and_the_hinge_defines_forward() -> None:
    lugged = wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_count=24)
    found = steady(0.3, wheels={"wheel": lugged})
    contact = wheel.WheelOnSoil(lugged, soils.find("dry-sand"))
    point = contact.under_load(load_n=LOAD_N, slip=0.3)
    assert point is not None
    assert found.pull_n[0] == pytest.approx(point.drawbar_pull_n, abs=1e-3 * LOAD_N)
    plain, mirrored = steady(0.3), steady(0.3, axis=-1)
    for name in ("pull_n", "torque_nm"):
        assert mirrored[name][0] == pytest.approx(-plain[name][0], rel=1e-9)
    assert mirrored.slip[0] == pytest.approx(0.3, abs=1e-6)


def test_forces_are_those_of_the_plane_in_which_the_wheel_stands() -> None:
    level = steady(0.3)
    tilted = steady(0.3, tilt_deg=20.0)
    slope = np.tan(np.radians(20.0))
    by_function = steady(0.3, tilt_deg=20.0, ground=lambda x, y: slope * y)
    for name in ("sinkage_m", "normal_force_n", "pull_n", "torque_nm"):
        assert tilted[name][0] == pytest.approx(level[name][0], rel=1e-6)
        assert by_function[name][0] == pytest.approx(level[name][0], rel=1e-6)


def rover(ground: Any = "ground", xml: str | None = None) -> tuple[Any, Any, SoftGround]:
    text = ROVER.read_text() if xml is None else xml
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    return model, data, SoftGround(model, data, soil="dry-sand", wheels=NAMES, ground=ground)


def test_energy_is_balanced_over_a_second() -> None:
    model, data, soil = rover(lambda x, y: 0.05 * np.sin(1.5 * x) * np.cos(y))
    data.ctrl[:] = 2.0
    work = dict.fromkeys(("motors", "soil", "links"), 0.0)
    step = model.opt.timestep
    with soil.installed():
        mujoco.mj_step(model, data, nstep=400)
        start = None
        for _ in range(401):
            # at the state before the step
            velocity = data.qvel.copy()
            mujoco.mj_forward(model, data)
            if start is None:
                start = data.energy.sum()
            links = -model.dof_damping * velocity
            powers = {
                "motors": data.qfrc_actuator @ velocity,
                "links": links @ velocity,
                "soil": (data.qfrc_passive - links) @ velocity,
            }
            end = data.energy.sum()
            mujoco.mj_step(model, data)
            for name, power in powers.items():
                work[name] += step * power
    gained, given = end - start, work["motors"]
    assert work["soil"] < 0.0 < given  # sand takes energy
    assert sum(work.values()) == pytest.approx(gained, abs=0.01 * given)


def test_a_parked_rover_holds_its_slope() -> None:
    slope = np.tan(np.radians(12.0))
    model, data, soil = rover(lambda x, y: slope * x)
    # brakes: 2 N m turn a wheel by 2e-5 rad/s
    model.dof_damping[[model.joint(name).dofadr[0] for name in NAMES]] = 1e5
    data.qpos[2] += 0.02
    data.qpos[3:7] = [np.cos(np.radians(-6.0)), 0.0, np.sin(np.radians(-6.0)), 0.0]
    with soil.installed():
        mujoco.mj_step(model, data, nstep=3200)
        before = data.qpos[:3].copy()
        mujoco.mj_step(model, data, nstep=400)
    # on its springs of sheared sand it swings for some seconds, and then creeps by less than a hair a minute
    assert np.linalg.norm(data.qpos[:3] - before) < 1e-5
    total = sum(soil.wheels().normal_force_n)
    assert total == pytest.approx(46.0 * 9.81 * np.cos(np.radians(12.0)), rel=0.01)


def test_height_fields_are_the_ground() -> None:
    def dunes(x: Any, y: Any) -> Any:
        return 0.05 * np.sin(1.5 * x) * np.cos(y)

    count, half = 401, 5.0
    text = ROVER.read_text().replace(
        "<worldbody>",
        f'<asset><hfield name="dunes" nrow="{count}" ncol="{count}" size="{half} {half} 0.1 0.1"/></asset>\n<worldbody>'
        '<geom name="dunes" type="hfield" hfield="dunes" pos="0.5 0.2 -0.05" euler="0 0 90"/>',
    )
    model, data, soil = rover("dunes", text)
    # rows go along the field's y, which is the world's -x
    v, u = np.mgrid[0:count, 0:count] * (2.0 * half / (count - 1)) - half
    model.hfield_data[:] = ((dunes(0.5 - v, 0.2 + u) + 0.05) / 0.1).reshape(-1)
    _, by_function, other = rover(dunes)
    for one, ground in ((data, soil), (by_function, other)):
        one.ctrl[:] = 1.0
        with ground.installed():
            mujoco.mj_step(ground.model, one, nstep=1600)
    assert data.qpos[0] > 0.15
    np.testing.assert_allclose(data.qpos[:3], by_function.qpos[:3], atol=2e-4)
    # beyond the field there is no ground
    data.qpos[0] = 9.0
    soil.reset()
    with soil.installed():
        mujoco.mj_step(model, data)
    assert (soil.wheels().normal_force_n == 0.0).all()


def test_steps_in_two_halves_are_the_same() -> None:
    ends = []
    for halves in (False, True):
        model, data, soil = rover()
        data.ctrl[:] = 1.0
        if halves:
            for _ in range(200):
                mujoco.mj_step1(model, data)
                soil.apply()
                mujoco.mj_step2(model, data)
        else:
            with soil.installed():
                mujoco.mj_step(model, data, nstep=200)
        ends.append(data.qpos.copy())
    np.testing.assert_array_equal(*ends)


def test_a_reset_forgets_and_other_data_is_left_alone() -> None:
    model, data, soil = rover()
    data.ctrl[:] = 1.0
    ends = []
    with soil.installed():
        for _ in range(2):
            mujoco.mj_resetData(model, data)
            data.ctrl[:] = 1.0
            mujoco.mj_step(model, data, nstep=100)
            ends.append(data.qpos.copy())
        other = mujoco.MjData(model)
        mujoco.mj_step(model, other)
        assert (other.qfrc_passive == 0.0).all()
    np.testing.assert_array_equal(*ends)
    assert mujoco.get_mjcb_passive() is None


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"wheels": ["no_wheel"]}, "no body `no_wheel`"),
        ({"wheels": ["chassis"]}, "one joint, a hinge"),
        ({"wheels": []}, "wheels is empty"),
        ({"wheels": ["rocker_left"]}, "no cylinder"),
        ({"ground": "lawn"}, "no geom `lawn`"),
        ({"soil": "mud"}, "mud"),
    ],
)
def test_bad_input_is_named(change: dict[str, Any], match: str) -> None:
    model = mujoco.MjModel.from_xml_path(str(ROVER))
    given = {"soil": "dry-sand", "wheels": NAMES, "ground": "ground"} | change
    with pytest.raises(InputError, match=match):
        SoftGround(model, mujoco.MjData(model), **given)


def test_steps_and_integrators_that_do_not_fit_are_refused() -> None:
    model = mujoco.MjModel.from_xml_path(str(ROVER))
    model.opt.timestep = 0.01
    with pytest.raises(InputError, match="timestep is 0.01"):
        SoftGround(model, mujoco.MjData(model), soil="dry-sand", wheels=NAMES, ground="ground")
    model.opt.timestep = 0.002
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with pytest.raises(InputError, match="RK4"):
        SoftGround(model, mujoco.MjData(model), soil="dry-sand", wheels=NAMES, ground="ground")


def test_the_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLES / "drive.py"))
    said = capsys.readouterr().out
    assert said.count("slip") == 6 and "times as fast as real time" in said


@pytest.mark.filterwarnings("default")  # Gymnasium's advice about bounds
def test_the_environment_is_one_of_gymnasium() -> None:
    pytest.importorskip("gymnasium", reason="Gymnasium is not installed: pip install gymnasium")
    from gymnasium.utils.env_checker import check_env

    rover = runpy.run_path(str(EXAMPLES / "environment.py"))["SandRover"](duration_s=1.0)
    check_env(rover, skip_render_check=True)
    ends = []
    for _ in range(2):
        rover.reset(seed=3)
        steps = [rover.step(np.full(6, 2.0)) for _ in range(9)]
        ends.append(steps[-1][0])
    np.testing.assert_array_equal(*ends)
    assert steps[-1][3] and steps[-1][4]["energy_j"] > 0.0
