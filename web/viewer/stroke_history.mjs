/**
 * Commands to frozen hair, with undo and redo. A stroke is one press of the brush and may hold many commands. Undoing restores the
 * world as it was before the stroke, by a snapshot, because an update draws new random numbers and cannot be computed backwards.
 */

/** Snapshots older than this are dropped: their strokes stay, but cannot be undone. */
const MAX_BYTES = 256 * 1024 * 1024;

export class StrokeHistory {
    #world;
    /** @type {{before: Uint8Array, after: Uint8Array|null, commands: object[], commandsAfter: object[]}[]} */
    #done = [];
    #undone = [];
    /** @type {object[]} every command that led to the present state, as the engine describes it */
    commands = [];

    constructor(world) {
        this.#world = world;
    }

    setParameters(body, values) {
        this.#world.setFrozenHair(body, values);
    }

    begin() {
        this.#undone.length = 0;
        this.#done.push({ before: this.#world.snapshot(), after: null, commands: this.commands.slice(), commandsAfter: [] });
        let bytes = 0;
        for (let k = this.#done.length - 1; k >= 0; --k) {
            bytes += this.#done[k].before.byteLength;
            if (bytes > MAX_BYTES && k < this.#done.length - 1) {
                this.#done.splice(0, k + 1);
                break;
            }
        }
    }

    command(body, cursor) {
        this.#world.commandFrozenHair(body, cursor);
        this.commands.push(this.#world.frozenCommands.at(-1));
    }

    undo() {
        const stroke = this.#done.pop();
        if (!stroke) return;
        stroke.after = this.#world.snapshot();
        stroke.commandsAfter = this.commands;
        this.#world.restore(stroke.before);
        this.commands = stroke.commands.slice();
        this.#undone.push(stroke);
    }

    redo() {
        const stroke = this.#undone.pop();
        if (!stroke) return;
        this.#world.restore(stroke.after);
        this.commands = stroke.commandsAfter.slice();
        this.#done.push(stroke);
    }

    state() {
        return { commands: this.commands.length, canUndo: this.#done.length > 0, canRedo: this.#undone.length > 0 };
    }
}
