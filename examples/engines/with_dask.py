"""Operating points from Parquet to Parquet on a Dask cluster: with_dask.py SOURCE_FOLDER TARGET_FOLDER."""

import sys
from pathlib import Path

import dask
from dask.distributed import Client, LocalCluster
from points import solve_file

# Workers sample their stack a hundred times a second and watch their memory ten times, for the dashboard: more processor
# time than these tasks cost Dask. Set before the cluster starts.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.tick.interval": "500ms",
}


def run(client: Client, source: Path, target: Path) -> float:
    target.mkdir(parents=True, exist_ok=True)
    paths = sorted(source.glob("*.parquet"))
    # a task is lost with its worker and runs again on another
    sums = client.map(solve_file, paths, [target / path.name for path in paths], retries=2)
    return float(sum(client.gather(sums)))


if __name__ == "__main__":
    dask.config.set(QUIET)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        print(run(client, Path(sys.argv[1]), Path(sys.argv[2])))
