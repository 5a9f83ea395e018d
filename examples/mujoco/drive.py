"""A six-wheeled rover on dunes of dry sand, in MuJoCo: `python examples/mujoco/drive.py`."""

import time
from pathlib import Path

import mujoco
import numpy as np

from grouser.mujoco import SoftGround

WHEELS = [f"{place}_{side}" for side in ("left", "right") for place in ("front", "middle", "rear")]


def dunes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the ground, m: 0.1 m from trough to crest."""
    return 0.05 * np.sin(1.5 * x) * np.cos(y)


model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_name("rover.xml")))
data = mujoco.MjData(model)
soil = SoftGround(model, data, soil="dry-sand", wheels=WHEELS, ground=dunes)
data.ctrl[:] = 0.8  # rad/s: 0.1 m/s at the wheels
duration_s, began = 10.0, time.process_time()
with soil.installed():
    mujoco.mj_step(model, data, nstep=round(duration_s / model.opt.timestep))
pace = duration_s / (time.process_time() - began)

driven = float(np.hypot(*data.qpos[:2]))
print(f"{driven:.2f} m in {data.time:.0f} s; {pace:.0f} times as fast as real time (processor time)")
wheels = soil.wheels()
for name, slip, sinkage, pull in zip(WHEELS, wheels.slip, wheels.sinkage_m, wheels.pull_n):
    print(f"{name:13} slip {slip:5.2f}  sinkage {1e3 * sinkage:4.1f} mm  pull {pull:6.1f} N")
