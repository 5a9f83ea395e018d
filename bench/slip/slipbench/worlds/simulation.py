"""A vehicle on a ground in MuJoCo, and its true motion."""

from __future__ import annotations

import dataclasses
import math
from typing import List, Optional, Tuple

import mujoco
import numpy as np

from slipbench.log import Floats
from slipbench.motion import SAMPLE_S, Motion
from slipbench.worlds.ground import Ground, SoftGround
from slipbench.worlds.vehicles import STEP_S, Field, Vehicle, model_text

PUSH_S = 0.005  # between computations of the soft ground's forces
DAMPING_S = 0.03
SETTLE_S = 1.0  # before the log: the robot is set down


@dataclasses.dataclass(frozen=True)
class Plan:
    """Commanded speed and turn at each sample; what a sled pulls back (N); does the robot hold its heading by its gyro?"""

    speed: Floats
    turn: Floats
    holds_heading: bool = True
    sled_n: Optional[Floats] = None
    # a skid-steered robot turns less than its wheels say: its driver commands more
    turn_factor: float = 1.0


def simulate(vehicle: Vehicle, ground: Ground, plan: Plan, soft: Optional[SoftGround] = None, extent: Tuple[float, float] = (14.0, 4.0), cell_m: float = 0.1) -> Motion:
    """The soft ground, if any, pushes the wheels instead of MuJoCo's contacts. `extent`: length and half width of the ground, in cells."""
    is_flat = not ground.waves and not ground.ramps and ground.side_slope == 0.0
    field, heights = None, np.zeros(0)
    if soft is not None:
        vehicle = dataclasses.replace(vehicle, is_rigid_contact=False)
    elif not is_flat:
        length, half = extent
        columns, rows = round(length / cell_m) + 1, round(2 * half / cell_m) + 1
        # the robot starts 2 m from the end of the ground
        heights = ground.height(*np.meshgrid(np.linspace(-2, length - 2, columns), np.linspace(-half, half, rows)))
        low = float(heights.min())
        field = Field(columns, rows, 0.5 * length, half, float(heights.max()) - low, 0.5 * length - 2, low)
    model = mujoco.MjModel.from_xml_string(model_text(vehicle, field))
    if field is not None:
        model.hfield_data[:] = ((heights - field.low_m) / field.height_m).ravel()
    data = mujoco.MjData(model)
    # placed so that no wheel is below the ground
    wheels = vehicle.all_wheels
    lift = max(float(ground.height(np.array(wheel.x_m), np.array(wheel.y_m))) for wheel in wheels)
    data.qpos[:3] = (0.0, 0.0, vehicle.axle_z_m + lift + 0.005)
    mujoco.mj_forward(model, data)
    record = Recorder(vehicle, model, data, ground)
    push = SoftPush(vehicle, model, ground, soft) if soft is not None else None
    substeps = round(SAMPLE_S / STEP_S)
    chassis = model.body("chassis").id
    count = len(plan.speed)
    geoms = [model.geom(wheel.name).id for wheel in wheels]
    bodies = [model.body(wheel.name).id for wheel in wheels]
    target = 0.0
    settling = round(SETTLE_S / SAMPLE_S)
    for k in range(-settling, count):
        matrix = data.xmat[chassis]
        if k >= 0:
            yaw = math.atan2(matrix[3], matrix[0])
            turn = float(plan.turn[k])
            target += turn * SAMPLE_S
            if plan.holds_heading:
                error = (target - yaw + math.pi) % (2 * math.pi) - math.pi
                moves = min(1.0, abs(float(plan.speed[k])) / 0.05)
                turn += moves * min(max(1.0 * error, -0.4), 0.4)
            command(vehicle, data, float(plan.speed[k]), turn * plan.turn_factor)
            for geom, body in zip(geoms, bodies):
                model.geom_friction[geom, 0] = ground.friction(float(data.xpos[body, 0]))
        if plan.sled_n is not None and k >= 0:
            forward = matrix[[0, 3, 6]]
            velocity = data.qvel[:3]
            along = float(velocity @ forward)
            # a sled resists motion only; below 2 cm/s less, so that it does not push
            data.xfrc_applied[chassis, :3] = -plan.sled_n[k] * min(max(along / 0.02, 0.0), 1.0) * forward
        readings = np.zeros(model.nsensordata)
        for step in range(substeps):
            if push is not None and step % round(PUSH_S / STEP_S) == 0:
                push.apply(data)
            mujoco.mj_step(model, data)
            readings += data.sensordata
        if k < 0:
            continue
        # an inertial unit samples fast and filters: the mean over the sample, not a moment of a contact's chatter
        record.sample(readings / substeps)
        place = data.xpos[chassis]
        if matrix[8] < 0.5 or (field is not None and not (-1.2 < place[0] < field.half_x_m + field.middle_x_m - 0.8 and abs(place[1]) < field.half_y_m - 0.8)):
            break  # the robot lies on its side, or the ground ends
    return record.motion(plan)


