// Optimise: a problem file, its compromise in words, its front linked with its variables.

import { h, svg } from './dom.js';
import { shown } from './format.js';
import { FIRST_VIEW, frontInSpace } from './front_space.js';
import { Brushes } from './brushes.js';
import { Refusal } from './physics.js';
import { sources } from './report.js';
import { tickLabels, ticks } from './ticks.js';

const NAMES = ['dry-sand-wheel', 'pull-against-torque', 'running-slip', 'robust-wheel'];
/** Variables of a problem that the explorer has too. */
const EXPLORED = ['radius_m', 'width_m', 'slip', 'load_n', 'grouser_height_m'];

/** On a phone pictures are drawn for its width, so that their text stays readable. */
function isNarrow() {
  return innerWidth < 520;
}

/** The view; `onwards`: `explore(query)` opens the explorer with a design, `drive(design, soil)` drives with it. */
export class Optimise {
  #physics;
  #onwards;
  #answer = null;
  #chosen = null;
  #isSolving = false;
  #problems = null;
  #after = [];
  #view = { ...FIRST_VIEW };
  #brushes = new Brushes(() => this.#applyBrushes());

  constructor(physics, report, onwards) {
    this.#physics = physics;
    this.#onwards = onwards;
    this.element = this.#build();
    if (report) this.#take(report);
  }

