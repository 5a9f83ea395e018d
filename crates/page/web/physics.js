// What computes: one interface with two implementations, this module in the page or the server.
//
// `ask(request)` takes an object with `call` and gives the answer's object; both have the keys and units of the
// command's `--json`. An answer that is an error is thrown as a `Refusal`.

/** Why a request has no answer. */
export class Refusal extends Error {
  constructor({ field, message }) {
    super(message);
    this.field = field;
  }
}

function checked(text) {
  const answer = JSON.parse(text);
  if (answer.error) throw new Refusal(answer.error);
  return answer;
}

/** The crates compiled to WebAssembly. */
export class WasmPhysics {
  #exports;
  #encoder = new TextEncoder();
  #decoder = new TextDecoder();

  constructor(exports) {
    this.#exports = exports;
  }

  /** Compiles a module of the page. */
  static async load(name) {
    return WasmPhysics.of(await moduleBytes(name));
  }

  /** The bytes of a module. */
  static bytes(name) {
    return moduleBytes(name);
  }

  /** A module out of its bytes; `take` receives the parts of a run (ArrayBuffer) before its answer. */
  static async of(bytes, take = () => {}) {
    let exports = null;
    const take_part = (address, length) => take(exports.memory.buffer.slice(address, address + length));
    ({ instance: { exports } } = await WebAssembly.instantiate(bytes, { page: { take_part } }));
    return new WasmPhysics(exports);
  }

  /** The answer at once; `file` (ArrayBuffer) is what the request is about. */
  askNow(request, file = new ArrayBuffer(0)) {
    const { grouser_room, grouser_answer, grouser_release, memory } = this.#exports;
    const placed = (bytes) => {
      const room = grouser_room(bytes.length);
      new Uint8Array(memory.buffer, room, bytes.length).set(bytes);
      return [room, bytes.length];
    };
    const bytes = this.#encoder.encode(typeof request === 'string' ? request : JSON.stringify(request));
    const packed = grouser_answer(...placed(bytes), ...placed(new Uint8Array(file)));
    const address = Number(packed >> 32n);
    const length = Number(packed & 0xffffffffn);
    const text = this.#decoder.decode(new Uint8Array(memory.buffer, address, length));
    grouser_release(address, length);
    return checked(text);
  }

  async ask(request) {
    return this.askNow(request);
  }
}

/** The same crates in the server that the page came from. */
export class ServerPhysics {
  async ask(request) {
    const response = await fetch('api/answer', {
      method: 'POST',
      headers: { 'content-type': 'application/json' },
      body: JSON.stringify(request),
    });
    // 400 comes with what is wrong
    if (!response.ok && response.status !== 400) throw new Refusal({ field: null, message: `the server answers ${response.status}` });
    return checked(await response.text());
  }
}

/** Is a module at hand? A page with a file in it has the explorer's only, a report none. */
export function hasModule(name) {
  return !document.getElementById('script') || Boolean(document.getElementById(`wasm-${name}`));
}

/** The report in the page, if there is one. */
export async function embeddedReport() {
  const block = document.getElementById('embedded');
  if (!block?.dataset.name.endsWith('.json')) return null;
  return JSON.parse(new TextDecoder().decode(await blockBytes(block)));
}

/** What a block of the page holds. */
export function blockBytes(block) {
  return unpacked(Uint8Array.from(atob(block.textContent.trim()), (c) => c.charCodeAt(0)));
}

/** The bytes of a module: out of this file, or from beside it. */
async function moduleBytes(name) {
  const inside = document.getElementById(`wasm-${name}`);
  return inside ? blockBytes(inside) : unpacked(await fetched(`${name}.wasm.gz`));
}

function unpacked(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

async function fetched(path) {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path}: ${response.status}`);
  return response.arrayBuffer();
}
