// The installed package: scenes, moving points, bits, boards, error messages; `npm pack` into an empty folder.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { pathToFileURL } from "node:url";

const here = import.meta.dirname;
const golden = join(here, "../../golden");
const folder = mkdtempSync(join(tmpdir(), "midair-npm-"));
after(() => rmSync(folder, { recursive: true, force: true }));

const npm = (...words) => execFileSync("npm", words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
const packed = JSON.parse(npm("pack", "--json", "--pack-destination", folder, join(here, "..")))[0];
writeFileSync(join(folder, "package.json"), JSON.stringify({ name: "empty", type: "module", private: true }));
npm("install", "--no-audit", "--no-fund", "--offline", join(folder, packed.filename));
const installed = join(folder, "node_modules/midair");
const { load, Refusal } = await import(pathToFileURL(join(installed, "dist/index.js")).href);
const midair = await load();

const points = [[-0.02, 0, 0.12], [0.02, 0.01, 0.12]];
const ring = (more = {}) => ({
  array: { preset: "sonicsurface" },
  points: points.map((position) => ({ position, pressure: 1200 })),
  ...more,
});
const moduli = ({ pressures }) => pressures.map(([re, im]) => Math.hypot(re, im));
const near = (got, want, share) => assert.ok(Math.abs(got - want) <= share * want, `${got} for ${want}`);

test("the package has what it needs and nothing else", () => {
  const names = packed.files.map(({ path }) => path).filter((path) => !path.startsWith("dist/types"));
  assert.deepEqual(names.sort(), ["LICENSE", "README.md", "dist/index.js", "dist/midair.wasm", "example.mjs", "package.json"]);
  assert.ok(packed.size < 1e6, `${packed.size} bytes`);
});

test("the example runs in an empty folder", () => {
  const said = execFileSync("node", [join(installed, "example.mjs")], { cwd: folder, encoding: "utf8" }).trim().split("\n");
  assert.equal(said.length, 6);
  for (const line of said.slice(0, 5)) assert.match(line, /^frame \d: done, 1[45]\d\d and 1[45]\d\d Pa, uniformity (1\.000|0\.99\d)$/);
  assert.match(said[5], /^\d+ bytes for the board$/);
});

test("its types are found by TypeScript", () => {
  writeFileSync(
    join(folder, "use.ts"),
    'import { load, type Answer } from "midair";\nconst scene = (await load()).open({}, { toml: false });\n' +
      "const answer: Answer = scene.solve();\nconst drive: Float32Array = answer.drive;\nconsole.log(drive.length, answer.status);\n",
  );
  const tsc = join(here, "../../studio/node_modules/.bin/tsc");
  const flags = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--lib", "es2023,dom", "--types", ""];
  execFileSync(tsc, [...flags, "use.ts"], { cwd: folder, encoding: "utf8" });
});

for (const name of readdirSync(golden).filter((name) => name.endsWith(".json"))) {
  test(`golden/${name}: the bits of the scalar set`, () => {
    const text = readFileSync(join(golden, name), "utf8");
    const record = JSON.parse(text);
    // The text is used unparsed, because a JavaScript number cannot store a seed of 64 bits.
    const scene = text.slice(text.indexOf('"scene":') + 8, text.lastIndexOf("}"));
    const own = midair.open(scene.replace('"solver":{', `"solver":{"balance":${record.balance},`));
    assert.deepEqual(own.solve().drive, Float32Array.from(record.drive.flat()));
    own.free();
  });
}

test("points are given what is requested", () => {
  const scene = midair.open(ring());
  const answer = scene.solve();
  assert.equal(answer.status, "done");
  for (const pascals of moduli(answer)) near(pascals, 1200, 0.01);
  const field = scene.field(Float64Array.from(points.flat()));
  for (const j of [0, 1]) near(Math.hypot(field[2 * j], field[2 * j + 1]), 1200, 0.01);
  scene.free();
});

test("points move without a new scene, as a new scene has them", () => {
  const scene = midair.open(ring());
  scene.solve();
  const moved = points.map(([x, y, z]) => [x + 0.01, y, z]);
  scene.move(moved);
  const fresh = midair.open({ ...ring(), points: moved.map((position) => ({ position, pressure: 1200 })) });
  assert.deepEqual(scene.solve().drive, fresh.solve().drive);
  assert.equal(scene.save(false), fresh.save(false));
  scene.free();
  fresh.free();
});

test("a moved scene keeps its bead, its solver and its plane", () => {
  const parts = { signature: "trap", bead: { radius: 1.2e-3, density: 900 }, solver: { name: "uniform" }, plane: { axis: "x" } };
  const scene = midair.open({ array: { preset: "openmpd_pair" }, points: [{ position: [0, 0, 0] }], ...parts });
  const before = scene.save(false);
  scene.move([[0, 0, 0]]);
  assert.equal(scene.save(false), before);
  assert.equal(JSON.parse(before).bead.density, 900);
  scene.free();
});

test("pressures change with the points, and their number too", () => {
  const scene = midair.open(ring());
  scene.move([...points, [0, 0.03, 0.12]], [500, 700, 900]);
  moduli(scene.solve()).forEach((pascals, j) => near(pascals, [500, 700, 900][j], 0.01));
  scene.free();
});

test("glide follows: no phase turns by more than its bound", () => {
  const scene = midair.open(ring({ solver: { name: "glide", change: 0.2 } }));
  let last;
  for (let frame = 0; frame < 10; frame++) {
    scene.move(points.map(([x, y, z]) => [x + 5e-5 * frame, y, z]));
    const { drive } = scene.solve();
    for (let i = 0; last && i < drive.length; i += 2) {
      const turn = Math.atan2(drive[i + 1] * last[i] - drive[i] * last[i + 1], drive[i] * last[i] + drive[i + 1] * last[i + 1]);
      assert.ok(Math.abs(turn) < 0.2 + 1e-5, `frame ${frame}, transducer ${i / 2}: ${turn}`);
    }
    last = drive;
  }
  scene.free();
});

for (const name of readdirSync(join(golden, "motion"))) {
  test(`golden/motion/${name}: frames and the bytes of a board`, () => {
    const { motion, board, points, targets, bytes } = JSON.parse(readFileSync(join(golden, "motion", name), "utf8"));
    const scene = midair.open(motion);
    const moving = scene.motion();
    assert.equal(moving.rate, motion.motion.rate);
    assert.deepEqual([...moving.points], points.flat());
    assert.deepEqual([...moving.targets], targets);
    const frames = scene.follow();
    assert.equal(frames.length, bytes.length);
    bytes.forEach((hex, index) => {
      scene.frame(index);
      assert.equal(Buffer.from(scene.encode(board)).toString("hex"), hex, `frame ${index}`);
    });
    assert.throws(() => scene.save(false), /its points move/);
    scene.free();
  });
}

test("a scene at rest has no motion", () => {
  const scene = midair.open(ring());
  assert.throws(() => scene.motion(), /^Error: motion is not there: open a scene file with \[motion\]$/);
  assert.throws(() => midair.open({ array: { preset: "autd3" }, motion: { rate: 10, path: [] } }), /motion.path/);
  scene.free();
});

test("TOML is read as JSON is, and written", () => {
  const scene = midair.open(ring());
  const again = midair.open(scene.save(true));
  assert.deepEqual(again.solve().drive, scene.solve().drive);
  scene.free();
  again.free();
});

test("bytes for a board, and its silence", () => {
  const scene = midair.open(ring());
  scene.solve();
  const [frame, silence] = [scene.encode("sonicsurface"), scene.silence("sonicsurface")];
  assert.ok(frame instanceof Uint8Array && frame.length > 256 && silence.length > 0);
  assert.throws(() => scene.encode("sonicsurfaces"), /sonicsurface/);
  // An OpenMPD board that is turned by a quarter has the order of a SonicSurface.
  for (const other of ["autd3", "nano"]) assert.throws(() => scene.encode(other), /^Error: (array|transducers) /);
  scene.free();
});

test("an array in another order than its board is refused, and plays by its pins", () => {
  const places = [...Array(16).keys()].map((i) => [0.01 * (Math.floor(i / 4) - 1.5), 0.01 * ((i % 4) - 1.5), 0]);
  const points = [{ position: [0, 0, 0.05] }];
  const mixed = midair.open({ array: { positions: places }, points });
  mixed.solve();
  assert.throws(() => mixed.encode("nano16"), /array is in another order than nano16: .* the order \[0, 4, 8, 12, 1,/);
  const pins = places.map((_, i) => Math.floor(i / 4) + 4 * (i % 4));
  const pinned = midair.open({ array: { positions: places, pins }, points });
  pinned.solve();
  assert.equal(pinned.encode("nano16").length, 65);
  mixed.free();
  pinned.free();
});

test("two boards at right angles focus where they should", () => {
  const second = { preset: "autd3", rotation: [0, Math.PI / 2, 0], translation: [-0.12, 0, 0.13] };
  const focus = [0.02, 0.01, 0.14];
  const scene = midair.open({ array: { part: [{ preset: "autd3" }, second] }, points: [{ position: focus }], solver: { name: "naive" } });
  const { drive } = scene.solve();
  const positions = scene.array();
  const k = (2 * Math.PI * 40e3) / 346.13;
  const sum = (x, z) => {
    let [re, im] = [0, 0];
    for (let i = 0; i < drive.length / 2; i++) {
      const r = Math.hypot(x - positions[3 * i], focus[1] - positions[3 * i + 1], z - positions[3 * i + 2]);
      // The phases alone decide: with 1/r, the loudest place lies nearer to the boards.
      const phase = k * r + Math.atan2(drive[2 * i + 1], drive[2 * i]);
      re += Math.cos(phase);
      im += Math.sin(phase);
    }
    return Math.hypot(re, im);
  };
  let best = [0, 0, 0];
  for (let i = -20; i <= 20; i++) {
    for (let j = -20; j <= 20; j++) {
      const size = sum(focus[0] + 5e-5 * i, focus[2] + 5e-5 * j);
      if (size > best[0]) best = [size, i, j];
    }
  }
  assert.ok(Math.abs(5e-5 * best[1]) < 1e-4 && Math.abs(5e-5 * best[2]) < 1e-4, `${best}`);
  assert.equal(scene.encode("autd3").length, 2 * 498);
  scene.free();
});

test("the catalogue names presets, solvers and boards", () => {
  const { version, presets, solvers, boards } = midair.catalogue();
  assert.match(version, /^\d+\.\d+\.\d+/);
  assert.ok(presets.some(({ name }) => name === "autd3"));
  assert.ok(solvers.some(({ name }) => name === "uniform"));
  assert.ok(boards.some(({ name }) => name === "sonicsurface"));
});

const refusals = {
  "an unknown preset": [{ ...ring(), array: { preset: "sonicsurfac" } }, /sonicsurface/],
  "no point": [{ ...ring(), points: [] }, /points/],
  "text that is no scene": ["{", /./],
  "a point on a transducer's other side of the world": [{ ...ring(), points: [{ position: [1e9, 0, 0] }] }, /points\[0\]/],
};
for (const [name, [scene, said]] of Object.entries(refusals)) {
  test(`one line refuses ${name}`, () => {
    assert.throws(() => midair.open(scene), (error) => said.test(error.message) && !error.message.includes("\n"));
  });
}

test("errors and warnings have codes", () => {
  const codeOf = (scene) => {
    try {
      return midair.open(scene).warnings.map(({ code }) => code);
    } catch (error) {
      assert.ok(error instanceof Refusal && error.message === error.notice.text);
      return error.notice.code;
    }
  };
  assert.equal(codeOf({ ...ring(), array: { preset: "sonicsurfac" } }), "unknown");
  assert.equal(codeOf({ ...ring(), points: [{ position: [1e9, 0, 0] }] }), "too-far");
  assert.equal(codeOf("{"), "unreadable");
  assert.deepEqual(codeOf({ ...ring(), points: [{ position: [0, 0, 20] }] }), ["too-far"]);
});

test("beads that fall are reported once, and counted at each solve", () => {
  const places = [[0.01, 0, 0], [-0.01, 0, 0], [0, 0.01, 0], [0, -0.01, 0]];
  for (const [more, kept] of [[{}, 0], [{ channels: Array.from({ length: 72 }, (_, k) => k) }, 4]]) {
    const scene = midair.open({ signature: "trap", array: { preset: "tinylev", ...more }, points: places.map((position) => ({ position })) });
    const said = [scene.solve().said, scene.solve().said].map((all) => all.filter(({ code }) => code === "fallen").map(({ text }) => text.split(":")[0]));
    assert.deepEqual(said, [kept ? [] : ["traps hold 0 of 4 beads"], []]);
    assert.deepEqual(scene.beads(), [kept, 4]);
    scene.free();
  }
  const foci = midair.open(ring());
  foci.solve();
  assert.deepEqual(foci.beads(), []);
});

test("a bead that is lost has a time and places until then, one that stays has null", () => {
  const flown = (speed) => {
    const scene = midair.open({ signature: "trap", array: { preset: "openmpd_pair", quantization: {} }, points: [{ position: [0, 0, 0] }], solver: { name: "glide", rate: 1000 } });
    scene.follow(Float64Array.from({ length: 300 }, (_, k) => (k % 3 ? 0 : 1e-3 * speed * Math.abs(((k / 3) % 50) - 25))), 100);
    return scene.fly(0, 1000);
  };
  const [stays, lost] = [flown(0.1), flown(4)];
  assert.equal(stays.lost, null);
  assert.ok(lost.lost > 0 && lost.lost < 0.1);
  for (const { places } of [stays, lost]) assert.ok(places.every(Number.isFinite));
  assert.ok(stays.places.length > lost.places.length && lost.places.length % 3 === 0);
});

test("a move that is refused leaves the scene as it was", () => {
  const scene = midair.open(ring());
  const { drive } = scene.solve();
  assert.throws(() => scene.move([[0, 0]]), /points\[0\] has 2 numbers: give x, y and z in m/);
  assert.throws(() => scene.move([points[0], [0, 0, Number.NaN]]), /points\[1\]/);
  assert.throws(() => scene.move(points, [1, 2, 3]), /pressures/);
  assert.deepEqual(scene.solve().drive, drive);
  scene.free();
});

const numbers = (...values) => Float64Array.from(values);
const [nan, huge] = [Number.NaN, { length: 1e9 }];
const wrong = {
  "frame(NaN)": [(scene) => scene.frame(nan), "whole-number"],
  "frame(0.5)": [(scene) => scene.frame(0.5), "whole-number"],
  "frame(undefined)": [(scene) => scene.frame(), "whole-number"],
  "frame(2 ** 32)": [(scene) => scene.frame(2 ** 32), "whole-number"],
  "frame(99)": [(scene) => scene.frame(99), "out-of-range"],
  "moved(-1)": [(scene) => scene.moved(-1), "whole-number"],
  "fly(NaN)": [(scene) => scene.fly(nan, 200), "whole-number"],
  "fly(0, NaN)": [(scene) => scene.fly(0, nan), "not-finite"],
  "fly(9)": [(scene) => scene.fly(9, 200), "out-of-range"],
  "along(NaN)": [(scene) => scene.along([points], nan), "whole-number"],
  "along of NaN": [(scene) => scene.along([[[nan, 0, 0], [0, 0, 0]]], 9), "invalid"],
  "follow(-1)": [(scene) => scene.follow(numbers(), -1), "whole-number"],
  "follow of no points, 2 ** 31 times": [(scene) => scene.follow(numbers(), 2 ** 31), "invalid"],
  "follow of NaN": [(scene) => scene.follow(new Float64Array(12).fill(nan), 2), "not-finite"],
  "field of 4 numbers": [(scene) => scene.field(numbers(0, 0, 0.1, 0)), "numbers-count"],
  "field of 1e9 numbers": [(scene) => scene.field(huge), "numbers-count"],
  "field of -1 numbers": [(scene) => scene.field({ length: -1 }), "numbers-count"],
  "field of NaN": [(scene) => scene.field(numbers(nan, 0, 0.1)), "not-finite"],
  "probe of two places": [(scene) => scene.probe(points.flat()), "numbers-count"],
  "skin of one place, four times": [(scene) => scene.skin(new Float64Array(12).fill(0.1), 200), "out-of-range"],
  "skin(NaN)": [(scene) => scene.skin(numbers(0, 0, 0.1, 0.01, 0, 0.1, 0, 0.01, 0.1, 0.01, 0.01, 0.1), nan), "not-finite"],
  "a drive of NaN": [(scene) => scene.load(new Float64Array(512).fill(nan)), "not-finite"],
  "a scale of NaN": [(scene) => scene.load(new Float64Array(512), nan), "out-of-range"],
  "a scale below 0": [(scene) => scene.load(new Float64Array(512), -1), "out-of-range"],
  "a drive of 1e9 numbers": [(scene) => scene.load(huge), "numbers-count"],
  "a pressure of NaN": [() => midair.open({ ...ring(), points: [{ position: points[0], pressure: nan }] }), "type"],
  "a rate of infinity": [() => midair.open({ array: { preset: "autd3" }, motion: { rate: Number.POSITIVE_INFINITY, path: [] } }), "type"],
  "a scene in itself": [() => midair.open(Object.defineProperty({}, "a", { enumerable: true, get() { return this; } })), "scene-form"],
};
for (const [name, [act, code]] of Object.entries(wrong)) {
  test(`one line refuses ${name}, and the scene goes on`, () => {
    const scene = midair.open(ring());
    scene.follow(numbers(...points.flat(), ...points.flat()), 2);
    assert.throws(() => act(scene), (error) => error instanceof Refusal && error.notice.code === code && !error.message.includes("\n"));
    assert.equal(scene.solve().status, "done");
    scene.free();
  });
}

test("a scene that is freed or lost is refused in one line, and may be freed again", () => {
  const freed = midair.open(ring());
  freed.free();
  const lost = midair.open(ring());
  const trap = () => {
    throw new WebAssembly.RuntimeError("unreachable");
  };
  lost.wasm = { ...lost.wasm, studio_solve: trap };
  assert.throws(() => lost.solve(), /^Error: the scene is lost \(unreachable\): open it anew/);
  for (const scene of [freed, lost]) {
    for (const act of [() => scene.solve(), () => scene.save(false), () => scene.move(points), () => scene.silence("sonicsurface")]) {
      assert.throws(act, /^Error: the scene was freed: open it anew$/);
    }
    scene.free();
  }
});

test("a missing module is one line", async () => {
  await assert.rejects(load(new URL("file:///nowhere/midair.wasm")), /nowhere/);
  await assert.rejects(load(new Uint8Array([1, 2, 3])), /WebAssembly/);
});
