// A run as the page plays it, out of an answer of the module `run` or of a file.

/** What is wrong with a file. */
export class BadFile extends Error {}

/** Splits a line of CSV; quotes as the command writes them. */
function cells(line) {
  if (!line.includes('"')) return line.split(',');
  const out = [];
  for (const [, quoted, plain] of line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)) {
    out.push(quoted !== undefined ? quoted.replaceAll('""', '"') : plain);
  }
  return out;
}

/** The table of `grouser estimate -o F.csv` as a run; a run without a place. */
export function runOfEstimates(text, title) {
  const lines = text.replace(/^\ufeff/, '').split(/\r?\n/);
  const header = lines[0].split(',');
  const at = (name) => {
    const i = header.indexOf(name);
    if (i < 0) throw new BadFile(`${title}: no column ${name}`);
    return i;
  };
  const [time, name, slip, sigma, motion, health] = ['time_s', 'wheel', 'slip', 'slip_sigma', 'motion', 'health'].map(at);
  const wheels = new Map();
  const times = [];
  const number = (cell, line, column) => {
    if (cell === '' || cell === undefined) return null;
    const value = Number(cell);
    if (!Number.isFinite(value)) throw new BadFile(`${title}: line ${line}, column ${column}: “${cell.slice(0, 20)}” is not a number`);
    return value;
  };
  for (let i = 1; i < lines.length; i += 1) {
    if (lines[i] === '') continue;
    const row = cells(lines[i]);
    const t = number(row[time], i + 1, 'time_s');
    if (t === null || row.length < header.length) throw new BadFile(`${title}: line ${i + 1} is incomplete`);
    if (times.length === 0 || t > times.at(-1)) times.push(t);
    else if (t < times.at(-1)) throw new BadFile(`${title}: line ${i + 1}: time ${t} s is before ${times.at(-1)} s`);
    let wheel = wheels.get(row[name]);
    if (!wheel) {
      if (wheels.size >= 64) throw new BadFile(`${title}: more than 64 wheels`);
      wheel = { name: row[name], slip: [], slip_sigma: [], motion: [], health: [] };
      wheels.set(row[name], wheel);
    }
    const k = times.length - 1;
    while (wheel.slip.length < k) {
      wheel.slip.push(null);
      wheel.slip_sigma.push(null);
    }
    wheel.slip[k] = number(row[slip], i + 1, 'slip');
    wheel.slip_sigma[k] = number(row[sigma], i + 1, 'slip_sigma');
    if (wheel.motion.at(-1)?.[1] !== row[motion]) wheel.motion.push([t, row[motion]]);
    if (wheel.health.at(-1)?.[1] !== row[health]) wheel.health.push([t, row[health]]);
  }
  if (times.length < 2) throw new BadFile(`${title}: no rows`);
  for (const wheel of wheels.values()) {
    while (wheel.slip.length < times.length) {
      wheel.slip.push(null);
      wheel.slip_sigma.push(null);
    }
  }
  return { kind: 'estimate', title, time_s: times, wheels: [...wheels.values()], doubts: [], every: 1 };
}

/** Is the text a table of `grouser estimate -o`? */
export function isEstimates(text) {
  return /^\ufeff?time_s,wheel,slip,/.test(text);
}

/** The name that holds at a time. */
export function nameAt(spans, time) {
  let low = 0;
  let high = spans.length - 1;
  if (high < 0 || time < spans[0][0]) return '';
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (spans[middle][0] <= time) low = middle;
    else high = middle - 1;
  }
  return spans[low][1];
}

/** The times between which `is(name)` holds. */
export function spansOf(spans, end, is) {
  const out = [];
  spans.forEach(([from, name], i) => {
    if (!is(name)) return;
    const to = spans[i + 1]?.[0] ?? end;
    if (out.length && out.at(-1)[1] === from) out.at(-1)[1] = to;
    else out.push([from, to]);
  });
  return out;
}

