"""The kernel beside its rivals, in one run on one core, over the same operating points: naive Rust, numba, numpy
and jax with the same algorithm (Gauss-Jacobi and Gauss-Legendre rules by the same ladder, Newton in (ln θ_1, ln W)),
scipy's quad and brentq over the formulas as they are printed.

    just rivals

Accuracy comes first: each time stands beside the rival's worst error against the reference mode. What every
rival gave is stored under bench/target/rivals and its check sum printed. Writes its sections of bench/RESULTS.md,
between markers.
"""

import csv
import datetime
import functools
import hashlib
import io
import json
import os
import platform
import subprocess
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(name, "1")
os.environ.setdefault("JAX_ENABLE_X64", "1")
os.environ.setdefault("JAX_PLATFORMS", "cpu")
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numba  # noqa: E402
import numpy as np  # noqa: E402
import scipy  # noqa: E402
from scipy.integrate import quad  # noqa: E402
from scipy.optimize import brentq  # noqa: E402
from scipy.special import roots_jacobi, roots_legendre  # noqa: E402

HERE = Path(__file__).parent
OURS = HERE / "target" / "release" / "grouser-bench"
STORE = HERE / "target" / "rivals"

# the ladder of contact/ladder.rs: greatest stiffness, friction nodes, cohesion nodes
LADDER = ((1.2, 6, 8), (4.5, 8, 10), (16.0, 12, 16), (40.0, 16, 20), (90.0, 24, 32))
CURVE = 101


def tables(n):
    """Every rule of the ladder for one exponent, filled up to one length."""
    t, tw, x, xw = (np.zeros((5, m)) for m in (24, 24, 32, 32))
    for k, (_, friction, cohesion) in enumerate(LADDER):
        nodes, weights = roots_jacobi(friction, 0.0, n)
        t[k, :friction], tw[k, :friction] = (nodes + 1) / 2, weights / 2 ** (n + 1)
        nodes, weights = roots_legendre(cohesion)
        x[k, :cohesion], xw[k, :cohesion] = (nodes + 1) / 2, weights / 2
    return t, tw, x, xw


def integrals(theta_1, p, n, friction, cohesion, t, tw, x, xw):
    """W, DP, T and dW/dθ_1 by one step's rules. p: radius, width, q, c, tan φ, r/K, k rⁿ, c_1 + c_2 s.

    Plain operations, so that numba compiles it for numbers and numpy runs it over arrays."""
    radius, width, q, c, tan_phi, r_over_k, amplitude, position = p
    sin_1, cos_1 = np.sin(theta_1), np.cos(theta_1)
    ahead = 1.0 - position
    front, rear = ahead * theta_1, position * theta_1
    w = pull = torque = dw = 0.0 * theta_1
    for i in range(friction):
        u = front * t[i]
        theta = theta_1 - u
        sin, cos = np.sin(theta), np.cos(theta)
        drop = 2.0 * np.sin(theta_1 - 0.5 * u) * np.sin(0.5 * u)
        sigma = tw[i] * amplitude * (drop / t[i]) ** n
        per = n * (sin_1 - sin * (1.0 - ahead * t[i])) / drop
        for piece in range(2):
            if piece == 0:
                length, share, turn = front, ahead, 1.0 - ahead * t[i]
            else:
                theta = rear * t[i]
                sin, cos = np.sin(theta), np.cos(theta)
                length, share, turn = rear, position, position * t[i]
            left = np.exp(-r_over_k * ((theta_1 - theta) - q * (sin_1 - sin)))
            grip = tan_phi * (1.0 - left)
            dgrip = tan_phi * left * r_over_k * ((1.0 - turn) - q * (cos_1 - cos * turn))
            up = cos + grip * sin
            w = w + length * sigma * up
            pull = pull + length * sigma * (grip * cos - sin)
            torque = torque + length * sigma * grip
            dup = dgrip * sin + (grip * cos - sin) * turn
            dw = dw + sigma * (share * up + length * (per * up + dup))
    for i in range(cohesion):
        theta = theta_1 * x[i]
        sin, cos = np.sin(theta), np.cos(theta)
        left = np.exp(-r_over_k * ((theta_1 - theta) - q * (sin_1 - sin)))
        tau = c * xw[i] * (1.0 - left)
        dtau = c * xw[i] * left * r_over_k * ((1.0 - x[i]) - q * (cos_1 - cos * x[i]))
        w = w + theta_1 * tau * sin
        pull = pull + theta_1 * tau * cos
        torque = torque + theta_1 * tau
        dw = dw + tau * sin + theta_1 * (dtau * sin + tau * cos * x[i])
    area = radius * width
    return area * w, area * pull, radius * area * torque, area * dw


