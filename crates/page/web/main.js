// The page: its views and its address.

import { h } from './dom.js';
import { Explore } from './explore.js';
import { Optimise } from './optimise.js';
import { Run } from './run.js';
import { ServerPhysics, WasmPhysics, embeddedReport, hasModule } from './physics.js';
import { themeButton } from './theme.js';
import { WorkerPhysics, work } from './worker.js';

const VIEWS = [['explore', 'Explore'], ['optimise', 'Optimise'], ['run', 'Run']];

async function start() {
  const main = document.getElementById('main');
  const nav = document.getElementById('views');
  // a report shows its result, and computes nothing
  const report = await embeddedReport();
  const physics = hasModule('explore') ? await WasmPhysics.load('explore') : null;

  let written = null;
  const moved = (view) => (query) => {
    if (view !== current()[0]) return;
    written = query ? `#${view}?${query}` : `#${view}`;
    if (location.hash !== written) history.replaceState(null, '', written);
  };
  const drive = new WorkerPhysics('drive');
  const views = new Map();
  if (physics) views.set('explore', new Explore(physics, await physics.ask({ call: 'catalogue' }), moved('explore')));
  if (report?.answer || hasModule('optimize')) {
    const explore = (change) => {
      location.hash = `#explore?${change}`;
    };
    const driven = (wheel, soil) => {
      location.hash = '#run';
      views.get('run').drive('sandbox', wheel, soil);
    };
    views.set('optimise', new Optimise(new WorkerPhysics('optimize'), report, physics && { explore, drive: hasModule('drive') && driven }));
  }
  if (!report?.answer) views.set('run', new Run(drive, new WorkerPhysics('log'), report));

  // a page that brings a run opens with it
  const first = report?.answer ? 'optimise' : main.dataset.file || main.dataset.run || document.getElementById('embedded') ? 'run' : 'explore';

  function current() {
    const [, name = first, query = ''] = location.hash.match(/^#([a-z]+)(?:\?(.*))?$/s) ?? [];
    return [views.has(name) ? name : first, query];
  }

  function show() {
    const [name, query] = current();
    const view = views.get(name);
    for (const link of nav.children) link.toggleAttribute('aria-current', false);
    nav.querySelector(`[data-view="${name}"]`)?.setAttribute('aria-current', 'page');
    if (main.firstElementChild !== view.element) main.replaceChildren(view.element);
    view.open(query);
  }

  if (report) document.title = `${report.title}: Grouser`;
  nav.replaceChildren(...VIEWS.filter(([name]) => views.has(name)).map(([name, title]) => h('a', { href: `#${name}`, 'data-view': name }, title)));
  document.getElementById('tools').append(themeButton());
  addEventListener('hashchange', () => {
    if (location.hash !== written) show();
  });
  show();
  // the view is computed in the first frame, and its charts know their widths at the end of it
  requestAnimationFrame(() => requestAnimationFrame(() => {
    document.body.dataset.ready = 'true';
  }));
  // a server computes too: the same answers, for what a browser is too slow for
  const server = main.dataset.server ? new ServerPhysics() : null;
  window.grouser = { views, physics, server };
}

if (typeof document === 'undefined') {
  work();
} else {
  start().catch((error) => {
    document.getElementById('main').replaceChildren(h('p', { class: 'failed', role: 'alert' }, `The page cannot start: ${error.message}`));
    throw error;
  });
}
