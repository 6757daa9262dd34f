/**
 * The colour map of `wisp render`: lightness and hue are linear in Oklab (Ottosson 2020, "A perceptual color space for image
 * processing"), so that equal steps of a value look equal.
 */
import { DataTexture, LinearFilter, RGBAFormat } from "three";

const SIZE = 256;

/** @param {number} t in [0, 1] @returns {number[]} linear sRGB in [0, 1] */
export function mapColour(t) {
    const middle = 1 - Math.abs(2 * t - 0.82);
    const lightness = 0.30 + 0.60 * t, chroma = 0.126 - 0.05 * middle + 0.03 * t, hue = 5.20 - 3.40 * t;
    const a = chroma * Math.cos(hue), b = chroma * Math.sin(hue);
    const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3;
    return [
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
    ].map((c) => Math.min(1, Math.max(0, c)));
}

export function mapTexture() {
    const data = new Uint8Array(4 * SIZE);
    for (let i = 0; i < SIZE; ++i) {
        const c = mapColour(i / (SIZE - 1));
        data.set([...c.map((x) => Math.round(255 * x)), 255], 4 * i);
    }
    const texture = new DataTexture(data, SIZE, 1, RGBAFormat);
    texture.magFilter = texture.minFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
}

const toScreen = (c) => Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));

/** @returns {string} the map as a CSS gradient */
export function mapGradient() {
    const stops = Array.from({ length: 17 }, (_, i) => `rgb(${mapColour(i / 16).map(toScreen).join(" ")}) ${(100 * i) / 16}%`);
    return `linear-gradient(to right, ${stops.join(", ")})`;
}

/** The smallest of 1, 2, 5 x 10^n that is at least x. @param {number} x > 0 */
export function niceAbove(x) {
    const power = 10 ** Math.floor(Math.log10(x));
    const step = [1, 2, 5, 10].find((s) => s * power >= x * (1 - 1e-9));
    return step * power;
}
