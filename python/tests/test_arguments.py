"""Arguments of the wrong type, size or range: every error is typed and names the keyword, the value, the limit and the unit."""

from __future__ import annotations

import copy
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from grouser import InputError, InputTypeError, drive, figures, identify, logs, optimize, soils, terrain, wheel
from grouser.slip import OnBoard, Robot, Sample, SlipFilter

EXAMPLES = Path(__file__).parents[2] / "examples"
SAND = soils.find("dry-sand")
SIZE = {"radius_m": 0.125, "width_m": 0.1}
RIM = wheel.Wheel(**SIZE)
CONTACT = wheel.WheelOnSoil(RIM, SAND)
ROBOT = Robot.read(EXAMPLES / "five-wheel" / "robot.toml")
SCENARIO = drive.read(EXAMPLES / "scenarios" / "sandbox.toml")
MAPPER = terrain.SlipMapper(EXAMPLES / "robots" / "skid-steer.toml", soils.find("sandy-loam"), cell_m=1.0, headings=4)
MAP = terrain.slip_map(MAPPER, 0.05 * np.sin(np.arange(80.0)).reshape(8, 10))
BEKKER = {"name": "a", "n": 1.0, "k_c_kn_per_m_n1": 1, "k_phi_kn_per_m_n2": 1000, "c_1": 0.2, "c_2": 0.3, "k_shear_m": 0.01}
NAN = float("nan")


def robust(**change: Any) -> object:
    return optimize.robust(**{"objectives": lambda x, world: [(x[0] - world) ** 2], "worlds": [0.0], "start": [0.5], **change})


