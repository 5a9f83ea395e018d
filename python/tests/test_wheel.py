"""The wheel's array functions: numbers, shapes, types, threads."""

from __future__ import annotations

import pickle
import threading

import numpy as np
import pytest

from grouser import InputError, InputTypeError, soils, wheel

SAND = soils.find("dry-sand")
LUNAR = soils.find("lunar")
SIZE = {"radius_m": 0.125, "width_m": 0.1}


def test_an_independent_quadrature_is_met() -> None:
    # independent 1e-10 quadrature: 17.007 mm and 3.295 N
    points = wheel.under_load(LUNAR, radius_m=0.125, width_m=0.15, load_n=65.0, slip=0.25)
    assert points.status == 0
    assert points.sinkage_m == pytest.approx(0.017007, abs=1e-6)
    assert points.drawbar_pull_n == pytest.approx(3.2949, abs=1e-4)


def test_scalars_give_scalars_and_arrays_broadcast() -> None:
    one = wheel.under_load(SAND, **SIZE, load_n=80, slip=0.2)
    assert np.ndim(one.sinkage_m) == 0 and isinstance(one.sinkage_m, np.float64)
    slip = np.linspace(-0.4, 0.9, 14)
    load = np.array([[40.0], [80.0], [120.0]])
    table = wheel.under_load(SAND, **SIZE, load_n=load, slip=slip)
    assert table.drawbar_pull_n.shape == (3, 14)
    for i in range(3):
        for j in range(14):
            alone = wheel.under_load(SAND, **SIZE, load_n=float(load[i, 0]), slip=float(slip[j]))
            assert alone.drawbar_pull_n == table.drawbar_pull_n[i, j]
    empty = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=np.empty((0, 3)))
    assert empty.sinkage_m.shape == (0, 3)
    single = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=np.array([[0.2]]))
    assert single.sinkage_m.shape == (1, 1)


@pytest.mark.parametrize("layout", ["strided", "reversed", "fortran", "read-only", "float32", "int", "list", "big"])
def test_every_layout_gives_the_same_numbers(layout: str) -> None:
    base = np.linspace(0.0, 1.0, 24).reshape(4, 6)
    if layout == "strided":
        slip = np.repeat(base, 2, axis=1)[:, ::2]
    elif layout == "reversed":
        slip = base[::-1, ::-1][::-1, ::-1]
    elif layout == "fortran":
        slip = np.asfortranarray(base)
    elif layout == "read-only":
        slip = base.copy()
        slip.flags.writeable = False
    elif layout == "float32":
        slip = base.astype(np.float32)
        base = slip.astype(np.float64)
    elif layout == "int":
        slip = np.array([[0, 1]])
        base = slip.astype(np.float64)
    elif layout == "big":
        slip = base.astype(">f8")
    else:
        slip = base.tolist()
    expected = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=base)
    given = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip)
    for ours, theirs in zip(given, expected):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize(
    "bad",
    [
        "0.2",
        None,
        0.2j,
        True,
        object(),
        np.array([0.1, None], dtype=object),
        np.array(["0.1"]),
        np.array([1 + 2j]),
        np.array([True]),
        np.array(["2020-01-01"], dtype="datetime64[D]"),
        [[0.1], [0.1, 0.2]],
        {"slip": 0.1},
        b"0.1",
    ],
    ids=lambda bad: repr(bad)[:30],
)
def test_what_holds_no_numbers_is_a_type_error(bad: object) -> None:
    with pytest.raises(InputTypeError) as caught:
        wheel.under_load(SAND, **SIZE, load_n=80.0, slip=bad)
    assert caught.value.field == "slip"
    assert isinstance(caught.value, TypeError)


