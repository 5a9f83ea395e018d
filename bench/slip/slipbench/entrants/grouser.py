"""Grouser by its command: `grouser estimate`, offline (the whole log) and online (what the robot would have known).

The environment variable GROUSER names the command. The robot file states what the log states: geometry, encoders, and the noise of the data
sheets. Intervals are slip ± 1.645 slip_sigma where the health is Ok, which is where Grouser says that they hold.
"""

from __future__ import annotations

import csv
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import Dict, List, Optional

import numpy as np

from slipbench.log import Estimates, Floats, Log, Series

Z_90 = 1.645
LIMIT_S = 120


def command() -> Optional[str]:
    return shutil.which(os.environ.get("GROUSER", "grouser"))


def estimate(log: Log, is_online: bool) -> Estimates:
    program = command()
    if program is None:
        raise RuntimeError("no command grouser: set GROUSER to its path")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        files = write(log, folder)
        out = folder / "out.csv"
        line = [program, "estimate", *files, "--robot", folder / "robot.toml", "-o", out, *(["--online"] if is_online else [])]
        done = subprocess.run([str(word) for word in line], capture_output=True, text=True, timeout=LIMIT_S, check=False)
        # 3: a result, with a doubt
        if done.returncode not in (0, 3) or not out.exists():
            raise RuntimeError(f"grouser: exit {done.returncode}: {(done.stderr or done.stdout).strip()[:300]}")
        return read(out, log)


def read(path: pathlib.Path, log: Log) -> Estimates:
    rows: Dict[str, List[List[float]]] = {wheel.name: [] for wheel in log.robot.powered}
    with path.open() as table:
        for row in csv.DictReader(table):
            if row["wheel"] in rows:
                sigma = float(row["slip_sigma"] or "nan") if row["health"] == "Ok" else math.nan
                rows[row["wheel"]].append([float(row["time_s"]), float(row["slip"] or "nan"), sigma])
    found = {}
    for name, values in rows.items():
        time_s, slip, sigmas = np.array(values).reshape(-1, 3).T
        found[name] = Series(time_s, slip, slip - Z_90 * sigmas, slip + Z_90 * sigmas)
    return found


def write(log: Log, folder: pathlib.Path) -> List[pathlib.Path]:
    """Writes robot.toml and the tables; returns the tables."""
    robot, reference = log.robot, log.reference
    wheels: Dict[str, Floats] = {"t": log.time_s}
    columns = []
    for wheel in robot.wheels:
        if log.is_odometer:
            wheels[f"{wheel.name}_m"] = log.wheel_distance(wheel.name)
            columns.append(f'{{ column = "{wheel.name}_m", meaning = "wheel_distance", wheel = "{wheel.name}", unit = "m" }}')
            continue
        wheels[f"{wheel.name}_ticks"] = log.counts[wheel.name]
        columns.append(f'{{ column = "{wheel.name}_ticks", meaning = "wheel_count", wheel = "{wheel.name}", unit = "tick" }}')
    if log.rates is not None:
        # roll and pitch are of use beside accelerations only, and refused without
        rates = {"roll_rate": 0, "pitch_rate": 1, "yaw_rate": 2} if log.accelerations is not None else {"yaw_rate": 2}
        for meaning, i in rates.items():
            wheels[meaning] = log.rates[:, i]
            columns.append(f'{{ column = "{meaning}", meaning = "{meaning}", unit = "rad/s" }}')
    if log.accelerations is not None:
        for i, meaning in enumerate(("acceleration_forward", "acceleration_left", "acceleration_up")):
            wheels[meaning] = log.accelerations[:, i]
            columns.append(f'{{ column = "{meaning}", meaning = "{meaning}", unit = "m/s2" }}')
    for link, angle in log.links.items():
        wheels[f"{link}_rad"] = angle
        columns.append(f'{{ column = "{link}_rad", meaning = "joint_angle", link = "{link}", unit = "rad" }}')
    write_table(folder / "wheels.csv", wheels)
    files, tables = [folder / "wheels.csv"], [("wheels.csv", columns)]
    meanings = {
        "pose": [("pose_x", "m"), ("pose_y", "m"), ("pose_yaw", "rad")],
        "displacement": [("displacement_forward", "m"), ("displacement_left", "m"), ("displacement_turn", "rad")],
        "speed": [("speed_forward", "m/s")],
        "free-wheel": [],
    }[reference.kind]
    if meanings:
        readings = {"t": reference.time_s} | {name: reference.values[:, i] for i, (name, _) in enumerate(meanings)}
        write_table(folder / "reference.csv", readings)
        files.append(folder / "reference.csv")
        tables.append(("reference.csv", [f'{{ column = "{name}", meaning = "{name}", unit = "{unit}" }}' for name, unit in meanings]))
    (folder / "robot.toml").write_text(robot_file(log, tables))
    return files


