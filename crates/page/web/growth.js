// A run that grows: parts of numbers as the estimator finds them, from a worker or from the server.

/** Moments that are kept; of a longer run every second, fourth … */
const MAX_MOMENTS = 1 << 21;
const FIRST_ROOM = 8192;

/** A part of a run: its head, and its columns by name. `buffer` is an ArrayBuffer, the part begins at `offset`. */
export function readPart(buffer, offset = 0) {
  const length = new DataView(buffer).getUint32(offset, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, offset + 4, length)));
  const rows = head.rows ?? 0;
  const columns = (head.columns ?? []).map((name, i) => [name, new Float64Array(buffer, offset + 4 + length + 8 * rows * i, rows)]);
  return { head, columns: new Map(columns) };
}

/** The parts of an answer of the server: `{next, parts}`. */
export function readParts(buffer) {
  const view = new DataView(buffer);
  const parts = [];
  for (let at = 8; at < buffer.byteLength; at += 8 + view.getUint32(at, true)) parts.push(readPart(buffer, at + 8));
  return { next: view.getUint32(0, true), lost: view.getUint32(4, true), parts };
}

/** A run out of its parts, in the columns that the view plays. */
export class GrowingRun {
  #columns = new Map();
  #count = 0;
  #met = 0;
  #room = FIRST_ROOM;

  /** The run so far; `null` before its first part. */
  run = null;

  /** Adds a part. */
  add({ head, columns }) {
    if (head.begin) this.#begin(head.begin);
    if (head.overview) {
      const { end_s } = head.overview;
      const rims = this.run.wheels.map((_, i) => columns.get(`rim_speed_m_per_s ${i}`));
      this.run.overview = { time_s: columns.get('time_s'), rims };
      this.run.end_s = end_s;
      return;
    }
    for (const [kind, wheel, time, name] of head.changes ?? []) this.run.wheels[wheel][kind].push([time, name]);
    if (head.distance_m !== undefined) this.run.distance_m = head.distance_m;
    if (head.rows) this.#append(head.rows, columns);
  }

  /** What is known once the run has ended. */
  end({ doubts, distance_m, wheels }) {
    Object.assign(this.run, { doubts, distance_m, is_growing: false, end_s: undefined });
    this.run.wheels.forEach((wheel, i) => Object.assign(wheel, wheels[i]));
  }

  #begin({ wheels, ...rest }) {
    this.run = {
      ...rest, is_growing: true, doubts: [], every: 1, time_s: new Float64Array(0),
      wheels: wheels.map((wheel) => ({ ...wheel, slip: new Float64Array(0), slip_sigma: new Float64Array(0), motion: [], health: [] })),
    };
  }

  #append(rows, columns) {
    const { every } = this.run;
    const first = (every - (this.#met % every)) % every;
    const added = first < rows ? Math.ceil((rows - first) / every) : 0;
    while (this.#count + added > this.#room) this.#room *= 2;
    for (const [name, values] of columns) {
      let column = this.#columns.get(name);
      if (!column || column.length < this.#room) {
        const wider = new Float64Array(this.#room);
        if (column) wider.set(column.subarray(0, this.#count));
        this.#columns.set(name, wider);
        column = wider;
      }
      if (every === 1) column.set(values, this.#count);
      else for (let i = first, to = this.#count; i < rows; i += every, to += 1) column[to] = values[i];
    }
    this.#count += added;
    this.#met += rows;
    if (this.#count >= MAX_MOMENTS) this.#halve();
    this.#share();
  }

  #halve() {
    const kept = Math.ceil(this.#count / 2);
    for (const column of this.#columns.values()) for (let i = 0; i < kept; i += 1) column[i] = column[2 * i];
    this.#count = kept;
    this.run.every *= 2;
  }

  /** The columns as long as they are filled. */
  #share() {
    const of = (name) => this.#columns.get(name)?.subarray(0, this.#count);
    for (const name of ['time_s', 'x_m', 'y_m', 'heading_deg', 'speed_m_per_s']) this.run[name] = of(name);
    this.run.wheels.forEach((wheel, i) => {
      wheel.slip = of(`slip ${i}`);
      wheel.slip_sigma = of(`slip_sigma ${i}`);
    });
  }
}

/** Requests the parts of the server's run until it ends; `take(parts, lost)` receives them. */
export async function follow(take, signal) {
  for (let next = 0; !signal.aborted;) {
    const response = await fetch(`api/run/${next}`, { signal });
    if (!response.ok) throw new Error(`the server answers ${response.status}`);
    const answer = readParts(await response.arrayBuffer());
    next = answer.next;
    take(answer.parts, answer.lost);
    if (answer.parts.some(({ head }) => head.end || head.failed)) return;
  }
}
