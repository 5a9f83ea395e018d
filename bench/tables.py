"""`grouser batch` beside polars, which reads and writes the same tables: processor time, cores, memory.

    just bench-tables [ROWS] [ROUNDS]

needs polars. The table has half of its rows by load and half by sinkage, on five soils; some loads are carried by
no sinkage. Both programs read it and write the completed table, in turns; polars computes nothing in between, so
that its time is what a fast reader and writer of tables costs. Values first: every column of the input is equal in
the output, every number that was written is read back with the same digits, and a sample of the rows is computed
again one point at a time by `grouser wheel`.
"""

import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

import polars as pl

GROUSER = pathlib.Path(os.environ.get("GROUSER", pathlib.Path(__file__).parents[1] / "target/release/grouser"))
SOILS = ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"]
ADDED = ["vertical_force_n", "drawbar_pull_n", "torque_nm", "status", "cautions"]
SAMPLE = 40
TOLERANCE = 1e-9  # of the standard rule (README)

# what polars does with the same tables: read the one, write the other
RIVAL = """
import sys, time, polars
table, completed, out = sys.argv[1:]
written = polars.read_csv(completed)
before, began = time.process_time(), time.perf_counter()
polars.read_csv(table)
written.write_csv(out)
print(time.process_time() - before, time.perf_counter() - began)
"""

# in a small process: a child's memory counts from that of its parent on
MEASURED = """
import os, subprocess, sys, time
began = time.perf_counter()
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
elapsed = time.perf_counter() - began
print(os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, elapsed, usage.ru_maxrss / 1024)
"""


def write_table(path, rows):
    """Wheels, slips, sinkages and loads with the digits of a plan of experiments."""
    draw = random.Random(2012)
    with path.open("w") as out:
        out.write("soil,radius_m,width_m,slip,sinkage_m,load_n\n")
        for row in range(rows):
            radius, width = draw.uniform(0.05, 0.35), draw.uniform(0.05, 0.3)
            wheel = f"{draw.choice(SOILS)},{radius:.4f},{width:.4f},{draw.uniform(0.0, 0.9):.4f}"
            if row % 2:
                # mean pressures over the projection of the wheel, from firm ground to soils that give way
                load = 2.0 * radius * width * 10 ** draw.uniform(2.0, 4.0)
                out.write(f"{wheel},,{load:.2f}\n")
            else:
                out.write(f"{wheel},{radius * draw.uniform(0.01, 0.35):.5f},\n")


def run_grouser(table, out):
    """Processor time, elapsed time (s) and memory (MiB)."""
    command = [sys.executable, "-c", MEASURED, GROUSER, "batch", table, "-o", out]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    status, *figures = [float(x) for x in printed.split()]
    if status not in (0, 3):  # 3: some rows have no solution
        sys.exit(f"grouser batch failed with {status}")
    return figures


def run_polars(table, completed, out):
    """Processor time and elapsed time (s) without the start of Python."""
    command = [sys.executable, "-c", RIVAL, table, completed, out]
    return [float(x) for x in subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()]


def compare(table, completed, again):
    """What was read and written has the same values; a sample has those of single points."""
    given, solved = pl.read_csv(table), pl.read_csv(completed)
    assert solved.columns == given.columns + ADDED and solved.height == given.height
    for name in given.columns:
        kept = solved[name].filter(given[name].is_not_null())
        assert kept.equals(given[name].drop_nulls()), f"{name} was changed"
    counts = dict(solved["status"].value_counts().iter_rows())
    ok = solved.filter(pl.col("status") == "ok")
    assert all(ok[name].null_count() == 0 and ok[name].is_finite().all() for name in ["sinkage_m", *ADDED[:3]])
    assert solved.equals(pl.read_csv(again)), "polars writes other values"
    worst = 0.0
    some = solved.sample(SAMPLE, seed=1)
    for row in some.iter_rows(named=True):
        by = ["--load-n", row["load_n"]] if row["load_n"] is not None else ["--sinkage-m", row["sinkage_m"]]
        command = [GROUSER, "wheel", "--json", "--soil", row["soil"], "--radius-m", row["radius_m"], "--width-m", row["width_m"],
                   "--slip", row["slip"], *by]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        single = json.loads(done.stdout)
        single = single.get("result", single)
        assert single["status"] == row["status"], (row, single)
        if row["status"] == "ok":
            wheel = [1.0, 1.0, 1.0 / row["radius_m"]]
            size = max(abs(single[name]) * scale for name, scale in zip(ADDED, wheel))
            off = max(abs(single[name] - row[name]) * scale for name, scale in zip(ADDED, wheel))
            worst = max(worst, off / size, abs(single["sinkage_m"] / row["sinkage_m"] - 1.0))
    assert worst <= TOLERANCE, worst
    return counts, worst


def main():
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 9
    print(f"{rows} rows, polars {pl.__version__}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    with tempfile.TemporaryDirectory() as folder:
        table, completed, again = (pathlib.Path(folder) / name for name in ("in.csv", "out.csv", "again.csv"))
        write_table(table, rows)
        run_grouser(table, completed)
        run_polars(table, completed, again)
        counts, worst = compare(table, completed, again)
        print(f"{counts}; {SAMPLE} single points differ by {worst:.1e} at most")
        ours, theirs = [], []
        for _ in range(rounds):
            ours.append(run_grouser(table, completed))
            theirs.append(run_polars(table, completed, again))
    for name, runs in (("grouser batch", ours), ("polars", theirs)):
        processor, elapsed = (statistics.median(run[k] for run in runs) for k in (0, 1))
        cores = statistics.median(run[0] / run[1] for run in runs)
        memory = f", {max(run[2] for run in runs):.1f} MiB" if len(runs[0]) > 2 else ""
        print(f"{name:<14}{processor:6.2f} s of processor time, {elapsed:5.2f} s elapsed, {cores:.2f} cores busy{memory}")
    ratio = statistics.median(mine[0] / other[0] for mine, other in zip(ours, theirs))
    print(f"grouser batch over polars, processor time, median of {rounds} pairs: {ratio:.2f}")


if __name__ == "__main__":
    main()
