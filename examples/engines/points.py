"""What every engine runs: a file of operating points to a file of results, and a folder of such files."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from grouser import soils, wheel

SOIL = soils.find("dry-sand")
SIZE = {"radius_m": 0.125, "width_m": 0.1}


def write_points(folder: Path, files: int, points: int, seed: int = 3) -> list[Path]:
    """Writes operating points between 40 and 120 N and slips between 0.05 and 0.6."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(seed)
    paths = []
    for k in range(files):
        table = pa.table(
            {
                "cell": np.arange(points, dtype=np.int64) + k * points,
                "load_n": rng.uniform(40.0, 120.0, points),
                "slip": rng.uniform(0.05, 0.6, points),
            }
        )
        paths.append(folder / f"{k}.parquet")
        pq.write_table(table, paths[-1])
    return paths


def solve_batch(batch: pa.RecordBatch) -> pa.RecordBatch:
    """Drawbar pull and status of one batch, on the thread that the engine gives."""
    found = wheel.under_load(SOIL, **SIZE, load_n=batch["load_n"], slip=batch["slip"], threads=1)
    columns = [batch["cell"], pa.array(found.drawbar_pull_n), pa.array(found.status.astype(np.int32))]
    return pa.RecordBatch.from_arrays(columns, names=["cell", "pull_n", "status"])


def solve_file(source: Path, target: Path) -> float:
    """Solves a file batch by batch; returns the sum of the pulls. The target appears when it is whole."""
    partial = target.with_suffix(".partial")
    total = 0.0
    with pq.ParquetFile(source) as file:
        schema = pa.schema([("cell", pa.int64()), ("pull_n", pa.float64()), ("status", pa.int32())])
        with pq.ParquetWriter(partial, schema) as writer:
            for batch in file.iter_batches(1 << 17):
                solved = solve_batch(batch)
                total += float(np.sum(solved["pull_n"].to_numpy()))
                writer.write_batch(solved)
    partial.rename(target)
    return total
