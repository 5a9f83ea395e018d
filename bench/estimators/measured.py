"""Measured logs of other robots: a fast car with late and held readings, a differential robot, a lawn mower that does not slip.

The car's truth is on the clock of the motion capture, by which the encoder is late by 0.05 to 0.15 s. A perfect estimate on the
encoder's clock has an error of 0.004 to 0.016 of slip by that.
"""

import gzip
import math

import numpy as np

from truth import Distances, Log, WheelRun, centre_distance, displacements, naive_series, over_windows, sliding, write_map

SPAN_S = 0.5
FROM_S = 3.0
# dart: two fast runs with hard turns, two easy ones, one whose encoder has no sign and whose motion capture is lost for 13 s
DART = {
    "free_turns_fast": "dart-fast",
    "free_turns_fastest": "dart-fastest",
    "circles_rubber": "dart-easy",
    "throttle_ramp": "dart-easy",
    "racetrack_unsigned_encoder": "dart-unsigned",
}
DART_STEP_S = 0.05
DART_LOST_M_PER_S = 8.0  # faster than the car: motion capture lost
# The marker is 0.09 m in front of the rear axle (its sideways speed in turns) and goes up to 0.012 farther than the axle.
DART_SIGMA = 0.01
DART_MIN_SPEED_M_PER_S = 0.2
# optiodom: a tick is 0.094 mm; motion capture resampled to 0.05 s scatters by 0.2 mm while stationary (first rows of the logs).
# Its clock and that of the ticks agree to 5 ms: assumed, a tenth of a row.
OPTIODOM_RADIUS_M, OPTIODOM_TICKS, OPTIODOM_HALF_TRACK_M = 0.042, 64 * 43.7, 0.1
OPTIODOM_SIGMA_M, OPTIODOM_TIME_SIGMA_S = 0.0002, 0.005
PLAZA_RADIUS_M = 0.3
PLAZA_SIGMA = 0.0006  # wheels and path differ by less over 90 % of all seconds


def read(path):
    with gzip.open(path, "rt") as lines:
        names = lines.readline().strip().split(",")
        return dict(zip(names, np.loadtxt(lines, delimiter=",").T))


def robot_file(folder, name, wheels, estimator=()):
    lines = ["format = 1", f'name = "{name}"', *estimator]
    for wheel in wheels:
        lines += ["[[wheel]]", 'drive = "powered"', *(f"{key} = {value}" for key, value in wheel.items())]
    (folder / "robot.toml").write_text("\n".join(lines) + "\n")
    return folder / "robot.toml"


POSE = [("x_m", "pose_x", "m", None), ("y_m", "pose_y", "m", None), ("yaw_rad", "pose_yaw", "rad", None)]


def naive_over(series_s, readings, begins, ends, min_wheel_m):
    series = naive_series(readings, series_s, min_wheel_m)
    return {key: over_windows(series_s, values, begins, ends) for key, values in series.items()}


def dart(path, folder):
    table = read(path)
    time_s, wheel_speed = table["time_s"], table["wheel_speed_m_per_s"]
    steps_s = np.arange(time_s[0], time_s[-1], DART_STEP_S)
    x, y, yaw = (np.interp(steps_s, time_s, values) for values in (table["x_m"], table["y_m"], np.unwrap(table["yaw_rad"])))
    forward, left, _ = displacements(x, y, yaw)
    moved = np.copysign(np.hypot(forward, left), forward)
    is_lost = np.hypot(forward, left) > DART_LOST_M_PER_S * DART_STEP_S
    # stationary in the picture while the wheel runs: lost too
    is_lost |= (np.hypot(forward, left) < 1e-4) & (np.abs(np.interp(steps_s, time_s, wheel_speed)) > 0.3)
    is_lost = np.convolve(is_lost, np.ones(41), "same") > 0
    speed = np.where(is_lost, np.nan, moved / DART_STEP_S)
    # the encoder's delay: that by which its speed fits the motion capture best
    lags_s, fits = np.arange(-0.1, 0.4, 0.01), []
    for lag_s in lags_s:
        shifted = np.interp(steps_s - 0.5 * DART_STEP_S + lag_s, time_s, wheel_speed)
        is_used = np.isfinite(speed) & (np.abs(speed) > DART_MIN_SPEED_M_PER_S) & (speed > 0)
        fits.append(np.corrcoef(shifted[is_used], speed[is_used])[0, 1])
    lag_s = float(lags_s[int(np.argmax(fits))])
    wheel_m = np.concatenate([[0.0], np.cumsum(wheel_speed[1:] * np.diff(time_s))])
    aligned = np.interp(steps_s + lag_s, time_s, wheel_m)
    truth = Distances(steps_s, aligned, np.cumsum(np.where(is_lost, 0.0, moved)))
    begins, ends, slip, wheel, _ = sliding(truth, FROM_S, time_s[-1] - 1.0, SPAN_S, DART_MIN_SPEED_M_PER_S * SPAN_S)
    lost_m = np.concatenate([[0.0], np.cumsum(is_lost)])
    lost = np.interp(ends, steps_s, lost_m[1:]) - np.interp(begins, steps_s, lost_m[1:])
    is_good = (lost == 0) & (truth.between(begins, ends)[1] > DART_MIN_SPEED_M_PER_S * SPAN_S)
    begins, ends, slip = begins[is_good], ends[is_good], slip[is_good]
    seen = displacements(table["x_m"], table["y_m"], table["yaw_rad"])
    readings = Distances(time_s, wheel_m, np.cumsum(seen[0]))
    naive = naive_over(time_s, readings, begins, ends, 0.1)
    columns = [("wheel_speed_m_per_s", "wheel_speed", "m/s", "rear"), ("yaw_rate_rad_per_s", "yaw_rate", "rad/s", None), *POSE]
    write_map(folder / "columns.toml", columns, "time_s")
    wheels = [{"name": '"rear"', "x_m": 0.0, "y_m": 0.0, "radius_m": 0.03}]
    robot = robot_file(folder, "dart", wheels, ["[estimator]", 'wheel_sensor = "rate"'])
    name = path.name.split(".")[0]
    run = WheelRun("rear", begins, ends, slip, np.full(len(begins), DART_SIGMA), naive)
    log = Log(name, (DART[name],), folder, [path], robot, folder / "columns.toml", len(time_s), [run])
    log.extra = {"encoder_lag_s": lag_s}
    return log