WRONG_TYPES: list[tuple[str, Callable[[Any], object]]] = [
    ("radius_m", lambda x: wheel.Wheel(radius_m=x, width_m=0.1)),
    ("grouser_count", lambda x: wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_count=x or 1.5)),
    ("load_n", lambda x: CONTACT.under_load(load_n=x, slip=0.1)),
    ("slip_angle_deg", lambda x: CONTACT.under_load(load_n=80.0, slip=0.1, slip_angle_deg=x)),
    ("sinkage_m", lambda x: CONTACT.at_sinkage(sinkage_m=x, slip=0.1)),
    ("weight_n", lambda x: CONTACT.gradeability_deg(weight_n=x)),
    ("bearing_torque_nm", lambda x: CONTACT.free_slip(load_n=80.0, bearing_torque_nm=x)),
    ("wheel", lambda x: wheel.WheelOnSoil(x, SAND)),
    ("soil", lambda x: wheel.WheelOnSoil(RIM, x)),
    ("soil", lambda x: wheel.under_load(x, **SIZE, load_n=80.0, slip=0.1)),
    ("soil", lambda x: wheel.at_sinkage(x, **SIZE, sinkage_m=0.01, slip=0.1)),
    ("wheel", lambda x: wheel.curve(SAND, x, load_n=80.0, slip=[0.1])),
    ("contact", lambda x: wheel.operating_points(x, load_n=80.0, slip=0.1)),
    ("contact", lambda x: wheel.slip_demand(x, weight_n=80.0, slope_deg=0.1)),
    ("contact", lambda x: wheel.jacobian(x, load_n=80.0, slip=0.1)),
    ("key", lambda x: soils.find(x or 3)),
    ("rebound", lambda x: SAND.with_rebound(rebound=x)),
    ("text", lambda x: soils.Soil.from_toml(x or 3)),
    ("robot", lambda x: SlipFilter(x)),
    ("robot", lambda x: OnBoard(x)),
    ("robot", lambda x: logs.estimate("log.csv", x)),
    ("sample", lambda x: SlipFilter(ROBOT).update(x)),
    ("now_ns", lambda x: SlipFilter(ROBOT).estimate_at(now_ns=x)),
    ("wheel", lambda x: SlipFilter(ROBOT).set_steering_angle(x, angle_rad=0.1)),
    ("gain", lambda x: OnBoard(ROBOT, gain=x)),
    ("path", lambda x: drive.read(x)),
    ("seed", lambda x: drive.run(SCENARIO, seed=x or 0.5)),
    ("duration_s", lambda x: drive.run(SCENARIO, duration_s=x or "1")),
    ("rim_speed_mps", lambda x: drive.Simulation(SCENARIO).command([(x,)] * len(SCENARIO.wheels))),
    ("speed_mps", lambda x: OnBoard(ROBOT).tick(now_ns=0, speed_mps=x, heading_rad=0.0)),
    ("time_ns", lambda x: Sample.yaw_rate(time_ns=x, rate_rad_per_s=0.1)),
    ("rate_rad_per_s", lambda x: Sample.yaw_rate(time_ns=0, rate_rad_per_s=x)),
    ("force_mps2", lambda x: Sample.inertial(time_ns=0, force_mps2=x, rate_rad_per_s=[0.0, 0.0, 0.0])),
    ("scenario", lambda x: drive.run(x)),
    ("pilot", lambda x: drive.run(SCENARIO, pilot=x or 3)),
    ("cell_m", lambda x: terrain.SlipMapper(EXAMPLES / "robots" / "skid-steer.toml", SAND, cell_m=x)),
    ("mapper", lambda x: terrain.slip_map(x, np.zeros((3, 3)))),
    ("found", lambda x: terrain.plan(x, start_m=(1.0, 1.0), goal_m=(2.0, 2.0))),
    ("start", lambda x: optimize.minimax(lambda y: y, start=x)),
    ("reference_accuracy", lambda x: wheel.WheelOnSoil(RIM, SAND, reference_accuracy=x)),
    ("shear", lambda x: wheel.WheelOnSoil(RIM, SAND, shear=x or 3)),
    ("bulldozing", lambda x: wheel.WheelOnSoil(RIM, SAND, bulldozing=x or 3)),
    ("reference", lambda x: logs.Engine(ROBOT, reference=x)),
    ("wheel_sensor", lambda x: logs.Engine(ROBOT, reference="grip", wheel_sensor=x)),
    ("paths", lambda x: logs.estimate(x, ROBOT)),
    ("paths", lambda x: logs.read([x], ROBOT)),
    ("columns", lambda x: logs.read("log.csv", ROBOT, columns=x or 3)),
    ("reference", lambda x: logs.estimate("log.csv", ROBOT, reference=x or 3)),
    ("from_s", lambda x: logs.estimate("log.csv", ROBOT, from_s=x or "0.1")),
    ("online", lambda x: logs.estimate("log.csv", ROBOT, online=x)),
    ("path", lambda x: Robot.read(x)),
    ("path", lambda x: soils.read(x)),
    ("path", lambda x: terrain.read(x)),
    ("job", lambda x: identify.run(x)),
    ("path", lambda x: optimize.solve_file(x)),
    ("text", lambda x: optimize.solve_text(x)),
    ("robot", lambda x: terrain.SlipMapper(x, SAND, cell_m=1.0)),
    ("soil_intervals", lambda x: terrain.SlipMapper("robot.toml", SAND, cell_m=1.0, soil_intervals=x or 3)),
    ("by_cvar", lambda x: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), by_cvar=x)),
    ("max_risk", lambda x: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), max_risk=x)),
    ("worlds", lambda x: robust(worlds=x if x != b"1" else 3)),
    ("measure", lambda x: robust(measure=x)),
    ("parameter", lambda x: robust(parameter=x)),
    ("step_tolerance", lambda x: robust(settings=optimize.Settings(step_tolerance=x))),
    ("settings", lambda x: robust(settings=x)),
    ("linear", lambda x: robust(linear=[x])),
    ("bound", lambda x: robust(linear=[optimize.Linear([1.0], x)])),
    ("equal", lambda x: robust(linear=[optimize.Linear([1.0], 1.0, equal=x)])),
    ("polish", lambda x: optimize.pareto(lambda y: [y[0], -y[0]], start=[0.5], lower=0.0, upper=1.0, polish=x)),
    ("title", lambda x: figures.lines(x, "x", "y")),
]  # fmt: skip


@pytest.mark.parametrize("bad", [object(), 1j, b"1", None], ids=lambda bad: type(bad).__name__)
@pytest.mark.parametrize(("field", "call"), WRONG_TYPES, ids=lambda x: x if isinstance(x, str) else "")
def test_a_wrong_type_names_its_keyword(field: str, call: Callable[[Any], object], bad: object) -> None:
    with pytest.raises(InputTypeError) as caught:
        call(bad)
    assert caught.value.field == field and str(caught.value).startswith(field)


