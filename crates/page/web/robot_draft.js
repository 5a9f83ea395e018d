// A robot file for a log that came alone: what the log holds, and the numbers that no log holds.

import { download, h } from './dom.js';

/** What a proposed file leaves open; each is asked once for all wheels. */
const OPEN = {
  radius_m: { label: 'Radius of the wheels', unit: 'm' },
  ticks_per_turn: { label: 'Ticks per turn of a wheel', unit: '1' },
};
const lineOf = (key) => new RegExp(`^${key} = "measure"`, 'gm');
const REFERENCE = /^# (pose = (".*?"))(?:\s+# (.*))?$/gm;

/** Asks for what the file `robot` leaves open; `estimate(text)` gets the whole file. */
export class RobotDraft {
  #robot;
  #inputs = {};

  constructor(robot, estimate) {
    this.#robot = robot;
    const wheels = [...robot.matchAll(/^name = "(.*)"$/gm)].slice(1).map(([, name]) => name);
    const references = [...robot.matchAll(REFERENCE)];
    this.reference = h('select', { id: 'draft-reference', on: { change: () => this.#fill() } },
      h('option', { value: '' }, 'nothing more than the file names'),
      references.map(([, line, topic, says]) => h('option', { value: line, title: says }, topic.slice(1, -1))));
    const open = Object.entries(OPEN).filter(([key]) => lineOf(key).test(robot));
    this.text = h('textarea', { id: 'draft-text', rows: 18, spellcheck: 'false' });
    this.text.addEventListener('input', () => this.#check());
    this.go = h('button', { type: 'button', class: 'primary', disabled: true, on: { click: () => estimate(this.text.value) } }, 'Estimate slip');
    const save = h('button', { type: 'button', class: 'quiet', on: { click: () => download('robot.toml', 'application/toml', this.text.value) } }, 'Save robot.toml');
    this.element = h('section', { class: 'card draft', 'aria-label': 'Robot file of this log' },
      h('h2', {}, 'A robot file for this log'),
      h('p', { class: 'muted' }, wheels.length ? `Wheels found: ${wheels.join(', ')}. ` : 'No wheels were found. ', 'A log holds no sizes: a wrong radius or number of ticks looks like slip. Places of the wheels are round numbers; check them in the file.'),
      open.map(([key, { label, unit }]) => this.#field(key, label, unit)),
      references.length ? h('div', { class: 'field' }, h('label', { for: 'draft-reference' }, 'What measures the motion over ground'), this.reference) : null,
      h('div', { class: 'run-tools' }, this.go, save),
      h('details', {}, h('summary', {}, 'The file'), h('label', { class: 'sr-only', for: 'draft-text' }, 'The robot file'), this.text));
    this.#fill();
  }

  #field(key, label, unit) {
    const input = h('input', { id: `draft-${key}`, type: 'number', min: 0, step: 'any', inputmode: 'decimal', on: { input: () => this.#fill() } });
    this.#inputs[key] = input;
    return h('div', { class: 'field' }, h('label', { for: input.id }, label), h('span', { class: 'field-value' }, input, h('span', { class: 'unit' }, unit === '1' ? '' : unit)));
  }

  /** The file with what was chosen and typed. */
  #fill() {
    let text = this.#robot;
    for (const [key, input] of Object.entries(this.#inputs)) {
      if (Number(input.value) > 0) text = text.replace(lineOf(key), `${key} = ${Number(input.value)}`);
    }
    const chosen = this.reference.value;
    if (chosen) text = text.replace(`# ${chosen}`, chosen);
    this.text.value = text;
    this.#check();
  }

  /** Whether anything is open still: a file with placeholders is refused. */
  #check() {
    this.go.disabled = Object.keys(OPEN).some((key) => lineOf(key).test(this.text.value));
  }
}
