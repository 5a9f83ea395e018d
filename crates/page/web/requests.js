// The explorer's state as requests.

import { soilToml } from './soils.js';
import { weight } from './state.js';

/** The wheel of a state on its soil, without motion. */
export function pairOf(state) {
  const request = {
    soil: soilToml(state, { name: state.soil_name, extra: state.extra }),
    radius_m: state.radius_m,
    width_m: state.width_m,
    slip_angle_deg: state.slip_angle_deg,
  };
  if (hasLugs(state)) {
    request.grouser_height_m = state.grouser_height_m;
    request.grouser_count = state.grouser_count;
    request.grouser_thickness_m = state.grouser_thickness_m;
  }
  return request;
}

/** Has the wheel lugs? */
export function hasLugs(state) {
  return state.grouser_count >= 1 && state.grouser_height_m > 0;
}

/** The operating point; `near` is the slip that held a neighbouring slope, if one is known. */
export function pointRequest(state, profile, near = null) {
  return { call: 'wheel', ...onGround(state), slip: state.slip, slip_demand_near: near, profile };
}

/** The curves over slip: quick while something moves, or with the cautions and the best slips. */
export function curveRequest(state, points, [from, to], quick) {
  return { call: 'curve', ...onGround(state), slip_from: from, slip_to: to, points, quick, best: !quick };
}

function onGround(state) {
  const request = { ...pairOf(state), load_n: weight(state) };
  if (state.slope_deg !== 0) request.slope_deg = state.slope_deg;
  return request;
}
