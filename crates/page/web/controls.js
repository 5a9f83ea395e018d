// A quantity with a slider and a typed value.

import { h, symbol } from './dom.js';
import { shifted, significant } from './format.js';

const STEPS = 1000;

/**
 * A control of a field of `state.js`. `change(value)` is called with the value in the unit of the key.
 * The slider covers the usual range; a typed value may lie beyond it.
 */
export class Control {
  #field;
  #slider;
  #number;
  #note;

  constructor(field, change) {
    this.#field = field;
    const id = `field-${field.key}`;
    this.#slider = h('input', {
      type: 'range', min: 0, max: STEPS, step: 1, 'aria-label': `${field.name}, slider`,
      on: { input: () => change(this.#fromSlider(Number(this.#slider.value))) },
    });
    if (!field.log) {
      const power = field.power ?? 0;
      Object.assign(this.#slider, {
        min: shifted(field.low, -power), max: shifted(field.high, -power), step: shifted(field.step, -power),
      });
    }
    this.#number = h('input', {
      id, type: 'text', inputmode: 'decimal', autocomplete: 'off', spellcheck: 'false', 'data-field': field.key,
      on: {
        change: () => this.#typed(change),
        keydown: (event) => this.#key(event, change),
        focus: () => this.#number.select(),
      },
    });
    this.#note = h('p', { class: 'field-note', hidden: true });
    this.element = h(
      'div',
      { class: 'field' },
      h('label', { for: id }, h('span', { class: 'field-name' }, field.name), ' ', symbol(field.symbol)),
      h('span', { class: 'field-value' }, this.#number, h('span', { class: 'unit' }, field.unit)),
      this.#slider,
      this.#note,
    );
  }

  /** Shows a value (in the unit of the key) and a remark. */
  show(value, note = '') {
    const { power = 0, log, low, high } = this.#field;
    const inUnit = shifted(value, -power);
    if (document.activeElement !== this.#number) this.#number.value = String(inUnit).replace('-', '−');
    const place = log
      ? (STEPS * Math.log(Math.max(value, 1e-12) / low)) / Math.log(high / low)
      : inUnit;
    if (Number(this.#slider.value) !== place) this.#slider.value = place;
    this.#slider.setAttribute('aria-valuetext', `${inUnit} ${this.#field.unit}`);
    const [min, max] = [Number(this.#slider.min), Number(this.#slider.max)];
    const share = Math.min(1, Math.max(0, (place - min) / (max - min)));
    this.#slider.style.setProperty('--share', `${(100 * share).toFixed(1)}%`);
    this.#note.hidden = !note;
    this.#note.textContent = note;
    this.element.classList.remove('is-wrong');
  }

  /** Marks the field whose value was refused. */
  refuse(message) {
    this.element.classList.add('is-wrong');
    this.#note.hidden = false;
    this.#note.textContent = message;
  }

  #fromSlider(place) {
    const { log, low, high, power = 0 } = this.#field;
    if (log) return significant(low * (high / low) ** (place / STEPS), 3);
    return shifted(place, power);
  }

  #typed(change) {
    const text = this.#number.value.trim().replace('−', '-').replace(',', '.');
    const value = Number(text);
    if (text === '' || !Number.isFinite(value)) {
      this.refuse('a number, such as 0.35');
      return;
    }
    this.element.classList.remove('is-wrong');
    change(shifted(value, this.#field.power ?? 0));
  }

  #key(event, change) {
    if (event.key === 'Enter') this.#typed(change);
    if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
    event.preventDefault();
    const up = event.key === 'ArrowUp' ? 1 : -1;
    const places = event.shiftKey ? 10 : 1;
    const { log, step } = this.#field;
    const now = Number(this.#number.value.replace('−', '-'));
    if (!Number.isFinite(now)) return;
    const next = log
      ? significant(now * 1.01 ** (up * places), 3)
      : significant(now + shifted(step, -(this.#field.power ?? 0)) * up * places, 6);
    this.#number.value = String(next).replace('-', '−');
    this.#typed(change);
  }
}