# what is wrong: keyword, value, limit and unit as the caller knows them
OUT_OF_RANGE: list[tuple[Callable[[], object], str, Any, Any, str]] = [
    (lambda: wheel.Wheel(radius_m=-0.1, width_m=0.1), "radius_m", -0.1, (0.001, 100.0), "m"),
    (lambda: wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_count=0), "grouser_count", 0.0, (1.0, 1e4), "1"),
    (lambda: wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_count=-1), "grouser_count", -1, (0.0, 2.0**32 - 1), "1"),
    (lambda: CONTACT.under_load(load_n=-1.0, slip=0.1), "load_n", -1.0, (0.0, 1e12), "N"),
    (lambda: CONTACT.under_load(load_n=80.0, slip=2.0), "slip", 2.0, (-1.0, 1.0), "1"),
    (lambda: CONTACT.under_load(load_n=80.0, slip=0.2, slip_angle_deg=95.0), "slip_angle_deg", 95.0, (-89.9, 89.9), "deg"),
    (lambda: CONTACT.at_sinkage(sinkage_m=0.2, slip=0.1), "sinkage_m", 0.2, (0.0, 0.125), "m"),
    (lambda: soils.Soil(**BEKKER, cohesion_kpa=1.0, phi_deg=95.0), "phi_deg", 95.0, (0.0, 89.0), "deg"),
    (lambda: soils.Soil(**BEKKER, cohesion_kpa=-2.0, phi_deg=30.0), "cohesion_kpa", -2.0, (0.0, 1e5), "kPa"),
    (lambda: soils.find("dry-sand", k_shear_m=-1.0), "k_shear_m", -1.0, 0.0, "m"),
    (lambda: Sample.wheel_count(time_ns=2**63, wheel=0, count=0), "time_ns", 2**63, (-(2.0**63), 2.0**63), "1"),
    (lambda: SlipFilter(ROBOT).set_steering_angle(-1, angle_rad=0.1), "wheel", -1, (0.0, 2.0**32 - 1), "1"),
    (lambda: OnBoard(ROBOT).tick(now_ns=0, speed_mps=np.inf, heading_rad=0.0), "speed_mps", np.inf, (-1e6, 1e6), "m/s"),
    (lambda: OnBoard(ROBOT).tick(now_ns=0, speed_mps=0.1, heading_rad=-np.inf), "heading_rad", -np.inf, (-1e6, 1e6), "rad"),
    (lambda: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), rim_speed_mps=0), "rim_speed_mps", 0.0, (1e-4, 100.0), "m/s"),
    (lambda: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), min_tip_over_deg=91), "min_tip_over_deg", 91.0, (0.0, 90.0), "deg"),
    (lambda: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), turn_energy_j=-1), "turn_energy_j", -1.0, (0.0, 1e9), "J"),
    (lambda: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), max_slip=2), "max_slip", 2.0, (0.0, 1.0), "1"),
    (lambda: OnBoard(ROBOT, most_tilt_deg=95.0), "most_tilt_deg", 95.0, (0.0, 90.0), "deg"),
    (lambda: OnBoard(ROBOT, optimum=0.99), "optimum", 0.99, (0.01, 0.95), "1"),
    (lambda: OnBoard(ROBOT).tick(now_ns=10**30, speed_mps=0.1, heading_rad=0.0), "now_ns", 10**30, (-(2.0**63), 2.0**63), "1"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "field", "value", "limit", "unit"), OUT_OF_RANGE, ids=lambda x: x if isinstance(x, str) else "")
def test_a_number_outside_its_limits_is_named_as_it_was_given(
    call: Callable[[], object], field: str, value: Any, limit: Any, unit: str
) -> None:
    with pytest.raises(InputError) as caught:
        call()
    error = caught.value
    assert (error.field, error.value, error.unit) == (field, value, unit)
    if isinstance(limit, tuple):
        assert error.limit == pytest.approx(limit, rel=1e-12)
    else:
        assert np.min(error.limit) == pytest.approx(limit, abs=1e-3)
    # the message is of the same unit
    assert f"{field} is" in str(error).replace("`", "")
    # and has no line, which keywords do not have
    assert not re.search(r":\d+:", str(error))
    again = pickle.loads(pickle.dumps(error))
    assert (again.field, again.value, again.limit, again.unit, str(again)) == (
        error.field, error.value, error.limit, error.unit, str(error)
    )  # fmt: skip


NUMBERS: list[tuple[str, Callable[[Any], object]]] = [
    ("radius_m", lambda x: wheel.Wheel(radius_m=x, width_m=0.1)),
    ("n", lambda x: soils.Soil(**{**BEKKER, "cohesion_kpa": 1.0, "phi_deg": 30.0, "n": x})),
    ("grouser_tip_share", lambda x: wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_tip_share=x)),
    ("load_n", lambda x: CONTACT.under_load(load_n=x, slip=0.1)),
    ("load_n", lambda x: wheel.under_load(SAND, **SIZE, load_n=x, slip=0.1)),
    ("force_mps2", lambda x: Sample.inertial(time_ns=0, force_mps2=[0.0, 0.0, x], rate_rad_per_s=[0.0, 0.0, 0.0])),
    ("parameter", lambda x: robust(measure="mean-plus-deviations", parameter=x)),
    ("optimality_tolerance", lambda x: robust(settings=optimize.Settings(optimality_tolerance=x))),
    ("max_values", lambda x: robust(settings=optimize.Settings(max_values=x))),
    ("to_s", lambda x: logs.estimate("log.csv", ROBOT, to_s=x)),
    ("max_slip", lambda x: terrain.plan(MAP, start_m=(1.0, 1.0), goal_m=(2.0, 2.0), max_slip=x)),
]  # fmt: skip