def test_a_bad_point_is_a_status_and_changes_no_other() -> None:
    slip = np.array([0.2, np.nan, 7.0, 0.2, -np.inf])
    points = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip)
    assert points.status.tolist() == [0, 3, 3, 0, 3]
    assert np.isnan(points.sinkage_m[[1, 2, 4]]).all()
    assert points.sinkage_m[0] == points.sinkage_m[3] == wheel.under_load(SAND, **SIZE, load_n=80.0, slip=0.2).sinkage_m
    heavy = wheel.under_load(LUNAR, **SIZE, load_n=1e9, slip=0.2)
    assert heavy.status == 1 and np.isnan(heavy.torque_nm)


def test_shapes_that_do_not_broadcast_are_named() -> None:
    with pytest.raises(InputError, match="load_n") as caught:
        wheel.under_load(SAND, **SIZE, load_n=np.ones(3), slip=np.ones(2))
    assert caught.value.field == "shape"


@pytest.mark.parametrize("threads", [0, -1, 1.5, "2", True, 10**6])
def test_a_bad_number_of_threads_is_refused(threads: object) -> None:
    with pytest.raises((InputError, InputTypeError)) as caught:
        wheel.under_load(SAND, **SIZE, load_n=80.0, slip=0.2, threads=threads)  # type: ignore[arg-type]
    assert caught.value.field == "threads"


def test_the_number_of_threads_changes_no_bit() -> None:
    rng = np.random.default_rng(7)
    slip, load = rng.uniform(-0.01, 0.95, 120_001), rng.uniform(10.0, 150.0, 120_001)
    one = wheel.under_load(SAND, **SIZE, load_n=load, slip=slip, threads=1)
    for threads in (2, 3, 8):
        many = wheel.under_load(SAND, **SIZE, load_n=load, slip=slip, threads=threads)
        for a, b in zip(one, many):
            np.testing.assert_array_equal(a, b)


def test_python_threads_share_arrays_and_objects() -> None:
    slip = np.linspace(0.0, 0.9, 50_000)
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    results: dict[int, tuple[object, object]] = {}

    def work(k: int) -> None:
        batch = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip).drawbar_pull_n
        point = contact.under_load(load_n=80.0, slip=0.2)
        assert point is not None
        results[k] = (batch, point.drawbar_pull_n)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8
    for batch, point in results.values():
        np.testing.assert_array_equal(batch, results[0][0])
        assert point == results[0][1]


def test_the_batch_and_the_single_point_agree() -> None:
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    rng = np.random.default_rng(3)
    slip, load = rng.uniform(-0.9, 0.95, 500), rng.uniform(10.0, 150.0, 500)
    batch = wheel.under_load(SAND, **SIZE, load_n=load, slip=slip)
    columns = wheel.operating_points(contact, load_n=load, slip=slip)
    for i in range(500):
        point = contact.under_load(load_n=load[i], slip=slip[i])
        assert point is not None and columns.status[i] == 0
        # the same path: the same bits
        assert columns.drawbar_pull_n[i] == point.drawbar_pull_n
        assert columns.sinkage_m[i] == point.sinkage_m
        scale = max(load[i], abs(point.drawbar_pull_n), abs(point.torque_nm) / 0.125)
        assert abs(batch.drawbar_pull_n[i] - point.drawbar_pull_n) < 1e-9 * scale
        assert abs(batch.torque_nm[i] - point.torque_nm) < 1e-9 * scale
        assert abs(batch.sinkage_m[i] - point.sinkage_m) < 1e-9 * 0.125


def test_a_curve_is_as_accurate_as_its_points() -> None:
    slip = np.linspace(0.0, 0.9, 300)
    curve = wheel.curve(SAND, wheel.Wheel(**SIZE), load_n=80.0, slip=slip)
    points = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip)
    np.testing.assert_allclose(curve.drawbar_pull_n, points.drawbar_pull_n, atol=80.0 * 2e-9, rtol=0.0)
    with pytest.raises(InputError) as caught:
        wheel.curve(SAND, wheel.Wheel(**SIZE, grouser_height_m=0.01), load_n=80.0, slip=slip)
    assert caught.value.field == "grouser_height_m" and caught.value.unit == "m"


