/** What the page draws, without a browser: the colours of pictures, and less where the graphics are slow. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { HAIR, colourOf } from "../viewer/body_colours.mjs";
globalThis.devicePixelRatio = 1;
const { PixelRatio, spreadOrder } = await import("../viewer/pixel_ratio.mjs");

const numbersOf = (text) => [...text.matchAll(/\{ ([\d.f, ]+) \}/g)].map((m) => m[1].split(",").map(parseFloat));

test("bodies have the colours of app/io/palette.c", () => {
    const [table, hair, solid] = readFileSync(new URL("../../app/io/palette.c", import.meta.url), "utf8").split(/palette_hair|palette_solid/);
    const palette = numbersOf(table);
    assert.equal(palette.length, 8);
    assert.deepEqual(HAIR, numbersOf(hair)[0]);
    assert.deepEqual(colourOf({ kind: "collider" }, 3), numbersOf(solid)[0]);
    assert.deepEqual([0, 1, 4].map((n) => colourOf({ kind: "balloon" }, n)), [0, 2, 1].map((n) => palette[n]));
    assert.deepEqual([0, 1, 4].map((n) => colourOf({ kind: "cloth" }, n)), [1, 3, 2].map((n) => palette[n]));
});

test("pictures of a second each lead to fewer pixels, then to fewer strands, within ten of them", () => {
    const pixels = new PixelRatio();
    let pictures = 0;
    while (pixels.strands > 1 / 16 && pictures < 100) pixels.picture(1000), ++pictures;
    assert.ok(pictures <= 10);
    assert.equal(pixels.ratio, 0.75);
});

test("fast pictures and pauses change nothing", () => {
    const pixels = new PixelRatio();
    for (let i = 0; i < 500; ++i) assert.equal(pixels.picture(i % 10 === 0 ? 60000 : 16), false);
    assert.equal(pixels.strands, 1);
});

test("a part of the strands is spread over all of them, and all are all", () => {
    const order = spreadOrder(9000);
    assert.deepEqual([...order].sort((a, b) => a - b), Array.from({ length: 9000 }, (_, i) => i));
    for (const part of [16, 4]) {
        const first = order.slice(0, Math.ceil(9000 / part)).sort((a, b) => a - b);
        assert.ok(first.every((s, i) => i === 0 || s - first[i - 1] <= part));
    }
});
