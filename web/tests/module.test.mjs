/** The module of WebAssembly in node: bits, values, input and refusals. */
import assert from "node:assert/strict";
import { test } from "node:test";

import { loadWisp, nativeHash, sceneFiles, wisp as runProgram, WispError } from "./package.mjs";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const wisp = await loadWisp({ print: () => {} });

function open(name) {
  return wisp.readScene(name, sceneFiles(name));
}

function scene(text) {
  return wisp.readScene("scene.yaml", { "scene.yaml": text });
}

const HANGING = `wisp: 1
steps: 60
substeps: 4
surfaces:
  - name: cloth
    generate: { shape: plane, columns: 12, rows: 12, spacing: 0.05 }
    pins: [0, 11]
    cloth: {}
colliders:
  - { name: ball, shape: sphere, radius: 0.1, position: [0.3, -0.3, 0.3] }
  - { name: moved, shape: sphere, radius: 0.1, position: [2, 0, 0], keyframes: [{ time: 1, position: [2, 1, 0] }] }
`;

for (const name of ["flag", "balloons", "cloth_on_ball", "swinging_guides", "frozen_3d_curly", "quad_drape", "chain_links", "bunny_balloon"]) {
  test(`${name} has the hash of the native build`, () => {
    const world = open(`${name}.yaml`).createWorld();
    const steps = Math.min(world.scene.steps, 120);
    for (let step = 0; step < steps; ++step) {
      world.step();
    }
    assert.equal(world.hash(), nativeHash(`data/scenes/${name}.yaml`, "--steps", String(steps)));
    world.release();
  });
}

test("a mesh collider has the hash of the native build, which may search it by Embree", () => {
  const text = `${HANGING}  - { name: mesh, shape: mesh, generate: { shape: icosphere, level: 2, radius: 0.15 }, position: [0.3, -0.3, 0.2] }\n`;
  const folder = mkdtempSync(join(tmpdir(), "wisp-module-"));
  const file = join(folder, "mesh.yaml");
  writeFileSync(file, text);
  const world = scene(text).createWorld();
  for (let step = 0; step < 60; ++step) {
    world.step();
  }
  assert.equal(world.hash(), nativeHash(file));
  world.release();
  rmSync(folder, { recursive: true });
});

test("a wrong scene is refused with file, line and column", () => {
  assert.throws(() => scene("wisp: 1\nsurfaces:\n  - name: a\n    clothe: {}\n"), /scene\.yaml:4:5: surfaces\[0\]: unknown key 'clothe'/);
  assert.throws(() => scene(HANGING.replace("generate: { shape: plane, columns: 12, rows: 12, spacing: 0.05 }", "file: gone.obj")).createWorld(),
    /scene\.yaml:5:5: surface 'cloth': gone\.obj: cannot open: No such file/);
});

test("a banner that tears has the hash of the native build, and the triangles of its recording", () => {
  const folder = mkdtempSync(join(tmpdir(), "wisp-module-"));
  const file = join(folder, "banner.wisp");
  runProgram("run", "data/scenes/tearing.yaml", "--record", file);
  const recording = wisp.openRecording(readFileSync(file));
  rmSync(folder, { recursive: true });
  const world = open("tearing.yaml").createWorld(), banner = world.bodies[0];
  assert.deepEqual(world.bodies.map((body) => body.tears), [true, false]);
  assert.equal(recording.bodies[0].tears, true);
  let splits = 0;
  for (let step = 0; step <= world.scene.steps; ++step) {
    recording.seek(step);
    assert.deepEqual(world.triangles(banner), recording.triangles(recording.bodies[0]));
    splits += world.triangles(banner).some((vertex, k) => vertex !== banner.triangles[k]) ? 1 : 0;
    if (step < world.scene.steps) world.step();
  }
  assert.ok(splits > 10 && splits < world.scene.steps);
  assert.equal(world.hash(), nativeHash("data/scenes/tearing.yaml"));
  world.release();
  recording.release();
});

test("points are a view of memory that follows the steps", () => {
  const world = scene(HANGING).createWorld();
  const cloth = world.bodies[0];
  const before = world.points(cloth).slice();
  for (let step = 0; step < 10; ++step) {
    world.step();
  }
  const after = world.points(cloth);
  assert.equal(after.length, 3 * 144);
  assert.deepEqual(Array.from(after.slice(0, 3)), Array.from(before.slice(0, 3)), "a pinned vertex stays");
  assert.ok(after[3 * 143 + 1] < before[3 * 143 + 1] - 0.01, "a free corner falls");
  assert.equal(world.points(cloth).byteOffset, after.byteOffset, "no copy");
  world.release();
});

