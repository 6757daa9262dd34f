/** The package as somebody else gets it: packed by npm, installed in an empty project, used with types. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { nativeHash, packageFolder, root } from "./package.mjs";

const SCENE = "data/scenes/flag.yaml";
const PROGRAM = `import { readFileSync } from "node:fs";
import { loadWisp, type World } from "wisp";

const wisp = await loadWisp();
const scene = wisp.readScene("flag.yaml", { "flag.yaml": readFileSync(process.argv[2]!, "utf8") });
const world: World = scene.createWorld();
for (let step = 0; step < 30; ++step) world.step();
const points: Float32Array = world.points(world.bodies[0]!);
console.log(world.hash(), points.length);
`;

let folder;

function run(command, ...options) {
  return execFileSync(command, options, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

before(() => {
  folder = mkdtempSync(join(tmpdir(), "wisp-"));
  const [packed] = JSON.parse(run("npm", "pack", packageFolder, "--json"));
  writeFileSync(join(folder, "package.json"), JSON.stringify({ name: "consumer", type: "module", private: true }));
  run("npm", "install", "--offline", "--no-audit", "--no-fund", join(folder, packed.filename));
  writeFileSync(join(folder, "program.ts"), PROGRAM);
});

after(() => rmSync(folder, { recursive: true }));

test("a program with types runs a scene from the packed package, with the native hash", () => {
  const tsc = join(root, "web/node_modules/typescript/bin/tsc");
  const typings = join(root, "web/node_modules/@types");
  run(process.execPath, tsc, "--strict", "--noUncheckedIndexedAccess", "--module", "nodenext", "--target", "es2022",
    "--typeRoots", typings, "--types", "node", "program.ts");
  assert.equal(run(process.execPath, "program.js", join(root, SCENE)).trim(),
    `${nativeHash(SCENE, "--steps", "30")} ${3 * 61 * 41}`);
});

test("the package holds what it needs and nothing else", () => {
  const [packed] = JSON.parse(run("npm", "pack", packageFolder, "--json", "--dry-run"));
  assert.deepEqual(packed.files.map((file) => file.path).sort(),
    ["LICENSE", "README.md", "package.json", "wisp.d.ts", "wisp.mjs", "wisp_module.mjs", "wisp_module.wasm"]);
});
