// Collisions of billiard balls with friction, in WebAssembly. In a browser:
//
//   import {loadCarom} from "./carom.mjs";
//   const carom = await loadCarom(await (await fetch("carom.wasm")).arrayBuffer());
//   const kernel = carom.kernel({model: "mathavan2014", maxError: 1e-6});
//   const {ball1, ball2, status} = kernel.collide(parameters, cue, object);
//
// SI units, z up. A ball is 9 numbers: position (m), velocity (m/s), angular velocity (rad/s). On a cushion:
//
//   const cushion = carom.cushionKernel({maxError: 1e-6});
//   const {ball, status} = cushion.collide(cushionParameters, motion, normal);
//
// Here the ball is 6 numbers, velocity and angular velocity, and the normal 2, level, into the cushion.

/** What became of a collision; anything but OK leaves velocities as they came. */
export const Status = Object.freeze({OK: 0, SEPARATING: 1, BAD_INPUT: 2, TILTED: 3});

const OPTIONS = ["model", "maxError", "steps"];
const MOST_STEPS = 100000000;

// What two impacts differ in: what they are called in the module, the names of the parameters, and how many
// numbers come in, for each argument of `collide`, and go out in a batch.
const BALLS = {
  prefix: "",
  parameters: ["R", "M", "u_s1", "u_s2", "u_b", "e_b"],
  bodies: {ball1: 9, ball2: 9},
  outputs: 12,
};
const CUSHION = {
  prefix: "cushion_",
  parameters: ["R", "M", "u_s", "u_w", "e_c", "h"],
  bodies: {ball: 6, normal: 2},
  outputs: 6,
};

/** The module from the bytes of carom.wasm (ArrayBuffer, typed array) or a WebAssembly.Module. */
export async function loadCarom(source) {
  const made = await WebAssembly.instantiate(source, {});
  return new Carom((made.instance ?? made).exports);
}

class Carom {
  #exports;

  constructor(exports) {
    this.#exports = exports;
    this.rows = rowsOf(exports, BALLS);
    this.cushionRows = rowsOf(exports, CUSHION);
  }

  /** Names of the contact models that there are. */
  get models() {
    return modelsOf(this.rows);
  }

  get cushionModels() {
    return modelsOf(this.cushionRows);
  }

