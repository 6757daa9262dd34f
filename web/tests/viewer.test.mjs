/** The page of `wisp view` in Chromium. */
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { loadWisp, nativeHash, wisp as runProgram } from "./package.mjs";
import { launch, pageData, settledVertex, state, until, withPage } from "./page.mjs";

/** A small cloth that hangs from two corners: quick with a reference and a search. */
const CLOTH = `wisp: 1
dt: 0.0166667
steps: 240
substeps: 2
surfaces:
  - name: cloth
    generate: { shape: plane, columns: 13, rows: 13, spacing: 0.05 }
    pins: [0, 12]
    cloth: { drag_coefficient: 0.2 }
    compute: [points]
colliders:
  - { name: ball, shape: sphere, radius: 0.1, position: [0.3, -0.35, 0.3] }
  - { name: ground, shape: plane, position: [0, -1, 0] }
`;

let browser, wisp;
before(async () => {
    [browser, wisp] = await Promise.all([launch(), loadWisp()]);
});
after(() => browser.close());

const cloth = (more) => pageData("cloth.yaml", { "cloth.yaml": CLOTH }, more);

/** Hashes of a run in node: the bits are those of the native program, which the tests of the module establish. */
function hashesOf(text, steps, every) {
    const world = wisp.readScene("cloth.yaml", { "cloth.yaml": text }).createWorld();
    const values = [];
    for (let step = 1; step <= steps; ++step) {
        world.step();
        if (step % every === 0) values.push(world.hash());
    }
    world.release();
    return { every, isa: "test", values };
}

async function pause(page) {
    if ((await state(page)).isPlaying) await page.getByRole("button", { name: "Pause" }).click();
}

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

test("a scene runs from a file without a request to any server, with the hashes of the run outside the browser", async () => {
    const hashes = hashesOf(CLOTH, 60, 20);
    await withPage(browser, cloth({ hashes }), {}, async (page) => {
        const { hashes: shown } = await until(page, (s) => s.step >= 62);
        assert.deepEqual(shown.rows.slice(0, 3).map((row) => [row.step, row.hash, row.isEqual]),
            hashes.values.map((hash, k) => [20 * (k + 1), hash, true]));
        await page.getByText("hashes equal those of the native run").waitFor();
    });
});

test("a hash that differs is shown as different", async () => {
    await withPage(browser, cloth({ hashes: { every: 10, isa: "test", values: ["0123456789abcdef"] } }), {}, async (page) => {
        await until(page, (s) => s.step >= 12);
        await page.getByText("Differs from the native run at step 10.").waitFor();
    });
});

test("buttons and keys pause, make one step, and start again", async () => {
    await withPage(browser, cloth(), {}, async (page) => {
        await until(page, (s) => s.step >= 3);
        await pause(page);
        const paused = await until(page, (s) => s.step === s.requested && !s.isPlaying);
        await page.getByRole("button", { name: "Step" }).click();
        await until(page, (s) => s.step === paused.step + 1);
        await page.locator("#canvas").focus();
        await page.keyboard.press(".");
        await until(page, (s) => s.step === paused.step + 2);
        await page.keyboard.press("r");
        await until(page, (s) => s.step === 0);
        await page.keyboard.press(" ");
        await until(page, (s) => s.isPlaying && s.step >= 2);
        await page.keyboard.press("3");
        assert.equal((await state(page)).speed, 0.25);
        await page.keyboard.press("?");
        await page.getByRole("dialog", { name: "Keys and pointer" }).waitFor();
    });
});

test("the pointer drags a vertex, lets it go, and the hashes are no longer compared", async () => {
    await withPage(browser, cloth({ hashes: hashesOf(CLOTH, 60, 20) }), {}, async (page) => {
        await until(page, (s) => s.step >= 2);
        const vertex = 6 * 13 + 6;
        await pause(page);
        await until(page, (s) => s.step === s.requested);
        const from = await page.evaluate((v) => window.wispPage.vertex(0, v), vertex);
        const [x, y] = await page.evaluate((v) => window.wispPage.vertexOnScreen(0, v), vertex);
        await page.mouse.move(x, y);
        await page.mouse.down();
        await page.mouse.move(x + 20, y - 60, { steps: 4 });
        await page.getByRole("button", { name: "Step" }).focus();
        const { step } = await state(page);
        for (let k = 0; k < 3; ++k) await page.keyboard.press("Enter");
        await until(page, (s) => s.step === step + 3);
        const [dx, dy] = await page.evaluate((v) => window.wispPage.vertexOnScreen(0, v), vertex);
        const to = await page.evaluate((v) => window.wispPage.vertex(0, v), vertex);
        // The vertex is where the pointer is, to a pixel: what was gripped is not exactly at it.
        assert.ok(distance([dx, dy], [x + 20, y - 60]) < 2, `${dx}, ${dy} is not ${x + 20}, ${y - 60}`);
        assert.ok(distance(from, to) > 0.05);
        await page.mouse.up();
        await page.keyboard.press("Enter");
        await until(page, (s) => s.step === step + 4);
        assert.match((await state(page)).hashes.excluded, /you changed the scene/);
    });
});

