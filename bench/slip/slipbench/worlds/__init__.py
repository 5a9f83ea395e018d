"""The worlds: each a function of its name and a seed."""

from __future__ import annotations

import dataclasses
from typing import Callable, Dict

from slipbench.log import Run
from slipbench.worlds import kinematic, mujoco_worlds


@dataclasses.dataclass(frozen=True)
class World:
    """What it is, in one line, and what makes a run of it."""

    make: Callable[[str, int], Run]
    what: str


def first_line(function: Callable[..., object]) -> str:
    return (function.__doc__ or "").split("\n")[0]


SIMULATED: Dict[str, World] = {
    function.__name__.replace("_", "-"): World(function, first_line(function))
    for function in (
        mujoco_worlds.five_waves,
        mujoco_worlds.five_patches,
        mujoco_worlds.bogie_rough,
        mujoco_worlds.skid_turns,
        mujoco_worlds.car_patches,
        mujoco_worlds.skid_slopes,
        mujoco_worlds.sand_four,
        mujoco_worlds.sand_five,
        mujoco_worlds.sand_dig,
        mujoco_worlds.turf_four,
        kinematic.random_camera,
        kinematic.random_free,
    )
}
