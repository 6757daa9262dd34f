/**
 * The page's end of a worker. `data.mjs` has the engine's bytes and the worker's text, both inside the page, so that it runs from a
 * file without a server.
 */
import { engineBytes, workerText } from "./data.mjs";

let workerUrl = null;

export class Engine {
    #worker;
    #nextId = 1;
    /** @type {Map<number, {resolve: Function, reject: Function}>} */
    #waiting = new Map();

    /**
     * @param {object} on
     * @param {(frame: import("./simulation.mjs").Frame) => void} [on.frame]
     * @param {(message: string) => void} [on.failed] a step could not be made
     * @param {(runs: number, maxRuns: number) => void} [on.progress]
     */
    constructor(on) {
        workerUrl ??= URL.createObjectURL(new Blob([workerText()], { type: "text/javascript" }));
        this.#worker = new Worker(workerUrl);
        this.#worker.onmessage = ({ data }) => {
            if (data.type === "frame") on.frame?.(data.frame);
            else if (data.type === "failed") on.failed?.(data.error);
            else if (data.type === "progress") on.progress?.(data.runs, data.maxRuns);
            else this.#answer(data);
        };
        this.#worker.onerror = (event) => {
            event.preventDefault();
            const message = `The engine stopped: ${event.message || "its worker could not start"}.`;
            for (const { reject } of this.#waiting.values()) reject(new Error(message));
            this.#waiting.clear();
            on.failed?.(message);
        };
    }

    #answer({ id, value, error }) {
        const waiting = this.#waiting.get(id);
        this.#waiting.delete(id);
        if (error !== undefined) waiting?.reject(new Error(error));
        else waiting?.resolve(value);
    }

    /** @returns {Promise<string>} the version of the engine */
    load() {
        return this.ask("load", { wasm: engineBytes() });
    }

    /** @param {string} type @param {object} [content] @param {Transferable[]} [transfer] @returns {Promise<any>} */
    ask(type, content = {}, transfer = []) {
        const id = this.#nextId++;
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, { resolve, reject });
            this.#worker.postMessage({ id, type, ...content }, transfer);
        });
    }

    /** A request that is answered by a frame. */
    advance(count, inputs, recycle) {
        this.#worker.postMessage({ type: "advance", count, inputs, recycle }, recycle.map((array) => array.buffer));
    }

    /** Give arrays of spent frames back. */
    recycle(arrays) {
        if (arrays.length > 0) this.#worker.postMessage({ type: "recycle", arrays }, arrays.map((array) => array.buffer));
    }

    stop() {
        this.#worker.terminate();
        for (const { reject } of this.#waiting.values()) reject(new Error("The engine was stopped."));
        this.#waiting.clear();
    }
}
