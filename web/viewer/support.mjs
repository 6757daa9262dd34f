/** Whether this browser can run the page. */

/** A module with one function that returns a 128-bit constant: valid only where SIMD is known. */
const SIMD_MODULE = new Uint8Array([
    0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]);

/** @returns {string|null} a sentence on what is missing */
export function missingFeature() {
    if (typeof WebAssembly !== "object" || !WebAssembly.validate(SIMD_MODULE)) {
        return "This browser has no WebAssembly SIMD, which the engine is compiled for. Use Chrome 92, Firefox 90, Safari 16.4 or newer.";
    }
    if (!document.createElement("canvas").getContext("webgl2")) {
        return "This browser has no WebGL2, which draws the scene. It may be switched off, or the graphics driver may be blocked.";
    }
    return null;
}
