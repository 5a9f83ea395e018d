"""What an engine costs beside the work: operating points from Parquet to Parquet, by two processes and on Dask, Ray and Spark (Sail).

    python bench/engines.py [POINTS]

needs the package with pyarrow and psutil, and the engines; one that is not installed is left out. The start of an engine
is not counted, its own work while the points are solved is: processor time of all processes. On a shared machine the same work
takes a quarter more or less from one run to the next, so that engine and plain processes run in turn and the least of each counts.
An engine also works while it has no task (monitors, heartbeats): that part grows with the wall time, which the load of the machine
stretches, so it is measured over idle seconds and printed beside the sum.
"""

import multiprocessing
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import psutil

ENGINES = str(Path(__file__).resolve().parents[1] / "examples" / "engines")
sys.path.insert(0, ENGINES)
import points  # noqa: E402

FILES, ROUNDS = 40, 5


def processor_time(pids=None):
    """Of these processes, or of this one and its children, s."""
    total = 0.0
    me = psutil.Process()
    for process in [me, *me.children(recursive=True)]:
        try:
            if pids is None or process.pid in pids:
                times = process.cpu_times()
                total += times.user + times.system
        except psutil.NoSuchProcess:
            continue
    return total


def pid_after(seconds):
    time.sleep(seconds)
    return os.getpid()


def idle_share(seconds=3.0):
    """Processors that an engine without tasks keeps busy."""
    cpu, wall = processor_time(), time.perf_counter()
    time.sleep(seconds)
    return (processor_time() - cpu) / (time.perf_counter() - wall)


def timed(run, pids=None):
    """Processor time and wall time of a run, s, and its sum."""
    cpu, wall = processor_time(pids), time.perf_counter()
    total = run()
    return processor_time(pids) - cpu, time.perf_counter() - wall, total


def compared(name, run, folder, source):
    """An engine and two plain processes in turn: the least of each, which other programs disturbed least."""
    idle = idle_share()
    paths = sorted(source.glob("*.parquet"))
    ours, theirs = [], []
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        # both are up, with their modules
        plain_pids = set(pool.map(pid_after, [1.0, 1.0], chunksize=1))
        for k in range(ROUNDS):
            target = folder / f"{name}-{k}"
            plain = folder / f"plain-{name}-{k}"
            plain.mkdir()
            theirs.append(timed(lambda: run(source, target)))
            jobs = [(path, plain / path.name) for path in paths]
            # the engine beside them works a little although it has no task
            ours.append(timed(lambda: sum(pool.starmap(points.solve_file, jobs, 1)), plain_pids))
            assert abs(theirs[-1][2] - ours[-1][2]) < 1e-9 * abs(ours[-1][2]), name
            shutil.rmtree(target)
            shutil.rmtree(plain)
    (cpu, wall, _), (plain, _, _) = min(theirs), min(ours)
    spread = max(ours)[0] / plain - 1
    print(
        f"{name}: {cpu:.2f} s of processor time, two processes {plain:.2f} s: {100 * (cpu / plain - 1):+.1f} %, without its "
        f"{idle:.3f} processors when idle {100 * ((cpu - idle * wall) / plain - 1):+.1f} % (least of {ROUNDS} each; two processes "
        f"alone differ by {100 * spread:.0f} %); load {os.getloadavg()[0]:.1f}",
        flush=True,
    )


def on_dask(source, folder):
    import dask
    import with_dask
    from dask.distributed import Client, LocalCluster

    dask.config.set(with_dask.QUIET)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.run(lambda: __import__("points"))
        compared("Dask", lambda source, target: with_dask.run(client, source, target), folder, source)


def on_ray(source, folder):
    import ray
    import with_ray

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": ENGINES}})
    warm = ray.remote(lambda: __import__("points").SIZE)
    ray.get([warm.remote() for _ in range(4)])
    compared("Ray", with_ray.run, folder, source)
    ray.shutdown()


def on_spark(source, folder):
    import with_spark
    from pysail.spark import SparkConnectServer
    from pyspark.sql import SparkSession

    server = SparkConnectServer()
    server.start()
    session = SparkSession.builder.remote(f"sc://localhost:{server.listening_address[1]}").getOrCreate()
    session.sql("select 1").collect()
    compared("Spark (Sail)", lambda source, target: with_spark.run(session, source, target), folder, source)


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000
    os.environ["PYTHONPATH"] = ENGINES
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        source = folder / "points"
        points.write_points(source, FILES, count // FILES)
        for engine in (on_dask, on_ray, on_spark):
            try:
                engine(source, folder)
            except ImportError as missing:
                print(f"{engine.__name__}: left out, {missing}")


if __name__ == "__main__":
    main()
