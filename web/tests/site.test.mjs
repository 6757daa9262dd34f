/** The site: its links, what it asks the network for, and how it fits a phone. Built here from the documents alone. */
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { chromium } from "playwright-core";
import { checkSite } from "../site/check_site.mjs";

const run = promisify(execFile);
const tree = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const builder = join(tree, "web/site/build_site.mjs");
const pages = ["index.html", "docs/index.html", "docs/scenes.html", "docs/methods.html", "docs/results.html", "CHANGES.html"];
let folder;
let site;
let browser;

before(async () => {
    folder = await mkdtemp(join(tmpdir(), "wisp-site-"));
    site = join(folder, "site");
    await run(process.execPath, [builder, tree, site]);
    browser = await chromium.launch({
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync"],
    });
});

after(async () => {
    await browser?.close();
    if (folder) await rm(folder, { recursive: true, force: true });
});

/** Opens a page of a site and collects what it asks for and complains about. */
async function open(path, width = 1440, root = site) {
    const context = await browser.newContext({ viewport: { width, height: 844 } });
    const page = await context.newPage();
    const requests = [];
    const errors = [];
    page.on("request", (request) => requests.push(request.url()));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(pathToFileURL(join(root, path)).href);
    return { page, requests, errors, close: () => context.close() };
}

/** A tree of a few pages, with this text as docs/page.md. */
async function smallTree(name, text) {
    const small = join(folder, name);
    await mkdir(join(small, "docs"), { recursive: true });
    await mkdir(join(small, "web"));
    await cp(join(tree, "web/package.json"), join(small, "web/package.json"));
    await writeFile(join(small, "README.md"), "# Small\n\nA sentence.\n\n- **Fact.** Text.\n");
    await writeFile(join(small, "CHANGES.md"), "# Changes\n");
    const { docs } = JSON.parse(await readFile(join(tree, "web/site/site.json"), "utf8"));
    for (const file of docs.flatMap((group) => group.pages)) {
        await mkdir(dirname(join(small, file)), { recursive: true });
        await writeFile(join(small, file), `# ${file}\n`);
    }
    await writeFile(join(small, "docs/page.md"), text);
    return small;
}

const build = (small, output) => run(process.execPath, [builder, small, join(folder, output)]);

test("every link of the site leads to a file and a heading, and nothing is loaded from elsewhere", async () => {
    assert.deepEqual(await checkSite(site), []);
});

test("a link to a file that is not there is refused with the page and the link", async () => {
    const small = await smallTree("dead-file", "# Page\n\n[gone](gone.md)\n");
    await assert.rejects(build(small, "out"), /docs\/page\.md: link to 'gone\.md': there is no such file/);
});

test("a link to a heading that is not there is refused with the page and the link", async () => {
    const small = await smallTree("dead-heading", "# Page\n\n[gone](scenes.md#gone)\n");
    await assert.rejects(build(small, "out"), /docs\/page\.html: link to 'scenes\.html#gone': there is no such heading/);
});

test("a picture from another machine is refused", async () => {
    const small = await smallTree("external", "# Page\n\n![far](https://example.org/far.png)\n");
    await assert.rejects(build(small, "out"), /docs\/page\.html: loads 'https:\/\/example\.org\/far\.png' from elsewhere/);
});

test("headings have the anchors of GitHub, and equal ones are counted", async () => {
    const small = await smallTree("anchors", "# Page\n\n## `a_b`: What's *it*, then?\n\n## Same\n\n## Same\n\n[x](#a_b-whats-it-then) [y](#same-1)\n");
    await build(small, "anchors-out");
    const html = await readFile(join(folder, "anchors-out/docs/page.html"), "utf8");
    assert.match(html, /<h2 id="a_b-whats-it-then">/);
    assert.match(html, /<h2 id="same">/);
    assert.match(html, /<h2 id="same-1">/);
});

