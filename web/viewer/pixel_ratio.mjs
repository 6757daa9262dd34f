/** How many pixels are drawn per pixel of the page: fewer where the graphics cannot keep up. */

const SLOW_MS = 24, WINDOW = 45; // pictures that are measured before a decision
const STEPS = [2, 1.5, 1, 0.75];

export class PixelRatio {
    #last = 0;
    #slow = 0;
    #count = 0;
    #level = STEPS.findIndex((ratio) => ratio <= devicePixelRatio);

    constructor() {
        if (this.#level < 0) this.#level = STEPS.length - 2;
    }

    get ratio() {
        return Math.min(devicePixelRatio, STEPS[this.#level]);
    }

    /** A picture was drawn. @param {number} now ms @returns {boolean} whether the ratio has changed */
    picture(now) {
        const lapse = now - this.#last;
        this.#last = now;
        // A single long gap is a pause, not slow graphics.
        if (lapse > 250) return false;
        ++this.#count;
        if (lapse > SLOW_MS) ++this.#slow;
        if (this.#count < WINDOW) return false;
        const isSlow = this.#slow > 0.6 * WINDOW && this.#level + 1 < STEPS.length;
        this.#count = this.#slow = 0;
        if (isSlow) ++this.#level;
        return isSlow;
    }
}
