/**
 * A scene that runs: the main world in one worker and, if it is wanted, the reference in another. The session decides when steps are
 * asked for, gives both worlds the same inputs before the same steps, and keeps what is known about the run.
 */
import { Clock } from "./clock.mjs";
import { Engine } from "./engine.mjs";
import { FrameQueue } from "./frame_queue.mjs";
import { HashCheck } from "./hash_check.mjs";

/** The main world waits when the reference is this many requests behind. */
const MAX_LAG = 4;
/** Requests under way: one that is computed, one that waits, so that the worker never idles. */
const MAX_IN_FLIGHT = 2;
const MAX_STEPS_PER_REQUEST = 16;

export class Session {
    #main;
    #reference = null;
    #queue = new FrameQueue();
    /** @type {import("./simulation.mjs").Input[]} wait for the next request */
    #inputs = [];
    #requested = 0; // the step that the last request leads to
    #arrived = 0;
    /** @type {number[]} steps of each request under way */
    #flight = [];
    #isStarting = false;
    #lastStart = Promise.resolve();
    #followed = 0; // the step that the reference has reached
    #referenceInFlight = 0;
    /** @type {object[]} frames of the reference that are shown or will be */
    #referenceFrames = [];
    #interval = 1 / 60; // s between pictures, smoothed
    #lastTick = null;

    clock = new Clock();
    hasFailed = false;
    /** @type {object|null} as the engine describes it */
    scene = null;
    /** @type {object[]} */
    bodies = [];
    parameters = {};
    usesReference = false;
    /** Whether strokes of the brush add up, though the scene's own commands replace each other. */
    strokes = false;
    hashes = new HashCheck(null);
    colourBy = null;
    /** @type {object} parameters of frozen hair per body */
    frozen = {};
    memoryBytes = 0;
    version = "";
    /** @type {number|null} root mean square distance to the reference, m */
    distance = null;

    /**
     * @param {object} on
     * @param {(frame: object) => void} on.frame a frame of the main world has arrived
     * @param {(frame: object) => void} on.reference a frame of the reference has arrived
     * @param {() => void} on.change something of the state has changed
     * @param {(message: string) => void} on.failed
     */
    constructor(on) {
        this.on = on;
        this.#main = this.#engine((frame) => this.#mainFrame(frame));
    }

    #engine(onFrame) {
        return new Engine({ frame: onFrame, failed: (message) => this.#fail(message) });
    }

    #fail(message) {
        if (this.hasFailed) return;
        this.hasFailed = true;
        this.clock.pause();
        this.on.failed(message);
        this.on.change();
    }

    /** @param {string} name @param {Record<string, Uint8Array>} files @param {object|null} hashes of the native run */
    async open(name, files, hashes) {
        this.version = await this.#main.load();
        this.scene = await this.#main.ask("openScene", { name, files });
        this.files = files;
        this.name = name;
        this.hashes = new HashCheck(hashes);
        this.parameters = {};
    }

    /** Start from step 0. @param {{parameters?: object, usesReference?: boolean, strokes?: boolean}} [changes] */
    start(changes = {}) {
        // A change that comes while the scene starts waits until it has started, and then starts it again.
        const started = this.#lastStart.then(() => this.#startNow(changes));
        this.#lastStart = started.catch(() => {});
        return started;
    }

