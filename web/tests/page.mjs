/**
 * Pages for tests in Chromium: a scene or recording in a copy of viewer.html, opened from a file. Every request that leaves the page
 * and every error in its console fails the test that uses it.
 */
import assert from "node:assert/strict";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const ROOT = fileURLToPath(new URL("../../", import.meta.url));
const BUILD = join(ROOT, "build-web");
const EXECUTABLE = process.env.CHROMIUM ?? "/usr/bin/chromium";
// The renderer in software draws WebGL2 on machines without a graphics card.
const FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];
/** Messages of that renderer about its own speed. */
const HARMLESS = /GL Driver Message|GPU stall/;

export async function launch() {
    return chromium.launch({ executablePath: EXECUTABLE, args: FLAGS });
}

/**
 * @param {string} name of the scene or recording @param {Record<string, string|Uint8Array>} files
 * @param {object} [more] of the page's data, such as hashes
 */
export function pageData(name, files, more = {}) {
    const encoded = Object.entries(files).map(([file, content]) => [file, Buffer.from(content).toString("base64")]);
    return {
        version: "0", kind: name.endsWith(".wisp") ? "recording" : "scene", name, title: name.replace(/\.[^.]*$/, ""),
        files: Object.fromEntries(encoded), hashes: { every: 60, isa: "test", values: [] }, ...more,
    };
}

/**
 * Open a page and give it to a test. @param {import("playwright-core").Browser} browser
 * @param {object|null} data @param {object} options of the context, such as viewport
 * @param {(page: import("playwright-core").Page) => Promise<void>} use
 */
export async function withPage(browser, data, options, use) {
    const folder = await mkdtemp(join(tmpdir(), "wisp-page-"));
    const context = await browser.newContext({ viewport: { width: 860, height: 560 }, acceptDownloads: true, ...options });
    try {
        const template = await readFile(join(BUILD, "viewer.html"), "utf8");
        const marker = `id="wisp-data">null<`;
        assert.ok(template.includes(marker), "viewer.html has the place for its data");
        const path = join(folder, "page.html");
        await writeFile(path, template.replace(marker, () => `id="wisp-data">${JSON.stringify(data)}<`));
        const page = await context.newPage();
        page.setDefaultTimeout(20000);
        const problems = [];
        page.on("console", (message) => {
            if (["error", "warning"].includes(message.type()) && !HARMLESS.test(message.text())) problems.push(message.text());
        });
        page.on("pageerror", (error) => problems.push(error.stack));
        page.on("request", (request) => {
            if (!/^(file|blob|data):/.test(request.url())) problems.push(`request of ${request.url()}`);
        });
        await page.goto(pathToFileURL(path).href);
        await use(page);
        assert.deepEqual(problems, []);
    } finally {
        await context.close();
        await rm(folder, { recursive: true });
    }
}

export const state = (page) => page.evaluate(() => window.wispPage?.state() ?? { isOpen: false });

/** Wait until what the page knows about its run satisfies a function. @param {(state: object) => boolean} holds */
export async function until(page, holds) {
    const end = Date.now() + 60000;
    for (;;) {
        const now = await state(page);
        if (now.isOpen && holds(now)) {
            // What has arrived is shown with the next picture.
            await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
            return now;
        }
        if (Date.now() > end) assert.fail(`not within a minute: ${holds}, but ${JSON.stringify({ ...now, passes: [], bodies: [] })}`);
        await new Promise((resolve) => setTimeout(resolve, 50));
    }
}

/** Where a vertex is on the screen, once the camera has come to rest. */
export async function settledVertex(page, body, vertex) {
    const read = () => page.evaluate(([b, v]) => window.wispPage.vertexOnScreen(b, v), [body, vertex]);
    for (let before = await read(); ;) {
        await new Promise((resolve) => setTimeout(resolve, 300));
        const now = await read();
        if (Math.hypot(now[0] - before[0], now[1] - before[1]) < 0.05) return now;
        before = now;
    }
}
