"""Programs that estimate slips, each a command; and how their output is read."""

import csv
import os
import pathlib
import subprocess
import threading

import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
GROUSER = ROOT / "target" / "release" / "grouser"
COMMON = ["FILES", "--robot", "ROBOT", "--map", "MAP", "-o", "OUT"]
COMMANDS = {
    "main": [GROUSER, "estimate", *COMMON, "--json", "--online"],
    "main-smooth": [GROUSER, "estimate", *COMMON, "--json"],
}
LIMIT_S = 300  # of one log: a program that hangs is stopped


def command(entrant, log, out):
    words = []
    for word in COMMANDS[entrant]:
        if word == "MAP" and log.column_map is None:
            words.pop()  # the robot file has the columns
        elif word == "FILES":
            words += log.files
        else:
            words.append({"ROBOT": log.robot, "MAP": log.column_map, "OUT": out}.get(word, word))
    return [str(word) for word in words]


def estimate(entrant, log):
    """Series by wheel (times, slips, sigmas, 1 where the health is Ok), processor time in s, and what went wrong or None."""
    out = log.folder / f"{entrant}.csv"
    out.unlink(missing_ok=True)
    with (log.folder / f"{entrant}.txt").open("w") as output:
        process = subprocess.Popen(command(entrant, log, out), stdout=output, stderr=subprocess.STDOUT)
        limit = threading.Timer(LIMIT_S, process.kill)
        limit.start()
        _, status, usage = os.wait4(process.pid, 0)
        limit.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
    spent_s = usage.ru_utime + usage.ru_stime
    if process.returncode not in (0, 3) or not out.exists():
        return {}, spent_s, f"exit {process.returncode}"
    found = {}
    with out.open() as table:
        for row in csv.DictReader(table):
            series = found.setdefault(row["wheel"], ([], [], [], []))
            series[0].append(float(row["time_s"]))
            series[1].append(float(row["slip"] or "nan"))
            series[2].append(float(row["slip_sigma"] or "nan"))
            series[3].append(float(row["health"] == "Ok"))
    return {name: tuple(np.array(values) for values in series) for name, series in found.items()}, spent_s, None
