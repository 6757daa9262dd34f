/** Vertices of a body on the GPU: two textures, the frame before and the frame after the time that is shown. */
import { DataTexture, FloatType, IntType, NearestFilter, RedFormat, RGBFormat, RGIntegerFormat } from "three";
import { TEXTURE_WIDTH, textureRows } from "./buffer_pool.mjs";

function dataTexture(array, rows, format, type, internalFormat) {
    const texture = new DataTexture(array, TEXTURE_WIDTH, rows, format, type);
    texture.internalFormat = internalFormat;
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.generateMipmaps = false;
    texture.unpackAlignment = 4;
    texture.needsUpdate = true;
    return texture;
}

/** @param {Float32Array|null} array padded @param {number} count texels */
export function triplesTexture(array, count) {
    const rows = textureRows(count);
    return dataTexture(array ?? new Float32Array(3 * TEXTURE_WIDTH * rows), rows, RGBFormat, FloatType, "RGB32F");
}

/** @param {Float32Array|null} array padded @param {number} count texels */
export function numbersTexture(array, count) {
    const rows = textureRows(count);
    return dataTexture(array ?? new Float32Array(TEXTURE_WIDTH * rows), rows, RedFormat, FloatType, "R32F");
}

/** @param {Int32Array} array of pairs, padded @param {number} count pairs */
export function pairsTexture(array, count) {
    return dataTexture(array, textureRows(count), RGIntegerFormat, IntType, "RG32I");
}

export class PointTextures {
    #shown = [null, null]; // the arrays that the two textures hold
    uniforms;

    /** @param {number} count vertices */
    constructor(count) {
        this.textures = [triplesTexture(null, count), triplesTexture(null, count)];
        this.uniforms = { pointsBefore: { value: this.textures[0] }, pointsNow: { value: this.textures[1] }, frameMix: { value: 1 } };
    }

    /**
     * Show a place between two frames. Uploads only what is not there yet: as time goes on, the later frame becomes the earlier one.
     * @param {Float32Array} before @param {Float32Array} now @param {number} mix
     */
    show(before, now, mix) {
        this.uniforms.frameMix.value = mix;
        if (this.#shown[1] === before && before !== now) {
            this.textures.reverse();
            this.#shown.reverse();
        }
        this.#put(0, before);
        this.#put(1, now);
        this.uniforms.pointsBefore.value = this.textures[0];
        this.uniforms.pointsNow.value = this.textures[1];
    }

    #put(which, array) {
        if (this.#shown[which] === array) return;
        this.#shown[which] = array;
        this.textures[which].image.data = array;
        this.textures[which].needsUpdate = true;
    }

    dispose() {
        for (const texture of this.textures) texture.dispose();
    }
}
