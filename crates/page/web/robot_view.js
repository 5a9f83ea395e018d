// The robot from above at the cursor's time: its wheels by slip, the ground's forces on them, and the ruts around.

import { h, svg } from './dom.js';
import { shown } from './format.js';
import { slipClass } from './slip_classes.js';

/** Room around the outermost wheel, m. */
const ROOM_M = 0.22;
/** Width and height of the picture, and the length of the bar that is the arrows' scale, px. */
const [SIZE, BAR_PX] = [300, 60];
/** Forces up to this share of all are within one and a half bars. */
const USUAL_SHARE = 0.98;
/** Moments that are looked at for the scale. */
const SCALE_MOMENTS = 2000;
/** Depths of ruts, m, from which they are drawn darker. */
const DEPTHS_M = [0.005, 0.015, 0.03];

/** Does a run have what the picture shows? */
export function hasWheelPlaces(run) {
  return run.wheels.length > 0 && run.wheels.every((wheel) => wheel.wheel_x_m?.length && wheel.wheel_y_m?.length);
}

/** The ruts of a run up to the moment `last`, from `first` on: [{d, kind, width_m}]; `place` maps metres to pixels. */
export function ruts(run, place, first = 0, last = run.time_s.length - 1, stride = 1) {
  const parts = new Map();
  for (const { wheel_x_m: x, wheel_y_m: y, sinkage_m: sinkage, width_m: width } of run.wheels) {
    for (let i = first + stride; i <= last; i += stride) {
      const kind = `${DEPTHS_M.filter((depth) => sinkage[i] >= depth).length} ${width}`;
      const from = place(x[i - stride], y[i - stride]);
      const to = place(x[i], y[i]);
      parts.set(kind, `${parts.get(kind) ?? ''}M${from[0].toFixed(1)} ${from[1].toFixed(1)}L${to[0].toFixed(1)} ${to[1].toFixed(1)}`);
    }
  }
  return [...parts].map(([kind, d]) => ({ d, depth: Number(kind.split(' ')[0]), width_m: Number(kind.split(' ')[1]) }));
}