test("a held vertex is where it was dragged, and falls when it is let go", () => {
  const world = scene(HANGING).createWorld();
  const cloth = world.bodies[0];
  world.grab(cloth, 143);
  for (let step = 0; step < 20; ++step) {
    world.drag(cloth, 143, [0.5, 0.1 * step / 20, 0.5]);
    world.step();
  }
  const held = Array.from(world.points(cloth).slice(3 * 143));
  [0.5, 0.095, 0.5].forEach((value, axis) => assert.ok(Math.abs(held[axis] - value) < 1e-6));
  world.letGo(cloth, 143);
  for (let step = 0; step < 20; ++step) {
    world.step();
  }
  assert.ok(world.points(cloth)[3 * 143 + 1] < 0.05);
  assert.throws(() => world.drag(cloth, 143, [0, 0, 0]), /vertex 143 of body 0 is not held/);
  assert.throws(() => world.grab(cloth, 144), /'cloth' has 144 vertices/);
  world.release();
});

test("a pinned vertex can be dragged and stays where it was left", () => {
  const world = scene(HANGING).createWorld();
  const cloth = world.bodies[0];
  world.grab(cloth, 0);
  world.drag(cloth, 0, [0, 0.2, 0]);
  world.step();
  world.letGo(cloth, 0);
  world.step();
  assert.ok(Math.abs(world.points(cloth)[1] - 0.2) < 1e-6);
  world.release();
});

test("a collider moves unless keyframes move it", () => {
  const world = scene(HANGING).createWorld();
  const [, ball, moved] = world.bodies;
  world.moveCollider(ball, [0.3, -0.1, 0.3]);
  world.step();
  assert.deepEqual(world.colliderPlace(ball).map((x) => Math.round(100 * x)), [30, -10, 30]);
  assert.throws(() => world.moveCollider(moved, [0, 0, 0]), /collider 'moved' follows its keyframes/);
  assert.throws(() => world.moveCollider(world.bodies[0], [0, 0, 0]), /'cloth' is no collider/);
  world.release();
});

test("gravity and wind act on what moves", () => {
  const world = scene(HANGING).createWorld();
  world.setGravity([0, 0, 0]);
  world.step();
  assert.equal(world.points(world.bodies[0])[3 * 143 + 1], 0, "nothing falls");
  assert.equal(world.setWind([0, 3, 0]), true);
  for (let step = 0; step < 20; ++step) {
    world.step();
  }
  assert.ok(world.points(world.bodies[0])[3 * 143 + 1] > 0.001, "the wind lifts the cloth");
  assert.equal(open("balloons.yaml").createWorld().setWind([1, 0, 0]), false, "balloons feel no wind");
  world.release();
});

test("strands are dragged by their head", () => {
  const strands = scene(`wisp: 1
strands:
  - name: hair
    generate: { shape: straight, strands: 4, vertices: 8, length: 0.2 }
    dynamics: {}
`);
  const world = strands.createWorld();
  const hair = world.bodies[0];
  const root = world.points(hair)[0];
  world.grab(hair, 7);
  const [x, y, z] = world.points(hair).slice(21, 24);
  for (let step = 0; step < 30; ++step) {
    world.drag(hair, 7, [x + 0.1, y, z]);
    world.step();
  }
  assert.ok(Math.abs(world.points(hair)[0] - root - 0.1) < 1e-5);
  world.release();
});

test("settings are those of wisp tune, and other ones are written into the scene as it is", () => {
  const hanging = scene(`# a comment\n${HANGING}`);
  assert.deepEqual(hanging.parameters.map((parameter) => parameter.name), ["substeps", "iterations", "cloth.tethers", "cloth.coarse_substeps"]);
  const changed = hanging.withParameters({ substeps: 8 });
  assert.equal(changed.text, `# a comment\n${HANGING}`.replace("substeps: 4", "substeps: 8"));
  assert.throws(() => hanging.withParameters({ substep: 8 }), /got setting 'substep'/);
  assert.throws(() => hanging.withParameters({ substeps: 3 }), /substeps: got 3, expected one of/);
});

test("the converged run differs from a coarse one, by less the finer that is", () => {
  const distance = (settings) => {
    const world = scene(HANGING).withParameters(settings).createWorld();
    const reference = scene(HANGING).createWorld({ reference: true });
    for (let step = 0; step < 60; ++step) {
      world.step();
      reference.step();
    }
    const a = world.points(world.bodies[0]), b = reference.points(reference.bodies[0]);
    return Math.sqrt(a.reduce((sum, value, i) => sum + (value - b[i]) ** 2, 0) / (a.length / 3));
  };
  const coarse = distance({ substeps: 1 }), fine = distance({ substeps: 16 });
  assert.ok(fine > 0 && fine < 0.5 * coarse, `${fine} m against ${coarse} m`);
});

