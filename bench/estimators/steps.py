"""Drives whose slip changes in known steps: four wheels with counters, a gyro, poses at 5 Hz with 2 cm of noise.

`steps`: a level of 0.02 to 0.6 each 3 to 12 s. `two-steps`: 0, 0.2 and 0.5 for 40 s each, as in crates/synthetic.
"""

import numpy as np

from truth import Distances, Log, WheelRun, centre_distance, displacements, naive_series, text, write_map, write_table

RATE_HZ, POSE_HZ = 100, 5
RADIUS_M, TICKS = 0.1, 1000
PLACES = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]
POSE_SIGMA_M, YAW_SIGMA_RAD = 0.02, 0.01
GYRO_SIGMA, GYRO_BIAS = 0.002, 0.004
STEP_TIME_S = 0.15
OUTLIER_M = 0.5
OWN_SLIP_SIGMA, OWN_SLIP_TIME_S = 0.005, 5.0
FROM_S, UNTIL_END_S = 3.0, 3.0
POINT_S = 0.1
CELLS = [(0.1, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (2.0, 0.1)]
SEEDS = 4


def levels(random, kind):
    """Times and levels of the common slip, and how long the drive lasts, s."""
    if kind == "two-steps":
        return [(0.0, 0.0), (40.0, 0.2), (80.0, 0.5)], 120.0
    lasts_s, at, out = random.uniform(60, 120), 0.0, []
    while at < lasts_s:
        out.append((at, random.uniform(0.02, 0.6)))
        at += random.uniform(3, 12)
    return out, lasts_s


def drive(kind, speed, outliers, seed, folder):
    random = np.random.default_rng([seed, round(10 * speed), round(100 * outliers), len(kind)])
    changes, lasts_s = levels(random, kind)
    dt = 1 / RATE_HZ
    time_s = np.arange(0, lasts_s, dt)
    slip = np.zeros(len(time_s))
    before = changes[0][1]
    slip += before
    for at, level in changes[1:]:
        slip += (level - before) * np.clip((time_s - at) / STEP_TIME_S, 0, 1)
        before = level
    wheel_speed = speed * (1 + 0.03 * np.sin(2 * np.pi * time_s / 17))
    body = wheel_speed * (1 - slip)
    turn = 0.02 * np.sin(2 * np.pi * time_s / 21)
    yaw = 0.3 + np.cumsum(turn) * dt
    x, y = np.cumsum(body * np.cos(yaw)) * dt, np.cumsum(body * np.sin(yaw)) * dt
    fading = dt / OWN_SLIP_TIME_S
    columns, slips, angles = {"t": text(time_s, 4)}, [], []
    for i, (_, side) in enumerate(PLACES):
        own, noise = np.zeros(len(time_s)), random.normal(size=len(time_s))
        for k in range(1, len(time_s)):
            own[k] = own[k - 1] * (1 - fading) + OWN_SLIP_SIGMA * np.sqrt(2 * fading) * noise[k]
        slips.append(slip + own)
        turned = np.cumsum((body - turn * side) / (1 - slips[-1])) * dt / RADIUS_M
        count = np.floor(turned / (2 * np.pi) * TICKS + random.uniform())
        columns[f"w{i}"] = text(count, 0)
        angles.append(count / TICKS * 2 * np.pi)
    columns["gyro"] = text(turn + GYRO_BIAS + GYRO_SIGMA * random.normal(size=len(time_s)), 5)
    at = np.arange(0, len(time_s), RATE_HZ // POSE_HZ)
    pose = [np.full(len(time_s), np.nan) for _ in range(3)]
    for out, true, sigma in zip(pose, (x, y, yaw), (POSE_SIGMA_M, POSE_SIGMA_M, YAW_SIGMA_RAD)):
        out[at] = true[at] + sigma * random.normal(size=len(at))
    is_outlier, course = random.random(len(at)) < outliers, random.uniform(0, 2 * np.pi, len(at))
    pose[0][at] += OUTLIER_M * np.cos(course) * is_outlier
    pose[1][at] += OUTLIER_M * np.sin(course) * is_outlier
    columns |= {name: text(values, 5) for name, values in zip(("x", "y", "yaw"), pose)}
    write_table(folder / "log.csv", columns)
    meanings = [(f"w{i}", "wheel_count", "tick", f"w{i}") for i in range(4)] + [("gyro", "yaw_rate", "rad/s", None)]
    meanings += [("x", "pose_x", "m", None), ("y", "pose_y", "m", None), ("yaw", "pose_yaw", "rad", None)]
    write_map(folder / "columns.toml", meanings)
    lines = ["format = 1", 'name = "known steps"', "[estimator]", f"position_sigma_m = {POSE_SIGMA_M}"]
    lines.append(f"yaw_sigma_deg = {np.degrees(YAW_SIGMA_RAD):.4f}")
    for i, (px, py) in enumerate(PLACES):
        lines += ["[[wheel]]", f'name = "w{i}"', f"x_m = {px}", f"y_m = {py}", f"radius_m = {RADIUS_M}"]
        lines += ['drive = "powered"', 'encoder_on = "wheel"', f"ticks_per_turn = {TICKS}"]
    (folder / "robot.toml").write_text("\n".join(lines) + "\n")
    points = np.arange(FROM_S, lasts_s - UNTIL_END_S, POINT_S)
    seen = displacements(*(values[at] for values in pose))
    runs = []
    for i, place in enumerate(PLACES):
        readings = Distances(time_s[at], RADIUS_M * angles[i][at], centre_distance(*seen, place, 0.0))
        naive = naive_series(readings, points, 0.02)
        true = np.interp(points, time_s, slips[i])
        runs.append(WheelRun(f"w{i}", points, points, true, np.zeros(len(points)), naive))
    row = f"{kind}-{speed:g}" + ("-outliers" if outliers else "")
    name = f"{row}_{seed}"
    return Log(name, (row,), folder, [folder / "log.csv"], folder / "robot.toml", folder / "columns.toml", len(time_s), runs)


def logs():
    for kind in ("two-steps", "steps"):
        for speed, outliers in CELLS:
            for seed in range(SEEDS):
                row = f"{kind}-{speed:g}" + ("-outliers" if outliers else "")
                make = lambda folder, kind=kind, speed=speed, out=outliers, seed=seed: drive(kind, speed, out, seed, folder)
                yield (row,), f"{row}_{seed}", make
