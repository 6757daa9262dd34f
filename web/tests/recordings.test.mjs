/** Recordings of `wisp run` in readers that others wrote: Khronos' glTF validator, three.js, TinyUSDZ. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { AnimationMixer, Mesh, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { USDAParser } from "three/addons/loaders/usd/USDAParser.js";

const require = createRequire(import.meta.url);
const { validateBytes } = require("gltf-validator");
const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const STEPS = 12;
/** Strands with widths and colours and a balloon; a flag and a static mast; cloth on a table that has keyframes. */
const SCENES = ["hair_on_balloon", "flag", "moving_floor_cloth"];

let folder;
const recordings = {};

function record(scene, file, ...options) {
    const path = join(folder, file);
    execFileSync(join(root, "build/app/wisp"), ["run", join(root, "data/scenes", `${scene}.yaml`), "--steps", String(STEPS),
        "--record", path, ...options], { stdio: ["ignore", "ignore", "pipe"] });
    return path;
}

/** A .wisp file: what every other format is compared with. */
function readWisp(path) {
    const bytes = readFileSync(path);
    const headerBytes = Number(bytes.readBigUInt64LE(16)), frameBytes = Number(bytes.readBigUInt64LE(24));
    const bodies = [];
    let at = 40;
    for (let b = 0; b < bytes.readUInt32LE(12); ++b) {
        const [kind, letters, vertices, elements] = [0, 4, 8, 12].map((k) => bytes.readUInt32LE(at + k));
        const name = bytes.toString("utf8", at + 16, at + 16 + letters);
        at += 16 + 4 * Math.ceil(letters / 4);
        const count = kind === 1 ? elements + 1 : 3 * elements;
        const numbers = Array.from({ length: count }, (_, i) => bytes.readInt32LE(at + 4 * i));
        at += 4 * count;
        bodies.push({ name, isStrands: kind === 1, vertices, numbers, frames: [] });
    }
    const times = [];
    for (let start = headerBytes; start + frameBytes <= bytes.length; start += frameBytes) {
        times.push(bytes.readDoubleLE(start + 24));
        let from = start + 40;
        for (const body of bodies) {
            body.frames.push(Float32Array.from({ length: 3 * body.vertices }, (_, i) => bytes.readFloatLE(from + 4 * i)));
            from += 12 * body.vertices;
        }
    }
    return { bodies, times };
}

before(() => {
    folder = mkdtempSync(join(tmpdir(), "wisp-recordings-"));
    for (const scene of SCENES) recordings[scene] = readWisp(record(scene, `${scene}.wisp`));
});
after(() => rmSync(folder, { recursive: true }));

// ---- glTF ----

const loadGltf = (path) => {
    const { buffer, byteOffset, byteLength } = readFileSync(path);
    return new GLTFLoader().parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), "");
};

for (const scene of SCENES) {
    test(`${scene}: the glTF validator of Khronos has nothing to say`, async () => {
        const report = await validateBytes(new Uint8Array(readFileSync(record(scene, `${scene}.glb`))));
        assert.deepEqual(report.issues.messages, []);
        assert.equal(report.info.animationCount, 1);
        assert.equal(report.info.totalVertexCount, recordings[scene].bodies.reduce((sum, body) => sum + body.vertices, 0));
    });

    test(`${scene}: three.js shows the points of the recording at the times of its frames`, async () => {
        const gltf = await loadGltf(record(scene, `${scene}.glb`));
        const mixer = new AnimationMixer(gltf.scene);
        assert.equal(gltf.animations.length, 1);
        mixer.clipAction(gltf.animations[0]).play();
        const { bodies, times } = recordings[scene];
        assert.equal(times.length, STEPS + 1);
        for (const frame of [0, 1, STEPS / 2, STEPS - 1]) {
            mixer.setTime(times[frame]);
            for (const body of bodies) {
                const object = gltf.scene.getObjectByName(body.name);
                assert.equal(object.isLineSegments === true, body.isStrands);
                assert.equal(object.geometry.getAttribute("position").count, body.vertices);
                const point = new Vector3();
                for (let v = 0; v < body.vertices; ++v) {
                    Mesh.prototype.getVertexPosition.call(object, v, point); // lines lack it, and have all that it needs
                    for (let k = 0; k < 3; ++k) {
                        // times and weights are single precision: 1e-6 of the way to the next frame, a few cm at most
                        const error = Math.abs(point.getComponent(k) - body.frames[frame][3 * v + k]);
                        assert.ok(error < 1e-6, `${body.name}, frame ${frame}, vertex ${v}: ${error} m off`);
                    }
                }
            }
        }
    });
}

