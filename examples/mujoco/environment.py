"""The rover on sand as a Gymnasium environment: `python examples/mujoco/environment.py` drives it at random."""

from pathlib import Path
from typing import Any

import gymnasium
import mujoco
import numpy as np

from grouser.mujoco import SoftGround

WHEELS = [f"{place}_{side}" for side in ("left", "right") for place in ("front", "middle", "rear")]
PERIOD_S = 0.1
"""Time between actions, s: some periods of a wheel's speed loop."""
ENERGY_M_PER_J = 1e-3
"""Price of energy in the reward: at 0.1 m/s the rover uses 120 J/m, so that energy costs an eighth of the progress."""


class SandRover(gymnasium.Env[np.ndarray, np.ndarray]):
    """Wheel speeds (rad/s) in; velocity, turning rate, gravity in the robot's frame, slips and sinkages (m) out.

    The reward is the progress along x, m, less the price of the motors' energy. Slips are true, which no robot measures.
    """

    def __init__(self, soil: str = "dry-sand", duration_s: float = 20.0) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_name("rover.xml")))
        self.data = mujoco.MjData(self.model)
        self.ground = SoftGround(self.model, self.data, soil=soil, wheels=WHEELS, ground=self.height)
        self.duration_s, self.phase = duration_s, np.zeros(2)
        count = len(WHEELS)
        self.action_space = gymnasium.spaces.Box(-4.0, 4.0, (count,), np.float64)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (9 + 2 * count,), np.float64)

    def height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 0.05 * np.sin(1.5 * x + self.phase[0]) * np.cos(y + self.phase[1])

    def observation(self) -> np.ndarray:
        axes, wheels = self.data.body("chassis").xmat.reshape(3, 3), self.ground.wheels()
        slip = np.nan_to_num(wheels.slip)  # no slip is defined at standstill
        return np.concatenate([axes.T @ self.data.qvel[:3], self.data.qvel[3:6], axes[2], slip, wheels.sinkage_m])

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        self.phase = self.np_random.uniform(0.0, 2.0 * np.pi, 2)  # other dunes
        mujoco.mj_resetData(self.model, self.data)
        self.ground.reset()
        self.data.qpos[2] += self.height(self.data.qpos[:1], self.data.qpos[1:2])[0] + 0.03
        self.step(np.zeros(len(WHEELS)))
        return self.observation(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        start, energy = self.data.qpos[0], 0.0
        self.data.ctrl[:] = action
        with self.ground.installed():
            for _ in range(round(PERIOD_S / self.model.opt.timestep)):
                mujoco.mj_step(self.model, self.data)
                # motors do not charge the battery
                power = self.data.actuator_force * self.data.actuator_velocity
                energy += self.model.opt.timestep * float(np.maximum(power, 0.0).sum())
        reward = float(self.data.qpos[0] - start) - ENERGY_M_PER_J * energy
        is_lost = bool(self.ground.wheels().is_buried.all() or self.data.body("chassis").xmat[8] < 0.0)
        return self.observation(), reward, is_lost, bool(self.data.time > self.duration_s - 0.5 * PERIOD_S), {"energy_j": energy}


if __name__ == "__main__":
    rover = SandRover()
    rover.reset(seed=1)
    rover.action_space.seed(1)
    total, done = 0.0, False
    while not done:
        _, reward, terminated, truncated, _ = rover.step(np.abs(rover.action_space.sample()))
        total, done = total + reward, terminated or truncated
    print(f"{rover.data.qpos[0]:.2f} m in {rover.data.time:.0f} s, reward {total:.2f}")