def command(vehicle: Vehicle, data: mujoco.MjData, speed: float, turn: float) -> None:
    if vehicle.front_free:
        base = vehicle.front_free[0].x_m
        limit = math.radians(28)
        angle = min(max(math.atan2(turn * base, abs(speed)) if abs(speed) > 0.05 else 0.0, -limit), limit)
        for i, wheel in enumerate(vehicle.robot.powered):
            data.ctrl[i] = (speed - math.tan(angle) / base * speed * wheel.y_m) / wheel.radius_m
        for i, wheel in enumerate(vehicle.front_free):
            # Ackermann: both front wheels point at one centre
            bend = math.tan(angle) / base
            data.ctrl[len(vehicle.robot.powered) + i] = math.atan2(bend * base, 1 - bend * wheel.y_m)
        return
    for i, wheel in enumerate(vehicle.robot.powered):
        data.ctrl[i] = (speed - turn * wheel.y_m) / wheel.radius_m


class SoftPush:
    """Puts a soft ground's forces on the wheels, before each step."""

    def __init__(self, vehicle: Vehicle, model: mujoco.MjModel, ground: Ground, soft: SoftGround) -> None:
        self.model, self.ground, self.soft = model, ground, soft
        wheels = vehicle.all_wheels
        self.bodies = np.array([model.body(wheel.name).id for wheel in wheels])
        self.parents = model.body_parentid[self.bodies]
        self.radius = np.array([wheel.radius_m for wheel in wheels])
        self.width = np.array([wheel.width_m for wheel in wheels])
        soft.prepare([(wheel.radius_m, wheel.width_m) for wheel in wheels])
        self.slip, self.side, self.dug = (np.zeros(len(wheels)) for _ in range(3))
        self.velocity = np.zeros((len(wheels), 6))

    def apply(self, data: mujoco.MjData) -> None:
        for i, body in enumerate(self.bodies):
            mujoco.mj_objectVelocity(self.model, data, mujoco.mjtObj.mjOBJ_BODY, int(body), self.velocity[i], 0)
        place = data.xpos[self.bodies]
        axle = data.xmat[self.parents].reshape(-1, 3, 3)[:, :, 1]
        slope_x, slope_y = self.ground.gradient(place[:, 0], place[:, 1])
        normal = np.stack([-slope_x, -slope_y, np.ones(len(slope_x))], axis=1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        along = np.cross(axle, normal)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = np.cross(normal, along)
        velocity = self.velocity[:, 3:]
        forward, left, up = ((velocity * axis).sum(axis=1) for axis in (along, across, normal))
        rim = (self.velocity[:, :3] * axle).sum(axis=1) * self.radius
        faster = np.maximum(np.abs(rim), np.abs(forward))
        share = PUSH_S / self.soft.relaxation_m
        # the contact's deflection follows the slip over a relaxation length; implicit, so that it is stable at any speed
        self.slip = np.clip((self.slip + share * (rim - forward)) / (1 + share * faster), -1, 1)
        self.side = np.clip((self.side - share * left) / (1 + share * np.maximum(faster, np.abs(left))), -1, 1)
        # a contact damps its own deflection: without it a standing robot would swing on its soil
        slip = np.clip(self.slip + DAMPING_S / self.soft.relaxation_m * (rim - forward), -1, 1)
        side = np.clip(self.side - DAMPING_S / self.soft.relaxation_m * left, -1, 1)
        depth = (self.ground.height(place[:, 0], place[:, 1]) - place[:, 2]) * normal[:, 2] + self.radius
        self.dug += PUSH_S * (self.soft.dig_rate(rim - forward) - self.dug * np.abs(forward) / 0.15)
        self.dug = np.clip(self.dug, 0, 0.6 * self.radius)
        push = self.soft.forces(depth - self.dug, -up, slip, side)
        # soil pushed in front of a wheel in its own rut: passive pressure over its width, 20 kPa per m of depth
        wall = 0.5 * 20e3 * self.width * self.dug**2 * np.clip(forward / 0.02, -1, 1)
        moment = push.moment + self.soft.rolling * push.normal * self.radius * np.clip(rim / 0.02, -1, 1)
        force = push.normal[:, None] * normal + (push.pull - wall)[:, None] * along + push.aside[:, None] * across
        data.xfrc_applied[self.bodies, :3] = force
        data.xfrc_applied[self.bodies, 3:] = -moment[:, None] * axle


class Recorder:
    """Copies MuJoCo's state at each sample, and derives the motion from it at the end."""

    def __init__(self, vehicle: Vehicle, model: mujoco.MjModel, data: mujoco.MjData, ground: Ground) -> None:
        self.vehicle, self.model, self.data, self.ground = vehicle, model, data, ground
        wheels = vehicle.robot.wheels
        self.wheels = np.array([model.body(wheel.name).id for wheel in wheels])
        self.parents = model.body_parentid[self.wheels]
        self.joints = np.array([model.jnt_qposadr[model.joint(wheel.name).id] for wheel in wheels])
        self.links = {link.name: int(model.jnt_qposadr[model.joint(link.name).id]) for link in vehicle.robot.links}
        self.steers = [int(model.jnt_qposadr[model.joint(f"{wheel.name}_steer").id]) for wheel in vehicle.front_free]
        self.chassis = model.body("chassis").id
        self.places: List[Floats] = []
        self.matrices: List[Floats] = []
        self.origins: List[Floats] = []
        self.frames: List[Floats] = []
        self.positions: List[Floats] = []
        self.readings: List[Floats] = []

    def sample(self, readings: Floats) -> None:
        data = self.data
        self.places.append(data.xpos[self.wheels].copy())
        self.matrices.append(data.xmat[self.parents].copy())
        self.origins.append(data.xpos[self.chassis].copy())
        self.frames.append(data.xmat[self.chassis].copy())
        self.positions.append(data.qpos.copy())
        self.readings.append(readings)

    def motion(self, plan: Plan) -> Motion:
        places, origins, positions, readings = (np.array(one) for one in (self.places, self.origins, self.positions, self.readings))
        count = len(places)
        carriers = np.array(self.matrices).reshape(count, -1, 3, 3)
        frames = np.array(self.frames).reshape(count, 3, 3)
        rolled, ground, turned = {}, {}, {}
        for i, wheel in enumerate(self.vehicle.robot.wheels):
            angle = positions[:, self.joints[i]]
            pitched = turning_about(carriers[:, i], 1)
            rolled[wheel.name] = wheel.radius_m * (angle + pitched)
            turned[wheel.name] = angle
            ground[wheel.name] = self.along_ground(places[:, i], carriers[:, i])
        steps = np.diff(origins, axis=0, prepend=origins[:1])
        forward, left = (np.cumsum((steps * frames[:, :, axis]).sum(axis=1)) for axis in (0, 1))
        yaw = np.unwrap(np.arctan2(frames[:, 1, 0], frames[:, 0, 0]))
        links = {name: positions[:, at] for name, at in self.links.items()}
        steering = None
        if self.steers:
            # the bicycle's angle: mean of both cotangents
            tangents = [np.tan(positions[:, at]) for at in self.steers]
            steering = np.arctan(0.5 * (tangents[0] + tangents[1]))
        time_s = SAMPLE_S * np.arange(1, count + 1)
        robot = dataclasses.replace(self.vehicle.robot, origin_z_m=self.vehicle.axle_z_m)
        return Motion(robot, time_s, origins[:, 0], origins[:, 1], yaw, forward, left, readings[:, :3], turned, rolled, ground, readings[:, 3:], links, steering)

    def along_ground(self, places: Floats, carriers: Floats) -> Floats:
        """Distance of a wheel's centre along the ground under it, in the wheel's heading."""
        slope_x, slope_y = self.ground.gradient(places[:, 0], places[:, 1])
        normal = np.stack([-slope_x, -slope_y, np.ones(len(slope_x))], axis=1)
        along = np.cross(carriers[:, :, 1], normal)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        middle = 0.5 * (along[1:] + along[:-1])
        return np.concatenate([[0.0], np.cumsum((np.diff(places, axis=0) * middle).sum(axis=1))])


def turning_about(frames: Floats, axis: int) -> Floats:
    """Rotation of a body about one of its own axes, summed over small turns."""
    small = np.einsum("kji,kjl->kil", frames[:-1], frames[1:])
    a, b = (axis + 1) % 3, (axis + 2) % 3
    return np.concatenate([[0.0], np.cumsum(0.5 * (small[:, b, a] - small[:, a, b]))])

