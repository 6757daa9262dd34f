/**
 * Compares the hash of the state with the one that the native program printed at the same step. Both computed the same scene, so
 * they must agree to the last bit, unless the scene was changed on the page.
 */
export class HashCheck {
    #native;

    /** @param {{every: number, isa: string, values: string[]}|null} native */
    constructor(native) {
        this.#native = native;
        this.every = native?.every ?? 60;
        this.restart();
    }

    restart() {
        /** @type {{step: number, hash: string, native: string|null, isEqual: boolean|null}[]} */
        this.rows = [];
        /** @type {string|null} why the hashes cannot agree */
        this.excluded = null;
    }

    /** From now on hashes are not compared. @param {string} reason */
    exclude(reason) {
        this.excluded ??= reason;
    }

    add(step, hash) {
        const native = this.#native?.values[step / this.every - 1] ?? null;
        const isEqual = native === null || this.excluded ? null : native === hash;
        this.rows.push({ step, hash, native, isEqual });
    }

    get isa() {
        return this.#native?.isa ?? null;
    }

    get hasNative() {
        return this.#native !== null;
    }

    get nativeSteps() {
        return this.#native ? this.#native.values.length * this.every : 0;
    }

    get equalCount() {
        return this.rows.filter((row) => row.isEqual === true).length;
    }

    get firstDifference() {
        return this.rows.find((row) => row.isEqual === false) ?? null;
    }
}
