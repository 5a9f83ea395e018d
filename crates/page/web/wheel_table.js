// The table of a run's wheels: their values at a time, and which of them the charts show.

import { h, svg } from './dom.js';
import { nameAt } from './run_data.js';

/** A slip with three decimals. */
function slipText(value) {
  return Number.isFinite(value) ? value.toFixed(3).replace('-', '−') : '–';
}

export class WheelTable {
  #wheels = [];
  #cells = [];
  #hasTruth = false;
  #changed;

  /** Names of wheels that are not shown. */
  hidden = new Set();

  /** `changed()`: other wheels are to be shown. */
  constructor(changed) {
    this.#changed = changed;
    this.element = h('table', { class: 'wheels' });
  }

  /** Another run's wheels, all shown. */
  begin(wheels) {
    this.hidden.clear();
    this.#wheels = wheels;
    this.#hasTruth = wheels.some((wheel) => wheel.true_slip?.length);
    this.#cells = wheels.map(() => ({ slip: h('span', {}), sigma: h('span', { class: 'sigma' }), truth: h('td', { class: 'number' }), motion: h('td', { class: 'state' }), health: h('td', { class: 'state' }) }));
    this.element.replaceChildren(
      h('caption', { class: 'sr-only' }, 'Wheels at the cursor’s time'),
      h('thead', {}, h('tr', {}, ['wheel', 'slip ± sigma', ...(this.#hasTruth ? ['true slip'] : []), 'motion', 'health'].map((name) => h('th', { scope: 'col' }, name)))),
      h('tbody', {}, wheels.map((wheel, i) => this.#row(wheel, this.#cells[i]))));
  }

  /** The same wheels with more moments. */
  grow(wheels) {
    this.#wheels = wheels;
  }

  /** The values at a time, which is that of the moment `index`; −1 for none. */
  show(index, time) {
    this.#wheels.forEach((wheel, i) => {
      const { slip, sigma, truth, motion, health } = this.#cells[i];
      const value = slipText(wheel.shown.slip[index]);
      const spread = wheel.shown.sigma[index];
      const hasSpread = value !== '–' && Number.isFinite(spread);
      slip.textContent = hasSpread ? `${value} ` : value;
      sigma.textContent = hasSpread ? `± ${spread.toFixed(3)}` : '';
      if (this.#hasTruth) truth.textContent = slipText(wheel.true_slip[index]);
      motion.textContent = (index >= 0 && nameAt(wheel.motion ?? [], time)) || '–';
      health.textContent = (index >= 0 && nameAt(wheel.health ?? [], time)) || '–';
    });
  }

  #row({ name, look }, { slip, sigma, truth, motion, health }) {
    const box = h('input', { type: 'checkbox', checked: true, 'aria-label': `Show ${name}`, on: { change: () => {
      if (box.checked) this.hidden.delete(name);
      else this.hidden.add(name);
      this.#changed();
    } } });
    const line = svg('svg', { width: 18, height: 8, 'aria-hidden': 'true' }, svg('line', { x1: 0, x2: 18, y1: 4, y2: 4, stroke: look.colour, 'stroke-width': 3 }));
    return h('tr', {}, h('th', { scope: 'row' }, h('label', {}, box, line, name)), h('td', { class: 'number' }, slip, sigma), this.#hasTruth ? truth : null, motion, health);
  }
}
