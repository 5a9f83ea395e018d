"""A slip map by tiles on a Dask cluster: with_dask_map.py DEM.asc ROBOT.toml; the tiles join to the map of one process."""

import sys

import dask.array as da
import numpy as np
from dask import delayed
from dask.distributed import Client, LocalCluster

from grouser import soils, terrain

SOIL, HEADINGS = "sandy-loam", 8


def tile(heights: np.ndarray, mapper: terrain.SlipMapper, quantity: str) -> np.ndarray:
    return terrain.slip_map(mapper, heights, threads=1).quantity(quantity)


def run(client: Client, heights: np.ndarray, mapper: terrain.SlipMapper, quantity: str, cells: int = 16) -> np.ndarray:
    """A quantity of the map (headings, rows, columns); a tile that is lost with its worker is computed again."""
    relief = da.from_array(heights, chunks=(cells, cells))
    # ground beyond the edge is unknown, as it is for one process
    edge = da.overlap.overlap(relief, depth=mapper.reach, boundary=np.nan)
    # a part of the graph: it goes to each worker once, makes its tables there, and is sent again where a worker is lost
    shared = delayed(mapper)
    tiles = edge.map_blocks(
        lambda block, shared: tile(block, shared, quantity),
        shared,
        dtype=np.float32,
        new_axis=0,
        chunks=((len(mapper.headings_deg),), *edge.chunks),
    )
    trimmed = da.overlap.trim_overlap(tiles, depth={1: mapper.reach, 2: mapper.reach}, boundary=np.nan)
    return np.asarray(trimmed.compute(scheduler=client))


if __name__ == "__main__":
    grid = np.loadtxt(sys.argv[1], skiprows=6)
    heights = np.where(grid == -9999.0, np.nan, grid)
    mapper = terrain.SlipMapper(sys.argv[2], soils.find(SOIL), cell_m=1.0, headings=HEADINGS)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        slip = run(client, heights, mapper, "slip")
    alone = terrain.slip_map(mapper, heights).quantity("slip")
    print("the same map" if np.array_equal(slip, alone, equal_nan=True) else "another map")
