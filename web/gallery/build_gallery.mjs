/**
 * Makes the gallery: every scene of data/scenes and every figure of the papers, with what is shown and what it cost.
 *
 *     node web/gallery/build_gallery.mjs TREE WISP OUTPUT [--quick]
 *
 * Writes OUTPUT/index.html and its pictures. A scene's caption is the comment that begins its file; `pictures` in gallery.json has the
 * options of its pictures, and `figures` has scenes with words replaced. --quick draws fewer and smaller pictures.
 */
import { execFileSync } from "node:child_process";
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

/** A figure of a paper: a scene, with words of it replaced, in one or more frames. */
async function paperFigures({ title, pictures }) {
    const figures = [];
    for (const [index, { scene, text, replace = {}, options = [] }] of pictures.slice(0, isQuick ? 1 : pictures.length).entries()) {
        let words = (await readFile(join(tree, "data/scenes", `${scene}.yaml`), "utf8")).replaceAll("file: ../", `file: ${tree}/data/`);
        for (const [from, to] of Object.entries(replace)) {
            if (!words.includes(from)) throw new Error(`${scene}.yaml has no '${from}'`);
            words = words.replaceAll(from, to);
        }
        const name = `${basename(title.split(":")[0].replaceAll(" ", "_").toLowerCase())}_${index + 1}`, path = join(output, `${name}.yaml`);
        await writeFile(path, words);
        run("render", path, ...(options.includes("--size") || isQuick ? [] : ["--size", "480x360"]), ...options, ...look, "-o", `${name}.png`);
        figures.push({ picture: `${name}.png`, title: [`${scene}.yaml`, ...options].join(" "), text, cost: "" });
    }
    console.log(`${title}: ${figures.length} pictures`);
    return { title, figures, isSheet: true };
}

const card = ({ picture, title, text, cost }) => `<figure><a href="${picture}"><img src="${picture}" alt="${escape(text)}" loading="lazy"></a>
<figcaption><strong>${escape(title)}</strong> ${escape(text)}${cost ? `<br><small>${escape(cost)}</small>` : ""}</figcaption></figure>`;

const section = ({ title, figures, isSheet }) => `<section><h2>${escape(title)}</h2><div class="pictures${isSheet ? " sheets" : ""}">${figures.map(card).join("\n")}</div></section>`;

await rm(output, { recursive: true, force: true });
await mkdir(output, { recursive: true });
const sections = [{ title: "Scenes", figures: await sceneFigures() }];
for (const one of settings.figures) sections.push(await paperFigures(one));
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
