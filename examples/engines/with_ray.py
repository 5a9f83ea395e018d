"""Operating points from Parquet to Parquet on a Ray cluster: with_ray.py SOURCE_FOLDER TARGET_FOLDER."""

import sys
from pathlib import Path

import ray
from points import solve_file


def run(source: Path, target: Path) -> float:
    target.mkdir(parents=True, exist_ok=True)
    paths = sorted(source.glob("*.parquet"))
    # a task is lost with its worker and runs again on another
    task = ray.remote(max_retries=2)(solve_file)
    return float(sum(ray.get([task.remote(path, target / path.name) for path in paths])))


if __name__ == "__main__":
    here = str(Path(__file__).parent)
    ray.init(num_cpus=2, include_dashboard=False, runtime_env={"env_vars": {"PYTHONPATH": here}})
    print(run(Path(sys.argv[1]), Path(sys.argv[2])))
