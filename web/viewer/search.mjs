/** The search for settings that meet an error, in a worker of its own. */
import { Engine } from "./engine.mjs";

/** s that a search may take, and s of the scene that each run simulates. */
const LIMIT = 60, SECONDS = 2;

export class Search {
    #engine = null;

    get isRunning() {
        return this.#engine !== null;
    }

    /**
     * @param {string} name @param {Record<string, Uint8Array>} files
     * @param {number} error m @param {(runs: number, maxRuns: number) => void} progress
     * @returns {Promise<object|null>} null: it was stopped
     */
    async run(name, files, error, progress) {
        let stopped;
        const stop = new Promise((resolve) => (stopped = resolve));
        const engine = new Engine({ progress, failed: () => {} });
        this.#engine = engine;
        this.stop = () => stopped(null);
        try {
            const work = async () => {
                await engine.load();
                await engine.ask("openScene", { name, files });
                return engine.ask("tune", { error, length: SECONDS, limit: LIMIT });
            };
            return await Promise.race([work(), stop]);
        } finally {
            engine.stop();
            this.#engine = null;
        }
    }

    stop() {
        // Replaced while a search runs.
    }
}

const millimetres = (metres) => `${+(1000 * metres).toPrecision(3)} mm`;

/** @param {object} found @param {number} error m @returns {string} */
export function sentenceOf(found, error) {
    const setting = Object.entries(found.parameters).map(([name, value]) => `${name.replaceAll("_", " ")} ${+value.toPrecision(3)}`).join(", ");
    const cost = `${+found.ms.toPrecision(3)} ms per step`;
    const early = found.stoppedEarly ? " The time limit ended the search, so a cheaper one may exist." : "";
    return found.meetsTarget
        ? `Found ${setting}: ${millimetres(found.error)} for ${cost}, after ${found.runs} runs.${early}`
        : `No setting of this scene meets ${millimetres(error)}. The closest is ${setting}: ${millimetres(found.error)} for ${cost}.${early}`;
}
