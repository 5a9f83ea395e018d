"""Slip estimators judged on ground that they were not tuned on: measured logs, known steps, random logs, the robot's own logs.

    python bench/estimators [ROWS [ENTRANT ...]] [--folder DIR] [--data DIR] [--store] [--fresh]

ROWS: beginnings of row names with commas between, or `all` (table.py lists the rows). ENTRANT: names of entrants.py; `main` without
one. The logs are made in DIR (target/estimators), and their truth stays out of the estimators' sight. A Markdown table is printed
on standard output, its figures are written to DIR/figures.tsv; `main.tsv` has the figures of a past run of `main`, shown for comparison, and
`--store` writes it. `--fresh` makes all logs again; otherwise logs of the same generator are used again. Needs numpy.

Columns: RMSE is the mean over wheel runs of each one's root mean square error; "/ trailing" and "/ centred" divide it by that of the
better naive mean (random logs: geometric mean over logs). An interval holds where |error| <= 1.645 sqrt(sigma^2 + sigma_truth^2), at all
points with a slip and a sigma, whatever the health; "score" is the mean interval score of these intervals, "half-width" the
median 1.645 sigma of the entrant alone. "answered" is the share of points with a slip, "Ok" that with health Ok. A truth over a window is
compared with the mean of the entrant's slips in it; naive means are treated in the same way.
"""

import argparse
import concurrent.futures
import datetime
import hashlib
import multiprocessing
import os
import pathlib
import pickle
import platform
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))

import entrants  # noqa: E402
import judge  # noqa: E402
import measured  # noqa: E402
import random_rows  # noqa: E402
import robotino  # noqa: E402
import steps  # noqa: E402
import table  # noqa: E402
import worlds  # noqa: E402

STORED = HERE / "main.tsv"
GENERATORS = ["truth", "robotino", "steps", "measured", "random_rows", "worlds", "mujoco_five_wheel"]


def all_logs(data):
    shipped = entrants.ROOT / "examples" / "robotino"
    yield from robotino.logs(data, shipped)
    yield from steps.logs()
    yield from measured.logs(data)
    yield from worlds.logs()
    yield from random_rows.logs()


def fingerprint():
    sources = [HERE / f"{name}.py" for name in GENERATORS] + [HERE.parent / "random_logs.py"]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()


def made(name, make, folder, is_fresh):
    """The log, made or found from a run before of the same generator."""
    kept = folder / "truth" / f"{name}.pickle"
    key = fingerprint()
    if kept.exists() and not is_fresh:
        known, log = pickle.loads(kept.read_bytes())
        if known == key:
            return log
    own = folder / name
    own.mkdir(parents=True, exist_ok=True)
    log = make(own)
    kept.parent.mkdir(exist_ok=True)
    kept.write_bytes(pickle.dumps((key, log)))
    return log


def judged(index, names, folder, is_fresh):
    """Of each entrant: the result on one log."""
    rows, name, make = LOGS[index]
    try:
        log = made(name, make, folder, is_fresh)
    except worlds.Skipped as why:
        return name, rows, {}, str(why)
    results = {}
    for entrant in names:
        series, spent_s, failure = entrants.estimate(entrant, log)
        one = {"runs": judge.of_log(log, series), "spent_s": spent_s, "row_count": log.row_count, "failure": failure}
        one |= {"high": judge.high_slip(log, series), "whole": judge.whole_slip(log, series), "extra": log.extra}
        results[entrant] = one
    return name, log.rows, results, None


def processor():
    model = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")] if os.path.exists("/proc/cpuinfo") else []
    return model[0] if model else platform.machine()


def commit():
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=HERE)
    return done.stdout.strip() or "unknown"


def main():
    parser = argparse.ArgumentParser(prog="estimators", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="?", default="all")
    parser.add_argument("entrants", nargs="*")
    parser.add_argument("--folder", type=pathlib.Path, default=entrants.ROOT / "target" / "estimators")
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path(os.environ.get("GROUSER_DATA", entrants.ROOT / "data")))
    parser.add_argument("--store", action="store_true", help="keep the figures of main and main-smooth in bench/estimators/main.tsv")
    parser.add_argument("--fresh", action="store_true", help="make all logs again")
    parser.add_argument("--each", action="store_true", help="also the error on each log")
    options = parser.parse_args()
    names = options.entrants or ["main"]
    for name in list(names):
        if name not in entrants.COMMANDS:
            parser.error(f"no entrant {name}: {', '.join(entrants.COMMANDS)}")
        if not pathlib.Path(entrants.COMMANDS[name][0]).exists():
            print(f"{name}: skipped, {entrants.COMMANDS[name][0]} does not exist", file=sys.stderr)
            names.remove(name)
    if not options.data.is_dir():
        print(f"{options.data}: no measured data, set GROUSER_DATA; their rows are missing", file=sys.stderr)
    global LOGS
    LOGS = list(all_logs(options.data.resolve()))
    words = options.rows.split(",")
    is_wanted = lambda row: options.rows == "all" or any(row.startswith(word) for word in words)
    chosen = names and [index for index, (rows, _, _) in enumerate(LOGS) if any(map(is_wanted, rows))]
    if names and not chosen:
        parser.error(f"no row begins with {options.rows}")
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    of_rows, skipped_rows = {}, {}
    with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
        tasks = [pool.submit(judged, index, names, folder, options.fresh) for index in chosen]
        for count, task in enumerate(tasks, 1):
            name, rows, results, skipped = task.result()
            failed = [f"{entrant} {one['failure']}" for entrant, one in results.items() if one["failure"]]
            print(f"[{count}/{len(tasks)}] {name} {skipped or ''} {', '.join(failed)}", file=sys.stderr, flush=True)
            skipped_rows |= dict.fromkeys(rows, skipped) if skipped else {}
            if options.each:
                table.print_each(name, results)
            for row in filter(is_wanted, rows):
                for entrant, one in results.items():
                    of_rows.setdefault(row, {}).setdefault(entrant, []).append(one)
    figures = {(row, entrant): judge.of_row(row, found) for row, by_entrant in of_rows.items() for entrant, found in by_entrant.items()}
    head = f"{datetime.date.today()}, commit {commit()}, {processor()}"
    table.write(folder / "figures.tsv", figures, head)
    if options.store:
        stored, _ = table.read(STORED)
        stored |= {key: value for key, value in figures.items() if key[1].startswith("main")}
        table.write(STORED, stored, head)
    stored, stored_head = ({}, "") if options.store else table.read(STORED)
    stored = {key: values for key, values in stored.items() if is_wanted(key[0])}
    print(table.markdown(figures, stored, stored_head, head, skipped_rows))


if __name__ == "__main__":
    main()
