/** A report in Chromium: its charts are drawn from its data, and are tables without script. */
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { wisp as runProgram } from "./package.mjs";
import { launch } from "./page.mjs";

const SCENE = `wisp: 1
steps: 6
surfaces: [{ name: sheet, generate: { shape: plane, columns: 5, rows: 5, spacing: 0.1 }, pins: [0, 4], cloth: {} }]
`;
const NAME = `</script><b>"`;

const folder = mkdtempSync(join(tmpdir(), "wisp-report-")), path = join(folder, "report.html");
let browser, charts;
before(async () => {
    browser = await launch();
    writeFileSync(join(folder, "sheet.yaml"), SCENE);
    runProgram("accuracy", join(folder, "sheet.yaml"), "--quick", "--seconds", "0.2", "--report", path);
    const page = readFileSync(path, "utf8"), [, data] = /id="chart-data">([^<]*)</.exec(page);
    charts = JSON.parse(data);
    charts[0].series[0].name = NAME;
    writeFileSync(path, page.replace(data, () => JSON.stringify(charts).replaceAll("<", "\\u003c")));
});
after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
});

/** Open the report and give it to a test; an error or a request fails it. */
async function withReport(options, use) {
    const context = await browser.newContext(options), problems = [];
    const page = await context.newPage();
    page.on("console", (message) => problems.push(message.text()));
    page.on("pageerror", (error) => problems.push(error.stack));
    page.on("request", (request) => {
        if (!/^(file|data):/.test(request.url())) problems.push(`request of ${request.url()}`);
    });
    await page.goto(pathToFileURL(path).href);
    await use(page);
    assert.deepEqual(problems, []);
    await context.close();
}

test("every chart is drawn, on a wide and on a narrow screen, light and dark", async () => {
    const colours = new Set();
    for (const width of [1200, 390]) {
        for (const colorScheme of ["light", "dark"]) {
            await withReport({ viewport: { width, height: 900 }, colorScheme }, async (page) => {
                assert.ok(charts.length > 0);
                assert.equal(await page.locator("svg.plot").count(), charts.length);
                const points = charts.flatMap((chart) => chart.series).flatMap((series) => series.points);
                assert.equal(await page.locator("svg.plot g.point use").count(), points.filter((p) => p.y > 0 && p.x > 0).length);
                assert.equal(await page.locator("#chart-1 .key li").first().textContent(), NAME);
                const box = await page.locator("#chart-1 svg.plot").boundingBox();
                assert.ok(box.width > 0.7 * Math.min(width, 500) && box.x >= 0 && box.x + box.width <= width);
                assert.ok((await page.locator("nav a").count()) > charts.length);
                colours.add(await page.locator("#chart-1 .line").first().evaluate((line) => getComputedStyle(line).stroke));
            });
        }
    }
    assert.equal(colours.size, 2);
});

test("without script the charts are tables", async () => {
    await withReport({ javaScriptEnabled: false }, async (page) => {
        assert.equal(await page.locator("figure table.data").count(), charts.length);
        const rows = charts.flatMap((chart) => chart.series).reduce((sum, series) => sum + series.points.length, 0);
        assert.equal(await page.locator("figure table.data tbody tr").count(), rows);
        assert.ok(await page.locator("#chart-1 table.data").isVisible());
    });
});
