// Light and dark: as the system has it, until the reader chooses.

import { h } from './dom.js';

const KEY = 'grouser-theme';

function stored() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null; // a page without storage
  }
}

/** The button that changes the theme. */
export function themeButton() {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const root = document.documentElement;
  const now = () => root.dataset.theme ?? (dark.matches ? 'dark' : 'light');
  const button = h('button', { type: 'button', class: 'quiet icon', 'aria-label': 'Light or dark' }, '◐');
  const choice = stored();
  if (choice === 'dark' || choice === 'light') root.dataset.theme = choice;
  button.addEventListener('click', () => {
    root.dataset.theme = now() === 'dark' ? 'light' : 'dark';
    try {
      localStorage.setItem(KEY, root.dataset.theme);
    } catch {
      // without storage the choice lasts as long as the page
    }
  });
  return button;
}
