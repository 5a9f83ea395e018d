"""The figures as tab-separated values, as text, and as one HTML page without scripts."""

from __future__ import annotations

import dataclasses
import html
import math
from typing import Dict, List, Sequence, Tuple

from slipbench import score
from slipbench.entrants import ENTRANTS
from slipbench.run import Result, grouped
from slipbench.sensors import FAULTS
from slipbench.worlds import SIMULATED
from slipbench.worlds.measured import MEASURED

Scores = Dict[Tuple[str, str], score.Score]
FIELDS = [field.name for field in dataclasses.fields(score.Score)]
# Where intervals of 90 % hold: simulated worlds; measured ones, whose truth is uncertain itself.
GOOD_SHARE, GOOD_SHARE_MEASURED = (0.87, 0.93), (0.85, 0.95)
COLUMNS = ("entrant", "RMSE", "90 % hold", "stated", "half-width", "over 1 s", "longest s", "digs", "after s", "false", "us/row", "failed")


def number(value: float, digits: int = 3) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def cells(name: str, one: score.Score) -> List[str]:
    digs = f"{one.called}/{one.digs}" if one.digs else "-"
    over = number(one.overconfident_runs, 2)
    row = [name, number(one.rmse, 4), number(one.held), number(one.stated, 2), number(one.half), over, number(one.overconfident_s, 1)]
    return row + [digs, number(one.call_s, 2), str(one.false_calls), number(one.us_per_row, 1), str(one.failed) if one.failed else "-"]


def as_tsv(scores: Scores, head: str) -> str:
    lines = [f"# {head}", "\t".join(["world", "entrant", *FIELDS])]
    for (world, entrant), one in scores.items():
        values = [getattr(one, name) for name in FIELDS]
        lines.append("\t".join([world, entrant, *("" if isinstance(v, float) and math.isnan(v) else f"{v:.6g}" for v in values)]))
    return "\n".join(lines) + "\n"


def runs_tsv(found: Sequence[Result]) -> str:
    """Each run of each entrant: for whoever wants to know which seed failed."""
    names = ("rmse", "held", "stated", "half", "overconfident_s", "digs", "called", "false_calls")
    lines = ["\t".join(["world", "seed", "fault", "entrant", *names, "failure"])]
    for result in found:
        for entrant, outcome in result.outcomes.items():
            one = score.of_world([outcome])
            values = [getattr(one, name) for name in names]
            text = ["" if isinstance(v, float) and math.isnan(v) else f"{v:.4g}" for v in values]
            failure = (outcome.failure or "").replace("\t", " ").replace("\n", " ")
            lines.append("\t".join([result.world, str(result.seed), result.fault, entrant, *text, failure]))
    return "\n".join(lines) + "\n"


def as_text(scores: Scores) -> str:
    lines = []
    for world in dict.fromkeys(world for world, _ in scores):
        own = {name: one for (of, name), one in scores.items() if of == world}
        rows = [list(COLUMNS), *(cells(name, one) for name, one in own.items())]
        widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
        first = next(iter(own.values()))
        lines.append(f"{world}: {first.runs} runs, {first.points} points")
        for row in rows:
            lines.append("  " + "  ".join([row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:]))]))
        lines.append("")
    return "\n".join(lines)


STYLE = """body{font:15px/1.45 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#1d2430;background:#fff}
h1{font-size:1.5rem}h2{font-size:1.1rem;margin:1.6rem 0 .2rem}p{margin:.3rem 0 .6rem}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.15rem .6rem;text-align:right;border-bottom:1px solid #e2e6ec}th:first-child,td:first-child{text-align:left}th{font-weight:600}
.good{background:#d8f0dc}.low{background:#f9d9d3}.high{background:#fbefc8}.best{font-weight:700}.note{color:#5a6474}
@media(prefers-color-scheme:dark){body{color:#e4e8ee;background:#14181f}th,td{border-color:#2b323d}.good{background:#1e4a2a}.low{background:#5c2620}
.high{background:#544411}.note{color:#9aa5b4}}"""


def shade(world: str, held: float) -> str:
    low, high = GOOD_SHARE_MEASURED if world in MEASURED else GOOD_SHARE
    if math.isnan(held):
        return ""
    return "low" if held < low else "high" if held > high else "good"


def as_page(found: Sequence[Result], head: str) -> str:
    scores = grouped(found, lambda result: result.world)
    parts = [f"<h1>Wheel slip estimators</h1><p>{html.escape(head)}</p>"]
    parts.append(
        "<p>Slips of simulated and measured robots against the true ones. <b>RMSE</b> of all points; bold: least of the causal and of the "
        "other entrants. <b>90 % hold</b>: share of stated intervals that contain the truth, "
        "<span class=good>87 to 93 %</span> (measured: 85 to 95 %), <span class=low>too few</span>, <span class=high>more</span>. "
        "<b>Over 1 s</b>: share of runs in which an interval is wrong by 4 sigma for over 1 s. <b>Digs</b>: true slips above 0.6 for 1 s "
        "that are called, and the mean time to the call.</p>"
    )
    for world in dict.fromkeys(world for world, _ in scores):
        own = {name: one for (of, name), one in scores.items() if of == world}
        what = SIMULATED[world].what if world in SIMULATED else (MEASURED[world][1].__doc__ or "").split("\n")[0]
        parts.append(f"<h2>{world}</h2><p class=note>{html.escape(what)} {next(iter(own.values())).runs} runs.</p><table><tr>")
        parts.append("".join(f"<th>{name}</th>" for name in COLUMNS) + "</tr>")
        best = {
            causal: min((one.rmse for name, one in own.items() if ENTRANTS[name].is_causal == causal and one.answered > 0.9), default=math.nan)
            for causal in (True, False)
        }
        for name, one in own.items():
            marks = {1: "best" if one.rmse == best[ENTRANTS[name].is_causal] else "", 2: shade(world, one.held)}
            row = "".join(f'<td class="{marks.get(i, "")}">{html.escape(cell)}</td>' for i, cell in enumerate(cells(name, one)))
            parts.append(f"<tr>{row}</tr>")
        parts.append("</table>")
    parts.append("<h2>By fault</h2><p class=note>RMSE, and the share of intervals that hold, over all simulated worlds.</p><table><tr><th>fault</th>")
    simulated = [result for result in found if result.world in SIMULATED]
    faults = grouped(simulated, lambda result: result.fault)
    names = list(dict.fromkeys(name for _, name in faults))
    parts.append("".join(f"<th colspan=2>{name}</th>" for name in names) + "</tr>")
    for fault in FAULTS:
        row = f'<td title="{html.escape(FAULTS[fault])}">{fault}</td>'
        for name in names:
            has = faults.get((fault, name))
            row += f'<td>{number(has.rmse)}</td><td class="{shade("", has.held)}">{number(has.held, 2)}</td>' if has else "<td></td><td></td>"
        parts.append(f"<tr>{row}</tr>")
    parts.append("</table><h2>Entrants and faults</h2><ul>")
    parts += [f"<li><b>{name}</b>: {html.escape(one.what)}{'' if one.is_causal else ' (not causal)'}</li>" for name, one in ENTRANTS.items()]
    parts += [f"<li><b>{name}</b>: {html.escape(what)}</li>" for name, what in FAULTS.items()]
    parts.append("</ul>")
    title = "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>slipbench</title>"
    return f"{title}<style>{STYLE}</style><body>{''.join(parts)}</body></html>\n"