test("touch drags a vertex, and one finger on empty space orbits", async () => {
    await withPage(browser, cloth(), { hasTouch: true, viewport: { width: 390, height: 844 } }, async (page) => {
        await until(page, (s) => s.step >= 2);
        await pause(page);
        await until(page, (s) => s.step === s.requested);
        const client = await page.context().newCDPSession(page);
        const touch = (type, x, y) => client.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
        const screen = () => settledVertex(page, 0, 84);
        const start = await screen();
        await touch("touchStart", 20, 150);
        await touch("touchMove", 80, 150);
        await touch("touchEnd");
        const orbited = await screen();
        assert.ok(distance(start, orbited) > 2, "the camera has moved");
        await touch("touchStart", ...orbited);
        await touch("touchMove", orbited[0] + 10, orbited[1] - 50);
        await page.getByRole("button", { name: "Step" }).focus();
        const { step } = await state(page);
        await page.keyboard.press("Enter");
        await until(page, (s) => s.step === step + 1);
        assert.ok(distance(await screen(), [orbited[0] + 10, orbited[1] - 50]) < 3);
        await touch("touchEnd");
    });
});

test("a collider follows the pointer and moves the cloth on it", async () => {
    await withPage(browser, cloth(), {}, async (page) => {
        await until(page, (s) => s.step >= 1);
        await pause(page);
        await until(page, (s) => s.step === s.requested);
        const before = await page.evaluate(() => window.wispPage.vertex(1, 0));
        // From below, so that nothing is in front of the ball.
        await page.locator("#canvas").focus();
        for (let k = 0; k < 20; ++k) await page.keyboard.press("ArrowDown");
        await settledVertex(page, 1, 0);
        const count = (await state(page)).bodies[1].vertexCount;
        const middle = await page.evaluate((n) => {
            const places = Array.from({ length: n }, (_, v) => window.wispPage.vertexOnScreen(1, v));
            return [0, 1].map((k) => places.reduce((sum, p) => sum + p[k], 0) / n);
        }, count);
        await page.mouse.move(...middle);
        await page.mouse.down();
        await page.mouse.move(middle[0] + 40, middle[1], { steps: 3 });
        const { step } = await state(page);
        await page.getByRole("button", { name: "Step" }).focus();
        for (let k = 0; k < 2; ++k) await page.keyboard.press("Enter");
        await until(page, (s) => s.step === step + 2);
        const place = await page.evaluate(() => window.wispPage.vertex(1, 0));
        assert.ok(distance(before, place) > 0.02, "the ball has moved");
        await page.mouse.up();
    });
});

test("settings restart the scene and change its error, which the reference measures; off is at the left", async () => {
    await withPage(browser, cloth(), {}, async (page) => {
        const first = await until(page, (s) => s.usesReference && s.followed >= 40);
        assert.ok(first.rms > 1e-5, `a coarse run is off its reference: ${first.rms} m`);
        assert.ok(first.step - first.followed <= 5, "the scene waits for its reference");
        await page.getByLabel("substeps", { exact: true }).focus();
        await page.keyboard.press("End");
        const finer = await until(page, (s) => s.parameters.find((k) => k.name === "substeps").value >= 16 && s.followed >= 40);
        assert.ok(finer.rms < first.rms, `${finer.rms} m is less than ${first.rms} m`);
        assert.match(finer.hashes.excluded, /settings differ/);
        await page.getByRole("button", { name: "Scene's own settings" }).click();
        const own = await until(page, (s) => s.parameters.find((k) => k.name === "substeps").value === 2 && s.followed >= 5);
        assert.equal(own.hashes.excluded, null);
        const tethers = page.getByLabel("cloth tethers", { exact: true });
        await tethers.focus();
        for (const [key, text] of [["End", "on"], ["Home", "off"]]) {
            await page.keyboard.press(key);
            await page.locator(`[aria-valuetext="${text}"]`).and(tethers).waitFor(); // the page draws it in its next frame
        }
    });
});

