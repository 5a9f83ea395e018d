// The page: its views and its address.

import { h } from './dom.js';
import { Explore } from './explore.js';
import { WasmPhysics } from './physics.js';
import { themeButton } from './theme.js';

const VIEWS = [['explore', 'Explore']];

async function start() {
  const main = document.getElementById('main');
  const nav = document.getElementById('views');
  const physics = await WasmPhysics.load('explore');
  const catalogue = await physics.ask({ call: 'catalogue' });

  let written = null;
  const moved = (view) => (query) => {
    if (view !== current()[0]) return;
    written = query ? `#${view}?${query}` : `#${view}`;
    if (location.hash !== written) history.replaceState(null, '', written);
  };
  const views = new Map([['explore', new Explore(physics, catalogue, moved('explore'))]]);

  function current() {
    const [, name = 'explore', query = ''] = location.hash.match(/^#([a-z]+)(?:\?(.*))?$/s) ?? [];
    return [views.has(name) ? name : 'explore', query];
  }

  function show() {
    const [name, query] = current();
    const view = views.get(name);
    for (const link of nav.children) link.toggleAttribute('aria-current', false);
    nav.querySelector(`[data-view="${name}"]`)?.setAttribute('aria-current', 'page');
    if (main.firstElementChild !== view.element) main.replaceChildren(view.element);
    view.open(query);
  }

  nav.replaceChildren(...VIEWS.map(([name, title]) => h('a', { href: `#${name}`, 'data-view': name }, title)));
  document.getElementById('tools').append(themeButton());
  addEventListener('hashchange', () => {
    if (location.hash !== written) show();
  });
  show();
  document.body.dataset.ready = 'true';
  window.grouser = { views, physics };
}

start().catch((error) => {
  document.getElementById('main').replaceChildren(h('p', { class: 'failed', role: 'alert' }, `The page cannot start: ${error.message}`));
  throw error;
});
