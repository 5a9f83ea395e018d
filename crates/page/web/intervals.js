// What the 95 % intervals of a soil's numbers do to the curves: bands between soils that are drawn from them.

import { SOIL_FIELDS } from './soils.js';

/** Soils that are drawn. */
const DRAWS = 64;
/** Half of a 95 % interval in standard deviations, as for `grouser map --soil-intervals`. */
const HALF_WIDTH_SIGMA = 1.96;
/** The quantiles between which the band lies. */
const [LOW, HIGH] = [0.025, 0.975];
const KEYS = new Set(['n', 'k_c_kn_per_m_n1', 'k_phi_kn_per_m_n2', 'cohesion_kpa', 'phi_deg', 'k_shear_m', 'c_1', 'c_2']);
/** Bases of Halton's sequence, one a number. */
const BASES = [2, 3, 5, 7, 11, 13, 17, 19];

/** The intervals of a file as `grouser map --soil-intervals` reads it: `key = { low = …, high = … }`. */
export function readIntervals(text) {
  const found = {};
  for (const line of text.split(/\r?\n/)) {
    const [, key, inside] = /^\s*([a-z_0-9]+)\s*=\s*\{([^}]*)\}\s*(?:#.*)?$/.exec(line) ?? [];
    if (key === undefined) continue;
    if (!KEYS.has(key)) throw new Error(`${key} is not one of ${[...KEYS].join(', ')}`);
    const end = (name) => {
      const [, number] = new RegExp(`\\b${name}\\s*=\\s*([-+0-9.eE_]+)`).exec(inside) ?? [];
      const value = Number(number?.replaceAll('_', ''));
      if (number === undefined || !Number.isFinite(value)) throw new Error(`${key} needs low and high, two numbers`);
      return value;
    };
    const interval = [end('low'), end('high')];
    if (!(interval[0] <= interval[1])) throw new Error(`${key}: low is ${interval[0]}, above high, ${interval[1]}`);
    found[key] = interval;
  }
  if (!Object.keys(found).length) throw new Error('no interval such as phi_deg = { low = 27.0, high = 33.0 }');
  return found;
}

/** Intervals as a part of the address, and back. */
export function intervalsText(intervals) {
  return Object.entries(intervals).map(([key, [low, high]]) => `${key}:${low}:${high}`).join(',');
}

export function intervalsOf(text) {
  const found = {};
  for (const part of (text ?? '').split(',')) {
    const [key, low, high] = part.split(':');
    const ends = [Number(low), Number(high)];
    if (KEYS.has(key) && low && high && ends.every(Number.isFinite) && ends[0] <= ends[1]) found[key] = ends;
  }
  return Object.keys(found).length ? found : null;
}

/** Which number of a state lies outside its interval, in words; null where none does. */
export function outside(state, intervals) {
  for (const [key, [low, high]] of Object.entries(intervals)) {
    if (state[key] < low || state[key] > high) {
      const { name } = SOIL_FIELDS.find((field) => field.key === key);
      return `${name} is ${state[key]}, outside its interval [${low}, ${high}]: no bands are drawn`;
    }
  }
  return null;
}

/**
 * Bands of the curves' columns. `curveOf(numbers)` gives the curve of a soil with these numbers, and throws where the laws
 * refuse them. Each number is normal about its own, with the interval's ends 1.96 standard deviations away on either side,
 * independently of the others. The draws are evenly spread (Halton's sequence), so that few are enough.
 */
export function bands(state, intervals, curveOf) {
  const entries = Object.entries(intervals);
  const curves = [];
  for (let draw = 1; draw <= DRAWS; draw += 1) {
    const numbers = {};
    entries.forEach(([key, [low, high]], i) => {
      const z = normalQuantile(entries.length === 1 ? (draw - 0.5) / DRAWS : halton(draw, BASES[i]));
      const half = z < 0 ? state[key] - low : high - state[key];
      numbers[key] = state[key] + (z * half) / HALF_WIDTH_SIGMA;
    });
    const curve = curveOf(numbers);
    if (curve) curves.push(curve);
  }
  // a band of few draws would promise what it does not hold
  if (curves.length < DRAWS / 2) return null;
  const out = { slip: curves[0].slip, draws: curves.length };
  for (const key of Object.keys(curves[0])) {
    if (key === 'slip' || !Array.isArray(curves[0][key]) || curves[0][key].length !== out.slip.length) continue;
    out[key] = { low: [], high: [] };
    out.slip.forEach((_, i) => {
      const values = curves.map((curve) => curve[key][i]).filter((value) => typeof value === 'number').sort((a, b) => a - b);
      const whole = values.length === curves.length;
      out[key].low.push(whole ? quantile(values, LOW) : null);
      out[key].high.push(whole ? quantile(values, HIGH) : null);
    });
  }
  return out;
}

function quantile(sorted, share) {
  // the draws stand at the middles of their shares
  const at = Math.min(sorted.length - 1, Math.max(0, share * sorted.length - 0.5));
  const below = Math.floor(at);
  return sorted[below] + (sorted[Math.min(sorted.length - 1, below + 1)] - sorted[below]) * (at - below);
}

function halton(index, base) {
  let [value, share] = [0, 1 / base];
  for (let rest = index; rest > 0; rest = Math.floor(rest / base), share /= base) value += (rest % base) * share;
  return value;
}

/** The standard normal's quantile, to 4.5e-4: Abramowitz and Stegun 26.2.23. */
function normalQuantile(share) {
  const tail = Math.min(share, 1 - share);
  const t = Math.sqrt(-2 * Math.log(tail));
  const z = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  return share < 0.5 ? -z : z;
}
