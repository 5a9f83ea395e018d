"""The shipped problems with bounds under global optimisers, in one run: SciPy's SLSQP from many starts, differential evolution,
SHGO and DIRECT, pymoo's GA and DE, and Grouser from its eight starts and with its proof.

    pip install numpy scipy pymoo ./python
    python bench/opt/global_rivals.py

All rivals minimise the same function of the variables, whose wheel is computed by the same library, and have the same bounds. A
rival's time and evaluations count until it first has a feasible value within the gap of 1e-6 (1 + |f|) of the best value that
anyone found; a solver that never gets there is shown with what it lacks. Feasible: constraints to 1e-8 of their limits. Writes
bench/opt/GLOBAL_RESULTS.md. `GROUSER` names another program than the `grouser` of the path.
"""

import datetime
import json
import os
import subprocess
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("RAYON_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import pymoo  # noqa: E402
import scipy  # noqa: E402
from pymoo.algorithms.soo.nonconvex.de import DE  # noqa: E402
from pymoo.algorithms.soo.nonconvex.ga import GA  # noqa: E402
from pymoo.core.problem import ElementwiseProblem  # noqa: E402
from pymoo.optimize import minimize as pymoo_minimize  # noqa: E402
from scipy import optimize as so  # noqa: E402
from scipy.stats import qmc  # noqa: E402

from grouser import soils, wheel  # noqa: E402
from rivals import processor  # noqa: E402

HERE = Path(__file__).parent
PROBLEMS = HERE.parent.parent / "examples" / "problems"
GAP = 1e-6
FEASIBLE = 1e-8
SECONDS = 8.0
SEED = 1


def contact(soil, radius, width, slip, load):
    """Forces of a smooth wheel; NaN where it is not carried."""
    try:
        return wheel.under_load(soil, radius_m=radius, width_m=width, load_n=load, slip=slip)
    except Exception:  # a size outside the limits of the laws
        return None


DRY = soils.find("dry-sand")
THREE = [soils.find(key) for key in ("dry-sand", "sandy-loam", "lunar")]


def paper(x):
    r, z, theta, phi, c, k_c, k_phi, b, n = x
    theta, phi = np.radians(theta), np.radians(phi)
    tau = c * 1e3 + (k_c / b + k_phi) * 1e3 * z**n * np.tan(phi)
    theta_1 = np.arccos(np.clip(1 - z / r, -1, 1))
    depth = r * (np.cos(theta) - np.cos(theta_1))
    sigma = (k_c / b + k_phi) * 1e3 * depth**n if depth > 0 and abs(theta) <= theta_1 else 0.0
    strength = c * 1e3 + sigma * np.tan(phi)
    lever = np.sin(theta_1) - np.sin(theta)
    s_0 = 1 - (theta_1 - theta) / lever if abs(lever) > 1e-12 else 1 - 1 / np.cos(theta_1)
    return max(1e4 / tau, 1e4 / strength, abs(s_0)), [np.degrees(theta_1) / 45 - x[2] / 45]


def running_slip(x):
    p = contact(DRY, 0.125, 0.10, x[0], 60.0)
    grade = np.degrees(np.arctan(p.drawbar_pull_n / p.vertical_force_n))
    q = 1 - x[0]
    return float(-p.drawbar_pull_n * q * 0.125 / p.torque_nm), [float(grade) / 3 - 1]


def dry_sand_wheel(x):
    r, b, s = x
    p = contact(DRY, r, b, s, 100.0)
    pull = p.drawbar_pull_n / p.vertical_force_n
    efficiency = p.drawbar_pull_n * (1 - s) * r / p.torque_nm
    mass = 2700 * 2 * np.pi * r * b * 0.003 + 0.4
    gamma = max((0.15 - pull) / 0.05, (0.35 - efficiency) / 0.1, (mass - 1.2) / 0.4)
    return float(gamma), [
        float(1 - p.sinkage_m / (0.2 * r)),
        float(1 - p.torque_nm / 8),
        float(1 - b / (1.5 * r)),
    ]


def robust_wheel(x):
    r, b, s = x
    worst, limits = -np.inf, []
    for soil in THREE:
        p = contact(soil, r, b, s, 80.0)
        pull = p.drawbar_pull_n / p.vertical_force_n
        worst = max(worst, float(0.4 - pull), float(1.5 * p.sinkage_m / r))
        limits.append(float(1 - p.torque_nm / 8))
    return worst, limits


CASES = {
    "paper": (
        paper,
        [0.07, 0.01, 0.0, 13.0, 1.0, 0.9, 196.7, 0.05, 0.5],
        [0.18, 0.03, 45.0, 30.0, 4.14, 13.2, 1528.4, 0.20, 1.6],
    ),
    "running-slip": (running_slip, [0.01], [0.8]),
    "dry-sand-wheel": (dry_sand_wheel, [0.05, 0.03, 0.02], [0.25, 0.20, 0.60]),
    "robust-wheel": (robust_wheel, [0.06, 0.04, 0.02], [0.20, 0.20, 0.60]),
}


class OutOfTime(Exception):
    """The time of a solver is over."""


class Counted:
    """A problem over the unit box that keeps its record: (value, evaluations, CPU seconds) of each feasible improvement."""

    def __init__(self, case):
        self.function, low, high = case
        self.low, self.high = np.array(low), np.array(high)
        self.record, self.evaluations, self.begin = [], 0, time.process_time()
        self.last = (None, None)
        self.constraints = len(self(np.full(len(low), 0.5))[1])
        self.record, self.evaluations, self.begin = [], 0, time.process_time()

    def __call__(self, share):
        share = np.clip(np.asarray(share, float), 0, 1)
        if self.last[0] is not None and np.array_equal(share, self.last[0]):
            return self.last[1]
        spent = time.process_time() - self.begin
        if spent > SECONDS:
            raise OutOfTime
        self.evaluations += 1
        try:
            value, limits = self.function(self.low + share * (self.high - self.low))
        except (AttributeError, TypeError):
            value, limits = np.nan, [-1.0] * getattr(self, "constraints", 1)
        if not np.isfinite(value):
            value, limits = 1e3, [-1.0] * len(limits)
        limits = np.nan_to_num(np.array(limits), nan=-1.0)
        if limits.min() >= -FEASIBLE and (not self.record or value < self.record[-1][0]):
            self.record.append((value, self.evaluations, time.process_time() - self.begin))
        self.last = (share, (value, limits))
        return self.last[1]

    def value(self, x):
        return self(x)[0]

    def limits(self, x):
        return self(x)[1]

    def penalised(self, x):
        value, limits = self(x)
        return value + 1e2 * np.maximum(-limits, 0).sum()


def slsqp(problem):
    n = len(problem.low)
    starts = qmc.Sobol(n, seed=SEED).random(64)
    for start in [np.full(n, 0.5), *starts]:
        so.minimize(
            problem.value, start, method="SLSQP", bounds=[(0, 1)] * n,
            constraints=[{"type": "ineq", "fun": problem.limits}],
            options={"ftol": 1e-12, "maxiter": 300},
        )


def differential_evolution(problem):
    so.differential_evolution(
        problem.value, [(0, 1)] * len(problem.low), seed=SEED, maxiter=5000, tol=1e-12, atol=1e-12,
        constraints=so.NonlinearConstraint(problem.limits, 0, np.inf),
    )


def shgo(problem):
    so.shgo(
        problem.value, [(0, 1)] * len(problem.low), n=128, iters=5, sampling_method="sobol",
        constraints=[{"type": "ineq", "fun": problem.limits}],
    )


def direct(problem):
    so.direct(
        problem.penalised, [(0, 1)] * len(problem.low), maxfun=100_000, maxiter=100_000,
        locally_biased=True, vol_tol=1e-40, len_tol=1e-12,
    )


def by_pymoo(algorithm):
    def run(problem):
        class Wheel(ElementwiseProblem):
            def __init__(self):
                n = len(problem.low)
                super().__init__(n_var=n, n_obj=1, n_ieq_constr=problem.constraints, xl=0, xu=1)

            def _evaluate(self, x, out, *_, **__):
                value, limits = problem(x)
                out["F"], out["G"] = value, -limits

        pymoo_minimize(Wheel(), algorithm(), ("n_gen", 5000), seed=SEED, verbose=False)

    return run


RIVALS = {
    "SciPy SLSQP, 65 starts": slsqp,
    "SciPy differential evolution": differential_evolution,
    "SciPy SHGO": shgo,
    "SciPy DIRECT, penalty": direct,
    "pymoo GA": by_pymoo(lambda: GA(pop_size=100)),
    "pymoo DE": by_pymoo(lambda: DE(pop_size=100)),
}


def ours(name, *flags):
    """Grouser's answer, and its whole process's CPU seconds."""
    before = os.times()
    out = subprocess.run(
        [os.environ.get("GROUSER", "grouser"), "optimize", PROBLEMS / f"{name}.toml", "--json", *flags], capture_output=True, text=True, check=False
    )
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    return json.loads(out.stdout), seconds


def main():
    lines = [
        "# Global optimisers on the shipped problems",
        "",
        f"{datetime.date.today()}, {processor()}, load {os.getloadavg()[0]:.1f}; one core each, CPU seconds, at most {SECONDS:.0f} s. SciPy "
        f"{scipy.__version__}, pymoo {pymoo.__version__}. `python bench/opt/global_rivals.py`",
        "",
        "Reached: evaluations and CPU seconds until a feasible value within 1e-6 (1 + |f|) of the best one that anyone found. Lacking: what "
        "the value at the end lacks, over 1 + |f|. Rivals compute the wheel through Python (the same library); Grouser's time is that of "
        "its whole process, all of its eight starts. Only Grouser's proof bounds what nobody found.",
        "",
        "| problem | solver | best value | lacking | evaluations | seconds |",
        "|---|---|---|---|---|---|",
    ]
    for name, case in CASES.items():
        rows = []
        for solver, run in RIVALS.items():
            problem = Counted(case)
            try:
                run(problem)
            except OutOfTime:
                pass
            except Exception as error:  # a rival's own failure is a result
                print(name, solver, type(error).__name__, error)
            rows.append((solver, problem))
        answer, seconds = ours(name)
        values = [problem.record[-1][0] for _, problem in rows if problem.record]
        best = min([answer["utility"], *values])
        scale = 1 + abs(best)
        for solver, problem in rows:
            if not problem.record:
                lines.append(f"| {name} | {solver} | none feasible | | {problem.evaluations} | |")
                continue
            value = problem.record[-1][0]
            reached = next((r for r in problem.record if r[0] <= best + GAP * scale), None)
            cost = f"{reached[1]} | {reached[2]:.2f}" if reached else f"not reached in {problem.evaluations} | "
            lines.append(f"| {name} | {solver} | {value:.7f} | {(value - best) / scale:.0e} | {cost} |")
        value = answer["utility"]
        lines.append(
            f"| {name} | Grouser, 8 starts | {value:.7f} | {(value - best) / scale:.0e} | {answer['values']} | {seconds:.2f} |"
        )
        proved, seconds = ours(name, "--certify", "1e-6", "--certify-time", str(SECONDS))
        certificate = proved["certificate"]
        lines.append(
            f"| {name} | Grouser, proof: {certificate['status']} | ≥ {certificate['lower']:.7f} | {certificate['gap'] / scale:.0e} "
            f"| {certificate['boxes']} boxes | {seconds:.2f} |"
        )
        print("\n".join(lines[-8:]), flush=True)
        (HERE / "GLOBAL_RESULTS.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
