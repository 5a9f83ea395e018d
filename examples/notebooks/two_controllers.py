"""A marimo notebook: two controllers on the same ground, seed by seed.

`marimo edit two_controllers.py` opens it; `python two_controllers.py` runs it. The same seed is the same ground and the
same noise for both; neither sees the truth.
"""

import marimo

app = marimo.App()


@app.cell
def _():
    from pathlib import Path

    import numpy as np

    from grouser import drive, figures

    scenario = drive.read(Path(__file__).resolve().parents[1] / "scenarios" / "sandbox.toml")
    SEEDS, DURATION_S = [1, 2, 3], 8.0
    return DURATION_S, SEEDS, drive, figures, np, scenario


@app.cell
def _(drive, scenario):
    def proportional(seen):
        """Slows all wheels where their mean slip exceeds the slip of greatest efficiency."""
        slips = [wheel.slip for wheel in seen.wheels if wheel.slip is not None]
        excess = max(0.0, sum(slips) / len(slips) - scenario.optimum_slip) if slips else 0.0
        return [drive.WheelCommand(seen.requested_speed_mps * max(0.2, 1.0 - 3.0 * excess)) for _ in seen.wheels]

    return (proportional,)


@app.cell
def _(DURATION_S, SEEDS, drive, proportional, scenario):
    runs = {
        "proportional": [drive.run(scenario, controller=proportional, seed=k, duration_s=DURATION_S) for k in SEEDS],
        "Grouser's": [drive.run(scenario, pilot="controller", seed=k, duration_s=DURATION_S) for k in SEEDS],
    }
    return (runs,)


@app.cell
def _(SEEDS, np, runs):
    # pairs: what differs between the seeds is the same for both
    energy = {name: np.array([run.energy_j / run.distance_m for run in some]) for name, some in runs.items()}
    difference = energy["proportional"] - energy["Grouser's"]
    spread = difference.std(ddof=1) / np.sqrt(len(SEEDS))
    print(f"energy a metre, proportional less Grouser's: {difference.mean():.1f} ± {spread:.1f} J/m over {len(SEEDS)} seeds")
    for name, some in runs.items():
        print(f"{name:14s} {np.mean([run.distance_m for run in some]):.2f} m, worst slip {max(run.worst_slip for run in some):.2f}")
    return difference, energy, spread


@app.cell
def _(figures, np, runs):
    slips = figures.lines(
        "True slip of the first wheel, first seed",
        "Time (s)",
        "Slip *s*",
        *[
            figures.Line(some[0].track["time_s"][::10], np.clip(some[0].track["slip"][::10, 0], -1.0, 1.0), name)
            for name, some in runs.items()
        ],
    )
    slips
    return (slips,)


if __name__ == "__main__":
    app.run()
