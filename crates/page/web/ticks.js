// Round numbers on an axis.

function roundStep(span, count) {
  const raw = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 2.5, 5, 10].find((k) => k * power >= raw * 0.999);
}

/** About `count` round numbers in [low, high]. */
export function ticks(low, high, count) {
  const span = high - low;
  if (!(span > 0) || !Number.isFinite(span)) return [low];
  const step = roundStep(span, count);
  const first = Math.ceil(low / step - 1e-9);
  const out = [];
  for (let i = first; i * step <= high + 1e-9 * span; i += 1) out.push(Number((i * step).toPrecision(12)));
  return out;
}

/** Labels with the decimals that the step between them needs. */
export function tickLabels(values) {
  const step = values.length > 1 ? Math.abs(values[1] - values[0]) : Math.abs(values[0]) || 1;
  let decimals = 0;
  while (decimals < 8 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals += 1;
  return values.map((value) => value.toFixed(decimals).replace('-', '−'));
}

/** A range that holds all `values` with a little room; with `zero` it holds zero. */
export function rangeOf(values, zero = false) {
  let low = zero ? 0 : Infinity;
  let high = zero ? 0 : -Infinity;
  for (const value of values) {
    if (value === null || !Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  if (low === high) return low === 0 ? [0, 1] : [low - 0.5 * Math.abs(low), high + 0.5 * Math.abs(high)];
  const room = 0.03 * (high - low);
  // out to half a step, so that the axis stays while a slider moves a curve a little
  const half = 0.5 * roundStep(high - low, 4);
  const out = (value, way) => (zero && value === 0 ? 0 : Number((way((value) / half) * half).toPrecision(12)));
  return [out(low - (zero && low === 0 ? 0 : room), Math.floor), out(high + (zero && high === 0 ? 0 : room), Math.ceil)];
}