test("a body that stands still has no morph targets, and strands have colours", async () => {
    const flag = await loadGltf(record("flag", "flag.glb"));
    assert.equal(flag.scene.getObjectByName("mast").morphTargetInfluences, undefined);
    assert.equal(flag.scene.getObjectByName("flag").morphTargetInfluences.length, STEPS);
    assert.equal(flag.scene.getObjectByName("flag").geometry.morphAttributes.normal.length, STEPS);
    const curtain = (await loadGltf(record("hair_on_balloon", "curtain.glb"))).scene.getObjectByName("curtain");
    const colour = curtain.geometry.getAttribute("color");
    // tip_colour of the scene
    [0.3, 0.18, 0.1].forEach((c, k) => assert.ok(Math.abs(colour.getComponent(20, k) - c) < 1e-6));
});

// ---- USD ----

/** TinyUSDZ knows browsers and workers alone, so node has to look like one while it starts. */
async function startTinyUsd() {
    process.type = "renderer";
    globalThis.WorkerGlobalScope = Object;
    globalThis.self = { location: { href: "file:///" } };
    const { default: init } = await import("tinyusdz");
    const module = await init({ wasmBinary: readFileSync(require.resolve("tinyusdz/tinyusdz.wasm")) });
    delete process.type;
    delete globalThis.WorkerGlobalScope;
    delete globalThis.self;
    return module;
}
const tinyUsd = startTinyUsd();

async function loadUsd(text) {
    const loader = new (await tinyUsd).TinyUSDZLoaderNative();
    assert.ok(loader.loadFromBinary(new TextEncoder().encode(text), "recording.usda"), loader.error());
    return loader;
}

/** What TinyUSDZ has understood of a file, as the text that it writes itself. */
async function understood(text) {
    const loader = new (await tinyUsd).TinyUSDZLoaderNative();
    assert.ok(loader.loadAsLayerFromBinary(new TextEncoder().encode(text), "recording.usda"), loader.error());
    // Names with a colon and metadata in several lines confuse three.js: the metadata of such attributes go into one line.
    return loader.layerToString().replaceAll(/^( *[\w[\]]+ [\w:]+) \(\n *(interpolation = "\w+")\n *\)/gm, "$1 ($2)");
}

const usdName = (name) => name.replaceAll("-", "_");
const attribute = (layer, body, name) => layer.specsByPath[`/Recording/${usdName(body.name)}.${name}`]?.fields;

test("TinyUSDZ refuses what is no USD, so that its silence means something", async () => {
    const loader = new (await tinyUsd).TinyUSDZLoaderNative();
    const text = '#usda 1.0\ndef Mesh "m"\n{\n    float[] points = [1]\n}\n';
    assert.equal(loader.loadFromBinary(new TextEncoder().encode(text), "bad.usda"), false);
});

