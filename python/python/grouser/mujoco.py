"""Soft ground under the wheels of a MuJoCo model.

Needs MuJoCo (`pip install mujoco`). The forces are those of `grouser drive`: the wheel-soil model at the sinkage of each
wheel, with the shear displacement of the contact as a state. Slip itself is undefined at standstill and is never divided
by; a wheel holds a slope without creeping.

The ground is rigid for everything but the named wheels. Wheels leave no ruts.

Examples
--------
>>> import mujoco
>>> from grouser.mujoco import SoftGround
>>> model = mujoco.MjModel.from_xml_string('''
... <mujoco>
...   <option timestep="0.002"/>
...   <worldbody>
...     <geom name="floor" type="plane" size="5 5 0.1"/>
...     <body pos="0 0 0.1">
...       <freejoint/>
...       <geom type="box" size="0.2 0.1 0.02" mass="4" pos="0 0 0.1"/>
...       <body name="wheel">
...         <joint type="hinge" axis="0 1 0"/>
...         <geom type="cylinder" size="0.1 0.05" euler="90 0 0" mass="1"/>
...       </body>
...     </body>
...   </worldbody>
... </mujoco>''')
>>> data = mujoco.MjData(model)
>>> ground = SoftGround(model, data, soil="dry-sand", wheels=["wheel"], ground="floor")
>>> with ground.installed():
...     mujoco.mj_step(model, data, nstep=5)
>>> bool(ground.wheels().normal_force_n[0] >= 0.0)
True
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

try:
    import mujoco
except ModuleNotFoundError:  # pragma: no cover
    raise ModuleNotFoundError("grouser.mujoco needs MuJoCo: pip install mujoco", name="mujoco") from None

from . import _core
from ._arrays import FloatArray
from ._core import Soil, Wheel
from ._errors import InputError, InputTypeError
from ._tables import Table
from .soils import of as soil_of
from .wheel import slip_from_speeds

__all__ = ["MAX_STEP_S", "SoftGround", "WheelStates"]

MAX_STEP_S = 2.5e-3
"""Maximum step, s, that of `grouser drive`: larger ones change the distance of a drive by more than 0.02 %."""

_PARALLEL = 1e-6
"""Tolerance of directions that must be parallel: files of models have about seven digits."""

Height = Callable[[FloatArray, FloatArray], Any]
"""Height of the ground, m, at arrays of x and y, m; NaN where there is none."""


class WheelStates(Table):
    """How the wheels meet the ground at the last step, in the order of the wheels."""

    sinkage_m: FloatArray
    """Sinkage, m; negative in the air."""
    normal_force_n: FloatArray
    """Force of the soil away from the ground, N."""
    pull_n: FloatArray
    """Force of the soil along the wheel, N, in the direction of positive spin."""
    side_force_n: FloatArray
    """Force of the soil along the axle, N."""
    torque_nm: FloatArray
    """Torque with which the soil resists positive spin, N m."""
    slip: FloatArray
    """Slip; NaN at standstill and where a wheel travels against its rotation."""
    slip_angle_deg: FloatArray
    """Drift from the wheel's plane, degrees, positive along the axle; NaN at standstill."""
    is_buried: npt.NDArray[np.bool_]
    """Is the hub about to be buried? There the laws end, and the forces are those at nine tenths of the radius."""