def robot_file(log: Log, tables: List[tuple[str, List[str]]]) -> str:
    robot, reference = log.robot, log.reference
    lines = ["format = 1", f'name = "{robot.name}"', "[estimator]", f'reference = "{reference.kind}"']
    if not log.is_odometer:
        lines.append('wheel_sensor = "count"')
    if reference.kind in ("pose", "displacement"):
        lines += [f"position_sigma_m = {reference.sigma}", f"yaw_sigma_deg = {math.degrees(reference.yaw_sigma):.5f}"]
    if reference.kind == "speed":
        lines.append(f"speed_sigma_m_per_s = {reference.sigma}")
    if robot.origin_z_m and log.accelerations is not None and reference.kind != "free-wheel":
        lines.append(f"reference_z_m = {robot.origin_z_m}")
    if robot.links or log.accelerations is not None:
        # with a body, gravity is taken out of the accelerations
        mass = robot.mass_kg
        lines += ["[chassis]", f"mass_kg = {mass}", "cg_x_m = 0.0", "cg_y_m = 0.0", f"cg_z_m = {robot.cg_z_m}"]
        lines += [f"inertia_{axes}_kg_m2 = {share * mass:.4f}" for axes, share in (("xx", 0.02), ("yy", 0.03), ("zz", 0.04))]
    for link in robot.links:
        x, y, z = link.pivot_m
        lines += ["[[link]]", f'name = "{link.name}"', f"pivot_x_m = {x}", f"pivot_y_m = {y}", f"pivot_z_m = {z}", "mass_kg = 0.6"]
        lines += [f'on = "{link.on}"'] if link.on else []
        lines += [f'opposite = "{link.opposite}"'] if link.opposite else []
        lines.append("range_deg = 30.0")
    for wheel in robot.wheels:
        lines += ["[[wheel]]", f'name = "{wheel.name}"', f"x_m = {wheel.x_m:.6g}", f"y_m = {wheel.y_m:.6g}", f"radius_m = {wheel.radius_m:.6g}"]
        lines += [f"width_m = {wheel.width_m:.6g}", f'drive = "{"powered" if wheel.is_powered else "free"}"', 'encoder_on = "wheel"']
        lines += [] if log.is_odometer else [f"ticks_per_turn = {wheel.ticks_per_turn:.6g}"]
        lines += [f"heading_deg = {math.degrees(wheel.heading_rad) % 360:.6g}"] if wheel.heading_rad else []
        lines += [f'on = "{wheel.link}"'] if wheel.link else []
    for file, columns in tables:
        lines += ["[[table]]", f'file = "{file}"', 'time = { column = "t", unit = "s" }', "columns = [", *(f"  {one}," for one in columns), "]"]
    return "\n".join(lines) + "\n"


def write_table(path: pathlib.Path, columns: Dict[str, Floats]) -> None:
    text = {name: [cell(value, name.endswith("_ticks")) for value in values] for name, values in columns.items()}
    with path.open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(text)
        table.writerows(zip(*text.values()))


def cell(value: float, is_count: bool) -> str:
    if math.isnan(value):
        return ""
    return str(int(value)) if is_count else f"{value:.6f}"
