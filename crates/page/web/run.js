// Run: a drive in the page, or a recorded log, under one cursor of time.

import { Chart, plotWidth } from './chart.js';
import { h, svg } from './dom.js';
import { factsOf, notesOf } from './facts.js';
import { clock, shown } from './format.js';
import { CURVES } from './palette.js';
import { withFile } from './opening.js';
import { Refusal, blockBytes, hasModule } from './physics.js';
import { decisionList, drivesTable, energyTable, grouped, readReport, sources, stateList } from './report.js';
import { GrowingRun, follow, readPart } from './growth.js';
import { BadFile, common, inColumns, masked, nameAt, placeOf, runOfEstimates, spansOf, thinned, valuesAt } from './run_data.js';
import { RobotView } from './robot_view.js';
import { SLIP_CLASSES } from './slip_classes.js';
import { Track } from './track.js';

const NO_REFERENCE = /ReferenceLost|Relative/;
/** A run that grows is drawn anew after this time, ms; one from a live source sooner. */
const REDRAW_MS = { file: 600, live: 150 };

/** The view; `drive` simulates, `log` reads recorded logs. */
export class Run {
  #drive;
  #log;
  #files = {};
  #run = null;
  #others = [];
  #report = null;
  #wheels = [];
  #slips = [];
  #hidden = new Set();
  #range = [0, 1];
  #time = 0;
  #playing = null;
  #examples = null;
  #redraw = null;
  #isFollowing = false;

  constructor(drive, log, report = null) {
    this.#drive = drive;
    this.#log = log;
    this.element = this.#build();
    this.timings = {};
    this.#report = report;
  }

