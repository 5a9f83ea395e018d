"""python -m slipbench: the table and the page."""

from __future__ import annotations

import argparse
import datetime
import os
import pathlib
import sys

from slipbench import fetch, report, run
from slipbench.entrants import ENTRANTS
from slipbench.entrants.grouser import command
from slipbench.worlds import SIMULATED
from slipbench.worlds.measured import MEASURED


def processor() -> str:
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return "an unknown processor"
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "an unknown processor")


def chosen(text: str, names: list[str], what: str) -> list[str]:
    """Names that begin with one of the words between commas."""
    found = [name for name in names if text == "all" or any(name.startswith(word) for word in text.split(","))]
    if not found:
        sys.exit(f"no {what} begins with {text}: {', '.join(names)}")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(prog="slipbench", description="Wheel slip estimators against known slips.")
    parser.add_argument("--worlds", default="all", help="beginnings of names, with commas between")
    parser.add_argument("--entrants", default="all", help="beginnings of names, with commas between")
    parser.add_argument("--seeds", default="20", help="how many seeds, or FIRST:END")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("GROUSER_DATA"), help="folder of the public logs; GROUSER_DATA")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("slipbench-out"), help="folder of the results")
    parser.add_argument("--resume", action="store_true", help="go on with what is in the folder: all runs there are kept")
    parser.add_argument("--fetch", action="store_true", help="fetch the public logs that can be fetched into the data folder, and end")
    options = parser.parse_args()
    if options.fetch:
        sys.exit(fetch.fetch(options.data or pathlib.Path("data")))
    worlds = chosen(options.worlds, [*SIMULATED, *MEASURED], "world")
    entrants = chosen(options.entrants, list(ENTRANTS), "entrant")
    if command() is None and any(name.startswith("grouser") for name in entrants):
        print("no command grouser (set GROUSER to its path): its rows are left out", file=sys.stderr)
        entrants = [name for name in entrants if not name.startswith("grouser")]
    first, _, end = options.seeds.rpartition(":")
    todo = run.tasks(worlds, range(int(first or 0), int(end)), options.data)
    options.out.mkdir(parents=True, exist_ok=True)
    store = options.out / "runs.jsonl"
    if not options.resume:
        store.unlink(missing_ok=True)
    found = run.all_of(todo, entrants, options.jobs, store)
    spent_s = sum(one.made_s + sum(outcome.spent_s for outcome in one.outcomes.values()) for one in found)
    head = f"{datetime.date.today()}, {processor()}, {len(found)} runs, {spent_s / 60:.1f} min of processor time"
    scores = run.grouped(found, lambda result: result.world)
    (options.out / "results.tsv").write_text(report.as_tsv(scores, head))
    (options.out / "runs.tsv").write_text(report.runs_tsv(found))
    (options.out / "faults.tsv").write_text(report.as_tsv(run.grouped([one for one in found if one.world in SIMULATED], lambda one: one.fault), head))
    text = f"{head}\n\n{report.as_text(scores)}"
    (options.out / "table.txt").write_text(text)
    (options.out / "index.html").write_text(report.as_page(found, head))
    print(text)
    print(f"wrote {options.out}/results.tsv, runs.jsonl, runs.tsv, faults.tsv, table.txt, index.html")


if __name__ == "__main__":
    main()
