/**
 * Makes the live pages of the gallery and their pictures.
 *
 *     node web/site/build_live.mjs TREE WISP OUTPUT
 *
 * Writes OUTPUT/NAME.html by `wisp view` and OUTPUT/NAME.png by `wisp render` for each scene of site.json.
 */
import { execFileSync } from "node:child_process";
import { mkdir, readFile } from "node:fs/promises";
import { basename, join, resolve } from "node:path";

if (process.argv.length !== 5) {
    console.error("usage: node web/site/build_live.mjs TREE WISP OUTPUT");
    process.exit(64);
}
const [tree, wisp, output] = process.argv.slice(2).map((path) => resolve(path));
const { gallery, pictures } = JSON.parse(await readFile(join(tree, "web/site/site.json"), "utf8"));

/** The program says what is wrong itself. */
function run(...words) {
    try {
        execFileSync(wisp, words, { stdio: "inherit" });
    } catch (error) {
        process.exit(error.status || 1);
    }
}

await mkdir(output, { recursive: true });
for (const { scene } of gallery) {
    const from = join(tree, "data/scenes", scene);
    const to = join(output, basename(scene, ".yaml"));
    run("view", from, "-o", `${to}.html`);
    run("render", from, ...(pictures[basename(scene, ".yaml")]?.[0] ?? []), "--size", "960x600", "--samples", "24", "-o", `${to}.png`);
}
