"""A marimo notebook: from plate, shear and wheel tests to a soil with intervals, a wheel on it, its best slip, a drive, and
the slip in its robot's log.

`marimo edit plate_to_drive.py` opens it; `python plate_to_drive.py` runs it.
"""

import marimo

app = marimo.App()


@app.cell
def _():
    from pathlib import Path

    import numpy as np

    from grouser import drive, figures, identify, logs, wheel

    examples = Path(__file__).resolve().parents[1]
    return Path, drive, examples, figures, identify, logs, np, wheel


@app.cell
def _(examples, identify):
    # plates, a shear ring and a wheel in the test bed: every number of the soil with its 95 % interval
    found = identify.run(examples / "bevameter" / "tests.toml")
    for _name, _number in found.numbers.items():
        print(f"{_name:20s} {_number.value:10.4g}  [{_number.low:.4g}, {_number.high:.4g}]  {_number.verdict}")
    sand = found.soil
    return found, sand


@app.cell
def _(figures, sand, wheel):
    rim = wheel.Wheel(radius_m=0.125, width_m=0.1)
    pull = figures.slip_curves(sand, rim, load_n=[40.0, 80.0, 120.0])
    pull
    return pull, rim


@app.cell
def _(rim, sand, wheel):
    contact = wheel.WheelOnSoil(rim, sand)
    best_slip, efficiency = contact.slip_of_maximum_efficiency(load_n=60.0)
    print(f"best slip {best_slip:.3f}, efficiency {efficiency:.3f}")
    return best_slip, contact, efficiency


@app.cell
def _(np, rim, sand, wheel):
    # how the best slip moves with the load: one call
    loads = np.linspace(20.0, 120.0, 51)[:, np.newaxis]
    slips = np.linspace(0.01, 0.95, 400)
    table = wheel.under_load(sand, radius_m=rim.radius_m, width_m=rim.width_m, load_n=loads, slip=slips)
    efficiency_of = table.drawbar_pull_n * (1.0 - slips) * rim.radius_m / table.torque_nm
    best_of_load = slips[np.nanargmax(efficiency_of, axis=1)]
    return best_of_load, efficiency_of, loads, slips, table


@app.cell
def _(drive, examples):
    scenario = drive.read(examples / "scenarios" / "sandbox.toml")

    def slip_limit(seen):
        slips = [wheel.slip for wheel in seen.wheels if wheel.slip is not None]
        mean = sum(slips) / len(slips) if slips else 0.0
        speed = seen.requested_speed_mps * min(1.0, max(0.2, 1.4 - 4.0 * mean))
        return [drive.WheelCommand(speed) for _ in seen.wheels]

    runs = {
        "own": drive.run(scenario, controller=slip_limit, seed=3, duration_s=5.0),
        "ours": drive.run(scenario, pilot="controller", seed=3, duration_s=5.0),
        "open loop": drive.run(scenario, pilot="open-loop", seed=3, duration_s=5.0),
    }
    for name, run in runs.items():
        print(f"{name}: {run.distance_m:.2f} m, {run.energy_j:.0f} J, worst slip {run.worst_slip:.2f}")
    return runs, scenario, slip_limit


@app.cell
def _(examples, figures, logs):
    five = examples / "five-wheel"
    robot = logs.Robot.read(five / "robot.toml")
    result = logs.estimate(five / "log.csv", robot, columns=five / "columns.toml")
    first = result.rows.wheel == 0
    track = figures.lines(
        "Slip in the log",
        "Time (s)",
        "Slip *s*",
        figures.Line(result.rows.time_s[first], result.rows.slip[first], robot.wheels[0]),
    )
    track
    return result, robot, track


if __name__ == "__main__":
    app.run()
