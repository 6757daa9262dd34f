/**
 * Arrays that travel between the worker and the page. A step of 10 000 strands is 2.4 MB; allocating it 60 times per second would
 * keep the garbage collector busy, so the page sends each array back when it has been drawn.
 */

/** Width of all data textures, in texels. Arrays are padded to whole rows so that the page uploads them without a copy. */
export const TEXTURE_WIDTH = 1024;

/** @param {number} count texels @returns {number} rows of a texture that holds them */
export function textureRows(count) {
    return Math.max(1, Math.ceil(count / TEXTURE_WIDTH));
}

/** @param {number} count vertices @param {number} channels @returns {number} floats of the padded array */
export function paddedLength(count, channels) {
    return TEXTURE_WIDTH * textureRows(count) * channels;
}

export class BufferPool {
    /** @type {Map<number, Float32Array[]>} free arrays by length */
    #free = new Map();

    /** @param {number} length floats @returns {Float32Array} its content is undefined */
    take(length) {
        return this.#free.get(length)?.pop() ?? new Float32Array(length);
    }

    /** @param {Float32Array[]} arrays that nothing else uses */
    give(arrays) {
        for (const array of arrays) {
            let list = this.#free.get(array.length);
            if (!list) this.#free.set(array.length, list = []);
            if (list.length < 12) list.push(array);
        }
    }
}