def optiodom(path, folder):
    table = read(path)
    time_s = table["time_s"]
    moved = displacements(table["x_m"], table["y_m"], table["yaw_rad"])
    runs = []
    for name, side in (("left", 1), ("right", -1)):
        wheel_m = table[f"{name}_ticks"] / OPTIODOM_TICKS * 2 * math.pi * OPTIODOM_RADIUS_M
        place = (0.0, side * OPTIODOM_HALF_TRACK_M)
        distances = Distances(time_s, wheel_m, centre_distance(*moved, place, 0.0))
        begins, ends, slip, wheel, centre = sliding(distances, FROM_S, time_s[-1] - 1.5, SPAN_S, 0.02)
        at_ends = np.hypot(OPTIODOM_SIGMA_M, OPTIODOM_TIME_SIGMA_S * np.abs(centre) / SPAN_S)
        sigma = math.sqrt(2) * at_ends / np.abs(wheel)
        naive = naive_over(time_s, distances, begins, ends, 0.02)
        runs.append(WheelRun(name, begins, ends, slip, sigma, naive))
    columns = [(f"{name}_ticks", "wheel_count", "tick", name) for name in ("left", "right")] + POSE
    write_map(folder / "columns.toml", columns, "time_s")
    wheels = [
        {"name": f'"{name}"', "x_m": 0.0, "y_m": side * OPTIODOM_HALF_TRACK_M, "radius_m": OPTIODOM_RADIUS_M}
        | {"encoder_on": '"wheel"', "ticks_per_turn": OPTIODOM_TICKS}
        for name, side in (("left", 1), ("right", -1))
    ]
    robot = robot_file(folder, "optiodom", wheels)
    return Log(path.name.split(".")[0], ("optiodom",), folder, [path], robot, folder / "columns.toml", len(time_s), runs)


def plaza(path, folder):
    """The mower does not slip: every slip is an error, and that of the whole distance."""
    table = read(path)
    time_s, wheel_m = table["time_s"], table["distance_m"]
    moved = displacements(table["x_m"], table["y_m"], table["yaw_rad"])
    distances = Distances(time_s, wheel_m, np.cumsum(np.hypot(moved[0], moved[1])))
    begins, ends, _, wheel, _ = sliding(distances, FROM_S, time_s[-1] - 2, 1.0, 0.3, 0.5)
    readings = Distances(time_s, wheel_m, np.cumsum(moved[0]))
    # the distance has no sign, and the mower reverses near 1407 s
    is_forward = readings.between(begins, ends)[1] > 0.5 * wheel
    begins, ends = begins[is_forward], ends[is_forward]
    naive = naive_over(time_s, readings, begins, ends, 0.1)
    columns = [("distance_m", "wheel_distance", "m", "wheels"), ("yaw_rate_rad_s", "yaw_rate", "rad/s", None)] + POSE
    write_map(folder / "columns.toml", columns, "time_s")
    robot = robot_file(folder, "mower", [{"name": '"wheels"', "x_m": 0.0, "y_m": 0.0, "radius_m": PLAZA_RADIUS_M}])
    run = WheelRun("wheels", begins, ends, np.zeros(len(begins)), np.full(len(begins), PLAZA_SIGMA), naive)
    log = Log("plaza1", ("plaza",), folder, [path], robot, folder / "columns.toml", len(time_s), [run])
    log.whole = (0.0, float(time_s[-1]))
    log.extra = {"time_s": time_s, "wheel_m": wheel_m}
    return log


def logs(data):
    for name, make in (("dart", dart), ("optiodom", optiodom), ("plaza", plaza)):
        for path in sorted((data / name).glob("*.csv.gz")):
            log = path.name.split(".")[0]
            yield (DART.get(log, name),), log, lambda folder, path=path, make=make: make(path, folder)
