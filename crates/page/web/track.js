// The way of the robot from above, coloured by slip, with the robot at the cursor's time.

import { h, svg } from './dom.js';
import { shown } from './format.js';
import { contours, groundAt, picture, soilNames } from './ground.js';
import { hasWheelPlaces, ruts } from './robot_view.js';
import { slipClass } from './slip_classes.js';
import { tickLabels, ticks } from './ticks.js';

const MARGIN = 34;
/** Between the chevrons that show which way the robot drove, and before the first, px. */
const CHEVRON_PX = 90;

/** The picture. `pick(time)` is called where the track is clicked, `over(place)` with what lies under the pointer. */
export class Track {
  #root = svg('svg', { class: 'track', role: 'img' });
  #pick;
  #run = null;
  #slips = [];
  #events = [];
  #others = [];
  #contours = [];
  #back = null;
  #over;
  #width = 0;
  #place = null;
  #index = 0;
  #robot = svg('g', { class: 'robot', visibility: 'hidden' }, svg('path', { d: 'M13 0 L-8 7.5 L-4.5 0 L-8 -7.5 Z' }));
  // the robot moves in a layer of its own: ground and way are not painted anew
  #layer = svg('svg', { class: 'track-layer', 'aria-hidden': 'true' }, this.#robot);

  constructor(pick, over = () => {}) {
    this.#pick = pick;
    this.#over = over;
    this.element = h('div', { class: 'track-box' }, this.#root, this.#layer);
    new ResizeObserver(([entry]) => {
      this.#width = Math.round(entry.contentRect.width);
      this.#render();
    }).observe(this.#root);
    this.#root.addEventListener('pointerdown', (event) => this.#nearest(event));
    this.#root.addEventListener('pointermove', (event) => this.#under(event));
    this.#root.addEventListener('pointerleave', () => this.#over(null));
  }

  /** Shows a run; `slips` is the greatest slip of its wheels at each moment, `others` runs to compare with. */
  show(run, slips, events, others = []) {
    this.#run = run;
    this.#slips = slips;
    this.#events = events;
    this.#others = others;
    this.#contours = run.ground ? contours(run.ground) : [];
    this.#render();
  }

  /** Moves the robot. */
  cursor(index) {
    this.#index = index;
    if (!this.#place || !this.#run) return;
    const { x_m: x, y_m: y, heading_deg: heading } = this.#run;
    if (!Number.isFinite(x[index])) {
      this.#robot.setAttribute('visibility', 'hidden');
      return;
    }
    const [px, py] = this.#place(x[index], y[index]);
    this.#robot.setAttribute('visibility', 'visible');
    this.#robot.setAttribute('transform', `translate(${px.toFixed(1)} ${py.toFixed(1)}) rotate(${(-heading[index]).toFixed(1)})`);
  }

  #nearest(event) {
    if (!this.#place) return;
    const box = this.#root.getBoundingClientRect();
    const [ex, ey] = [event.clientX - box.left, event.clientY - box.top];
    const { x_m: x, y_m: y, time_s: time } = this.#run;
    let best = [Infinity, 0];
    for (let i = 0; i < x.length; i += 1) {
      if (!Number.isFinite(x[i])) continue;
      const [px, py] = this.#place(x[i], y[i]);
      const far = (px - ex) ** 2 + (py - ey) ** 2;
      if (far < best[0]) best = [far, i];
    }
    if (best[0] < 900) this.#pick(time[best[1]]);
  }

  #under(event) {
    if (!this.#back || !this.#run?.ground) return;
    const box = this.#root.getBoundingClientRect();
    const [x, y] = this.#back(event.clientX - box.left, event.clientY - box.top);
    const found = groundAt(this.#run.ground, x, y);
    this.#over(found && { x, y, ...found });
  }

  /** The ground: shade, tints, contours with their heights. */
  #ground(seen) {
    const { ground } = this.#run;
    if (!ground) return [];
    const [x, y] = this.#place(ground.x_m[0], ground.y_m[1]);
    const [right, bottom] = this.#place(ground.x_m[1], ground.y_m[0]);
    const parts = [svg('image', { href: picture(ground), x, y, width: right - x, height: bottom - y, preserveAspectRatio: 'none', class: 'relief' })];
    const places = [];
    for (const { label, lines } of this.#contours) {
      const drawn = lines.map(([x1, y1, x2, y2]) => [...this.#place(x1, y1), ...this.#place(x2, y2)]);
      parts.push(svg('path', { class: 'contour', d: drawn.map(([x1, y1, x2, y2]) => `M${x1.toFixed(1)} ${y1.toFixed(1)}L${x2.toFixed(1)} ${y2.toFixed(1)}`).join('') }));
      // once a height, where it is seen, away from the other labels
      const free = drawn.find(([px, py]) => px > Math.max(x, MARGIN) + 30 && px < Math.min(right, seen.right) - 30 && py > Math.max(y, 8) + 16 && py < Math.min(bottom, seen.bottom) - 16 && places.every(([qx, qy]) => Math.hypot(px - qx, py - qy) > 70));
      if (!free) continue;
      places.push(free);
      parts.push(svg('text', { x: free[0], y: free[1] + 3, 'text-anchor': 'middle', class: 'contour-label' }, label));
    }
    const half = (this.#run.tile_m ?? 0) / 2;
    for (const tile of (half && this.#run.planned?.learnt) || []) {
      const [px, py] = this.#place(tile.x_m - half, tile.y_m + half);
      const [qx, qy] = this.#place(tile.x_m + half, tile.y_m - half);
      // the weaker, the redder: a slope of 20° is more than most relief has
      const weak = Math.min(1, Math.max(0, 1 - tile.steepest_deg / 20));
      parts.push(svg('rect', { x: px, y: py, width: qx - px, height: qy - py, class: 'tile', 'fill-opacity': (0.55 * weak).toFixed(2) },
        svg('title', {}, `learnt: the robot climbs ${shown(tile.steepest_deg)}° here, 90 % within ${shown(tile.steepest_low_deg)}° to ${shown(tile.steepest_high_deg)}°`)));
    }
    for (const { name, x: east, y: north } of soilNames(ground)) {
      const [px, py] = this.#place(east, north);
      parts.push(svg('text', { x: px, y: py, 'text-anchor': 'middle', class: 'soil-name' }, name));
    }
    return parts;
  }

  /** Which way the robot drove, along its way. */
  #chevrons() {
    const { x_m: x, y_m: y } = this.#run;
    let d = '';
    let from = null;
    let gone = 0;
    for (let i = 0; i < x.length; i += 1) {
      if (!Number.isFinite(x[i])) continue;
      const here = this.#place(x[i], y[i]);
      // a step of some pixels: the noise of a place at rest has no direction
      if (from === null) from = here;
      const [dx, dy] = [here[0] - from[0], here[1] - from[1]];
      const step = Math.hypot(dx, dy);
      if (step < 4) continue;
      gone += step;
      from = here;
      if (gone < CHEVRON_PX) continue;
      gone = 0;
      const [ux, uy] = [dx / step, dy / step];
      const corner = (side) => `${(here[0] - 2.6 * ux - side * 2.6 * uy).toFixed(1)} ${(here[1] - 2.6 * uy + side * 2.6 * ux).toFixed(1)}`;
      d += `M${corner(1)}L${here.map((k) => k.toFixed(1)).join(' ')}L${corner(-1)}`;
    }
    return svg('path', { d, class: 'chevron' });
  }

  #render() {
    if (!this.#width || !this.#run?.x_m) return;
    const runs = [this.#run, ...this.#others];
    let [low, high, left, right] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const { x_m: x, y_m: y } of runs) {
      // a place that is missing compares as neither
      for (let i = 0; i < x.length; i += 1) {
        if (x[i] < left) left = x[i];
        if (x[i] > right) right = x[i];
        if (y[i] < low) low = y[i];
        if (y[i] > high) high = y[i];
      }
    }
    if (!(right >= left)) {
      this.#root.replaceChildren();
      this.#robot.setAttribute('visibility', 'hidden');
      return;
    }
    const room = Math.max(0.4, 0.06 * Math.max(right - left, high - low));
    [left, right, low, high] = [left - room, right + room, low - room, high + room];
    const width = this.#width;
    const limit = width < 520 ? 260 : 400;
    let scale = (width - 2 * MARGIN) / (right - left);
    if ((high - low) * scale > limit) {
      scale = limit / (high - low);
      const spare = (width - 2 * MARGIN) / scale - (right - left);
      [left, right] = [left - spare / 2, right + spare / 2];
    }
    const least = 150 / scale;
    if (high - low < least) {
      const spare = least - (high - low);
      [low, high] = [low - spare / 2, high + spare / 2];
    }
    const height = (high - low) * scale + MARGIN + 14;
    this.#place = (x, y) => [MARGIN + (x - left) * scale, 8 + (high - y) * scale];
    this.#back = (px, py) => [left + (px - MARGIN) / scale, high - (py - 8) / scale];
    const at = (i, run) => this.#place(run.x_m[i], run.y_m[i]).map((k) => k.toFixed(1)).join(' ');

    const frame = { x: MARGIN, y: 8, width: (right - left) * scale, height: (high - low) * scale };
    const ground = svg('rect', { ...frame, class: 'ground-map' });
    const grid = svg('g', { class: 'grid' });
    const text = svg('g', { class: 'axis-text' });
    const across = ticks(left, right, width < 520 ? 4 : 8);
    const step = across.length > 1 ? across[1] - across[0] : 1;
    const up = [];
    for (let y = Math.ceil(low / step) * step; y <= high; y += step) up.push(Number(y.toPrecision(12)));
    tickLabels(across).forEach((label, i) => {
      const [x] = this.#place(across[i], 0);
      grid.append(svg('line', { x1: x, x2: x, y1: 8, y2: height - MARGIN + 8 + 12 }));
      text.append(svg('text', { x, y: height - 8, 'text-anchor': 'middle' }, i === across.length - 1 ? `${label} m` : label));
    });
    tickLabels(up).forEach((label, i) => {
      const [, y] = this.#place(0, up[i]);
      grid.append(svg('line', { x1: MARGIN, x2: MARGIN + (right - left) * scale, y1: y, y2: y }));
      text.append(svg('text', { x: MARGIN - 6, y: y + 4, 'text-anchor': 'end' }, label));
    });

    const sunk = svg('g', { class: 'ruts' });
    if (hasWheelPlaces(this.#run)) {
      const stride = Math.max(1, Math.floor(this.#run.x_m.length / 3000));
      for (const { d, depth, width_m } of ruts(this.#run, this.#place, 0, this.#run.x_m.length - 1, stride)) sunk.append(svg('path', { d, class: `rut rut-${depth}`, 'stroke-width': Math.max(0.8, width_m * scale).toFixed(1) }));
    }
    const ways = svg('g', { class: 'way' });
    for (const other of this.#others) ways.append(svg('path', { d: whole(other, (i) => at(i, other)), class: 'other-way' }, svg('title', {}, other.controller)));
    ways.append(svg('path', { d: whole(this.#run, (i) => at(i, this.#run)), class: 'way-edge' }));
    // one path a class of slip: thousands of moments stay a handful of elements
    const parts = new Map();
    const x = this.#run.x_m;
    const stride = Math.max(1, Math.floor(x.length / 6000));
    for (let i = stride; i < x.length; i += stride) {
      if (!Number.isFinite(x[i]) || !Number.isFinite(x[i - stride])) continue;
      let kind = -1;
      for (let k = i - stride + 1; k <= i; k += 1) kind = Math.max(kind, slipClass(this.#slips[k]));
      parts.set(kind, `${parts.get(kind) ?? ''}M${at(i - stride, this.#run)}L${at(i, this.#run)}`);
    }
    for (const [kind, d] of [...parts].sort(([a], [b]) => a - b)) ways.append(svg('path', { d, class: `slip-${kind < 0 ? 'none' : kind}` }));
    const marks = this.#events.slice(0, 60).map(({ x_m, y_m, name, number }) => {
      const [px, py] = this.#place(x_m, y_m);
      const title = svg('title', {}, name);
      if (!number) return svg('circle', { cx: px, cy: py, r: 4.5, class: 'event' }, title);
      return svg('g', { class: 'numbered' }, svg('circle', { cx: px, cy: py, r: 8 }), svg('text', { x: px, y: py + 3.5, 'text-anchor': 'middle' }, number), title);
    });
    const first = x.findIndex((value) => value === value);
    const [sx, sy] = this.#place(x[first], this.#run.y_m[first]);
    const start = svg('g', { class: 'start' }, svg('circle', { cx: sx, cy: sy, r: 3.5 }), svg('text', { x: sx, y: sy - 12, 'text-anchor': 'middle' }, 'start'));
    this.#root.setAttribute('viewBox', `0 0 ${width} ${height.toFixed(0)}`);
    this.#root.setAttribute('height', height.toFixed(0));
    this.#root.setAttribute('aria-label', `Path of the robot from above, ${shown(right - left - 2 * room)} m by ${shown(high - low - 2 * room)} m, coloured by slip`);
    this.#root.replaceChildren(ground, svg('svg', { ...frame, viewBox: Object.values(frame).join(' ') }, this.#ground({ right: MARGIN + frame.width, bottom: 8 + frame.height })), grid, text, sunk, ways, this.#chevrons(), ...marks, start);
    this.#layer.setAttribute('viewBox', `0 0 ${width} ${height.toFixed(0)}`);
    this.#layer.setAttribute('height', height.toFixed(0));
    // the cursor may have been set before there was room to draw
    this.cursor(this.#index);
  }
}

function whole(run, at) {
  let d = '';
  let pen = false;
  const stride = Math.max(1, Math.floor(run.x_m.length / 6000));
  for (let i = 0; i < run.x_m.length; i += stride) {
    if (!Number.isFinite(run.x_m[i])) {
      pen = false;
      continue;
    }
    d += `${pen ? 'L' : 'M'}${at(i)}`;
    pen = true;
  }
  return d;
}
