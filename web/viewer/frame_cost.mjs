/** Time that the page's own thread needs for a picture. */
const SIZE = 240;

export class FrameCost {
    #times = new Float64Array(SIZE);
    #count = 0;

    add(ms) {
        this.#times[this.#count++ % SIZE] = ms;
    }

    /** @returns {{median: number, largest: number, count: number}} ms, of the last four seconds or so */
    get stats() {
        const count = Math.min(SIZE, this.#count);
        const sorted = this.#times.slice(0, count).sort();
        return { median: sorted[count >> 1] ?? 0, largest: sorted[count - 1] ?? 0, count: this.#count };
    }
}
