"""What an engine costs beside the work: operating points from Parquet to Parquet, by two processes and on Dask, Ray and Spark (Sail).

    python bench/engines.py [POINTS]

needs the package with pyarrow and psutil, and the engines; one that is not installed is left out. The start of an engine
is not counted, its own work while the points are solved is: processor time of all processes. An engine also works while it has
no task (monitors, heartbeats): that part grows with the wall time, which the load of the machine stretches, so it is measured
over idle seconds and printed beside the sum.
"""

import multiprocessing
import os
import sys
import tempfile
import time
from pathlib import Path

import psutil

ENGINES = str(Path(__file__).resolve().parents[1] / "examples" / "engines")
sys.path.insert(0, ENGINES)
import points  # noqa: E402

FILES = 40


def processor_time():
    """Of this process, its children and what they have waited for, s."""
    total = 0.0
    me = psutil.Process()
    for process in [me, *me.children(recursive=True)]:
        try:
            times = process.cpu_times()
        except psutil.NoSuchProcess:
            continue
        total += times.user + times.system
    return total


def idle_share(seconds=3.0):
    """Processors that an engine without tasks keeps busy."""
    cpu, wall = processor_time(), time.perf_counter()
    time.sleep(seconds)
    return (processor_time() - cpu) / (time.perf_counter() - wall)


def timed(name, run, single=None):
    idle = idle_share() if single else 0.0
    cpu, wall = processor_time(), time.perf_counter()
    total = run()
    cpu, wall = processor_time() - cpu, time.perf_counter() - wall
    if single is None:
        beside = ""
    else:
        assert abs(total - single[0]) < 1e-9 * abs(total), name
        beside = f", {100 * (cpu / single[1] - 1):+.1f} %, without its {idle:.3f} processors when idle {100 * ((cpu - idle * wall) / single[1] - 1):+.1f} %"
    print(f"{name}: {wall:.1f} s, {cpu:.1f} s of processor time{beside}; load {os.getloadavg()[0]:.1f}", flush=True)
    return total, cpu


def one_process(source, target):
    target.mkdir()
    return sum(points.solve_file(path, target / path.name) for path in sorted(source.glob("*.parquet")))


def two_processes(source, target):
    target.mkdir()
    paths = sorted(source.glob("*.parquet"))
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        pool.map(len, [[]] * 8)
        return timed("two processes", lambda: sum(pool.starmap(points.solve_file, [(path, target / path.name) for path in paths], 1)))


def on_dask(source, target, single):
    import dask
    import with_dask
    from dask.distributed import Client, LocalCluster

    dask.config.set(with_dask.QUIET)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.run(lambda: __import__("points"))
        timed("Dask", lambda: with_dask.run(client, source, target), single)


def on_ray(source, target, single):
    import ray
    import with_ray

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": ENGINES}})
    warm = ray.remote(lambda: __import__("points").SIZE)
    ray.get([warm.remote() for _ in range(4)])
    timed("Ray", lambda: with_ray.run(source, target), single)
    ray.shutdown()


def on_spark(source, target, single):
    import with_spark
    from pysail.spark import SparkConnectServer
    from pyspark.sql import SparkSession

    server = SparkConnectServer()
    server.start()
    session = SparkSession.builder.remote(f"sc://localhost:{server.listening_address[1]}").getOrCreate()
    session.sql("select 1").collect()
    timed("Spark (Sail)", lambda: with_spark.run(session, source, target), single)


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000
    os.environ["PYTHONPATH"] = ENGINES
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        source = folder / "points"
        points.write_points(source, FILES, count // FILES)
        timed("one process", lambda: one_process(source, folder / "one"))
        single = two_processes(source, folder / "two")
        # again, for the spread of the machine
        single = min(single, two_processes(source, folder / "two-again"), key=lambda run: run[1])
        for engine in (on_dask, on_ray, on_spark):
            try:
                engine(source, folder / engine.__name__, single)
            except ImportError as missing:
                print(f"{engine.__name__}: left out, {missing}")


if __name__ == "__main__":
    main()
