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
    /** @type {Map<number, Record<string, number>>} parameters of each body, as they are */
    #parameters = new Map();
    /** @type {object[]} entries of `hair_events` that led to the present state */
    events;

    /** @param {object} world @param {object[]} events that its scene has already */
    constructor(world, events) {
        this.#world = world;
        this.events = events;
        for (const body of world.bodies) if (body.isFrozenHair) this.#parameters.set(body.index, this.#read(body));
    }

    #read(body) {
        const values = this.#world.frozenHair(body);
        return Object.fromEntries(Object.keys(KEYS).map((key) => [key, values[key]]));
    }

    #state() {
        return { snapshot: this.#world.snapshot(), events: this.events.slice(), parameters: new Map(this.#parameters) };
    }

    #restore(state) {
        this.#world.restore(state.snapshot);
        this.events = state.events.slice();
        this.#parameters = new Map(state.parameters);
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
        const parameters = { ...this.#parameters.get(body.index) };
        let isChanged = false;
        for (const [key, sceneKey] of Object.entries(KEYS)) {
            const value = Math.fround(wanted[key] ?? parameters[key]);
            if (value === Math.fround(parameters[key])) continue;
            parameters[key] = event[sceneKey] = value;
            isChanged = true;
        }
        if (isChanged) this.#world.setFrozenHair(body, parameters);
        this.#world.commandFrozenHair(body, cursor);
        this.#parameters.set(body.index, parameters);
        this.events = this.events.filter((other) => other.step !== event.step || other.strands !== event.strands);
        this.events.push(event);
    }

    undo() {
        this.#move(this.#done, this.#undone);
    }

    redo() {
        this.#move(this.#undone, this.#done);
    }

    #move(from, to) {
        const state = from.pop();
        if (!state) return;
        to.push(this.#state());
        this.#restore(state);
    }

    state() {
        return { commands: this.events.length, canUndo: this.#done.length > 0, canRedo: this.#undone.length > 0 };
    }
}
