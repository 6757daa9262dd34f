/**
 * The worker: an instance of the engine and what the page asks of it. The page starts it once for the main world, once for the
 * reference and once for a search of settings; each has its own memory.
 *
 * Requests are `{ id, type, ... }`, answers `{ type: "answer", id, value }` or `{ type: "answer", id, error }`. Frames come on their
 * own as `{ type: "frame", frame }`, or `{ type: "failed", error }` when a step could not be made.
 */
import { loadWisp } from "wisp";
import { engineLog } from "./engine_log.mjs";
import { Simulation } from "./simulation.mjs";
import { combableScene, combedScene, hairEvents, hasEntry, isCombable } from "./hair_scene.mjs";
import { RecordingPlayer } from "./recording_player.mjs";

let wisp = null;
let scene = null;
let derived = null; // the scene with other settings, that the world was made of
let simulation = null;
let climateWorld = null; // of the scene itself, made when the editor asks for a climate
let player = null;
/** @type {MessagePort|null} to the reference, where this is the main world; to the main world, where this is the reference */
let peer = null;

function describeScene() {
    return { name: scene.name, dt: scene.dt, steps: scene.steps, gravity: scene.gravity, parameters: scene.parameters };
}

/** The scene as a brush starts from it: strokes add up, and a climate is the stiffness that it gives. */
function combable() {
    const world = scene.createWorld();
    let text = scene.text;
    for (const body of world.bodies) {
        if (!body.isFrozenHair || !hasEntry(text, body.name) || isCombable(text, body.name)) continue;
        const { freezes, temperature, wetness } = world.frozenHair(body);
        text = combableScene(text, body.name, { freezes, stiffness: world.climateStiffness(body, temperature, wetness) });
    }
    world.release();
    return scene.withText(text);
}

/**
 * Parameters of frozen hair per body, as a brush starts from them: those of the scene that it combs, which aligns and has a stiffness
 * in place of a climate.
 */
function frozenHair() {
    const bodies = simulation.bodies.filter((body) => body.isFrozenHair && hasEntry(derived.text, body.name));
    const isReady = (body) => isCombable(derived.text, body.name);
    if (bodies.every(isReady)) {
        return Object.fromEntries(bodies.map((body) => [body.index, { ...simulation.world.frozenHair(body), isCombable: true }]));
    }
    const combed = combable(), world = combed.createWorld();
    const frozen = bodies.map((body) => {
        const { temperature, wetness } = simulation.world.frozenHair(body);
        return [body.index, { ...world.frozenHair(body), temperature, wetness, isCombable: isReady(body) }];
    });
    world.release();
    combed.release();
    return Object.fromEntries(frozen);
}

function send(frame, transfer) {
    self.postMessage({ type: "frame", frame }, transfer);
}

function advance(count, inputs) {
    const { frame, transfer } = simulation.advance(count, inputs);
    if (peer) {
        const points = simulation.copyMoving();
        peer.postMessage({ count, inputs, points }, points.filter(Boolean).map((array) => array.buffer));
    }
    send(frame, transfer);
}

/** As the reference: make the same steps with the same inputs, and measure the distance to where the main world is. */
function follow({ count, inputs, points }) {
    const { frame, transfer } = simulation.advance(count, inputs);
    frame.distance = simulation.distanceTo(points);
    send(frame, transfer);
}

function guarded(work) {
    try {
        work();
    } catch (error) {
        self.postMessage({ type: "failed", error: error.message });
    }
}

const requests = {
    async load({ wasm }) {
        wisp = await loadWisp({ wasm, print: engineLog.print });
        return wisp.version;
    },

    openScene({ name, files }) {
        const next = wisp.readScene(name, files);
        scene?.release();
        climateWorld?.release();
        climateWorld = null;
        scene = next;
        return describeScene();
    },

    start({ parameters, strokes, reference, hashEvery, colourBy, port }) {
        const base = strokes ? combable() : scene;
        const next = parameters && Object.keys(parameters).length > 0 ? base.withParameters(parameters) : base;
        if (next !== base && base !== scene) base.release();
        const started = new Simulation(next, { reference, hashEvery, colourBy, hairEvents: hairEvents(next.text) });
        simulation?.release();
        if (derived && derived !== scene) derived.release();
        derived = next;
        simulation = started;
        // Messages of the former run that still wait must not reach this one.
        if (peer) peer.onmessage = null;
        peer?.close();
        peer = port ?? null;
        if (peer && reference) peer.onmessage = (event) => guarded(() => follow(event.data));
        return {
            frame: simulation.now().frame, bodies: simulation.bodies, memoryBytes: simulation.world.memoryBytes, frozen: frozenHair(),
        };
    },

    /** Stiffness that a climate gives hair, by the scene's own curve, which a combed scene no longer has. */
    climate({ body, temperature, wetness }) {
        climateWorld ??= scene.createWorld();
        return climateWorld.climateStiffness(climateWorld.bodies[body], temperature, wetness);
    },

    setColour({ colourBy }) {
        simulation.setColour(colourBy);
    },

    hash() {
        return { step: simulation.world.stepCount, hash: simulation.world.hash() };
    },

    /** The scene with the commands that were given, as text; `wisp run` makes the same state from it. */
    saveScene() {
        const step = simulation.world.stepCount;
        return { text: combedScene(simulation.scene.text, simulation.strokes.events, step), hash: simulation.world.hash(), step };
    },

    /** Blocks this worker, which is made for it. The page stops a search by ending the worker. */
    tune({ error, length, limit }) {
        return wisp.tune(scene, {
            error, length, limit,
            progress(runs, maxRuns) {
                self.postMessage({ type: "progress", runs, maxRuns });
                return true;
            },
        });
    },

    openRecording({ bytes }) {
        player = new RecordingPlayer(wisp.openRecording(bytes));
        return player.describe();
    },

    seek({ frame }) {
        const found = player.seek(frame);
        send(found.frame, found.transfer);
    },
};

self.onmessage = async ({ data }) => {
    if (data.type === "advance") {
        if (data.recycle) (simulation ?? player).pool.give(data.recycle);
        return guarded(() => advance(data.count, data.inputs));
    }
    if (data.type === "recycle") return (simulation ?? player)?.pool.give(data.arrays);
    try {
        const value = await requests[data.type](data);
        self.postMessage({ type: "answer", id: data.id, value });
    } catch (error) {
        self.postMessage({ type: "answer", id: data.id, error: error.message });
    }
};
