// Run: a drive in the page, or a recorded log, under one cursor of time.

import { h } from './dom.js';
import { factsOf, notesOf, soilTable } from './facts.js';
import { figureButton } from './figure_file.js';
import { clock, shown } from './format.js';
import { CURVES } from './palette.js';
import { Player } from './player.js';
import { decisionList, drivesTable, energyTable, grouped, sources, stateList } from './report.js';
import { RobotView } from './robot_view.js';
import { RunCharts } from './run_charts.js';
import { inColumns, masked, nameAt, placeOf } from './run_data.js';
import { RunSource } from './run_source.js';
import { SLIP_CLASSES } from './slip_classes.js';
import { Track } from './track.js';
import { WheelTable } from './wheel_table.js';

/** A run that grows is drawn anew after this time, ms; one from a live source sooner. */
const REDRAW_MS = { file: 600, live: 150 };

/** The view; `drive` simulates, `log` reads recorded logs, `report` has runs to show. */
export class Run {
  #source;
  #report;
  #run = null;
  #others = [];
  #wheels = [];
  #redraw = null;

  constructor(drive, log, report = null) {
    this.#source = new RunSource(drive, log, this);
    this.#report = report;
    this.element = this.#build();
  }

  /** Nothing of a run is in the address: a log never leaves the machine. */
  open() {
    if (this.#run) return;
    if (this.#report) this.report(this.#report);
    else this.#source.open();
  }

  /** The run that is shown. */
  get run() {
    return this.#run;
  }

  get timings() {
    return this.#source.timings;
  }

  /** Drives an example with other wheels; see `RunSource`. */
  drive(name, wheel, soil) {
    return this.#source.drive(name, wheel, soil);
  }

  // ---- building -----------------------------------------------------------------------------

  #build() {
    this.player = new Player({ moved: () => this.#moved(), ranged: () => this.#draw(), followed: () => this.#refresh() });
    this.table = new WheelTable(() => this.#draw());
    this.charts = new RunCharts({ pick: (time) => this.player.choose(time), hover: (time) => this.#showValues(time ?? this.player.time), table: this.table.element });
    this.robotView = new RobotView();
    this.decisions = h('section', { class: 'card decisions', 'aria-label': 'Decisions and states' });
    this.empty = h('section', { class: 'card drop' },
      h('h2', {}, 'A run under one cursor of time'),
      h('p', {}, 'Drop files here: a robot’s log (CSV, MCAP, ROS bag; all files of a split one, or its folder), alone or with its robot file and column map, the table of ', h('code', {}, 'grouser estimate -o'), ', or a scenario with its robot file. They stay on this machine.'));
    this.body = h('div', { class: 'run-body', hidden: true }, this.player.element,
      h('div', { class: 'run-grid' },
        h('div', { class: 'run-side' }, this.#mapCard(), h('div', { class: 'run-pair' }, this.#factsCard(), this.robotView.element)),
        h('div', { class: 'run-side' }, this.charts.slip.element, this.decisions)),
      h('div', { class: 'run-more' }, this.charts.element, h('div', { class: 'run-tools' }, this.charts.multiplesButton, figureButton(() => ({ charts: this.charts.visible, description: this.#run.title, name: 'run' }))), this.charts.multiples));
    this.draft = h('div', { hidden: true });
    this.drives = h('div', { hidden: true });
    this.provenance = h('div', {});
    const view = h('div', { class: 'run' }, this.#source.tools, this.#source.names, this.empty, this.draft, this.drives, this.body, this.provenance);
    this.#source.acceptDrops(view);
    return view;
  }

  #mapCard() {
    this.place = h('output', { class: 'muted place' });
    this.track = new Track((time) => this.player.choose(time), (under) => {
      this.place.textContent = under ? `x ${shown(under.x)} m, y ${shown(under.y)} m, height ${shown(under.height)} m, ${under.soil}` : this.#soils();
    });
    const names = ['0', ...SLIP_CLASSES.slice(0, -1).map(String)];
    const key = SLIP_CLASSES.map((limit, i) => h('span', { class: `slip-key slip-key-${i}` }, i === SLIP_CLASSES.length - 1 ? `over ${names[i]}` : `to ${limit}`));
    this.mapCard = h('section', { class: 'card map', 'aria-label': 'Path of the robot' },
      h('header', {}, h('h2', {}, 'Path, coloured by slip'), this.modeBadge = h('span', { class: 'badge' })), this.track.element,
      h('p', { class: 'key' }, h('span', { class: 'plain' }, 'maximum slip of the wheels:'), key), this.place);
    return this.mapCard;
  }

  /** The soils of the ground in words. */
  #soils() {
    const soils = this.#run?.ground?.soils ?? [];
    const ground = soils.length > 1 ? `ground: ${soils[0]}; tinted: ${soils.slice(1).join(', ')}` : soils.length ? `ground: ${soils[0]}` : '';
    const drivers = this.#others.map(({ controller }) => controller).filter(Boolean);
    return [ground, drivers.length ? `grey: the path of ${drivers.join(', ')}` : ''].filter(Boolean).join('; ');
  }

  #factsCard() {
    this.facts = h('dl', { class: 'readouts' });
    this.notes = h('ul', { class: 'cautions' });
    this.books = h('div', {});
    return h('section', { class: 'card facts', 'aria-label': 'Result' }, this.facts, this.notes, this.books);
  }

  // ---- what the source hands over -----------------------------------------------------------

  /** Shows a report: its runs, the controller's first, and what belongs to them. */
  report(report) {
    const { runs, drives, provenance, sources: more, note } = report;
    const shownRun = (i) => this.show(runs[i], runs.filter((_, k) => k !== i));
    this.drives.hidden = !drives || drives.length < 2;
    if (drives) this.drives.replaceChildren(drivesTable(report, shownRun));
    this.provenance.replaceChildren(...[sources([...(provenance ?? []), ...(more ?? [])], note)].filter(Boolean));
    shownRun(Math.max(0, runs.findIndex(({ controller }) => controller === 'controller')));
  }

  /** Shows a run, with others of the same ground in grey: by default the drive of another driver that is shown now. */
  show(run, others = this.#isRival(run) ? [this.#run] : []) {
    this.#others = others.map(inColumns);
    this.#begin(inColumns(run));
    this.player.seek(this.#firstMotion());
  }

  /** What is asked before a log can be estimated; it stays, to be changed. */
  propose(element) {
    this.draft.replaceChildren(element);
    this.draft.hidden = false;
    this.empty.hidden = true;
    this.body.hidden = true;
  }

  /** When a wheel of a log first moves: before that there is nothing to see. */
  #firstMotion() {
    if (this.#run.kind === 'drive') return this.#start();
    const begins = this.#run.wheels.map(({ motion }) => motion?.find(([, name]) => name === 'Driving')?.[0] ?? Infinity);
    const first = Math.min(...begins);
    return Number.isFinite(first) ? first : this.#start();
  }

  /** Is `run` a drive of the scenario that is shown, by another driver? */
  #isRival(run) {
    const before = this.#run;
    return before?.kind === 'drive' && run.kind === 'drive' && before.title === run.title && before.controller !== run.controller;
  }

  /** Shows a run that grows. */
  begin(run) {
    this.#others = [];
    this.#begin(run);
    if (run.is_live) this.player.follow(true);
    else this.player.seek(this.#start());
  }

  /** The run has grown: drawn anew after a while, with all that came meanwhile. */
  grown(run, say) {
    this.#redraw ??= setTimeout(() => {
      this.#redraw = null;
      if (!this.#run?.is_growing) return;
      say();
      // a reader who chose a time keeps the picture
      if (this.#run.is_live && !this.player.isFollowing) return;
      this.#refresh();
    }, REDRAW_MS[run.is_live ? 'live' : 'file']);
  }

  /** A run that grew is complete. */
  ended(run) {
    if (this.#run !== run) this.begin(run);
    this.player.end();
    this.#refresh();
    if (!run.is_live && this.player.time === this.#start()) this.player.seek(this.#firstMotion());
  }

  /** Nothing grows any more. */
  stopped() {
    clearTimeout(this.#redraw);
    this.#redraw = null;
  }

  // ---- showing ------------------------------------------------------------------------------

  #begin(run) {
    this.#run = run;
    this.player.begin(this.#start(), this.#end());
    this.empty.hidden = true;
    this.body.hidden = false;
    this.#derive();
    this.table.begin(this.#wheels);
    this.#showDecisions();
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
    const slips = new Float64Array(run.time_s.length).fill(NaN);
    for (const { shown: { slip } } of this.#wheels) {
      for (let i = 0; i < slip.length; i += 1) if (slip[i] === slip[i] && !(Math.abs(slip[i]) <= Math.abs(slips[i]))) slips[i] = slip[i];
    }
    this.table.grow(this.#wheels);
    this.player.grow(this.#start(), this.#end(), run.is_live && run.is_growing);
    const hasWay = run.x_m?.some((value) => value === value) ?? false;
    this.mapCard.hidden = !hasWay;
    this.body.classList.toggle('has-way', hasWay);
    if (hasWay) this.track.show(run, slips, this.#events(), this.#others);
    this.robotView.show(run);
    this.place.textContent = this.#soils();
    this.#showFacts();
  }

  #refresh() {
    this.#derive();
    this.#draw();
    this.player.seek(this.player.time);
  }

  #draw() {
    const { range, time: cursor } = this.player;
    this.charts.show({ run: this.#run, wheels: this.#wheels, hidden: this.table.hidden, others: this.#others, range, cursor });
  }

  #events() {
    return grouped(this.#run.decisions ?? []).map(({ time_s, action, reason, x_m, y_m, number }) => ({ x_m, y_m, number, name: `${clock(time_s, 1)} ${action}: ${reason}` }));
  }

  #showFacts() {
    const run = this.#run;
    this.facts.replaceChildren(...factsOf(run, this.#others, this.#end() - this.#start()));
    this.books.replaceChildren(...[soilTable(run), energyTable(run)].filter(Boolean));
    this.notes.replaceChildren(...notesOf(run));
  }

  #showDecisions() {
    const run = this.#run;
    const seek = (time) => this.player.seek(time);
    const decisions = run.decisions?.length ? [h('h2', {}, `Decisions of the ${run.controller}`), ...decisionList(run, seek)] : [];
    const states = run.mode?.length ? [h('h2', {}, `States of the ${run.controller}`), stateList(run, seek)] : [];
    this.decisions.hidden = !decisions.length && !states.length;
    this.decisions.replaceChildren(...[...decisions, ...states].filter(Boolean));
  }

  /** The last moment that is not after a time; −1 where the run has none yet. */
  #index(time) {
    const times = this.#run.time_s;
    const next = placeOf(times, time);
    const index = times[next] === time ? next : next - 1;
    // what is not estimated yet is not the last moment's
    return this.#run.is_growing && time > times.at(-1) + 1 ? -1 : index;
  }

  /** The cursor has another time. */
  #moved() {
    const run = this.#run;
    const { time } = this.player;
    const index = this.#index(time);
    this.track.cursor(index);
    this.robotView.cursor(index);
    this.charts.cursor(time);
    this.#showValues(time);
    const mode = run.mode ? nameAt(run.mode, time) : '';
    this.modeBadge.hidden = !mode;
    this.modeBadge.textContent = mode;
  }

  /** The wheels' values at a time. */
  #showValues(time) {
    this.table.show(this.#index(time), time);
  }
}