test("both worlds receive the same inputs before the same steps", async () => {
    await withPage(browser, cloth(), {}, async (page) => {
        await page.getByLabel("substeps", { exact: true }).waitFor();
        await page.getByLabel("substeps", { exact: true }).focus();
        await page.keyboard.press("End");
        await until(page, (s) => s.parameters[0].value >= 16 && s.followed >= 5);
        await page.getByText("Forces").click();
        await page.getByLabel("Gravity, y").fill("9.81");
        await page.keyboard.press("Tab");
        const { step } = await state(page);
        const risen = await until(page, (s) => s.followed >= step + 200); // on the way up folds are chance
        const [, y] = await page.evaluate(() => window.wispPage.vertex(0, 84));
        assert.ok(y > 0.1, `the cloth falls upwards: ${y} m`);
        // A reference that still hung would be more than half a metre away.
        assert.ok(risen.rms < 0.2, `${risen.rms} m`);
    });
});

test("a search finds settings within an error and applies them, or says that none meets it", async () => {
    await withPage(browser, cloth(), {}, async (page) => {
        await until(page, (s) => s.step >= 2);
        await page.getByLabel("Error to meet, millimetres").fill("20");
        await page.getByRole("button", { name: "Find" }).click();
        await page.getByText(/^Found .* ms per step/).waitFor({ timeout: 120000 });
        await page.getByLabel("Error to meet, millimetres").fill("0.0001");
        await page.getByRole("button", { name: "Find" }).click();
        await page.getByText(/^No setting of this scene meets/).waitFor({ timeout: 120000 });
    });
});

test("colours by strain have a legend with their unit", async () => {
    await withPage(browser, cloth(), {}, async (page) => {
        await until(page, (s) => s.step >= 2);
        await page.getByText("Appearance").click();
        await page.getByRole("radio", { name: "Strain" }).check();
        await page.getByRole("img", { name: /Legend: Strain of edges, %, from 0 to [0-9.]+/ }).waitFor();
        await page.getByRole("radio", { name: "Speed" }).check();
        await page.getByRole("img", { name: /Legend: Speed, m\/s, from 0 to [0-9.]+/ }).waitFor();
        // The scene computes neither, so the world is another one from here on.
        await until(page, (s) => /asks for/.test(s.hashes.excluded));
    });
});

test("a wrong scene is refused with the sentence of the engine, and another one can be opened", async () => {
    const data = pageData("cloth.yaml", { "cloth.yaml": CLOTH.replace("substeps", "substep") });
    await withPage(browser, data, {}, async (page) => {
        await page.getByRole("alert").getByText(/cloth\.yaml:4:1: .*substep/).first().waitFor();
        await page.locator("input[type=file]").setInputFiles({ name: "good.yaml", mimeType: "text/yaml", buffer: Buffer.from(CLOTH) });
        await until(page, (s) => s.step >= 2);
    });
});

test("without data the page asks for files, and says what it expects", async () => {
    await withPage(browser, null, {}, async (page) => {
        await page.getByRole("heading", { name: "Open a scene" }).waitFor();
        await page.locator("input[type=file]").setInputFiles({ name: "a.txt", mimeType: "text/plain", buffer: Buffer.from("?") });
        await page.getByText("Got a.txt, expected a scene").waitFor();
    });
});

test("a banner that tears is drawn with the triangles of its step, simulated and recorded, and again from its start", async () => {
    const text = readFileSync(new URL("../../data/scenes/tearing.yaml", import.meta.url), "utf8");
    const world = wisp.readScene("tearing.yaml", { "tearing.yaml": text }).createWorld(), banner = world.bodies[0];
    const start = Array.from(banner.triangles);
    const trianglesAt = (step) => {
        while (world.stepCount < step) world.step();
        return Array.from(world.triangles(banner));
    };
    const end = trianglesAt(45);
    assert.notDeepEqual(end, start);
    const drawn = (page) => page.evaluate(() => window.wispPage.triangles(0));
    await withPage(browser, pageData("tearing.yaml", { "tearing.yaml": text }), {}, async (page) => {
        await until(page, (s) => s.step >= 45);
        await pause(page);
        const paused = await until(page, (s) => s.step === s.requested && !s.isPlaying);
        await page.waitForTimeout(200);
        assert.deepEqual(await drawn(page), trianglesAt(paused.step));
        await page.locator("#canvas").focus();
        await page.keyboard.press("r");
        await until(page, (s) => s.step === 0);
        await page.waitForTimeout(200);
        assert.deepEqual(await drawn(page), start);
    });
    world.release();
    const folder = mkdtempSync(join(tmpdir(), "wisp-viewer-")), file = join(folder, "tearing.wisp");
    runProgram("run", "data/scenes/tearing.yaml", "--record", file);
    await withPage(browser, pageData("tearing.wisp", { "tearing.wisp": readFileSync(file) }), {}, async (page) => {
        await until(page, (s) => s.kind === "recording" && !s.isPlaying && s.step === 45);
        await page.waitForTimeout(200);
        assert.deepEqual(await drawn(page), end);
        await page.getByRole("slider", { name: "Frame of the recording" }).focus();
        await page.keyboard.press("Home");
        await until(page, (s) => s.step === 0);
        await page.waitForTimeout(200);
        assert.deepEqual(await drawn(page), start);
    });
    rmSync(folder, { recursive: true });
});