def rung(theta_1, q, r_over_k):
    stiffness = r_over_k * theta_1 * (1.0 - q * np.cos(theta_1))
    return (
        0 + (stiffness > 1.2) + (stiffness > 4.5) + (stiffness > 16.0) + (stiffness > 40.0)
    )


FRICTION = np.array([f for _, f, _ in LADDER])
COHESION = np.array([c for _, _, c in LADDER])
# inlined, so that a caller who drops dW/dθ_1 does not pay for it
fast_integrals = numba.njit(fastmath=True, inline="always")(integrals)
fast_rung = numba.njit(rung)


@numba.njit(fastmath=True, inline="always")
def numba_one(theta_1, p, n, t, tw, x, xw):
    k = fast_rung(theta_1, p[2], p[5])
    return fast_integrals(theta_1, p, n, FRICTION[k], COHESION[k], t[k], tw[k], x[k], xw[k])


@numba.njit(fastmath=True)
def numba_solve(load, start, p, n, t, tw, x, xw):
    theta_1 = start
    for _ in range(20):
        w, pull, torque, dw = numba_one(theta_1, p, n, t, tw, x, xw)
        off = np.log(w / load)
        theta_1 *= np.exp(-off * w / (theta_1 * dw))
        if abs(off) <= 1e-7:
            break
    w, pull, torque, dw = numba_one(theta_1, p, n, t, tw, x, xw)
    return theta_1, pull, torque


@numba.njit(fastmath=True)
def numba_forces_all(theta_1, p, n, t, tw, x, xw, out):
    for i in range(theta_1.size):
        one = (p[0][i], p[1][i], p[2][i], p[3], p[4], p[5][i], p[6][i], p[7][i])
        w, pull, torque, _ = numba_one(theta_1[i], one, n, t, tw, x, xw)
        out[i, 0], out[i, 1], out[i, 2] = w, pull, torque


@numba.njit(fastmath=True)
def numba_solve_all(load, start, p, n, t, tw, x, xw, out, warm):
    before = start[0]
    for i in range(load.size):
        one = (p[0][i], p[1][i], p[2][i], p[3], p[4], p[5][i], p[6][i], p[7][i])
        begin = before if warm and i > 0 else start[i]
        theta_1, pull, torque = numba_solve(load[i], begin, one, n, t, tw, x, xw)
        before = theta_1
        out[i, 0], out[i, 1], out[i, 2] = theta_1, pull, torque


def numpy_forces(theta_1, p, n, rules):
    """All points at once, by rungs."""
    out = np.empty((theta_1.size, 4))
    steps = rung(theta_1, p[2], p[5])
    for k in range(5):
        at = steps == k
        if at.any():
            part = [v[at] if isinstance(v, np.ndarray) else v for v in p]
            rows = (rule[k] for rule in rules)
            out[at] = np.transpose(
                integrals(theta_1[at], part, n, FRICTION[k], COHESION[k], *rows)
            )
    return out


def numpy_solve(load, start, p, n, rules):
    theta_1 = start.copy()
    for _ in range(6):
        w, _, _, dw = numpy_forces(theta_1, p, n, rules).T
        off = np.log(w / load)
        theta_1 *= np.exp(-off * w / (theta_1 * dw))
        if np.abs(off).max() <= 1e-7:
            break
    f = numpy_forces(theta_1, p, n, rules)
    return np.column_stack([theta_1, f[:, 1], f[:, 2]])