def test_derivatives_agree_with_differences() -> None:
    h = 1e-6
    for wheel_keys in (SIZE, {**SIZE, "grouser_height_m": 0.01}):
        contact = wheel.WheelOnSoil(wheel.Wheel(**wheel_keys), SAND)
        found = wheel.jacobian(contact, load_n=80.0, slip=np.array([-0.2, 0.1, 0.5]))
        for i, slip in enumerate([-0.2, 0.1, 0.5]):

            def at(ds: float = 0.0, dr: float = 0.0, db: float = 0.0, dw: float = 0.0) -> np.ndarray:
                size = {**wheel_keys, "radius_m": 0.125 + dr, "width_m": 0.1 + db}
                here = wheel.WheelOnSoil(wheel.Wheel(**size), SAND)
                p = here.under_load(load_n=80.0 + dw, slip=slip + ds)
                assert p is not None
                return np.array([p.sinkage_m, p.drawbar_pull_n, p.torque_nm])

            steps = [{"ds": h}, {"dr": h}, {"db": h}, {"dw": 1e3 * h}]
            for k, step in enumerate(steps):
                back = {key: -value for key, value in step.items()}
                difference = (at(**step) - at(**back)) / (2 * sum(step.values()))
                ours = np.array([found.d_sinkage[i, k], found.d_drawbar_pull[i, k], found.d_torque[i, k]])
                np.testing.assert_allclose(ours, difference, rtol=2e-5, atol=1e-7)


def test_a_slip_demand_holds_its_slope() -> None:
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    slope = np.array([-5.0, 0.0, 2.0, 5.0, 60.0, np.nan])
    demand = wheel.slip_demand(contact, weight_n=80.0, slope_deg=slope)
    assert demand.status.tolist() == [0, 0, 0, 0, 1, 3]
    for alpha, slip in zip(np.radians(slope[:4]), demand.slip[:4]):
        point = contact.under_load(load_n=80.0 * np.cos(alpha), slip=slip)
        assert point is not None
        assert point.drawbar_pull_n == pytest.approx(80.0 * np.sin(alpha), abs=1e-6)


def test_slip_demands_on_lanes_and_one_by_one_agree() -> None:
    slope = np.linspace(-5.0, 25.0, 1200)  # more than a block, with slopes that nothing holds
    size = wheel.Wheel(**SIZE)
    lanes = wheel.slip_demand(wheel.WheelOnSoil(size, SAND), weight_n=80.0, slope_deg=slope, threads=2)
    exact = wheel.WheelOnSoil(size, SAND, reference_accuracy=True)
    alone = wheel.slip_demand(exact, weight_n=80.0, slope_deg=slope[::40])
    assert lanes.status[::40].tolist() == alone.status.tolist()
    assert {0, 1} == set(alone.status.tolist())
    np.testing.assert_allclose(lanes.slip[::40], alone.slip, atol=1e-7)


@pytest.mark.parametrize("of", ["pull", "efficiency"])
def test_best_slips_of_many_loads_are_those_one_by_one(of: str) -> None:
    load = np.append(np.linspace(5.0, 120.0, 1200), [np.nan, -1.0, 1e9])  # more than a block
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    found = getattr(wheel, f"slip_of_maximum_{of}")(contact, load_n=load, threads=2)
    assert found.status[-3:].tolist() == [3, 3, 1] and np.isnan(found.slip[-3:]).all()
    for i in range(0, 1200, 100):
        slip, value = getattr(contact, f"slip_of_maximum_{of}")(load_n=load[i])
        assert found.status[i] == 0
        assert found.value[i] == pytest.approx(value, abs=1e-9 * max(1.0, load[i]))
        assert found.slip[i] == pytest.approx(slip, abs=1e-4)
    exact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND, reference_accuracy=True)
    reference = getattr(wheel, f"slip_of_maximum_{of}")(exact, load_n=load[:1200:100])
    np.testing.assert_allclose(found.value[:1200:100], reference.value, atol=1e-7)


