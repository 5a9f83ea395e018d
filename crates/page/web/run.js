// Run: a drive in the page, or a recorded log, under one cursor of time.

import { Chart, plotWidth } from './chart.js';
import { h, svg } from './dom.js';
import { clock, shown } from './format.js';
import { CURVES } from './palette.js';
import { Refusal, blockBytes, hasModule } from './physics.js';
import { decisionList, drivesTable, energyTable, grouped, readReport, sources } from './report.js';
import { BadFile, common, isEstimates, masked, nameAt, runOfEstimates, spansOf, thinned } from './run_data.js';
import { SLIP_CLASSES, Track } from './track.js';

const NO_REFERENCE = /ReferenceLost|Relative/;
/** Largest log that the page reads, bytes. */
const MAX_LOG_BYTES = 192 * 1024 * 1024;

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
    const { file } = document.getElementById('main').dataset;
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
    this.empty = h('section', { class: 'card drop' },
      h('h2', {}, 'A run under one cursor of time'),
      h('p', {}, 'Drop files here: a robot’s log (CSV, MCAP, ROS 1 bag) with its robot file and column map, the table of ', h('code', {}, 'grouser estimate -o'), ', or a scenario with its robot file. They stay on this machine.'));
    this.files = h('p', { class: 'muted file-list' });
    this.body = h('div', { class: 'run-body', hidden: true }, this.#player(), h('div', { class: 'run-grid' }, h('div', { class: 'run-side' }, this.#mapCard(), this.#factsCard()), this.#slipCard()), this.#more());
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
    this.scrub = h('input', { type: 'range', 'aria-label': 'Time', step: 'any', on: { input: () => this.#seek(Number(this.scrub.value)) } });
    this.now = h('output', { class: 'now' });
    this.zoom = h('select', { 'aria-label': 'Time shown', on: { change: () => this.#zoomTo() } },
      [['', 'whole run'], ['120', '2 min'], ['30', '30 s'], ['10', '10 s']].map(([value, text]) => h('option', { value }, text)));
    return h('div', { class: 'card player' }, this.playButton, this.scrub, this.now, this.rate, this.zoom);
  }

  #mapCard() {
    this.place = h('output', { class: 'muted place' });
    this.track = new Track((time) => this.#seek(time), (under) => {
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
    return soils.length > 1 ? `ground: ${soils[0]}; tinted: ${soils.slice(1).join(', ')}` : soils.length ? `ground: ${soils[0]}` : '';
  }

  #slipCard() {
    this.slipChart = new Chart({
      title: 'Slip of each wheel', height: 340, x: { name: 'Time', unit: 's' }, y: { name: 'Slip', unit: '' },
      pick: (time) => this.#seek(time),
    });
    this.table = h('table', { class: 'wheels' });
    this.slipChart.element.append(
      h('p', { class: 'key' }, h('span', { class: 'key-band' }, 'band: one sigma'), h('span', { class: 'key-rest' }, 'at rest: no slip'), h('span', { class: 'key-lost' }, 'nothing measures the speed')),
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
    this.speedChart = new Chart({ title: 'Forward speed', x: { name: 'Time', unit: 's' }, y: { name: 'Speed', unit: 'm/s' }, pick: (time) => this.#seek(time), value: valueOf });
    this.torqueChart = new Chart({ title: 'Torque of each motor', x: { name: 'Time', unit: 's' }, y: { name: 'Torque', unit: 'N m' }, pick: (time) => this.#seek(time) });
    this.energyChart = new Chart({ title: 'Electrical energy used', x: { name: 'Time', unit: 's' }, y: { name: 'Energy', unit: 'J' }, zero: true, pick: (time) => this.#seek(time), value: valueOf });
    this.decisions = h('section', { class: 'card decisions', 'aria-label': 'Decisions' });
    this.multiples = h('div', { class: 'charts' });
    this.multiplesButton = h('button', { type: 'button', class: 'quiet', 'aria-expanded': 'false', on: { click: () => this.#toggleMultiples() } }, 'One chart for each wheel');
    this.many = [];
    return h('div', { class: 'run-more' }, h('div', { class: 'charts' }, this.speedChart.element, this.torqueChart.element, this.energyChart.element), this.decisions, h('div', {}, this.multiplesButton), this.multiples);
  }

  // ---- opening ------------------------------------------------------------------------------

  async #take(files) {
    this.input.value = '';
    try {
      for (const file of files) await this.#sort(file);
      this.files.textContent = Object.entries(this.#files).map(([kind, { name }]) => `${kind}: ${name}`).join(' · ');
      await this.#go();
    } catch (error) {
      if (!(error instanceof BadFile) && !(error instanceof Refusal)) throw error;
      this.#say(error.message, true);
    }
  }

  /** What a file is, by what it holds. */
  async #sort(file) {
    if (file.size > MAX_LOG_BYTES) throw new BadFile(`${file.name} has ${shown(file.size / 1048576)} MiB, but the page reads at most ${MAX_LOG_BYTES / 1048576} MiB: use grouser estimate`);
    if (/\.toml$/i.test(file.name)) {
      const text = await file.text();
      const kind = /^\s*\[\[leg\]\]/m.test(text) ? 'scenario' : /^\s*\[\[wheel/m.test(text) && !/^\s*\[\[column/m.test(text) && /radius/m.test(text) ? 'robot' : 'columns';
      this.#files[kind] = { name: file.name, text };
      return;
    }
    if (/\.json$/i.test(file.name)) {
      this.#files = { report: { name: file.name, text: await file.text() } };
      return;
    }
    const head = await file.slice(0, 4096).text();
    if (isEstimates(head)) {
      this.#files = { table: { name: file.name, text: await file.text() } };
      return;
    }
    delete this.#files.table;
    this.#files.log = { name: file.name, file };
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
      const log_base64 = await base64(log.file);
      await this.#compute(`estimating ${log.name}`, { call: 'estimate', log_name: log.name, log_base64, robot: robot.text, columns: columns?.text ?? null });
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
      const run = await (request.call === 'estimate' ? this.#log : this.#drive).ask(request);
      const seconds = (performance.now() - started) / 1e3;
      const before = this.#run;
      // two drivers of one scenario lie on one map
      this.show(run, before?.kind === 'drive' && run.kind === 'drive' && before.title === run.title && before.controller !== run.controller ? [before] : []);
      this.timings.compute = seconds;
      this.#say(`${clock(run.duration_s)} ${run.kind === 'drive' ? 'driven' : 'estimated'} in ${shown(seconds, 2)} s`);
    } finally {
      this.stopButton.hidden = true;
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
    this.#others = others;
    this.#run = run;
    this.#pause();
    this.#wheels = run.wheels.map((wheel, i) => ({ ...wheel, shown: masked(run, wheel), look: CURVES[i % CURVES.length] }));
    this.#slips = run.time_s.map((_, i) => {
      let greatest = null;
      for (const { shown: columns } of this.#wheels) {
        const slip = columns.slip[i];
        if (slip !== null && slip !== undefined && (greatest === null || Math.abs(slip) > Math.abs(greatest))) greatest = slip;
      }
      return greatest;
    });
    this.#hidden.clear();
    const end = run.time_s.at(-1);
    const start = run.time_s[0];
    this.#range = [start, end];
    this.#time = start;
    Object.assign(this.scrub, { min: start, max: end, value: start });
    this.zoom.value = '';
    this.empty.hidden = true;
    this.body.hidden = false;
    const hasWay = run.x_m?.some((value) => value !== null);
    this.mapCard.hidden = !hasWay;
    this.body.classList.toggle('has-way', Boolean(hasWay));
    const spans = (wheel, is) => spansOf(wheel.motion ?? [], end, is);
    const powered = this.#wheels.filter((wheel) => !wheel.is_reference && wheel.slip.some((slip) => slip !== null));
    const counted = powered.length ? powered : this.#wheels;
    this.rests = common(counted.map((wheel) => spans(wheel, (name) => name === 'Standstill')));
    this.lost = common(counted.map((wheel) => spansOf(wheel.health ?? [], end, (name) => NO_REFERENCE.test(name))));
    if (hasWay) this.track.show(run, this.#slips, this.#events(run), this.#others);
    this.place.textContent = this.#soils();
    this.#showTable();
    this.#showFacts(run);
    this.#showDecisions(run);
    this.#draw();
    this.#seek(start);
  }

  #events(run) {
    return grouped(run.decisions ?? []).map(({ time_s, action, reason, x_m, y_m, number }) => ({ x_m, y_m, number, name: `${clock(time_s, 1)} ${action}: ${reason}` }));
  }

  #series(wheel, range, pixels) {
    const { slip, sigma, true_slip } = wheel.shown;
    const low = slip.map((value, i) => (value === null || sigma[i] === null ? null : value - sigma[i]));
    const high = slip.map((value, i) => (value === null || sigma[i] === null ? null : value + sigma[i]));
    const thin = thinned(this.#run.time_s, [slip, low, high, ...(true_slip.length ? [true_slip] : [])], range, pixels);
    const [y, bandLow, bandHigh, truth] = thin.columns;
    const series = [{ name: wheel.name, x: thin.x, y, colour: wheel.look.colour, dash: null, width: 1.6, band: { low: bandLow, high: bandHigh } }];
    if (truth) series.push({ name: `${wheel.name}, true`, x: thin.x, y: truth, colour: wheel.look.colour, dash: '2 3', width: 1.2, ghost: true });
    return series;
  }

  #draw() {
    const run = this.#run;
    const range = this.#range;
    const spans = [...this.rests.map(([from, to]) => ({ from, to, kind: 'rest' })), ...this.lost.map(([from, to]) => ({ from, to, kind: 'lost' }))];
    const pixels = plotWidth(this.slipChart);
    const visible = this.#wheels.filter(({ name }) => !this.#hidden.has(name));
    const cursor = this.#time;
    this.slipChart.show({ range, spans, cursor, series: visible.flatMap((wheel) => this.#series(wheel, range, pixels)) });
    const columns = (list) => list.filter(([, column]) => column).map(([name, column, look]) => {
      const thin = thinned(run.time_s, [column], range, pixels);
      return { name, x: thin.x, y: thin.columns[0], width: 1.6, ...look };
    });
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
      const ghosts = this.#others.map((other) => {
        const thin = thinned(other.time_s, [other.used_energy_j], range, pixels);
        return { name: other.controller, x: thin.x, y: thin.columns[0], colour: 'var(--muted)', dash: '3 3', width: 1.3, ghost: true };
      });
      this.energyChart.show({ range, spans: [], cursor, series: [...columns([[run.controller ?? 'used', run.used_energy_j, { colour: CURVES[2].colour }]]), ...ghosts] });
    }
    this.many.forEach((chart, i) => chart.show({ range, spans, cursor, series: this.#series(this.#wheels[i], range, pixels / 2) }));
  }

  #toggleMultiples() {
    const open = this.many.length === 0;
    this.multiplesButton.setAttribute('aria-expanded', String(open));
    this.many = open ? this.#wheels.map(({ name }) => new Chart({ title: name, height: 180, x: { name: 'Time', unit: 's' }, y: { name: 'Slip', unit: '' }, pick: (time) => this.#seek(time) })) : [];
    this.multiples.replaceChildren(...this.many.map((chart) => chart.element));
    if (open) this.#draw();
  }

  #showTable() {
    const truth = this.#wheels.some((wheel) => wheel.true_slip?.length);
    this.cells = this.#wheels.map((wheel) => ({ slip: h('td', { class: 'number' }), truth: h('td', { class: 'number' }), motion: h('td', {}), health: h('td', {}) }));
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
    const item = (name, value, unit = '', note = '') => h('div', {}, h('dt', {}, name), h('dd', {}, h('span', { class: 'number' }, value), unit ? h('span', { class: 'unit' }, ` ${unit}`) : null, note ? h('span', { class: 'note' }, note) : null));
    const items = [item(run.kind === 'drive' ? 'Drive' : 'Log', clock(run.time_s.at(-1) - run.time_s[0]), '', run.title)];
    if (run.kind === 'drive') {
      items.push(
        item('Outcome', run.outcome, '', `driver ${run.controller}, slip to run at ${shown(run.optimum_slip)}`),
        item('Way', shown(run.distance_m), 'm', 'along the legs'),
        item('Energy', shown(run.energy_j), 'J', run.energy_j_per_m === null ? '' : `${shown(run.energy_j_per_m)} J/m; ${shown((100 * run.energy_in_soil_j) / run.energy_j, 2)} % into the soil`),
        item('Slip error', shown(run.slip_rmse, 2), '', `root mean square; greatest slip ${shown(run.worst_slip, 2)}`));
      if (run.planned) items.push(item('Plans anew', String(run.planned.replans), '', `held ${run.planned.held} times; risk of a place at most ${shown(run.planned.risk, 2)}; squares: soil that was learnt`));
      for (const other of this.#others.slice(0, 4)) items.push(item('Compared', other.controller, '', `${other.outcome}, ${shown(other.distance_m)} m, ${shown(other.energy_j)} J: grey on the map`));
    } else {
      if (run.distance_m !== null && run.distance_m !== undefined) items.push(item('Way', shown(run.distance_m), 'm', 'by the estimator’s odometry'));
      for (const wheel of run.wheels) if (wheel.median_slip !== null && wheel.median_slip !== undefined) items.push(item(wheel.name, shown(wheel.median_slip), '', 'median slip'));
    }
    this.facts.replaceChildren(...items);
    this.books.replaceChildren(...[energyTable(run)].filter(Boolean));
    const notes = [...(run.doubts ?? []).map((text) => h('li', { class: 'is-error' }, `Doubtful: ${text}`))];
    if (run.every > 1) notes.push(h('li', {}, `The log is long: every ${run.every}th moment is shown; motion and health are complete.`));
    this.notes.replaceChildren(...notes);
  }

  #showDecisions(run) {
    this.decisions.hidden = !run.decisions?.length;
    if (!run.decisions?.length) return;
    this.decisions.replaceChildren(h('h2', {}, `Decisions of the ${run.controller}`), ...decisionList(run, (time) => this.#seek(time)).filter(Boolean));
  }

  // ---- time ---------------------------------------------------------------------------------

  #index(time) {
    const times = this.#run.time_s;
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  #seek(time) {
    const run = this.#run;
    const end = run.time_s.at(-1);
    this.#time = Math.min(end, Math.max(run.time_s[0], time));
    const index = this.#index(this.#time);
    this.scrub.value = this.#time;
    this.scrub.style.setProperty('--share', `${((100 * (this.#time - run.time_s[0])) / (end - run.time_s[0])).toFixed(2)}%`);
    this.scrub.setAttribute('aria-valuetext', `${shown(this.#time, 4)} s`);
    this.now.textContent = `${clock(this.#time, 1)} / ${clock(end)}`;
    if (this.zoom.value && (this.#time < this.#range[0] || this.#time > this.#range[1])) {
      this.#zoomTo();
      return;
    }
    this.track.cursor(index);
    for (const chart of [this.slipChart, this.speedChart, this.torqueChart, this.energyChart, ...this.many]) chart.cursor(this.#time);
    this.#wheels.forEach((wheel, i) => {
      const { slip, truth, motion, health } = this.cells[i];
      const value = wheel.shown.slip[index];
      const sigma = wheel.shown.sigma[index];
      slip.textContent = value === null || value === undefined ? '–' : `${value.toFixed(3).replace('-', '−')}${sigma === null ? '' : ` ± ${sigma.toFixed(3)}`}`;
      if (this.truth) truth.textContent = wheel.true_slip[index] === null ? '–' : wheel.true_slip[index].toFixed(3).replace('-', '−');
      motion.textContent = nameAt(wheel.motion ?? [], this.#time) || '–';
      health.textContent = nameAt(wheel.health ?? [], this.#time) || '–';
    });
    const mode = run.mode ? nameAt(run.mode, this.#time) : '';
    this.modeBadge.hidden = !mode;
    this.modeBadge.textContent = mode;
  }

  #zoomTo() {
    const { time_s: times } = this.#run;
    const width = Number(this.zoom.value);
    if (!width) this.#range = [times[0], times.at(-1)];
    else {
      const from = Math.max(times[0], Math.min(this.#time - 0.2 * width, times.at(-1) - width));
      this.#range = [from, Math.min(times.at(-1), from + width)];
    }
    this.#draw();
    this.#seek(this.#time);
  }

  #play() {
    if (this.#playing) {
      this.#pause();
      return;
    }
    if (this.#time >= this.#run.time_s.at(-1)) this.#seek(this.#run.time_s[0]);
    this.playButton.textContent = '❚❚';
    this.playButton.setAttribute('aria-label', 'Pause');
    let last = performance.now();
    const frame = (now) => {
      this.#seek(this.#time + ((now - last) / 1e3) * Number(this.rate.value));
      last = now;
      if (this.#time >= this.#run.time_s.at(-1)) this.#pause();
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

function base64(file) {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.addEventListener('load', () => resolve(reader.result.slice(reader.result.indexOf(',') + 1)));
    reader.addEventListener('error', () => reject(new BadFile(`${file.name}: ${reader.error.message}`)));
    reader.readAsDataURL(file);
  });
}
