// The worker: long computations beside the page, which stays quick.

import { Refusal, WasmPhysics } from './physics.js';

/** Answers requests of the page; the first message brings the module's bytes. */
export function work() {
  let physics = null;
  let current = null;
  self.addEventListener('message', async ({ data }) => {
    if (data.bytes) {
      physics = WasmPhysics.of(data.bytes, (part) => self.postMessage({ id: current, part }, [part]));
      return;
    }
    const { id, request, file } = data;
    try {
      const ready = await physics;
      current = id;
      self.postMessage({ id, answer: ready.askNow(request, file) });
    } catch (error) {
      self.postMessage({ id, refused: { field: error instanceof Refusal ? error.field : null, message: error.message } });
    }
  });
}

/** A module of the page in a worker of its own. */
export class WorkerPhysics {
  #worker = null;
  #name;
  #waiting = new Map();
  #next = 0;

  constructor(name) {
    this.#name = name;
  }

  /** The answer; `file` (ArrayBuffer) goes to the worker, `take` receives the parts of a run. */
  async ask(request, { file, take } = {}) {
    this.#worker ??= this.#start();
    const worker = await this.#worker;
    this.#next += 1;
    const id = this.#next;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject, take });
      worker.postMessage({ id, request, file }, file ? [file] : []);
    });
  }

  /** Ends what it computes; the next request starts anew. */
  async stop() {
    (await this.#worker)?.terminate();
    this.#worker = null;
    for (const { reject } of this.#waiting.values()) reject(new Refusal({ field: null, message: 'stopped' }));
    this.#waiting.clear();
  }

  async #start() {
    const bytes = await WasmPhysics.bytes(this.#name);
    // in the one file the page's script is the worker's; from a server it is a file
    const own = document.getElementById('script');
    const worker = own
      ? new Worker(URL.createObjectURL(new Blob([own.textContent], { type: 'text/javascript' })))
      : new Worker('main.js', { type: 'module' });
    worker.addEventListener('message', ({ data }) => {
      const waiting = this.#waiting.get(data.id);
      if (data.part) {
        waiting?.take?.(data.part);
        return;
      }
      this.#waiting.delete(data.id);
      if (data.refused) waiting?.reject(new Refusal(data.refused));
      else waiting?.resolve(data.answer);
    });
    worker.postMessage({ bytes }, [bytes]);
    return worker;
  }
}
