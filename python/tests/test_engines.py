"""The engines' examples on local clusters; a worker that is killed half-way changes no sum."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

pq = pytest.importorskip("pyarrow.parquet")
ENGINES = Path(__file__).parents[2] / "examples" / "engines"
sys.path.insert(0, str(ENGINES))

import points as operating  # noqa: E402

FILES, POINTS = 6, 100_000
# clusters of others warn of what is theirs
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("points")
    operating.write_points(folder, FILES, POINTS)
    return folder


@pytest.fixture(scope="module")
def expected(source: Path, tmp_path_factory: pytest.TempPathFactory) -> float:
    target = tmp_path_factory.mktemp("one-process")
    return sum(operating.solve_file(path, target / path.name) for path in sorted(source.glob("*.parquet")))


def check(target: Path, total: float, expected: float) -> None:
    assert total == pytest.approx(expected, rel=1e-12)
    table = pq.read_table(target)
    assert table.num_rows == FILES * POINTS
    assert np.asarray(table["status"]).max() == 0
    assert len(np.unique(np.asarray(table["cell"]))) == FILES * POINTS


def test_dask_with_a_worker_killed_half_way(source: Path, expected: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("dask.distributed")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ENGINES), os.environ.get("PYTHONPATH", "")]))
    import with_dask

    killed = []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            pids = [int(pid) for pid in client.run(os.getpid).values()]

            def kill() -> None:
                while not list(tmp_path.glob("*.parquet")):
                    time.sleep(0.01)
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

            threading.Thread(target=kill, daemon=True).start()
            check(tmp_path, with_dask.run(client, source, tmp_path), expected)
    assert killed


def test_a_map_by_tiles_with_a_worker_killed_half_way(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("dask.distributed")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ENGINES), os.environ.get("PYTHONPATH", "")]))
    import with_dask_map

    from grouser import soils, terrain

    examples = ENGINES.parent
    grid = np.loadtxt(examples / "terrain" / "dunes.asc", skiprows=6)
    heights = np.tile(np.where(grid == -9999.0, np.nan, grid), (6, 6))
    mapper = terrain.SlipMapper(examples / "robots" / "skid-steer.toml", soils.find("sandy-loam"), cell_m=1.0)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            pid = next(iter(client.run(os.getpid).values()))
            # the tables take a second on each worker: then tiles are under way
            killer = threading.Timer(2.0, os.kill, (pid, signal.SIGKILL))
            killer.start()
            slip = with_dask_map.run(client, heights, mapper, "slip", cells=24)
            killer.join()
    np.testing.assert_array_equal(slip, terrain.slip_map(mapper, heights).quantity("slip"))


def test_ray_with_a_worker_killed_half_way(source: Path, expected: float, tmp_path: Path) -> None:
    ray = pytest.importorskip("ray")
    import with_ray

    paths = os.pathsep.join([str(ENGINES), os.environ.get("PYTHONPATH", "")])
    ray.init(num_cpus=2, include_dashboard=False, runtime_env={"env_vars": {"PYTHONPATH": paths}})
    try:
        pid = ray.get(ray.remote(lambda: os.getpid()).remote())

        def kill() -> None:
            while not list(tmp_path.glob("*.parquet")):
                time.sleep(0.01)
            os.kill(pid, signal.SIGKILL)

        threading.Thread(target=kill, daemon=True).start()
        check(tmp_path, with_ray.run(source, tmp_path), expected)
    finally:
        ray.shutdown()


def test_spark_by_sail(source: Path, expected: float, tmp_path: Path) -> None:
    pytest.importorskip("pysail")
    pytest.importorskip("pyspark")
    target = tmp_path / "out"
    # a process of its own: the server's threads do not outlive it
    run = [sys.executable, str(ENGINES / "with_spark.py"), str(source), str(target)]
    ended = subprocess.run(run, capture_output=True, text=True, check=False, timeout=300)
    assert ended.returncode == 0, ended.stderr[-2000:]
    check(target, float(ended.stdout.split()[-1]), expected)


def test_rasters_keep_their_labels() -> None:
    xr = pytest.importorskip("xarray")
    import with_xarray

    slope = xr.DataArray([[0.0, 2.0], [5.0, 60.0]], dims=("y", "x"), coords={"x": [10.0, 20.0]})
    demand = with_xarray.slip_demand(slope, weight_n=80.0)
    assert demand.dims == ("y", "x") and demand.x.values.tolist() == [10.0, 20.0]
    assert demand.values[0, 0] < demand.values[0, 1] < demand.values[1, 0]
    assert np.isnan(demand.values[1, 1])