test("tuning finds settings that are within the error", () => {
  let calls = 0;
  const found = wisp.tune(scene(HANGING), { error: 0.03, length: 0.5, progress: () => { ++calls; } });
  assert.equal(found.meetsTarget, true);
  assert.ok(found.error <= 0.03 && found.ms > 0);
  assert.equal(calls, found.runs);
  const unmet = wisp.tune(scene(HANGING), { error: 1e-5, length: 0.2 });
  assert.equal(unmet.meetsTarget, false);
  assert.ok(unmet.error > 1e-5);
  assert.ok(scene(HANGING).withParameters(found.parameters).text.includes(`substeps: ${found.parameters.substeps}`));
});

test("a snapshot brings back every bit and the step", () => {
  const world = open("flag.yaml").createWorld();
  for (let step = 0; step < 5; ++step) {
    world.step();
  }
  const bytes = world.snapshot(), hash = world.hash();
  world.step();
  assert.notEqual(world.hash(), hash);
  world.restore(bytes);
  assert.equal(world.hash(), hash);
  assert.equal(world.stepCount, 5);
  assert.throws(() => world.restore(bytes.slice(0, 100)), WispError);
  assert.throws(() => world.restore(new Uint8Array(3)), /no snapshot/);
  world.release();
});

test("a recording has the frames of the native run", () => {
  const folder = mkdtempSync(join(tmpdir(), "wisp-"));
  try {
    const file = join(folder, "flag.wisp");
    runProgram("run", "data/scenes/flag.yaml", "--steps", "20", "--record", file);
    const bytes = readFileSync(file);
    const recording = wisp.openRecording(bytes);
    const world = open("flag.yaml").createWorld();
    for (let step = 0; step < 20; ++step) {
      world.step();
    }
    recording.seek(recording.frameCount - 1);
    assert.deepEqual(recording.points(recording.bodies[0]), world.points(world.bodies[0]));
    assert.throws(() => recording.seek(recording.frameCount), WispError);
    assert.throws(() => wisp.openRecording(bytes.subarray(0, 20)), WispError);
    writeFileSync(file, "not a recording");
    assert.throws(() => wisp.openRecording(readFileSync(file)), WispError);
    recording.release();
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test("frozen hair turns towards a command, and a climate gives a stiffness", () => {
  const world = open("frozen_2d.yaml").createWorld();
  const hair = world.bodies[0];
  assert.equal(hair.isFrozenHair, true);
  world.step();
  const before = world.points(hair).slice();
  world.setFrozenHair(hair, { reach: 1 });
  world.commandFrozenHair(hair, [0.5, 0, 0]);
  world.step();
  const mean = (points) => points.reduce((sum, value, i) => i % 3 === 0 ? sum + value : sum, 0) / (points.length / 3);
  assert.ok(mean(world.points(hair)) > mean(before) + 0.02);
  assert.ok(world.climateStiffness(hair, -20, 1) > world.climateStiffness(hair, 5, 1));
  assert.throws(() => world.setFrozenHair(hair, { intensity: 2 }), /intensity/);
  world.release();
});

test("what is not of a world is refused", () => {
  const world = scene(HANGING).createWorld(), other = open("flag.yaml").createWorld();
  assert.throws(() => world.request(world.bodies[0], "strains"), /'cloth' has no value 'strains'/);
  assert.throws(() => world.width(world.bodies[0]), /'cloth' has no value 'width'/);
  assert.throws(() => world.points(other.bodies[0]), /not of this world/);
  assert.throws(() => scene(HANGING).createWorld({ reference: true, factor: 0 }), /factor: got 0/);
  world.release();
  world.release();
  assert.throws(() => world.step(), /released/);
  other.release();
});

test("a snapshot with a wrong place in its scene is refused and changes nothing", () => {
  const world = open("frozen_2d.yaml").createWorld();
  world.step();
  const bytes = world.snapshot(), hash = world.hash();
  for (const [at, value] of [[0, -1], [4, -5], [4, 1000], [8, 7]]) {
    const damaged = bytes.slice();
    new DataView(damaged.buffer).setInt32(at, value, true);
    assert.throws(() => world.restore(damaged), /no snapshot of this world/);
  }
  assert.equal(world.hash(), hash);
  world.release();
});

test("a scene that is released leaves no files", () => {
  const folders = [];
  for (let k = 0; k < 50; ++k) {
    const flag = open("flag.yaml");
    folders.push(flag.withParameters({ substeps: 2 }));
    folders.pop().release();
    flag.release();
    flag.release();
  }
  assert.equal(open("flag.yaml").steps, 360);
});