@jax.jit
@functools.partial(jax.vmap, in_axes=(0, (0, 0, 0, None, None, 0, 0, 0), None, None, None, None, None))
def jax_integrals(theta_1, p, n, t, tw, x, xw):
    """As `integrals`, with the nodes of a rule as an axis: a third faster under jax than a loop over them."""
    radius, width, q, c, tan_phi, r_over_k, amplitude, position = p
    sin_1, cos_1 = jnp.sin(theta_1), jnp.cos(theta_1)
    ahead = 1.0 - position
    u = ahead * theta_1 * t
    drop = 2.0 * jnp.sin(theta_1 - 0.5 * u) * jnp.sin(0.5 * u)
    sigma = tw * amplitude * (drop / t) ** n
    per = n * (sin_1 - jnp.sin(theta_1 - u) * (1.0 - ahead * t)) / drop
    w = pull = torque = dw = 0.0
    for length, turn in ((ahead, 1.0 - ahead * t), (position, position * t)):
        theta = theta_1 * turn
        sin, cos = jnp.sin(theta), jnp.cos(theta)
        left = jnp.exp(-r_over_k * ((theta_1 - theta) - q * (sin_1 - sin)))
        grip = tan_phi * (1.0 - left)
        dgrip = tan_phi * left * r_over_k * ((1.0 - turn) - q * (cos_1 - cos * turn))
        up = cos + grip * sin
        w += theta_1 * length * (sigma * up).sum()
        pull += theta_1 * length * (sigma * (grip * cos - sin)).sum()
        torque += theta_1 * length * (sigma * grip).sum()
        dup = dgrip * sin + (grip * cos - sin) * turn
        dw += length * (sigma * (up + theta_1 * (per * up + dup))).sum()
    theta = theta_1 * x
    sin, cos = jnp.sin(theta), jnp.cos(theta)
    left = jnp.exp(-r_over_k * ((theta_1 - theta) - q * (sin_1 - sin)))
    tau = c * xw * (1.0 - left)
    dtau = c * xw * left * r_over_k * ((1.0 - x) - q * (cos_1 - cos * x))
    w += theta_1 * (tau * sin).sum()
    pull += theta_1 * (tau * cos).sum()
    torque += theta_1 * tau.sum()
    dw += (tau * sin + theta_1 * (dtau * sin + tau * cos * x)).sum()
    area = radius * width
    return area * w, area * pull, radius * area * torque, area * dw


@jax.jit
def jax_forces(theta_1, p, n, rule):
    return jnp.stack(jax_integrals(theta_1, p, n, *rule)[:3], 1)


@jax.jit
def jax_solve(load, start, p, n, rule):
    def is_open(state):
        return (state[0] < 20) & (jnp.abs(state[2]).max() > 1e-7)

    def step(state):
        count, theta_1, _ = state
        w, _, _, dw = jax_integrals(theta_1, p, n, *rule)
        off = jnp.log(w / load)
        return count + 1, theta_1 * jnp.exp(-off * w / (theta_1 * dw)), off

    _, theta_1, _ = jax.lax.while_loop(is_open, step, (0, start, jnp.full_like(start, jnp.inf)))
    _, pull, torque, _ = jax_integrals(theta_1, p, n, *rule)
    return jnp.stack([theta_1, pull, torque], 1)


def jax_groups(soil, steps, p, columns):
    """The points of each rung on the device, and their places: shapes are fixed when a function is compiled."""
    groups = []
    for k in np.unique(steps):
        at = np.flatnonzero(steps == k)
        part = tuple(jnp.asarray(v[at]) if isinstance(v, np.ndarray) else jnp.float64(v) for v in p)
        nodes = (FRICTION[k], FRICTION[k], COHESION[k], COHESION[k])
        rule = tuple(jnp.asarray(rule[k][:count]) for rule, count in zip(soil.rules, nodes))
        groups.append((at, [jnp.asarray(column[at]) for column in columns], part, jnp.float64(soil.n), rule))
    return groups


def jax_run(function, groups):
    """Starts every group, waits for all and returns them in the order of the points."""
    results = [[function(*columns, p, n, rule) for _, columns, p, n, rule in soil] for soil in groups]
    out = []
    for soil, parts in zip(groups, results):
        rows = np.empty((sum(group[0].size for group in soil), 3))
        for group, part in zip(soil, parts):
            rows[group[0]] = part
        out.append(rows)
    return out


def quad_forces(theta_1, soil, radius, width, slip):
    """The formulas as they are printed, three integrals over two pieces."""
    theta_m = (soil["c_1"] + soil["c_2"] * slip) * theta_1
    k = soil["k_c"] / width + soil["k_phi"]
    tan_phi = np.tan(soil["phi"])

    def stresses(theta):
        shifted = theta if theta >= theta_m else theta_1 - theta / theta_m * (theta_1 - theta_m)
        sigma = k * (radius * max(np.cos(shifted) - np.cos(theta_1), 0.0)) ** soil["n"]
        j = radius * ((theta_1 - theta) - (1 - slip) * (np.sin(theta_1) - np.sin(theta)))
        return sigma, (soil["c"] + sigma * tan_phi) * (1 - np.exp(-j / soil["k_shear"]))

    def integral(f):
        return sum(
            quad(lambda a: f(a, *stresses(a)), *piece, epsrel=1e-10, epsabs=0.0)[0]
            for piece in ((0.0, theta_m), (theta_m, theta_1))
        )

    area = radius * width
    return lambda which: (
        area * integral(lambda a, s, q: s * np.cos(a) + q * np.sin(a))
        if which == 0
        else area * integral(lambda a, s, q: q * np.cos(a) - s * np.sin(a))
        if which == 1
        else radius * area * integral(lambda a, s, q: q)
    )


