"""`grouser estimate` on logs of robots, sensors, courses and slips drawn at random, beside the naive means over one and two
seconds that anybody would take from the same files.

    cargo build --release && python bench/random_logs.py [FIRST [COUNT [HZ [TROUBLE]]]]

The world is this file: a body on a course, and rims that run faster than the ground under them by their slip. It shares no code
and no law with the program. What differs from log to log: two, four or six wheels or a car's steering, size and speed, stops,
reverse and bends, the profile of slip, wheels by counts, angles, rates or speeds with resolution and noise, with or without
gyro (with a bias that may never be seen at rest) and accelerometer, positions, displacements or speeds as reference with their
rate, noise, outliers and delay, and whether the robot file states these. HZ thins the rows of wheels, gyro and accelerometer, 0
leaves them. A TROUBLE is something more that the robot file does not state: see TROUBLES. Needs numpy.
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

GROUSER = pathlib.Path(__file__).parents[1] / "target" / "release" / "grouser"
STEP_S = 0.002
SETTLED_S = 5.0  # errors count from here on
MIN_RIM_M_PER_S = 0.05  # and where a wheel turns at least as fast
TROUBLES = {
    "outages": "the reference is silent for 12 s and for 6 s",
    "stuck": "the first wheel's sensor shows one value for 6 s, where there are more than two wheels",
    "gyro": "the gyro's scale is 1.03, and its bias drifts by 0.0003 rad/s a second",
    "geometry": "the track is 5 % and the radius 1 % smaller than described",
    "scatter": "stamps of the reference are late by 30 ms as they fall",
    "jumps": "a pose jumps by up to 0.3 m once in 20 s, and stays there",
    "aside": "the robot slides aside by 0.05 to 0.2 of its way, as on a slope",
    "bends": "wheels outside a bend slip more by 0.1 to 0.4 at 0.4 rad/s, those inside less",
    "lag": "rates and speeds of wheels are behind by 80 ms",
}


def course(random, time, levels, lag_s):
    """Levels that begin at times, followed with a lag."""
    out, now, index = np.empty_like(time), levels[0][1], 0
    for i, t in enumerate(time):
        while index + 1 < len(levels) and levels[index + 1][0] <= t:
            index += 1
        now += (levels[index][1] - now) * min(1.0, STEP_S / lag_s)
        out[i] = now
    return out


def drawn_levels(random, first, begin_s, gaps_s, end_s, level):
    levels, at = [(0.0, first)], random.uniform(*begin_s)
    while at < end_s:
        levels.append((at, level()))
        at += random.uniform(*gaps_s)
    return levels


class World:
    """True motion and slips, on steps of STEP_S."""

    def __init__(self, random, trouble=None):
        self.lasts_s = random.choice([40.0, 80.0, 150.0])
        self.time = time = np.arange(0, self.lasts_s, STEP_S)
        self.kind = str(random.choice(["two", "four", "six", "car"]))
        size = 10 ** random.uniform(-0.5, 0.5)
        half, self.radius = 0.25 * size, 0.1 * size
        rows = {"two": [0.0], "four": [half, -half], "six": [1.5 * half, 0.0, -1.5 * half], "car": [2.2 * half, 0.0]}
        self.places = [(x, side * half) for x in rows[self.kind] for side in (1, -1)]
        self.top = 10 ** random.uniform(-1, 0.4)
        shares = ([1.0, 0.6, 0.3, 0.0, -0.4], [0.55, 0.15, 0.1, 0.12, 0.08])
        speeds = drawn_levels(random, 0.0, (1, 4), (4, 20), self.lasts_s, lambda: self.top * random.choice(shares[0], p=shares[1]))
        self.speed = course(random, time, speeds, random.uniform(0.2, 0.8))
        most = min(0.6, 0.4 * self.top / half) if random.random() < 0.7 else 0.0
        bends = drawn_levels(random, 0.0, (3, 8), (3, 10), self.lasts_s, lambda: random.uniform(-most, most) * (random.random() < 0.5))
        self.turn = course(random, time, bends, 0.5)
        if self.kind == "car":
            self.turn *= np.abs(self.speed) / self.top
        elif self.kind != "four":  # others turn on the spot
            self.turn[np.abs(self.speed) < 1e-3] = 0.0
        self.yaw = np.cumsum(self.turn) * STEP_S
        aside = random.uniform(0.05, 0.2) * np.sin(self.yaw + random.uniform(0, 6)) if trouble == "aside" else 0.0
        self.x = np.cumsum(self.speed * (np.cos(self.yaw) - aside * np.sin(self.yaw))) * STEP_S
        self.y = np.cumsum(self.speed * (np.sin(self.yaw) + aside * np.cos(self.yaw))) * STEP_S
        self.draw_slips(random)
        if trouble == "bends" and self.kind != "car":
            share = random.uniform(0.1, 0.4) / 0.4
            self.slips = [np.clip(slip - share * np.sign(y) * self.turn, -0.4, 0.9) for slip, (_, y) in zip(self.slips, self.places)]
        self.rims = []
        for (x, y), slip in zip(self.places, self.slips):
            ground = self.speed - self.turn * y
            if self.kind == "car" and x > 0:
                steered = np.arctan2(self.turn * x, ground)
                steered = np.where(self.speed < 0, steered - np.sign(steered) * np.pi, steered)
                ground = ground * np.cos(steered) + self.turn * x * np.sin(steered)
            self.rims.append(ground / (1 - slip))

    def draw_slips(self, random):
        self.profile = str(random.choice(["constant", "patch", "steps", "walk", "none"]))
        base = random.choice([0.02, 0.05, 0.15, 0.3])
        count = len(self.time)

        def one():
            if self.profile == "none":
                return np.zeros(count)
            if self.profile == "constant":
                return np.full(count, base)
            if self.profile == "walk":
                return np.clip(base + np.cumsum(random.normal(size=count)) * math.sqrt(STEP_S) * 0.05, -0.05, 0.8)
            begun = iter(range(count))
            levels = [base, 0.1, 0.35, 0.6, 0.75]
            level = (lambda: random.choice(levels)) if self.profile == "steps" else (lambda: base if next(begun) % 2 else 0.5)
            return course(random, self.time, drawn_levels(random, base, (5, 15), (3, 12), self.lasts_s, level), 0.15)

        common, self.slips = one(), []
        for _ in self.places:
            own = random.normal() * 0.02 if self.profile != "none" else 0.0
            alone = self.profile == "patch" and random.random() < 0.3
            self.slips.append(np.clip((one() if alone else common) + own, -0.1, 0.9))

    def steering(self):
        wheelbase = self.places[0][0]
        moves = np.abs(self.speed) > 1e-3
        return np.arctan(np.where(moves, self.turn / np.where(moves, self.speed, 1.0), 0.0) * wheelbase)


class Log:
    """The files of a world as its sensors see it; and what the naive means take from the same readings."""

    def __init__(self, world, random, folder, thinned_hz=None, trouble=None):
        self.world, self.folder, self.trouble = world, folder, trouble
        self.names = [f"w{i}" for i in range(len(world.places))]
        drawn_hz = int(random.choice([20, 50, 100]))
        hz = thinned_hz or drawn_hz
        self.rows = np.arange(0, len(world.time), round(1 / (hz * STEP_S)))
        self.sensor = str(random.choice(["count", "count", "angle", "rate", "speed"]))
        self.ticks = int(random.choice([360, 1000, 4096]))
        self.reference = str(random.choice(["pose", "pose", "speed", "displacement"]))
        rates = {"pose": [1, 2, 5, 10], "speed": [1, 2, 5, 10], "displacement": [5, 10, 20]}
        self.rate = int(random.choice(rates[self.reference]))
        sigmas = {"pose": [0.005, 0.01, 0.02, 0.05], "speed": [0.01, 0.03, 0.1], "displacement": [0.002]}
        self.sigma = float(random.choice(sigmas[self.reference]))
        self.yaw_sigma = float(random.choice([0.003, 0.02]))
        self.outliers = float(random.choice([0, 0, 0.01]))
        self.delay = float(random.choice([0, 0, 0.1]))
        self.is_told = random.random() < 0.5
        self.has_gyro, self.has_accelerometer = random.random() < 0.85, random.random() < 0.4
        self.write_wheels(random)
        self.write_reference(random)
        self.write_robot()

    def write_wheels(self, random):
        world, rows = self.world, self.rows
        columns, data, self.ways = [], {}, []
        meaning, unit = {
            "count": ("wheel_count", "tick"),
            "angle": ("wheel_angle", "rad"),
            "rate": ("wheel_rate", "rad/s"),
            "speed": ("wheel_speed", "m/s"),
        }[self.sensor]
        for name, rim in zip(self.names, world.rims):
            rate = rim / world.radius
            if self.trouble == "lag" and self.sensor in ("rate", "speed"):
                fading = np.exp(-np.arange(0, 0.4, STEP_S) / 0.08)
                rate = np.convolve(rate, fading / fading.sum())[: len(rate)]
            counts = np.floor((np.cumsum(rate) * STEP_S + random.uniform(0, 6)) / (2 * np.pi) * self.ticks)[rows]
            noisy = rate[rows] + 0.01 * random.normal(size=len(rows))
            angle = counts / self.ticks * 2 * np.pi
            values = {"count": counts.astype(int), "angle": angle, "rate": noisy, "speed": noisy * world.radius}[self.sensor]
            data[name] = [f"{value:.5f}" if self.sensor != "count" else str(value) for value in values]
            if self.trouble == "stuck" and name == "w0" and len(self.names) > 2:
                middle, count = len(rows) // 2, round(6.0 / ((rows[1] - rows[0]) * STEP_S))
                data[name][middle : middle + count] = [data[name][middle]] * len(data[name][middle : middle + count])
            columns.append(f'{{ column = "{name}", meaning = "{meaning}", wheel = "{name}", unit = "{unit}" }}')
            summed = np.cumsum(noisy) * (rows[1] - rows[0]) * STEP_S
            self.ways.append(world.radius * (angle if self.sensor in ("count", "angle") else summed))
        if self.has_gyro:
            bias, noise = random.normal() * 0.01, random.choice([0.002, 0.01])
            turn = world.turn[rows]
            if self.trouble == "gyro":
                turn = 1.03 * turn + 0.0003 * world.time[rows]
            data["gyro"] = [f"{value:.5f}" for value in (turn + bias + noise * random.normal(size=len(rows)))]
            columns.append('{ column = "gyro", meaning = "yaw_rate", unit = "rad/s" }')
        if self.has_accelerometer:
            for name, true in (("forward", np.gradient(world.speed, STEP_S)), ("left", world.speed * world.turn)):
                measured = true[rows] + 0.05 * random.normal() + 0.1 * random.normal(size=len(rows))
                data[name] = [f"{value:.4f}" for value in measured]
                columns.append(f'{{ column = "{name}", meaning = "acceleration_{name}", unit = "m/s2" }}')
        if world.kind == "car":
            data["steering"] = [f"{value:.5f}" for value in world.steering()[rows]]
            columns.append('{ column = "steering", meaning = "steering_angle", unit = "rad" }')
        self.wheel_columns = columns
        self.write_table("wheels.csv", {"t": [f"{t:.4f}" for t in world.time[rows]], **data})

    def write_reference(self, random):
        world = self.world
        at = np.arange(int(random.uniform(0, 0.2) / STEP_S), len(world.time), round(1 / (self.rate * STEP_S)))
        stamps = world.time[at] + self.delay
        if self.trouble == "scatter":
            stamps = np.maximum.accumulate(stamps + 0.03 * np.abs(random.normal(size=len(at)))) + 1e-6 * np.arange(len(at))
        noise = lambda sigma: sigma * random.normal(size=len(at))
        if self.reference == "pose":
            off = np.where(random.random(len(at)) < self.outliers, 0.5, 0.0)
            x, y = world.x[at] + noise(self.sigma) + off, world.y[at] + noise(self.sigma) - off
            if self.trouble == "jumps":
                jumps = random.random(len(at)) < 1 / (20 * self.rate)
                jumped = np.cumsum(np.where(jumps, random.uniform(-0.3, 0.3, len(at)), 0.0))
                x, y = x + jumped, y + jumped
            yaw = world.yaw[at] + noise(self.yaw_sigma)
            values = {"x": ("pose_x", "m", x), "y": ("pose_y", "m", y), "yaw": ("pose_yaw", "rad", yaw)}
            middle = yaw[:-1] + 0.5 * np.diff(yaw)
            steps = np.diff(x) * np.cos(middle) + np.diff(y) * np.sin(middle)
            turns = np.diff(yaw)
        elif self.reference == "speed":
            speed = world.speed[at] + noise(self.sigma)
            values = {"v": ("speed_forward", "m/s", speed)}
            steps, turns = 0.5 * (speed[1:] + speed[:-1]) * np.diff(stamps), np.diff(world.yaw[at])
        else:
            yaw, east = world.yaw[at], np.diff(world.x[at], prepend=world.x[at[0]])
            north = np.diff(world.y[at], prepend=world.y[at[0]])
            turn = np.diff(yaw, prepend=yaw[0])
            middle = yaw - 0.5 * turn
            forward = np.cos(middle) * east + np.sin(middle) * north + noise(self.sigma)
            left = np.cos(middle) * north - np.sin(middle) * east + noise(self.sigma)
            turn = turn + noise(0.002)
            values = {
                "forward": ("displacement_forward", "m", forward),
                "left": ("displacement_left", "m", left),
                "turned": ("displacement_turn", "rad", turn),
            }
            steps, turns = forward[1:], turn[1:]
        self.reference_columns = [f'{{ column = "{n}", meaning = "{m}", unit = "{u}" }}' for n, (m, u, _) in values.items()]
        is_out = np.zeros(len(stamps), bool)
        if self.trouble == "outages" and self.reference != "displacement":
            for share, lasts_s in ((0.3, 12.0), (0.7, 6.0)):
                is_out |= (stamps > share * world.lasts_s) & (stamps < share * world.lasts_s + lasts_s)
        text = {name: [f"{v:.5f}" for v in value[~is_out]] for name, (_, _, value) in values.items()}
        self.write_table("reference.csv", {"t": [f"{t:.4f}" for t in stamps[~is_out]], **text})
        self.stamps = stamps
        self.reference_way = np.concatenate([[0.0], np.cumsum(steps)])
        self.reference_turn = np.concatenate([[0.0], np.cumsum(turns)])

    def write_table(self, name, columns):
        with (self.folder / name).open("w", newline="") as out:
            table = csv.writer(out)
            table.writerow(columns)
            table.writerows(zip(*columns.values()))

    def write_robot(self):
        sensor = {"count": "count", "angle": "angle"}.get(self.sensor, "rate")
        lines = ["format = 1", 'name = "random"', "[estimator]", f'wheel_sensor = "{sensor}"']
        if self.is_told and self.reference == "pose":
            lines += [f"position_sigma_m = {self.sigma}", f"yaw_sigma_deg = {math.degrees(self.yaw_sigma):.4f}"]
        if self.is_told and self.reference == "speed":
            lines.append(f"speed_sigma_m_per_s = {self.sigma}")
        if self.is_told and self.delay:
            lines += ["[filter]", f"reference_latency_s = {self.delay}"]
        if self.world.kind == "car":
            lines += ["[steering]", 'kind = "ackermann"', 'wheels = ["w0", "w1"]']
        track, radius = (1.05, 1.01) if self.trouble == "geometry" else (1.0, 1.0)
        for name, (x, y) in zip(self.names, self.world.places):
            lines += ["[[wheel]]", f'name = "{name}"', f"x_m = {x:.5f}", f"y_m = {track * y:.5f}"]
            lines += [f"radius_m = {radius * self.world.radius:.5f}"]
            lines += ['drive = "powered"', 'encoder_on = "wheel"', f"ticks_per_turn = {self.ticks}"]
        (self.folder / "robot.toml").write_text("\n".join(lines) + "\n")
        lines = ["format = 1"]
        for file, columns in (("wheels.csv", self.wheel_columns), ("reference.csv", self.reference_columns)):
            lines += ["[[table]]", f'file = "{file}"', 'time = { column = "t", unit = "s" }', f"columns = [{', '.join(columns)}]"]
        (self.folder / "columns.toml").write_text("\n".join(lines) + "\n")

    def naive(self, wheel, at_s, window_s):
        """Mean slip over the last window of the reference's readings; None where it has none."""
        last = np.searchsorted(self.stamps, at_s, side="right") - 1
        if last < 1:
            return None
        first = np.searchsorted(self.stamps, self.stamps[last] - window_s - 0.01 / self.rate, side="left")
        if first >= last:
            return None
        times = self.world.time[self.rows]
        known_delay = self.delay if self.is_told else 0.0
        begin, end = np.interp(self.stamps[[first, last]] - known_delay, times, self.ways[wheel])
        if abs(end - begin) < 0.02 * window_s:
            return None
        x, y = self.world.places[wheel]
        way = self.reference_way[last] - self.reference_way[first]
        if self.world.kind != "car" or x == 0:
            way -= (self.reference_turn[last] - self.reference_turn[first]) * y
        return float(np.clip(1 - way / (end - begin), -1, 1))


