// Charts as a file: one figure in SVG with its letters as outlines, as the command draws figures.

import { download, h } from './dom.js';
import { Refusal, hasModule } from './physics.js';
import { WorkerPhysics } from './worker.js';

let physics = null;

/** The figure of several charts as SVG. */
export async function figureOf(charts, description) {
  physics ??= new WorkerPhysics('figure');
  return (await physics.ask({ call: 'figure', description, panels: charts.map((chart) => chart.panel) })).svg;
}

/** A button that saves what `content()` gives: {charts, description, name}. A page without the module has none. */
export function figureButton(content) {
  const status = h('span', { role: 'status', class: 'muted' });
  const save = async () => {
    const { charts, description, name } = content();
    status.textContent = 'drawing …';
    try {
      download(`${name}.svg`, 'image/svg+xml', await figureOf(charts, description));
      status.textContent = '';
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      status.textContent = error.message;
    }
  };
  return h('span', { class: 'figure-file', hidden: !hasModule('figure') }, h('button', { type: 'button', class: 'quiet', on: { click: save } }, 'Save as figure'), status);
}
