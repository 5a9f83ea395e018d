"""The Python package beside numba, in one run on one core: a million sinkages under a load, with the same rules,
and what the package costs before it computes.

    python bench/python.py

needs the package, numpy, scipy, numba and jax. Accuracy first: both are compared with the reference mode on a
sample; the check sums are of the stored drawbar pulls.
"""

import hashlib
import os
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import rivals  # noqa: E402  (pins one core before numba loads)
import numpy as np  # noqa: E402

import grouser  # noqa: E402
from grouser import soils, wheel  # noqa: E402

POINTS = 1_000_000
KEY = "dry-sand"


def points():
    """Wheels, loads and slips inside the range of both: a sinkage below half the radius."""
    rng = np.random.default_rng(2012)
    radius, width = rng.uniform(0.05, 0.35, POINTS), rng.uniform(0.03, 0.3, POINTS)
    slip = rng.uniform(0.0, 0.9, POINTS)
    sinkage = rng.uniform(0.01, 0.35, POINTS) * radius
    at = wheel.at_sinkage(soils.find(KEY), radius_m=radius, width_m=width, sinkage_m=sinkage, slip=slip, threads=1)
    return radius, width, slip, at.vertical_force_n


def as_rows(soil, radius, width, slip, load):
    """The rivals' terms."""
    given = rivals.Soil.__new__(rivals.Soil)
    given.soil = {
        "k_c": 1e3 * soil.k_c_kn_per_m_n1,
        "k_phi": 1e3 * soil.k_phi_kn_per_m_n2,
        "n": soil.n,
        "c": 1e3 * soil.cohesion_kpa,
        "phi": np.radians(soil.phi_deg),
        "k_shear": soil.k_shear_m,
        "c_1": soil.c_1,
        "c_2": soil.c_2,
    }
    given.n = soil.n
    given.rules = rivals.tables(soil.n)
    given.p = given.parameters(radius, width, slip)
    given.start = given.begin(load, radius, width)
    return given


def processor_time(job, rounds):
    times = []
    for _ in range(rounds):
        began = time.process_time()
        job()
        times.append(time.process_time() - began)
    return sorted(times)[rounds // 2]


def import_time(statement, rounds=9):
    """Median seconds of an import in a fresh interpreter, by its own clock."""
    code = f"import time; a = time.perf_counter(); {statement}; print(time.perf_counter() - a)"
    times = [float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout) for _ in range(rounds)]
    return sorted(times)[rounds // 2]


def main():
    soil = soils.find(KEY)
    radius, width, slip, load = points()
    given = as_rows(soil, radius, width, slip, load)
    out = np.empty((POINTS, 3))

    def by_numba():
        rivals.numba_solve_all(load, given.start, given.p, given.n, *given.rules, out, False)

    def by_grouser():
        return wheel.under_load(soil, radius_m=radius, width_m=width, load_n=load, slip=slip, threads=1)

    by_numba()
    ours = by_grouser()
    assert (ours.status == 0).all()
    some = np.arange(0, POINTS, 5000)
    worst = {"grouser": 0.0, "numba": 0.0}
    for i in some:
        rim = wheel.Wheel(radius_m=radius[i], width_m=width[i])
        exact = wheel.WheelOnSoil(rim, soil, reference_accuracy=True).under_load(load_n=load[i], slip=slip[i])
        scale = max(load[i], abs(exact.drawbar_pull_n), abs(exact.torque_nm) / radius[i])
        for name, pull in (("grouser", ours.drawbar_pull_n[i]), ("numba", out[i, 1])):
            worst[name] = max(worst[name], abs(pull - exact.drawbar_pull_n) / scale)
    seconds = {"grouser": processor_time(by_grouser, 5), "numba": processor_time(by_numba, 3)}
    sums = {"grouser": ours.drawbar_pull_n, "numba": out[:, 1]}
    for name in ("grouser", "numba"):
        check = hashlib.sha256(np.ascontiguousarray(sums[name]).tobytes()).hexdigest()[:12]
        print(
            f"{name}: {seconds[name]:.3f} s of processor time for {POINTS} solves, "
            f"{seconds[name] / seconds['grouser']:.1f} x, worst error of {some.size} {worst[name]:.1e}, {check}"
        )
    alone, both = import_time("import numpy"), import_time("import numpy, grouser")
    print(f"import: {1e3 * (both - alone):.1f} ms beyond NumPy's {1e3 * alone:.1f} ms")
    module = next(Path(grouser.__file__).parent.glob("_core*.so"))
    print(f"extension module: {module.stat().st_size / 1e6:.2f} MB; lanes on {wheel.instructions(soil)}; load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
