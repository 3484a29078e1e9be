// node --test js/carom.test.mjs: kernels in WebAssembly against the reference of the project.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {test} from "node:test";

import {loadCarom, Status} from "./carom.mjs";

const root = new URL("../", import.meta.url);
const wasm = process.env.CAROM_WASM ?? new URL("build/wasm/js/carom.wasm", root);
const carom = await loadCarom(readFileSync(wasm));

const PARAMETERS = ["R", "M", "u_s1", "u_s2", "u_b", "e_b"];
const AXES = ["x", "y", "z"];
const namesOf = (ball, kinds) => kinds.flatMap((kind) => AXES.map((axis) => kind + ball + axis));
const OUTCOME = [...namesOf(1, ["v", "w"]), ...namesOf(2, ["v", "w"])];

function records(name, folder = "reference") {
  const path = new URL(`tests/data/${folder}/${name}.csv`, root);
  const [header, ...lines] = readFileSync(path, "utf8").trim().split(/\r?\n/);
  const names = header.split(",");
  return lines.map((line) => {
    const fields = line.split(",");
    return Object.fromEntries(names.map((key, index) => [key, fields[index]]));
  });
}

const cases = records("inputs").map((row) => ({
  parameters: Object.fromEntries(PARAMETERS.map((key) => [key, Number(row[key])])),
  ball1: namesOf(1, ["r", "v", "w"]).map((key) => Number(row[key])),
  ball2: namesOf(2, ["r", "v", "w"]).map((key) => Number(row[key])),
}));

const velocities = ({ball1, ball2}) => [...ball1.slice(3), ...ball2.slice(3)];

/** The largest difference, spins as R w, relative to |v1 - v2|. */
function errorOf(each, got, want) {
  const relative = Math.hypot(...[3, 4, 5].map((i) => each.ball1[i] - each.ball2[i]));
  const units = OUTCOME.map((name) => (name[0] === "w" ? each.parameters.R : 1));
  return Math.max(...got.map((value, i) => Math.abs(value - want[i]) * units[i])) / relative;
}

/** Columns of a batch: 18 rows of a number for each case. */
function columnsOf(some) {
  const columns = new Float64Array(18 * some.length);
  some.forEach(({ball1, ball2}, i) => {
    [...ball1, ...ball2].forEach((value, j) => { columns[j * some.length + i] = value; });
  });
  return columns;
}

for (const model of ["mathavan2014", "bottom_slip", "pooltool"]) {
  const exact = records(`exact_${model}`).map((row) => OUTCOME.map((name) => Number(row[name])));
  for (const maxError of [1e-3, 1e-6, 1e-9]) {
    test(`${model} keeps ${maxError} on all reference cases`, (t) => {
      const kernel = carom.kernel({model, maxError});
      assert.equal(kernel.maxError, maxError);
      let worst = 0;
      cases.forEach((each, index) => {
        const done = kernel.collide(each.parameters, each.ball1, each.ball2);
        const batch = kernel.collideBatch(each.parameters, columnsOf([each]));
        assert.equal(done.status, Status.OK);
        assert.equal(batch.good, 1);
        for (const got of [velocities(done), [...batch.columns]]) {
          worst = Math.max(worst, errorOf(each, got, exact[index]));
        }
      });
      t.diagnostic(`${kernel.name}: ${cases.length} cases, largest error ${worst.toExponential(1)}`);
      assert.ok(cases.length === 950 && worst <= maxError);
    });
  }
}

test("a collision in a batch depends on itself alone, however large the batch", () => {
  const n = 20000, {parameters} = cases[0];
  const many = Array.from({length: n}, (_, i) => cases[i % cases.length]);
  for (const goal of [{}, {steps: 1000}]) {
    const kernel = carom.kernel(goal);
    const batch = kernel.collideBatch(parameters, columnsOf(many));
    assert.ok(batch.good > 0.9 * n && batch.statuses.length === n);
    for (let i = 0; i < n; i += 997) {
      const alone = kernel.collideBatch(parameters, columnsOf([many[i]]));
      const single = kernel.collide(parameters, many[i].ball1, many[i].ball2);
      assert.ok(batch.statuses[i] === alone.statuses[0] && single.status === alone.statuses[0]);
      alone.columns.forEach((value, j) => assert.ok(Object.is(batch.columns[j * n + i], value)));
    }
  }
});

test("batches of fixed steps are the scheme's, but for a step more or less and contact that sticks", (t) => {
  const kernel = carom.kernel({model: "pooltool", steps: 1000});
  const near = cases.filter((each) => {
    const single = velocities(kernel.collide(each.parameters, each.ball1, each.ball2));
    const batch = [...kernel.collideBatch(each.parameters, columnsOf([each])).columns];
    return errorOf(each, batch, single) < 1e-6;
  });
  t.diagnostic(`${near.length} of ${cases.length} cases are within 1e-6 of a single call`);
  assert.ok(near.length > 0.99 * cases.length);
});

test("fixed steps, and any number of them", () => {
  const {parameters, ball1, ball2} = cases[0];
  const plain = carom.kernel({model: "pooltool", steps: 1000}).collide(parameters, ball1, ball2);
  const fine = carom.kernel({model: "pooltool", steps: 100000}).collide(parameters, ball1, ball2);
  const exact = carom.kernel({model: "pooltool"}).collide(parameters, ball1, ball2);
  const [far, near] = [plain, fine].map((c) => errorOf(cases[0], velocities(c), velocities(exact)));
  assert.ok(near < far && far < 1e-2 && near < 1e-4);
});

