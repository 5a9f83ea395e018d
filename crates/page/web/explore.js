// Explore: a wheel on a soil.

import { Chart } from './chart.js';
import { Control } from './controls.js';
import { copyMenu } from './copy_as.js';
import { h, svg } from './dom.js';
import { figureButton } from './figure_file.js';
import { shown, significant } from './format.js';
import { bands, outside, readIntervals } from './intervals.js';
import { measuredPoints } from './measured_points.js';
import { CURVES } from './palette.js';
import { Paper2012 } from './paper_2012.js';
import { Refusal } from './physics.js';
import { curveRequest, hasLugs, pointRequest } from './requests.js';
import { SOIL_FIELDS, numbersOf } from './soils.js';
import {
  GRAVITY_FIELD, LOAD_FIELD, LUG_FIELDS, MASS_FIELD, MOTION_FIELDS, WHEEL_FIELDS,
  changedSoil, chooseSoil, firstState, fromQuery, toQuery, weight,
} from './state.js';
import { StressPicture } from './stress.js';

/** Points of a curve, as many as the command's range of slip has by default. */
const POINTS = 91;
/** Points of a compared soil's curve. */
const COMPARED_POINTS = 46;
/** Points of the curves between which a band lies. */
const BAND_POINTS = 31;
const PROFILE_POINTS = 121;
/** From this slip on a wheel spins nearly on the spot, as for the command's range of slip. */
const SPINNING_SLIP = 0.99;
/** How long nothing moves before the best slips are looked for, ms. */
const SETTLED_MS = 120;

const QUANTITIES = [
  { key: 'drawbar_pull_n', title: 'Drawbar pull', unit: 'N', scale: 1, best: 'most_pull' },
  { key: 'torque_nm', title: 'Torque', unit: 'N m', scale: 1 },
  { key: 'sinkage_m', title: 'Sinkage', unit: 'mm', scale: 1e3 },
  { key: 'tractive_efficiency', title: 'Tractive efficiency', unit: '%', scale: 100, best: 'most_efficient', zero: true },
];

/** The view. `physics` answers requests; `moved(query)` is called when the state has a new address. */
export class Explore {
  #physics;
  #moved;
  #catalogue;
  #state;
  #controls = new Map();
  #charts = new Map();
  #best = {};
  #frame = null;
  #settled = null;
  #measured = null;
  #bands = null;

  constructor(physics, { soils, gravity }, moved) {
    this.#physics = physics;
    this.#moved = moved;
    this.#catalogue = new Map(soils.map((entry) => [entry.key, entry]));
    this.#state = firstState(this.#catalogue);
    this.gravity = gravity;
    this.timings = [];
    this.element = this.#build();
  }

  /** Takes a state out of an address. */
  open(query) {
    this.#state = fromQuery(this.#catalogue, query);
    this.#best = {};
    this.#bands = null;
    this.#schedule();
  }