class SoftGround:
    """The soil under the wheels of one model and its data.

    Parameters
    ----------
    model : mujoco.MjModel
        Contacts of the wheels' bodies are switched off in it (``geom_contype`` and ``geom_conaffinity`` are 0), also those
        with obstacles.
    data : mujoco.MjData
        The data that receives the forces; other data of the same model are left alone.
    soil : Soil, str or path
        A soil, a key of the catalogue, or a soil file.
    wheels : sequence of str, or mapping of str to Wheel or None
        Names of bodies with one hinge joint; positive spin rolls forward. Radius and width are those of the body's cylinder,
        whose axis is that of the hinge, or those of the `Wheel`, which may have grousers.
    ground : str or callable
        Name of a plane or height field that does not move, or a function of arrays of x and y, m, that returns heights, m.

    Raises
    ------
    InputError
        A name that is not in the model, a wheel without hinge or cylinder, a step beyond `MAX_STEP_S`, the Runge-Kutta
        integrator (the contact has one state for each step).

    Notes
    -----
    Where time goes backwards, as after ``mj_resetData``, the contacts are forgotten. Finite differences of MuJoCo
    (``mjd_transitionFD``) step back and forth, so they are not those of this ground.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        soil: Soil | str | os.PathLike[str],
        wheels: Sequence[str] | Mapping[str, Wheel | None],
        ground: str | Height,
    ) -> None:
        step = model.opt.timestep
        if not step <= MAX_STEP_S:
            raise InputError(f"timestep is {step} s, but must be at most {MAX_STEP_S}", "timestep", step, MAX_STEP_S, "s")
        if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
            raise InputError("integrator is RK4, but the contact has one state for each step: use implicitfast", "integrator")
        self.model, self.data = model, data
        start = mujoco.MjData(model)
        mujoco.mj_kinematics(model, start)
        given = wheels if isinstance(wheels, Mapping) else dict.fromkeys([wheels] if isinstance(wheels, str) else wheels)
        found = [_wheel(model, start, name, wheel) for name, wheel in given.items()]
        if not found:
            raise InputError("wheels is empty, but must name bodies", "wheels")
        self.names = list(given)
        self._bodies, self._joints, self._geoms = (np.array(column) for column in list(zip(*found))[:3])
        self._contacts = _core.GroundContacts(soil_of("soil", soil), [wheel for *_, wheel in found])
        self._height = ground if callable(ground) else _height_of(model, start, ground)
        own = np.isin(model.geom_bodyid, self._bodies)
        model.geom_contype[own] = model.geom_conaffinity[own] = 0
        self._states = np.empty((len(found), 10))
        self._results = np.zeros((len(found), 15))
        self._roots = model.body_rootid[self._bodies]
        self._time: float | None = None

    def reset(self) -> None:
        """Forgets what the contacts remember, as after a jump of the robot."""
        self._contacts.reset()
        self._time = None

    def apply(self) -> None:
        """Adds the forces to ``data.qfrc_passive``.

        For steps in two halves: ``mj_step1``, `apply`, ``mj_step2``. A second call at the same time adds them a second time.
        """
        model, data = self.model, self.data
        if self._time is not None and data.time < self._time:
            self.reset()
        step = 0.0 if self._time is None else data.time - self._time
        self._time = data.time
        states = self._states
        at = data.geom_xpos[self._geoms]
        turning, moving = np.split(data.cvel[self._bodies], 2, axis=1)
        arm = at - data.subtree_com[self._roots]
        states[:, 0:3] = at
        states[:, 3:6] = data.xaxis[self._joints]
        # velocity of the centre: MuJoCo's refers to the centre of mass of the whole robot
        states[:, 6:9] = moving + np.cross(turning, arm)
        states[:, 9] = np.einsum("ij,ij->i", turning, states[:, 3:6])
        x, y = self._contacts.places(states.reshape(-1)).reshape(-1, 2).T
        heights = np.ascontiguousarray(self._height(x, y), dtype=np.float64)
        if heights.shape != x.shape:
            raise InputError(f"the height of the ground has the shape {heights.shape}, but must have that of x", "ground")
        self._results = self._contacts.step(states.reshape(-1), heights, step).reshape(-1, 15)
        for body, place, row in zip(self._bodies, at, self._results):
            mujoco.mj_applyFT(model, data, row[0:3], row[3:6], place, body, data.qfrc_passive)

    @contextmanager
    def installed(self) -> Iterator[SoftGround]:
        """MuJoCo's callback of passive forces calls `apply` within the context; a callback that was there is called before."""
        before = mujoco.get_mjcb_passive()

        def passive(model: mujoco.MjModel, data: mujoco.MjData) -> None:
            if before is not None:
                before(model, data)
            if data is self.data:
                self.apply()

        mujoco.set_mjcb_passive(passive)
        try:
            yield self
        finally:
            mujoco.set_mjcb_passive(before)

    def wheels(self) -> WheelStates:
        """How the wheels meet the ground at the last step."""
        sinkage, normal, pull, side, torque, forward, left, rim, buried = self._results[:, 6:].T.copy()
        angle = np.where((forward == 0.0) & (left == 0.0), np.nan, np.degrees(np.arctan2(left, np.abs(forward))))
        slip = slip_from_speeds(forward_speed_mps=forward, rim_speed_mps=rim)
        return WheelStates(sinkage, normal, pull, side, torque, slip, angle, buried != 0.0)


