"""The five-wheeled robot of examples/robots in MuJoCo, a world of other laws: rigid ground with friction, waves along the course.

    python mujoco_five_wheel.py AMPLITUDE_M FRICTION

Writes mj.csv (counts and gyro) and mj_truth.csv (true slips) into the working folder. Needs numpy and mujoco.
"""

import csv
import math
import sys

import mujoco
import numpy as np

LENGTH_M, WIDTH_M, WAVE_M = 18.0, 8.0, 4.0
COLUMNS, ROWS = 361, 161
STEP_S, LASTS_S, EVERY = 0.001, 45.0, 10
SPEED_M_PER_S, BEGINS_S, STOPS_S = 0.2, 2.0, (20.0, 22.0)
GYRO_SIGMA = math.radians(0.17)
# name: radius, width, mass, place, pivot of its carrier, m and kg
WHEELS = {
    "front_left": (0.15, 0.12, 0.6, (0.3, 0.25, 0.15), (0, 0.25, 0.22)),
    "front_right": (0.15, 0.12, 0.6, (0.3, -0.25, 0.15), (0, -0.25, 0.22)),
    "rear_left": (0.15, 0.12, 0.6, (-0.3, 0.25, 0.15), (0, 0.25, 0.22)),
    "rear_right": (0.15, 0.12, 0.6, (-0.3, -0.25, 0.15), (0, -0.25, 0.22)),
    "fifth": (0.12, 0.08, 0.4, (-0.55, 0, 0.12), (-0.25, 0, 0.22)),
    "free": (0.10, 0.06, 0.2, (-0.72, 0, 0.10), (-0.55, 0, 0.15)),
}
POWERED = [name for name in WHEELS if name != "free"]
TICKS = {"free": 2000}
OTHER_TICKS = 3840
CENTRE_Z_M = 0.26


def wheel_body(name, friction):
    radius, width, mass, place, pivot = WHEELS[name]
    x, y, z = (a - b for a, b in zip(place, pivot))
    return f"""<body name="{name}" pos="{x} {y} {z}"><joint name="{name}" type="hinge" axis="0 1 0" damping="0.001" armature="0.01"/>
      <geom type="ellipsoid" size="{radius} {width / 2} {radius}" mass="{mass}" friction="{friction} 0.005 0.0001" condim="3"
      contype="1" conaffinity="0"/></body>"""


def description(amplitude_m, friction):
    wheel = lambda name: wheel_body(name, friction)
    rocker = lambda name, y, front, rear: f"""<body name="{name}" pos="0 {y} -.04">
      <joint name="{name}" type="hinge" axis="0 1 0" damping="1" range="-25 25" limited="true"/>
      <geom type="sphere" size=".02" mass=".8" contype="0" conaffinity="0"/>{wheel(front)}{wheel(rear)}</body>"""
    motors = "".join(f'<velocity joint="{name}" kv="20"/>' for name in POWERED)
    return f"""<mujoco><option timestep="{STEP_S}" integrator="implicitfast"/>
    <asset><hfield name="h" nrow="{ROWS}" ncol="{COLUMNS}" size="{LENGTH_M / 2} {WIDTH_M / 2} {max(2 * amplitude_m, 1e-3)} 0.5"/></asset>
    <worldbody><geom type="hfield" hfield="h" friction="{friction} 0.005 0.0001" contype="0" conaffinity="1"/>
    <body name="chassis" pos="-7.5 0 {2 * amplitude_m + 0.28}"><freejoint/>
     <geom type="box" size=".25 .15 .05" mass="8" pos="0.02 0 0" contype="0" conaffinity="0"/><site name="imu"/>
     {rocker("left", 0.25, "front_left", "rear_left")}{rocker("right", -0.25, "front_right", "rear_right")}
     <body name="arm" pos="-.25 0 -.04"><joint name="arm" type="hinge" axis="0 1 0" stiffness="4" springref="-21.5" damping="1"
      range="-30 30" limited="true"/><geom type="sphere" size=".02" mass=".4" pos="-.17 0 -.04" contype="0" conaffinity="0"/>
      {wheel("fifth")}<body name="sub" pos="-.3 0 -.07"><joint name="sub" type="hinge" axis="0 1 0" damping=".05" range="-30 30"
       limited="true"/><geom type="sphere" size=".01" mass=".08" pos="-.08 0 -.03" contype="0" conaffinity="0"/>{wheel("free")}</body>
     </body></body></worldbody>
    <equality><joint joint1="left" joint2="right" polycoef="0 -1 0 0 0"/></equality>
    <actuator>{motors}</actuator><sensor><gyro site="imu"/></sensor></mujoco>"""


def true_slip(model, data, name, amplitude_m):
    """Speed of the wheel's centre along the ground under it against its circumferential speed in the world."""
    body = model.body(name).id
    velocity = np.zeros(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
    slope = amplitude_m * 2 * math.pi / WAVE_M * math.sin(2 * math.pi * (data.xpos[body][0] + LENGTH_M / 2) / WAVE_M)
    along = (velocity[3] + velocity[5] * slope) / math.hypot(1, slope)
    wheel = velocity[1] * WHEELS[name][0]
    if abs(wheel) < 0.02:
        return ""
    return 1 - along / wheel if abs(along) <= abs(wheel) else wheel / along - 1


def main():
    amplitude_m, friction = float(sys.argv[1]), float(sys.argv[2])
    model = mujoco.MjModel.from_xml_string(description(amplitude_m, friction))
    x = np.linspace(0, LENGTH_M, COLUMNS)
    heights = 0.5 * (1 - np.cos(2 * math.pi * x / WAVE_M)) if amplitude_m > 0 else 0 * x
    model.hfield_data[:] = np.tile(heights, (ROWS, 1)).ravel()
    data, random = mujoco.MjData(model), np.random.default_rng(1)
    address = {name: model.jnt_qposadr[model.joint(name).id] for name in WHEELS}
    rows, truth = [], []
    for step in range(round(LASTS_S / STEP_S)):
        time_s = step * STEP_S
        speed = SPEED_M_PER_S * min(max(time_s - BEGINS_S, 0.0), 1.0) * (not STOPS_S[0] < time_s < STOPS_S[1])
        for i, name in enumerate(POWERED):
            data.ctrl[i] = speed / WHEELS[name][0]
        mujoco.mj_step(model, data)
        if step % EVERY == EVERY - 1:
            turns = {name: data.qpos[address[name]] / (2 * math.pi) for name in WHEELS}
            ticks = [math.floor(turns[name] * TICKS.get(name, OTHER_TICKS)) for name in WHEELS]
            rows.append([step + 1, *ticks, round(data.sensordata[2] + GYRO_SIGMA * random.standard_normal(), 6)])
            truth.append([(step + 1) * STEP_S, *(true_slip(model, data, name, amplitude_m) for name in POWERED)])
    for name, head, body in (
        ("mj.csv", ["time_ms", *(f"{wheel}_ticks" for wheel in WHEELS), "gyro_z_rad_per_s"], rows),
        ("mj_truth.csv", ["time_s", *(f"{wheel}_slip" for wheel in POWERED)], truth),
    ):
        with open(name, "w", newline="") as out:
            csv.writer(out).writerows([head, *body])


if __name__ == "__main__":
    main()
