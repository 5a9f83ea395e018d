// The result of a run in words and numbers.

import { h } from './dom.js';
import { clock, shown } from './format.js';

function item(name, value, unit = '', note = '') {
  return h('div', {}, h('dt', {}, name), h('dd', {}, h('span', { class: 'number' }, value), unit ? h('span', { class: 'unit' }, ` ${unit}`) : null, note ? h('span', { class: 'note' }, note) : null));
}

/** The facts of a run that lasts `seconds`, with those of the runs that it is compared with. */
export function factsOf(run, others, seconds) {
  const items = [item(run.kind === 'drive' ? 'Drive' : 'Log', clock(seconds), '', run.title)];
  if (run.kind === 'drive') {
    items.push(
      item('Outcome', run.outcome, '', `driver ${run.controller}, slip to run at ${shown(run.optimum_slip)}`),
      item('Way', shown(run.distance_m), 'm', 'along the legs'),
      item('Energy', shown(run.energy_j), 'J', run.energy_j_per_m === null ? '' : `${shown(run.energy_j_per_m)} J/m; ${shown((100 * run.energy_in_soil_j) / run.energy_j, 2)} % into the soil`),
      item('Slip error', shown(run.slip_rmse, 2), '', `root mean square; greatest slip ${shown(run.worst_slip, 2)}`));
    if (run.planned) items.push(item('Plans anew', String(run.planned.replans), '', `held ${run.planned.held} times; risk of a place at most ${shown(run.planned.risk, 2)}; squares: soil that was learnt`));
    for (const other of others.slice(0, 4)) items.push(item('Compared', other.controller, '', `${other.outcome}, ${shown(other.distance_m)} m, ${shown(other.energy_j)} J: grey on the map`));
  } else {
    if (run.distance_m !== null && run.distance_m !== undefined) items.push(item('Way', shown(run.distance_m), 'm', 'by the estimator’s odometry'));
    for (const wheel of run.wheels) if (wheel.median_slip !== null && wheel.median_slip !== undefined) items.push(item(wheel.name, shown(wheel.median_slip), '', 'median slip'));
  }
  return items;
}

/** What is doubtful of a run, or left out. */
export function notesOf(run) {
  const notes = [...(run.doubts ?? []).map((text) => h('li', { class: 'is-error' }, `Doubtful: ${text}`))];
  if (run.every > 1) notes.push(h('li', {}, `The log is long: every ${run.every}th moment is shown; motion and health are complete.`));
  return notes;
}
