/**
 * One world in a worker: it takes inputs, makes steps, and packs what the page draws. The main world and the reference run this
 * same code with the same inputs before the same steps, so that only their settings differ.
 *
 * @typedef {object} Input what a user did; it takes effect at the next step
 * @property {"grab"|"drag"|"letGo"|"grabCollider"|"moveCollider"|"gravity"|"wind"|"stroke"|"command"|"undo"|"redo"} type
 * @property {number} [body]
 * @property {number} [vertex]
 * @property {number[]} [value] m, m/s or m/s^2; of a collider, how far it was moved since it was grabbed
 * @property {Record<string, number>} [values] parameters of frozen hair
 *
 * @typedef {object} Frame
 * @property {number} step
 * @property {number} time s
 * @property {(Float32Array|null)[]} points per body, padded to rows of a texture; null for hidden ones
 * @property {(Int32Array|null)[]|null} triangles of bodies that tear; null if none does
 * @property {(Float32Array|null)[]} values strain or speed per body
 * @property {{width: Float32Array|null, colour: Float32Array|null}[]|null} looks widths and colours, when they may have changed
 * @property {number} stepMs mean of the steps of this frame
 * @property {{pass: string, seconds: number}[]} profile of the last step
 * @property {string|null} requested a value that the page needs and the scene does not compute
 * @property {number[]} refused bodies that cannot be held
 * @property {string[]} log what the engine has to say, a sentence each
 * @property {string|null} notice an input that could not be taken, and why
 * @property {[number, string][]} hashes of steps that the page compares
 */
import { BufferPool, paddedLength } from "./buffer_pool.mjs";
import { engineLog } from "./engine_log.mjs";
import { StrokeHistory } from "./stroke_history.mjs";
import { trianglesOf } from "./surface_topology.mjs";

const NO_PROFILE = [];

/** Bodies as plain data, which a message can carry: views of the engine's memory are copied. */
function describeBody(body) {
    return {
        ...body,
        triangles: body.triangles ? Int32Array.from(body.triangles) : null,
        offsets: body.offsets ? Int32Array.from(body.offsets) : null,
    };
}

export class Simulation {
    /**
     * @param {object} scene of wisp.mjs
     * @param {{reference?: boolean, hashEvery?: number, colourBy?: string|null, hairEvents?: object[]}} settings
     */
    constructor(scene, settings) {
        this.scene = scene;
        this.world = scene.createWorld({ reference: settings.reference === true });
        this.hashEvery = settings.hashEvery ?? 0;
        this.pool = new BufferPool();
        this.bodies = this.world.bodies.map(describeBody);
        this.strokes = new StrokeHistory(this.world, settings.hairEvents ?? []);
        this.colourBy = settings.colourBy ?? null;
        this.looksChanged = true;
        /** @type {Set<number>} bodies that cannot be held, such as those that keyframes move */
        this.refused = new Set();
        /** @type {Set<string>} values that the page asked for */
        this.requested = new Set();
    }

    release() {
        this.world.release();
    }

    /** @param {"strain"|"speed"|null} what the values to send, from the next step on */
    setColour(what) {
        this.colourBy = what;
    }

