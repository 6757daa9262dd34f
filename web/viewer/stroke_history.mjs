/**
 * Commands to frozen hair, with undo and redo. A stroke is one press of the brush and may hold many commands, one per step. Undoing
 * restores the world as it was before the stroke: snapshots hold its random numbers too.
 *
 * Each command is kept as the entry of `hair_events` that repeats it, so that the list saves as a scene.
 */

/** Snapshots beyond this are dropped from the oldest: their strokes stay, but cannot be undone. */
const MAX_BYTES = 256 * 1024 * 1024;

/** Parameters of a command, by their names in the engine and in a scene. */
const KEYS = {
    intensity: "intensity", reach: "reach", stretchStiffness: "stretch_stiffness", bendStiffness: "bend_stiffness",
    clumpRadius: "clump_radius",
};

export class StrokeHistory {
    #world;
    #done = [];
    #undone = [];
    #isCombed = false;
    /** @type {object[]} entries of `hair_events` that led to the present state */
    events;

    /** @param {object} world @param {object[]} events that its scene has already */
    constructor(world, events) {
        this.#world = world;
        this.events = events;
    }

    #state() {
        return { snapshot: this.#world.snapshot(), events: this.events.slice(), isCombed: this.#isCombed };
    }

    #restore(state) {
        this.#world.restore(state.snapshot);
        this.events = state.events.slice();
        this.#isCombed = state.isCombed;
    }

    begin() {
        this.#undone.length = 0;
        this.#done.push(this.#state());
        let bytes = 0;
        for (let k = this.#done.length - 1; k >= 0; --k) {
            bytes += this.#done[k].snapshot.byteLength;
            if (bytes > MAX_BYTES && k < this.#done.length - 1) {
                this.#done.splice(0, k + 1);
                return;
            }
        }
    }

    /**
     * @param {object} body @param {number[]} place of the cursor, m
     * @param {Record<string, number>} wanted parameters; others stay
     */
    command(body, place, wanted) {
        // The engine computes in single precision: what is saved is what it got.
        const cursor = place.map(Math.fround), event = { step: this.#world.stepCount, strands: body.name, cursor };
        const parameters = this.#world.frozenHair(body);
        let isChanged = false;
        for (const [key, sceneKey] of Object.entries(KEYS)) {
            const value = Math.fround(wanted[key] ?? parameters[key]);
            if (value === parameters[key] || !this.#isUsed(key, parameters)) continue;
            parameters[key] = event[sceneKey] = value;
            isChanged = true;
        }
        if (isChanged) this.#world.setFrozenHair(body, parameters);
        this.#world.commandFrozenHair(body, cursor);
        // With the first command the scene's own events that are still to come are over.
        if (!this.#isCombed) this.events = this.events.filter((other) => other.step < event.step);
        this.#isCombed = true;
        // Of several commands before one step the last counts, with the parameters that the others have changed.
        const same = this.events.find((other) => other.step === event.step && other.strands === event.strands);
        this.events = this.events.filter((other) => other !== same);
        this.events.push({ ...same, ...event });
    }

    /** A parameter of a stage that the scene leaves out does nothing, and a scene refuses it. */
    #isUsed(key, parameters) {
        if (key === "reach" || key === "intensity") return parameters.aligns;
        return key === "clumpRadius" ? parameters.clumps : parameters.freezes;
    }

    undo() {
        this.#move(this.#done, this.#undone);
    }

    redo() {
        this.#move(this.#undone, this.#done);
    }

    #move(from, to) {
        const state = from.at(-1);
        if (!state) return;
        const now = this.#state();
        // Refused if the world has other values than then, such as colours by strain: both lists then stay as they are.
        this.#restore(state);
        from.pop();
        to.push(now);
    }

    state() {
        return { commands: this.events.length, canUndo: this.#done.length > 0, canRedo: this.#undone.length > 0 };
    }
}
