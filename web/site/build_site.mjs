/**
 * Builds the site: a folder of static pages that ask no other machine for anything.
 *
 *     node web/site/build_site.mjs TREE OUTPUT [--live FOLDER] [--api FOLDER]
 *
 * TREE is the source tree. --live has the files of build_live.mjs, --api doxygen's pages by web/site/Doxyfile; without them the
 * site has no gallery and no API reference. OUTPUT is made anew. The site is refused if a link of it leads nowhere.
 */
import { cp, mkdir, readFile, readdir, rm } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { writeApi } from "./api_pages.mjs";
import { checkSite } from "./check_site.mjs";
import { docsIndex, docsPage } from "./docs_pages.mjs";
import { frontPage, galleryOf, galleryPage } from "./front_page.mjs";
import { TreePages, placeOf, put } from "./tree_pages.mjs";

const here = dirname(fileURLToPath(import.meta.url));

function usage() {
    console.error("usage: node web/site/build_site.mjs TREE OUTPUT [--live FOLDER] [--api FOLDER]");
    process.exit(64);
}

function options() {
    try {
        const { positionals, values } = parseArgs({ allowPositionals: true, options: { live: { type: "string" }, api: { type: "string" } } });
        return positionals.length === 2 ? { tree: resolve(positionals[0]), output: resolve(positionals[1]), ...values } : usage();
    } catch (error) {
        console.error(error.message);
        return usage();
    }
}

function end(problems) {
    for (const problem of problems) console.error(problem);
    process.exit(1);
}

/** The order of site.json; pages of docs/ that it does not name come last. */
async function groupsOf(settings, tree) {
    const named = settings.docs.flatMap(({ pages }) => pages);
    const found = (await readdir(join(tree, "docs"))).filter((name) => name.endsWith(".md")).map((name) => `docs/${name}`);
    const others = found.filter((file) => !named.includes(file)).sort();
    return others.length > 0 ? [...settings.docs, { title: "More", pages: others }] : settings.docs;
}

async function writePages(site, tree, groups, output) {
    const problems = [];
    const sources = new TreePages(tree, problems);
    for (const file of ["README.md", "CHANGES.md", ...groups.flatMap(({ pages }) => pages)]) await sources.add(file);
    if (problems.length > 0) end(problems);
    await put(output, "index.html", frontPage(site, sources.pages.get("README.md")));
    await put(output, "docs/index.html", docsIndex(site, groups, sources.pages));
    for (const file of sources.pages.keys()) {
        if (file !== "README.md") await put(output, placeOf(file), docsPage(site, groups, sources.pages, file));
    }
    await sources.writeFiles(site, output);
    return sources.pages.size;
}

const { tree, output, live, api } = options();
const settings = JSON.parse(await readFile(join(here, "site.json"), "utf8"));
const { version } = JSON.parse(await readFile(join(tree, "web/package.json"), "utf8"));
const gallery = live ? galleryOf(settings, await readdir(live)) : [];
if (live && gallery.length < settings.gallery.length) end([`${live}: got ${gallery.length} live pages with pictures, expected ${settings.gallery.length}`]);
const site = {
    version,
    gallery,
    hero: settings.hero,
    navigation: [
        ...(live ? [{ title: "Gallery", path: "gallery.html" }] : []),
        { title: "Docs", path: "docs/index.html" },
        { title: "Results", path: "docs/results.html" },
        ...(api ? [{ title: "API", path: "api/index.html" }] : []),
        { title: "Changes", path: "CHANGES.html" },
    ],
};

await rm(output, { recursive: true, force: true });
await mkdir(output, { recursive: true });
for (const name of ["base.css", "pages.css", "api.css", "site.js", "icon.svg"]) await cp(join(here, name), join(output, name));
const count = await writePages(site, tree, await groupsOf(settings, tree), output);
if (live) {
    for (const { name } of gallery) {
        for (const file of [`${name}.html`, `${name}.png`]) await cp(join(live, file), join(output, "live", file));
    }
    await put(output, "gallery.html", galleryPage(site));
}
if (api) await writeApi(site, resolve(api), output);
const problems = await checkSite(output);
if (problems.length > 0) end(problems);
console.log(`${output}: ${count} pages of text, ${gallery.length} live pages${api ? ", the API reference" : ""}`);
