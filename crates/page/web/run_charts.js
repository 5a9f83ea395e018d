// The charts of a run over time: slip with sigma, rim speeds, speed, torque, energy, tip-over margin, and one chart for each wheel.

import { Chart, plotWidth } from './chart.js';
import { h } from './dom.js';
import { shown } from './format.js';
import { CURVES } from './palette.js';
import { common, placeOf, spansOf, thinned, valuesAt } from './run_data.js';
import { rangeOf } from './ticks.js';

const NO_REFERENCE = /ReferenceLost|Relative/;
const TIME = { name: 'Time', unit: 's' };
const SLIP = { name: 'Slip', unit: '' };
/** Slips of this share at each end may lie beyond the scale, where they are peaks: beyond twice what the others need. */
const PEAK_SHARE = 0.004;
/** Moments of a wheel that are looked at for the scale. */
const SCALE_MOMENTS = 4000;

function valueOf(one, value) {
  return h('span', { class: one.ghost ? 'value ghost' : 'value', style: { color: one.colour } }, `${one.name} ${value === null ? '–' : shown(value)}`);
}

/** Spans in which no powered wheel turns, and in which nothing measures the robot's speed. */
function spansOfRun(run, wheels) {
  const end = run.time_s.at(-1) ?? 0;
  const powered = wheels.filter((wheel) => !wheel.is_reference && wheel.slip.some((slip) => slip === slip));
  const counted = powered.length ? powered : wheels;
  const named = (kind, states, is) => common(counted.map((wheel) => spansOf(wheel[states] ?? [], end, is))).map(([from, to]) => ({ from, to, kind }));
  return [...named('rest', 'motion', (name) => name === 'Standstill'), ...named('lost', 'health', (name) => NO_REFERENCE.test(name))];
}