    async #startNow(changes) {
        this.#isStarting = true;
        try {
            const parameters = changes.parameters ?? this.parameters;
            const usesReference = changes.usesReference ?? this.usesReference;
            const strokes = changes.strokes ?? this.strokes;
            let ports = null;
            if (usesReference) {
                await this.#openReference();
                ports = new MessageChannel();
                const twin = await this.#reference.ask("start", { reference: true, strokes, port: ports.port2 }, [ports.port2]);
                this.#referenceFrames = [twin.frame];
            } else {
                this.#closeReference();
                this.#referenceFrames = [];
            }
            const run = await this.#main.ask("start", {
                parameters, strokes, hashEvery: this.hashes.every, colourBy: this.colourBy, port: ports?.port1,
            }, ports ? [ports.port1] : []);
            this.parameters = parameters;
            this.usesReference = usesReference;
            this.strokes = strokes;
            this.#begin(run);
        } catch (error) {
            // The reference may have started already: without the main world it has nobody to follow.
            this.#closeReference();
            this.usesReference = false;
            throw error;
        } finally {
            this.#isStarting = false;
        }
        this.on.change();
    }

    async #openReference() {
        if (this.#reference) return;
        const engine = this.#engine((frame) => this.#referenceFrame(frame));
        try {
            await engine.load();
            await engine.ask("openScene", { name: this.name, files: this.files });
        } catch (error) {
            engine.stop();
            throw error;
        }
        this.#reference = engine;
    }

    #closeReference() {
        this.#reference?.stop();
        this.#reference = null;
    }

    #begin(run) {
        this.bodies = run.bodies;
        this.memoryBytes = run.memoryBytes;
        this.frozen = run.frozen;
        this.hasFailed = false;
        this.distance = null;
        this.#queue.clear();
        this.#inputs.length = 0;
        this.#requested = this.#arrived = this.#followed = run.frame.step;
        this.#flight.length = 0;
        this.#referenceInFlight = 0;
        this.#queue.push(run.frame);
        this.clock.reset(run.frame.time);
        this.hashes.restart();
        const changed = Object.keys(this.parameters).filter((name) => this.parameters[name] !== this.ownValue(name));
        if (this.strokes) this.hashes.exclude("strokes of the brush add up here");
        if (changed.length > 0) this.hashes.exclude("the settings differ from those of the scene");
        this.on.frame({ ...run.frame, isFirst: true });
    }

    /** @param {string} name of a parameter @returns {number} its value in the scene */
    ownValue(name) {
        return this.scene.parameters.find((parameter) => parameter.name === name)?.value;
    }

    /** What a user did, for both worlds. @param {import("./simulation.mjs").Input} input */
    input(input) {
        // Only the last place of a drag before a step counts.
        if (input.type === "drag" || input.type === "moveCollider") {
            const same = this.#inputs.slice().reverse().find((other) => other.body === input.body && other.vertex === input.vertex);
            if (same?.type === input.type) {
                same.value = input.value;
                return;
            }
        }
        this.#inputs.push(input);
        this.hashes.exclude("you changed the scene while it ran");
    }

    #request(count) {
        const inputs = this.#inputs;
        this.#inputs = [];
        this.#requested += count;
        this.#flight.push(count);
        if (this.#reference) ++this.#referenceInFlight;
        this.#main.advance(count, inputs, this.#queue.takeSpent());
    }

    /** One step, and stay there. */
    step() {
        if (this.hasFailed || this.#isStarting) return;
        this.pause();
        this.#request(1);
    }

    /** Inputs take effect now, with a number of steps, even while time stands still. */
    applyNow(count) {
        if (!this.hasFailed && !this.#isStarting) this.#request(count);
    }

    get isBusy() {
        return this.#flight.length > 0;
    }

    play() {
        if (!this.hasFailed) this.clock.play();
        this.on.change();
    }

    pause() {
        this.clock.pause();
        this.on.change();
    }

    #mainFrame(frame) {
        if (this.#isStarting) return;
        this.#flight.shift();
        this.#arrived = frame.step;
        this.#requested = frame.step + this.#flight.reduce((sum, steps) => sum + steps, 0);
        if (frame.requested) this.hashes.exclude(`the page asks for ${frame.requested}, which the scene does not compute`);
        // An undone stroke leads back to an earlier step.
        if (this.#queue.last && frame.step <= this.#queue.last.step) {
            this.#queue.clear();
            this.clock.reset(frame.time);
        }
        this.#queue.push(frame);
        for (const [step, hash] of frame.hashes) this.hashes.add(step, hash);
        this.on.frame(frame);
    }

    #referenceFrame(frame) {
        if (this.#isStarting) return;
        --this.#referenceInFlight;
        this.#followed = frame.step;
        this.distance = frame.distance;
        if (frame.step <= (this.#referenceFrames.at(-1)?.step ?? -1)) this.#referenceFrames = [];
        this.#referenceFrames.push(frame);
        this.on.reference(frame);
    }

    /**
     * Called for each picture.
     * @param {number} now ms
     * @returns {{from: object, to: object, mix: number, reference: {from: object, to: object}|null}|null} what to draw
     */
    tick(now) {
        if (!this.scene || this.#isStarting) return null;
        this.#measureInterval(now);
        // With a reference both worlds are shown at the same step: that of the slower one.
        const maxStep = this.#reference ? this.#followed : Infinity;
        const limit = this.#queue.limit(maxStep);
        if (this.clock.isPlaying) this.#requestDue();
        this.clock.tick(now, limit);
        if (!this.clock.isPlaying) this.clock.shown = limit;
        const pair = this.#queue.around(this.clock.shown, maxStep);
        if (!pair) return null;
        const [from, to] = pair;
        const span = to.time - from.time;
        const mix = span > 0 ? Math.min(1, Math.max(0, (this.clock.shown - from.time) / span)) : 1;
        return { from, to, mix, reference: this.#referenceAt(from.step, to.step) };
    }

    /** The frames of the reference at the same steps; earlier ones are given back. */
    #referenceAt(fromStep, toStep) {
        if (!this.#reference) return null;
        const frames = this.#referenceFrames;
        while (frames.length > 1 && frames[0].step < fromStep) this.#reference.recycle(frames.shift().points);
        const from = frames.find((frame) => frame.step === fromStep), to = frames.find((frame) => frame.step === toStep);
        return from && to ? { from, to } : null;
    }

    #measureInterval(now) {
        if (this.#lastTick !== null) {
            const interval = Math.min(0.1, (now - this.#lastTick) / 1000);
            this.#interval += 0.05 * (interval - this.#interval);
        }
        this.#lastTick = now;
    }

    #requestDue() {
        // Several short steps between two pictures travel as one frame.
        const perPicture = this.clock.speed * this.#interval / this.scene.dt;
        const count = Math.min(MAX_STEPS_PER_REQUEST, Math.max(1, Math.floor(perPicture + 0.25)));
        const ahead = (this.clock.shown + 2 * count * this.scene.dt) / this.scene.dt;
        while (this.#flight.length < MAX_IN_FLIGHT && this.#requested < ahead && this.#referenceInFlight < MAX_LAG) {
            this.#request(count);
        }
    }

    /** @param {"strain"|"speed"|null} colourBy */
    setColour(colourBy) {
        this.colourBy = colourBy;
        this.#main.ask("setColour", { colourBy });
        if (!this.clock.isPlaying) this.applyNow(0);
    }

    /** @returns {Promise<number>} the stiffness that a climate gives hair */
    climate(body, temperature, wetness) {
        return this.#main.ask("climate", { body, temperature, wetness });
    }

    /** @returns {Promise<{step: number, hash: string}>} */
    hash() {
        return this.#main.ask("hash");
    }

    /** Whether strokes of the brush add up: the scene says so, or was started as one that does. */
    get canComb() {
        return Object.values(this.frozen).every((hair) => hair.isCombable);
    }

    /** @returns {Promise<{text: string, hash: string, step: number}>} the scene with the strokes that were made */
    saveScene() {
        return this.#main.ask("saveScene");
    }

    get state() {
        return {
            step: this.#arrived, requested: this.#requested, followed: this.#reference ? this.#followed : null,
            time: this.clock.shown, isPlaying: this.clock.isPlaying, hasFailed: this.hasFailed,
        };
    }

    close() {
        this.#main.stop();
        this.#closeReference();
    }
}