  /** The address of the state. */
  query() {
    return toQuery(this.#catalogue, this.#state);
  }

  /** Where pull and efficiency are greatest, once looked for. */
  get best() {
    return this.#best;
  }

  /** The state. */
  get state() {
    return this.#state;
  }

  #set(change) {
    Object.assign(this.#state, change);
    this.#best = {};
    this.#bands = null;
    this.#schedule();
  }

  #schedule() {
    this.#requestedAt ??= performance.now();
    this.#frame ??= requestAnimationFrame(() => {
      this.#frame = null;
      this.#update();
    });
  }

  #requestedAt = null;

  // ---- building -----------------------------------------------------------------------------

  #build() {
    this.picture = new StressPicture({
      radius: (metres) => this.#set({ radius_m: significant(metres, 3) }),
      load: this.#dragLoad(),
      sinkage: (metres) => this.#sink(metres),
    });
    this.readouts = h('dl', { class: 'readouts' });
    this.cautions = h('ul', { class: 'cautions', 'aria-live': 'polite' });
    const charts = QUANTITIES.map((quantity) => this.#chart(quantity));
    this.legend = h('div', { class: 'legend' });
    return h(
      'div',
      { class: 'explore' },
      this.adjust = h('button', { type: 'button', class: 'primary adjust', 'aria-expanded': 'false', on: { click: () => this.#adjust() } }, 'Adjust'),
      h('form', { class: 'controls', 'aria-label': 'Soil, wheel and motion', on: { submit: (event) => event.preventDefault() } },
        this.#soilChoice(), this.#motionPanel(), this.#wheelPanel(), this.#soilNumbers()),
      h('div', { class: 'results' },
        h('section', { class: 'card hero', 'aria-label': 'Operating point' },
          h('header', {}, this.heading = h('h2', {}, ''), copyMenu(() => this.#state, this.#catalogue)),
          this.readouts, this.cautions,
          this.picture.element,
          h('p', { class: 'key' },
            h('span', { class: 'key-normal' }, 'normal stress σ'), h('span', { class: 'key-shear' }, 'shear stress τ'),
            this.peak = h('span', { class: 'key-peak' }))),
        this.#tabs(),
        this.slipTab = h('div', { id: 'tab-slip', role: 'tabpanel', 'aria-label': 'Against slip', class: 'slip-tab' }, this.#compareBar(), h('div', { class: 'charts' }, charts)),
        this.paper.element),
    );
  }

  #tabs() {
    this.paper = new Paper2012((change) => this.#set(change));
    const tab = (key, name, panel) => h('button', {
      type: 'button', role: 'tab', 'data-tab': key, 'aria-controls': panel,
      on: {
        click: () => this.#set({ tab: key }),
        keydown: ({ key: pressed }) => {
          if (pressed !== 'ArrowLeft' && pressed !== 'ArrowRight') return;
          const other = this.tabs.find(({ dataset }) => dataset.tab !== key);
          other.click();
          other.focus();
        },
      },
    }, name);
    this.tabs = [tab('slip', 'Against slip', 'tab-slip'), tab('2012', 'The 2012 model', 'tab-paper')];
    return h('div', { class: 'tabs', role: 'tablist', 'aria-label': 'Curves' }, this.tabs);
  }

  #showTab(state, point) {
    const isPaper = state.tab === '2012';
    this.slipTab.hidden = isPaper;
    this.paper.element.hidden = !isPaper;
    for (const tab of this.tabs) {
      const isShown = tab.dataset.tab === state.tab;
      tab.setAttribute('aria-selected', String(isShown));
      tab.tabIndex = isShown ? 0 : -1;
    }
    const hasOwnK = !this.#catalogue.has(state.soil) || changedSoil(this.#catalogue, state).includes('k_shear_m');
    if (isPaper) this.paper.show(state, point, hasOwnK ? 'soil.toml' : state.soil, (request) => this.#physics.askNow(request));
  }

  /** On a phone the controls are a sheet over the lower half. */
  #adjust() {
    const open = this.element.classList.toggle('is-adjusting');
    this.adjust.setAttribute('aria-expanded', String(open));
    this.adjust.textContent = open ? 'Done' : 'Adjust';
  }

  #dragLoad() {
    // a drag reports its share of the load at its start; keys report steps
    let start = null;
    addEventListener('pointerdown', () => { start = null; }, true);
    addEventListener('keydown', () => { start = null; }, true);
    return (share) => {
      start ??= this.#state.load_by === 'mass' ? this.#state.mass_kg : this.#state.load_n;
      const key = this.#state.load_by === 'mass' ? 'mass_kg' : 'load_n';
      this.#set({ [key]: significant(start * share, 3) });
    };
  }

  #control(field) {
    const control = new Control(field, (value) => this.#set({ [field.key]: value }));
    this.#controls.set(field.key, control);
    return control.element;
  }

  #soilChoice() {
    const complete = [];
    const open = [];
    for (const entry of this.#catalogue.values()) {
      (numbersOf(entry).open.length ? open : complete).push(h('option', { value: entry.key }, entry.name));
    }
    this.soilChoice = h(
      'select',
      { id: 'soil', on: { change: () => this.#set(chooseSoil(this.#catalogue, this.#catalogue.get(this.soilChoice.value), this.#state)) } },
      h('optgroup', { label: 'Complete' }, complete),
      h('optgroup', { label: 'K, c₁ or c₂ not in the source' }, open),
    );
    this.ownSoil = h('option', { value: 'own', hidden: true }, 'own soil');
    this.soilChoice.append(this.ownSoil);
    this.source = h('p', { class: 'source' });
    this.resetSoil = h('button', {
      type: 'button', class: 'link', hidden: true,
      on: { click: () => this.#set(chooseSoil(this.#catalogue, this.#catalogue.get(this.#state.soil), {})) },
    }, 'back to the source’s numbers');
    return h('fieldset', { class: 'card panel' },
      h('legend', {}, 'Soil'),
      h('label', { for: 'soil', class: 'sr-only' }, 'Soil of the catalogue'), this.soilChoice,
      this.source, this.resetSoil);
  }

  #soilNumbers() {
    const [usual, rare] = [SOIL_FIELDS.slice(0, 6), SOIL_FIELDS.slice(6)];
    return h('fieldset', { class: 'card panel' },
      h('legend', {}, 'Soil’s numbers'),
      usual.map((field) => this.#control(field)),
      h('details', {}, h('summary', {}, 'Stress distribution and more'), rare.map((field) => this.#control(field))),
      this.#intervalsChoice());
  }

  /** The intervals of the soil's numbers, out of a file. */
  #intervalsChoice() {
    this.intervalsFile = h('input', { type: 'file', accept: '.toml', class: 'sr-only', id: 'intervals-file', on: { change: () => this.#readIntervals() } });
    this.intervalsNote = h('p', { class: 'source', role: 'status' });
    this.dropIntervals = h('button', {
      type: 'button', class: 'link', hidden: true, on: { click: () => this.#set({ intervals: null }) },
    }, 'without intervals');
    return h('div', { class: 'intervals' },
      h('label', { class: 'quiet button', for: 'intervals-file' }, '95 % intervals'), this.intervalsFile, this.intervalsNote, this.dropIntervals);
  }

  async #readIntervals() {
    const [file] = this.intervalsFile.files;
    if (!file) return;
    try {
      this.#set({ intervals: readIntervals(await file.text()) });
    } catch (error) {
      this.#set({ intervals: null });
      this.intervalsProblem = `${file.name}: ${error.message}`;
    }
    this.intervalsFile.value = '';
  }

  #wheelPanel() {
    return h('fieldset', { class: 'card panel' },
      h('legend', {}, 'Wheel'),
      WHEEL_FIELDS.map((field) => this.#control(field)),
      h('details', { class: 'lugs' }, h('summary', {}, 'Lugs'), LUG_FIELDS.map((field) => this.#control(field))));
  }

  #motionPanel() {
    const by = (value, text) => h('label', {}, h('input', {
      type: 'radio', name: 'load-by', value, checked: value === 'load',
      on: { change: () => this.#set(this.#loadBy(value)) },
    }), h('span', {}, text));
    this.massOnly = h('div', {}, this.#control(MASS_FIELD), this.#control(GRAVITY_FIELD),
      h('div', { class: 'presets', role: 'group', 'aria-label': 'Gravity of a body' },
        this.gravity.map(({ body, gravity_m_per_s2 }) => h('button', {
          type: 'button', on: { click: () => this.#set({ gravity_m_per_s2 }) },
        }, body[0].toUpperCase() + body.slice(1)))));
    this.loadOnly = h('div', {}, this.#control(LOAD_FIELD));
    this.holdSlope = h('button', {
      type: 'button', class: 'link', hidden: true, on: { click: () => this.#holdSlope() },
    }, 'use the slip that holds the slope');
    return h('fieldset', { class: 'card panel' },
      h('legend', {}, 'Load and motion'),
      h('div', { class: 'segmented', role: 'radiogroup', 'aria-label': 'Load given as' }, by('load', 'Load'), by('mass', 'Mass, gravity')),
      this.loadOnly, this.massOnly,
      MOTION_FIELDS.map((field) => this.#control(field)), this.holdSlope);
  }

  #loadBy(value) {
    if (value === 'mass') return { load_by: 'mass', mass_kg: significant(this.#state.load_n / this.#state.gravity_m_per_s2, 6) };
    return { load_by: 'load', load_n: significant(weight(this.#state), 6) };
  }

  #compareBar() {
    this.chips = h('div', { class: 'chips' });
    this.addSoil = h('select', { 'aria-label': 'Compare with a soil', on: { change: () => this.#compare(this.addSoil.value) } },
      h('option', { value: '' }, '+ compare a soil'),
      [...this.#catalogue.values()].map((entry) => h('option', { value: entry.key }, entry.name)));
    this.pin = h('button', { type: 'button', class: 'quiet', on: { click: () => this.#pinOrDrop() } }, 'Pin this curve');
    this.measuredFile = h('input', { type: 'file', accept: '.csv,text/csv', class: 'sr-only', id: 'measured-file', on: { change: () => this.#readMeasured() } });
    this.measuredNote = h('span', { class: 'muted', role: 'status' });
    return h('section', { class: 'compare', 'aria-label': 'Curves against slip' },
      this.chips, this.addSoil, this.pin,
      h('label', { class: 'quiet button', for: 'measured-file' }, 'Measured points'), this.measuredFile, this.measuredNote,
      figureButton(() => ({ charts: [...this.#charts.values()].map(({ chart }) => chart), description: this.heading.textContent, name: 'wheel-on-soil' })));
  }

  #compare(key) {
    this.addSoil.value = '';
    if (!key || this.#state.compare.includes(key) || this.#state.compare.length >= 5) return;
    this.#set({ compare: [...this.#state.compare, key] });
  }

  #pinOrDrop() {
    const { pinned, compare, ...now } = this.#state;
    this.#set({ pinned: pinned ? null : { ...now, compare: [], pinned: null, intervals: null } });
  }

  #chart(quantity) {
    const chart = new Chart({
      title: quantity.title,
      height: () => (innerWidth < 1700 ? 230 : 320),
      x: { name: 'Slip', unit: '' },
      y: { name: quantity.title, unit: quantity.unit },
      zero: quantity.zero,
      pick: (slip) => this.#set({ slip: Number(slip.toFixed(3)) }),
      hover: (slip) => { for (const { chart: one } of this.#charts.values()) one.point(slip); },
      value: (one, value, unit) => one.silent ? null : h('span', { class: one.ghost ? 'value ghost' : 'value', style: { color: one.colour } },
        value === null ? '–' : shown(value)),
    });
    this.#charts.set(quantity.key, { chart, quantity });
    return chart.element;
  }

  // ---- actions ------------------------------------------------------------------------------

  /** The load that is carried at a sinkage. */
  #sink(metres) {
    try {
      const { load_n, slope_deg, ...request } = pointRequest(this.#state, 0);
      const { vertical_force_n } = this.#physics.askNow({ ...request, sinkage_m: metres });
      if (!(vertical_force_n > 0)) return;
      const on = vertical_force_n / Math.cos((this.#state.slope_deg * Math.PI) / 180);
      if (this.#state.load_by === 'mass') this.#set({ mass_kg: significant(on / this.#state.gravity_m_per_s2, 4) });
      else this.#set({ load_n: significant(on, 4) });
    } catch (refusal) {
      if (!(refusal instanceof Refusal)) throw refusal;
      // a sinkage to the hub: the handle stays where it is
    }
  }

  #holdSlope() {
    if (this.demand !== null && this.demand !== undefined) this.#set({ slip: this.demand });
  }

  async #readMeasured() {
    const [file] = this.measuredFile.files;
    if (!file) return;
    try {
      this.#measured = measuredPoints(await file.text(), QUANTITIES.map(({ key }) => key));
      this.measuredNote.textContent = `${this.#measured.slip.length} points of ${file.name}`;
    } catch (error) {
      this.#measured = null;
      this.measuredNote.textContent = `${file.name}: ${error.message}`;
    }
    this.measuredFile.value = '';
    this.#schedule();
  }

  // ---- showing ------------------------------------------------------------------------------

  #update() {
    const state = this.#state;
    this.#showControls(state);
    const started = performance.now();
    let point;
    let curves;
    try {
      point = this.#physics.askNow(pointRequest(state, PROFILE_POINTS, this.demand));
      curves = this.#curves(state);
      this.element.classList.remove('is-stale');
    } catch (refusal) {
      if (!(refusal instanceof Refusal)) throw refusal;
      this.#refused(refusal);
      return;
    }
    const computed = performance.now();
    this.point = point;
    this.curves = curves;
    // until they are looked for again, the cautions at other slips are those of before
    this.curve = { ...curves[0].curve, cautions: curves[0].curve.cautions ?? this.curve?.cautions ?? [] };
    this.demand = point.slip_demand;
    this.picture.show(state, point);
    this.#showReadouts(state, point);
    this.#showCautions(state, point, this.curve);
    if (state.tab !== '2012') this.#showCurves(state, point, curves);
    this.#showTab(state, point);
    const drawn = performance.now();
    this.timings.push({ compute: computed - started, draw: drawn - computed, wait: started - (this.#requestedAt ?? started) });
    this.#requestedAt = null;
    this.#moved(this.query());
    clearTimeout(this.#settled);
    if (!this.#best.known) this.#settled = setTimeout(() => this.#findBest(), SETTLED_MS);
  }

  #range(state) {
    return [state.slip < 0 ? -0.6 : 0, state.slip > 0.9 ? 1 : 0.9];
  }

  #curves(state) {
    const range = this.#range(state);
    const curve = (of, points) => this.#physics.askNow(curveRequest(of, points, range, true));
    const curves = [{ name: state.soil_name, curve: curve(state, POINTS), look: CURVES[0] }];
    state.compare.forEach((key, i) => {
      const entry = this.#catalogue.get(key);
      const soil = chooseSoil(this.#catalogue, entry, state);
      curves.push({ key, name: entry.name, open: soil.open, curve: curve({ ...state, ...soil }, COMPARED_POINTS), look: CURVES[i + 1] });
    });
    if (state.pinned) curves.push({ name: 'pinned', ghost: true, curve: curve(state.pinned, COMPARED_POINTS), look: { colour: 'var(--muted)', dash: '3 3' } });
    return curves;
  }

  #findBest() {
    const state = this.#state;
    try {
      const exact = this.#physics.askNow(curveRequest(state, POINTS, this.#range(state), false));
      this.#best = { known: true, most_pull: exact.most_pull, most_efficient: exact.most_efficient };
      this.curve = exact;
      if (state.slope_deg !== 0) {
        this.point = this.#physics.askNow(pointRequest(state, PROFILE_POINTS));
        this.demand = this.point.slip_demand;
      }
    } catch (refusal) {
      if (!(refusal instanceof Refusal)) throw refusal;
      return;
    }
    this.curves[0].curve = this.curve;
    this.#findBands(state);
    this.#showCurves(state, this.point, this.curves);
    this.#showMarks();
  }

  /** The bands that the intervals of the soil's numbers leave. */
  #findBands(state) {
    if (!state.intervals || outside(state, state.intervals)) return;
    const range = this.#range(state);
    this.#bands = bands(state, state.intervals, (numbers) => {
      try {
        return this.#physics.askNow(curveRequest({ ...state, ...numbers }, BAND_POINTS, range, true));
      } catch (refusal) {
        if (!(refusal instanceof Refusal)) throw refusal;
        return null;
      }
    });
    this.#showIntervals(state);
  }

  /** The bands of the curves, once found. */
  get bands() {
    return this.#bands;
  }

  #showIntervals(state) {
    const given = state.intervals;
    this.dropIntervals.hidden = !given;
    const names = given && Object.keys(given).map((key) => SOIL_FIELDS.find((field) => field.key === key).name.toLowerCase());
    const said = given
      ? outside(state, given) ?? `The bands hold 95 % of ${this.#bands?.draws ?? 64} soils drawn from the intervals of ${names.join(', ')}, each number by itself.`
      : this.intervalsProblem ?? '';
    this.intervalsProblem = given ? null : this.intervalsProblem;
    this.intervalsNote.textContent = said;
  }

  #showMarks() {
    for (const { chart, quantity } of this.#charts.values()) {
      const best = quantity.best ? this.#best[quantity.best] : null;
      chart.show({
        marks: best ? [{ x: best.slip, y: best[quantity.key] * quantity.scale, colour: 'var(--curve-1)', name: `maximum: ${shown(best[quantity.key] * quantity.scale)} ${quantity.unit} at slip ${shown(best.slip)}` }] : [],
      });
    }
    this.#showReadouts(this.#state, this.point);
    this.#showCautions(this.#state, this.point, this.curve);
  }

  #showControls(state) {
    for (const [key, control] of this.#controls) {
      const note = state.open.includes(key) ? 'not in the source: your number' : '';
      control.show(state[key], note);
    }
    const entry = this.#catalogue.get(state.soil);
    this.ownSoil.hidden = Boolean(entry);
    this.ownSoil.textContent = state.soil_name;
    this.soilChoice.value = entry ? state.soil : 'own';
    const own = entry ? numbersOf(entry, state).numbers : {};
    const edited = entry && SOIL_FIELDS.some(({ key }) => state[key] !== own[key] && !state.open.includes(key));
    this.resetSoil.hidden = !edited;
    this.source.textContent = entry
      ? `${edited ? 'Changed from: ' : 'Source: '}${entry.source}${entry.note ? ` (${entry.note})` : ''}`
      : 'Own soil';
    this.#showIntervals(state);
    this.massOnly.hidden = state.load_by !== 'mass';
    this.loadOnly.hidden = state.load_by === 'mass';
    for (const radio of this.element.querySelectorAll('[name="load-by"]')) radio.checked = radio.value === state.load_by;
    this.holdSlope.hidden = state.slope_deg === 0;
    this.pin.textContent = state.pinned ? 'Drop the pinned curve' : 'Pin this curve';
    const wheel = hasLugs(state) ? `${state.grouser_count} lugs` : 'smooth';
    this.heading.textContent = `Wheel of ${shown(state.radius_m * 1e3)} × ${shown(state.width_m * 1e3)} mm, ${wheel}, on ${state.soil_name.toLowerCase()}${edited ? ', changed' : ''}`;
  }

  #refused(refusal) {
    clearTimeout(this.#settled);
    this.element.classList.add('is-stale');
    const names = { radius: 'radius_m', width: 'width_m', load: 'load_n', weight: 'load_n', slope: 'slope_deg', slip_angle: 'slip_angle_deg', grouser_height: 'grouser_height_m', lug_count: 'grouser_count', lug_thickness: 'grouser_thickness_m' };
    const control = this.#controls.get(names[refusal.field] ?? refusal.field);
    control?.refuse(refusal.message);
    this.said = null;
    this.cautions.replaceChildren(h('li', { class: 'is-error' }, refusal.message));
    this.#requestedAt = null;
  }

  #showReadouts(state, point) {
    const solved = point.profile !== undefined;
    const item = (name, value, unit, note) => h('div', {}, h('dt', {}, name),
      h('dd', {}, h('span', { class: 'number' }, value), unit ? h('span', { class: 'unit' }, ` ${unit}`) : null, note ? h('span', { class: 'note' }, note) : null));
    const best = this.#best;
    const items = [
      item('Drawbar pull', solved ? shown(point.drawbar_pull_n) : '–', 'N', best.most_pull ? `most ${shown(best.most_pull.drawbar_pull_n)} at slip ${shown(best.most_pull.slip, 2)}` : 'pull left over to tow or climb'),
      item('Torque', solved ? shown(point.torque_nm) : '–', 'N m', solved && point.energy_j_per_m !== null ? `${shown(point.energy_j_per_m)} J per metre` : 'no travel'),
      item('Sinkage', solved ? shown(point.sinkage_m * 1e3) : '–', 'mm', solved ? `contact from ${shown(point.theta_2_deg)}° to ${shown(point.theta_1_deg)}°` : ''),
      item('Efficiency', solved && point.tractive_efficiency !== null ? shown(point.tractive_efficiency * 100) : 'none', solved && point.tractive_efficiency !== null ? '%' : '', best.most_efficient ? `most ${shown(100 * best.most_efficient.tractive_efficiency)} % at slip ${shown(best.most_efficient.slip, 2)}` : 'of the work, pulls'),
    ];
    if (state.slope_deg !== 0) {
      items.push(item('Slip on the slope', point.slip_demand === null || point.slip_demand === undefined ? 'none' : shown(point.slip_demand), '',
        point.slip_demand === null || point.slip_demand === undefined ? `${shown(point.slope_pull_n)} N needed, ${shown(point.max_pull_n)} N found` : `holds ${shown(point.slope_pull_n)} N downhill`));
    }
    if (state.slip_angle_deg !== 0) items.push(item('Side force', solved ? shown(point.side_force_n) : '–', 'N', 'to the left'));
    if (solved && point.pull_fluctuation_n !== undefined) items.push(item('Lugs in soil', shown(point.grousers_in_soil, 2), '', `pull varies by ${shown(point.pull_fluctuation_n, 2)} N`));
    this.readouts.replaceChildren(...items);
    this.peak.textContent = solved ? `peak σ ${shown(Math.max(...point.profile.normal_stress_pa) / 1e3)} kPa` : '';
  }

  #showCautions(state, point, curve) {
    const items = [];
    if (point.status === 'no-solution') items.push(h('li', { class: 'is-error' }, `No sinkage carries this load; the most that was found to be carried is ${shown(point.max_load_n)} N.`));
    else if (point.status === 'not-converged') items.push(h('li', { class: 'is-error' }, 'The search for the sinkage did not converge.'));
    if (state.slope_deg !== 0 && (point.slip_demand === null || point.slip_demand === undefined)) {
      items.push(h('li', { class: 'is-error' }, `No slip holds the slope of ${shown(state.slope_deg)}°.`));
    }
    const here = new Set();
    for (const caution of point.cautions ?? []) {
      here.add(caution.key);
      items.push(h('li', {}, sentence(caution.text)));
    }
    if ((this.#best.most_pull?.slip ?? 0) >= SPINNING_SLIP) {
      items.push(h('li', { class: 'is-faint' }, 'The most pull is at slip 1, where the laws do not hold: they do not count the thrust that disturbed soil loses.'));
    }
    const elsewhere = curve.cautions.filter(({ key }) => !here.has(key));
    for (const caution of elsewhere) items.push(h('li', { class: 'is-faint' }, `At other slips (${caution.points} of ${curve.slip.length} points): ${caution.text}.`));
    if (state.open.length) items.push(h('li', {}, `The source of this soil does not give ${state.open.map((key) => ({ k_shear_m: 'K', c_1: 'c₁', c_2: 'c₂' })[key]).join(', ')}: the numbers used are yours, not the soil’s.`));
    const said = items.map((item) => item.textContent).join('|');
    if (said === this.said) return;
    this.said = said;
    this.cautions.replaceChildren(...items);
  }

  #showCurves(state, point, curves) {
    const range = this.#range(state);
    for (const { chart, quantity } of this.#charts.values()) {
      const scale = (values) => values.map((value) => (value === null ? null : value * quantity.scale));
      const series = curves.map(({ name, curve, look, ghost }) => ({
        name, x: curve.slip, y: scale(curve[quantity.key]), ...look, ghost, width: ghost ? 1.5 : 2.25,
      }));
      const band = this.#bands?.[quantity.key];
      if (band) {
        series.unshift({
          name: '95 % of the soils', x: this.#bands.slip, y: this.#bands.slip.map(() => null), colour: CURVES[0].colour,
          band: { low: scale(band.low), high: scale(band.high) }, silent: true,
        });
      }
      const measured = this.#measured?.[quantity.key];
      if (measured) series.push({ points: true, x: this.#measured.slip, y: scale(measured), colour: 'currentColor' });
      const levels = quantity.key === 'drawbar_pull_n' && state.slope_deg !== 0
        ? [{ y: point.slope_pull_n, name: `needed on ${shown(state.slope_deg)}°` }] : [];
      chart.show({ series, range, levels, cursor: state.slip, ...(this.#best.known ? {} : { marks: [] }) });
    }
    const chip = ({ key, name, look, ghost, open }) => h('span', { class: 'chip', title: open?.length ? 'K, c₁ or c₂ are those of the sliders: the source does not give them' : null },
      svg('svg', { width: 26, height: 8, 'aria-hidden': 'true' }, svg('line', { x1: 0, x2: 26, y1: 4, y2: 4, stroke: look.colour, 'stroke-width': ghost ? 1.5 : 2.5, 'stroke-dasharray': look.dash })),
      `${name}${open?.length ? ' *' : ''}`,
      key ? h('button', { type: 'button', 'aria-label': `Drop ${name}`, on: { click: () => this.#set({ compare: this.#state.compare.filter((one) => one !== key) }) } }, '×') : null);
    this.chips.replaceChildren(...(curves.length > 1 ? curves.map(chip) : []));
  }
}

function sentence(text) {
  return `${text[0].toUpperCase()}${text.slice(1)}.`;
}
