// The ground of a drive as a picture: light and shade by its slope, tints by its soil, contours by its height.

import { tickLabels, ticks } from './ticks.js';

/** Slopes are shown this much steeper, so that gentle ground has a shape. */
const EXAGGERATION = 2;
const LIGHT = [-0.5, 0.5, Math.SQRT1_2];
/** Tints of all soils but the first, red, green, blue. */
const TINTS = [[150, 110, 60], [110, 140, 60], [70, 120, 160], [160, 80, 110]];
const pictures = new WeakMap();

/** A picture of shade and tints without the ground's own colour, as a data address; the same one for the same ground. */
export function picture(ground) {
  if (!pictures.has(ground)) pictures.set(ground, painted(ground));
  return pictures.get(ground);
}

function painted({ columns, height_m: height, soil, x_m, y_m }) {
  const rows = height.length / columns;
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [columns, rows];
  const context = canvas.getContext('2d');
  const image = context.createImageData(columns, rows);
  const step = [(x_m[1] - x_m[0]) / (columns - 1), (y_m[1] - y_m[0]) / (rows - 1)];
  const slope = (a, b, width) => (height[a] === null || height[b] === null ? 0 : (EXAGGERATION * (height[b] - height[a])) / width);
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const at = row * columns + column;
      const [left, right] = [column ? at - 1 : at, column + 1 < columns ? at + 1 : at];
      const [below, above] = [row ? at - columns : at, row + 1 < rows ? at + columns : at];
      const across = slope(left, right, step[0] * (right - left));
      const up = slope(below, above, (step[1] * (above - below)) / columns);
      const lit = Math.max(0, (LIGHT[2] - LIGHT[0] * across - LIGHT[1] * up) / Math.hypot(1, across, up)) - LIGHT[2];
      const tint = TINTS[(soil[at] - 1) % TINTS.length];
      // shade is black or white over the tint, each as far as it goes
      const shade = Math.min(0.34, Math.abs(lit) * 0.8);
      const share = tint ? 0.42 : 0;
      const alpha = height[at] === null ? 0.5 : shade + share * (1 - shade);
      const white = lit > 0 ? 255 : 0;
      const to = 4 * ((rows - 1 - row) * columns + column);
      for (let k = 0; k < 3; k += 1) image.data[to + k] = height[at] === null ? 128 : (shade * white + share * (1 - shade) * (tint?.[k] ?? 0)) / (alpha || 1);
      image.data[to + 3] = 255 * alpha;
    }
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

/** Contours at round heights: [{label, lines: [[x, y, x, y], …]}], m. Level ground has none. */
export function contours({ columns, height_m: height, x_m, y_m }) {
  const known = height.filter((value) => value !== null);
  const [low, high] = [known.reduce((a, b) => Math.min(a, b), Infinity), known.reduce((a, b) => Math.max(a, b), -Infinity)];
  if (!(high - low > 1e-3)) return [];
  const levels = ticks(low, high, 8);
  const labels = tickLabels(levels);
  const rows = height.length / columns;
  const node = (column, row) => [x_m[0] + ((x_m[1] - x_m[0]) * column) / (columns - 1), y_m[0] + ((y_m[1] - y_m[0]) * row) / (rows - 1), height[row * columns + column]];
  const found = levels.map((level, i) => ({ level, label: `${labels[i]} m`, lines: [] }));
  for (let row = 0; row + 1 < rows; row += 1) {
    for (let column = 0; column + 1 < columns; column += 1) {
      const corners = [node(column, row), node(column + 1, row), node(column + 1, row + 1), node(column, row + 1)];
      if (corners.some(([, , z]) => z === null)) continue;
      // two triangles a cell: a contour crosses each once or not at all
      for (const triangle of [[0, 1, 2], [0, 2, 3]]) {
        const three = triangle.map((k) => corners[k]);
        const [least, most] = [Math.min(...three.map(([, , z]) => z)), Math.max(...three.map(([, , z]) => z))];
        for (const { level, lines } of found) {
          if (level <= least || level > most) continue;
          lines.push(crossing(three, level));
        }
      }
    }
  }
  return found.filter(({ lines }) => lines.length);
}

/** Where a level crosses a triangle: the two ends. */
export function crossing(corners, level) {
  const ends = [];
  corners.forEach(([x, y, z], k) => {
    const [x2, y2, z2] = corners[(k + 1) % 3];
    if ((z < level) === (z2 < level)) return;
    const share = (level - z) / (z2 - z);
    ends.push(x + share * (x2 - x), y + share * (y2 - y));
  });
  return ends;
}

/** Where the names of all soils but the first stand: [{name, x, y}], the mean place of each. */
export function soilNames({ columns, soil, soils, x_m, y_m }) {
  const rows = soil.length / columns;
  const sums = soils.map(() => [0, 0, 0]);
  soil.forEach((index, at) => {
    sums[index][0] += 1;
    sums[index][1] += at % columns;
    sums[index][2] += Math.floor(at / columns);
  });
  return soils.map((name, i) => ({ name, x: x_m[0] + ((x_m[1] - x_m[0]) * sums[i][1]) / (sums[i][0] * (columns - 1)), y: y_m[0] + ((y_m[1] - y_m[0]) * sums[i][2]) / (sums[i][0] * (rows - 1)) }))
    .filter((_, i) => i > 0 && sums[i][0] > 0);
}

/** Height and soil at a place; null beyond the ground or where it is not known. */
export function groundAt({ columns, height_m: height, soil, soils, x_m, y_m }, x, y) {
  const rows = height.length / columns;
  const column = Math.round(((x - x_m[0]) / (x_m[1] - x_m[0])) * (columns - 1));
  const row = Math.round(((y - y_m[0]) / (y_m[1] - y_m[0])) * (rows - 1));
  if (!(column >= 0 && column < columns && row >= 0 && row < rows)) return null;
  const at = row * columns + column;
  return height[at] === null ? null : { height: height[at], soil: soils[soil[at]] };
}