  /**
   * The fastest kernel that keeps maxError, relative to the balls' relative speed (default 1e-6); or
   * with `steps`, pooltool's fixed-step scheme with that N. Throws RangeError naming what there is, also
   * for an option that is none.
   */
  kernel(options = {}) {
    return new Kernel(this.#exports, chosenOf(this.rows, "mathavan2014", options));
  }

  /** The same of a ball that runs into a cushion; maxError is relative to its speed. */
  cushionKernel(options = {}) {
    return new CushionKernel(this.#exports, chosenOf(this.cushionRows, "clamped", options));
  }
}

function rowsOf(exports, impact) {
  const of = (name) => exports[impact.prefix + name];
  return Array.from({length: of("rows")()}, (_, row) => ({
    row,
    model: text(exports, of("model")(row)),
    name: text(exports, of("kernel")(row)),
    steps: of("steps")(row),
    maxError: of("budget")(row),
  }));
}

function modelsOf(rows) {
  return [...new Set(rows.map(({model}) => model))];
}

function chosenOf(known, usual, options) {
  requireOptions(options);
  const {model = usual, maxError, steps} = options;
  const rows = known.filter((row) => row.model === model);
  if (rows.length === 0) {
    throw new RangeError(`model '${model}': there is none; there are ${modelsOf(known).join(", ")}`);
  }
  if (maxError !== undefined && steps !== undefined) {
    throw new RangeError("maxError and steps exclude each other: name one of them");
  }
  if (steps !== undefined) {
    if (!Number.isInteger(steps) || steps < 1 || steps > MOST_STEPS) {
      throw new RangeError(`steps ${steps}: expected a whole number from 1 to ${MOST_STEPS}`);
    }
    const fixed = rows.find((row) => row.steps > 0);
    if (fixed === undefined) throw new RangeError(`steps: there are none of ${model}; name maxError`);
    return {...fixed, steps};
  }
  const wanted = maxError ?? 1e-6;
  const exact = rows.filter((row) => row.steps === 0);
  const fit = exact.filter((row) => row.maxError <= wanted);
  if (fit.length === 0) {
    const there = exact.map((row) => row.maxError).join(", ");
    throw new RangeError(`maxError ${wanted}: no kernel is as exact; there are ${there}`);
  }
  return fit.reduce((a, b) => (b.maxError > a.maxError ? b : a));
}

/** What kernels of both impacts do: numbers into the module's memory, a call, and numbers out. */
class AnyKernel {
  #exports;
  #row;
  #impact;

  constructor(exports, row, impact) {
    this.#exports = exports;
    this.#row = row;
    this.#impact = impact;
    this.model = row.model;
    this.name = row.name;
    this.steps = row.steps || undefined;
    this.maxError = row.steps ? undefined : row.maxError;
  }

  get #inputs() {
    return Object.values(this.#impact.bodies).reduce((a, b) => a + b);
  }

  /** One collision: {out, status}, the bodies' numbers in place of what came. */
  one(parameters, bodies) {
    const {parameters: names, prefix} = this.#impact;
    const sizes = Object.entries(this.#impact.bodies);
    sizes.forEach(([name, size], i) => {
      if (bodies[i]?.length !== size) {
        throw new RangeError(`${name}: expected ${size} numbers; ${came(bodies[i])} came`);
      }
    });
    const {at, numbers} = this.#room(names.length + this.#inputs, 0);
    this.#write(numbers, parameters);
    let place = names.length;
    sizes.forEach(([, size], i) => {
      numbers.set(bodies[i], place);
      place += size;
    });
    const first = at + 8 * names.length;
    const status = this.#exports[`${prefix}collide`](this.#row.row, at, first, this.steps ?? 0);
    return {out: numbers.slice(names.length), status};
  }

  /** n collisions: {columns, statuses, good}. */
  collideBatch(parameters, columns) {
    const {parameters: names, outputs, prefix} = this.#impact;
    const inputs = this.#inputs, n = columns.length / inputs;
    if (!Number.isInteger(n)) {
      throw new RangeError(`columns: expected ${inputs} numbers a collision; ${came(columns)} came`);
    }
    if (this.steps !== undefined && this.steps !== 1000) {
      throw new RangeError("steps: batches are of N = 1000");
    }
    const {at, numbers, bytes} = this.#room(names.length + (inputs + outputs) * n, n);
    this.#write(numbers, parameters);
    numbers.set(columns, names.length);
    const input = at + 8 * names.length, output = input + 8 * inputs * n;
    const run = this.#exports[`${prefix}collide_batch`];
    const good = run(this.#row.row, at, n, input, output, output + 8 * outputs * n);
    const first = names.length + inputs * n;
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
    this.#impact.parameters.forEach((name, index) => {
      const value = parameters[name];
      if (typeof value !== "number") {
        throw new TypeError(`parameter ${name}: expected a number; ${came(value)} came`);
      }
      numbers[index] = value;
    });
  }
}

class Kernel extends AnyKernel {
  constructor(exports, row) {
    super(exports, row, BALLS);
  }

  /** One collision: {ball1, ball2, status}. What comes in is left as it is. */
  collide(parameters, ball1, ball2) {
    const {out, status} = this.one(parameters, [ball1, ball2]);
    return {ball1: out.subarray(0, 9), ball2: out.subarray(9), status};
  }

  /**
   * n collisions: `columns` is a Float64Array of 18 n numbers, r1x of all, then r1y of all, to w2z.
   * {columns, statuses, good}: 12 n numbers, v1x of all to w2z; n statuses; how many are OK. Batches go in
   * lanes: as exact as collide, though rounded otherwise; a collision's outcome depends on itself alone.
   */
  collideBatch(parameters, columns) {
    return super.collideBatch(parameters, columns);
  }
}

class CushionKernel extends AnyKernel {
  constructor(exports, row) {
    super(exports, row, CUSHION);
  }

  /** One impact: {ball, status}. What comes in is left as it is. */
  collide(parameters, ball, normal) {
    const {out, status} = this.one(parameters, [ball, normal]);
    return {ball: out.subarray(0, 6), status};
  }

  /** n impacts: 8 n numbers, vx of all to wz, nx and ny; {columns, statuses, good} with 6 n numbers. */
  collideBatch(parameters, columns) {
    return super.collideBatch(parameters, columns);
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
