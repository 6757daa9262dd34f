/**
 * Makes the gallery: every scene of data/scenes and every figure of the papers, with what is shown and what it cost.
 *
 *     node web/gallery/build_gallery.mjs TREE WISP OUTPUT [--quick]
 *
 * Writes OUTPUT/index.html and its pictures. A scene's caption is the comment that begins its file; `pictures` in gallery.json has the
 * options of its pictures, and `figures` the cases of `wisp bench` that draw. --quick draws fewer and smaller pictures.
 */
import { execFileSync, spawnSync } from "node:child_process";
import { copyFile, mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const words = process.argv.slice(2).filter((word) => word !== "--quick");
const isQuick = process.argv.includes("--quick");
if (words.length !== 3) {
    console.error("usage: node web/gallery/build_gallery.mjs TREE WISP OUTPUT [--quick]");
    process.exit(64);
}
const [tree, wisp, output] = words.map((path) => resolve(path));
const settings = JSON.parse(await readFile(join(here, "gallery.json"), "utf8"));
const look = isQuick ? ["--size", "320x200", "--samples", "4"] : ["--samples", "32"];

/** The program says what is wrong itself. */
function run(...options) {
    try {
        return execFileSync(wisp, options, { encoding: "utf8", stdio: ["ignore", "pipe", "inherit"] });
    } catch (error) {
        process.exit(error.status || 1);
    }
}

/** The comment that begins a scene, as one text. */
function commentOf(text) {
    const lines = text.split("\n");
    const end = lines.findIndex((line) => !line.startsWith("#"));
    return lines.slice(0, end).map((line) => line.replace(/^#\s?/, "")).join(" ");
}

/** Text as it stands in HTML, also within quotes. */
const escape = (text) =>
    text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");

const grouped = (number) => String(number).replace(/\B(?=(\d{3})+$)/g, "\u202f");

/** What a run of the scene says: size, and the median of a step. */
function costOf(path) {
    const [row] = JSON.parse(run("run", path, "--format", "json")).rows;
    const { strands, vertices } = row.size;
    const size = `${strands > 0 ? `${grouped(strands)} strands, ` : ""}${grouped(vertices)} vertices`;
    return `${size}; ${row.ms_median.toPrecision(2)} ms a step with ${row.workers} worker${row.workers === 1 ? "" : "s"}`;
}

/** A scene writes its outputs into the folder it is run in. */
async function sceneFigures() {
    const figures = [];
    const names = (await readdir(join(tree, "data/scenes"))).filter((name) => name.endsWith(".yaml")).sort();
    process.chdir(output);
    for (const name of names.slice(0, isQuick ? 3 : names.length)) {
        const path = join(tree, "data/scenes", name), scene = basename(name, ".yaml"), cost = costOf(path);
        const text = commentOf(await readFile(path, "utf8"));
        for (const [index, options] of (settings.pictures[scene] ?? [[]]).entries()) {
            const picture = `${scene}${index > 0 ? `_${index + 1}` : ""}.png`;
            run("render", path, ...(options.includes("--size") || isQuick ? [] : ["--size", "960x600"]), ...options, ...look, "-o", picture);
            figures.push({ picture, title: [name, ...options].join(" "), text, cost });
        }
        console.log(`${name}: ${cost}`);
    }
    return figures;
}

/** Pictures that a case draws are notes of its results. A check of it that fails does not stop the gallery, but is said. */
async function paperFigures({ name, groups }) {
    await mkdir(join(output, name), { recursive: true });
    const results = join(output, name, "results.json");
    const options = ["bench", name, "--pictures", join(output, name), "--format", "json", "--output", results, ...(isQuick ? ["--quick"] : [])];
    const { status } = spawnSync(wisp, options, { stdio: ["ignore", "ignore", "inherit"] });
    if (status !== 0) console.error(`wisp bench ${name} ended with ${status}; see ${results}`);
    const { notes } = JSON.parse(await readFile(results, "utf8"));
    const found = notes.map((note) => /!\[(.*)\]\((.*)\)/.exec(note)).filter((match) => match)
        .map(([, text, path]) => ({ picture: `${name}/${basename(path)}`, title: basename(path, ".png"), text, cost: "" }));
    return groups.map(({ title, begins }) => ({ title, figures: found.filter((one) => one.title.startsWith(begins)), isSheet: true }));
}

const card = ({ picture, title, text, cost }) => `<figure><a href="${picture}"><img src="${picture}" alt="${escape(text)}" loading="lazy"></a>
<figcaption><strong>${escape(title)}</strong> ${escape(text)}${cost ? `<br><small>${escape(cost)}</small>` : ""}</figcaption></figure>`;

const section = ({ title, figures, isSheet }) => `<section><h2>${escape(title)}</h2><div class="pictures${isSheet ? " sheets" : ""}">${figures.map(card).join("\n")}</div></section>`;

await rm(output, { recursive: true, force: true });
await mkdir(output, { recursive: true });
const sections = [{ title: "Scenes", figures: await sceneFigures() }];
for (const one of settings.figures) sections.push(...(await paperFigures(one)));
for (const name of ["gallery.css", "icon.svg"]) await copyFile(join(here, name), join(output, name));
await writeFile(join(output, "index.html"), `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="description" content="Every scene and every figure of the papers">
<title>Wisp in pictures</title>
<link rel="icon" href="icon.svg">
<link rel="stylesheet" href="gallery.css">
</head>
<body><main><h1>Wisp in pictures</h1>
${sections.filter(({ figures }) => figures.length > 0).map(section).join("\n")}
</main></body>
</html>
`);
console.log(`${join(output, "index.html")}: ${sections.reduce((sum, { figures }) => sum + figures.length, 0)} pictures`);