def quad_solve(load, soil, radius, width, slip):
    def off(theta_1):
        return quad_forces(theta_1, soil, radius, width, slip)(0) - load

    return brentq(off, 1e-3, 1.5, xtol=1e-10)


class Soil:
    """The points of one soil, in the rivals' terms."""

    def __init__(self, rows):
        self.soil = {k: float(rows[0][k]) for k in ("k_c", "k_phi", "n", "c", "phi", "k_shear", "c_1", "c_2")}
        column = {
            k: np.array([float(row[k]) for row in rows])
            for k in ("radius_m", "width_m", "slip", "sinkage_m", "load_n")
        }
        self.column = column
        self.exact = np.array([[float(row[k]) for k in ("w", "pull", "torque")] for row in rows])
        self.n = self.soil["n"]
        self.rules = tables(self.n)
        self.theta_1 = 2 * np.arcsin(np.sqrt(column["sinkage_m"] / (2 * column["radius_m"])))
        self.p = self.parameters(column["radius_m"], column["width_m"], column["slip"])
        self.start = self.begin(column["load_n"], column["radius_m"], column["width_m"])

    def parameters(self, radius, width, slip):
        s = self.soil
        amplitude = (s["k_c"] / width + s["k_phi"]) * radius ** s["n"]
        position = s["c_1"] + s["c_2"] * slip
        return (radius, width, 1 - slip, s["c"], np.tan(s["phi"]), radius / s["k_shear"], amplitude, position)

    def begin(self, load, radius, width):
        """Bekker's closed form."""
        s, n = self.soil, self.n
        k = s["k_c"] / width + s["k_phi"]
        z = (3 * load / ((3 - n) * width * k * np.sqrt(2 * radius))) ** (2 / (2 * n + 1))
        return 2 * np.arcsin(np.sqrt(np.minimum(0.5, z / (2 * radius))))