/** The scale of slips that peaks of a few moments do not decide: {scale, low, high}; null where there are no such peaks. */
function scaleWithoutPeaks(run, wheels, [from, to]) {
  const values = [];
  const [first, last] = [placeOf(run.time_s, from), placeOf(run.time_s, to)];
  const stride = Math.max(1, Math.floor((last - first) / SCALE_MOMENTS));
  let [low, high] = [Infinity, -Infinity];
  for (const { shown: { slip, sigma, true_slip: truth } } of wheels) {
    for (let i = first; i < last; i += stride) {
      for (const value of [slip[i] - (sigma[i] || 0), slip[i] + (sigma[i] || 0), truth?.[i]]) {
        if (!Number.isFinite(value)) continue;
        values.push(value);
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
  }
  if (values.length < 100) return null;
  values.sort((a, b) => a - b);
  const at = (share) => values[Math.round(share * (values.length - 1))];
  const usual = [at(PEAK_SHARE), at(1 - PEAK_SHARE)];
  const scale = rangeOf(usual);
  return high - low > 2 * (usual[1] - usual[0]) ? { scale, low, high } : null;
}

export class RunCharts {
  #pointing;
  #many = [];
  #shown = null;

  /** `pick(time)`: a click; `hover(time)`: where the pointer is, null for nowhere. `table` stands under the slips. */
  constructor({ pick, hover, table }) {
    this.#pointing = { pick, hover: (time) => {
      for (const chart of this.#all()) chart.point(time);
      hover(time);
    } };
    const chart = (title, y, more = {}) => new Chart({ title, x: TIME, y, ...this.#pointing, value: valueOf, ...more });
    this.slip = new Chart({ title: 'Slip of each wheel', height: 340, x: TIME, y: SLIP, ...this.#pointing });
    this.speed = chart('Forward speed', { name: 'Speed', unit: 'm/s' });
    this.rims = chart('Rim speed of each wheel, as logged', { name: 'Speed', unit: 'm/s' });
    this.torque = chart('Torque of each motor', { name: 'Torque', unit: 'N m' });
    this.energy = chart('Electrical energy used', { name: 'Energy', unit: 'J' }, { zero: true });
    this.margin = chart('Tip-over margin', { name: 'Margin', unit: 'deg' }, { zero: true });
    this.todoKey = h('span', { class: 'key-todo' }, 'not estimated yet');
    this.peaksKey = h('span', { class: 'plain', hidden: true });
    this.slip.element.append(
      h('p', { class: 'key' }, h('span', { class: 'key-band' }, 'band: one sigma'), h('span', { class: 'key-rest' }, 'at rest: no slip'), h('span', { class: 'key-lost' }, 'nothing measures the speed'), this.todoKey, this.peaksKey),
      table);
    this.element = h('div', { class: 'charts' }, this.rims.element, this.speed.element, this.torque.element, this.margin.element, this.energy.element);
    this.multiplesButton = h('button', { type: 'button', class: 'quiet multiples-button', 'aria-expanded': 'false', on: { click: () => this.#toggleMultiples() } }, 'One chart for each wheel');
    this.multiples = h('div', { class: 'charts' });
  }

  #all() {
    return [this.slip, this.rims, this.speed, this.torque, this.margin, this.energy, ...this.#many];
  }

  /** The charts that are shown. */
  get visible() {
    return this.#all().filter(({ element }) => !element.hidden);
  }

  cursor(time) {
    for (const chart of this.#all()) chart.cursor(time);
  }

  /** Draws a run: its wheels, those of them that are `hidden`, and the `others` that it is compared with. */
  show({ run, wheels, hidden, others, range, cursor }) {
    const isOther = this.#shown?.run !== run;
    this.#shown = { run, wheels, range, cursor };
    const spans = spansOfRun(run, wheels);
    if (run.end_s) spans.push({ from: run.time_s.at(-1) ?? 0, to: run.end_s, kind: 'todo' });
    this.todoKey.hidden = !run.end_s;
    const pixels = plotWidth(this.slip);
    const visible = wheels.filter(({ name }) => !hidden.has(name));
    const peaks = scaleWithoutPeaks(run, visible, range);
    this.peaksKey.hidden = !peaks;
    if (peaks) this.peaksKey.textContent = `peaks from ${shown(peaks.low, 2)} to ${shown(peaks.high, 2)} are cut off`;
    const line = (times, values, look) => {
      const places = thinned(times, values, range, pixels);
      return { x: valuesAt(times, places), y: valuesAt(values, places), width: 1.6, ...look };
    };
    const setpoint = run.slip_setpoint ? [line(run.time_s, run.slip_setpoint, { name: 'setpoint', colour: 'var(--muted)', dash: '6 4' })] : [];
    this.slip.show({ range, spans, cursor, scale: peaks?.scale ?? null, series: [...visible.flatMap((wheel) => this.#slipSeries(wheel, pixels)), ...setpoint] });
    const columns = (list) => list.filter(([, column]) => column).map(([name, column, look]) => line(run.time_s, column, { name, ...look }));
    const draw = (chart, is, series, spansShown = []) => {
      chart.element.hidden = !is;
      if (is) chart.show({ range, spans: spansShown, cursor, series: series() });
    };
    draw(this.rims, run.overview, () => visible.map(({ name, look }) => line(run.overview.time_s, run.overview.rims[wheels.findIndex((wheel) => wheel.name === name)], { name, colour: look.colour })));
    draw(this.speed, run.speed_m_per_s, () => columns([
      [run.kind === 'drive' ? 'true' : 'estimated', run.speed_m_per_s, CURVES[0]],
      ['estimated', run.estimated_speed_m_per_s, CURVES[1]],
      ['requested', run.requested_speed_m_per_s, { colour: 'var(--muted)', dash: '2 3' }],
    ]), spans);
    const turned = visible.filter(({ torque_nm: torque }) => torque?.some((value) => value));
    draw(this.torque, turned.length, () => columns(turned.map(({ name, torque_nm: torque, look }) => [name, torque, { colour: look.colour }])));
    // what is compared with other drives of the same ground
    const compared = (chart, key, look) => draw(chart, run[key], () => {
      const ghosts = others.filter((other) => other[key]).map((other) => line(other.time_s, other[key], { name: other.controller, colour: 'var(--muted)', dash: '3 3', width: 1.3, ghost: true }));
      return [...columns([[run.controller ?? 'used', run[key], look]]), ...ghosts];
    });
    compared(this.margin, 'tip_over_margin_deg', CURVES[0]);
    compared(this.energy, 'used_energy_j', { colour: CURVES[2].colour });
    this.#shown.spans = spans;
    if (isOther && this.#many.length) this.#makeMultiples();
    this.#drawMultiples();
  }

  /** The slip of a wheel with its sigma, and the true one. */
  #slipSeries(wheel, pixels) {
    const { run, range } = this.#shown;
    const { slip, sigma, true_slip } = wheel.shown;
    const places = thinned(run.time_s, slip, range, pixels);
    const [x, y, spread] = [run.time_s, slip, sigma].map((values) => valuesAt(values, places));
    const band = { low: y.map((value, i) => value - spread[i]), high: y.map((value, i) => value + spread[i]) };
    const series = [{ name: wheel.name, x, y, colour: wheel.look.colour, dash: null, width: 1.6, band }];
    if (true_slip) series.push({ name: `${wheel.name}, true`, x, y: valuesAt(true_slip, places), colour: wheel.look.colour, dash: '2 3', width: 1.2, ghost: true });
    return series;
  }

  #toggleMultiples() {
    const open = this.#many.length === 0;
    this.multiplesButton.setAttribute('aria-expanded', String(open));
    if (open) this.#makeMultiples();
    else {
      this.#many = [];
      this.multiples.replaceChildren();
    }
    this.#drawMultiples();
  }

  #makeMultiples() {
    const value = (one, at) => valueOf({ ...one, name: one.ghost ? 'true' : 'estimated' }, at);
    this.#many = this.#shown.wheels.map(({ name }) => new Chart({ title: name, height: 180, x: TIME, y: SLIP, ...this.#pointing, value }));
    this.multiples.replaceChildren(...this.#many.map((chart) => chart.element));
  }

  #drawMultiples() {
    const { wheels, range, spans, cursor } = this.#shown;
    const pixels = plotWidth(this.slip) / 2;
    this.#many.forEach((chart, i) => chart.show({ range, spans, cursor, series: this.#slipSeries(wheels[i], pixels) }));
  }
}
