/** What the tests share: the package that `./dev web` built, scenes of the tree, and the native program. */
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
export const packageFolder = join(root, "build-web/package");
export const program = join(root, "build/app/wisp");

export const { loadWisp, WispError } = await import(join(packageFolder, "wisp.mjs"));

/** The files of a scene in data/scenes. */
export function sceneFiles(name) {
  const files = { [name]: readFileSync(join(root, "data/scenes", name), "utf8") };
  for (const mesh of ["bunny.obj", "figure.glb"]) {
    if (files[name].includes(`../${mesh}`)) {
      files[`../${mesh}`] = readFileSync(join(root, "data", mesh));
    }
  }
  return files;
}

/** Run the native program. @returns its standard output */
export function wisp(...options) {
  return execFileSync(program, options, { encoding: "utf8", cwd: root, stdio: ["ignore", "pipe", "pipe"] });
}

/** The hash that `wisp run` prints for a scene. */
export function nativeHash(path, ...options) {
  return /^hash +([0-9a-f]{16})$/m.exec(wisp("run", path, ...options))[1];
}
