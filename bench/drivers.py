"""Logs as drivers write them: is a slip that is called Ok right, and is what is odd named?

    bench/drivers.py GROUSER [CASES] [SEEDS]      a row a case: exit code, share of rows that are Ok, share of these that are wrong, RMSE

GROUSER is the command, CASES names separated by commas or "all", SEEDS as 0:3. Each case is a cart of four wheels with encoders, a gyro and
a pose, whose wheels slip by 0.3 for 12 s, as an MCAP file in which one driver has one habit. A slip is wrong where its error exceeds three
sigmas and 0.05, half a second around the jumps of the true slip left out. Needs NumPy and mcap-ros2-support.
"""

import csv
import math
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np
from mcap_ros2.writer import Writer

JOINT = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
HEADER = JOINT[JOINT.index("=" * 80):]
GEOMETRY = """================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
IMU = """std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
""" + GEOMETRY + HEADER
ODOM = """std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
================================================================================
MSG: geometry_msgs/PoseWithCovariance
geometry_msgs/Pose pose
float64[36] covariance
================================================================================
MSG: geometry_msgs/TwistWithCovariance
geometry_msgs/Twist twist
float64[36] covariance
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Twist
geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
""" + GEOMETRY + HEADER

NAMES = ["front_left", "front_right", "rear_left", "rear_right"]
PLACES = [(0.25, 0.2), (0.25, -0.2), (-0.25, 0.2), (-0.25, -0.2)]
RADIUS_M = 0.1
LENGTH_S = 60.0
SLIPS_S = (20.0, 32.0)
DT_S = 0.001
BASE_S = 1_700_000_000
TICK_RAD = 2 * math.pi / 4096


class Run:
    """A drive and what its drivers publish."""

    def __init__(self, seed, reverses=False, stops=False, wheel_hz=20.0, pose_hz=10.0):
        self.random = random.Random(seed)
        draw = self.random
        self.time = np.arange(int(LENGTH_S / DT_S)) * DT_S
        speed, turn = np.zeros_like(self.time), np.zeros_like(self.time)
        target, until, at = (0.4, 0.0), 4.0, [0.0, 0.0]
        for i, time in enumerate(self.time):
            if time >= until:
                sign = -1.0 if reverses and draw.random() < 0.45 else 1.0
                target = (sign * draw.uniform(0.25, 0.6), draw.uniform(-0.3, 0.3))
                if stops and draw.random() < 0.3:
                    target = (0.0, 0.0)
                until = time + draw.uniform(4, 8)
            at = [now + (to - now) * DT_S / 0.4 for now, to in zip(at, target)]
            speed[i], turn[i] = at
        # it stands for two seconds
        begun = np.clip((self.time - 2) / 0.5, 0, 1)
        self.speed, self.turn = speed * begun, turn * begun
        self.slip = np.where((self.time >= SLIPS_S[0]) & (self.time < SLIPS_S[1]), 0.3, 0.0)
        self.yaw = np.cumsum(self.turn) * DT_S
        self.x = np.cumsum(self.speed * np.cos(self.yaw)) * DT_S
        self.y = np.cumsum(self.speed * np.sin(self.yaw)) * DT_S
        angles = [np.cumsum((self.speed - self.turn * y) / (1 - self.slip) / RADIUS_M) * DT_S for _, y in PLACES]
        self.joints, self.imu, self.pose = [], [], []
        for i in self.moments(wheel_hz):
            before = max(i - 20, 0)
            rates = [(of[i] - of[before]) / max((i - before) * DT_S, DT_S) for of in angles]
            ticks = [math.floor(of[i] / TICK_RAD) * TICK_RAD for of in angles]
            self.joints.append(dict(self.stamped(i, 0.004), name=list(NAMES), position=ticks, velocity=rates))
        for i in self.moments(50.0):
            self.imu.append(dict(self.stamped(i, 0.003), rate=self.turn[i] + 0.003 + draw.gauss(0, 0.004)))
        for i in self.moments(pose_hz):
            noise = [draw.gauss(0, sigma) for sigma in (0.002, 0.002, 0.004)]
            place = dict(zip(("x", "y", "yaw"), (self.x[i] + noise[0], self.y[i] + noise[1], self.yaw[i] + noise[2])))
            self.pose.append(dict(self.stamped(i, 0.02), frame="map", child="base_link", **place))

    def moments(self, hz):
        return [min(round(k / hz / DT_S), len(self.time) - 1) for k in range(int(LENGTH_S * hz))]

    def stamped(self, i, delay):
        return dict(i=i, stamp=BASE_S + self.time[i], log=BASE_S + self.time[i] + delay)

    def write(self, folder):
        """The log, and a robot file that is right."""

        def header(m, frame):
            ns = round(m["stamp"] * 1e9)
            return dict(stamp={"sec": ns // 10**9, "nanosec": ns % 10**9}, frame_id=frame)

        def xyz(x=0.0, y=0.0, z=0.0):
            return dict(x=x, y=y, z=z)

        def orientation(yaw=0.0):
            return dict(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))

        def joint(m):
            return dict(header=header(m, ""), name=m["name"], position=m["position"], velocity=m["velocity"], effort=[])

        def imu(m):
            unknown = [-1.0] + [0.0] * 8
            rate = dict(angular_velocity=xyz(z=m["rate"]), angular_velocity_covariance=[0.0] * 9)
            force = dict(linear_acceleration=xyz(z=9.81), linear_acceleration_covariance=unknown)
            return dict(header=header(m, "base_link"), orientation=orientation(), orientation_covariance=unknown, **rate, **force)

        def odometry(m):
            pose = dict(position=xyz(m["x"], m["y"]), orientation=orientation(m["yaw"]))
            still = dict(linear=xyz(), angular=xyz())
            parts = dict(pose=dict(pose=pose, covariance=[0.0] * 36), twist=dict(twist=still, covariance=[0.0] * 36))
            return dict(header=header(m, m["frame"]), child_frame_id=m["child"], **parts)

        log, robot = folder / "log.mcap", folder / "robot.toml"
        kinds = [
            ("/joint_states", "sensor_msgs/msg/JointState", JOINT, joint, self.joints),
            ("/imu/data", "sensor_msgs/msg/Imu", IMU, imu, self.imu),
            ("/vo", "nav_msgs/msg/Odometry", ODOM, odometry, self.pose),
        ]
        with log.open("wb") as out:
            writer = Writer(out)
            messages = []
            for topic, name, definition, message, rows in kinds:
                schema = writer.register_msgdef(name, definition)
                messages += [(m["log"], topic, schema, message(m)) for m in rows]
            for time, topic, schema, message in sorted(messages, key=lambda one: one[0]):
                ns = round(time * 1e9)
                writer.write_message(topic=topic, schema=schema, message=message, log_time=ns, publish_time=ns)
            writer.finish()
        wheels = (
            f'[[wheel]]\nname = "{name}"\nx_m = {x}\ny_m = {y}\nradius_m = {RADIUS_M}\ndrive = "powered"\n'
            for name, (x, y) in zip(NAMES, PLACES)
        )
        robot.write_text('format = 1\nname = "cart"\n[topics]\npose = "/vo"\n' + "".join(wheels))
        return log, robot


def wraps(low, turns):
    """Angles that are kept within a whole number of turns, without velocities."""

    def change(run):
        span = 2 * math.pi * turns
        for m in run.joints:
            m.update(position=[(angle - low) % span + low for angle in m["position"]], velocity=[])

    return change


def sets(rows, **values):
    """Values that take the place of the right ones."""

    def change(run):
        for m in getattr(run, rows):
            m.update({key: list(value) if isinstance(value, list) else value for key, value in values.items()})

    return change


def zero_stamps(rows, share):
    def change(run):
        for m in getattr(run, rows):
            if run.random.random() < share:
                m["stamp"] = 0

    return change


def second(rows, other):
    """A second publisher on a topic."""

    def change(run):
        both = getattr(run, rows)
        both += [{**m, "log": m["log"] + 0.002, **other(m)} for m in list(both)]

    return change


def frozen(begin_s, end_s, noise_m=0.0):
    def change(run):
        held = None
        for m in run.pose:
            if begin_s <= m["stamp"] - BASE_S < end_s:
                held = held or {key: m[key] for key in ("x", "y", "yaw")}
                m.update(held)
                if noise_m:
                    m.update(x=held["x"] + run.random.gauss(0, noise_m), y=held["y"] + run.random.gauss(0, noise_m))

    return change


def held(rows, hz, keys):
    """Rows that repeat the last update."""

    def change(run):
        last, due = None, 0.0
        for m in getattr(run, rows):
            if m["stamp"] - BASE_S >= due - 1e-6:
                last, due = {key: m[key] for key in keys}, due + 1 / hz
            m.update(last)

    return change


def some_missing(run):
    for m in run.joints:
        if run.random.random() < 0.1:
            m["position"] = [math.nan] * 4


def one_wheel_missing(run):
    for m in run.joints:
        m["position"][2] = m["velocity"][2] = math.nan


def without_noise(run):
    for m in run.pose:
        m.update(x=run.x[m["i"]], y=run.y[m["i"]], yaw=run.yaw[m["i"]])


def exact_at_rest(run):
    last = None
    for m in run.pose:
        rests = abs(run.speed[m["i"]]) < 0.004 and abs(run.turn[m["i"]]) < 0.004
        last = (last or {key: m[key] for key in ("x", "y", "yaw")}) if rests else None
        m.update(last or {})


def unsigned_velocities(run):
    for m in run.joints:
        m.update(position=[], velocity=[abs(rate) for rate in m["velocity"]])


def unsigned_counts(run):
    total, last = [0.0] * 4, run.joints[0]["position"]
    for m in run.joints:
        total = [sum_ + abs(now - before) for sum_, now, before in zip(total, m["position"], last)]
        last = m["position"]
        m.update(position=total, velocity=[])


def shuffled_names(run):
    for m in run.joints:
        order = run.random.sample(range(4), 4)
        m.update({key: [m[key][k] for k in order] for key in ("name", "position", "velocity")})


def counters_reset(run):
    zero = next(m["position"] for m in run.joints if m["stamp"] - BASE_S > 41)
    for m in run.joints:
        m["velocity"] = []
        if m["stamp"] - BASE_S > 41:
            m["position"] = [now - then for now, then in zip(m["position"], zero)]


def gyro_stuck(run):
    for m in run.imu:
        if m["stamp"] - BASE_S > 15:
            m["rate"] = 0.0123


def stamps_repeat(run):
    for before, m in zip(run.joints[::2], run.joints[1::2]):
        m["stamp"] = before["stamp"]


def nothing(_run):
    pass


COMMANDS = second("joints", lambda m: {"stamp": m["stamp"] + 0.003, "position": [1.1 * angle for angle in m["position"]]})
ZEROS = second("joints", lambda m: {"stamp": m["stamp"] + 0.003, "position": [0.0] * 4, "velocity": [0.0] * 4})
ARM = second("joints", lambda m: {"stamp": m["stamp"] + 0.003, "name": ["a", "b"], "position": [0.1, 0.2], "velocity": [0.0] * 2})
OTHER = second("pose", lambda m: {"x": 5 - 0.3 * m["x"], "y": 3 + 0.5 * m["x"], "yaw": m["yaw"] + 1})
# name: what is changed, options of the run, words that name it; None where slips must be right and nothing needs a name
CASES = {
    "clean": (nothing, {}, None),
    "reverses": (nothing, dict(reverses=True), None),
    "a turn from -pi": (wraps(-math.pi, 1), {}, None),
    "a turn from 0": (wraps(0.0, 1), {}, None),
    "a turn from -pi at 5 Hz": (wraps(-math.pi, 1), dict(wheel_hz=5.0), None),
    "a turn from 0 at 8 Hz": (wraps(0.0, 1), dict(wheel_hz=8.0), None),
    "two turns": (wraps(-2 * math.pi, 2), {}, None),
    "three turns at 10 Hz": (wraps(0.0, 3), dict(wheel_hz=10.0), None),
    "eight turns": (wraps(0.0, 8), {}, None),
    "sixteen turns": (wraps(-16 * math.pi, 16), {}, None),
    "velocities NaN": (sets("joints", velocity=[math.nan] * 4), {}, None),
    "velocities zero": (sets("joints", velocity=[0.0] * 4), {}, None),
    "positions NaN": (sets("joints", position=[math.nan] * 4), {}, None),
    "positions zero": (sets("joints", position=[0.0] * 4), {}, None),
    "some positions NaN": (some_missing, {}, "no sensor has"),
    "a wheel NaN": (one_wheel_missing, {}, "does not measure wheel"),
    "wheels stamped 0, 1 in 500": (zero_stamps("joints", 0.002), {}, None),
    "wheels stamped 0, 3 %": (zero_stamps("joints", 0.03), {}, None),
    "wheels stamped 0": (zero_stamps("joints", 1.0), {}, None),
    "gyro stamped 0, 3 %": (zero_stamps("imu", 0.03), {}, None),
    "gyro stamped 0": (zero_stamps("imu", 1.0), {}, None),
    "pose stamped 0, 3 %": (zero_stamps("pose", 0.03), {}, None),
    "pose stamped 0": (zero_stamps("pose", 1.0), {}, None),
    "wheels published twice": (second("joints", lambda m: {}), {}, None),
    "pose published twice": (second("pose", lambda m: {}), {}, None),
    "commands published as wheels": (COMMANDS, {}, "two programs"),
    "zeros published as wheels": (ZEROS, {}, "two programs"),
    "an arm on the wheels' topic": (ARM, {}, None),
    "another robot's pose": (OTHER, {}, "two programs"),
    "pose frozen for 3 s": (frozen(40, 43), {}, "frozen"),
    "pose frozen for 10 s": (frozen(40, 50), {}, "frozen"),
    "pose frozen with noise": (frozen(40, 50, 0.002), {}, "frozen"),
    "pose frozen from 15 s on": (frozen(15, 1e9), {}, "frozen"),
    "pose frozen at 2 Hz": (frozen(40, 50), dict(pose_hz=2.0), "frozen"),
    "pose never changes": (frozen(0, 1e9), {}, "frozen"),
    "pose without noise": (without_noise, dict(stops=True), None),
    "pose exact at rest": (exact_at_rest, dict(stops=True), None),
    "velocities without sign": (unsigned_velocities, dict(reverses=True), "no sign"),
    "counts without sign": (unsigned_counts, dict(reverses=True), "no sign"),
    "pose of 2 Hz in rows of 20": (held("pose", 2, ["x", "y", "yaw"]), dict(pose_hz=20.0), "held"),
    "pose of 5 Hz in rows of 50": (held("pose", 5, ["x", "y", "yaw"]), dict(pose_hz=50.0), "held"),
    "wheels of 5 Hz in rows of 20": (held("joints", 5, ["position", "velocity"]), {}, None),
    "gyro of 10 Hz in rows of 50": (held("imu", 10, ["rate"]), {}, None),
    "names in any order": (shuffled_names, {}, None),
    "counters reset": (counters_reset, {}, "faster than the robot"),
    "gyro stuck": (gyro_stuck, {}, None),
    "stamps in pairs": (stamps_repeat, {}, "not later"),
}


def judge(command, case, seed, options):
    """Exit code, shares of rows that are Ok and of these that are wrong, RMSE, and whether the habit was named."""
    change, kind, words = CASES[case]
    run = Run(seed, **kind)
    change(run)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log, robot = run.write(folder)
        out = folder / "out.csv"
        line = [command, "estimate", log, "--robot", robot, "-o", out, *options]
        done = subprocess.run([str(word) for word in line], capture_output=True, text=True, check=False, env={"COLUMNS": "10000"})
        is_named = words is None or words in done.stdout + done.stderr
        rows = list(csv.DictReader(out.open())) if out.exists() else []
    errors, wrong = [], 0
    for row in rows:
        if row["health"] != "Ok" or not row["slip"]:
            continue
        time = float(row["time_s"])
        i = min(int(time / DT_S), len(run.time) - 1)
        if min(abs(time - edge) for edge in SLIPS_S) < 0.5 or abs(run.speed[i]) < 0.05:
            continue
        errors.append(float(row["slip"]) - run.slip[i])
        wrong += abs(errors[-1]) > max(3 * float(row["slip_sigma"]), 0.05)
    share = len(errors) / max(len(rows), 1)
    rmse = math.sqrt(sum(error * error for error in errors) / max(len(errors), 1))
    return done.returncode, share, wrong / max(len(errors), 1), rmse, is_named


def main():
    command = sys.argv[1]
    chosen = sys.argv[2].split(",") if len(sys.argv) > 2 and sys.argv[2] != "all" else list(CASES)
    seeds = range(*map(int, sys.argv[3].split(":"))) if len(sys.argv) > 3 else range(1)
    cases = right = named = 0
    for case in chosen:
        for seed in seeds:
            for mode in ([], ["--online"]):
                code, share, wrong, rmse, is_named = judge(command, case, seed, mode)
                cases, right, named = cases + 1, right + (wrong <= 0.01), named + is_named
                word = "" if is_named else "  NOT NAMED"
                print(f"{case:30} {seed} {'online' if mode else 'whole':6}  exit {code}  Ok {share:.2f}  wrong {wrong:.3f}  RMSE {rmse:.3f}{word}", flush=True)
    print(f"{right} of {cases} with at most 0.01 of the Ok slips wrong, {named} named where they must be")


if __name__ == "__main__":
    main()
