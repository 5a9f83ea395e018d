"""Robots as MuJoCo models and as their owners describe them."""

from __future__ import annotations

import dataclasses
from typing import Dict, List, Optional, Tuple

from slipbench.log import Link, Robot, Wheel

# Encoders on the motors' shafts behind gears of 50 to 100: thousands of ticks a turn of the wheel.
TICKS, FREE_TICKS = 3840.0, 2000.0
STEP_S = 0.0025


@dataclasses.dataclass(frozen=True)
class Vehicle:
    """`links`: pivot height and what carries it come from the robot. `arms`: spring of a link (N m/rad, spring reference in degrees)."""

    robot: Robot
    wheel_kg: float
    is_rigid_contact: bool = True
    axle_z_m: float = 0.15
    drive_kv: float = 20.0
    torque_nm: float = 15.0
    arms: Tuple[Tuple[str, float, float], ...] = ()
    half_size_m: Tuple[float, float, float] = (0.25, 0.15, 0.05)
    front_free: Tuple[Wheel, ...] = ()  # wheels without an encoder (of a car that steers)

    @property
    def all_wheels(self) -> Tuple[Wheel, ...]:
        return self.robot.wheels + self.front_free


def four(torque_nm: float = 15.0) -> Vehicle:
    """Half a Husky: four fixed wheels, 13 kg."""
    places = {"front_left": (0.25, 0.25), "front_right": (0.25, -0.25), "rear_left": (-0.25, 0.25), "rear_right": (-0.25, -0.25)}
    wheels = tuple(Wheel(name, x, y, 0.15, TICKS, width_m=0.12) for name, (x, y) in places.items())
    return Vehicle(Robot("four wheels", wheels, mass_kg=10.6), 0.6, torque_nm=torque_nm)


def five() -> Vehicle:
    """The robot of Ani et al. (2012) in sizes of examples/robots/five-wheel.toml: two rockers, an arm with a driven and a free wheel."""
    rockers = [("left", 0.25), ("right", -0.25)]
    wheels: List[Wheel] = []
    for side, y in rockers:
        for place, x in (("front", 0.3), ("rear", -0.3)):
            wheels.append(Wheel(f"{place}_{side}", x, y, 0.15, TICKS, width_m=0.12, link=f"{side}_rocker"))
    wheels.append(Wheel("fifth", -0.55, 0.0, 0.12, TICKS, width_m=0.08, link="arm"))
    wheels.append(Wheel("free", -0.72, 0.0, 0.10, FREE_TICKS, is_powered=False, width_m=0.06, link="sub_arm"))
    links = (
        Link("left_rocker", (0.0, 0.25, 0.22), opposite="right_rocker"),
        Link("right_rocker", (0.0, -0.25, 0.22), opposite="left_rocker"),
        Link("arm", (-0.25, 0.0, 0.22)),
        Link("sub_arm", (-0.55, 0.0, 0.15), on="arm"),
    )
    robot = Robot("five wheels", tuple(wheels), links, mass_kg=8.0, cg_z_m=0.26)
    return Vehicle(robot, 0.6, axle_z_m=0.22, arms=(("arm", 4.0, -21.5),))


def rocker_bogie() -> Vehicle:
    """Six wheels; a rocker has the front wheel and a bogie with the other two. Sizes of a 20 kg rover of a student team."""
    wheels: List[Wheel] = []
    links: List[Link] = []
    for side, y, other in (("left", 0.3, "right"), ("right", -0.3, "left")):
        wheels.append(Wheel(f"front_{side}", 0.42, y, 0.12, TICKS, width_m=0.1, link=f"{side}_rocker"))
        wheels.append(Wheel(f"middle_{side}", 0.0, y, 0.12, TICKS, width_m=0.1, link=f"{side}_bogie"))
        wheels.append(Wheel(f"rear_{side}", -0.38, y, 0.12, TICKS, width_m=0.1, link=f"{side}_bogie"))
        links.append(Link(f"{side}_rocker", (0.08, y, 0.25), opposite=f"{other}_rocker"))
        links.append(Link(f"{side}_bogie", (-0.19, y, 0.18), on=f"{side}_rocker"))
    robot = Robot("rocker bogie", tuple(wheels), tuple(links), mass_kg=14.0, cg_z_m=0.3)
    return Vehicle(robot, 0.6, axle_z_m=0.25, half_size_m=(0.3, 0.2, 0.06))


def car() -> Vehicle:
    """A 1:5 car with rear drive; the steered front wheels have no encoders."""
    rear = tuple(Wheel(f"rear_{side}", 0.0, y, 0.09, TICKS, width_m=0.06) for side, y in (("left", 0.18), ("right", -0.18)))
    front = tuple(Wheel(f"front_{side}", 0.5, y, 0.09, TICKS, is_powered=False, is_steered=True, width_m=0.06) for side, y in (("left", 0.18), ("right", -0.18)))
    return Vehicle(Robot("car", rear, mass_kg=6.0, cg_z_m=0.12), 0.3, axle_z_m=0.09, drive_kv=3.0, torque_nm=4.0, half_size_m=(0.25, 0.12, 0.04), front_free=front)