test("what is wrong is named", () => {
  const {parameters, ball1, ball2} = cases[0], kernel = carom.kernel();
  assert.throws(() => carom.kernel({model: "billiards"}), /there are mathavan2014, bottom_slip/);
  assert.throws(() => carom.kernel({maxError: 1e-12}), /there are 0.001, 0.000001, 1e-9/);
  assert.throws(() => carom.kernel({steps: 0}), /1 to 100000000/);
  assert.throws(() => carom.kernel({steps: 5, maxError: 1e-3}), /exclude each other/);
  assert.throws(() => kernel.collide({...parameters, u_b: undefined}, ball1, ball2), /u_b/);
  assert.throws(() => kernel.collide(parameters, ball1.slice(1), ball2), /9 numbers/);
  assert.throws(() => kernel.collideBatch(parameters, new Float64Array(17)), /18 numbers/);
  const still = kernel.collide(parameters, ball1.map((x, i) => (i === 3 ? NaN : x)), ball2);
  assert.equal(still.status, Status.BAD_INPUT);
  assert.ok(Number.isNaN(still.ball1[3]) && still.ball2.every((x, i) => x === ball2[i]));
});

test("options that are none are refused, and errors say what came", () => {
  const {parameters, ball1, ball2} = cases[0];
  const kernel = carom.kernel();
  const refused = [
    [() => carom.kernel({max_error: 1e-6}), /option 'max_error'.*there are model, maxError, steps/],
    [() => carom.kernel("pooltool"), /options: expected an object/],
    [() => kernel.collide({R: 1}, ball1, ball2), /parameter M: expected a number; undefined came/],
    [() => kernel.collide(parameters, ball1.slice(1), ball2), /ball1: expected 9 numbers; 8 numbers/],
    [() => kernel.collideBatch(parameters, new Float64Array(19)), /columns: .*; 19 numbers came/],
  ];
  for (const [call, message] of refused) assert.throws(call, {message});
});

const CUSHION = ["R", "M", "u_s", "u_w", "e_c", "h"];
const MOTION = ["vx", "vy", "vz", "wx", "wy", "wz"];
const impacts = records("inputs", "ball_cushion").map((row) => ({
  id: row.id,
  parameters: Object.fromEntries(CUSHION.map((key) => [key, Number(row[key])])),
  ball: MOTION.map((key) => Number(row[key])),
  normal: [Number(row.nx), Number(row.ny)],
}));

/** The largest difference, spins as R w, relative to |v|. */
function cushionErrorOf({ball, parameters}, got, want) {
  const off = got.map((x, i) => Math.abs(x - want[i]) * (i < 3 ? 1 : parameters.R));
  return Math.max(...off) / Math.hypot(ball[0], ball[1]);
}

const answers = new Map(
  records("exact", "ball_cushion").map((row) => [row.id, MOTION.map((key) => Number(row[key]))]),
);

test("the cushion keeps its budget on all reference cases", (t) => {
  const kernel = carom.cushionKernel();
  let worst = 0;
  for (const each of impacts) {
    const done = kernel.collide(each.parameters, each.ball, each.normal);
    const columns = new Float64Array([...each.ball, ...each.normal]);
    const batch = kernel.collideBatch(each.parameters, columns);
    assert.ok(done.status === Status.OK && batch.good === 1);
    for (const got of [[...done.ball], [...batch.columns]]) {
      worst = Math.max(worst, cushionErrorOf(each, got, answers.get(each.id)));
    }
  }
  t.diagnostic(`${kernel.name}: ${impacts.length} cases, largest error ${worst.toExponential(1)}`);
  assert.ok(impacts.length === 600 && kernel.maxError === 1e-6 && worst <= kernel.maxError);
});

test("what is wrong with an impact on a cushion is named", () => {
  const {parameters, ball, normal} = impacts[0], kernel = carom.cushionKernel();
  assert.deepEqual(carom.cushionModels, ["clamped"]);
  assert.throws(() => carom.cushionKernel({model: "mathavan2014"}), /there are clamped/);
  assert.throws(() => carom.cushionKernel({steps: 1000}), /steps: there are none of clamped/);
  assert.throws(() => carom.cushionKernel({maxError: 1e-9}), /there are 0.000001/);
  assert.throws(() => kernel.collide({...parameters, h: undefined}, ball, normal), /parameter h/);
  assert.throws(() => kernel.collide(parameters, ball, [1]), /normal: expected 2 numbers; 1 numbers/);
  assert.throws(() => kernel.collideBatch(parameters, new Float64Array(9)), /8 numbers a collision/);
  const parting = kernel.collide(parameters, ball.map((x) => -x), normal);
  assert.equal(parting.status, Status.SEPARATING);
  assert.equal(kernel.collide({...parameters, h: 0}, ball, normal).status, Status.BAD_INPUT);
  const far = kernel.collide(parameters, ball, normal.map((x) => x * 1e-310));
  assert.ok(Math.abs(far.ball[1] - kernel.collide(parameters, ball, normal).ball[1]) < 1e-9);
});

test("package.json names the files that there are and the generator's version", () => {
  const folder = new URL("js/", root);
  const known = JSON.parse(readFileSync(new URL("package.json", folder), "utf8"));
  for (const name of known.files.filter((each) => each !== "carom.wasm")) {
    assert.ok(readFileSync(new URL(name, folder), "utf8").length > 0);
  }
  const source = readFileSync(new URL("generator/__init__.py", root), "utf8");
  assert.equal(known.version, /__version__ = "(.*)"/.exec(source)[1]);
});
