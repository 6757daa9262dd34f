/** Hair that was combed by hand: the saved scene gives `wisp run` the bits of the page. */
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { combableScene, combedScene } from "../viewer/hair_scene.mjs";
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
