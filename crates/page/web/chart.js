// A line chart in SVG: real text, axes with units, one cursor, values at the cursor.

import { h, svg } from './dom.js';
import { rangeOf, tickLabels, ticks } from './ticks.js';

const MARGIN = { left: 58, right: 14, top: 10, bottom: 40 };

/** Width of what moves with a cursor, px. */
const STRIP_PX = 16;

/** Width of a digit of a label, px: 0.495 of the size, in the face of face.css. */
const DIGIT_PX = 6.7;

/**
 * A chart of its own element. `options`: title, y (name and unit), x (name and unit), height (px or a function),
 * `pick(x)` when a place on the axis is clicked or dragged to, `hover(x or null)`.
 */
export class Chart {
  #options;
  #plot;
  #atCursor;
  #atPointer;
  #data = { series: [], range: [0, 1], marks: [], levels: [], cursor: null };
  #hover = null;
  #width = 0;
  #frame = null;
  #axes = null;
  #lines = null;

  constructor(options) {
    this.#options = { height: 230, ...options };
    this.values = h('div', { class: 'chart-values' });
    this.#plot = svg('svg', { class: 'plot', role: 'img' });
    // a cursor moves in a strip of its own: thousands of points are not painted anew
    [this.#atCursor, this.#atPointer] = [0, 1].map(() => svg('svg', { class: 'plot-strip', width: STRIP_PX, 'aria-hidden': 'true' }));
    this.element = h(
      'section',
      { class: 'card chart', 'aria-label': options.title },
      h('header', {}, h('h3', {}, options.title), this.values),
      h('div', { class: 'plot-box' }, this.#plot, this.#atCursor, this.#atPointer),
    );
    new ResizeObserver(([entry]) => {
      const width = Math.round(entry.contentRect.width);
      if (width && width !== this.#width) {
        this.#width = width;
        this.#render();
      }
    }).observe(this.#plot.parentElement);
    this.#listen();
  }

  /** Shows data: series [{x, y, colour, dash, width, name, ghost, band}], range of x, marks, levels, cursor; lines beyond `scale`, a range of y, are cut off. */
  show(data) {
    this.#data = { ...this.#data, ...data };
    this.#render();
  }

  /** Moves the cursor alone. */
  cursor(x) {
    this.#data.cursor = x;
    this.#renderCursor();
  }

  /** Shows where another chart is pointed at. */
  point(x) {
    this.#hover = x;
    this.#renderCursor();
  }

  /** What is drawn, for a figure of publication quality: see `figure_file.js`. */
  get panel() {
    const { x, y } = this.#options;
    const { series, range, levels, marks, spans = [], scale } = this.#data;
    const { low, high } = this.#frame ?? {};
    const lines = series.filter((one) => !one.points);
    const inside = (of) => of >= range[0] && of <= range[1];
    return {
      x: { title: named(x), range }, y: { title: named(y), range: scale ?? [low, high] },
      curves: lines.filter((one) => !one.silent).map((one) => ({ x: rounded(one.x), y: rounded(one.y), label: one.name ?? null, style: one.ghost ? null : styleOf(one) })),
      bands: lines.filter((one) => one.band).map((one) => ({ x: rounded(one.x), low: rounded(one.band.low), high: rounded(one.band.high), style: styleOf(one) })),
      points: series.filter((one) => one.points).map((one) => ({ x: rounded(one.x), y: rounded(one.y) })),
      marks: marks.filter((mark) => inside(mark.x)).map((mark) => ({ x: mark.x, y: mark.y })),
      levels: levels.map((level) => ({ y: level.y, label: level.name })),
      spans: spans.filter(({ kind }) => kind === 'rest').map(({ from, to }) => ({ from, to })),
    };
  }

  #listen() {
    const place = (event) => {
      const box = this.#plot.getBoundingClientRect();
      const share = (event.clientX - box.left - MARGIN.left) / (box.width - MARGIN.left - MARGIN.right);
      const [low, high] = this.#data.range;
      return low + Math.min(1, Math.max(0, share)) * (high - low);
    };
    const { pick, hover } = this.#options;
    this.#plot.addEventListener('pointermove', (event) => {
      if (event.buttons & 1 && pick) pick(place(event));
      hover?.(place(event));
    });
    this.#plot.addEventListener('pointerleave', () => hover?.(null));
    this.#plot.addEventListener('pointerdown', (event) => {
      if (!pick || event.button !== 0) return;
      this.#plot.setPointerCapture(event.pointerId);
      pick(place(event));
    });
  }

  #render() {
    if (!this.#width) return;
    const { zero } = this.#options;
    const height = typeof this.#options.height === 'function' ? this.#options.height() : this.#options.height;
    const { series, range, levels, scale } = this.#data;
    const width = this.#width;
    const inner = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
    const values = series.flatMap((one) => (one.band ? [...one.y, ...one.band.low, ...one.band.high] : [...one.y]));
    const [low, high] = scale ?? rangeOf(values.concat(levels.map((level) => level.y)), zero);
    const px = (value) => MARGIN.left + (inner.width * (value - range[0])) / (range[1] - range[0]);
    const py = (value) => MARGIN.top + inner.height * (1 - (value - low) / (high - low));
    this.#frame = { px, py, inner, low, high };

    const key = [width, height, Boolean(scale), ...range, low, high, ...(series.map((one) => one.name))].join(' ');
    if (key !== this.#axes) {
      this.#axes = key;
      this.#renderAxes({ width, height, inner, px, py, low, high });
    }
    this.#renderLines({ width, px, py });
    this.#renderCursor();
  }

  #renderAxes({ width, height, inner, px, py, low, high }) {
    const { x, y, title } = this.#options;
    const { range, series } = this.#data;
    const across = ticks(range[0], range[1], width < 420 ? 4 : 6);
    const up = ticks(low, high, 4);
    const grid = svg('g', { class: 'grid' });
    const text = svg('g', { class: 'axis-text' });
    const labels = tickLabels(up);
    // the name stands left of the longest label, where there is room for both
    const longest = Math.max(...labels.map((label) => label.length));
    const nameAt = Math.min(12, Math.max(8, MARGIN.left - 17 - DIGIT_PX * longest));
    labels.forEach((label, i) => {
      const at = py(up[i]);
      grid.append(svg('line', { x1: MARGIN.left, x2: width - MARGIN.right, y1: at, y2: at, class: up[i] === 0 ? 'zero' : null }));
      text.append(svg('text', { x: MARGIN.left - 8, y: at + 4, 'text-anchor': 'end' }, label));
    });
    tickLabels(across).forEach((label, i) => {
      const at = px(across[i]);
      grid.append(svg('line', { x1: at, x2: at, y1: MARGIN.top, y2: MARGIN.top + inner.height }));
      text.append(svg('text', { x: at, y: height - 22, 'text-anchor': 'middle' }, label));
    });
    text.append(
      svg('text', { x: MARGIN.left + inner.width / 2, y: height - 4, 'text-anchor': 'middle', class: 'axis-name' }, named(x)),
      svg('text', { transform: `translate(${nameAt} ${MARGIN.top + inner.height / 2}) rotate(-90)`, 'text-anchor': 'middle', class: 'axis-name' }, named(y)),
    );

    this.#plot.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#plot.setAttribute('height', height);
    this.#plot.setAttribute('aria-label', `${title} against ${x.name}. ${series.map((one) => one.name).filter(Boolean).join(', ')}`);
    // what is beyond the scale is not drawn over labels
    const inside = { x: MARGIN.left, y: MARGIN.top - 4, width: inner.width, height: inner.height + 8 };
    this.#lines = svg('svg', { class: 'lines', ...inside, viewBox: Object.values(inside).join(' '), overflow: this.#data.scale ? 'hidden' : 'visible' });
    this.#plot.replaceChildren(grid, this.#lines, text);
    for (const strip of [this.#atCursor, this.#atPointer]) strip.setAttribute('height', height);
  }

  #renderLines({ width, px, py }) {
    const { series, range, marks, levels } = this.#data;
    const lines = document.createDocumentFragment();
    for (const { from, to, kind } of this.#data.spans ?? []) {
      const [a, b] = [Math.max(from, range[0]), Math.min(to, range[1])];
      if (a < b) lines.append(svg('rect', { x: px(a), width: Math.max(0.5, px(b) - px(a)), y: MARGIN.top, height: this.#frame.inner.height, class: `span ${kind}` }));
    }
    for (const one of series) {
      if (one.band) lines.append(svg('path', { d: bandPath(one.x, one.band, px, py), fill: one.colour, class: 'band' }));
    }
    for (const level of levels) {
      lines.append(svg('line', { x1: MARGIN.left, x2: width - MARGIN.right, y1: py(level.y), y2: py(level.y), class: 'level' }));
      lines.append(svg('text', { x: width - MARGIN.right - 4, y: py(level.y) - 5, 'text-anchor': 'end', class: 'level-text' }, level.name));
    }
    for (const one of series) {
      if (one.points) {
        for (let i = 0; i < one.x.length; i += 1) {
          if (!Number.isFinite(one.y[i]) || one.x[i] < range[0] || one.x[i] > range[1]) continue;
          lines.append(svg('circle', { cx: px(one.x[i]), cy: py(one.y[i]), r: 3, class: 'measured' }));
        }
        continue;
      }
      lines.append(svg('path', {
        d: linePath(one.x, one.y, px, py), class: one.ghost ? 'line ghost' : 'line',
        stroke: one.colour, 'stroke-dasharray': one.dash, 'stroke-width': one.width ?? 2,
      }));
    }
    for (const mark of marks) {
      if (mark.x < range[0] || mark.x > range[1]) continue;
      lines.append(svg('circle', { cx: px(mark.x), cy: py(mark.y), r: 4, class: 'mark', stroke: mark.colour }, svg('title', {}, mark.name)));
    }
    this.#lines.replaceChildren(lines);
  }

  #renderCursor() {
    if (!this.#frame) return;
    const { px, py, inner, low, high } = this.#frame;
    const { series, range, cursor } = this.#data;
    const at = this.#hover ?? cursor;
    const isShown = (x) => x !== null && x >= range[0] && x <= range[1];
    const dots = [];
    const { unit } = this.#options.y;
    const shownValues = [];
    for (const one of series) {
      if (one.points) continue;
      const value = at === null ? null : valueAt(one.x, one.y, at);
      if (value !== null && isShown(at) && value >= low && value <= high) {
        dots.push(svg('circle', { cx: STRIP_PX / 2, cy: py(value), r: one.ghost ? 3 : 4, fill: one.colour, class: one.ghost ? 'dot ghost' : 'dot' }));
      }
      shownValues.push(this.#options.value?.(one, value, unit) ?? null);
    }
    const draw = (strip, x, name, parts) => {
      strip.classList.toggle('is-away', !isShown(x));
      if (!isShown(x)) {
        strip.replaceChildren();
        return;
      }
      strip.style.setProperty('transform', `translateX(${(px(x) - STRIP_PX / 2).toFixed(1)}px)`);
      strip.replaceChildren(svg('line', { x1: STRIP_PX / 2, x2: STRIP_PX / 2, y1: MARGIN.top, y2: MARGIN.top + inner.height, class: name }), ...parts);
    };
    draw(this.#atCursor, cursor, 'cursor-line', this.#hover === null ? dots : []);
    draw(this.#atPointer, this.#hover, 'hover-line', dots);
    const written = shownValues.filter(Boolean);
    this.values.replaceChildren(...written, ...(written.length === 1 && unit ? [h('span', { class: 'unit' }, unit)] : []));
  }
}

/** Numbers with six digits, more than a figure shows; null for what is missing. */
function rounded(values) {
  return Array.from(values, (value) => (Number.isFinite(value) ? Number(value.toPrecision(6)) : null));
}

/** The number of a curve's colour. */
function styleOf({ colour }) {
  return Number(/--curve-(\d)/.exec(colour)?.[1] ?? 1) - 1;
}

function named({ name, unit }) {
  return unit ? `${name} (${unit})` : name;
}

/** The pixels of a chart's plot. */
export function plotWidth(chart) {
  return Math.max(200, chart.element.clientWidth - MARGIN.left - MARGIN.right);
}

/** The path of a line; a gap where a value is missing. */
export function linePath(x, y, px, py) {
  let d = '';
  let pen = false;
  for (let i = 0; i < x.length; i += 1) {
    if (!Number.isFinite(y[i])) {
      pen = false;
      continue;
    }
    d += `${pen ? 'L' : 'M'}${px(x[i]).toFixed(1)} ${py(y[i]).toFixed(1)}`;
    pen = true;
  }
  return d;
}

function bandPath(x, { low, high }, px, py) {
  let d = '';
  let start = null;
  const close = (end) => {
    for (let k = end - 1; k >= start; k -= 1) d += `L${px(x[k]).toFixed(1)} ${py(low[k]).toFixed(1)}`;
    d += 'Z';
    start = null;
  };
  for (let i = 0; i < x.length; i += 1) {
    if (!Number.isFinite(low[i]) || !Number.isFinite(high[i])) {
      if (start !== null) close(i);
      continue;
    }
    d += `${start === null ? 'M' : 'L'}${px(x[i]).toFixed(1)} ${py(high[i]).toFixed(1)}`;
    if (start === null) start = i;
  }
  if (start !== null) close(x.length);
  return d;
}

/** The value at `at` between two points; null where a neighbour is missing. */
export function valueAt(x, y, at) {
  let low = 0;
  let high = x.length - 1;
  if (high < 0 || at < x[0] || at > x[high]) return null;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (x[middle] <= at) low = middle;
    else high = middle;
  }
  if (at === x[low]) return Number.isFinite(y[low]) ? y[low] : null;
  if (at === x[high]) return Number.isFinite(y[high]) ? y[high] : null;
  if (!Number.isFinite(y[low]) || !Number.isFinite(y[high])) return null;
  return y[low] + ((y[high] - y[low]) * (at - x[low])) / (x[high] - x[low]);
}