  /** Shows the answer of a report. */
  #take({ answer, problem, proof, provenance }) {
    this.text.value = problem;
    this.text.readOnly = true;
    this.tools.hidden = true;
    this.solve.hidden = true;
    this.#answer = answer;
    this.#chosen = answer.knee ?? null;
    this.#after = [proof ? h('section', { class: 'card facts', 'aria-label': 'Proof' }, h('h2', {}, 'What is proved'), h('p', {}, proof)) : null, sources(provenance)];
    this.#show();
  }

  /** Nothing of a problem is in the address. */
  open() {
    if (!this.text.value) this.#example('pull-against-torque');
  }

  /** The answer that is shown. */
  get answer() {
    return this.#answer;
  }

  #build() {
    this.choice = h('select', { 'aria-label': 'Example', on: { change: () => this.#example(this.choice.value) } }, NAMES.map((name) => h('option', { value: name, selected: name === 'pull-against-torque' }, name)));
    this.file = h('input', { type: 'file', accept: '.toml', id: 'problem-file', class: 'sr-only', on: { change: () => this.#open() } });
    this.text = h('textarea', { spellcheck: 'false', 'aria-label': 'Problem file', rows: 26, autocomplete: 'off', on: { input: () => this.#enable() } });
    this.solve = h('button', { type: 'button', class: 'primary', disabled: true, on: { click: () => this.#solve() } }, 'Solve');
    this.stop = h('button', { type: 'button', class: 'quiet', hidden: true, on: { click: () => this.#physics.stop() } }, 'Stop');
    this.status = h('p', { class: 'run-status', role: 'status' });
    this.result = h('div', { class: 'results' });
    this.tools = h('div', { class: 'run-tools' }, this.choice, h('label', { class: 'quiet button', for: 'problem-file' }, 'Open a file'), this.file);
    return h('div', { class: 'optimise' },
      h('section', { class: 'card problem', 'aria-label': 'Problem' },
        this.tools,
        this.text, h('div', { class: 'run-tools' }, this.solve, this.stop, this.status)),
      this.result);
  }

  async #open() {
    const [file] = this.file.files;
    if (file && file.size <= 1 << 20) this.#write(await file.text());
    else if (file) this.#say('a problem file has at most 1 MiB', true);
    this.file.value = '';
  }

  async #example(name) {
    try {
      this.#problems ??= (await this.#physics.ask({ call: 'problems' })).problems;
      this.#write(this.#problems.find((one) => one.name === name).text);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.#say(error.message, true);
    }
  }

  #write(problem) {
    this.text.value = problem;
    this.#enable();
  }

  /** Nothing is solved before there is a problem, or while one is solved. */
  #enable() {
    this.solve.disabled = this.#isSolving || !this.text.value.trim();
  }

  #say(text, bad = false) {
    this.status.textContent = text;
    this.status.classList.toggle('is-error', bad);
  }

  async #solve() {
    this.#say('solving …');
    this.stop.hidden = false;
    this.#isSolving = true;
    this.#enable();
    const started = performance.now();
    try {
      const take = (part) => {
        const { stage, done, of } = JSON.parse(new TextDecoder().decode(part));
        this.#say(of ? `solving: ${stage}, ${done} of ${of}` : `solving: ${stage}, ${done}`);
      };
      this.#answer = await this.#physics.ask({ call: 'optimize', problem: this.text.value }, { take });
      this.#say(`solved in ${shown((performance.now() - started) / 1e3, 2)} s`);
      this.#chosen = this.#answer.knee ?? null;
      this.#brushes.clear();
      this.#show();
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.#say(error.message, true);
    } finally {
      this.stop.hidden = true;
      this.#isSolving = false;
      this.#enable();
    }
  }

  #show() {
    const { title, method, front } = this.#answer;
    const parts = [h('section', { class: 'card hero', 'aria-label': 'Answer' }, h('header', {}, h('h2', {}, title || 'Answer'), h('span', { class: 'badge' }, method)), front ? this.#words() : this.#optimum())];
    if (front?.length) {
      parts.push(h('div', { class: 'charts' }, this.#pairs()), this.#parallel());
    }
    this.result.replaceChildren(...parts, ...this.#after.filter(Boolean));
    this.#applyBrushes();
  }

  #units() {
    return Object.fromEntries(this.#answer.variables.map(({ name, unit }) => [name, unit ?? '']));
  }

  #values(x, note = () => '') {
    const units = this.#units();
    return h('dl', { class: 'readouts' }, Object.entries(x).map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, h('span', { class: 'number' }, shown(value, 4)), units[name] ? h('span', { class: 'unit' }, ` ${units[name]}`) : null, h('span', { class: 'note' }, note(name, value))))));
  }

  /** Says which bound a variable is at. */
  #bound() {
    return (name, value) => {
      const { lower, upper } = this.#answer.variables.find((one) => one.name === name);
      const close = (bound) => bound !== null && Math.abs(value - bound) <= 1e-6 * Math.max(1, Math.abs(bound));
      return close(lower) ? 'at its lower bound' : close(upper) ? 'at its upper bound' : '';
    };
  }

  #optimum() {
    const answer = this.#answer;
    const shares = Object.entries(answer.objective_multipliers);
    const costs = Object.entries(answer.constraint_multipliers).filter(([, cost]) => Math.abs(cost) > 1e-9);
    const bar = ([name, share]) => h('li', {}, h('span', { class: 'bar', style: { '--share': `${Math.round(100 * Math.min(1, Math.abs(share)))}%` } }), `${name}: ${shown(share)}`);
    const problems = [];
    if (!answer.is_solved) problems.push(h('li', { class: 'is-error' }, answer.violated ? `No point meets all constraints: ${Object.entries(answer.violated).map(([name, by]) => `${name} by ${shown(by)}`).join(', ')}.` : `No solution: ${answer.status}.`));
    if (answer.is_ambiguous) problems.push(h('li', {}, 'Several different points are equally good: the answer is not unique.'));
    return h('div', {}, this.#values(answer.x, this.#bound()), h('ul', { class: 'cautions' }, problems),
      h('h3', { class: 'sub' }, 'Objectives there'), this.#values(answer.values),
      shares.length ? [h('h3', { class: 'sub' }, 'What the compromise is between'), h('p', { class: 'muted' }, this.#sentence(shares)), h('ul', { class: 'bars' }, shares.map(bar))] : null,
      costs.length ? [h('h3', { class: 'sub' }, 'What the constraints cost'), h('ul', { class: 'bars' }, costs.map(bar))] : null,
      answer.active.length ? h('p', { class: 'muted' }, `Held by ${answer.active.join(', ')}.`) : null, this.#next(answer.x));
  }

  /** The multipliers in words. */
  #sentence(shares) {
    const binding = shares.filter(([, share]) => Math.abs(share) > 1e-6).sort((a, b) => b[1] - a[1]);
    const free = shares.filter(([, share]) => Math.abs(share) <= 1e-6).map(([name]) => name);
    if (binding.length === 1) return `${binding[0][0]} alone decides; ${free.length ? `${free.join(', ')} could be stricter without a change.` : ''}`;
    const list = binding.map(([name, share]) => `${name} (${shown(100 * share, 2)} %)`).join(', ');
    return `Improving one worsens another: ${list}.${free.length ? ` ${free.join(', ')} would bear more.` : ''}`;
  }

  #words() {
    const { front, knee, violation } = this.#answer;
    if (!front.length) return h('ul', { class: 'cautions' }, h('li', { class: 'is-error' }, `No point that meets all constraints was found; the nearest violates them by ${shown(violation)}.`));
    const i = this.#chosen ?? knee ?? 0;
    const point = front[i];
    return h('div', {}, h('p', { class: 'muted' }, `${front.length} compromises; ${i === knee ? 'the knee, where the front bends most' : `compromise ${i + 1}`}: choose one in a picture below.`),
      this.#values(point.x, this.#bound()), h('h3', { class: 'sub' }, 'Objectives'), this.#values(point.objectives),
      point.objective_multipliers ? h('p', { class: 'muted' }, this.#sentence(Object.entries(point.objective_multipliers))) : null, this.#next(point.x));
  }

  /** Ways to the explorer and to a scenario, for variables that they have. */
  #next(x) {
    if (!this.#onwards) return null;
    const known = EXPLORED.filter((key) => x[key] !== undefined);
    if (!known.includes('radius_m') && !known.includes('slip')) return null;
    const soil = this.text.value.match(/^\s*key\s*=\s*"([a-z0-9-]+)"/m)?.[1];
    const load = this.text.value.match(/^\s*load_n\s*=\s*([\d.]+)/m)?.[1];
    const query = new URLSearchParams(soil ? { soil } : {});
    if (load) query.set('load_n', load);
    for (const key of known) query.set(key, String(Number(x[key].toPrecision(6))));
    const button = (text, click) => h('button', { type: 'button', class: 'quiet', on: { click } }, text);
    const drives = this.#onwards.drive && (x.radius_m !== undefined || x.width_m !== undefined);
    return h('p', { class: 'run-tools' }, button('Explore this wheel', () => this.#onwards.explore(query.toString())),
      drives ? button('Drive the sandbox with it', () => this.#onwards.drive(x, soil)) : null);
  }

  /** Is a compromise outside of what is limited on an axis? */
  #isOut(i) {
    return !this.#brushes.hold(this.#axes(), this.#answer.front[i]);
  }

  /** Pales the compromises that are out, in all pictures. */
  #applyBrushes() {
    const { front } = this.#answer;
    if (!front?.length) return;
    for (const one of this.result.querySelectorAll('[data-compromise]')) one.classList.toggle('is-out', this.#isOut(Number(one.dataset.compromise)));
    const left = front.filter((_, i) => !this.#isOut(i)).length;
    this.brushed.textContent = this.#brushes.any ? `${left} of ${front.length} compromises are within the limits` : 'Drag along an axis to limit it; on an axis, the arrow keys move its upper limit, with Shift its lower one.';
    this.unlimited.hidden = !this.#brushes.any;
  }

  #choose(i) {
    this.#chosen = i;
    this.#show();
  }

  /** The first three objectives in space, and two against each other for each pair of them. */
  #pairs() {
    const names = this.#answer.objectives.map(({ name }) => name);
    const pairs = names.length > 2 ? [[0, 1], [0, 2], [1, 2]] : [[0, 1]];
    const cards = pairs.map(([a, b]) => this.#scatter(names[a], names[b]));
    if (names.length < 3) return cards;
    const { front, knee } = this.#answer;
    const space = frontInSpace({
      front, knee, names: names.slice(0, 3), chosen: this.#chosen, view: this.#view, narrow: isNarrow(), choose: (i) => this.#choose(i), isOut: (i) => this.#isOut(i),
    });
    return [space, ...cards];
  }

  #scatter(a, b) {
    const { front, knee } = this.#answer;
    const [width, height, left, bottom] = [isNarrow() ? 330 : 520, isNarrow() ? 260 : 320, 60, 44];
    const range = (name) => {
      const values = front.map(({ objectives }) => objectives[name]);
      const [low, high] = [Math.min(...values), Math.max(...values)];
      const room = 0.06 * (high - low || Math.abs(high) || 1);
      return [low - room, high + room];
    };
    const [ra, rb] = [range(a), range(b)];
    const px = (value) => left + ((width - left - 14) * (value - ra[0])) / (ra[1] - ra[0]);
    const py = (value) => 12 + (height - bottom - 12) * (1 - (value - rb[0]) / (rb[1] - rb[0]));
    const [ta, tb] = [ticks(...ra, 5), ticks(...rb, 5)];
    const marks = [
      ...tickLabels(ta).map((label, i) => [svg('line', { x1: px(ta[i]), x2: px(ta[i]), y1: 12, y2: height - bottom, class: 'gridline' }), svg('text', { x: px(ta[i]), y: height - bottom + 18, 'text-anchor': 'middle' }, label)]),
      ...tickLabels(tb).map((label, i) => [svg('line', { x1: left, x2: width - 14, y1: py(tb[i]), y2: py(tb[i]), class: 'gridline' }), svg('text', { x: left - 8, y: py(tb[i]) + 4, 'text-anchor': 'end' }, label)]),
    ];
    const dots = front.map((point, i) => svg('circle', {
      cx: px(point.objectives[a]), cy: py(point.objectives[b]), r: i === this.#chosen ? 7 : 4.5, class: `front-dot${i === this.#chosen ? ' is-chosen' : ''}${i === knee ? ' is-knee' : ''}`, 'data-compromise': i, on: { click: () => this.#choose(i) },
    }, svg('title', {}, `${a} ${shown(point.objectives[a])}, ${b} ${shown(point.objectives[b])}`)));
    return h('section', { class: 'card chart', 'aria-label': `${a} against ${b}` }, h('header', {}, h('h3', {}, `${a} against ${b}`)),
      svg('svg', { class: 'plot', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `${front.length} compromises, ${a} against ${b}` },
        svg('g', { class: 'axis-text' }, marks, svg('text', { x: (left + width) / 2, y: height - 6, 'text-anchor': 'middle', class: 'axis-name' }, a), svg('text', { transform: `translate(14 ${(height - bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle', class: 'axis-name' }, b)), dots));
  }

  /** Variables and objectives with their least and greatest values on the front. */
  #axes() {
    const { front, variables, objectives } = this.#answer;
    const axes = [...variables.map(({ name }) => ({ name, of: (p) => p.x[name] })), ...objectives.map(({ name }) => ({ name, of: (p) => p.objectives[name], is: true }))];
    return axes.map((axis) => {
      const values = front.map(axis.of);
      return { ...axis, low: Math.min(...values), high: Math.max(...values) };
    });
  }

  /** All variables and objectives side by side: a line is a compromise, linked with the dots. */
  #parallel() {
    const { front } = this.#answer;
    const axes = this.#axes();
    const [width, height, top, bottom, side] = isNarrow() ? [330, 280, 46, 26, 30] : [960, 300, 46, 26, 60];
    const scaled = axes.map((axis, k) => {
      const { low, high } = axis;
      const x = side + ((width - 2 * side) * k) / Math.max(1, axes.length - 1);
      return { ...axis, x, y: (value) => (high > low ? top + (height - top - bottom) * (1 - (value - low) / (high - low)) : (top + height - bottom) / 2) };
    });
    const order = front.map((_, i) => i).sort((i, j) => (i === this.#chosen) - (j === this.#chosen));
    const lines = order.map((i) => svg('path', { d: scaled.map(({ x, y, of }, k) => `${k ? 'L' : 'M'}${x.toFixed(1)} ${y(of(front[i])).toFixed(1)}`).join(''), class: `compromise${i === this.#chosen ? ' is-chosen' : ''}`, 'data-compromise': i, on: { click: () => this.#choose(i) } }));
    const marks = scaled.map(({ name, x, low, high, is }) => svg('g', { class: 'axis-text' },
      svg('line', { x1: x, x2: x, y1: top, y2: height - bottom, class: 'parallel-axis' }),
      svg('text', { x, y: 16, 'text-anchor': 'middle', class: is ? 'axis-name is-objective' : 'axis-name' }, name),
      svg('text', { x, y: top - 8, 'text-anchor': 'middle' }, shown(high)), svg('text', { x, y: height - bottom + 16, 'text-anchor': 'middle' }, shown(low))));
    const next = h('input', { type: 'range', min: 0, max: front.length - 1, step: 1, value: this.#chosen ?? 0, 'aria-label': 'Compromise along the front', on: { change: () => this.#choose(Number(next.value)) } });
    next.style.setProperty('--share', `${(100 * (this.#chosen ?? 0)) / Math.max(1, front.length - 1)}%`);
    const brushes = scaled.flatMap((axis) => this.#brushes.element(axis, { top, height: height - top - bottom, reach: isNarrow() ? 11 : 18 }));
    this.brushed = h('output', {});
    this.unlimited = h('button', { type: 'button', class: 'link', on: { click: () => {
      this.#brushes.clear();
      this.#show();
    } } }, 'Drop the limits');
    return h('section', { class: 'card chart', 'aria-label': 'Variables and objectives' }, h('header', {}, h('h3', {}, 'Variables and objectives of each compromise')),
      svg('svg', { class: 'plot', viewBox: `0 0 ${width} ${height}`, role: 'group', 'aria-label': 'A line for each compromise over all variables and objectives' }, lines, marks, brushes), h('p', { class: 'brushed' }, this.brushed, this.unlimited), next);
  }
}
