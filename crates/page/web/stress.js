// The wheel in the soil: stress on its rim, forces, angles, and handles for radius, load and sinkage.

import { svg, svgSymbol } from './dom.js';
import { shown } from './format.js';

const ARROWS = 15;
/** Room for an angle with its symbol, pixels. */
const ANGLE_TEXT_WIDTH = 84;
/** Longest stress arrow in radii. */
const LONGEST = 0.66;
/** Length of the load's arrow in radii; other forces are in its scale. */
const LOAD_LENGTH = 0.62;

/** The picture. `act` has what a handle does: radius(metres), load(share of now), sinkage(metres). */
export class StressPicture {
  #act;
  #root;
  #last = null;
  #width = 0;
  #drag = null;

  constructor(act) {
    this.#act = act;
    this.#root = svg('svg', { class: 'stress', role: 'group', 'aria-label': 'Wheel in the soil with the stress on its rim' });
    this.element = this.#root;
    new ResizeObserver(([entry]) => {
      this.#width = Math.round(entry.contentRect.width);
      this.#render();
    }).observe(this.#root);
    this.#root.addEventListener('pointermove', (event) => this.#drag?.(event));
    for (const end of ['pointerup', 'pointercancel']) this.#root.addEventListener(end, () => { this.#drag = null; });
  }

  /** Shows a solved point of a state; without a profile the wheel alone. */
  show(state, point) {
    this.#last = { state, point };
    this.#render();
  }

  #render() {
    if (!this.#width || !this.#last) return;
    const { state, point } = this.#last;
    const width = this.#width;
    const height = width < 520 ? 330 : innerWidth < 1700 ? 430 : 540;
    const narrow = width < 520;
    const radius = Math.min(height / 2.84, width / (narrow ? 3.4 : 3.1));
    const cx = width * (narrow ? 0.5 : 0.52);
    const cy = radius * 1.08;
    const metres = point.running_radius_m ?? state.radius_m;
    const scale = radius / metres;
    const rad = Math.PI / 180;
    const rim = (theta, out = 0) => [cx + (radius + out) * Math.sin(theta), cy + (radius + out) * Math.cos(theta)];
    const at = (place) => place.map((k) => k.toFixed(1)).join(' ');

    const scene = svg('g', { transform: `rotate(${-state.slope_deg} ${cx} ${cy})` });
    const solved = point.profile !== undefined;
    const entry = solved ? point.theta_1_deg * rad : 0;
    const exit = solved ? point.theta_2_deg * rad : 0;

    // ground: level ahead of the wheel, as the wheel leaves it behind
    const far = 3 * (width + height);
    const ahead = rim(entry);
    const behind = rim(exit);
    let ground = `M${cx + far} ${cy + far}L${cx + far} ${ahead[1]}`;
    const steps = 60;
    for (let i = 0; i <= steps; i += 1) ground += `L${at(rim(entry + ((exit - entry) * i) / steps))}`;
    ground += `L${cx - far} ${behind[1]}L${cx - far} ${cy + far}Z`;
    scene.append(svg('path', { d: ground, class: 'ground' }));
    scene.append(svg('path', { d: `M${cx + far} ${ahead[1]}L${at(ahead)}M${at(behind)}L${cx - far} ${behind[1]}`, class: 'ground-line' }));

    this.#wheel(scene, state, { cx, cy, radius, scale });
    if (solved) {
      this.#stress(scene, point, rim, at);
      this.#angles(scene, point, { cx, cy, radius, rim, at, rad });
      this.#sinkage(scene, point, { cx, cy, radius, rim, scale, narrow });
    }
    const upright = svg('g', {});
    if (solved) this.#forces(scene, point, { cx, cy, radius });
    this.#radiusHandle(scene, state, { cx, cy, radius, narrow });
    if (state.slope_deg !== 0) {
      upright.append(svg('text', { x: width - 14, y: height - 14, 'text-anchor': 'end', class: 'picture-note' }, `slope ${shown(state.slope_deg)}°`));
    }
    this.#root.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#root.setAttribute('height', height);
    const had = document.activeElement?.dataset?.handle;
    this.#root.replaceChildren(scene, upright);
    if (had) this.#root.querySelector(`[data-handle="${had}"]`)?.focus();
  }

  #wheel(scene, state, { cx, cy, radius, scale }) {
    const body = svg('g', { class: 'wheel' });
    const count = Math.min(state.grouser_count, 80);
    const height = state.grouser_height_m * scale;
    if (count >= 1 && height > 0) {
      const thick = Math.max(1.5, state.grouser_thickness_m * scale);
      for (let i = 0; i < count; i += 1) {
        const turn = (360 * i) / count;
        body.append(svg('rect', {
          x: cx - thick / 2, y: cy + radius, width: thick, height, class: 'lug', transform: `rotate(${turn} ${cx} ${cy})`,
        }));
      }
    }
    body.append(svg('circle', { cx, cy, r: radius, class: 'tyre' }));
    body.append(svg('circle', { cx, cy, r: radius * 0.9, class: 'inner-rim' }));
    for (let i = 0; i < 5; i += 1) {
      const angle = (2 * Math.PI * (i + 0.25)) / 5;
      const from = [cx + radius * 0.11 * Math.sin(angle), cy + radius * 0.11 * Math.cos(angle)];
      const to = [cx + radius * 0.9 * Math.sin(angle), cy + radius * 0.9 * Math.cos(angle)];
      body.append(svg('line', { x1: from[0], y1: from[1], x2: to[0], y2: to[1], class: 'spoke' }));
    }
    body.append(svg('circle', { cx, cy, r: radius * 0.11, class: 'hub' }));
    scene.append(body);
  }

