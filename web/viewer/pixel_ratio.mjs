/** How much is drawn: fewer pixels per pixel of the page, then fewer strands, where the graphics cannot keep up. */

const SLOW_MS = 24, PAUSE_MS = 5000;
// A decision takes 45 pictures, or a second and a half of slow ones.
const PICTURES = 45, DECISION_MS = 1500, LEAST_PICTURES = 3;
const LEVELS = [[2, 1], [1.5, 1], [1, 1], [0.75, 1], [0.75, 1 / 4], [0.75, 1 / 16]];

export class PixelRatio {
    #slow = 0;
    #count = 0;
    #time = 0;
    #level = LEVELS.findIndex(([ratio]) => ratio <= devicePixelRatio);

    constructor() {
        if (this.#level < 0) this.#level = 3;
    }

    get ratio() {
        return Math.min(devicePixelRatio, LEVELS[this.#level][0]);
    }

    /** Part of the strands that is drawn. */
    get strands() {
        return LEVELS[this.#level][1];
    }

    /** A picture was drawn. @param {number} lapse ms until the browser asked for the next one @returns {boolean} whether less is drawn */
    picture(lapse) {
        if (lapse > PAUSE_MS) return false; // a page that was not seen
        ++this.#count;
        this.#time += lapse;
        if (lapse > SLOW_MS) ++this.#slow;
        if (this.#count < PICTURES && (this.#time < DECISION_MS || this.#count < LEAST_PICTURES)) return false;
        const isSlow = this.#slow > 0.6 * this.#count && this.#level + 1 < LEVELS.length;
        this.#count = this.#slow = this.#time = 0;
        if (isSlow) ++this.#level;
        return isSlow;
    }
}

/** Numbers of all strands, so that the first of any part of them are spread evenly. */
export function spreadOrder(count) {
    const order = [];
    for (let stride = 16; stride >= 1; stride /= 4) {
        for (let s = 0; s < count; s += stride) if (stride === 16 || s % (4 * stride) !== 0) order.push(s);
    }
    return order;
}
