// The analytical slip model of Ani et al. (2012) at the operating point of the explorer, beside our laws.

import { Chart } from './chart.js';
import { Control } from './controls.js';
import { h } from './dom.js';
import { shown } from './format.js';
import { CURVES } from './palette.js';

/** The optimum slip that the paper prints. */
const PRINTED_SLIP = 0.1146;
const POINTS = 121;

/** Its own quantities: the angle on the rim, and the share of the strength that is mobilised. */
export const PAPER_FIELDS = [
  { key: 'theta_deg', name: 'Angle on the rim', symbol: 'θ', unit: '°', low: 0, high: 45, step: 0.5 },
  { key: 'mobilised', name: 'Share of the strength', symbol: 'x', unit: '', low: 0, high: 0.95, step: 0.01 },
];

const SWEEPS = [
  { sweep: 'theta_deg', title: 'S against the angle on the rim', x: { name: 'Angle θ', unit: '°' }, scale: 1, range: (state, z, theta1) => [0, Math.max(45, Math.ceil(theta1))] },
  { sweep: 'sinkage_m', title: 'S against sinkage', x: { name: 'Sinkage z', unit: 'mm' }, scale: 1e3, range: (state, z) => [0.0005, Math.min(0.8 * state.radius_m, Math.max(0.04, 1.5 * z))] },
  { sweep: 'radius_m', title: 'S against the wheel’s radius', x: { name: 'Radius r', unit: 'mm' }, scale: 1e3, range: (state, z) => [Math.max(0.05, 1.3 * z), Math.max(0.2, 1.5 * state.radius_m)] },
  { sweep: 'mobilised', title: 'S against the share of the strength', x: { name: 'Share τ/T', unit: '' }, scale: 1, range: () => [0, 0.95] },
];

/** The tab. `set(change)` changes the state of the explorer. */
export class Paper2012 {
  #charts;
  #controls;

  constructor(set) {
    this.#controls = PAPER_FIELDS.map((field) => [field, new Control(field, (value) => set({ [field.key]: value }))]);
    this.#charts = SWEEPS.map((sweep) => ({
      ...sweep,
      chart: new Chart({
        title: sweep.title, x: sweep.x, y: { name: 'Slip S', unit: '' },
        pick: ['theta_deg', 'mobilised'].includes(sweep.sweep) ? (at) => set({ [sweep.sweep]: Number(at.toFixed(2)) }) : null,
        value: (one, value) => h('span', { class: 'value', style: { color: one.colour } }, value === null ? '–' : shown(value)),
      }),
    }));
    this.words = h('div', { class: 'paper-words' });
    this.command = h('pre', { class: 'command' });
    this.element = h('div', { id: 'tab-paper', role: 'tabpanel', 'aria-label': 'The 2012 model', hidden: true, class: 'paper-tab' },
      h('section', { class: 'card panel' }, this.words, h('div', { class: 'paper-fields' }, this.#controls.map(([, control]) => control.element)), this.command),
      h('div', { class: 'charts' }, this.#charts.map(({ chart }) => chart.element)));
  }

  /** Shows the model at a solved operating point; `soil` names the soil's K in a command, `ask(request)` answers at once. */
  show(state, point, soil, ask) {
    for (const [{ key }, control] of this.#controls) control.show(state[key], '');
    const z = point.sinkage_m;
    if (!(z > 0)) {
      this.words.replaceChildren(h('p', {}, 'The wheel does not sink here: the model needs a sinkage.'));
      return;
    }
    const fixed = { call: 'slip_model', theta_deg: state.theta_deg, sinkage_m: z, radius_m: state.radius_m, k_shear_m: state.k_shear_m };
    // as S = 1 − v/(r ω), the paper's measure for driving and braking alike
    const ours = state.slip < 0 ? state.slip / (1 + state.slip) : state.slip;
    for (const { chart, sweep, scale, range } of this.#charts) {
      const [from, to] = range(state, z, point.theta_1_deg);
      const curve = (mobilised) => ask({ ...fixed, mobilised, sweep, from, to, points: POINTS });
      const free = curve(0);
      const outside = free.in_contact.map((inside, i) => (inside ? null : free.driving_formula_slip[i]));
      const line = (found) => found.driving_formula_slip.map((slip, i) => (found.in_contact[i] && slip >= -2 ? slip : null));
      const x = free.at.map((at) => at * scale);
      const series = [];
      if (sweep !== 'mobilised') {
        series.push({ name: 'S₀', x, y: line(free), ...CURVES[0], width: 2.25 });
        if (outside.some((slip) => slip !== null)) series.push({ name: 'outside the contact', x, y: outside, colour: 'var(--muted)', dash: '2 4', width: 1, ghost: true });
      }
      if (sweep === 'mobilised' || state.mobilised > 0) series.push({ name: `S at τ = ${shown(state.mobilised, 2)} T`, x, y: line(sweep === 'mobilised' ? free : curve(state.mobilised)), ...CURVES[1], width: 2.25 });
      const now = { theta_deg: state.theta_deg, sinkage_m: z, radius_m: state.radius_m, mobilised: state.mobilised }[sweep] * scale;
      chart.show({ series, range: [from * scale, to * scale], marks: [], levels: [{ y: ours, name: 'our operating point' }, { y: -PRINTED_SLIP, name: 'printed optimum 0.1146, as −S' }], cursor: now });
    }
    const here = ask({ ...fixed, mobilised: state.mobilised, sweep: 'theta_deg', from: state.theta_deg, to: state.theta_deg, points: 2 });
    this.slip = here.driving_formula_slip[0];
    const inside = here.in_contact[0];
    this.words.replaceChildren(
      h('p', {}, `At θ = ${shown(state.theta_deg)}°, the sinkage z = ${shown(1e3 * z)} mm of our operating point and r = ${shown(1e3 * state.radius_m)} mm the model gives S = `,
        h('strong', {}, this.slip === null ? 'no slip' : shown(this.slip)), `; our wheel runs at ${shown(ours)}.`,
        inside ? '' : ` The angle lies outside the contact, which ends at ${shown(point.theta_1_deg)}°: the number has no meaning under a wheel.`),
      h('p', { class: 'muted' }, 'S₀ is the slip at which the shear displacement returns to zero at θ. It depends on θ and z/r alone: no soil moves it, and it is never positive. The paper apparently prints magnitudes. With a share x of the strength it is the slip at which the soil at θ mobilises x: the law of shear that our wheel obeys too, solved for the slip. Source: Ani et al. (2012), J. Cent. South Univ. 19.'));
    this.command.textContent = `grouser paper slip-model --theta-deg ${state.theta_deg} --sinkage-m ${z} --radius-m ${state.radius_m}${state.mobilised > 0 ? ` --mobilised ${state.mobilised} --soil ${soil}` : ''}`;
  }
}
