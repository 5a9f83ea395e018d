// The parts of a report beside the run: all drives in a table, where the energy went, where the numbers come from.

import { h } from './dom.js';
import { clock, shown } from './format.js';
import { BadFile } from './run_data.js';

/** Decisions of one kind about wheels that follow each other within this time are one, s. */
const MAX_GAP_S = 1;
/** States that are listed. */
const MAX_STATES = 100;

/** A dropped report: what it shows, checked as far as the page relies on it. */
export function readReport(text, name) {
  let report;
  try {
    report = JSON.parse(text);
  } catch {
    throw new BadFile(`${name} is no JSON`);
  }
  const column = (values, length) => Array.isArray(values) && values.length === length;
  const isRun = (run) => Array.isArray(run?.time_s) && run.time_s.length > 1 && Array.isArray(run.wheels) && run.wheels.length <= 64
    && run.wheels.every((wheel) => typeof wheel?.name === 'string' && column(wheel.slip, run.time_s.length) && column(wheel.slip_sigma, run.time_s.length));
  if (!Array.isArray(report?.runs) || !report.runs.length || !report.runs.every(isRun)) throw new BadFile(`${name} holds no run: a report of grouser drive or estimate is expected`);
  return report;
}

/** Every drive of a report; `choose(i)` shows the i-th run. */
export function drivesTable({ drives, summaries, runs }, choose) {
  const head = ['driver', 'seed', 'outcome', 'distance, m', 'time, s', 'energy, J', 'J/m', 'worst slip', 'slip, RMS error', 'bias'];
  const row = (drive) => {
    const run = runs.findIndex(({ controller, seed }) => controller === drive.controller && seed === drive.seed);
    const name = run < 0 ? drive.controller : h('button', { type: 'button', class: 'link', on: { click: () => choose(run) } }, drive.controller);
    const cells = [drive.seed, drive.outcome, ...[drive.distance_m, drive.duration_s, drive.energy_j, drive.energy_j_per_m, drive.worst_slip, drive.slip_rmse, drive.slip_bias].map((value) => shown(value))];
    return h('tr', {}, h('th', { scope: 'row' }, name), cells.map((cell) => h('td', {}, cell)));
  };
  return h('section', { class: 'card sheet', 'aria-label': 'Drives' }, h('h2', {}, 'Drives'),
    h('div', { class: 'wide' }, h('table', {}, h('thead', {}, h('tr', {}, head.map((name) => h('th', { scope: 'col' }, name)))), h('tbody', {}, drives.map(row)))),
    summaries?.length ? h('ul', {}, summaries.map((text) => h('li', {}, text))) : null);
}

/** Where the electrical energy of a drive went. */
export function energyTable({ energy_went_into: rows, energy_j: whole }) {
  if (!rows) return null;
  const share = (energy) => (whole > 0 ? `${shown((100 * energy) / whole, 3)} %` : '–');
  return h('details', { class: 'books' }, h('summary', {}, 'Where the energy went'),
    h('table', {}, h('thead', {}, h('tr', {}, ['into', 'J', 'share'].map((name) => h('th', { scope: 'col' }, name)))),
      h('tbody', {}, [...rows, ['battery, in all', whole]].map(([name, energy]) => h('tr', {}, h('th', { scope: 'row' }, name), h('td', {}, shown(energy, 4)), h('td', {}, share(energy)))))));
}

/** Where the numbers come from: rows of words and values. */
export function sources(rows, note) {
  if (!rows?.length) return null;
  return h('section', { class: 'card sheet', 'aria-label': 'Provenance' }, h('h2', {}, 'Provenance'),
    h('div', { class: 'wide' }, h('table', {}, h('tbody', {}, rows.map(([name, value]) => h('tr', {}, h('th', { scope: 'row' }, name), h('td', { class: 'text' }, value)))))),
    note ? h('p', { class: 'muted' }, note) : null);
}

/** Decisions in the order of time: those about the whole robot numbered, those alike about wheels joined. */
export function grouped(decisions) {
  const groups = [];
  let number = 0;
  for (const decision of decisions) {
    const last = groups.at(-1);
    if (!decision.wheel) {
      number += 1;
      groups.push({ ...decision, number, wheels: [], values: [decision.value, decision.value], end_s: decision.time_s });
    } else if (last && !last.number && last.action === decision.action && last.reason === decision.reason && decision.time_s - last.end_s <= MAX_GAP_S) {
      last.end_s = decision.time_s;
      last.values = [Math.min(last.values[0], decision.value), Math.max(last.values[1], decision.value)];
      if (!last.wheels.includes(decision.wheel)) last.wheels.push(decision.wheel);
    } else {
      groups.push({ ...decision, number: null, wheels: [decision.wheel], values: [decision.value, decision.value], end_s: decision.time_s });
    }
  }
  return groups;
}

/** The states of a drive's controller and when each began; `seek(time)` sets the cursor. */
export function stateList({ mode }, seek) {
  const item = ([time_s, name]) => h('li', {}, h('button', { type: 'button', class: 'link', on: { click: () => seek(time_s) } }, clock(time_s, 1)), ` ${name}`);
  const more = mode.length - MAX_STATES;
  return h('div', {}, h('ol', { class: 'states' }, mode.slice(0, MAX_STATES).map(item)), more > 0 ? h('p', { class: 'muted' }, `… and ${more} more.`) : null);
}

/** The decisions of a drive; `seek(time)` sets the cursor. */
export function decisionList({ decisions, decision_count: count }, seek) {
  const span = ([low, high]) => (shown(low) === shown(high) ? shown(low) : `${shown(low)} to ${shown(high)}`);
  const item = ({ time_s, number, action, reason, wheels, values, limit }) => h('li', {}, h('button', { type: 'button', class: 'link', on: { click: () => seek(time_s) } }, clock(time_s, 1)),
    number ? h('span', { class: 'number-on-map' }, number) : null, ` ${action}`, wheels.length ? ` (${wheels.join(', ')})` : '', `: ${reason}`, h('span', { class: 'muted' }, ` ${span(values)} against ${shown(limit)}`));
  const more = (count ?? decisions.length) - decisions.length;
  return [h('ol', {}, grouped(decisions).map(item)), more > 0 ? h('p', { class: 'muted' }, `… and ${more} more.`) : null];
}
