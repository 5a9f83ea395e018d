"""A marimo notebook: Ani, Xu, Xue, Liu & Zhang, J. Cent. South Univ. 19 (2012) 2458-2467, recomputed.

`marimo edit paper_2012.py` opens it; `python paper_2012.py` runs it. The paper prints neither bounds nor a start; what stands
for them in `examples/problems/paper.toml` is marked there as assumed.
"""

import marimo

app = marimo.App()


@app.cell
def _():
    from pathlib import Path

    import numpy as np

    from grouser import figures, optimize, soils, wheel

    examples = Path(__file__).resolve().parents[1]
    return Path, examples, figures, np, optimize, soils, wheel


@app.cell
def _(figures, np, soils, wheel):
    # the paper's soils are those of Wong's tables; its wheel stands at the middle of the figures' ranges
    rim = wheel.Wheel(radius_m=0.1, width_m=0.1)
    slip = np.linspace(0.0, 0.95, 96)
    keys = ["dry-sand", "sandy-loam", "clayey-soil"]
    known = [soils.find(key) for key in keys if key in soils.keys()]
    pulls = figures.lines(
        "Drawbar pull against slip under 60 N",
        "Slip *s*",
        "Drawbar pull *F*_{DP} (N)",
        *[figures.Line(slip, wheel.curve(soil, rim, load_n=60.0, slip=slip).drawbar_pull_n, soil.name) for soil in known],
    )
    pulls
    return known, pulls, rim, slip


@app.cell
def _(examples, optimize):
    # the minimax problem in our reading, from several starts
    optimum = optimize.solve_file(examples / "problems" / "paper.toml")
    print(f"{optimum.status}: the greatest objective is {optimum.maximum:.4f}")
    for _name, _value in zip(optimum.names, optimum.x, strict=True):
        print(f"  {_name} = {_value:.4g}")
    return (optimum,)


@app.cell
def _(known, np, rim, wheel):
    # what the paper calls the optimal slip depends on what is to be greatest
    contact = wheel.WheelOnSoil(rim, known[0])
    of_efficiency, efficiency = contact.slip_of_maximum_efficiency(load_n=60.0)
    dense = np.linspace(0.01, 0.95, 951)
    pull = wheel.curve(known[0], rim, load_n=60.0, slip=dense).drawbar_pull_n
    # the laws let soil that was dug up push like fresh soil: a greatest pull at the end of the range is theirs, not a wheel's
    print(f"greatest efficiency {efficiency:.3f} at slip {of_efficiency:.3f}; greatest pull at slip {dense[pull.argmax()]:.3f}")
    return contact, efficiency, of_efficiency


if __name__ == "__main__":
    app.run()
