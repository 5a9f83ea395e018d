// Limits on the axes of parallel coordinates: dragged along an axis, or moved with the arrow keys.

import { svg } from './dom.js';
import { shown } from './format.js';

/** A press of a key as a share of the axis. */
const KEY_SHARE = 0.05;
/** Less than this is a click, which drops the limits of an axis, px. */
const CLICK_PX = 3;

/** The limits by the names of their axes; `changed()` is called when one has moved. */
export class Brushes {
  #limits = new Map();
  #changed;

  constructor(changed) {
    this.#changed = changed;
  }

  /** Is an axis limited? */
  get any() {
    return this.#limits.size > 0;
  }

  /** Drops all limits. */
  clear() {
    this.#limits.clear();
  }

  /** Is a compromise within the limits of all `axes` ({name, low, high, of})? */
  hold(axes, compromise) {
    return axes.every(({ name, low, high, of }) => {
      const limits = this.#limits.get(name);
      if (!limits || !(high > low)) return true;
      const share = (of(compromise) - low) / (high - low);
      return share >= limits[0] - 1e-9 && share <= limits[1] + 1e-9;
    });
  }

  /** What is dragged on an axis at `x`, between `top` and `top + height`, `reach` to both sides. */
  element({ name, x, low, high }, { top, height, reach }) {
    const mark = svg('rect', { class: 'brush', x: x - 6, width: 12 });
    const place = svg('rect', { class: 'brush-reach', x: x - reach, width: 2 * reach, y: top, height, tabindex: 0, role: 'slider', 'aria-orientation': 'vertical', 'aria-label': `Limits of ${name}`, 'aria-valuemin': low, 'aria-valuemax': high });
    const draw = () => {
      const limits = this.#limits.get(name);
      const [from, to] = limits ?? [0, 1];
      const [least, most] = [from, to].map((share) => low + share * (high - low));
      mark.setAttribute('visibility', limits ? 'visible' : 'hidden');
      mark.setAttribute('y', top + height * (1 - to));
      mark.setAttribute('height', Math.max(1, height * (to - from)));
      place.setAttribute('aria-valuenow', most);
      place.setAttribute('aria-valuetext', limits ? `${shown(least)} to ${shown(most)}` : 'no limits');
    };
    const set = (limits) => {
      if (limits && (limits[0] > 0 || limits[1] < 1)) this.#limits.set(name, limits);
      else this.#limits.delete(name);
      draw();
      this.#changed();
    };
    let start = null;
    // the picture is scaled to its card
    const shareAt = (event) => {
      const box = place.getBoundingClientRect();
      return Math.min(1, Math.max(0, 1 - (event.clientY - box.top) / box.height));
    };
    place.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      place.setPointerCapture(event.pointerId);
      start = { y: event.clientY, share: shareAt(event) };
    });
    place.addEventListener('pointermove', (event) => {
      if (!start || Math.abs(event.clientY - start.y) < CLICK_PX) return;
      const share = shareAt(event);
      set([Math.min(share, start.share), Math.max(share, start.share)]);
    });
    place.addEventListener('pointerup', (event) => {
      if (start && Math.abs(event.clientY - start.y) < CLICK_PX) set(null);
      start = null;
    });
    place.addEventListener('pointercancel', () => { start = null; });
    place.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') set(null);
      const step = { ArrowUp: KEY_SHARE, ArrowDown: -KEY_SHARE }[event.key];
      if (!step) return;
      event.preventDefault();
      const [from, to] = this.#limits.get(name) ?? [0, 1];
      if (event.shiftKey) set([Math.max(0, Math.min(to, from + step)), to]);
      else set([from, Math.min(1, Math.max(from, to + step))]);
    });
    draw();
    return [mark, place];
  }
}
