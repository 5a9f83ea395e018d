"""The optimiser beside its rivals, in one run on one core: basin and SciPy's SLSQP over the published
minimax problems, pymoo over ZDT1 and DTLZ2.

    pip install numpy scipy pymoo
    cargo build --release --manifest-path bench/opt/Cargo.toml
    python bench/opt/rivals.py

Prints the tables and writes them to bench/opt/RESULTS.md with the date and the processor. Accuracy comes
first: a time counts only beside the value that it reached.
"""

import csv
import datetime
import io
import os
import platform
import subprocess
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import pymoo  # noqa: E402
import scipy  # noqa: E402
from pymoo.algorithms.moo.nsga2 import NSGA2  # noqa: E402
from pymoo.algorithms.moo.nsga3 import NSGA3  # noqa: E402
from pymoo.indicators.hv import HV  # noqa: E402
from pymoo.optimize import minimize as pymoo_minimize  # noqa: E402
from pymoo.problems import get_problem  # noqa: E402
from pymoo.util.ref_dirs import get_reference_directions  # noqa: E402
from scipy.optimize import minimize  # noqa: E402

from problems import PROBLEMS  # noqa: E402

HERE = Path(__file__).parent
OURS = HERE / "target" / "release" / "grouser-opt-bench"


def ours(*arguments):
    """Our program's table, on one thread."""
    environment = dict(os.environ, RAYON_NUM_THREADS="1")
    text = subprocess.run(
        [OURS, *arguments], check=True, capture_output=True, text=True, env=environment
    ).stdout
    return list(csv.DictReader(io.StringIO(text)))


def epigraph(problem):
    """The problem in (x, gamma) for SLSQP, with exact derivatives by complex step."""
    f, n = problem["functions"], len(problem["start"])
    signs = (1.0, -1.0) if problem["absolute"] else (1.0,)
    counts = {"jacobians": 0}

    def slopes(x):
        counts["jacobians"] += 1
        step = 1e-30
        columns = []
        for i in range(n):
            moved = x.astype(complex)
            moved[i] += 1j * step
            columns.append(f(moved).imag / step)
        return np.array(columns).T

    def rows(v):
        values = f(v[:n]).real
        return np.concatenate([v[n] - sign * values for sign in signs])

    def row_slopes(v):
        jacobian = slopes(v[:n])
        level = np.ones((jacobian.shape[0], 1))
        return np.vstack([np.hstack([-sign * jacobian, level]) for sign in signs])

    constraints = [{"type": "ineq", "fun": rows, "jac": row_slopes}]
    for a, low, high in problem["rows"]:
        full = np.append(a, 0.0)
        if low == high:
            constraints.append(
                {"type": "eq", "fun": lambda v, a=full, b=low: a @ v - b, "jac": lambda v, a=full: a}
            )
            continue
        if np.isfinite(low):
            constraints.append(
                {"type": "ineq", "fun": lambda v, a=full, b=low: a @ v - b, "jac": lambda v, a=full: a}
            )
        if np.isfinite(high):
            constraints.append(
                {"type": "ineq", "fun": lambda v, a=full, b=high: b - a @ v, "jac": lambda v, a=full: -a}
            )
    return constraints, counts


def scipy_slsqp(problem):
    n = len(problem["start"])
    values = problem["functions"](problem["start"])
    level = np.max(np.abs(values) if problem["absolute"] else values)
    last = np.append(np.zeros(n), 1.0)
    bounds = [*zip(problem["lower"], problem["upper"]), (-np.inf, np.inf)]
    best = np.inf
    for _ in range(3):
        constraints, counts = epigraph(problem)
        begin = time.process_time()
        found = minimize(
            lambda v: v[n],
            np.append(problem["start"], level),
            jac=lambda v: last,
            bounds=bounds,
            constraints=constraints,
            method="SLSQP",
            options={"ftol": 1e-12, "maxiter": 1000},
        )
        best = min(best, time.process_time() - begin)
    values = problem["functions"](found.x[:n])
    maximum = np.max(np.abs(values) if problem["absolute"] else values)
    return maximum, counts["jacobians"], 1e6 * best


def minimax_table():
    lines = [
        "| problem | Grouser: Jacobians | µs | basin: Jacobians | µs | SciPy SLSQP: Jacobians | µs | off: Grouser | basin | SciPy |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    sums = np.zeros(6)
    for row in ours():
        maximum, jacobians, microseconds = scipy_slsqp(PROBLEMS[row["problem"]])
        optimum = float(row["optimum"])
        numbers = [
            float(row["ours_jacobians"]),
            float(row["ours_us"]),
            float(row["basin_jacobians"]),
            float(row["basin_us"]),
            jacobians,
            microseconds,
        ]
        sums += numbers

        def off(value):
            error = abs(float(value) - optimum) / (1 + abs(optimum))
            return f"{error:.0e}" + ("" if error <= 1e-6 else " **miss**")

        shown = [f"{v:.0f}" for v in numbers]
        lines.append(
            f"| {row['problem']} | {' | '.join(shown)} | {off(row['ours'])} | {off(row['basin'])} | {off(maximum)} |"
        )
    lines.append(f"| together | {' | '.join(f'**{v:.0f}**' for v in sums)} | | | |")
    return lines


def front_table():
    rows = {row["problem"]: row for row in ours("fronts")}
    directions = get_reference_directions("das-dennis", 3, n_partitions=12)
    rivals = {
        "ZDT1": (get_problem("zdt1"), NSGA2(pop_size=100), [1.1, 1.1]),
        "DTLZ2": (
            get_problem("dtlz2", n_var=12, n_obj=3),
            NSGA3(ref_dirs=directions, pop_size=92),
            [1.1, 1.1, 1.1],
        ),
    }
    lines = [
        "| problem | hypervolume: pymoo | Grouser | Grouser, polished | CPU s: pymoo | Grouser | Grouser, polished | ratio | ratio with polishing |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name, (problem, algorithm, reference) in rivals.items():
        seconds = np.inf
        for _ in range(3):
            begin = time.process_time()
            found = pymoo_minimize(problem, algorithm, ("n_gen", 250), seed=1, verbose=False)
            seconds = min(seconds, time.process_time() - begin)
        volume = HV(ref_point=np.array(reference))(found.F)
        row = rows[name]
        raw, polished = float(row["seconds"]), float(row["seconds_polished"])
        lines.append(
            f"| {name} | {volume:.4f} | {float(row['volume']):.4f} | {float(row['volume_polished']):.5f} "
            f"| {seconds:.2f} | {raw:.3f} | {polished:.3f} | {seconds / raw:.0f} × | {seconds / polished:.0f} × |"
        )
    return lines


def processor():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def main():
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    text = [
        "# The optimiser beside its rivals",
        "",
        f"{datetime.date.today()}, {processor()}, load {load:.1f}; one core each. SciPy {scipy.__version__}, "
        f"pymoo {pymoo.__version__}, basin 3.2.0. Times are the best of several runs.",
        "",
        "## Published minimax problems from their published starts",
        "",
        "Off: |value − published| / (1 + |published|); published values have eight digits. Derivatives are exact "
        "for all three.",
        "",
        *minimax_table(),
        "",
        "## Fronts: population 100 and 92, 250 generations, reference point 1.1",
        "",
        *front_table(),
        "",
    ]
    (HERE / "RESULTS.md").write_text("\n".join(text))
    print("\n".join(text))


if __name__ == "__main__":
    main()
