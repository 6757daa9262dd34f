/** Frames that have arrived and are not yet shown, and the two between which the picture lies. */
export class FrameQueue {
    /** @type {object[]} in the order of their steps */
    #frames = [];
    /** @type {Float32Array[]} arrays that the worker may have back */
    #spent = [];

    clear() {
        this.#frames.length = 0;
        this.#spent.length = 0;
    }

    push(frame) {
        this.#frames.push(frame);
    }

    get last() {
        return this.#frames.at(-1) ?? null;
    }

    get count() {
        return this.#frames.length;
    }

    /**
     * The frames around a time: the first is the last one at or before it. Earlier ones are given up.
     * @param {number} time s
     * @param {number} maxStep frames beyond it are held back
     * @returns {[object, object]|null} the same frame twice, if there is none after it
     */
    around(time, maxStep) {
        const frames = this.#frames;
        const slack = 1e-9;
        while (frames.length > 1 && frames[1].time <= time + slack && frames[1].step <= maxStep) this.#spend(frames.shift());
        if (frames.length === 0) return null;
        const next = frames.length > 1 && frames[1].step <= maxStep ? frames[1] : frames[0];
        return [frames[0], next];
    }

    /** @param {number} maxStep @returns {number} s of the last frame that may be shown */
    limit(maxStep) {
        let time = this.#frames[0]?.time ?? 0;
        for (const frame of this.#frames) if (frame.step <= maxStep) time = frame.time;
        return time;
    }

    #spend(frame) {
        for (const array of [...frame.points, ...frame.values]) if (array) this.#spent.push(array);
    }

    /** @returns {Float32Array[]} */
    takeSpent() {
        const spent = this.#spent;
        this.#spent = [];
        return spent;
    }
}
