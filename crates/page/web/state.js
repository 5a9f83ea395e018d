// The explorer's state and its address.

import { intervalsOf, intervalsText } from './intervals.js';
import { SOIL_FIELDS, numbersOf } from './soils.js';

/** Wheel and motion: key of the command's flag, name, symbol, unit, slider range, power of ten shown. */
export const WHEEL_FIELDS = [
  { key: 'radius_m', name: 'Radius', symbol: 'r', unit: 'mm', power: -3, low: 0.02, high: 0.6, log: true },
  { key: 'width_m', name: 'Width', symbol: 'b', unit: 'mm', power: -3, low: 0.01, high: 0.5, log: true },
];
export const LUG_FIELDS = [
  { key: 'grouser_count', name: 'Number of lugs', symbol: 'N', unit: '', low: 0, high: 60, step: 1 },
  { key: 'grouser_height_m', name: 'Height of a lug', symbol: 'h', unit: 'mm', power: -3, low: 0, high: 0.04, step: 0.0005 },
  { key: 'grouser_thickness_m', name: 'Thickness of a lug', symbol: 't', unit: 'mm', power: -3, low: 0, high: 0.01, step: 0.0001 },
];
export const LOAD_FIELD = { key: 'load_n', name: 'Load', symbol: 'W', unit: 'N', low: 1, high: 3000, log: true };
export const MASS_FIELD = { key: 'mass_kg', name: 'Mass on the wheel', symbol: 'm', unit: 'kg', low: 0.1, high: 500, log: true };
export const GRAVITY_FIELD = { key: 'gravity_m_per_s2', name: 'Gravity', symbol: 'g', unit: 'm/s²', low: 0.5, high: 12, step: 0.001 };
export const MOTION_FIELDS = [
  { key: 'slip', name: 'Slip', symbol: 's', unit: '', low: -0.5, high: 1, step: 0.005 },
  { key: 'slope_deg', name: 'Slope', symbol: 'α', unit: '°', low: -30, high: 30, step: 0.1 },
  { key: 'slip_angle_deg', name: 'Slip angle', symbol: 'β', unit: '°', low: -45, high: 45, step: 0.5 },
];

const DEFAULTS = {
  radius_m: 0.125, width_m: 0.1,
  grouser_count: 0, grouser_height_m: 0, grouser_thickness_m: 0,
  load_by: 'load', load_n: 80, mass_kg: 8, gravity_m_per_s2: 9.80665,
  slip: 0.35, slope_deg: 0, slip_angle_deg: 0,
  theta_deg: 10, mobilised: 0,
};
const NUMBERS = Object.keys(DEFAULTS).filter((key) => key !== 'load_by');

/** The state that the page opens with. */
export function firstState(catalogue) {
  return { ...DEFAULTS, ...chooseSoil(catalogue, catalogue.get('dry-sand'), {}), compare: [], pinned: null, intervals: null, tab: 'slip' };
}

/** What changes when a soil of the catalogue is chosen. */
export function chooseSoil(catalogue, entry, before) {
  const { numbers, open } = numbersOf(entry, before);
  return { ...numbers, soil: entry.key, open, extra: '', soil_name: entry.name, intervals: null };
}

/** The weight on the wheel, N. */
export function weight(state) {
  return state.load_by === 'mass' ? state.mass_kg * state.gravity_m_per_s2 : state.load_n;
}

/** The numbers of the soil that differ from the entry's own. */
export function changedSoil(catalogue, state) {
  const entry = catalogue.get(state.soil);
  const own = entry ? numbersOf(entry, state).numbers : {};
  return SOIL_FIELDS.map(({ key }) => key).filter((key) => state[key] !== own[key] || state.open.includes(key));
}

/** The state as the part of the address after `#explore?`. */
export function toQuery(catalogue, state) {
  const query = new URLSearchParams();
  query.set('soil', state.soil);
  for (const key of changedSoil(catalogue, state)) query.set(key, state[key]);
  for (const key of NUMBERS) if (state[key] !== DEFAULTS[key] || !isMinor(key, state)) query.set(key, state[key]);
  if (state.load_by === 'mass') query.set('load_by', 'mass');
  if (state.tab === '2012') query.set('tab', '2012');
  if (state.extra) query.set('extra', state.extra);
  if (state.soil_name && !catalogue.has(state.soil)) query.set('soil_name', state.soil_name);
  if (state.intervals) query.set('intervals', intervalsText(state.intervals));
  if (state.compare.length) query.set('compare', state.compare.join(','));
  if (state.pinned) query.set('pinned', toQuery(catalogue, { ...state.pinned, compare: [], pinned: null }));
  return query.toString();
}

function isMinor(key, state) {
  if (key === 'load_n') return state.load_by === 'mass';
  if (key === 'mass_kg' || key === 'gravity_m_per_s2') return state.load_by !== 'mass';
  return !['radius_m', 'width_m', 'slip'].includes(key);
}

/** The state of an address; what is not a number is left as it is. */
export function fromQuery(catalogue, text, depth = 0) {
  const query = new URLSearchParams(text);
  const state = firstState(catalogue);
  const key = query.get('soil');
  if (catalogue.has(key)) Object.assign(state, chooseSoil(catalogue, catalogue.get(key), {}));
  else if (key) Object.assign(state, { soil: 'own', soil_name: query.get('soil_name') ?? 'own soil', open: [] });
  for (const name of [...SOIL_FIELDS.map((field) => field.key), ...NUMBERS]) {
    const given = query.get(name);
    if (given !== null && given.trim() !== '' && Number.isFinite(Number(given))) state[name] = Number(given);
  }
  if (query.get('load_by') === 'mass') state.load_by = 'mass';
  if (query.get('tab') === '2012') state.tab = '2012';
  state.intervals = intervalsOf(query.get('intervals'));
  state.extra = (query.get('extra') ?? '').slice(0, 4000);
  state.compare = (query.get('compare') ?? '').split(',').filter((name) => catalogue.has(name)).slice(0, 5);
  const pinned = query.get('pinned');
  if (pinned && depth === 0) state.pinned = fromQuery(catalogue, pinned, 1);
  return state;
}