  /** Nothing of a run is in the address: a log never leaves the machine. */
  open() {
    if (this.#report) {
      if (!this.#run) this.#showReport();
      return;
    }
    const { file, run } = document.getElementById('main').dataset;
    if (run) {
      if (!this.#run) this.#followServer(run === 'live');
      return;
    }
    if (file && !this.#run) {
      fetch('api/file').then((response) => response.blob()).then((blob) => this.#take([new File([blob], file)]));
      return;
    }
    const embedded = document.getElementById('embedded');
    if (embedded && !this.#run) {
      blockBytes(embedded).then((bytes) => this.#take([new File([bytes], embedded.dataset.name)]));
    }
  }

  /** The run that is shown. */
  get run() {
    return this.#run;
  }

  // ---- building -----------------------------------------------------------------------------

  #build() {
    this.input = h('input', { type: 'file', multiple: true, id: 'run-files', class: 'sr-only', on: { change: () => this.#take([...this.input.files]) } });
    this.exampleButton = h('button', { type: 'button', class: 'primary', on: { click: () => this.#example('sandbox', 'controller') } }, 'Drive the sandbox');
    this.exampleChoice = h('select', { 'aria-label': 'Another scenario', on: { change: () => this.#chooseExample() } },
      h('option', { value: '' }, 'another scenario'),
      ['sandbox', 'soft-patch', 'slope'].map((name) => h('optgroup', { label: name },
        ['controller', 'fixed-slip', 'open-loop'].map((pilot) => h('option', { value: `${name} ${pilot}` }, `${name}, ${pilot}`)))));
    this.status = h('p', { class: 'run-status', role: 'status' });
    this.stopButton = h('button', { type: 'button', class: 'quiet', hidden: true, on: { click: () => Promise.all([this.#drive.stop(), this.#log.stop()]) } }, 'Stop');
    this.robotView = new RobotView();
    this.empty = h('section', { class: 'card drop' },
      h('h2', {}, 'A run under one cursor of time'),
      h('p', {}, 'Drop files here: a robot’s log (CSV, MCAP, ROS 1 bag) with its robot file and column map, the table of ', h('code', {}, 'grouser estimate -o'), ', or a scenario with its robot file. They stay on this machine.'));
    this.files = h('p', { class: 'muted file-list' });
    this.body = h('div', { class: 'run-body', hidden: true }, this.#player(), h('div', { class: 'run-grid' }, h('div', { class: 'run-side' }, this.#mapCard(), this.#factsCard()), h('div', { class: 'run-side' }, this.#slipCard(), this.robotView.element)), this.#more());
    this.exampleButton.hidden = !hasModule('drive');
    this.exampleChoice.hidden = !hasModule('drive');
    this.drives = h('div', { hidden: true });
    this.provenance = h('div', {});
    const view = h('div', { class: 'run' },
      h('div', { class: 'run-tools', hidden: !hasModule('explore') },
        h('label', { class: 'quiet button', for: 'run-files' }, 'Open files'), this.input, this.exampleButton, this.exampleChoice, this.stopButton, this.status),
      this.files, this.empty, this.drives, this.body, this.provenance);
    for (const event of ['dragover', 'drop']) {
      view.addEventListener(event, (drag) => {
        drag.preventDefault();
        view.classList.toggle('is-over', event === 'dragover');
        if (event === 'drop') this.#take([...drag.dataTransfer.files]);
      });
    }
    view.addEventListener('dragleave', () => view.classList.remove('is-over'));
    return view;
  }

  #player() {
    this.playButton = h('button', { type: 'button', class: 'primary play', 'aria-label': 'Play', on: { click: () => this.#play() } }, '▶');
    this.rate = h('select', { 'aria-label': 'Speed of playing' }, [1, 4, 16, 64].map((rate) => h('option', { value: rate, selected: rate === 4 }, `${rate}×`)));
    this.scrub = h('input', { type: 'range', 'aria-label': 'Time', step: 'any', on: { input: () => this.#choose(Number(this.scrub.value)) } });
    this.now = h('output', { class: 'now' });
    this.zoom = h('select', { 'aria-label': 'Time shown', on: { change: () => this.#zoomTo() } },
      [['', 'whole run'], ['120', '2 min'], ['30', '30 s'], ['10', '10 s']].map(([value, text]) => h('option', { value }, text)));
    this.liveButton = h('button', { type: 'button', class: 'quiet', hidden: true, 'aria-pressed': 'false', on: { click: () => this.#setFollowing(!this.#isFollowing) } }, 'Live');
    return h('div', { class: 'card player' }, this.playButton, this.scrub, this.now, this.liveButton, this.rate, this.zoom);
  }

  #mapCard() {
    this.place = h('output', { class: 'muted place' });
    this.track = new Track((time) => this.#choose(time), (under) => {
      this.place.textContent = under ? `x ${shown(under.x)} m, y ${shown(under.y)} m, height ${shown(under.height)} m, ${under.soil}` : this.#soils();
    });
    const names = ['0', ...SLIP_CLASSES.slice(0, -1).map(String)];
    const key = SLIP_CLASSES.map((limit, i) => h('span', { class: `slip-key slip-key-${i}` }, i === SLIP_CLASSES.length - 1 ? `over ${names[i]}` : `to ${limit}`));
    this.mapCard = h('section', { class: 'card map', 'aria-label': 'Way of the robot' },
      h('header', {}, h('h2', {}, 'Way, coloured by slip'), this.modeBadge = h('span', { class: 'badge' })), this.track.element,
      h('p', { class: 'key' }, h('span', { class: 'plain' }, 'greatest slip of the wheels:'), key), this.place);
    return this.mapCard;
  }

  /** The soils of the ground in words. */
  #soils() {
    const soils = this.#run?.ground?.soils ?? [];
    const ground = soils.length > 1 ? `ground: ${soils[0]}; tinted: ${soils.slice(1).join(', ')}` : soils.length ? `ground: ${soils[0]}` : '';
    const drivers = this.#others.map(({ controller }) => controller).filter(Boolean);
    return [ground, drivers.length ? `grey: the way of ${drivers.join(', ')}` : ''].filter(Boolean).join('; ');
  }

  #slipCard() {
    this.slipChart = new Chart({
      title: 'Slip of each wheel', height: 340, x: { name: 'Time', unit: 's' }, y: { name: 'Slip', unit: '' }, ...this.#pointing(),
    });
    this.table = h('table', { class: 'wheels' });
    this.slipChart.element.append(
      h('p', { class: 'key' }, h('span', { class: 'key-band' }, 'band: one sigma'), h('span', { class: 'key-rest' }, 'at rest: no slip'), h('span', { class: 'key-lost' }, 'nothing measures the speed'), this.todoKey = h('span', { class: 'key-todo' }, 'not estimated yet')),
      this.table);
    return this.slipChart.element;
  }

  #factsCard() {
    this.facts = h('dl', { class: 'readouts' });
    this.notes = h('ul', { class: 'cautions' });
    this.books = h('div', {});
    return h('section', { class: 'card facts', 'aria-label': 'Result' }, this.facts, this.notes, this.books);
  }

  #more() {
    this.speedChart = new Chart({ title: 'Forward speed', x: { name: 'Time', unit: 's' }, y: { name: 'Speed', unit: 'm/s' }, ...this.#pointing(), value: valueOf });
    this.rimChart = new Chart({ title: 'Rim speed of each wheel, as logged', x: { name: 'Time', unit: 's' }, y: { name: 'Speed', unit: 'm/s' }, ...this.#pointing(), value: valueOf });
    this.torqueChart = new Chart({ title: 'Torque of each motor', x: { name: 'Time', unit: 's' }, y: { name: 'Torque', unit: 'N m' }, ...this.#pointing(), value: valueOf });
    this.energyChart = new Chart({ title: 'Electrical energy used', x: { name: 'Time', unit: 's' }, y: { name: 'Energy', unit: 'J' }, zero: true, ...this.#pointing(), value: valueOf });
    this.decisions = h('section', { class: 'card decisions', 'aria-label': 'Decisions and states' });
    this.multiples = h('div', { class: 'charts' });
    this.multiplesButton = h('button', { type: 'button', class: 'quiet multiples-button', 'aria-expanded': 'false', on: { click: () => this.#toggleMultiples() } }, 'One chart for each wheel');
    this.many = [];
    return h('div', { class: 'run-more' }, h('div', { class: 'charts' }, this.rimChart.element, this.speedChart.element, this.torqueChart.element, this.energyChart.element), this.decisions, h('div', {}, this.multiplesButton), this.multiples);
  }

  /** What charts over time do at a click, and where the pointer is: values there, in all of them. */
  #pointing() {
    return {
      pick: (time) => this.#choose(time),
      hover: (time) => {
        for (const chart of this.#charts()) chart.point(time);
        this.#showValues(time ?? this.#time);
      },
    };
  }

  #charts() {
    return [this.slipChart, this.rimChart, this.speedChart, this.torqueChart, this.energyChart, ...this.many];
  }

  // ---- opening ------------------------------------------------------------------------------

  async #take(files) {
    this.input.value = '';
    try {
      for (const file of files) this.#files = await withFile(this.#files, file);
      this.files.textContent = Object.entries(this.#files).map(([kind, { name }]) => `${kind}: ${name}`).join(' · ');
      await this.#go();
    } catch (error) {
      if (!(error instanceof BadFile) && !(error instanceof Refusal)) throw error;
      this.#say(error.message, true);
    }
  }

  async #go() {
    const { table, log, robot, columns, scenario, report } = this.#files;
    const started = performance.now();
    if (report) {
      this.#report = readReport(report.text, report.name);
      this.#files = {};
      this.#showReport();
      return;
    }
    if (!table && !hasModule('log')) {
      this.#say('this page has a run in it and opens tables of grouser estimate -o only: export a page without a run for logs and drives', true);
      return;
    }
    if (table) {
      this.show(runOfEstimates(table.text, table.name));
      delete this.#files.table;
    } else if (log && robot) {
      await this.#estimate(log, { call: 'estimate', log_name: log.name, robot: robot.text, columns: columns?.text ?? null });
      delete this.#files.log;
    } else if (scenario && robot) {
      await this.#compute(`driving ${scenario.name}`, { call: 'drive', name: scenario.name.replace(/\.toml$/, ''), scenario: scenario.text, robot: robot.text, pilot: 'controller' });
      delete this.#files.scenario;
    } else {
      const wants = log ? `${log.name}: the robot file (TOML) that describes its wheels and sensors is needed too` : scenario ? `${scenario.name}: the robot file that it names is needed too` : 'a log or a scenario is needed too';
      this.#say(wants);
      return;
    }
    this.timings.open = performance.now() - started;
  }

  async #example(name, pilot) {
    try {
      this.#say('loading');
      this.#examples ??= (await this.#drive.ask({ call: 'examples' })).examples;
      const example = this.#examples.find((one) => one.name === name);
      await this.#compute(`driving ${name}, ${pilot}`, { call: 'drive', name, scenario: example.scenario, robot: example.robot, pilot });
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.#say(error.message, true);
    }
  }

  #chooseExample() {
    const [name, pilot] = this.exampleChoice.value.split(' ');
    this.exampleChoice.value = '';
    if (name) this.#example(name, pilot);
  }

  async #compute(what, request) {
    this.#say(`${what} …`);
    this.stopButton.hidden = false;
    const started = performance.now();
    try {
      const run = await this.#drive.ask(request);
      const seconds = (performance.now() - started) / 1e3;
      const before = this.#run;
      // two drivers of one scenario lie on one map
      this.show(run, before?.kind === 'drive' && run.kind === 'drive' && before.title === run.title && before.controller !== run.controller ? [before] : []);
      this.timings.compute = seconds;
      this.#say(`${clock(run.duration_s)} driven in ${shown(seconds, 2)} s`);
    } finally {
      this.stopButton.hidden = true;
    }
  }

  /** A log through the estimator beside the page: its rim speeds at once, its slips as they are found. */
  async #estimate({ name, file }, request) {
    this.#say(`reading ${name} …`);
    this.stopButton.hidden = false;
    const started = performance.now();
    const growing = new GrowingRun();
    const take = (part) => {
      growing.add(readPart(part));
      if (growing.run.overview && this.#run !== growing.run) {
        this.#showGrowing(growing.run);
        this.timings.overview = performance.now() - started;
      }
      this.#grown(() => `estimated to ${clock(growing.run.time_s.at(-1) ?? 0)} of ${clock(growing.run.end_s)}; what is there can be looked at`);
    };
    try {
      const end = await this.#log.ask(request, { file: await file.arrayBuffer(), take });
      this.#ended(growing, end);
      this.timings.compute = (performance.now() - started) / 1e3;
      this.#say(`${clock(growing.run.time_s.at(-1) - growing.run.time_s[0])} estimated in ${shown(this.timings.compute, 2)} s`);
    } finally {
      this.stopButton.hidden = true;
      clearTimeout(this.#redraw);
      this.#redraw = null;
    }
  }

  /** The run that the server reads, from its beginning to now and on. */
  async #followServer(isLive) {
    const growing = new GrowingRun();
    this.#say('waiting for the first measurements …');
    const take = (parts, lost) => {
      for (const part of parts) {
        if (part.head.failed) throw new Refusal({ field: null, message: part.head.failed });
        if (part.head.end) {
          this.#ended(growing, part.head.end);
          this.#say('the run has ended');
        } else growing.add(part);
      }
      const { run } = growing;
      if (!run || (!run.time_s.length && !run.overview)) return;
      run.is_live = isLive;
      if (this.#run !== run) this.#showGrowing(run);
      if (run.is_growing) this.#grown(() => `${isLive ? 'live' : 'estimated'} to ${clock(run.time_s.at(-1) ?? 0)}${lost ? '; what is older than the server keeps is not shown' : ''}`);
    };
    try {
      await follow(take, new AbortController().signal);
    } catch (error) {
      this.#say(error instanceof Refusal ? error.message : `the server cannot be reached any more: ${error.message}`, true);
    }
  }

  #say(text, bad = false) {
    this.status.textContent = text;
    this.status.classList.toggle('is-error', bad);
  }

  // ---- showing ------------------------------------------------------------------------------

  /** Shows a report: its runs, the controller's first, and what stands beside them. */
  #showReport() {
    const { runs, drives, provenance, sources: more, note } = this.#report;
    const shownRun = (i) => this.show(runs[i], runs.filter((_, k) => k !== i));
    this.drives.hidden = !drives || drives.length < 2;
    if (drives) this.drives.replaceChildren(drivesTable(this.#report, shownRun));
    this.provenance.replaceChildren(...[sources([...(provenance ?? []), ...(more ?? [])], note)].filter(Boolean));
    shownRun(Math.max(0, runs.findIndex(({ controller }) => controller === 'controller')));
  }

  /** Shows a run, with others of the same ground in grey. */
  show(run, others = []) {
    this.#others = others.map(inColumns);
    this.#begin(inColumns(run));
    this.#seek(this.#start());
  }

  #begin(run) {
    this.#run = run;
    this.#pause();
    this.#isFollowing = false;
    this.#hidden.clear();
    this.zoom.value = '';
    this.#range = [this.#start(), this.#end()];
    this.#time = this.#start();
    this.empty.hidden = true;
    this.body.hidden = false;
    this.#derive();
    this.#showTable();
    this.#showDecisions(run);
    this.#draw();
  }

  /** The times between which the cursor moves. */
  #start() {
    return this.#run.time_s[0] ?? 0;
  }

  #end() {
    return Math.max(this.#run.end_s ?? 0, this.#run.time_s.at(-1) ?? 0);
  }

  /** What follows from the run's columns. */
  #derive() {
    const run = this.#run;
    this.#wheels = run.wheels.map((wheel, i) => ({ ...wheel, shown: masked(run, wheel), look: CURVES[i % CURVES.length] }));
    this.#slips = new Float64Array(run.time_s.length).fill(NaN);
    for (const { shown: { slip } } of this.#wheels) {
      for (let i = 0; i < slip.length; i += 1) if (slip[i] === slip[i] && !(Math.abs(slip[i]) <= Math.abs(this.#slips[i]))) this.#slips[i] = slip[i];
    }
    const end = run.time_s.at(-1) ?? 0;
    Object.assign(this.scrub, { min: this.#start(), max: this.#end() });
    this.liveButton.hidden = !run.is_live;
    const hasWay = run.x_m?.some((value) => value === value) ?? false;
    this.mapCard.hidden = !hasWay;
    this.body.classList.toggle('has-way', hasWay);
    const powered = this.#wheels.filter((wheel) => !wheel.is_reference && wheel.slip.some((slip) => slip === slip));
    const counted = powered.length ? powered : this.#wheels;
    this.rests = common(counted.map((wheel) => spansOf(wheel.motion ?? [], end, (name) => name === 'Standstill')));
    this.lost = common(counted.map((wheel) => spansOf(wheel.health ?? [], end, (name) => NO_REFERENCE.test(name))));
    if (hasWay) this.track.show(run, this.#slips, this.#events(run), this.#others);
    this.robotView.show(run);
    this.place.textContent = this.#soils();
    this.#showFacts(run);
  }

  #showGrowing(run) {
    this.#others = [];
    this.#begin(run);
    if (run.is_live) this.#setFollowing(true);
    else this.#seek(this.#start());
  }

  /** The run has grown: drawn anew after a while, with all that came meanwhile. */
  #grown(words) {
    this.#redraw ??= setTimeout(() => {
      this.#redraw = null;
      if (!this.#run?.is_growing) return;
      this.#say(words());
      // a reader who chose a time keeps the picture
      if (this.#run.is_live && !this.#isFollowing) return;
      this.#refresh();
    }, REDRAW_MS[this.#run?.is_live ? 'live' : 'file']);
  }

  #refresh() {
    this.#derive();
    if (this.#isFollowing) {
      this.#time = this.#end();
      this.#fitRange();
    }
    this.#draw();
    this.#seek(this.#time);
  }

  #ended(growing, end) {
    growing.end(end);
    if (this.#run !== growing.run) this.#showGrowing(growing.run);
    this.#isFollowing = false;
    this.liveButton.hidden = true;
    this.#refresh();
  }

  /** Does the cursor stay at the newest moment? */
  #setFollowing(on) {
    this.#isFollowing = on;
    this.liveButton.setAttribute('aria-pressed', String(on));
    if (on) {
      this.#pause();
      this.#refresh();
    }
  }

  /** The reader chose a time: the picture stays. */
  #choose(time) {
    this.#setFollowing(false);
    this.#seek(time);
  }

  #events(run) {
    return grouped(run.decisions ?? []).map(({ time_s, action, reason, x_m, y_m, number }) => ({ x_m, y_m, number, name: `${clock(time_s, 1)} ${action}: ${reason}` }));
  }

  #series(wheel, range, pixels) {
    const { slip, sigma, true_slip } = wheel.shown;
    const places = thinned(this.#run.time_s, slip, range, pixels);
    const [x, y, spread] = [this.#run.time_s, slip, sigma].map((values) => valuesAt(values, places));
    const band = { low: y.map((value, i) => value - spread[i]), high: y.map((value, i) => value + spread[i]) };
    const series = [{ name: wheel.name, x, y, colour: wheel.look.colour, dash: null, width: 1.6, band }];
    if (true_slip) series.push({ name: `${wheel.name}, true`, x, y: valuesAt(true_slip, places), colour: wheel.look.colour, dash: '2 3', width: 1.2, ghost: true });
    return series;
  }

  #draw() {
    const run = this.#run;
    const range = this.#range;
    const spans = [...this.rests.map(([from, to]) => ({ from, to, kind: 'rest' })), ...this.lost.map(([from, to]) => ({ from, to, kind: 'lost' }))];
    if (run.end_s) spans.push({ from: run.time_s.at(-1) ?? 0, to: run.end_s, kind: 'todo' });
    this.todoKey.hidden = !run.end_s;
    const pixels = plotWidth(this.slipChart);
    const visible = this.#wheels.filter(({ name }) => !this.#hidden.has(name));
    const cursor = this.#time;
    this.slipChart.show({ range, spans, cursor, series: visible.flatMap((wheel) => this.#series(wheel, range, pixels)) });
    const line = (times, values, look) => {
      const places = thinned(times, values, range, pixels);
      return { x: valuesAt(times, places), y: valuesAt(values, places), width: 1.6, ...look };
    };
    const columns = (list) => list.filter(([, column]) => column).map(([name, column, look]) => line(run.time_s, column, { name, ...look }));
    this.rimChart.element.hidden = !run.overview;
    if (run.overview) {
      this.rimChart.show({ range, spans: [], cursor, series: visible.map(({ name, look }) => line(run.overview.time_s, run.overview.rims[this.#wheels.findIndex((wheel) => wheel.name === name)], { name, colour: look.colour })) });
    }
    this.speedChart.element.hidden = !run.speed_m_per_s;
    if (run.speed_m_per_s) {
      this.speedChart.show({ range, spans, cursor, series: columns([
        [run.kind === 'drive' ? 'true' : 'estimated', run.speed_m_per_s, CURVES[0]],
        ['estimated', run.estimated_speed_m_per_s, CURVES[1]],
        ['requested', run.requested_speed_m_per_s, { colour: 'var(--muted)', dash: '2 3' }],
      ]) });
    }
    const turned = visible.filter(({ torque_nm: torque }) => torque?.some((value) => value));
    this.torqueChart.element.hidden = !turned.length;
    if (turned.length) this.torqueChart.show({ range, spans: [], cursor, series: columns(turned.map(({ name, torque_nm: torque, look }) => [name, torque, { colour: look.colour }])) });
    this.energyChart.element.hidden = !run.used_energy_j;
    if (run.used_energy_j) {
      const ghosts = this.#others.map((other) => line(other.time_s, other.used_energy_j, { name: other.controller, colour: 'var(--muted)', dash: '3 3', width: 1.3, ghost: true }));
      this.energyChart.show({ range, spans: [], cursor, series: [...columns([[run.controller ?? 'used', run.used_energy_j, { colour: CURVES[2].colour }]]), ...ghosts] });
    }
    this.many.forEach((chart, i) => chart.show({ range, spans, cursor, series: this.#series(this.#wheels[i], range, pixels / 2) }));
  }

  #toggleMultiples() {
    const open = this.many.length === 0;
    this.multiplesButton.setAttribute('aria-expanded', String(open));
    this.many = open ? this.#wheels.map(({ name }) => new Chart({ title: name, height: 180, x: { name: 'Time', unit: 's' }, y: { name: 'Slip', unit: '' }, ...this.#pointing(), value: (one, value) => valueOf({ ...one, name: one.ghost ? 'true' : 'estimated' }, value) })) : [];
    this.multiples.replaceChildren(...this.many.map((chart) => chart.element));
    if (open) this.#draw();
  }

  #showTable() {
    const truth = this.#wheels.some((wheel) => wheel.true_slip?.length);
    this.cells = this.#wheels.map((wheel) => ({ slip: h('td', { class: 'number' }), truth: h('td', { class: 'number' }), motion: h('td', { class: 'state' }), health: h('td', { class: 'state' }) }));
    const rows = this.#wheels.map((wheel, i) => {
      const box = h('input', { type: 'checkbox', checked: true, 'aria-label': `Show ${wheel.name}`, on: { change: () => {
        if (box.checked) this.#hidden.delete(wheel.name);
        else this.#hidden.add(wheel.name);
        this.#draw();
      } } });
      const { slip, truth: real, motion, health } = this.cells[i];
      return h('tr', {}, h('th', { scope: 'row' }, h('label', {}, box, svg('svg', { width: 18, height: 8, 'aria-hidden': 'true' }, svg('line', { x1: 0, x2: 18, y1: 4, y2: 4, stroke: wheel.look.colour, 'stroke-width': 3 })), wheel.name)), slip, truth ? real : null, motion, health);
    });
    this.table.replaceChildren(
      h('caption', { class: 'sr-only' }, 'Wheels at the cursor’s time'),
      h('thead', {}, h('tr', {}, ['wheel', 'slip ± sigma', ...(truth ? ['true slip'] : []), 'motion', 'health'].map((name) => h('th', { scope: 'col' }, name)))),
      h('tbody', {}, rows));
    this.truth = truth;
  }

  #showFacts(run) {
    this.facts.replaceChildren(...factsOf(run, this.#others, this.#end() - this.#start()));
    this.books.replaceChildren(...[energyTable(run)].filter(Boolean));
    this.notes.replaceChildren(...notesOf(run));
  }

  #showDecisions(run) {
    const seek = (time) => this.#seek(time);
    const decisions = run.decisions?.length ? [h('h2', {}, `Decisions of the ${run.controller}`), ...decisionList(run, seek)] : [];
    const states = run.mode?.length ? [h('h2', {}, `States of the ${run.controller}`), stateList(run, seek)] : [];
    this.decisions.hidden = !decisions.length && !states.length;
    this.decisions.replaceChildren(...[...decisions, ...states].filter(Boolean));
  }

  // ---- time ---------------------------------------------------------------------------------

  /** The last moment that is not after a time; −1 where the run has none yet. */
  #index(time) {
    const times = this.#run.time_s;
    const next = placeOf(times, time);
    const index = times[next] === time ? next : next - 1;
    // what is not estimated yet is not the last moment's
    return this.#run.is_growing && time > times.at(-1) + 1 ? -1 : index;
  }

  #seek(time) {
    const run = this.#run;
    const [start, end] = [this.#start(), this.#end()];
    this.#time = Math.min(end, Math.max(start, time));
    const index = this.#index(this.#time);
    this.scrub.value = this.#time;
    this.scrub.style.setProperty('--share', `${((100 * (this.#time - start)) / (end - start || 1)).toFixed(2)}%`);
    this.scrub.setAttribute('aria-valuetext', `${shown(this.#time, 4)} s`);
    this.now.textContent = `${clock(this.#time, 1)} / ${clock(end)}`;
    if (this.zoom.value && (this.#time < this.#range[0] || this.#time > this.#range[1])) {
      this.#zoomTo();
      return;
    }
    this.track.cursor(index);
    this.robotView.cursor(index);
    for (const chart of this.#charts()) chart.cursor(this.#time);
    this.#showValues(this.#time);
    const mode = run.mode ? nameAt(run.mode, this.#time) : '';
    this.modeBadge.hidden = !mode;
    this.modeBadge.textContent = mode;
  }

  /** The wheels' values at a time. */
  #showValues(time) {
    const index = this.#index(time);
    this.#wheels.forEach((wheel, i) => {
      const { slip, truth, motion, health } = this.cells[i];
      const value = wheel.shown.slip[index];
      const sigma = wheel.shown.sigma[index];
      slip.textContent = Number.isFinite(value) ? `${value.toFixed(3).replace('-', '−')}${Number.isFinite(sigma) ? ` ± ${sigma.toFixed(3)}` : ''}` : '–';
      if (this.truth) truth.textContent = Number.isFinite(wheel.true_slip[index]) ? wheel.true_slip[index].toFixed(3).replace('-', '−') : '–';
      motion.textContent = (index >= 0 && nameAt(wheel.motion ?? [], time)) || '–';
      health.textContent = (index >= 0 && nameAt(wheel.health ?? [], time)) || '–';
    });
  }

  #fitRange() {
    const [start, end, width] = [this.#start(), this.#end(), Number(this.zoom.value)];
    const from = width ? Math.max(start, Math.min(this.#time - 0.2 * width, end - width)) : start;
    this.#range = [from, width ? Math.min(end, from + width) : end];
  }

  #zoomTo() {
    this.#fitRange();
    this.#draw();
    this.#seek(this.#time);
  }

  #play() {
    if (this.#playing) {
      this.#pause();
      return;
    }
    this.#setFollowing(false);
    if (this.#time >= this.#end()) this.#seek(this.#start());
    this.playButton.textContent = '❚❚';
    this.playButton.setAttribute('aria-label', 'Pause');
    let last = performance.now();
    const frame = (now) => {
      this.#seek(this.#time + ((now - last) / 1e3) * Number(this.rate.value));
      last = now;
      if (this.#time >= this.#end()) this.#pause();
      else this.#playing = requestAnimationFrame(frame);
    };
    this.#playing = requestAnimationFrame(frame);
  }

  #pause() {
    cancelAnimationFrame(this.#playing);
    this.#playing = null;
    this.playButton.textContent = '▶';
    this.playButton.setAttribute('aria-label', 'Play');
  }
}

function valueOf(one, value) {
  return h('span', { class: one.ghost ? 'value ghost' : 'value', style: { color: one.colour } }, `${one.name} ${value === null ? '–' : shown(value)}`);
}
