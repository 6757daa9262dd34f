/**
 * Builds the page: one file that holds its style, its scripts, the worker and the engine, and asks the network for nothing.
 *
 *     node web/build_viewer.mjs ENGINE OUTPUT
 *
 * ENGINE is the folder of wisp.mjs and the module that it loads, OUTPUT the page. `wisp view` puts a scene into a copy of it.
 */
import { build } from "esbuild";
import { readFile, readdir, writeFile } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

const here = dirname(fileURLToPath(import.meta.url));
const { positionals } = parseArgs({ allowPositionals: true });
if (positionals.length !== 2) {
    console.error("usage: node web/build_viewer.mjs ENGINE OUTPUT");
    process.exit(64);
}
const [engine, output] = positionals.map((path) => resolve(path));

/** A classic script of a module and all that it imports: workers from a Blob and pages from a file cannot import. */
async function bundle(entry) {
    const result = await build({
        entryPoints: [join(here, "viewer", entry)],
        bundle: true,
        write: false,
        format: "iife",
        target: "es2022",
        minify: true,
        legalComments: "inline",
        logLevel: "warning",
        alias: { wisp: join(engine, "wisp.mjs") },
        // The engine's glue looks for its files beside itself and for Node; here its bytes are given, and there is no Node. The
        // address of a Blob cannot be the base of another one.
        define: { "import.meta.url": '"file:///"' },
        external: ["node:*", "module", "fs", "path", "url", "crypto"],
        nodePaths: [join(here, "node_modules")],
    });
    return result.outputFiles[0].text;
}

/** Text between markers of the template. A function as replacement: the text may contain `$`. */
function put(page, marker, text) {
    if (!page.includes(marker)) throw new Error(`viewer/index.html: '${marker}' is missing`);
    return page.replace(marker, () => text);
}

async function wasmFile() {
    const found = (await readdir(engine)).find((name) => name.endsWith(".wasm"));
    if (!found) throw new Error(`${engine}: no .wasm file`);
    return readFile(join(engine, found));
}

const base64 = (bytes) => Buffer.from(bytes).toString("base64");
// A script ends at the first of these, even inside a text.
const inScript = (text) => text.replaceAll("</script", "<\\/script");

let page = await readFile(join(here, "viewer/index.html"), "utf8");
page = put(page, "/* style.css */", await readFile(join(here, "viewer/style.css"), "utf8"));
page = put(page, "/* main.mjs */", inScript(await bundle("main.mjs")));
page = put(page, `id="wisp-wasm">`, `id="wisp-wasm">${base64(await wasmFile())}`);
page = put(page, `id="wisp-worker">`, `id="wisp-worker">${base64(await bundle("worker.mjs"))}`);
await writeFile(output, page);
console.log(`${output}: ${(page.length / 1e6).toFixed(2)} MB`);