def median_time(job, rounds):
    times = []
    for _ in range(rounds):
        start = time.process_time()
        job()
        times.append(time.process_time() - start)
    return sorted(times)[rounds // 2]


def worst(soils, results, part=slice(None)):
    """Worst error of forces over max(|W|, |DP|, |T|/r)."""
    most = 0.0
    for soil, result in zip(soils, results):
        per = np.array([1.0, 1.0, 1.0]) / np.column_stack(
            [np.ones_like(soil.theta_1), np.ones_like(soil.theta_1), soil.column["radius_m"]]
        )
        exact, got = (soil.exact * per)[part], result[:, :3] * per[part]
        most = max(most, (np.abs(got - exact).max(1) / np.abs(exact).max(1)).max())
    return most


def worst_angle(soils, results, part=slice(None)):
    return max(np.abs(r[:, 0] / s.theta_1[part] - 1).max() for s, r in zip(soils, results))


def stored(name, arrays):
    text = "\n".join(",".join(f"{x:.12e}" for x in row) for a in arrays for row in np.atleast_2d(a))
    path = STORE / f"{name}.csv"
    path.write_text(text + "\n")
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def main():
    STORE.mkdir(parents=True, exist_ok=True)
    load_before = os.getloadavg()[0]
    points = subprocess.run([OURS, "points"], check=True, capture_output=True, text=True).stdout
    by_key = {}
    for row in csv.DictReader(io.StringIO(points)):
        by_key.setdefault(row["soil"], []).append(row)
    soils = [Soil(rows) for rows in by_key.values()]
    count = sum(s.theta_1.size for s in soils)
    ours = json.loads(subprocess.run([OURS, "kernel", "--json"], check=True, capture_output=True).stdout)
    rows = []

    def row(name, job, seconds_a_point, error, arrays):
        rows.append((name, job, seconds_a_point, error, stored(f"{name}-{job}".replace(" ", "-"), arrays)))

    rows += [
        (name, job, ours[key] * scale, ours.get(error), ours["check_sums"][i])
        for name, job, key, scale, error, i in (
            ("grouser", "forces", "eval_ns", 1e-9, "worst_error", 0),
            ("grouser", "solve", "solve_ns", 1e-9, "solve_worst_error", 1),
            ("grouser", "curve", "curve_us", 1e-6, None, 2),
            ("naive Rust", "forces", "naive_eval_ns", 1e-9, "naive_worst_error", 3),
            ("naive Rust", "solve", "naive_solve_ns", 1e-9, None, 4),
            ("naive Rust", "curve", "naive_curve_us", 1e-6, None, 5),
        )
    ]

    # the curve of the bench: r .2, b .15, the load that 20 mm carry at slip .2, slips 0 to .9
    slip = np.linspace(0.0, 0.9, CURVE)
    curves = []
    for soil in soils:
        radius, width = np.full(CURVE, 0.2), np.full(CURVE, 0.15)
        p = soil.parameters(radius, width, slip)
        at = soil.parameters(radius[:1], width[:1], slip[:1] * 0 + 0.2)
        theta_1 = np.array([2 * np.arcsin(np.sqrt(0.05))])
        load = np.full(CURVE, numpy_forces(theta_1, at, soil.n, soil.rules)[0, 0])
        curves.append((p, load, soil.begin(load, radius, width)))

    out = [np.empty((s.theta_1.size, 3)) for s in soils]
    curve_out = [np.empty((CURVE, 3)) for _ in soils]

    def numba_forces():
        for s, o in zip(soils, out):
            numba_forces_all(s.theta_1, s.p, s.n, *s.rules, o)

    def numba_solves():
        for s, o in zip(soils, out):
            numba_solve_all(s.column["load_n"], s.start, s.p, s.n, *s.rules, o, False)

    def numba_curves():
        for s, (p, load, start), o in zip(soils, curves, curve_out):
            numba_solve_all(load, start, p, s.n, *s.rules, o, True)

    for name, job, points_of, check in (
        ("forces", numba_forces, count, worst),
        ("solve", numba_solves, count, worst_angle),
    ):
        job()
        seconds = median_time(job, 21) / points_of
        row("numba", name, seconds, check(soils, out), out)
    numba_curves()
    row("numba", "curve", median_time(numba_curves, 21) / len(soils), None, curve_out)

    got = [numpy_forces(s.theta_1, s.p, s.n, s.rules)[:, :3] for s in soils]
    seconds = median_time(
        lambda: [numpy_forces(s.theta_1, s.p, s.n, s.rules) for s in soils], 5
    )
    row("numpy", "forces", seconds / count, worst(soils, got), got)

    def numpy_solves():
        return [numpy_solve(s.column["load_n"], s.start, s.p, s.n, s.rules) for s in soils]

    got = numpy_solves()
    row("numpy", "solve", median_time(numpy_solves, 3) / count, worst_angle(soils, got), got)

    def numpy_curves():
        return [numpy_solve(c[1], c[2], c[0], s.n, s.rules) for s, c in zip(soils, curves)]

    got = numpy_curves()
    row("numpy", "curve", median_time(numpy_curves, 3) / len(soils), None, got)

    # one rule a point: the finest that its search may need, from the closed form and a tenth beyond
    def steps_of(start, p):
        return rung(1.1 * start, p[2], p[5])

    at_sinkage = [jax_groups(s, rung(s.theta_1, s.p[2], s.p[5]), s.p, [s.theta_1]) for s in soils]
    under_load = [
        jax_groups(s, steps_of(s.start, s.p), s.p, [s.column["load_n"], s.start]) for s in soils
    ]
    of_curve = [
        jax_groups(s, steps_of(start, p), p, [load, start]) for s, (p, load, start) in zip(soils, curves)
    ]
    for job, function, groups, per, check in (
        ("forces", jax_forces, at_sinkage, count, worst),
        ("solve", jax_solve, under_load, count, worst_angle),
        ("curve", jax_solve, of_curve, len(soils), None),
    ):
        got = jax_run(function, groups)
        seconds = median_time(lambda: jax_run(function, groups), 21) / per
        row("jax", job, seconds, check and check(soils, got), got)

    # scipy on a part: it takes milliseconds a point
    part = slice(0, None, 100)
    start = time.process_time()
    got = []
    for s in soils:
        c = s.column
        some = range(s.theta_1.size)[part]
        forces = [
            quad_forces(s.theta_1[i], s.soil, c["radius_m"][i], c["width_m"][i], c["slip"][i]) for i in some
        ]
        got.append(np.array([[f(0), f(1), f(2)] for f in forces]))
    seconds = (time.process_time() - start) / sum(len(g) for g in got)
    row("scipy", "forces", seconds, worst(soils, got, part), got)
    part = slice(0, None, 200)
    start = time.process_time()
    got = []
    for s in soils:
        c = s.column
        got.append(
            np.array(
                [
                    [quad_solve(c["load_n"][i], s.soil, c["radius_m"][i], c["width_m"][i], c["slip"][i])]
                    for i in range(s.theta_1.size)[part]
                ]
            )
        )
    seconds = (time.process_time() - start) / sum(len(g) for g in got)
    row("scipy", "solve", seconds, worst_angle(soils, got, part), got)
    start = time.process_time()
    s, (_, load, _) = soils[0], curves[0]
    got = []
    for one, wanted in zip(slip, load):
        theta_1 = quad_solve(wanted, s.soil, 0.2, 0.15, one)
        f = quad_forces(theta_1, s.soil, 0.2, 0.15, one)
        got.append([theta_1, f(1), f(2)])
    row("scipy", "curve", time.process_time() - start, None, [np.array(got)])

    report(rows, ours, load_before)


def shown(seconds):
    for unit, scale in (("ns", 1e9), ("µs", 1e6), ("ms", 1e3)):
        if seconds * scale < 1000:
            return f"{seconds * scale:.3g} {unit}"
    return f"{seconds:.3g} s"


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def svml():
    """Intel's vector functions need a patched LLVM, which the wheels of some releases do not have."""
    return "with SVML" if numba.config.USING_SVML else "its wheel has no SVML"


def report(rows, ours, load_before):
    base = {job: seconds for name, job, seconds, _, _ in rows if name == "grouser"}
    words = {"forces": "three forces at a sinkage", "solve": "sinkage of a load", "curve": "101-point curve"}
    lines = [
        f"`just rivals` on {datetime.date.today()}, {processor()}, lanes on {ours['instructions']}, one core; load of the machine",
        f"{load_before:.2f} before and {os.getloadavg()[0]:.2f} after. numpy {np.__version__}, scipy {scipy.__version__}, "
        f"numba {numba.__version__} ({svml()}), jax {jax.__version__}.",
        "",
        "4096 operating points over five soils (r 0.05-0.35 m, z/r 0.01-0.35, slip 0-0.9), the same for all;",
        "scipy on a hundredth of them. Naive Rust: standard functions, 32-point Gauss-Legendre per piece,",
        "Brent to 1e-10, and everything that does not depend on the node outside its loop. numba, numpy and jax:",
        "the same rules by the same ladder, Newton with the exact derivative; numba's curve starts each point",
        "from the previous solution. jax: `vmap` and `jit` in float64 over the points of one rule, compiled",
        "before. Error: of forces over max(|W|, |DP|, |T|/r), of a solve in θ_1. Check sums are of the stored",
        "outputs (of Grouser and naive Rust: their sums). Times are medians, of short pieces (Rust) or of",
        "processor time (Python), so that the load of the machine has little effect on scalar code.",
        "",
        "| job | rival | per point (curve: all) | times Grouser | worst error | check sum |",
        "|---|---|---|---|---|---|",
    ]
    for job, title in words.items():
        for name, at, seconds, error, check in rows:
            if at == job:
                ratio = f"{seconds / base[job]:.1f}" if name != "grouser" else "1"
                shown_error = "" if error is None else f"{error:.1e}"
                check = check if isinstance(check, str) else f"{check:.12g}"
                lines.append(f"| {title} | {name} | {shown(seconds)} | {ratio} | {shown_error} | {check} |")
    replace_section("rivals", lines)
    printed = subprocess.run([OURS, "paths"], check=True, capture_output=True, text=True).stdout
    lines = [f"`grouser-bench paths` on {datetime.date.today()}, {processor()}, load of the machine "
             f"{os.getloadavg()[0]:.2f}: use the ratios", "", "```text", *printed.splitlines(), "```"]
    replace_section("paths", lines)


def replace_section(name, lines, path=HERE / "RESULTS.md"):
    """Puts lines between the markers of a name; everything outside of markers stays as it is."""
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    text = path.read_text()
    if text.count(begin) != 1 or text.count(end) != 1:
        raise SystemExit(f"{path} needs one line `{begin}` and one line `{end}`")
    head, rest = text.split(begin)
    _, tail = rest.split(end)
    path.write_text("\n".join([head + begin, *lines, end + tail]))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
