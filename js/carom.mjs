// Collisions of billiard balls with friction, in WebAssembly. In a browser:
//
//   import {loadCarom} from "./carom.mjs";
//   const carom = await loadCarom(await (await fetch("carom.wasm")).arrayBuffer());
//   const kernel = carom.kernel({model: "mathavan2014", maxError: 1e-6});
//   const {ball1, ball2, status} = kernel.collide(parameters, cue, object);
//
// SI units, z up. A ball is 9 numbers: position (m), velocity (m/s), angular velocity (rad/s).

/** What became of a collision; anything but OK leaves velocities as they came. */
export const Status = Object.freeze({OK: 0, SEPARATING: 1, BAD_INPUT: 2, TILTED: 3});

const PARAMETERS = ["R", "M", "u_s1", "u_s2", "u_b", "e_b"];
const OPTIONS = ["model", "maxError", "steps"];
const INPUTS = 18, OUTPUTS = 12, MOST_STEPS = 100000000;

/** The module from the bytes of carom.wasm (ArrayBuffer, typed array) or a WebAssembly.Module. */
export async function loadCarom(source) {
  const made = await WebAssembly.instantiate(source, {});
  return new Carom((made.instance ?? made).exports);
}

class Carom {
  #exports;

  constructor(exports) {
    this.#exports = exports;
    this.rows = Array.from({length: exports.rows()}, (_, row) => ({
      row,
      model: text(exports, exports.model(row)),
      name: text(exports, exports.kernel(row)),
      steps: exports.steps(row),
      maxError: exports.budget(row),
    }));
  }

  /** Names of the contact models that there are. */
  get models() {
    return [...new Set(this.rows.map(({model}) => model))];
  }

  /**
   * The fastest kernel that keeps maxError, relative to the balls' relative speed (default 1e-6); or
   * with `steps`, pooltool's fixed-step scheme with that N. Throws RangeError naming what there is, also
   * for an option that is none.
   */
  kernel(options = {}) {
    requireOptions(options);
    const {model = "mathavan2014", maxError, steps} = options;
    const rows = this.rows.filter((row) => row.model === model);
    if (rows.length === 0) {
      throw new RangeError(`model '${model}': there is none; there are ${this.models.join(", ")}`);
    }
    if (maxError !== undefined && steps !== undefined) {
      throw new RangeError("maxError and steps exclude each other: name one of them");
    }
    if (steps !== undefined) {
      if (!Number.isInteger(steps) || steps < 1 || steps > MOST_STEPS) {
        throw new RangeError(`steps ${steps}: expected a whole number from 1 to ${MOST_STEPS}`);
      }
      return new Kernel(this.#exports, {...rows.find((row) => row.steps > 0), steps});
    }
    const wanted = maxError ?? 1e-6;
    const exact = rows.filter((row) => row.steps === 0);
    const fit = exact.filter((row) => row.maxError <= wanted);
    if (fit.length === 0) {
      const known = exact.map((row) => row.maxError).join(", ");
      throw new RangeError(`maxError ${wanted}: no kernel is as exact; there are ${known}`);
    }
    return new Kernel(this.#exports, fit.reduce((a, b) => (b.maxError > a.maxError ? b : a)));
  }
}

class Kernel {
  #exports;
  #row;

  constructor(exports, row) {
    this.#exports = exports;
    this.#row = row;
    this.model = row.model;
    this.name = row.name;
    this.steps = row.steps || undefined;
    this.maxError = row.steps ? undefined : row.maxError;
  }

  /** One collision: {ball1, ball2, status}. What comes in is left as it is. */
  collide(parameters, ball1, ball2) {
    for (const [name, ball] of Object.entries({ball1, ball2})) {
      if (ball?.length !== 9) throw new RangeError(`${name}: expected 9 numbers; ${came(ball)} came`);
    }
    const {at, numbers} = this.#room(PARAMETERS.length + INPUTS, 0);
    this.#write(numbers, parameters);
    numbers.set(ball1, PARAMETERS.length);
    numbers.set(ball2, PARAMETERS.length + 9);
    const balls = at + 8 * PARAMETERS.length;
    const status = this.#exports.collide(this.#row.row, at, balls, this.steps ?? 0);
    const out = numbers.slice(PARAMETERS.length);
    return {ball1: out.subarray(0, 9), ball2: out.subarray(9), status};
  }

  /**
   * n collisions: `columns` is a Float64Array of 18 n numbers, r1x of all, then r1y of all, to w2z.
   * {columns, statuses, good}: 12 n numbers, v1x of all to w2z; n statuses; how many are OK. Batches go in
   * lanes: as exact as collide, though rounded otherwise; a collision's outcome depends on itself alone.
   */
  collideBatch(parameters, columns) {
    const n = columns.length / INPUTS;
    if (!Number.isInteger(n)) {
      throw new RangeError(`columns: expected 18 numbers a collision; ${came(columns)} came`);
    }
    if (this.steps !== undefined && this.steps !== 1000) {
      throw new RangeError("steps: batches are of N = 1000");
    }
    const count = PARAMETERS.length + (INPUTS + OUTPUTS) * n;
    const {at, numbers, bytes} = this.#room(count, n);
    this.#write(numbers, parameters);
    numbers.set(columns, PARAMETERS.length);
    const input = at + 8 * PARAMETERS.length, output = input + 8 * INPUTS * n;
    const status = output + 8 * OUTPUTS * n;
    const good = this.#exports.collide_batch(this.#row.row, at, n, input, output, status);
    const first = PARAMETERS.length + INPUTS * n;
    return {columns: numbers.slice(first), statuses: bytes.slice(), good: good >>> 0};
  }

  /** Memory for so many numbers and then bytes; views of it hold until it grows again. */
  #room(count, bytes) {
    const {memory, place} = this.#exports;
    const at = place() >>> 0, end = at + 8 * count;
    const lacks = end + bytes - memory.buffer.byteLength;
    if (lacks > 0) memory.grow(Math.ceil(lacks / 65536));
    return {
      at,
      numbers: new Float64Array(memory.buffer, at, count),
      bytes: new Uint8Array(memory.buffer, end, bytes),
    };
  }

  #write(numbers, parameters) {
    PARAMETERS.forEach((name, index) => {
      const value = parameters[name];
      if (typeof value !== "number") {
        throw new TypeError(`parameter ${name}: expected a number; ${came(value)} came`);
      }
      numbers[index] = value;
    });
  }
}

function came(value) {
  return value?.length === undefined ? typeof value : `${value.length} numbers`;
}

function requireOptions(options) {
  if (options === null || typeof options !== "object") {
    throw new TypeError(`options: expected an object; ${came(options)} came`);
  }
  const stranger = Object.keys(options).find((name) => !OPTIONS.includes(name));
  if (stranger !== undefined) {
    throw new RangeError(`option '${stranger}': there is none; there are ${OPTIONS.join(", ")}`);
  }
}

function text(exports, at) {
  return new TextDecoder().decode(new Uint8Array(exports.memory.buffer, at, exports.length(at)));
}
