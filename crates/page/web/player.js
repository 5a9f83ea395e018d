// The player: the cursor's time, the times that charts show, playing, and following a live run.

import { h } from './dom.js';
import { clock, shown } from './format.js';

/** Where the cursor stands in a window that does not show the whole run, as a share of its width. */
const CURSOR_SHARE = 0.2;

export class Player {
  #calls;
  #span = [0, 1];
  #playing = null;

  /** The cursor's time, s. */
  time = 0;

  /** The times that charts show, s. */
  range = [0, 1];

  /** Does the cursor stay at the newest moment? */
  isFollowing = false;

  /** `moved()`: the cursor has another time; `ranged()`: charts show other times; `followed()`: to the newest moment. */
  constructor(calls) {
    this.#calls = calls;
    this.playButton = h('button', { type: 'button', class: 'primary play', 'aria-label': 'Play', on: { click: () => this.#toggle() } }, '▶');
    this.rate = h('select', { 'aria-label': 'Speed of playing' }, [1, 4, 16, 64].map((rate) => h('option', { value: rate, selected: rate === 4 }, `${rate}×`)));
    this.scrub = h('input', { type: 'range', 'aria-label': 'Time', step: 'any', on: { input: () => this.choose(Number(this.scrub.value)) } });
    this.now = h('output', { class: 'now' });
    this.zoom = h('select', { 'aria-label': 'Time shown', on: { change: () => this.#zoomTo() } },
      [['', 'whole run'], ['120', '2 min'], ['30', '30 s'], ['10', '10 s']].map(([value, text]) => h('option', { value }, text)));
    this.liveButton = h('button', { type: 'button', class: 'quiet', hidden: true, 'aria-pressed': 'false', on: { click: () => this.follow(!this.isFollowing) } }, 'Live');
    this.element = h('div', { class: 'card player' }, this.playButton, this.scrub, this.now, this.liveButton, this.rate, this.zoom);
  }

  /** Another run, from `start` to `end` (s): the whole of it, at its start. */
  begin(start, end) {
    this.pause();
    this.isFollowing = false;
    this.zoom.value = '';
    this.#span = [start, end];
    this.range = [start, end];
    this.time = start;
  }

  /** The run is from `start` to `end` now. */
  grow(start, end, isLive) {
    this.#span = [start, end];
    Object.assign(this.scrub, { min: start, max: end });
    this.liveButton.hidden = !isLive;
    if (!this.isFollowing) return;
    this.time = end;
    this.#fitRange();
  }

  /** A live run has ended. */
  end() {
    this.isFollowing = false;
    this.liveButton.hidden = true;
  }

  /** Goes to a time of the run. */
  seek(time) {
    const [start, end] = this.#span;
    this.time = Math.min(end, Math.max(start, time));
    this.scrub.value = this.time;
    this.scrub.style.setProperty('--share', `${((100 * (this.time - start)) / (end - start || 1)).toFixed(2)}%`);
    this.scrub.setAttribute('aria-valuetext', `${shown(this.time, 4)} s`);
    this.now.textContent = `${clock(this.time, 1)} / ${clock(end)}`;
    if (this.zoom.value && (this.time < this.range[0] || this.time > this.range[1])) {
      this.#zoomTo();
      return;
    }
    this.#calls.moved();
  }

  /** The reader chose a time: the picture stays. */
  choose(time) {
    this.follow(false);
    this.seek(time);
  }

  /** Stays at the newest moment of a live run, or no longer. */
  follow(on) {
    this.isFollowing = on;
    this.liveButton.setAttribute('aria-pressed', String(on));
    if (on) {
      this.pause();
      this.#calls.followed();
    }
  }

  pause() {
    cancelAnimationFrame(this.#playing);
    this.#playing = null;
    this.playButton.textContent = '▶';
    this.playButton.setAttribute('aria-label', 'Play');
  }

  #toggle() {
    if (this.#playing) {
      this.pause();
      return;
    }
    this.follow(false);
    const [start, end] = this.#span;
    if (this.time >= end) this.seek(start);
    this.playButton.textContent = '❚❚';
    this.playButton.setAttribute('aria-label', 'Pause');
    let last = performance.now();
    const frame = (now) => {
      this.seek(this.time + ((now - last) / 1e3) * Number(this.rate.value));
      last = now;
      if (this.time >= this.#span[1]) this.pause();
      else this.#playing = requestAnimationFrame(frame);
    };
    this.#playing = requestAnimationFrame(frame);
  }

  #fitRange() {
    const [start, end] = this.#span;
    const width = Number(this.zoom.value);
    const from = width ? Math.max(start, Math.min(this.time - CURSOR_SHARE * width, end - width)) : start;
    this.range = [from, width ? Math.min(end, from + width) : end];
  }

  #zoomTo() {
    this.#fitRange();
    this.#calls.ranged();
    this.seek(this.time);
  }
}