/** The times that are in all of several lists of spans. */
export function common(lists) {
  return lists.reduce((left, right) => {
    const out = [];
    let i = 0;
    let k = 0;
    while (i < left.length && k < right.length) {
      const from = Math.max(left[i][0], right[k][0]);
      const to = Math.min(left[i][1], right[k][1]);
      if (from < to) out.push([from, to]);
      if (left[i][1] < right[k][1]) i += 1;
      else k += 1;
    }
    return out;
  });
}

/** Numbers as a typed column; what is missing is not a number. */
export function column(values) {
  if (values instanceof Float64Array) return values;
  const out = new Float64Array(values.length);
  for (let i = 0; i < out.length; i += 1) out[i] = values[i] ?? NaN;
  return out;
}

const BODY = ['time_s', 'x_m', 'y_m', 'heading_deg', 'progress_m', 'speed_m_per_s', 'estimated_speed_m_per_s', 'requested_speed_m_per_s', 'used_energy_j', 'tip_over_margin_deg', 'slip_setpoint'];
const OF_WHEEL = ['slip', 'slip_sigma', 'true_slip', 'torque_nm', 'sinkage_m', 'drawbar_pull_n', 'side_force_n', 'load_n', 'wheel_x_m', 'wheel_y_m', 'wheel_heading_deg'];

/** A run in typed columns. */
export function inColumns(run) {
  const typed = (of, names) => Object.fromEntries(names.filter((name) => of[name]).map((name) => [name, column(of[name])]));
  return { ...run, ...typed(run, BODY), wheels: run.wheels.map((wheel) => ({ ...wheel, ...typed(wheel, OF_WHEEL) })) };
}

/** Columns with gaps where the wheel stands: a slip at rest is a quotient of two noises. */
export function masked(run, wheel) {
  const rests = spansOf(wheel.motion ?? [], Infinity, (name) => name === 'Standstill').map(([from, to]) => [placeOf(run.time_s, from), to === Infinity ? run.time_s.length : placeOf(run.time_s, to)]);
  const mask = (values) => {
    const out = values.slice();
    for (const [from, to] of rests) out.fill(NaN, from, to);
    return out;
  };
  return { slip: mask(wheel.slip), sigma: mask(wheel.slip_sigma), true_slip: wheel.true_slip?.length ? mask(wheel.true_slip) : null };
}

/** The first place in a rising column that is not before `time`. */
export function placeOf(times, time) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The places of a column that a line of `pixels` places shows: the least and the greatest of each, and a gap. */
export function thinned(x, lead, [from, to], pixels) {
  const first = Math.max(0, placeOf(x, from) - 1);
  const last = Math.min(x.length - 1, placeOf(x, to));
  const count = last - first + 1;
  const kept = [];
  if (count <= 2 * pixels) {
    for (let i = first; i <= last; i += 1) kept.push(i);
    return kept;
  }
  const per = count / pixels;
  let end = first;
  for (let p = 0; p < pixels; p += 1) {
    const begin = end;
    end = p === pixels - 1 ? last + 1 : first + Math.floor((p + 1) * per);
    let low = -1;
    let high = -1;
    let gap = -1;
    for (let i = begin; i < end; i += 1) {
      const value = lead[i];
      if (value !== value) gap = i;
      else {
        if (low < 0 || value < lead[low]) low = i;
        if (high < 0 || value > lead[high]) high = i;
      }
    }
    const places = new Set([...(p ? [] : [first]), low, high, gap, ...(p === pixels - 1 ? [last] : [])].filter((i) => i >= 0));
    kept.push(...[...places].sort((a, b) => a - b));
  }
  return kept;
}

/** The values of a column at some places. */
export function valuesAt(values, places) {
  const out = new Float64Array(places.length);
  for (let k = 0; k < out.length; k += 1) out[k] = values[places[k]];
  return out;
}
