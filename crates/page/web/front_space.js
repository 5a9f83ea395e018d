// A front of three objectives in space: turned by dragging or with the arrow keys, linked with the other pictures.

import { h, svg } from './dom.js';
import { shown } from './format.js';

/** Width, height and half an edge of the box, pixels: on a phone drawn for its width. */
const WIDE = [520, 400, 130];
const NARROW = [330, 280, 70];
/** Where on an axis, −1 to 1, its lowest and greatest value are written: off the corners, which axes share. */
const END = 0.84;
/** Radians a pixel of dragging, and a press of a key. */
const [DRAG, KEY] = [0.008, 0.12];
/** The view from above stays between these, so that no axis turns over. */
const [FLAT, STEEP] = [0.05, 1.4];

/** Where the box is seen from first: azimuth and elevation, rad. */
export const FIRST_VIEW = { azimuth: 0.7, elevation: 0.45 };

/**
 * The card. `view` has azimuth and elevation and keeps them from one card to the next; `choose(i)` is called when a
 * compromise is clicked.
 */
export function frontInSpace({ front, names, knee, chosen, view, choose, narrow, isOut }) {
  const [width, height, half] = narrow ? NARROW : WIDE;
  const ranges = names.map((name) => {
    const values = front.map(({ objectives }) => objectives[name]);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return [low, high > low ? high : low + Math.max(1e-12, Math.abs(low))];
  });
  const unit = (point) => names.map((name, k) => 2 * ((point.objectives[name] - ranges[k][0]) / (ranges[k][1] - ranges[k][0])) - 1);
  const places = front.map(unit);
  const plot = svg('svg', {
    class: 'plot space', viewBox: `0 0 ${width} ${height}`, role: 'application', tabindex: 0,
    'aria-label': `${front.length} compromises over ${names.join(', ')}; the arrow keys turn the view`,
  });

  /** Picture and depth of a point of the box, −1 to 1; the third axis points up. */
  const project = ([x, y, z]) => {
    const [sin, cos] = [Math.sin(view.azimuth), Math.cos(view.azimuth)];
    const [across, away] = [x * cos - y * sin, x * sin + y * cos];
    const [s, c] = [Math.sin(view.elevation), Math.cos(view.elevation)];
    return [width / 2 + half * across, height / 2 - half * (z * c + away * s) * 0.95, away * c - z * s];
  };
  const line = (from, to, name) => {
    const [[x1, y1], [x2, y2]] = [project(from), project(to)];
    return svg('line', { x1, y1, x2, y2, class: name });
  };

  function draw() {
    const box = [];
    // the three planes behind the points
    const behind = [0, 1, 2].map((axis) => {
      const side = (sign) => project([0, 1, 2].map((k) => (k === axis ? sign : 0)))[2];
      return side(1) > side(-1) ? 1 : -1;
    });
    for (let axis = 0; axis < 3; axis += 1) {
      const [p, q] = [0, 1, 2].filter((k) => k !== axis);
      for (const [along, other] of [[p, q], [q, p]]) {
        for (const at of [-1, 0, 1]) {
          const end = (value) => {
            const out = [0, 0, 0];
            out[axis] = behind[axis];
            out[along] = value;
            out[other] = at;
            return out;
          };
          box.push(line(end(-1), end(1), 'gridline'));
        }
      }
    }
    // beside the upright axis there is room along it only
    const upright = ([x, y], words) => svg('text', {
      transform: `translate(${x + (x < width / 2 ? -8 : 16)} ${y}) rotate(-90)`, 'text-anchor': 'middle', class: 'axis-name',
    }, words);
    const labels = names.map((name, axis) => {
      // an axis stands on the edge where one plane behind meets one before
      const at = (value) => {
        const out = behind.map((sign) => -sign);
        if (axis === 2) out[0] = behind[0];
        else out[2] = -1;
        out[axis] = value;
        return out;
      };
      const [low, middle, high] = [-END, 0, END].map((value) => project(at(value)));
      const away = (place, by) => {
        const [dx, dy] = [place[0] - width / 2, place[1] - height / 2];
        const length = Math.hypot(dx, dy) || 1;
        return [place[0] + (by * dx) / length, place[1] + (by * dy) / length + 4];
      };
      const text = (place, by, words, kind) => {
        const [x, y] = away(place, by);
        return svg('text', { x, y, 'text-anchor': x < width / 2 - 8 ? 'end' : x > width / 2 + 8 ? 'start' : 'middle', class: kind }, words);
      };
      return svg('g', { class: 'axis-text' }, line(at(-1), at(1), 'parallel-axis'),
        text(low, 12, shown(ranges[axis][0])), text(high, 12, shown(ranges[axis][1])),
        axis === 2 ? upright(middle, name) : text(middle, 26, name, 'axis-name'));
    });
    const dots = places
      .map((place, i) => ({ i, place, seen: project(place) }))
      .sort((a, b) => b.seen[2] - a.seen[2])
      .flatMap(({ i, place, seen: [cx, cy] }) => [
        i === chosen ? line(place, [place[0], place[1], -1], 'drop-line') : null,
        svg('circle', {
          cx, cy, r: i === chosen ? 7 : 4.5, class: `front-dot${i === chosen ? ' is-chosen' : ''}${i === knee ? ' is-knee' : ''}${isOut(i) ? ' is-out' : ''}`, 'data-compromise': i, on: { click: () => choose(i) },
        }, svg('title', {}, names.map((name) => `${name} ${shown(front[i].objectives[name])}`).join(', '))),
      ]);
    plot.replaceChildren(...box, ...labels, ...dots.filter(Boolean));
  }

  const turn = (right, up) => {
    view.azimuth += right;
    view.elevation = Math.min(STEEP, Math.max(FLAT, view.elevation + up));
    draw();
  };
  let from = null;
  plot.addEventListener('pointerdown', (event) => {
    if (event.target.classList.contains('front-dot')) return;
    from = [event.clientX, event.clientY];
    plot.setPointerCapture(event.pointerId);
  });
  plot.addEventListener('pointermove', (event) => {
    if (!from || !(event.buttons & 1)) return;
    turn(DRAG * (from[0] - event.clientX), DRAG * (event.clientY - from[1]));
    from = [event.clientX, event.clientY];
  });
  plot.addEventListener('pointerup', () => { from = null; });
  plot.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [KEY, 0], ArrowRight: [-KEY, 0], ArrowUp: [0, KEY], ArrowDown: [0, -KEY] }[event.key];
    if (!step) return;
    event.preventDefault();
    turn(...step);
  });
  draw();
  return h('section', { class: 'card chart', 'aria-label': 'Three objectives in space' },
    h('header', {}, h('h3', {}, 'Three objectives in space'), h('span', { class: 'muted' }, 'drag to turn')), plot);
}
