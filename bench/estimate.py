"""Rows of a log that `grouser estimate` reads in a second of processor time.

    cargo build --release && python bench/estimate.py [RUNS]

The log is examples/five-wheel 50 times in a row: 100 050 rows of five counters and a gyro.
"""

import csv
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

REPEATS = 50
WIDTH = 65536  # the counters have 16 bits
EXAMPLE = pathlib.Path(__file__).parents[1] / "examples" / "five-wheel"
GROUSER = EXAMPLE.parents[1] / "target" / "release" / "grouser"


def write_log(path):
    head, *rows = csv.reader((EXAMPLE / "log.csv").read_text().splitlines())
    rows = [[float(value) for value in row] for row in rows]
    lasts_ms = rows[-1][0] - rows[0][0] + rows[1][0] - rows[0][0]
    turned = [int(last - first) for first, last in zip(rows[0][1:6], rows[-1][1:6])]
    with path.open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(head)
        for repeat in range(REPEATS):
            for time_ms, *ticks, gyro in rows:
                counts = [(int(tick) + repeat * by) % WIDTH for tick, by in zip(ticks, turned)]
                table.writerow([int(time_ms + repeat * lasts_ms), *counts, gyro])
    return REPEATS * len(rows)


def processor_s(*arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([GROUSER, "estimate", *arguments], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    rows = write_log(folder / "log.csv")
    log = [folder / "log.csv", "--robot", EXAMPLE / "robot.toml", "--map", EXAMPLE / "columns.toml"]
    for what, extra in [
        ("by the whole log", []),
        ("slips written as a table", ["-o", folder / "out.csv"]),
        ("online", ["--online"]),
    ]:
        median = statistics.median(processor_s(*log, *extra) for _ in range(runs))
        print(f"{what:<26}{rows / median:>10.0f} rows a processor second")