@dataclasses.dataclass(frozen=True)
class Field:
    """A height field: its size, and the place of its middle and lowest point."""

    columns: int
    rows: int
    half_x_m: float
    half_y_m: float
    height_m: float
    middle_x_m: float
    low_m: float


def model_text(vehicle: Vehicle, field: Optional[Field]) -> str:
    """MJCF."""
    robot = vehicle.robot
    pivots: Dict[Optional[str], Tuple[float, float, float]] = {None: (0.0, 0.0, vehicle.axle_z_m)}
    pivots |= {link.name: link.pivot_m for link in robot.links}
    springs = {name: (stiffness, reference) for name, stiffness, reference in vehicle.arms}

    def wheel_body(wheel: Wheel) -> str:
        a, b, c = pivots[wheel.link]
        place = f"{wheel.x_m - a} {wheel.y_m - b} {wheel.radius_m - c}"
        mass = vehicle.wheel_kg * (1.0 if wheel.is_powered else 0.5)
        kind = 1 if vehicle.is_rigid_contact else 0
        # priority: friction is the wheel's, which the world sets by where the wheel is
        geom = f"""<geom name="{wheel.name}" type="ellipsoid" size="{wheel.radius_m} {wheel.width_m / 2} {wheel.radius_m}" mass="{mass}"
          friction="0.8 0.005 0.0001" condim="3" priority="1" solref="0.01 1" contype="{kind}" conaffinity="0"/>"""
        armature = 0.01 if wheel.is_powered else 0.0
        joint = f'<joint name="{wheel.name}" type="hinge" axis="0 1 0" damping="0.001" armature="{armature}"/>'
        if wheel.is_steered:
            return f"""<body pos="{place}"><joint name="{wheel.name}_steer" type="hinge" axis="0 0 1" range="-30 30" limited="true" armature="0.01" damping="0.2"/>
              <geom type="sphere" size="0.02" mass="0.1" contype="0" conaffinity="0"/><body name="{wheel.name}">{joint}{geom}</body></body>"""
        return f'<body name="{wheel.name}" pos="{place}">{joint}{geom}</body>'

    def carried(name: Optional[str]) -> str:
        text = "".join(wheel_body(wheel) for wheel in vehicle.all_wheels if wheel.link == name)
        for link in robot.links:
            if link.on != name:
                continue
            a, b, c = (x - y for x, y in zip(link.pivot_m, pivots[name]))
            stiffness, reference = springs.get(link.name, (0.0, 0.0))
            mass = 0.08 if link.name == "sub_arm" else 0.6
            damping = 0.05 if link.name == "sub_arm" else 1.0
            text += f"""<body name="{link.name}" pos="{a} {b} {c}"><joint name="{link.name}" type="hinge" axis="0 1 0" damping="{damping}"
              stiffness="{stiffness}" springref="{reference}" range="-30 30" limited="true"/>
              <geom type="sphere" size="0.03" mass="{mass}" contype="0" conaffinity="0"/>{carried(link.name)}</body>"""
        return text

    ties = [link for link in robot.links if link.opposite is not None and link.name < str(link.opposite)]
    equality = "".join(f'<joint joint1="{link.name}" joint2="{link.opposite}" polycoef="0 -1 0 0 0"/>' for link in ties)
    drives = "".join(f'<velocity joint="{wheel.name}" kv="{vehicle.drive_kv}" forcerange="-{vehicle.torque_nm} {vehicle.torque_nm}"/>' for wheel in robot.powered)
    steers = "".join(f'<position joint="{wheel.name}_steer" kp="20" forcerange="-6 6"/>' for wheel in vehicle.front_free)
    asset, floor = "", ""
    if field is not None:
        size = f"{field.half_x_m} {field.half_y_m} {field.height_m} 0.5"
        asset = f'<asset><hfield name="h" nrow="{field.rows}" ncol="{field.columns}" size="{size}"/></asset>'
        # here and not later: MuJoCo compiles geoms at the origin of their body to have no place of their own
        floor = f'<geom name="floor" type="hfield" hfield="h" pos="{field.middle_x_m} 0 {field.low_m}" contype="0" conaffinity="1"/>'
    elif vehicle.is_rigid_contact:
        floor = '<geom name="floor" type="plane" size="100 100 1" contype="0" conaffinity="1"/>'
    box = " ".join(str(size) for size in vehicle.half_size_m)
    middle = 0.25 if vehicle.front_free else 0.0
    return f"""<mujoco><option timestep="{STEP_S}" integrator="implicitfast"/>{asset}
      <worldbody>{floor}<body name="chassis" pos="0 0 {vehicle.axle_z_m}"><freejoint/>
      <geom type="box" size="{box}" mass="{robot.mass_kg}" pos="{middle} 0 {robot.cg_z_m - vehicle.axle_z_m}" contype="0" conaffinity="0"/>
      <site name="imu"/>{carried(None)}</body></worldbody>
      <equality>{equality}</equality><actuator>{drives}{steers}</actuator>
      <sensor><gyro site="imu"/><accelerometer site="imu"/></sensor></mujoco>"""
