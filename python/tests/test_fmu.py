"""Co-simulation units in FMPy: what the standard demands, and the numbers of `wheel`."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from ctypes import byref, c_bool, c_double, c_size_t, c_uint32, c_void_p
from pathlib import Path
from typing import Any

import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed: pip install fmpy")
LIBRARY = os.environ.get("GROUSER_FMU_LIBRARY", "")
pytestmark = [
    pytest.mark.skipif(not LIBRARY, reason="GROUSER_FMU_LIBRARY names no library: cargo build --release -p grouser-fmu"),
    pytest.mark.filterwarnings("default"),  # FMPy's own
]

from grouser import InputError, commands, soils, wheel  # noqa: E402

SIZE = {"radius_m": 0.125, "width_m": 0.1}
OUTPUTS = ["sinkage_m", "drawbar_pull_n", "side_force_n", "torque_nm"]
OK, WARNING, DISCARD, ERROR = range(4)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fmu") / "front_wheel_1.fmu"
    lugs = {"grouser_height_m": 0.01, "grouser_count": 24, "grouser_thickness_m": 0.002}
    made = commands.fmu(
        soil="dry-sand", **SIZE, **lugs, rebound=0.1, load_n=80.0, slip=0.2, library=LIBRARY, output=str(path)
    )
    assert made["model"] == "front_wheel_1" and made["bytes"] == path.stat().st_size
    return path


def lugged() -> wheel.WheelOnSoil:
    lugs = {"grouser_height_m": 0.01, "grouser_count": 24, "grouser_thickness_m": 0.002}
    return wheel.WheelOnSoil(wheel.Wheel(**SIZE, **lugs), soils.find("dry-sand").with_rebound(rebound=0.1))


def test_nothing_is_found_by_the_validation(path: Path) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(path)) == []


def test_a_simulation_has_the_numbers_of_the_wheel(path: Path) -> None:
    rng = np.random.default_rng(3)
    count = 200
    given = np.zeros(count, dtype=[(name, float) for name in ("time", "load_n", "slip", "slip_angle_deg")])
    given["time"] = 0.01 * np.arange(count)
    given["load_n"] = rng.uniform(5.0, 120.0, count)
    given["slip"] = rng.uniform(-0.5, 0.95, count)
    given["slip_angle_deg"] = np.where(np.arange(count) % 2, rng.uniform(-40.0, 40.0, count), 0.0)
    contact = lugged()
    instance = Instance(path)
    try:
        for row in given:
            instance.set([row["load_n"], row["slip"], row["slip_angle_deg"]])
            assert instance.step(float(row["time"]), 0.01) == OK
            found = instance.get(4, 5, 6, 7)
            expected = contact.result(load_n=row["load_n"], slip=row["slip"], slip_angle_deg=row["slip_angle_deg"])
            assert found == [expected[name] for name in OUTPUTS]
    finally:
        instance.free()


def test_fmpy_simulates_it(path: Path) -> None:
    result = fmpy.simulate_fmu(str(path), stop_time=1.0, output_interval=0.1, start_values={"load_n": 60.0})
    expected = lugged().result(load_n=60.0, slip=0.2)
    assert len(result) == 11
    for name in OUTPUTS:
        np.testing.assert_array_equal(result[name], expected[name])
    assert (result["status"] == 0).all()
    assert not result["caution_hub_in_soil"].any()


def test_no_solution_is_a_status_without_numbers(path: Path) -> None:
    instance = Instance(path)
    try:
        instance.set([1e7, 0.2, 0.0])
        assert instance.step(0.0, 0.1) == WARNING
        assert np.isnan(instance.get(4, 5, 6, 7)).all()
        assert instance.directional([5], [2], [1.0])[0] == DISCARD
        with pytest.raises(Exception, match="3"):
            instance.set([80.0, 2.0, 0.0])
        instance.set([80.0, 0.9, 0.0])
        assert instance.step(0.1, 0.1) == OK and np.isfinite(instance.get(4, 5, 6, 7)).all()
    finally:
        instance.free()


def test_derivatives_are_those_of_the_wheel(path: Path) -> None:
    instance = Instance(path)
    try:
        instance.set([80.0, 0.2, 10.0])
        rows = []
        for known in (1, 2, 3):
            status, column = instance.directional([4, 5, 6, 7], [known], [1.0])
            assert status == OK
            rows.append(column)
        for known, row in zip((0, 1, 2), rows):
            step = (1e-3, 1e-6, 1e-4)[known]
            ends = []
            for sign in (1.0, -1.0):
                inputs = [80.0, 0.2, 10.0]
                inputs[known] += sign * step
                instance.set(inputs)
                ends.append(np.array(instance.get(4, 5, 6, 7)))
            np.testing.assert_allclose(row, (ends[0] - ends[1]) / (2.0 * step), rtol=1e-4, atol=1e-6)
    finally:
        instance.free()


def test_states_are_kept(path: Path) -> None:
    instance = Instance(path)
    unit = instance.unit
    try:
        instance.set([80.0, 0.2, 0.0])
        instance.step(0.0, 0.1)
        before = instance.get(0, 4, 5, 6, 7)
        state = unit.getFMUState()
        instance.set([30.0, 0.6, 5.0])
        instance.step(0.1, 0.1)
        unit.setFMUState(state)
        assert instance.get(0, 4, 5, 6, 7) == before
        unit.freeFMUState(state)
        unit.reset()
        with pytest.raises(Exception, match="DoStep"):
            unit.doStep(0.0, 0.1)
    finally:
        instance.free()


def test_every_function_of_the_standard_is_there(path: Path) -> None:
    header = Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h"
    names = {word for word in header.read_text().replace(";", " ").split() if word.startswith("fmi3") and word.isalnum()}
    names = {name for name in names if not name.endswith(("TYPE", "Name")) and f"FMI3_Export {name}TYPE" in header.read_text()}
    instance = Instance(path)
    try:
        assert len(names) > 70
        assert [name for name in sorted(names) if not hasattr(instance.unit.dll, name)] == []
        with pytest.raises(Exception, match="EnterEventMode"):
            instance.unit.enterEventMode()
    finally:
        instance.free()


def test_resources_of_another_unit_are_refused(path: Path, tmp_path: Path) -> None:
    folder = Path(fmpy.extract(str(path), str(tmp_path / "unit")))
    text = (folder / "modelDescription.xml").read_text()
    (folder / "modelDescription.xml").write_text(text.replace('instantiationToken="', 'instantiationToken="not-'))
    with pytest.raises(Exception, match="[Ii]nstantiate"):
        Instance(folder)


def test_what_is_no_library_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no library"):
        commands.fmu(soil="dry-sand", **SIZE, library=__file__.replace("test_fmu", "conftest"), output=str(tmp_path / "a.fmu"))
    ended = subprocess.run(
        [sys.executable, "-m", "grouser", "fmu", "--soil", "dry-sand", "--radius-m", "0.1", "--width-m", "0.1", "-o", "a.fmu"],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert ended.returncode == 2 and "--library" in ended.stderr


def test_steps_per_second(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    instance = Instance(path)
    try:
        began, count = time.process_time(), 2000
        for k in range(count):
            instance.set([60.0 + 0.01 * k, 0.2, 0.0])
            instance.step(0.01 * k, 0.01)
        with capsys.disabled():
            print(f"fmu: {count / (time.process_time() - began):.0f} steps per second of processor time")
    finally:
        instance.free()


class Instance:
    """A unit in step mode."""

    def __init__(self, path: Path) -> None:
        from fmpy.fmi3 import FMU3Slave

        description = fmpy.read_model_description(str(path))
        folder = path if path.is_dir() else Path(fmpy.extract(str(path)))
        self.unit: Any = FMU3Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.unit.instantiate()
        self.unit.enterInitializationMode()
        self.unit.exitInitializationMode()

    def set(self, inputs: list[float]) -> None:
        self.unit.setFloat64([1, 2, 3], inputs)

    def get(self, *references: int) -> list[float]:
        return list(self.unit.getFloat64(list(references)))

    def step(self, time_s: float, step_s: float) -> int:
        """Of the function itself: FMPy takes a warning as done."""
        flags = [c_bool() for _ in range(3)]
        return int(
            self.unit.dll.fmi3DoStep(
                c_void_p(self.unit.component), c_double(time_s), c_double(step_s), True, *map(byref, flags), byref(c_double())
            )
        )

    def directional(self, unknowns: list[int], knowns: list[int], seed: list[float]) -> tuple[int, list[float]]:
        product = (c_double * len(unknowns))()
        references = [(c_uint32 * len(of))(*of) for of in (unknowns, knowns)]
        status = self.unit.dll.fmi3GetDirectionalDerivative(
            c_void_p(self.unit.component),
            references[0],
            c_size_t(len(unknowns)),
            references[1],
            c_size_t(len(knowns)),
            (c_double * len(seed))(*seed),
            c_size_t(len(seed)),
            product,
            c_size_t(len(product)),
        )
        return int(status), list(product)

    def free(self) -> None:
        self.unit.freeInstance()
