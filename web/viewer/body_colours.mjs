/** Colours of bodies in linear light, those of app/io/palette.c. */
const PALETTE = [
    [0.62, 0.050, 0.045], [0.045, 0.16, 0.32], [0.68, 0.36, 0.060], [0.090, 0.30, 0.19],
    [0.36, 0.12, 0.30], [0.10, 0.36, 0.38], [0.66, 0.27, 0.19], [0.55, 0.50, 0.42],
];
export const HAIR = [0.20, 0.088, 0.038];
const COLLIDER = [0.50, 0.47, 0.43];

/** As scene_body_colour() has it: every other colour first, cloth and balloons from different ends. */
export function colourOf(body, number) {
    const place = 2 * number + Math.floor(number / 4) % 2 + (body.kind === "cloth" ? 1 : 0);
    return body.kind === "collider" ? COLLIDER : PALETTE[place % PALETTE.length];
}