for (const scene of SCENES) {
    test(`${scene}: TinyUSDZ and three.js read every point of every frame from USD`, async () => {
        const text = readFileSync(record(scene, `${scene}.usda`, "--record-with", "strain,speed"), "utf8");
        const { bodies } = recordings[scene];
        const meshes = (await loadUsd(text)).numMeshes();
        assert.equal(meshes, bodies.filter((body) => !body.isStrands).length);
        // the text as written here, and as TinyUSDZ writes it after its own reader
        for (const layer of [text, await understood(text)].map((t) => new USDAParser().parseData(t))) {
            for (const body of bodies) {
                const points = attribute(layer, body, "points");
                const { times, values } = points.timeSamples ?? { times: [0], values: [points.default] };
                assert.equal(times.length, body.name === "mast" ? 1 : STEPS + 1);
                times.forEach((code, frame) => {
                    assert.equal(code, frame);
                    assert.deepEqual(Float32Array.from(values[frame].flat()), body.frames[frame], `${body.name}, frame ${frame}`);
                });
            }
        }
    });
}

test("the stage has a rate, a range, units and a default prim, and prims have normals, velocities, colours and widths", async () => {
    const text = await understood(readFileSync(record("hair_on_balloon", "stage.usda", "--record-with", "strain,speed"), "utf8"));
    for (const line of ["timeCodesPerSecond = 60", "framesPerSecond = 60", "startTimeCode = 0", `endTimeCode = ${STEPS}`,
        "metersPerUnit = 1", 'upAxis = "Y"', 'defaultPrim = "Recording"']) {
        assert.ok(text.includes(`    ${line}\n`), line);
    }
    const layer = new USDAParser().parseData(text);
    const [curtain, balloon] = recordings.hair_on_balloon.bodies;
    const widths = attribute(layer, curtain, "widths").default;
    assert.equal(widths.length, curtain.vertices);
    assert.ok(Math.abs(widths[0] - 2e-3) < 1e-9 && Math.abs(widths[20] - 1e-3) < 1e-9);
    assert.equal(attribute(layer, curtain, "primvars:displayColor").default.length, 3 * curtain.vertices);
    assert.equal(attribute(layer, balloon, "doubleSided").default, "1");
    assert.match(attribute(layer, balloon, "subdivisionScheme").default, /none/);
    for (const [body, names] of [[curtain, ["extent", "velocities", "primvars:strain", "primvars:speed"]],
        [balloon, ["extent", "normals", "velocities", "primvars:strain", "primvars:speed"]]]) {
        for (const name of names) assert.equal(attribute(layer, body, name).timeSamples.times.length, STEPS + 1, name);
    }
});

test("USD's velocities carry the points of a frame to those of the next", async () => {
    const text = await understood(readFileSync(record("hair_on_balloon", "moving.usda"), "utf8"));
    const layer = new USDAParser().parseData(text);
    const { bodies: [, balloon], times } = recordings.hair_on_balloon;
    const velocities = attribute(layer, balloon, "velocities").timeSamples.values.map((frame) => frame.flat());
    const frame = STEPS / 2, step = times[frame + 1] - times[frame - 1];
    for (let i = 0; i < 3 * balloon.vertices; ++i) {
        const expected = (balloon.frames[frame + 1][i] - balloon.frames[frame - 1][i]) / step;
        assert.ok(Math.abs(velocities[frame][i] - expected) < 1e-5);
    }
});

test("normals of a balloon have length one and point out of it", async () => {
    const layer = new USDAParser().parseData(readFileSync(record("hair_on_balloon", "normals.usda"), "utf8"));
    const { bodies: [, balloon] } = recordings.hair_on_balloon;
    const normals = attribute(layer, balloon, "normals").timeSamples.values[STEPS].flat(), points = balloon.frames[STEPS];
    const centre = [0, 1, 2].map((k) => points.reduce((sum, x, i) => sum + (i % 3 === k ? x : 0), 0) / balloon.vertices);
    for (let v = 0; v < balloon.vertices; ++v) {
        const n = normals.slice(3 * v, 3 * v + 3);
        assert.ok(Math.abs(Math.hypot(...n) - 1) < 1e-6);
        assert.ok(n.reduce((sum, x, k) => sum + x * (points[3 * v + k] - centre[k]), 0) > 0);
    }
});