@pytest.mark.parametrize("reference", [False, True])
def test_skids_of_many_loads_are_those_one_by_one(reference: bool) -> None:
    size = wheel.Wheel(radius_m=0.05, width_m=0.03)
    contact = wheel.WheelOnSoil(size, SAND, reference_accuracy=reference)
    skid = wheel.free_slip(contact, load_n=[[2.0], [5.0]], bearing_torque_nm=[0.0, 0.01, 1.0, -1.0])
    assert skid.slip.shape == (2, 4)
    assert skid.status.tolist() == [[0, 0, 1, 3], [0, 0, 1, 3]]
    for i, load in enumerate([2.0, 5.0]):
        for j, bearing in enumerate([0.0, 0.01]):
            alone = contact.free_slip(load_n=load, bearing_torque_nm=bearing)
            assert skid.slip[i, j] == pytest.approx(alone, abs=1e-9)
    # more than a block, by two threads
    load = np.linspace(1.0, 10.0, 1200)
    assert wheel.free_slip(contact, load_n=load, threads=2).slip[-1] == pytest.approx(
        contact.free_slip(load_n=10.0, bearing_torque_nm=0.0), abs=1e-9
    )


def test_a_drifting_wheel_is_pushed_against_its_drift() -> None:
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), soils.find("lunar", unit_weight_n_per_m3=2700.0))
    points = wheel.operating_points(contact, load_n=65.0, slip=0.2, slip_angle_deg=[-20.0, 0.0, 20.0, 95.0])
    assert points.side_force_n[0] > 0.0 == points.side_force_n[1] > points.side_force_n[2]
    assert points.side_force_n[0] == -points.side_force_n[2]
    assert points.status.tolist() == [0, 0, 0, 3]


def test_slip_from_speeds_by_hand() -> None:
    slip = wheel.slip_from_speeds(forward_speed_mps=[0.08, 0.1, 0.0, -0.1], rim_speed_mps=[0.1, 0.08, 0.0, 0.1])
    np.testing.assert_allclose(slip, [0.2, -0.2, np.nan, np.nan], atol=1e-15)


def test_errors_name_field_value_limit_and_unit() -> None:
    with pytest.raises(InputError) as caught:
        wheel.Wheel(radius_m=-0.1, width_m=0.1)
    error = caught.value
    assert (error.field, error.value, error.limit, error.unit) == ("radius_m", -0.1, (0.001, 100.0), "m")
    again = pickle.loads(pickle.dumps(error))
    assert (again.field, again.value, again.limit, again.unit, str(again)) == (
        error.field,
        error.value,
        error.limit,
        error.unit,
        str(error),
    )
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    for keys in ({"load_n": float("nan"), "slip": 0.1}, {"load_n": 80.0, "slip": 1.5}, {"load_n": -1.0, "slip": 0.1}):
        with pytest.raises(InputError) as caught:
            contact.under_load(**keys)
        assert caught.value.field in keys
    with pytest.raises(InputError) as caught:
        contact.at_sinkage(sinkage_m=0.2, slip=0.1)
    assert caught.value.field == "sinkage_m" and caught.value.limit == (0.0, 0.125)
    with pytest.raises(TypeError):
        wheel.Wheel(0.1, 0.1)  # type: ignore[misc]


def test_counted_grousers_are_the_lugs_of_the_command() -> None:
    lugged = wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_count=24, grouser_thickness_m=0.002)
    assert (lugged.grouser_count, lugged.grouser_thickness_m) == (24, 0.002)
    assert pickle.loads(pickle.dumps(lugged)) == lugged
    assert eval(repr(lugged), {"Wheel": wheel.Wheel}) == lugged
    smooth = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    at = {"load_n": 80.0, "slip": 0.3}
    bars, rim = wheel.WheelOnSoil(lugged, SAND).under_load(**at), smooth.under_load(**at)
    assert bars is not None and rim is not None
    # the same point by the command:
    # grouser wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.3
    #   --grouser-height-m 0.01 --grouser-count 24 --grouser-thickness-m 0.002
    assert bars.sinkage_m > rim.sinkage_m and bars.drawbar_pull_n > rim.drawbar_pull_n
    for keys in (
        {"grouser_count": 24, "grouser_height_m": 0.01, "grouser_tip_share": 0.3},
        {"grouser_thickness_m": 0.002, "grouser_height_m": 0.01},
        {"grouser_count": 0, "grouser_height_m": 0.01},
        {"grouser_count": 24, "grouser_height_m": 0.01, "grouser_thickness_m": 1.0},
    ):
        with pytest.raises(InputError):
            wheel.Wheel(**SIZE, **keys)  # type: ignore[arg-type]


