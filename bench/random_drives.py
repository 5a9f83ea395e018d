"""`grouser drive` on robots, soils, reliefs, gravities, sensors and legs drawn at random: open loop at the controller's own mean speed next to the controller.

    cargo build --release && python bench/random_drives.py [FIRST [COUNT]]

The soil is the one that the controller knows, but for its scatter and compaction, and in two of five drives the ground obeys another
law. A controller that decides on wrong slips does worse than open loop here: it backs out of ground that carries the robot.
"""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).parents[1]
GROUSER = ROOT / "target" / "release" / "grouser"
SOILS = ["dry-sand", "dry-sand", "sandy-loam", "mars-sim-sand", "hit-lss1", "lunar", "clayey-soil"]
# without measured coefficients of the greatest stress: those of the Lunar Sourcebook
COEFFICIENTS = "c_1 = 0.4\nc_2 = 0.15\n"
LAWS = [None, None, "slip-velocity-regular", "independent", "towed-restart"]


def ground(draw, kind):
    match kind:
        case "slope":
            return [f"slope_deg = {draw.uniform(2, 12):.1f}", "from_m = 6.0"]
        case "dunes":
            return [f"height_m = {draw.uniform(0.05, 0.35):.2f}", f"length_m = {draw.uniform(3, 8):.1f}"]
        case "fractal":
            return [f"height_m = {draw.uniform(0.01, 0.08):.3f}", f"length_m = {draw.uniform(2, 6):.1f}"]
    return []


def legs(draw):
    """(speed m/s, heading °, length m or duration s)"""
    speed = draw.uniform(0.08, 0.4)
    out = [(speed, 0, draw.uniform(3, 8))]
    if draw.random() < 0.5:
        out.append((0, 0, 2))
    kind = draw.random()
    if kind < 0.35:
        out.append((-speed, 0, draw.uniform(1.5, 4)))
    elif kind < 0.7:
        out.append((speed, draw.choice([-40, 40, 90, -90, 170]), draw.uniform(2, 4)))
    return out


def scenario(seed):
    """The scenario's text, and what it is in a line."""
    draw = random.Random(seed)
    robot = draw.choice(["five-wheel", "rocker-bogie", "skid-steer"])
    soil = draw.choice(SOILS)
    gravity = draw.choice(["earth"] * 4 + ["mars", "moon"])
    kind = draw.choice(["flat", "slope", "dunes", "fractal"])
    lines = ["format = 1", f'title = "drive {seed}"', f'robot = "{ROOT}/examples/robots/{robot}.toml"']
    lines += [f'gravity_m_per_s2 = "{gravity}"', f"seed = {seed}", "duration_s = 240.0", "hotel_w = 4.0"]
    law = draw.choice(LAWS)
    if law:
        lines.append(f'world_laws = "{law}"')
    lines += ["[start]", "x_m = 4.0", "[ground]", f'kind = "{kind}"', "size_x_m = 30.0", "size_y_m = 20.0", 'soil = "known"']
    lines.append(f"scatter = {draw.uniform(0, 0.12):.3f}")
    if draw.random() < 0.4:
        lines.append(f"packing = {draw.uniform(0.1, 0.5):.2f}")
    lines += ground(draw, kind)
    lines += ["[[soil]]", 'name = "known"', f'key = "{soil}"']
    if soil in ("mars-sim-sand", "hit-lss1"):
        lines.append(COEFFICIENTS)
    lines += ["[sensors]", f"rate_hz = {draw.choice([50.0, 100.0])}"]
    reference = "free wheel" if robot == "five-wheel" else ""
    if robot != "five-wheel" or draw.random() < 0.3:
        if draw.random() < 0.6:
            lines.append(f"camera_rate_hz = {draw.choice([5.0, 10.0, 20.0])}")
            reference += " camera"
        else:
            lines.append(f"gnss_rate_hz = {draw.choice([2.0, 5.0, 10.0])}")
            lines.append(f"gnss_sigma_m = {draw.choice([0.01, 0.02, 0.05])}")
            reference += " fixes"
    way = legs(draw)
    for speed, heading, amount in way:
        lines += ["[[leg]]", f"speed_m_per_s = {speed:.3f}"]
        lines.append(f"duration_s = {amount}" if speed == 0 else f"distance_m = {amount:.2f}")
        if heading:
            lines.append(f"heading_deg = {heading}.0")
    rounded = [(round(speed, 2), heading, round(amount, 1)) for speed, heading, amount in way]
    return "\n".join(lines) + "\n", f"{robot}, {soil}, {gravity}, {kind}, {law or 'own law'}, {reference.strip()}, {rounded}"


def summary(name, runs):
    arrived = sum(run["outcome"] == "arrived" for run in runs)
    seen = [run for run in runs if run["slip_rmse"]]
    rmse = math.exp(sum(math.log(run["slip_rmse"]) for run in seen) / len(seen))
    wrong = sum(run["slip_wrong_longest_s"] > 1 for run in runs)
    scaled = sum(run["slip_squared_error_over_variance"] for run in seen) / len(seen)
    print(f"{name}: {arrived} of {len(runs)} arrived; RMSE of slip {rmse:.4f} (geometric mean), squared error over variance {scaled:.2f}, Ok and wrong for over 1 s in {wrong}")


def main():
    first, count = ([int(text) for text in sys.argv[1:3]] + [0, 100][len(sys.argv) - 1 :])[:2]
    pairs = []
    for seed in range(first, first + count):
        text, what = scenario(seed)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "drive.toml"
            path.write_text(text)
            command = [GROUSER, "drive", path, "--compare", "open-loop,controller", "--json"]
            done = subprocess.run(command, capture_output=True, text=True)
        if not done.stdout.strip():
            sys.exit(f"{seed}: {done.stderr}{text}")
        pair = json.loads(done.stdout)["runs"]
        of = lambda run: f"{run['outcome']} {run['distance_m']:.1f} m {run['duration_s']:.0f} s, RMSE {run['slip_rmse'] or math.nan:.3f}"
        print(seed, *(of(run) for run in pair), what, sep=" | ", flush=True)
        pairs.append(pair)
    summary("open loop", [pair[0] for pair in pairs])
    summary("controller", [pair[1] for pair in pairs])
    arrives = lambda run: run["outcome"] == "arrived"
    lost = sum(arrives(before) and not arrives(after) for before, after in pairs)
    won = sum(arrives(after) and not arrives(before) for before, after in pairs)
    print(f"only open loop arrives in {lost}, only the controller in {won}")


if __name__ == "__main__":
    main()