/** A round force that most forces of a run along and across its wheels do not exceed by half, N. */
export function roundForce({ wheels }) {
  const sizes = [];
  for (const { drawbar_pull_n: along, side_force_n: across } of wheels) {
    const stride = Math.max(1, Math.floor(along.length / SCALE_MOMENTS));
    for (let i = 0; i < along.length; i += stride) sizes.push(...[along[i], across[i]].map(Math.abs).filter(Number.isFinite));
  }
  sizes.sort((a, b) => a - b);
  const usual = sizes[Math.floor(USUAL_SHARE * (sizes.length - 1))] / 1.5;
  if (!(usual > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(usual));
  return power * [1, 2, 5, 10].find((k) => k * power >= usual);
}

/** The picture, in a card of its own. */
export class RobotView {
  #root = svg('svg', { class: 'robot-view', role: 'img' });
  #run = null;
  #reach = 1;
  #bar = 1;
  #index = null;

  constructor() {
    this.element = h('section', { class: 'card robot-card', 'aria-label': 'Robot from above' },
      h('header', {}, h('h2', {}, 'Forces of the ground on the wheels')), this.#root,
      h('p', { class: 'key' }, h('span', { class: 'key-pull' }, 'along: drives'), h('span', { class: 'key-drag' }, 'along: holds back'), h('span', { class: 'key-side' }, 'sideways'), h('span', { class: 'key-rut' }, 'rut'), this.scale = h('span', { class: 'plain' })));
  }

  show(run) {
    this.#index = null;
    this.#run = hasWheelPlaces(run) ? run : null;
    this.element.hidden = !this.#run;
    if (!this.#run) return;
    this.#bar = roundForce(run);
    this.scale.textContent = `bar: ${shown(this.#bar, 1)} N; the number is the load`;
    this.#reach = ROOM_M + Math.max(...run.wheels.map((wheel) => Math.hypot(wheel.wheel_x_m[0] - run.x_m[0], wheel.wheel_y_m[0] - run.y_m[0])));
  }

  /** Shows a moment. */
  cursor(index) {
    const run = this.#run;
    if (!run || !(index >= 0) || index === this.#index) return;
    this.#index = index;
    const size = SIZE;
    const scale = size / (2 * this.#reach);
    const [x, y, heading] = [run.x_m[index], run.y_m[index], (run.heading_deg[index] * Math.PI) / 180];
    // the robot drives upwards in the picture
    const turn = Math.PI / 2 - heading;
    const place = (east, north) => {
      const [right, up] = [(east - x) * Math.cos(turn) - (north - y) * Math.sin(turn), (east - x) * Math.sin(turn) + (north - y) * Math.cos(turn)];
      return [size / 2 + right * scale, size / 2 - up * scale];
    };
    // ruts as far back as the picture reaches
    let first = index;
    const far = (2 * this.#reach) ** 2;
    while (first > 0 && (run.x_m[first] - x) ** 2 + (run.y_m[first] - y) ** 2 < far) first -= 1;
    const parts = ruts(run, place, first, index).map(({ d, depth, width_m }) => svg('path', { d, class: `rut rut-${depth}`, 'stroke-width': (width_m * scale).toFixed(1) }));
    const words = [];
    const arrows = [];
    for (const wheel of run.wheels) {
      const [px, py] = place(wheel.wheel_x_m[index], wheel.wheel_y_m[index]);
      const own = wheel.wheel_heading_deg ? ((wheel.wheel_heading_deg[index] * Math.PI) / 180) + turn : Math.PI / 2;
      const [ahead, left] = [[Math.cos(own), -Math.sin(own)], [-Math.sin(own), -Math.cos(own)]];
      const [along, across, load] = [wheel.drawbar_pull_n[index], wheel.side_force_n[index], wheel.load_n[index]];
      const kind = slipClass((wheel.shown ?? wheel).slip[index]);
      const about = `${wheel.name}: ${shown(along, 2)} N along, ${shown(across, 2)} N to the left, load ${shown(load, 2)} N, sunk ${shown(1e3 * wheel.sinkage_m[index], 2)} mm`;
      words.push(about);
      const [length, width] = [2 * wheel.radius_m * scale, wheel.width_m * scale];
      parts.push(svg('rect', { x: -length / 2, y: -width / 2, width: length, height: width, rx: 3, transform: `translate(${px.toFixed(1)} ${py.toFixed(1)}) rotate(${((-own * 180) / Math.PI).toFixed(1)})`, class: `wheel-from-above slip-fill-${kind < 0 ? 'none' : kind}` }, svg('title', {}, about)));
      // beside the wheel, away from the middle
      const outwards = px < size / 2 - 2 ? -1 : 1;
      if (load > 0) parts.push(svg('text', { x: px + outwards * (width / 2 + 6), y: py + length / 2 - 1, 'text-anchor': outwards < 0 ? 'end' : 'start' }, `${shown(load, 2)} N`));
      const pixels = BAR_PX / this.#bar;
      arrows.push(arrow([px, py], ahead, along * pixels, along < 0 ? 'drag' : 'pull'), arrow([px, py], left, across * pixels, 'side'));
    }
    // arrows over all wheels
    parts.push(...arrows);
    const [bx, by] = [12, size - 12];
    parts.push(svg('path', { d: `M${bx} ${by}h${BAR_PX}m0 -4v8m${-BAR_PX} 0v-8`, class: 'measure' }), svg('text', { x: bx, y: by - 9 }, `${shown(this.#bar, 1)} N`), svg('path', { d: 'M0 -9 L6 7 L0 3 L-6 7 Z', transform: `translate(${size / 2} ${size / 2})`, class: 'robot-centre' }));
    this.#root.setAttribute('viewBox', `0 0 ${size} ${size}`);
    this.#root.setAttribute('aria-label', words.join('; '));
    this.#root.replaceChildren(...parts);
  }
}

/** An arrow from a place along a direction of length one; nothing below five pixels. */
function arrow([x, y], [dx, dy], wanted, kind) {
  // what is beyond the scale ends within the picture
  const length = Math.max(-2.5 * BAR_PX, Math.min(2.5 * BAR_PX, wanted));
  if (!(Math.abs(length) >= 5)) return '';
  const sign = Math.sign(length);
  const [tx, ty] = [x + dx * length, y + dy * length];
  const head = (side) => `${(tx - sign * 7 * dx + side * 4 * dy).toFixed(1)} ${(ty - sign * 7 * dy - side * 4 * dx).toFixed(1)}`;
  return svg('g', { class: `force ${kind}` },
    svg('line', { x1: x.toFixed(1), y1: y.toFixed(1), x2: (tx - sign * 5 * dx).toFixed(1), y2: (ty - sign * 5 * dy).toFixed(1) }),
    svg('path', { d: `M${tx.toFixed(1)} ${ty.toFixed(1)}L${head(1)}L${head(-1)}Z`, class: 'head' }));
}