def test_everything_is_picklable() -> None:
    heavy = wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_tip_share=0.3)
    contact = wheel.WheelOnSoil(heavy, LUNAR, reference_accuracy=True, shear="slip-velocity")
    again = pickle.loads(pickle.dumps(contact))
    assert again.wheel == heavy and again.soil == LUNAR
    a = contact.under_load(load_n=65.0, slip=0.25)
    b = again.under_load(load_n=65.0, slip=0.25)
    assert a is not None and b is not None
    assert (a.drawbar_pull_n, a.torque_nm) == (b.drawbar_pull_n, b.torque_nm)
    points = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=[0.1, 0.2])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(points)).sinkage_m, points.sinkage_m)


def test_draws_of_a_soil_are_soils_of_their_own() -> None:
    rng = np.random.default_rng(1)
    draws = {
        "n": rng.uniform(0.9, 1.3, 40),
        "cohesion_kpa": rng.uniform(0.2, 2.0, 40),
        "phi_deg": rng.uniform(26.0, 36.0, 40),
        "k_shear_m": rng.uniform(0.01, 0.04, 40),
        "k_c_kn_per_m_n1": rng.uniform(0.5, 1.5, 40),
        "k_phi_kn_per_m_n2": rng.uniform(1200.0, 1800.0, 40),
        "c_1": rng.uniform(0.1, 0.3, 40),
        "c_2": rng.uniform(0.2, 0.4, 40),
    }
    found = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=0.3, draws=draws, threads=2)
    forces = wheel.at_sinkage(SAND, **SIZE, sinkage_m=found.sinkage_m, slip=0.3, draws=draws)
    for i in range(40):
        soil = soils.Soil(name="draw", **{key: float(values[i]) for key, values in draws.items()})
        alone = wheel.under_load(soil, **SIZE, load_n=80.0, slip=0.3)
        assert found.sinkage_m[i] == pytest.approx(alone.sinkage_m, rel=1e-9)
        assert found.drawbar_pull_n[i] == pytest.approx(alone.drawbar_pull_n, abs=1e-7)
        assert forces.torque_nm[i] == pytest.approx(alone.torque_nm, rel=1e-8)
    # one number for all points, against each slip; a bad draw concerns its point alone
    table = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=[[0.1], [0.3]], draws={"phi_deg": [30.0, 95.0, 33.0]})
    assert table.status.tolist() == [[0, 3, 0]] * 2
    same = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=0.1, draws={"phi_deg": 33})
    assert same.drawbar_pull_n == pytest.approx(table.drawbar_pull_n[0, 2], abs=1e-9)
    with pytest.raises(InputError, match="n_1 is no number that differs by point"):
        wheel.under_load(SAND, **SIZE, load_n=80.0, slip=0.1, draws={"n_1": 0.2})


