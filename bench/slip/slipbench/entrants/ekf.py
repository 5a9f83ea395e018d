"""The filter that most ROS robots run: the equations of robot_localization's `ekf_filter_node` in two-dimensional mode.

Moore and Stouch, *A Generalized Extended Kalman Filter Implementation for the Robot Operating System* (2014). State: x, y, yaw, their
speeds in the robot's frame, and accelerations; an omnidirectional model with constant acceleration; the package's default process
noise; no rejection thresholds. Fused: the reference (a pose; or a twist of visual odometry, radar or the free wheel, whose sideways speed
is measured only by visual odometry) and the gyro's yaw rate. Not fused: wheel odometry, of which the slip is asked, and the
accelerometer, from which two-dimensional mode cannot take gravity out.
"""

from __future__ import annotations

import math
from typing import List, Tuple

import numpy as np

from slipbench.log import Estimates, Floats, Log, Series, Wheel, slip_of

# process_noise_covariance of the package's ekf.yaml for x, y, yaw, vx, vy, yaw rate, ax, ay
PROCESS = np.diag([0.05, 0.05, 0.06, 0.025, 0.025, 0.02, 0.01, 0.01])
INITIAL = np.diag([1e-9] * 8)  # initial_estimate_covariance
WHEEL_SPAN_S = 0.1
OUT_S = 0.1
Z_90 = 1.645
Measurement = Tuple[List[int], Floats, Floats]  # states, values, variances


def robot_localization(log: Log) -> Estimates:
    events = sorted(measurements(log), key=lambda event: event[0])
    state, covariance, now = np.zeros(8), INITIAL.copy(), log.time_s[0]
    outputs, due = [], log.time_s[0]
    for time_s, (states, values, variances) in events:
        while due < time_s:
            predicted, spread = predict(state, covariance, max(due - now, 0.0))
            outputs.append((due, predicted[3:6], spread[3:6, 3:6]))
            due += OUT_S
        state, covariance = predict(state, covariance, time_s - now)
        now = time_s
        gain = covariance[:, states] @ np.linalg.inv(covariance[np.ix_(states, states)] + np.diag(variances))
        innovation = values - state[states]
        if 2 in states:
            at = states.index(2)
            innovation[at] = (innovation[at] + math.pi) % (2 * math.pi) - math.pi
        state = state + gain @ innovation
        # Joseph's form, as in the package
        keep = np.eye(8)
        keep[:, states] -= gain
        covariance = keep @ covariance @ keep.T + gain @ np.diag(variances) @ gain.T
    times = np.array([time_s for time_s, _, _ in outputs])
    twists, spreads = np.array([twist for _, twist, _ in outputs]), np.array([spread for _, _, spread in outputs])
    return {wheel.name: slips(log, wheel, times, twists, spreads) for wheel in log.robot.powered}


def predict(state: Floats, covariance: Floats, step_s: float) -> Tuple[Floats, Floats]:
    _, _, yaw, vx, vy, turn, ax, ay = state
    c, s, half = math.cos(yaw), math.sin(yaw), 0.5 * step_s * step_s
    out = state.copy()
    out[0] += (vx * c - vy * s) * step_s + half * (ax * c - ay * s)
    out[1] += (vx * s + vy * c) * step_s + half * (ax * s + ay * c)
    out[2] += turn * step_s
    out[3] += ax * step_s
    out[4] += ay * step_s
    change = np.eye(8)
    change[0, 2:] = [-(vx * s + vy * c) * step_s - half * (ax * s + ay * c), c * step_s, -s * step_s, 0, half * c, -half * s]
    change[1, 2:] = [(vx * c - vy * s) * step_s + half * (ax * c - ay * s), s * step_s, c * step_s, 0, half * s, half * c]
    change[2, 5] = change[3, 6] = change[4, 7] = step_s
    return out, change @ covariance @ change.T + PROCESS * step_s


def measurements(log: Log) -> List[Tuple[float, Measurement]]:
    found: List[Tuple[float, Measurement]] = []
    rates = np.zeros((0, 3)) if log.rates is None else log.rates
    for time_s, one in zip(log.time_s, rates):
        found.append((float(time_s), ([5], one[2:3], np.array([log.rate_sigma**2]))))
    reference = log.reference.known()
    if reference.kind == "free-wheel":
        free = log.robot.free[0]
        rolled, tick = log.wheel_distance(free.name), 2 * math.pi * free.radius_m / free.ticks_per_turn
        steps = np.diff(log.time_s)
        for k, step_s in enumerate(steps):
            speed = (rolled[k + 1] - rolled[k]) / step_s + rates[k + 1, 2] * free.y_m
            variance = (tick / step_s) ** 2 / 6
            found.append((float(log.time_s[k + 1]), ([3], np.array([speed]), np.array([variance]))))
        return found
    gaps = np.diff(reference.time_s, prepend=np.nan)
    period = float(np.nanmedian(gaps))
    for time_s, values in zip(reference.time_s, reference.values):
        if reference.kind == "pose":
            variances = np.array([reference.sigma, reference.sigma, reference.yaw_sigma]) ** 2
            found.append((float(time_s), ([0, 1, 2], values, variances)))
        elif reference.kind == "displacement":
            variances = np.array([reference.sigma, reference.sigma, reference.yaw_sigma]) ** 2 / period**2
            found.append((float(time_s), ([3, 4, 5], values / period, variances)))
        else:
            found.append((float(time_s), ([3], values, np.array([reference.sigma**2]))))
    return found


def slips(log: Log, one: Wheel, time_s: Floats, twists: Floats, spreads: Floats) -> Series:
    """Twists: speeds forwards and to the left, and the yaw rate, with their covariances."""
    rolled = log.wheel_distance(one.name)
    at = lambda t: np.interp(t, log.time_s, rolled)
    wheel = (at(time_s) - at(time_s - WHEEL_SPAN_S)) / WHEEL_SPAN_S
    c, s = math.cos(one.heading_rad), math.sin(one.heading_rad)
    along = np.array([c, s, s * one.x_m - c * one.y_m])
    ground = twists @ along
    slip = np.where(np.abs(wheel) >= 0.02, np.clip(slip_of(wheel, ground), -1, 1), np.nan)
    tick = 2 * math.pi * one.radius_m / one.ticks_per_turn / WHEEL_SPAN_S
    variance = np.einsum("i,kij,j->k", along, spreads, along) + tick**2 / 6
    half = Z_90 * np.sqrt(variance) / np.maximum(np.maximum(np.abs(wheel), np.abs(ground)), 1e-9)
    return Series(time_s, slip, slip - half, slip + half)
