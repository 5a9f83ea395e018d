// Where runs come from: files, the examples' scenarios, and the server.

import { h } from './dom.js';
import { clock, shown } from './format.js';
import { GrowingRun, follow, readPart } from './growth.js';
import { droppedFiles, withFiles } from './opening.js';
import { Refusal, blockBytes, hasModule } from './physics.js';
import { readReport } from './report.js';
import { RobotDraft } from './robot_draft.js';
import { BadFile, runOfEstimates } from './run_data.js';

/** The value of a key in the text of a table, as it is written. */
function valueOf(table, key) {
  return table.match(new RegExp(`^\\s*${key}\\s*=\\s*([^\\s#]+)`, 'm'))?.[1];
}

/** The text with another value of a key that it has. */
function withValue(table, key, value) {
  return table.replace(new RegExp(`^(\\s*${key}\\s*=\\s*)("[^"]*"|[^\\s#]+)`, 'm'), `$1${value}`);
}

/** A robot file whose powered wheels of the first one's radius have the sizes of `wheel`, m. */
function withWheels(robot, wheel) {
  const tables = robot.split(/^(?=\[\[)/m);
  const isWheel = (table) => table.startsWith('[[wheel]]') && valueOf(table, 'drive') === '"powered"';
  const radius = valueOf(tables.find(isWheel), 'radius_m');
  const sizes = ['radius_m', 'width_m'].filter((key) => wheel[key] !== undefined);
  return tables.map((table) => (isWheel(table) && valueOf(table, 'radius_m') === radius
    ? sizes.reduce((text, key) => withValue(text, key, Number(wheel[key].toPrecision(6))), table)
    : table)).join('');
}

/** A scenario on `soil`, whose title names it and the wheels. */
function withGround(scenario, robot, soil) {
  const millimetres = (key) => shown(1e3 * Number(valueOf(robot.slice(robot.indexOf('[[wheel]]')), key)));
  const on = soil ? withValue(scenario, 'soil', `"${soil}"`) : scenario;
  return withValue(on, 'title', `"Wheels of ${millimetres('radius_m')} × ${millimetres('width_m')} mm on ${valueOf(on, 'soil').replaceAll('"', '')}"`);
}

/** What opens runs; each is handed to `view`: `show(run)`, `propose(element)`, `begin(run)`, `grown(run, words)`, `ended(run)`, `report(it)`. */
export class RunSource {
  #drive;
  #log;
  #view;
  #files = {};
  #examples = null;
  #isOpen = false;

  /** How long things took: the last opening and glance in ms, the last computation in s. */
  timings = {};

  /** `drive` simulates, `log` reads recorded logs. */
  constructor(drive, log, view) {
    this.#drive = drive;
    this.#log = log;
    this.#view = view;
    this.input = h('input', { type: 'file', multiple: true, id: 'run-files', class: 'sr-only', on: { change: () => this.#take([...this.input.files]) } });
    const example = h('button', { type: 'button', class: 'primary', hidden: !hasModule('drive'), on: { click: () => this.#example('sandbox', 'controller') } }, 'Drive the sandbox');
    this.choice = h('select', { 'aria-label': 'Another scenario', hidden: !hasModule('drive'), on: { change: () => this.#chooseExample() } },
      h('option', { value: '' }, 'another scenario'),
      ['sandbox', 'soft-patch', 'slope'].map((name) => h('optgroup', { label: name },
        ['controller', 'open-loop'].map((pilot) => h('option', { value: `${name} ${pilot}` }, `${name}, ${pilot}`)))));
    this.stopButton = h('button', { type: 'button', class: 'quiet', hidden: true, on: { click: () => Promise.all([this.#drive.stop(), this.#log.stop()]) } }, 'Stop');
    this.status = h('p', { class: 'run-status', role: 'status' });
    this.tools = h('div', { class: 'run-tools', hidden: !hasModule('explore') },
      h('label', { class: 'quiet button', for: 'run-files' }, 'Open files'), this.input, example, this.choice, this.stopButton, this.status);
    this.names = h('p', { class: 'muted file-list' });
  }

  /** Files that are dropped on an element are opened. */
  acceptDrops(element) {
    for (const event of ['dragover', 'drop']) {
      element.addEventListener(event, (drag) => {
        drag.preventDefault();
        element.classList.toggle('is-over', event === 'dragover');
        if (event === 'drop') this.#take(droppedFiles(drag.dataTransfer));
      });
    }
    element.addEventListener('dragleave', () => element.classList.remove('is-over'));
  }

  /** The run that the page brings: the server's, a file of it, or one in the page itself. */
  async open() {
    if (this.#isOpen) return;
    this.#isOpen = true;
    const { file, run } = document.getElementById('main').dataset;
    const embedded = document.getElementById('embedded');
    if (run) await this.#followServer(run === 'live');
    else if (file) await this.#take([new File([await (await fetch('api/file')).blob()], file)]);
    else if (embedded) await this.#take([new File([await blockBytes(embedded)], embedded.dataset.name)]);
  }

  #say(text, bad = false) {
    this.status.textContent = text;
    this.status.classList.toggle('is-error', bad);
  }

  /** Does something; what is refused is said. */
  async #saying(act) {
    try {
      await act();
    } catch (error) {
      if (!(error instanceof BadFile) && !(error instanceof Refusal)) throw error;
      this.#say(error.message, true);
    }
  }

  #take(files) {
    this.input.value = '';
    return this.#saying(async () => {
      this.#files = await withFiles(this.#files, await files);
      this.names.textContent = Object.entries(this.#files).map(([kind, { name }]) => `${kind}: ${name}`).join(' · ');
      await this.#go();
    });
  }

  async #go() {
    const { table, log, robot, columns, scenario, report } = this.#files;
    const started = performance.now();
    if (report) {
      this.#files = {};
      this.#view.report(readReport(report.text, report.name));
      return;
    }
    if (!table && !hasModule('log')) {
      this.#say('this page has a run in it and opens tables of grouser estimate -o only: export a page without a run for logs and drives', true);
      return;
    }
    if (table) {
      this.#view.show(runOfEstimates(table.text, table.name));
      delete this.#files.table;
    } else if (log && robot) {
      await this.#estimate(log, robot, columns);
      delete this.#files.log;
    } else if (log) {
      await this.#propose(log);
      return;
    } else if (scenario && robot) {
      await this.#simulate(`driving ${scenario.name}`, { name: scenario.name.replace(/\.toml$/, ''), scenario: scenario.text, robot: robot.text, pilot: 'controller' });
      delete this.#files.scenario;
    } else {
      const wants = scenario ? `${scenario.name}: the robot file that it names is needed too` : 'a log or a scenario is needed too';
      this.#say(wants);
      return;
    }
    this.timings.open = performance.now() - started;
  }

  #example(name, pilot) {
    return this.#saying(async () => {
      const { scenario, robot } = await this.#filesOf(name);
      await this.#simulate(`driving ${name}, ${pilot}`, { name, scenario, robot, pilot });
    });
  }

  /** Drives an example whose large powered wheels have the sizes of `wheel` (m), on `soil` of the catalogue. */
  drive(name, wheel, soil) {
    return this.#saying(async () => {
      const example = await this.#filesOf(name);
      const robot = withWheels(example.robot, wheel);
      const scenario = withGround(example.scenario, robot, soil);
      await this.#simulate(`driving ${name} with another wheel`, { name, scenario, robot, pilot: 'controller' });
    });
  }

  async #filesOf(name) {
    this.#say('loading');
    this.#examples ??= (await this.#drive.ask({ call: 'examples' })).examples;
    return this.#examples.find((one) => one.name === name);
  }

  #chooseExample() {
    const [name, pilot] = this.choice.value.split(' ');
    this.choice.value = '';
    if (name) this.#example(name, pilot);
  }

  async #simulate(what, request) {
    this.#say(`${what} …`);
    this.stopButton.hidden = false;
    const started = performance.now();
    try {
      const run = await this.#drive.ask({ call: 'drive', ...request });
      const seconds = (performance.now() - started) / 1e3;
      this.#view.show(run);
      this.timings.compute = seconds;
      this.#say(`${clock(run.duration_s)} driven in ${shown(seconds, 2)} s`);
    } finally {
      this.stopButton.hidden = true;
    }
  }

  /** Asks about a log, whose files go one behind the other. */
  async #askOf({ name, files }, request, take) {
    const logs = files.map((file) => ({ name: file.name, bytes: file.size }));
    return this.#log.ask({ ...request, log_name: name, logs }, { file: await new Blob(files).arrayBuffer(), take });
  }

  /** A log without a robot file: what it holds, and what must be asked. */
  async #propose(log) {
    this.#say(`reading ${log.name} …`);
    delete this.#files.log;
    const { robot } = await this.#askOf(log, { call: 'suggest' });
    const estimate = (text) => this.#saying(async () => {
      this.#files = { ...this.#files, log, robot: { name: 'robot.toml', text } };
      await this.#go();
    });
    this.#view.propose(new RobotDraft(robot, estimate).element);
    this.#say(`${log.name}: two numbers are needed at most`);
  }

  /** A log through the estimator beside the page: its rim speeds at once, its slips as they are found. */
  async #estimate({ name, files }, robot, columns) {
    this.#say(`reading ${name} …`);
    this.stopButton.hidden = false;
    const started = performance.now();
    const growing = new GrowingRun();
    const take = (part) => {
      growing.add(readPart(part));
      const { run } = growing;
      if (run.overview && this.#view.run !== run) {
        this.#view.begin(run);
        this.timings.overview = performance.now() - started;
      }
      this.#grown(run, () => `estimated to ${clock(run.time_s.at(-1) ?? 0)} of ${clock(run.end_s)}; what is there can be looked at`);
    };
    try {
      growing.end(await this.#askOf({ name, files }, { call: 'estimate', robot: robot.text, columns: columns?.text ?? null }, take));
      this.#view.ended(growing.run);
      this.timings.compute = (performance.now() - started) / 1e3;
      this.#say(`${clock(growing.run.time_s.at(-1) - growing.run.time_s[0])} estimated in ${shown(this.timings.compute, 2)} s`);
    } finally {
      this.stopButton.hidden = true;
      this.#view.stopped();
    }
  }

  #grown(run, words) {
    this.#view.grown(run, () => this.#say(words()));
  }

  /** The run that the server reads, from its beginning to now and on. */
  async #followServer(isLive) {
    const growing = new GrowingRun();
    this.#say('waiting for the first measurements …');
    const take = (parts, lost) => {
      for (const part of parts) {
        if (part.head.failed) throw new Refusal({ field: null, message: part.head.failed });
        if (part.head.end) {
          growing.end(part.head.end);
          this.#view.ended(growing.run);
          this.#say('the run has ended');
        } else growing.add(part);
      }
      const { run } = growing;
      if (!run || (!run.time_s.length && !run.overview)) return;
      run.is_live = isLive;
      if (this.#view.run !== run) this.#view.begin(run);
      if (run.is_growing) this.#grown(run, () => `${isLive ? 'live' : 'estimated'} to ${clock(run.time_s.at(-1) ?? 0)}${lost ? '; what is older than the server keeps is not shown' : ''}`);
    };
    try {
      await follow(take, new AbortController().signal);
    } catch (error) {
      this.#say(error instanceof Refusal ? error.message : `the server cannot be reached any more: ${error.message}`, true);
    }
  }
}