test("a recording plays, stops at its end, and its slider goes to any frame", async () => {
    const folder = mkdtempSync(join(tmpdir(), "wisp-"));
    try {
        const path = join(folder, "cloth.yaml"), file = join(folder, "cloth.wisp");
        writeFileSync(path, CLOTH);
        runProgram("run", path, "--steps", "40", "--record", file);
        const bytes = readFileSync(file), recording = wisp.openRecording(bytes);
        const place = (frame) => {
            recording.seek(frame);
            return Array.from(recording.points(recording.bodies[0]).subarray(3 * 84, 3 * 84 + 3));
        };
        await withPage(browser, pageData("cloth.wisp", { "cloth.wisp": bytes }), {}, async (page) => {
            await until(page, (s) => s.kind === "recording" && !s.isPlaying && s.step === recording.frameCount - 1);
            const slider = page.getByRole("slider", { name: "Frame of the recording" });
            await slider.focus();
            await page.keyboard.press("Home");
            await until(page, (s) => s.step === 0);
            for (let k = 0; k < 7; ++k) await page.keyboard.press("ArrowRight");
            await until(page, (s) => s.step === 7);
            await page.waitForTimeout(200);
            assert.deepEqual(await page.evaluate(() => window.wispPage.vertex(0, 84)), place(7));
            await page.getByRole("button", { name: "Play" }).click();
            await until(page, (s) => s.step > 9);
        });
        recording.release();
    } finally {
        rmSync(folder, { recursive: true });
    }
});

/** Curls on a small head, as a brush starts from them. */
const CURLS = `wisp: 1
steps: 1
strands:
  - name: curls
    generate: { shape: curly, dimension: 3, strands: 60, vertices: 16, scalp_radius: 0.1, seed: 7 }
    frozen_hair:
      seed: 7
      freeze: { stretch_stiffness: 12, bend_stiffness: 5 }
      align: { intensity: 0.6, reach: 0.08, reach_by: nearest }
      clump: { radius: 0.006, iterations: 3 }
    environment: { temperature_celsius: -6, wetness: 0.7 } # the page folds it into a stiffness
    compute: [points]
`;

async function brush(page, vertex, moves) {
    const [x, y] = await settledVertex(page, 0, vertex);
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let k = 1; k <= moves; ++k) {
        await page.mouse.move(x + 6 * k, y + 3 * k);
        await page.waitForTimeout(150);
    }
    await page.mouse.up();
    return until(page, (s) => s.step === s.requested && s.step > 0);
}

test("strokes of the brush undo, redo and save as a scene that the native program runs to the same bits", async () => {
    const folder = mkdtempSync(join(tmpdir(), "wisp-"));
    try {
        await withPage(browser, pageData("curls.yaml", { "curls.yaml": CURLS }), {}, async (page) => {
            await until(page, (s) => s.tool === "brush" && s.step === 1);
            await brush(page, 8, 3);
            const first = await page.evaluate(() => window.wispPage.hash());
            await page.getByLabel("Intensity x").focus();
            await page.keyboard.press("PageUp");
            await page.getByLabel("Temperature").focus();
            await page.keyboard.press("PageDown");
            await page.waitForTimeout(300);
            await brush(page, 16 * 30 + 8, 3);
            const second = await page.evaluate(() => window.wispPage.hash());
            assert.notEqual(second.hash, first.hash);
            await page.getByRole("button", { name: "Undo" }).click();
            await until(page, (s) => s.step === first.step);
            assert.deepEqual(await page.evaluate(() => window.wispPage.hash()), first);
            await page.getByRole("button", { name: "Redo" }).click();
            await until(page, (s) => s.step === second.step);
            assert.deepEqual(await page.evaluate(() => window.wispPage.hash()), second);
            await page.getByText(/^Last command: [0-9.]+ ms/).waitFor();

            const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save scene" }).click()]);
            const path = join(folder, download.suggestedFilename());
            await download.saveAs(path);
            assert.match(readFileSync(path, "utf8"), /hair_events:\n {2}- \{ step: 0, strands: curls, cursor: /);
            assert.equal(nativeHash(path), second.hash);
        });
    } finally {
        rmSync(folder, { recursive: true });
    }
});