  #stress(scene, point, rim, at) {
    const { theta_deg, normal_stress_pa, shear_stress_pa } = point.profile;
    const rad = Math.PI / 180;
    const most = Math.max(...normal_stress_pa, ...shear_stress_pa.map(Math.abs), 1e-9);
    const radius = rim(0)[1] - (rim(Math.PI)[1] + rim(0)[1]) / 2;
    const length = (stress) => (LONGEST * radius * stress) / most;
    const outline = (stresses) => {
      const there = theta_deg.map((theta) => at(rim(theta * rad)));
      const back = theta_deg.map((theta, i) => at(rim(theta * rad, length(stresses[i])))).reverse();
      return { area: `M${there.join('L')}L${back.join('L')}Z`, edge: `M${back.join('L')}` };
    };
    const normal = outline(normal_stress_pa);
    const shear = outline(shear_stress_pa.map(Math.abs));
    scene.append(svg('path', { d: normal.area, class: 'normal-area' }), svg('path', { d: normal.edge, class: 'normal-edge' }));
    scene.append(svg('path', { d: shear.area, class: 'shear-area' }), svg('path', { d: shear.edge, class: 'shear-edge' }));
    const last = theta_deg.length - 1;
    for (let k = 1; k < ARROWS; k += 1) {
      const i = Math.round((last * k) / ARROWS);
      const theta = theta_deg[i] * rad;
      const long = length(normal_stress_pa[i]);
      if (long > 5) scene.append(arrow(rim(theta, long), rim(theta, 1.5), 'normal-arrow'));
      // shear: along the rim, on the side to which the soil pushes it
      const along = length(shear_stress_pa[i]) * 0.55;
      if (Math.abs(along) > 7 && k % 2 === 0) {
        const from = rim(theta, 7);
        const way = [Math.cos(theta), -Math.sin(theta)];
        scene.append(arrow(
          [from[0] - (way[0] * along) / 2, from[1] - (way[1] * along) / 2],
          [from[0] + (way[0] * along) / 2, from[1] + (way[1] * along) / 2], 'shear-arrow'));
      }
    }
  }

  #angles(scene, point, { cx, cy, radius, rim, at, rad }) {
    const line = (theta, name) => scene.append(svg('path', { d: `M${cx} ${cy}L${at(rim(theta))}`, class: name }));
    line(0, 'angle-line');
    line(point.theta_1_deg * rad, 'angle-line');
    if (Math.abs(point.theta_2_deg) > 1.5) line(point.theta_2_deg * rad, 'angle-line');
    line(point.theta_m_deg * rad, 'angle-line faint');
    const reach = 0.46 * radius;
    const arc = (to) => {
      const end = [cx + reach * Math.sin(to), cy + reach * Math.cos(to)];
      return `M${cx} ${cy + reach}A${reach} ${reach} 0 0 ${to > 0 ? 0 : 1} ${at(end)}`;
    };
    scene.append(svg('path', { d: arc(point.theta_1_deg * rad), class: 'angle-arc' }));
    const y = rim(point.theta_1_deg * rad)[1];
    // within the picture on a phone too
    const x = Math.min(cx + radius * (point.theta_1_deg > 50 ? 1.02 : 0.92) + 12, this.#width - ANGLE_TEXT_WIDTH);
    scene.append(svg('text', { x, y: y - 26, class: 'angle-text' }, svgSymbol('θ_1'), ` = ${shown(point.theta_1_deg)}°`));
    scene.append(svg('text', { x, y: y - 8, class: 'angle-text muted' }, svgSymbol('θ_m'), ` = ${shown(point.theta_m_deg)}°`));
    if (Math.abs(point.theta_2_deg) > 1.5) {
      const [bx, by] = rim(point.theta_2_deg * rad);
      scene.append(svg('text', { x: bx - 14, y: by - 8, 'text-anchor': 'end', class: 'angle-text muted' }, svgSymbol('θ_2'), ` = ${shown(point.theta_2_deg)}°`));
    }
  }

  #sinkage(scene, point, { cx, cy, radius, rim, scale, narrow }) {
    const top = rim(point.theta_1_deg * (Math.PI / 180))[1];
    const bottom = cy + radius;
    const x = cx - radius * 1.22;
    scene.append(svg('line', { x1: x - 10, x2: x + radius * 0.9, y1: top, y2: top, class: 'measure faint' }));
    scene.append(svg('line', { x1: x - 10, x2: cx, y1: bottom, y2: bottom, class: 'measure faint' }));
    scene.append(svg('line', { x1: x, x2: x, y1: top, y2: bottom, class: 'measure' }));
    const place = narrow ? { x: 10, y: top - 14 } : { x: x - 14, y: (top + bottom) / 2 + 5, 'text-anchor': 'end' };
    scene.append(svg('text', { ...place, class: 'angle-text' }, svgSymbol('z'), ` = ${shown(point.sinkage_m * 1e3)} mm`));
    scene.append(this.#handle('sinkage', [x, top], 'Sinkage; the load follows', `${shown(point.sinkage_m * 1e3)} mm`, {
      drag: (dx, dy) => this.#act.sinkage(Math.max(1e-4, point.sinkage_m - dy / scale)),
      step: (k) => this.#act.sinkage(point.sinkage_m * 1.02 ** k),
    }));
  }

  #forces(scene, point, { cx, cy, radius }) {
    const load = point.vertical_force_n;
    if (!(load > 0)) return;
    const perNewton = (LOAD_LENGTH * radius) / load;
    const tip = [cx, cy + LOAD_LENGTH * radius];
    scene.append(arrow([cx, cy], tip, 'force load'));
    scene.append(svg('text', { x: cx - 9, y: cy + 0.36 * radius, 'text-anchor': 'end', class: 'force-text load' }, svgSymbol('W'), ` ${shown(load)} N`));
    const pull = Math.max(-1.6 * radius, Math.min(1.6 * radius, point.drawbar_pull_n * perNewton));
    if (Math.abs(pull) > 4) {
      scene.append(arrow([cx, cy], [cx + pull, cy], `force ${pull > 0 ? 'pull' : 'drag'}`));
    }
    const side = pull >= 0 ? 1 : -1;
    scene.append(svg('text', { x: cx + side * Math.max(18, Math.min(Math.abs(pull), 0.3 * radius)), y: cy - 12, 'text-anchor': side > 0 ? 'start' : 'end', class: `force-text ${pull >= 0 ? 'pull' : 'drag'}` }, svgSymbol('F_DP'), ` ${shown(point.drawbar_pull_n)} N`));
    // torque: an arc above the hub, clockwise when it drives
    const reach = 0.58 * radius;
    const drives = point.torque_nm >= 0;
    const [from, to] = drives ? [-0.62, 0.62] : [0.62, -0.62];
    const on = (angle) => [cx + reach * Math.sin(angle), cy - reach * Math.cos(angle)];
    const [a, b] = [on(from), on(to)];
    const tangent = drives ? 1 : -1;
    scene.append(svg('path', { d: `M${a[0]} ${a[1]}A${reach} ${reach} 0 0 ${drives ? 1 : 0} ${b[0]} ${b[1]}`, class: 'torque' }));
    scene.append(head(b, [tangent * Math.cos(to), tangent * Math.sin(to)], 'torque-head', 9));
    scene.append(svg('text', { x: cx, y: cy - reach - 8, 'text-anchor': 'middle', class: 'force-text torque-text' }, svgSymbol('T'), ` ${shown(point.torque_nm)} N m`));
    const long = LOAD_LENGTH * radius;
    scene.append(this.#handle('load', tip, 'Load', `${shown(load)} N`, {
      drag: (dx, dy) => this.#act.load(Math.max(0.05, (long + dy) / long)),
      step: (k) => this.#act.load(1.02 ** k),
    }));
  }

  #radiusHandle(scene, state, { cx, cy, radius, narrow }) {
    const angle = (-130 * Math.PI) / 180;
    const place = [cx + radius * Math.sin(angle), cy + radius * Math.cos(angle)];
    if (!narrow) scene.append(svg('text', { x: place[0] - 12, y: place[1] - 6, 'text-anchor': 'end', class: 'angle-text muted' }, svgSymbol('r'), ` = ${shown(state.radius_m * 1e3)} mm`));
    scene.append(this.#handle('radius', place, 'Radius of the wheel', `${shown(state.radius_m * 1e3)} mm`, {
      drag: (dx, dy) => {
        const out = (dx * Math.sin(angle) + dy * Math.cos(angle)) / radius;
        this.#act.radius(Math.max(0.01, state.radius_m * (1 + out)));
      },
      step: (k) => this.#act.radius(state.radius_m * 1.02 ** k),
    }));
  }

  /** A round handle that is dragged, or moved with the arrow keys. */
  #handle(name, [x, y], label, text, { drag, step }) {
    const knob = svg('g', {
      class: 'handle', tabindex: 0, role: 'slider', 'data-handle': name, 'aria-label': label, 'aria-valuetext': text,
      'aria-valuenow': Number.parseFloat(text.replace('−', '-')) || 0, transform: `translate(${x} ${y})`,
    }, svg('circle', { r: 14, class: 'handle-reach' }), svg('circle', { r: 6, class: 'handle-knob' }), svg('title', {}, `${label}: drag, or use the arrow keys`));
    knob.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      knob.focus();
      this.#root.setPointerCapture(event.pointerId);
      const start = [event.clientX, event.clientY];
      const { state } = this.#last;
      const turn = (state.slope_deg * Math.PI) / 180;
      this.#drag = (move) => {
        const [sx, sy] = [move.clientX - start[0], move.clientY - start[1]];
        drag(sx * Math.cos(turn) - sy * Math.sin(turn), sx * Math.sin(turn) + sy * Math.cos(turn));
      };
    });
    knob.addEventListener('keydown', (event) => {
      const way = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
      if (!way) return;
      event.preventDefault();
      step(way * (event.shiftKey ? 10 : 1));
    });
    return knob;
  }
}

function arrow(from, to, name) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const long = Math.hypot(dx, dy) || 1;
  const size = name.startsWith('force') ? 10 : 6;
  const way = [dx / long, dy / long];
  const neck = [to[0] - way[0] * size * 0.8, to[1] - way[1] * size * 0.8];
  return svg('g', { class: name }, svg('line', { x1: from[0], y1: from[1], x2: neck[0], y2: neck[1] }), head(to, way, 'head', size));
}

function head([x, y], [wx, wy], name, size) {
  const back = [x - wx * size, y - wy * size];
  const half = size * 0.42;
  const points = [[x, y], [back[0] - wy * half, back[1] + wx * half], [back[0] + wy * half, back[1] - wx * half]];
  return svg('polygon', { points: points.map((p) => p.map((k) => k.toFixed(1)).join(',')).join(' '), class: name });
}
