/** What a mesh's shaders need to know about its triangles, computed once, and again where cloth has torn. */
import { paddedLength } from "./buffer_pool.mjs";

/**
 * Triangles of the bodies that tear, as they are now.
 * @param {object} source a world or a recording
 * @returns {(Int32Array|null)[]|null} null if no body tears
 */
export function trianglesOf(source, bodies) {
    if (!bodies.some((body) => body.tears)) return null;
    return bodies.map((body) => (body.tears ? Int32Array.from(source.triangles(body)) : null));
}

/** @param {Int32Array} a @param {Int32Array} b of the same length */
export function areEqual(a, b) {
    for (let i = 0; i < a.length; ++i) if (a[i] !== b[i]) return false;
    return true;
}

/**
 * The triangles around each vertex: first a pair (start, count) per vertex, then for each triangle around it the other two corners.
 * @param {Int32Array} triangles @param {number} vertexCount
 * @returns {{array: Int32Array, count: number}} pairs, padded to rows of a texture
 */
export function ringOf(triangles, vertexCount) {
    const counts = new Int32Array(vertexCount);
    for (const v of triangles) ++counts[v];
    const count = vertexCount + triangles.length;
    const array = new Int32Array(paddedLength(count, 2));
    const cursor = new Int32Array(vertexCount);
    let start = vertexCount;
    for (let v = 0; v < vertexCount; ++v) {
        array[2 * v] = cursor[v] = start;
        array[2 * v + 1] = counts[v];
        start += counts[v];
    }
    for (let t = 0; t < triangles.length; t += 3) {
        for (let k = 0; k < 3; ++k) {
            const at = cursor[triangles[t + k]]++;
            array[2 * at] = triangles[t + (k + 1) % 3];
            array[2 * at + 1] = triangles[t + (k + 2) % 3];
        }
    }
    return { array, count };
}

/**
 * The edges of a mesh with the vertices opposite to them.
 * @param {Int32Array} triangles @param {number} vertexCount
 * @returns {Int32Array} four numbers per edge: its ends, and the opposite vertices, the second -1 at an open edge
 */
export function edgesOf(triangles, vertexCount) {
    /** @type {Map<number, number>} edge to its place in the list */
    const places = new Map();
    const edges = [];
    for (let t = 0; t < triangles.length; t += 3) {
        for (let k = 0; k < 3; ++k) {
            const a = triangles[t + k], b = triangles[t + (k + 1) % 3], opposite = triangles[t + (k + 2) % 3];
            const key = Math.min(a, b) * vertexCount + Math.max(a, b);
            const place = places.get(key);
            if (place === undefined) {
                places.set(key, edges.length);
                edges.push(a, b, opposite, -1);
            } else {
                edges[place + 3] = opposite;
            }
        }
    }
    return Int32Array.from(edges);
}