def scores(log):
    """Root mean square errors of the estimate and of the naive means, and how honest its intervals are."""
    folder, world = log.folder, log.world
    files = [folder / name for name in ("wheels.csv", "reference.csv")]
    arguments = ["--robot", folder / "robot.toml", "--map", folder / "columns.toml", "-o", folder / "slip.csv", "--json"]
    done = subprocess.run([GROUSER, "estimate", *files, *arguments], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        return {"code": done.returncode, "error": done.stderr.splitlines()[:2]}
    found = {name: [] for name in log.names}
    with (folder / "slip.csv").open() as table:
        for row in csv.DictReader(table):
            if row["wheel"] in found and row["slip"]:
                found[row["wheel"]].append((float(row["time_s"]), float(row["slip"]), float(row["slip_sigma"]), row["health"]))
    errors, squares = {"filter": [], 1.0: [], 2.0: []}, []
    longest_s = 0.0
    for wheel, name in enumerate(log.names):
        times = np.array([row[0] for row in found[name]])
        began_s = None
        for i in range(int(SETTLED_S / STEP_S), len(world.time), 50):
            at_s = world.time[i]
            row = np.searchsorted(times, at_s, side="right") - 1
            if abs(world.rims[wheel][i]) < MIN_RIM_M_PER_S or row < 0 or at_s - times[row] > 0.3:
                continue
            naive = {window: log.naive(wheel, at_s, window) for window in (1.0, 2.0)}
            if None in naive.values():
                continue
            _, slip, sigma, health = found[name][row]
            true = world.slips[wheel][i]
            errors["filter"].append(slip - true)
            for window, value in naive.items():
                errors[window].append(value - true)
            is_off = health == "Ok" and abs(slip - true) > 4 * sigma
            began_s = (at_s if began_s is None else began_s) if is_off else None
            longest_s = max(longest_s, at_s - began_s + 0.1 if is_off else 0.0)
            if health == "Ok":
                squares.append(((slip - true) / max(sigma, 1e-9)) ** 2)
    if not errors["filter"]:
        return {"code": done.returncode, "error": ["nothing to compare"]}
    rmse = {key: float(np.sqrt(np.mean(np.square(value)))) for key, value in errors.items()}
    squares = np.array(squares)
    return {
        "code": done.returncode,
        "filter": rmse["filter"],
        "naive": min(rmse[1.0], rmse[2.0]),
        "nees": float(squares.mean()) if len(squares) else None,
        "in_90": float((squares < 1.645**2).mean()) if len(squares) else None,
        "longest_beyond_s": float(longest_s),
        "beyond_4_sigma": float((squares > 16).mean()) if len(squares) else None,
    }


def main():
    given = [int(text) for text in sys.argv[1:4]]
    first, count, thinned_hz = given + [0, 100, None][len(given) :]
    trouble = sys.argv[4] if len(sys.argv) > 4 else None
    if trouble not in (None, *TROUBLES):
        sys.exit("\n".join(f"{name}: {what}" for name, what in TROUBLES.items()))
    ratios, results = [], []
    for seed in range(first, first + count):
        random = np.random.default_rng(seed)
        with tempfile.TemporaryDirectory() as folder:
            log = Log(World(random, trouble), random, pathlib.Path(folder), thinned_hz, trouble)
            result = scores(log)
        what = {key: getattr(log, key) for key in ("sensor", "reference", "rate", "sigma", "delay", "is_told", "has_gyro")}
        what |= {"kind": log.world.kind, "profile": log.world.profile, "top": round(float(log.world.top), 2)}
        print(seed, json.dumps({k: round(v, 4) if isinstance(v, float) else v for k, v in result.items()}), json.dumps(what), flush=True)
        if "filter" in result:
            results.append(result)
            ratios.append(result["filter"] / result["naive"])
    honest = [result for result in results if result["nees"] is not None]
    print(f"{len(results)} of {count} logs")
    print(f"error over the better naive mean's: median {np.median(ratios):.2f}, geometric mean {np.exp(np.mean(np.log(ratios))):.2f}")
    print(f"worse than it: {sum(ratio > 1 for ratio in ratios)}, by more than a half: {sum(ratio > 1.5 for ratio in ratios)}")
    print(f"doubtful by its own checks: {sum(result['code'] == 3 for result in results)}")
    print(f"squared error over variance, median: {np.median([result['nees'] for result in honest]):.2f}")
    print(f"logs with more than 1 % of the Ok estimates beyond four sigma: {sum(r['beyond_4_sigma'] > 0.01 for r in honest)}")
    print(f"for a second or longer: {sum(r['longest_beyond_s'] > 0.95 for r in honest)}")
    print(f"90 % intervals hold: {np.mean([r['in_90'] for r in honest]):.3f}")


if __name__ == "__main__":
    main()
