// The result of a run in words and numbers.

import { h, svg } from './dom.js';
import { clock, shown } from './format.js';

function item(name, value, unit = '', note = '') {
  return h('div', {}, h('dt', {}, name), h('dd', {}, h('span', { class: 'number' }, value), unit ? h('span', { class: 'unit' }, ` ${unit}`) : null, note ? h('span', { class: 'note' }, note) : null));
}

/** The facts of a run that lasts `seconds`, with those of the runs that it is compared with. */
export function factsOf(run, others, seconds) {
  const items = [item(run.kind === 'drive' ? 'Drive' : 'Log', clock(seconds), '', run.title)];
  if (run.kind === 'drive') {
    items.push(
      item('Outcome', run.outcome, '', `driver ${run.controller}, slip setpoint ${shown(run.optimum_slip)}`),
      item('Distance', shown(run.distance_m), 'm', 'along the legs'),
      item('Energy', shown(run.energy_j), 'J', run.energy_j_per_m === null ? '' : `${shown(run.energy_j_per_m)} J/m; ${shown((100 * run.energy_in_soil_j) / run.energy_j, 2)} % into the soil`),
      item('Slip error', shown(run.slip_rmse, 2), '', `root mean square; maximum slip ${shown(run.worst_slip, 2)}`));
    if (run.planned) items.push(item('Replanned', String(run.planned.replans), 'times', `backed out ${run.planned.held} times; probability of immobilisation at most ${shown(run.planned.risk, 2)}; squares: soil that was learnt`));
    for (const other of others.slice(0, 4)) items.push(item('Compared', other.controller, '', `${other.outcome}, ${shown(other.distance_m)} m, ${shown(other.energy_j)} J: grey on the map`));
  } else {
    if (run.distance_m !== null && run.distance_m !== undefined) items.push(item('Distance', shown(run.distance_m), 'm', 'by the estimator’s odometry'));
    if (run.slip_overall !== null && run.slip_overall !== undefined) items.push(item('Slip', shown(run.slip_overall), '', 'over the total distance'));
    for (const wheel of run.wheels) if (wheel.median_slip !== null && wheel.median_slip !== undefined) items.push(item(wheel.name, shown(wheel.median_slip), '', 'median slip'));
  }
  return items;
}

/** A number with its interval of 90 % on a scale of its own: [name, mean, low, high, unit]. */
function interval([name, mean, low, high, unit = '']) {
  const [from, to] = [Math.min(low, unit ? low : 1), Math.max(high, unit ? high : 1)];
  const room = 0.1 * (to - from || 1);
  const at = (value) => `${(100 * (value - from + room)) / (to - from + 2 * room)}%`;
  const line = (x1, x2, kind) => svg('line', { x1: at(x1), x2: at(x2), y1: 6, y2: 6, class: kind });
  const known = unit ? null : svg('line', { x1: at(1), x2: at(1), y1: 0, y2: 12, class: 'known' });
  return h('tr', {}, h('th', { scope: 'row' }, name), h('td', {}, `${shown(mean)}${unit}`), h('td', {}, `${shown(low)}${unit} to ${shown(high)}${unit}`),
    h('td', { class: 'interval' }, svg('svg', { height: 12, width: '100%', 'aria-hidden': 'true' }, known, line(low, high, 'spread'), svg('circle', { cx: at(mean), cy: 6, r: 4, class: 'mean' }))));
}

/** What was learnt of the soil, with intervals; null where nothing was. */
export function soilTable({ soil, known_soil: known }) {
  if (!soil) return null;
  const of = known ? `“${known}”` : 'the known soil';
  const rows = [
    [`strength, multiples of ${of}`, soil.strength, soil.strength_low, soil.strength_high],
    [`stiffness, multiples of ${of}`, soil.stiffness, soil.stiffness_low, soil.stiffness_high],
    ['friction angle', soil.phi_deg, soil.phi_low_deg, soil.phi_high_deg, '°'],
  ];
  const contacts = soil.contact_readings ? `, ${soil.contact_readings} of them with sinkages or entry angles` : '';
  return h('section', { class: 'learnt', 'aria-label': 'Soil that was learnt' }, h('h2', {}, 'Soil that was learnt'),
    h('table', {}, h('thead', {}, h('tr', {}, ['', 'mean', '90 % interval', ''].map((name) => h('th', { scope: 'col' }, name || h('span', { class: 'sr-only' }, 'number or picture'))))), h('tbody', {}, rows.map(interval))),
    h('p', { class: 'muted' }, `From ${soil.readings} readings${contacts}; ${soil.changes} changes of belief. The intervals hold for soils of the known kind; on other soils half of them held. The upright line is the known soil.`));
}

/** Why a run is uncertain, what restricts it, and what is left out. */
export function notesOf(run) {
  const notes = [...(run.doubts ?? []).map((text) => h('li', { class: 'is-error' }, `WARNING: ${text}`)), ...(run.reservations ?? []).map((text) => h('li', {}, text))];
  if (run.every > 1) notes.push(h('li', {}, `The log is long: every ${run.every}th moment is shown; motion and health are complete.`));
  return notes;
}
