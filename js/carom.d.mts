// Types of carom.mjs, for TypeScript and editors.

/** What became of a collision; anything but OK leaves velocities as they came. */
export declare const Status: Readonly<{OK: 0; SEPARATING: 1; BAD_INPUT: 2; TILTED: 3}>;
export type Status = (typeof Status)[keyof typeof Status];

/** Radius (m), mass (kg), frictions of both balls with the table, friction and restitution of the balls. */
export interface Parameters {
  R: number;
  M: number;
  u_s1: number;
  u_s2: number;
  u_b: number;
  e_b: number;
}

export type Model = "mathavan2014" | "bottom_slip" | "pooltool";

/** A budget relative to the balls' relative speed, or N of pooltool's fixed-step scheme: one of them. */
export interface KernelOptions {
  model?: Model;
  maxError?: number;
  steps?: number;
}

/** 9 numbers: position (m), velocity (m/s), angular velocity (rad/s); z up. */
export type Ball = ArrayLike<number>;

export interface Outcome {
  ball1: Float64Array;
  ball2: Float64Array;
  status: Status;
}

export interface BatchOutcome {
  /** 12 n numbers: v1x of all, then v1y of all, to w2z. */
  columns: Float64Array;
  statuses: Uint8Array;
  /** How many are OK. */
  good: number;
}

export interface Kernel {
  readonly model: Model;
  readonly name: string;
  readonly steps: number | undefined;
  readonly maxError: number | undefined;
  /** One collision. What comes in is left as it is. */
  collide(parameters: Parameters, ball1: Ball, ball2: Ball): Outcome;
  /** n collisions: 18 n numbers, r1x of all, then r1y of all, to w2z. */
  collideBatch(parameters: Parameters, columns: ArrayLike<number>): BatchOutcome;
}

/** Radius (m), mass (kg), friction with the table and with the cushion, restitution, height of the nose (m). */
export interface CushionParameters {
  R: number;
  M: number;
  u_s: number;
  u_w: number;
  e_c: number;
  h: number;
}

/** The one that the module carries; the other models are in C++ and Python. */
export type CushionModel = "clamped";

/** A budget relative to the ball's speed, 1e-6 or looser: the one kernel that the module carries keeps 1e-6. */
export interface CushionKernelOptions {
  model?: CushionModel;
  maxError?: number;
}

/** 6 numbers: velocity (m/s), angular velocity (rad/s); z up. */
export type Motion = ArrayLike<number>;

/** 2 numbers: level, into the cushion, of any length. */
export type Normal = ArrayLike<number>;

export interface CushionOutcome {
  ball: Float64Array;
  status: Status;
}

export interface CushionBatchOutcome {
  /** 6 n numbers: vx of all, then vy of all, to wz. */
  columns: Float64Array;
  statuses: Uint8Array;
  /** How many are OK. */
  good: number;
}

export interface CushionKernel {
  readonly model: CushionModel;
  readonly name: string;
  readonly maxError: number;
  /** One impact. What comes in is left as it is. */
  collide(parameters: CushionParameters, ball: Motion, normal: Normal): CushionOutcome;
  /** n impacts: 8 n numbers, vx of all, then vy of all, to wz, nx and ny. */
  collideBatch(parameters: CushionParameters, columns: ArrayLike<number>): CushionBatchOutcome;
}

export interface Carom {
  readonly models: Model[];
  readonly cushionModels: CushionModel[];
  /** The fastest kernel that keeps what is asked for. Throws RangeError naming what there is. */
  kernel(options?: KernelOptions): Kernel;
  /** The same of a ball that runs into a cushion. */
  cushionKernel(options?: CushionKernelOptions): CushionKernel;
}

/** The module from the bytes of carom.wasm or a WebAssembly.Module. */
export declare function loadCarom(
  source: ArrayBuffer | ArrayBufferView | WebAssembly.Module,
): Promise<Carom>;