def test_cautions_of_points_are_those_of_single_points() -> None:
    rng = np.random.default_rng(2)
    slip = np.linspace(-0.9, 0.95, 30)
    load = np.array([[20.0], [150.0], [400.0]])
    draws = {"c_1": rng.uniform(-0.3, 0.6, 30), "c_2": rng.uniform(0.0, 0.8, 30)}
    for given in (None, draws):
        points = wheel.under_load(SAND, **SIZE, load_n=load, slip=slip, draws=given)
        found = wheel.cautions(SAND, points, **SIZE, slip=slip, draws=given)
        assert len(found) > 1 and all(mask.shape == (3, 30) and mask.any() for mask in found.values())
        for j in range(30):
            soil = SAND if given is None else soils.Soil(
                name="draw",
                n=SAND.n,
                k_c_kn_per_m_n1=SAND.k_c_kn_per_m_n1,
                k_phi_kn_per_m_n2=SAND.k_phi_kn_per_m_n2,
                cohesion_kpa=SAND.cohesion_kpa,
                phi_deg=SAND.phi_deg,
                k_shear_m=SAND.k_shear_m,
                c_1=float(draws["c_1"][j]),
                c_2=float(draws["c_2"][j]),
            )
            contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), soil)
            for i in range(3):
                have = {key for key, mask in found.items() if mask[i, j]}
                if points.status[i, j] != 0:
                    assert have == set()
                    continue
                alone = contact.at_sinkage(sinkage_m=float(points.sinkage_m[i, j]), slip=float(slip[j]))
                assert have == set(alone.cautions), (i, j)
    # one point alone, and none
    one = wheel.under_load(SAND, **SIZE, load_n=400.0, slip=0.9)
    assert wheel.cautions(SAND, one, **SIZE, slip=0.9)["deep-sinkage"]
    none = wheel.under_load(SAND, **SIZE, load_n=400.0, slip=np.empty(0))
    assert wheel.cautions(SAND, none, **SIZE, slip=np.empty(0)) == {}
    with pytest.raises(InputError, match="do not broadcast"):
        wheel.cautions(SAND, points, **SIZE, slip=[0.1, 0.2])
    with pytest.raises(InputTypeError):
        wheel.cautions(SAND, one.sinkage_m, **SIZE, slip=0.9)  # type: ignore[arg-type]


def test_a_point_without_derivatives_is_bad_input() -> None:
    loads = np.array([0.0, -0.0, 5e-324, 1e-300, 1e-30, 1e-9, 1.0, 80.0])
    for slip in (-0.3, 0.0, 0.2, 1.0):
        found = wheel.jacobian(wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), SAND), load_n=loads, slip=slip)
        assert found.status[:2].tolist() == [3, 3] and found.status[-3:].tolist() == [0, 0, 0]
        for numbers in list(found.values())[1:]:
            is_finite = np.isfinite(numbers).reshape(loads.size, -1)
            assert is_finite[found.status == 0].all() and not is_finite[found.status != 0].any()


def test_columns_of_packed_records_are_read() -> None:
    packed = np.zeros(3, dtype=[("name", "u1"), ("load_n", "f8"), ("slip", "f8")])
    packed["load_n"], packed["slip"] = [40.0, 60.0, 80.0], [0.1, 0.2, 0.3]
    load, slip = packed["load_n"], packed["slip"]
    assert not load.flags.aligned
    found = wheel.under_load(SAND, **SIZE, load_n=load, slip=slip)
    aligned = wheel.under_load(SAND, **SIZE, load_n=load.copy(), slip=slip.copy())
    assert np.array_equal(found.sinkage_m, aligned.sinkage_m)
    one = wheel.curve(SAND, wheel.Wheel(**SIZE), load_n=80.0, slip=slip)
    assert np.array_equal(one.sinkage_m, wheel.curve(SAND, wheel.Wheel(**SIZE), load_n=80.0, slip=slip.copy()).sinkage_m)


def test_what_is_masked_is_missing() -> None:
    masked = np.ma.masked_array([0.1, 0.2, 0.3], mask=[False, True, False])
    for slip in (masked, masked.astype(np.float32), [masked[:1], masked[1:2], masked[2:]]):
        found = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip)
        assert np.isnan(np.ravel(found.sinkage_m)).tolist() == [False, True, False]
    whole = np.ma.masked_array([40, 60], mask=[False, True])
    assert np.isnan(wheel.under_load(SAND, **SIZE, load_n=whole, slip=0.2).sinkage_m).tolist() == [False, True]