test("a page that site.json does not name is listed all the same", async () => {
    await build(await smallTree("unnamed", "# Page\n"), "unnamed-out");
    const html = await readFile(join(folder, "unnamed-out/docs/index.html"), "utf8");
    assert.match(html, /<a href="page\.html">Page<\/a>/);
});

test("files that pages link to are copied", async () => {
    const small = await smallTree("files", "# Page\n\n[source](../code/main.c)\n[folder](../code)\n");
    await mkdir(join(small, "code"));
    await writeFile(join(small, "code/main.c"), "int main;\n");
    await build(small, "files-out");
    assert.equal(await readFile(join(folder, "files-out/code/main.c.txt"), "utf8"), "int main;\n");
    assert.match(await readFile(join(folder, "files-out/code/index.html"), "utf8"), /href="main\.c\.txt"/);
});

test("pages ask for nothing but files of the site, and complain about nothing", async () => {
    for (const path of pages) {
        const { requests, errors, close } = await open(path);
        assert.deepEqual(requests.filter((url) => !url.startsWith(pathToFileURL(site).href)), [], path);
        assert.ok(requests.length >= 4, `${path}: the page, two styles and a script`);
        assert.deepEqual(errors, [], path);
        await close();
    }
});

test("no page is wider than a phone", async () => {
    for (const path of pages) {
        const { page, close } = await open(path, 390);
        const width = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.equal(width, 390, path);
        await close();
    }
});

test("the first key leads to the text", async () => {
    const { page, close } = await open("docs/scenes.html");
    await page.keyboard.press("Tab");
    const first = await page.evaluate(() => ({ text: document.activeElement.textContent, top: document.activeElement.getBoundingClientRect().top }));
    assert.equal(first.text, "Skip to the text");
    assert.ok(first.top >= 0);
    await page.keyboard.press("Enter");
    assert.equal(new URL(page.url()).hash, "#content");
    await close();
});

/** A site with a gallery whose live pages only have a title. */
async function siteWithGallery() {
    const live = join(folder, "live");
    await mkdir(live, { recursive: true });
    const { gallery } = JSON.parse(await readFile(join(tree, "web/site/site.json"), "utf8"));
    for (const { scene } of gallery) {
        await writeFile(join(live, scene.replace(".yaml", ".html")), `<!DOCTYPE html><title>${scene}</title>`);
        await cp(join(tree, "docs/pictures/cloth_fold.png"), join(live, scene.replace(".yaml", ".png")));
    }
    const output = join(folder, "gallery-site");
    await run(process.execPath, [builder, tree, output, "--live", live]);
    return { output, count: gallery.length, live };
}

test("a picture of the gallery becomes its live page, one at a time, and opens it on a phone", async () => {
    const { output, count } = await siteWithGallery();
    const desktop = await open("gallery.html", 1440, output);
    assert.equal(await desktop.page.locator("a.poster").count(), count);
    assert.equal(await desktop.page.locator("iframe").count(), 0);
    await desktop.page.click("#flag a.poster");
    await desktop.page.click("#cloth_fold a.poster");
    assert.deepEqual(await desktop.page.locator("iframe").evaluateAll((frames) => frames.map(({ src }) => src.split("/").at(-1))), ["cloth_fold.html"]);
    assert.deepEqual(desktop.errors, []);
    await desktop.close();

    const phone = await open("gallery.html", 390, output);
    assert.equal(await phone.page.evaluate(() => document.documentElement.scrollWidth), 390);
    await phone.page.click("#flag a.poster");
    await phone.page.waitForURL(/live\/flag\.html$/);
    await phone.close();
});

test("a gallery that lacks a live page is refused", async () => {
    const { live, count } = await siteWithGallery();
    await rm(join(live, "flag.png"));
    await assert.rejects(run(process.execPath, [builder, tree, join(folder, "out"), "--live", live]),
        new RegExp(`got ${count - 1} live pages with pictures, expected ${count}`));
});
