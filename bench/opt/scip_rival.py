"""SCIP, a published branch and bound for mixed-integer nonlinear programs, on the problems of Grouser's proof logs.

    just certify            # writes target/proofs/*.jsonl
    pip install pyscipopt
    python bench/opt/scip_rival.py target/proofs/*.jsonl

The first line of a log holds the box, the operations and the rows, so that SCIP gets the very formulas. Same gap, 1e-6
(1 + |f|), with f the best value of the log, same time, one thread; SCIP's constraints hold to its tolerance of 1e-6 (here
1e-9), and its bounds are not rounded outwards. Writes bench/opt/SCIP_RESULTS.md.
"""

import datetime
import json
import math
import os
import sys
import time
from pathlib import Path

import pyscipopt
from pyscipopt import Model, cos, exp, log, sin, sqrt

from rivals import processor

SECONDS = 60.0
GAP = 1e-6
UNARY = {
    "neg": lambda x: -x,
    "abs": abs,
    "sqrt": sqrt,
    "exp": exp,
    "expm1": lambda x: exp(x) - 1,
    "ln": log,
    "ln1p": lambda x: log(1 + x),
    "log10": lambda x: log(x) / math.log(10),
    "sin": sin,
    "cos": cos,
    "tan": lambda x: sin(x) / cos(x),
    "sinh": lambda x: (exp(x) - exp(-x)) / 2,
    "cosh": lambda x: (exp(x) + exp(-x)) / 2,
}
BINARY = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b,
    "min": lambda a, b: (a + b - abs(a - b)) / 2,
    "max": lambda a, b: (a + b + abs(a - b)) / 2,
}
NUMBERS = {exp: math.exp, log: math.log, sin: math.sin, cos: math.cos, sqrt: math.sqrt}


class Unknown(Exception):
    """SCIP has no such operation."""


def unary(name, x):
    if name == "sinc" and not isinstance(x, (int, float)):
        raise Unknown("sinc")
    if name not in UNARY:
        raise Unknown(name)
    own = UNARY[name]
    return NUMBERS[own](x) if isinstance(x, (int, float)) and own in NUMBERS else own(x)


def build(head):
    model = Model()
    model.hideOutput()
    x = [model.addVar(lb=a, ub=b) for a, b in zip(head["lower"], head["upper"])]
    values = []
    for name, *given in head["ops"]:
        if name == "const":
            values.append(given[0])
        elif name == "var":
            values.append(x[given[0]])
        elif name == "powi":
            values.append(values[given[0]] ** given[1])
        elif name in BINARY:
            values.append(BINARY[name](*(values[a] for a in given)))
        else:
            values.append(unary(name, values[given[0]]))
    level = model.addVar(lb=None)
    for kind, node, _ in head["rows"]:
        row = values[node]
        if kind == "objective":
            model.addCons(row <= level)
        elif kind == "at_most":
            model.addCons(row <= 0)
        else:
            model.addCons(row == 0)
    model.setObjective(level)
    return model


def solve(head, best):
    model = build(head)
    model.setParam("timing/clocktype", 1)  # processor time
    model.setParam("limits/time", SECONDS)
    model.setParam("limits/absgap", GAP * (1 + abs(best)))
    model.setParam("numerics/feastol", 1e-9)
    begin = time.process_time()
    model.optimize()
    value = model.getObjVal() if model.getNSols() else math.inf
    return model.getStatus(), model.getDualbound(), value, model.getNTotalNodes(), time.process_time() - begin


def main():
    lines = [
        "# SCIP on the problems of the proofs",
        "",
        f"{datetime.date.today()}, {processor()}, load {os.getloadavg()[0]:.1f}. SCIP {pyscipopt.scip.MAJOR}.{pyscipopt.scip.MINOR}, pyscipopt "
        f"{pyscipopt.__version__}, one thread, at most {SECONDS:.0f} s. `python bench/opt/scip_rival.py target/proofs/*.jsonl`",
        "",
        "Same formulas and gap, 1e-6 (1 + |f|). Gap: what lies between SCIP's bound and the best value of both, over 1 + |f|. SCIP's bounds "
        "carry no rounding errors: a bound above the best value is wrong, not better. Grouser's proofs of the same problems are in RESULTS.md.",
        "",
        "| problem | Grouser | SCIP | SCIP's best value less ours | gap | nodes | CPU seconds |",
        "|---|---|---|---|---|---|---|",
    ]
    for path in map(Path, sys.argv[1:]):
        with open(path, encoding="utf-8") as log_file:
            head, last = json.loads(next(log_file)), None
            for last in log_file:
                pass
        end = json.loads(last)
        best = end["upper"]
        try:
            status, bound, value, nodes, seconds = solve(head, best)
        except Unknown as operation:
            lines.append(f"| {path.stem} | {end['end']} | has no `{operation}` | | | | |")
            continue
        gap = (min(best, value) - bound) / (1 + abs(best))
        word = {"optimal": "optimal", "gaplimit": "optimal", "timelimit": "time"}.get(status, status)
        found = f"{value - best:.1e}" if math.isfinite(value) else "none"
        lines.append(f"| {path.stem} | {end['end']} | {word} | {found} | {gap:.1e} | {nodes} | {seconds:.2f} |")
        print(lines[-1], flush=True)
        Path(__file__).with_name("SCIP_RESULTS.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