def _wheel(
    model: mujoco.MjModel, start: mujoco.MjData, name: str, wheel: Wheel | None
) -> tuple[int, int, int, Wheel]:
    """Body, joint and geom of a wheel, and the wheel."""
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if body < 0:
        raise InputError(f"wheels: the model has no body `{name}`", "wheels", name)
    if wheel is not None and not isinstance(wheel, Wheel):
        raise InputTypeError(f"wheels: `{name}` is {type(wheel).__name__}, but must be a Wheel or None", "wheels", wheel)
    joint = model.body_jntadr[body]
    if model.body_jntnum[body] != 1 or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
        raise InputError(f"wheels: the body `{name}` must have one joint, a hinge", "wheels", name)
    geoms = model.body_geomadr[body] + np.arange(model.body_geomnum[body])
    axes = start.geom_xmat[geoms].reshape(-1, 3, 3)[:, :, 2]
    is_cylinder = model.geom_type[geoms] == mujoco.mjtGeom.mjGEOM_CYLINDER
    round_it = geoms[is_cylinder & (np.abs(axes @ start.xaxis[joint]) > 1.0 - _PARALLEL)]
    if len(round_it) == 0 and (wheel is None or len(geoms) == 0):
        raise InputError(f"wheels: the body `{name}` has no cylinder about its hinge; give a Wheel", "wheels", name)
    geom = round_it[0] if len(round_it) else geoms[0]
    if wheel is None:
        radius, half_width, _ = model.geom_size[geom]
        wheel = Wheel(radius_m=radius, width_m=2.0 * half_width)
    return body, joint, geom, wheel


def _height_of(model: mujoco.MjModel, start: mujoco.MjData, name: str) -> Height:
    """The height of a plane or a height field."""
    geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name)
    if geom < 0:
        raise InputError(f"ground: the model has no geom `{name}`", "ground", name)
    if model.body_weldid[model.geom_bodyid[geom]] != 0:
        raise InputError(f"ground: the body of `{name}` moves", "ground", name)
    origin, axes = start.geom_xpos[geom].copy(), start.geom_xmat[geom].reshape(3, 3).copy()
    up = axes[:, 2]
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE and up[2] > _PARALLEL:
        slope = -up[:2] / up[2]
        return lambda x, y: origin[2] + slope[0] * (x - origin[0]) + slope[1] * (y - origin[1])
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_HFIELD or up[2] < 1.0 - _PARALLEL:
        raise InputError(f"ground: `{name}` must be a plane or an upright height field", "ground", name)
    field = model.geom_dataid[geom]
    half_x, half_y, top, _ = model.hfield_size[field]
    rows, columns = model.hfield_nrow[field], model.hfield_ncol[field]
    first = model.hfield_adr[field]
    # a view: heights that are changed later count
    grid = model.hfield_data[first : first + rows * columns].reshape(rows, columns)

    def height(x: FloatArray, y: FloatArray) -> FloatArray:
        dx, dy = x - origin[0], y - origin[1]
        u = (axes[0, 0] * dx + axes[1, 0] * dy + half_x) * ((columns - 1) / (2.0 * half_x))
        v = (axes[0, 1] * dx + axes[1, 1] * dy + half_y) * ((rows - 1) / (2.0 * half_y))
        inside = (u >= 0.0) & (u <= columns - 1) & (v >= 0.0) & (v <= rows - 1)
        j = np.where(inside, u, 0.0).astype(int).clip(0, columns - 2)
        i = np.where(inside, v, 0.0).astype(int).clip(0, rows - 2)
        s, t = u - j, v - i
        front = grid[i, j] * (1.0 - s) + grid[i, j + 1] * s
        back = grid[i + 1, j] * (1.0 - s) + grid[i + 1, j + 1] * s
        return np.where(inside, origin[2] + top * (front * (1.0 - t) + back * t), np.nan)

    return height