    /** A value of a body, if the world computes it. It is there after a step. */
    #read(body, what) {
        const isThere = body.computes[what] || this.requested.has(`${body.index} ${what}`);
        return this.world.stepCount > 0 && !body.hidden && isThere ? this.world[what](body) : null;
    }

    /**
     * Ask for the values that colour the picture, where the scene does not compute them.
     * @returns {string|null} what was asked for: it makes the hash another one than that of the scene
     */
    #requestColour() {
        const what = this.colourBy;
        if (!what) return null;
        let isNew = false;
        for (const body of this.bodies) {
            const key = `${body.index} ${what}`;
            if (body.hidden || !body.has[what] || body.computes[what] || this.requested.has(key)) continue;
            this.world.request(body, what);
            this.requested.add(key);
            isNew = true;
        }
        return isNew ? what : null;
    }

    #vertex(body, vertex) {
        return Array.from(this.world.points(body).slice(3 * vertex, 3 * vertex + 3));
    }

    /** @param {Input} input */
    #apply(input) {
        const world = this.world, body = this.bodies[input.body];
        switch (input.type) {
            case "grab":
                world.grab(body, input.vertex);
                // Strands come along with their head: by how far the hand has moved, wherever the vertex is in this world.
                this.grip = body.kind === "strands" ? this.#vertex(body, input.vertex).map((x, k) => x - input.value[k]) : [0, 0, 0];
                return undefined;
            case "drag": return world.drag(body, input.vertex, input.value.map((x, k) => x + this.grip[k]));
            case "letGo": return world.letGo(body, input.vertex);
            case "grabCollider":
                this.grabbedPlace = world.colliderPlace(body);
                return undefined;
            case "moveCollider":
                return world.moveCollider(body, this.grabbedPlace.map((x, k) => x + input.value[k]));
            case "gravity": return world.setGravity(input.value);
            case "wind": return world.setWind(input.value);
            case "stroke": return this.strokes.begin();
            case "command":
                this.looksChanged = true;
                return this.strokes.command(body, input.value, input.values);
            case "undo":
                this.looksChanged = true;
                return this.strokes.undo();
            case "redo":
                this.looksChanged = true;
                return this.strokes.redo();
            default: throw new Error(`Unknown input ${input.type}.`);
        }
    }

    /**
     * Apply inputs and make steps.
     * @param {number} count steps; 0 only applies the inputs
     * @param {Input[]} inputs
     * @returns {{frame: Frame, transfer: ArrayBuffer[]}}
     */
    advance(count, inputs) {
        const hashes = [];
        let notice = null;
        const requested = count > 0 ? this.#requestColour() : null;
        for (const input of inputs) {
            if (this.refused.has(input.body)) continue;
            // What cannot be done leaves the world as it was; the page says why and goes on.
            try {
                if (this.#apply(input) === false) notice = `Nothing in this scene feels ${input.type}.`;
            } catch (error) {
                notice = error.message;
                if (/grab|drag|moveCollider/i.test(input.type)) this.refused.add(input.body);
            }
        }
        const start = performance.now();
        for (let k = 0; k < count; ++k) {
            this.world.step();
            const step = this.world.stepCount;
            if (this.hashEvery > 0 && step % this.hashEvery === 0) hashes.push([step, this.world.hash()]);
        }
        const stepMs = count > 0 ? (performance.now() - start) / count : 0;
        return this.#pack(stepMs, hashes, count > 0, { notice, requested });
    }

    /** The state as it is. @returns {{frame: Frame, transfer: ArrayBuffer[]}} */
    now() {
        return this.#pack(0, [], false, { notice: null, requested: null });
    }

    #copy(view, count, channels) {
        const array = this.pool.take(paddedLength(count, channels));
        array.set(view);
        return array;
    }

    #values(body) {
        const values = this.colourBy ? this.#read(body, this.colourBy) : null;
        return values && this.#copy(values, body.vertexCount, 1);
    }

    #looks(body) {
        const width = this.#read(body, "width"), colour = this.#read(body, "colour");
        return {
            width: width && this.#copy(width, body.vertexCount, 1),
            colour: colour && this.#copy(colour, body.vertexCount, 3),
        };
    }

    #pack(stepMs, hashes, hasStepped, news) {
        const world = this.world;
        const points = this.bodies.map((body) => (body.hidden ? null : this.#copy(world.points(body), body.vertexCount, 3)));
        const values = this.bodies.map((body) => this.#values(body));
        let looks = null;
        // Appearance is derived by a step, so that it is there after the first one.
        if (this.looksChanged && world.stepCount > 0) {
            looks = this.bodies.map((body) => this.#looks(body));
            this.looksChanged = false;
        }
        let largest = 0;
        values.forEach((array, b) => {
            if (!array) return;
            const count = this.bodies[b].vertexCount;
            for (let i = 0; i < count; ++i) if (Math.abs(array[i]) > largest) largest = Math.abs(array[i]);
        });
        const frame = {
            step: world.stepCount, time: world.time, points, triangles: trianglesOf(world, this.bodies), values, looks, stepMs, hashes, largest, ...news, refused: [...this.refused], log: engineLog.take(),
            profile: hasStepped ? world.profile() : NO_PROFILE,
            counters: hasStepped ? world.counters() : null,
            strokes: this.strokes.state(),
        };
        const lookArrays = looks ? looks.flatMap((look) => [look.width, look.colour]) : [];
        const transfer = [...points, ...values, ...lookArrays].filter(Boolean).map((array) => array.buffer);
        return { frame, transfer };
    }

    /** Copies of the points of all bodies that move, for the reference to measure its distance from. */
    copyMoving() {
        return this.bodies.map((body) => (body.moves && !body.hidden ? Float32Array.from(this.world.points(body)) : null));
    }

    /**
     * @param {(Float32Array|null)[]} others points of another world of the same scene
     * @returns {number} root mean square distance over all vertices that move, m
     */
    distanceTo(others) {
        let sum = 0, count = 0;
        for (const body of this.bodies) {
            const other = others[body.index];
            if (!other || other.length !== 3 * body.vertexCount) continue;
            const mine = this.world.points(body);
            for (let i = 0; i < other.length; ++i) {
                const d = mine[i] - other[i];
                sum += d * d;
            }
            count += body.vertexCount;
        }
        return count > 0 ? Math.sqrt(sum / count) : 0;
    }
}
