"""Figures as a table of text and as a Markdown table, with the targets."""

import math
import sys

import judge

# What a row is to reach: RMSE unless another quantity is named; "on" online, "off" offline entrants.
TARGETS = {
    "robotino-full-one": "off 0.030, on 0.045",
    "robotino-full-two": "off 0.030, on 0.045",
    "robotino-5hz-one": "off 0.90 of centred, on 1.0 of trailing",
    "robotino-5hz-two": "off 1.0 of centred, on 1.0 of trailing",
    "high-slip-full": "on: all but one in 3 s, none false",
    "high-slip-5hz": "on: all but one in 3 s, none false",
    "dart-fast": "0.06, and 1.0 of trailing",
    "dart-fastest": "0.06, and 1.0 of trailing",
    "dart-easy": "0.02",
    "dart-unsigned": "",
    "optiodom": "0.022",
    "plaza": "p5 and p95 within 0.01, whole within 0.002",
    "two-steps-0.1": "off 0.028",
    "two-steps-0.5": "off 0.012",
    "two-steps-1": "off 0.008",
    "two-steps-2": "off 0.005",
    "two-steps-3": "off 0.004",
    "two-steps-2-outliers": "off 0.006",
    "steps-0.1": "",
    "steps-0.5": "",
    "steps-1": "",
    "steps-2": "",
    "steps-3": "",
    "steps-2-outliers": "",
    "random-plain": "on 0.40 of trailing",
    "random-plain-with-accelerometer": "on 0.26 of trailing",
    "random-plain-without": "",
}
TROUBLED = "on 1.1 of main's ratio"
DRIVEN = "1.1 of the loop"
DRIVEN_SOFT = "1.1 of the loop, 0.8 of the naive means"  # dunes and sandbox
MUJOCO = "1.0 of the naive means, below it where slip changes"
COLUMNS = ["row", "entrant", "RMSE", "/ trailing", "/ centred", "90 % hold", "score", "half-width", "points", "answered", "Ok", "RMSE of Ok", "rows/s", "also", "target"]


def write(path, figures, head):
    lines = [f"# {head}", "row\tentrant\tquantity\tvalue"]
    for (row, entrant), values in figures.items():
        lines += [f"{row}\t{entrant}\t{quantity}\t{value:.6g}" for quantity, value in values.items()]
    path.write_text("\n".join(lines) + "\n")


def read(path):
    if not path.exists():
        return {}, ""
    head, _, *lines = path.read_text().splitlines()
    figures = {}
    for line in lines:
        row, entrant, quantity, value = line.split("\t")
        figures.setdefault((row, entrant), {})[quantity] = float(value)
    return figures, head.removeprefix("# ")


def three(value):
    if value is None or math.isnan(value):
        return ""
    return f"{value:.4f}" if abs(value) < 0.1 else f"{value:.3f}"


def also(figures):
    words = []
    if "high" in figures:
        words.append(f"{figures['shown']:.0f} of {figures['high']:.0f} shown, {figures['shown_in_3_s']:.0f} in 3 s")
        if "median_after_s" in figures:
            words.append(f"median after {figures['median_after_s']:.1f} s")
        words.append(f"{figures['false']:.0f} false of {figures['wheel_runs']:.0f}")
    for key in ("p5", "p95", "whole", "loop", "over_loop"):
        if key in figures:
            words.append(f"{key.replace('_', ' ')} {three(figures[key])}")
    if figures.get("failed"):
        words.append(f"{figures['failed']:.0f} of {figures['logs']:.0f} failed")
    return ", ".join(words)


def line(row, entrant, figures, target):
    of = lambda key: three(figures.get(key))
    share = f"{figures['answered'] / figures['points']:.2f}" if figures.get("points") and "high" not in figures else ""
    points = f"{figures['points']:.0f}" if "high" not in figures else ""
    speed = f"{figures['rows_per_s']:.0f}" if "rows_per_s" in figures else ""
    cells = [row, entrant, of("rmse"), of("over_trailing"), of("over_centred"), of("held"), of("score"), of("half")]
    return "| " + " | ".join(cells + [points, share, of("ok"), of("ok_rmse"), speed, also(figures), target]) + " |"


def means(row, figures):
    """A line of each better naive mean."""
    for kind in ("trailing", "centred"):
        if kind in figures:
            yield "| " + " | ".join([row, f"{kind} mean", three(figures[kind])] + [""] * (len(COLUMNS) - 3)) + " |"


def target_of(row):
    if row in TARGETS:
        return TARGETS[row]
    if row.startswith("drive"):
        return DRIVEN_SOFT if row.endswith(("dunes", "sandbox")) else DRIVEN
    return MUJOCO if row.startswith("mujoco") else TROUBLED


def markdown(figures, stored, stored_head, head, skipped):
    rows = list(dict.fromkeys(row for row, _ in figures or stored))
    lines = [f"Run: {head}."] + ([f"Stored (main.tsv): {stored_head}."] if stored_head else []) + [""]
    lines += ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    for row in rows:
        target, first = target_of(row), True
        own = {entrant: values for (of, entrant), values in figures.items() if of == row}
        past = {f"{entrant} (stored)": values for (of, entrant), values in stored.items() if of == row}
        for entrant, values in (past | own).items():
            lines.append(line(row if first else "", entrant, values, target if first else ""))
            first = False
        lines += means("", next(iter((own or past).values())))
    lines += ["| " + " | ".join([row, why] + [""] * (len(COLUMNS) - 2)) + " |" for row, why in skipped.items()]
    return "\n".join(lines)


def print_each(name, results):
    for entrant, one in results.items():
        for run in one["runs"]:
            naive = ", ".join(f"{key} {three(judge.root_mean(values))}" for key, values in run["naive"].items())
            print(f"  {name} {entrant}: {three(judge.root_mean(run['errors']))} of {run['answered']}/{run['points']}; {naive}", file=sys.stderr)
        if one["extra"]:
            shown = {key: value for key, value in one["extra"].items() if isinstance(value, (int, float))}
            print(f"  {name}: {shown}", file=sys.stderr)
