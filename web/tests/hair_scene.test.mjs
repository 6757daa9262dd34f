/** Hair that was combed by hand: the saved scene gives `wisp run` the bits of the page. */
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { combableScene, combedScene, hairEvents, hasEntry } from "../viewer/hair_scene.mjs";
import { StrokeHistory } from "../viewer/stroke_history.mjs";
import { loadWisp, nativeHash, sceneFiles } from "./package.mjs";

const wisp = await loadWisp({ print: () => {} });

const KEYS = {
  intensity: "intensity", reach: "reach", stretch_stiffness: "stretchStiffness", bend_stiffness: "bendStiffness", clump_radius: "clumpRadius",
};

/** Comb a scene along a path, with changes of parameters on the way. */
function comb(name, strands, stiffness, changes) {
  const scene = wisp.readScene(name, sceneFiles(name));
  const text = combableScene(scene.text, strands, { freezes: true, stiffness });
  const world = scene.withText(text).createWorld();
  const hair = world.bodies.find((body) => body.name === strands);
  const commands = [];
  world.step();
  for (let k = 0; k < 30; ++k) {
    const cursor = [0.1 * Math.sin(k / 5), -0.15 - 0.003 * k, 0];
    const values = changes[k];
    if (values) {
      world.setFrozenHair(hair, Object.fromEntries(Object.entries(values).map(([key, value]) => [KEYS[key], value])));
    }
    world.commandFrozenHair(hair, cursor);
    commands.push({ step: world.stepCount, strands, cursor, ...values });
    world.step();
  }
  return { saved: combedScene(text, commands, world.stepCount), hash: world.hash() };
}

function hashOfRun(text) {
  const folder = mkdtempSync(join(tmpdir(), "wisp-"));
  try {
    writeFileSync(join(folder, "combed.yaml"), text);
    return nativeHash(join(folder, "combed.yaml"));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

test("a combed scene has the same bits in wisp run", () => {
  const { saved, hash } = comb("frozen_2d.yaml", "hair", null,
    { 0: { reach: 0.06, intensity: 0.7 }, 12: { bend_stiffness: 3.3, stretch_stiffness: 3.3 }, 20: { clump_radius: 0.007, reach: 0.1 } });
  assert.match(saved, /base: stroke/);
  assert.match(saved, /^# The setting of the frozen hair paper/, "comments stay");
  assert.equal(hashOfRun(saved), hash);
});

test("a climate becomes a stiffness, which the saved scene has", () => {
  const name = "environment_and_appearance.yaml";
  const world = wisp.readScene(name, sceneFiles(name)).createWorld();
  const stiffness = world.climateStiffness(world.bodies[0], -6, 0.7);
  const { saved, hash } = comb(name, "hair", stiffness, { 3: { reach: 0.2 } });
  assert.doesNotMatch(saved, /environment:/);
  assert.match(saved, new RegExp(`bend_stiffness: ${Number(Math.fround(stiffness).toPrecision(9))}`));
  assert.equal(hashOfRun(saved.replace(/^output:[^]*?(?=^\w)/m, "")), hash);
});

test("strokes add up: commands in other places leave swept strands where they are", () => {
  const scene = wisp.readScene("frozen_2d.yaml", sceneFiles("frozen_2d.yaml"));
  const world = scene.withText(combableScene(scene.text, "hair", { freezes: true, stiffness: null })).createWorld();
  const hair = world.bodies[0];
  const tips = () => Array.from({ length: hair.strandCount }, (_, s) => world.points(hair)[3 * (hair.offsets[s + 1] - 1)]);
  world.step();
  const before = tips();
  world.setFrozenHair(hair, { reach: 10, clumpRadius: 1e-4 });
  world.commandFrozenHair(hair, [1, 0, 0]);
  world.step();
  const swept = tips();
  world.setFrozenHair(hair, { reach: 1e-3 });
  for (let k = 0; k < 20; ++k) {
    world.commandFrozenHair(hair, [-5, -5, 0]);
    world.step();
  }
  assert.ok(swept.every((x, s) => x > before[s] + 0.02));
  tips().forEach((x, s) => assert.ok(Math.abs(x - swept[s]) < 1e-3, `strand ${s} stays`));
  world.beginStroke(hair);
  world.step();
  tips().forEach((x, s) => assert.ok(Math.abs(x - before[s]) < 0.1, `strand ${s} is back`));
});

test("the first command ends the events of the scene, whose parameters it goes on with", () => {
  const name = "frozen_stroke.yaml";
  const scene = wisp.readScene(name, sceneFiles(name));
  const world = scene.createWorld();
  const history = new StrokeHistory(world, hairEvents(scene.text));
  const hair = world.bodies[0];
  for (let step = 0; step < 25; ++step) {
    world.step();
  }
  const before = world.frozenHair(hair);
  history.begin();
  history.command(hair, [0.05, -0.2, 0], { clumpRadius: 0.004 });
  history.command(hair, [0.06, -0.2, 0], { clumpRadius: 0.004, reach: 0.09 }); // before the same step
  world.step();
  history.command(hair, [0.07, -0.2, 0], { clumpRadius: 0.004, reach: 0.09 });
  world.step();
  assert.equal(world.frozenHair(hair).intensity, before.intensity);
  assert.equal(history.events.filter((event) => event.step >= 25).length, 2);
  const saved = combedScene(scene.text, history.events, world.stepCount);
  assert.equal(hashOfRun(saved), world.hash());
  history.undo();
  assert.deepEqual(world.frozenHair(hair), before);
  assert.equal(world.stepCount, 25);
  history.redo();
  assert.equal(hashOfRun(saved), world.hash());
});

test("an undo that the world refuses loses nothing", () => {
  const text = `wisp: 1
strands:
  - name: hair
    generate: { shape: wavy, strands: 20, vertices: 8 }
    frozen_hair: { base: stroke, freeze: {}, align: {} }
surfaces:
  - name: cloth
    generate: { shape: plane, columns: 4, rows: 4 }
    cloth: {}
`;
  const world = wisp.readScene("a.yaml", { "a.yaml": text }).createWorld();
  const history = new StrokeHistory(world, []);
  world.step();
  history.begin();
  history.command(world.bodies[0], [0, 0, 0], {});
  world.step();
  world.request(world.bodies[1], "strain");
  world.step();
  assert.throws(() => history.undo(), /snapshot/);
  assert.deepEqual(history.state(), { commands: 1, canUndo: true, canRedo: false });
});

test("a copy of strands has no entry to comb", () => {
  const text = "wisp: 1\nstrands:\n  - name: hair\n    generate: { shape: wavy }\n    copies: { count: 2, spacing: [1, 0, 0] }\n    frozen_hair: { freeze: {} }\n";
  assert.equal(hasEntry(text, "hair"), true);
  assert.equal(hasEntry(text, "hair-2"), false);
});

test("events of other strands stay in a scene that is combed", () => {
  const text = `wisp: 1
strands:
  - { name: a, generate: { shape: wavy }, frozen_hair: { align: {} } }
  - { name: b, generate: { shape: wavy }, frozen_hair: { align: {} } }
hair_events:
  - { step: 0, strands: a, cursor: [0, 0, 0] }
  - { step: 0, strands: b, cursor: [1, 0, 0] }
`;
  assert.deepEqual(hairEvents(combableScene(text, "a", { freezes: false, stiffness: null })), [{ step: 0, strands: "b", cursor: [1, 0, 0] }]);
});
