"""A marimo notebook: the wheel of a light rover, chosen from a Pareto front of mass against pull and sinkage.

`marimo edit pareto_choice.py` opens it; `python pareto_choice.py` runs it.
"""

import marimo

app = marimo.App()


@app.cell
def _():
    import numpy as np

    from grouser import figures, optimize, soils, wheel

    LOAD_N, SLIP = 40.0, 0.2
    SOILS = [soils.find("dry-sand"), soils.find("sandy-loam")]
    return LOAD_N, SLIP, SOILS, figures, np, optimize, wheel


@app.cell
def _(LOAD_N, SLIP, SOILS, optimize, wheel):
    def mass_kg(x):
        # a rim of 1.5 mm aluminium and a disc of 2 mm; the formula is the designer's own
        radius, width = x
        return 2700.0 * (2.0 * 3.1416 * radius * width * 1.5e-3 + 3.1416 * radius**2 * 2e-3)

    def worst_pull_n(x):
        # the worse of both soils: what is promised wherever the rover stands
        radius, width = x
        points = [
            wheel.under_load(soil, radius_m=radius, width_m=width, load_n=LOAD_N, slip=SLIP, threads=1)
            for soil in SOILS
        ]
        return min(point.drawbar_pull_n for point in points)

    front = optimize.pareto(
        lambda x: [mass_kg(x), -worst_pull_n(x)],
        start=[0.12, 0.1],
        lower=[0.06, 0.04],
        upper=[0.2, 0.2],
        population=24,
        generations=25,
        polish=False,
    )
    return front, mass_kg, worst_pull_n


@app.cell
def _(figures, front, np):
    order = np.argsort(front.objectives[:, 0])
    mass, pull = front.objectives[order, 0], -front.objectives[order, 1]
    chosen = front.knee if front.knee is not None else 0
    shown = figures.lines(
        "What a kilogram buys",
        "Mass (kg)",
        "Least pull on two soils (N)",
        figures.Line(mass, pull, "front", points=True),
        figures.Line(front.objectives[[chosen], 0], -front.objectives[[chosen], 1], "chosen", points=True),
    )
    shown
    return chosen, mass, pull, shown


@app.cell
def _(SOILS, chosen, figures, front, wheel):
    radius, width = front.x[chosen]
    print(f"radius {1e3 * radius:.0f} mm, width {1e3 * width:.0f} mm: {front.objectives[chosen, 0]:.2f} kg")
    design = wheel.Wheel(radius_m=radius, width_m=width)
    curves = figures.slip_curves(SOILS[0], design, load_n=[20.0, 40.0, 60.0])
    curves
    return curves, design


if __name__ == "__main__":
    app.run()