@pytest.mark.parametrize("bad", [True, np.True_, "0.1", "1"], ids=repr)
@pytest.mark.parametrize(("field", "call"), NUMBERS, ids=lambda x: x if isinstance(x, str) else "")
def test_booleans_and_text_are_no_numbers(field: str, call: Callable[[Any], object], bad: object) -> None:
    with pytest.raises(InputTypeError) as caught:
        call(bad)
    assert caught.value.field == field


@pytest.mark.parametrize("yes", [True, np.True_], ids=repr)
def test_flags_of_numpy_are_flags(yes: Any) -> None:
    exact = wheel.WheelOnSoil(RIM, SAND, reference_accuracy=True).under_load(load_n=80.0, slip=0.2)
    same = wheel.WheelOnSoil(RIM, SAND, reference_accuracy=yes).under_load(load_n=80.0, slip=0.2)
    assert repr(same) == repr(exact) != repr(CONTACT.under_load(load_n=80.0, slip=0.2))
    online = logs.estimate(EXAMPLES / "five-wheel" / "log.csv", ROBOT, to_s=2.0, online=yes).rows.slip
    assert not np.array_equal(online, logs.estimate(EXAMPLES / "five-wheel" / "log.csv", ROBOT, to_s=2.0).rows.slip)


def test_a_measure_is_known_by_its_name_in_problem_files() -> None:
    for name in ("worst-case", "mean-plus-deviations"):
        ours = robust(measure=name, worlds=[0.0, 1.0], parameter=1.0)
        assert ours.x == robust(measure=name.replace("-", "_"), worlds=[0.0, 1.0], parameter=1.0).x  # type: ignore[attr-defined]


def test_an_integer_beyond_every_float_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        wheel.Wheel(radius_m=10**400, width_m=0.1)
    assert caught.value.field == "radius_m"


def test_points_samples_and_maps_are_picklable() -> None:
    for point in (
        CONTACT.under_load(load_n=80.0, slip=0.2, slip_angle_deg=5.0),
        CONTACT.at_sinkage(sinkage_m=0.01, slip=-0.2),
    ):
        assert point is not None
        for again in (pickle.loads(pickle.dumps(point)), copy.deepcopy(point)):
            assert repr(again) == repr(point) and again.side_force_n == point.side_force_n
    samples = [Sample.displacement(time_ns=-3, forward_m=0.1, left_m=0.2), Sample.speed(time_ns=1, forward_mps=0.1)]
    values = {"count": 2**63 + 1, "forward": False, "joint": 1, "force_mps2": [0.1, 0.2, 0.3]}
    # every kind that the library declares, with a function of that name
    for kind, _, of_wheel, fields in Sample._kinds():
        numbers = {key: values.get(key, 0.01 * (1 + k)) for k, (key, _, _) in enumerate(fields)}
        if kind == "inertial":
            numbers["rate_rad_per_s"] = [0.4, 0.5, 0.6]
        sample = getattr(Sample, kind.replace("-", "_"))(time_ns=1, **({"wheel": 2} if of_wheel else {}), **numbers)
        assert (sample.kind, sample.wheel) == (kind, 2 if of_wheel else None)
        flat = [x for value in numbers.values() for x in (value if isinstance(value, list) else [value])]
        assert sample.numbers == [-1.0 if x is False else float(x) for x in flat]
        samples.append(sample)
    assert [pickle.loads(pickle.dumps(sample)) for sample in samples] == samples
    again = pickle.loads(pickle.dumps(MAP))
    assert (again.shape, again.robot, again.soils) == (MAP.shape, MAP.robot, MAP.soils)
    np.testing.assert_array_equal(again.quantity("slip"), MAP.quantity("slip"))
    way = {"start_m": (2.5, 2.5), "goal_m": (6.5, 5.5)}
    ours, theirs = terrain.plan(MAP, **way).route, terrain.plan(again, **way).route
    assert ours is not None and theirs is not None and ours.energy_j == theirs.energy_j
