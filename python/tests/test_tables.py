"""Results and inputs as users of pandas, polars and pyarrow have them."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from grouser import InputError, InputTypeError, commands, drive, identify, logs, soils, wheel

ROOT = Path(__file__).parents[2]
FIVE = ROOT / "examples" / "five-wheel"
SIZE = {"radius_m": 0.1, "width_m": 0.08}


def test_results_are_tables() -> None:
    points = wheel.under_load("dry-sand", **SIZE, load_n=[40.0, 60.0, 80.0], slip=[0.1, 0.2, 0.3])
    names = ["status", "sinkage_m", "vertical_force_n", "drawbar_pull_n", "torque_nm"]
    for frame in (pd.DataFrame(points), pd.DataFrame(points._asdict()), points.to_frame()):
        assert list(frame.columns) == names and len(frame) == 3
        np.testing.assert_array_equal(frame["torque_nm"], points.torque_nm)
    for table in (pl.DataFrame(points), points.to_frame("polars"), pl.DataFrame(pa.table(points))):
        assert table.columns == names and table.height == 3
    assert pa.table(points).column_names == names
    assert pa.RecordBatchReader.from_stream(points).read_all().num_rows == 3
    assert "<td>" in points._repr_html_() and "torque_nm" in repr(points)
    again = pickle.loads(pickle.dumps(points))
    assert type(again) is type(points)
    np.testing.assert_array_equal(again.torque_nm, points.torque_nm)
    with pytest.raises(AttributeError, match="did you mean `sinkage_m`"):
        points.sinkage  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="polars"):
        points.to_frame("excel")


def test_a_row_has_a_column_for_each_derivative() -> None:
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), soils.find("dry-sand"))
    found = wheel.jacobian(contact, load_n=[[40.0, 60.0]], slip=0.2)
    frame = found.to_frame()
    assert len(frame) == 2 and list(frame.columns[-4:]) == [f"d_torque_{k}" for k in range(4)]
    np.testing.assert_array_equal(frame["d_torque_3"], found.d_torque[0, :, 3])


def test_one_point_is_one_row() -> None:
    assert len(wheel.under_load("dry-sand", **SIZE, load_n=60.0, slip=0.2).to_frame()) == 1


def test_soils_by_key_file_and_object_are_the_same(tmp_path: Path) -> None:
    file = tmp_path / "sand.toml"
    file.write_text(soils.find("dry-sand").to_toml())
    sands = ("dry-sand", soils.find("dry-sand"), file, str(file))
    pulls = {float(wheel.under_load(sand, **SIZE, load_n=60.0, slip=0.2).drawbar_pull_n) for sand in sands}
    assert len(pulls) == 1
    with pytest.raises(InputError, match="dry-sand"):
        wheel.under_load("dry-snad", **SIZE, load_n=60.0, slip=0.2)
    with pytest.raises(InputTypeError, match="a key of the catalogue"):
        wheel.under_load(3, **SIZE, load_n=60.0, slip=0.2)  # type: ignore[arg-type]


def test_a_log_is_a_path_or_a_frame() -> None:
    given = {"columns": FIVE / "columns.toml"}
    whole = logs.estimate(FIVE / "log.csv", FIVE / "robot.toml", **given)
    frame = pd.read_csv(FIVE / "log.csv")
    columns = {name: frame[name].to_numpy() for name in frame}
    for log in (frame, pl.read_csv(FIVE / "log.csv"), pa.Table.from_pandas(frame), columns):
        rows = logs.estimate(log, logs.Robot.read(FIVE / "robot.toml"), **given).rows
        np.testing.assert_array_equal(rows.slip, whole.rows.slip)
    assert len(pd.DataFrame(whole.rows)) == len(whole.rows.slip) == pl.DataFrame(whole.rows).height
    with pytest.raises(InputError, match="differ in length"):
        logs.estimate({"time_ms": [0.0, 1.0], "count": [0.0]}, FIVE / "robot.toml", **given)


def test_a_drive_s_track_is_a_table() -> None:
    track = drive.run(ROOT / "examples" / "scenarios" / "sandbox.toml", duration_s=0.5).track
    frame = track.to_frame()
    assert len(frame) == len(track["time_s"]) and {"slip_0", "slip_4"} <= set(frame.columns)


def test_a_job_of_frames_is_the_job_file() -> None:
    folder = ROOT / "examples" / "bevameter"
    fit = ["c_1", "c_2", "n_1", "sinkage_datum_m"]
    job = {
        "name": "Sand of the bevameter example",
        "plate": [{"table": pd.read_csv(folder / "plates.csv")}],
        "shear": {"table": pl.read_csv(folder / "shear.csv")},
        "wheel": {
            "table": folder / "wheel.csv",
            "radius_m": 0.10,
            "width_m": 0.06,
            "fit": fit,
            "pull_scatter_n": 0.4,
            "torque_scatter_nm": np.float64(0.03),
            "sinkage_scatter_m": 0.0004,
            "intervals": "profile",
        },
    }
    assert identify.run(job) == identify.run(folder / "tests.toml")
    with pytest.raises(InputError, match="no value of a job"):
        identify.run({"plate": [{"table": folder / "plates.csv", "width_m": None}]})


def test_verbs_of_the_command_are_functions() -> None:
    found = commands.climb(soil="dry-sand", radius_m=0.125, width_m=0.1, load_n=80.0, max_slip=0.5)
    held = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), soils.find("dry-sand"))
    slip = wheel.slip_demand(held, weight_n=80.0, slope_deg=found["steepest_slope_deg"] - 1e-6).slip
    assert abs(float(slip) - 0.5) < 1e-3
    with pytest.raises(InputError, match="radius") as caught:
        commands.climb(soil="dry-sand", radius_m=-1.0, width_m=0.1, load_n=80.0)
    assert caught.value.value == -1.0 and caught.value.unit == "m"
    with pytest.raises(InputError, match="grouser climb --help"):
        commands.climb(sand=1)


def test_a_call_that_does_not_fit_says_what_to_write() -> None:
    sand = soils.find("dry-sand")
    with pytest.raises(InputTypeError, match=r"by keyword: radius_m=…, width_m=…, load_n=…, slip=…"):
        wheel.under_load(sand, 0.1, 0.08, 60, 0.2)  # type: ignore[misc]
    with pytest.raises(InputTypeError, match=r"needs slip=…"):
        wheel.under_load(sand, **SIZE, load_n=60)  # type: ignore[call-arg]
    with pytest.raises(InputTypeError, match=r"no `widht_m`; did you mean `width_m`\?"):
        wheel.under_load(sand, radius_m=0.1, widht_m=0.08, load_n=60, slip=0.2)  # type: ignore[call-arg]
    with pytest.raises(InputTypeError, match=r"operating_points"):
        wheel.under_load(sand, **SIZE, load_n=60, slip=0.2, grouser_height_m=0.01)  # type: ignore[call-arg]
    assert "under_load" in dir(wheel) and "np" not in dir(wheel)


def test_lugs_braking_and_drift_are_arrays() -> None:
    lugs = wheel.Wheel(**SIZE, grouser_height_m=0.01, grouser_count=20)
    contact = wheel.WheelOnSoil(lugs, soils.find("dry-sand"))
    points = wheel.operating_points(contact, load_n=60.0, slip=[-0.3, 0.3], slip_angle_deg=[[0.0], [20.0]])
    assert points.torque_nm.shape == (2, 2) and (points.torque_nm[:, 0] < 0.0).all()
    assert (points.side_force_n[1] < 0.0).all() and len(points.to_frame()) == 4
