/** Pieces of shader that the drawings share. */

/** Places of vertices, from textures that are uploaded as they come from the worker, between two frames. */
export const PLACES = /* glsl */ `
uniform highp sampler2D pointsBefore, pointsNow;
uniform float frameMix;
ivec2 texelOf(int i) { return ivec2(i & 1023, i >> 10); }
vec3 placeOf(int i) {
    ivec2 at = texelOf(i);
    return mix(texelFetch(pointsBefore, at, 0).xyz, texelFetch(pointsNow, at, 0).xyz, frameMix);
}`;

/** Strain or speed, or -1 where there is none, as a place in the colour map. */
export const VALUES = /* glsl */ `
uniform highp sampler2D values;
uniform float valueScale;
float valueOf(int i) { return valueScale > 0.0 ? abs(texelFetch(values, texelOf(i), 0).r) * valueScale : -1.0; }`;

/** A surface's normal and curvature at a vertex, from the triangles around it. */
export const RING = /* glsl */ `
uniform highp isampler2D ring;
// xyz: normal. w: how far the vertex lies below its neighbours, in their mean distance: folds are above 0, ridges below.
vec4 normalOf(int i, vec3 p) {
    ivec2 span = texelFetch(ring, texelOf(i), 0).rg;
    vec3 sum = vec3(0.0), mean = vec3(0.0);
    float reach = 0.0;
    for (int k = 0; k < span.y && k < 24; ++k) {
        ivec2 pair = texelFetch(ring, texelOf(span.x + k), 0).rg;
        vec3 a = placeOf(pair.x) - p, b = placeOf(pair.y) - p;
        sum += cross(a, b);
        mean += a + b;
        reach += length(a) + length(b);
    }
    float size = length(sum);
    vec3 n = size > 0.0 ? sum / size : vec3(0.0, 1.0, 0.0);
    return vec4(n, reach > 0.0 ? dot(mean, n) / reach : 0.0);
}`;

/** The light of the scene: a soft key light with a shadow, and a sky. */
export const LIGHT = /* glsl */ `
uniform vec3 keyDirection, keyColour, skyColour, groundColour;
uniform highp sampler2DShadow shadowMap;
uniform mat4 shadowMatrix;
uniform float shadowTexel, shadowBias;
float shadowAt(vec3 world, float bias) {
    vec4 c = shadowMatrix * vec4(world, 1.0);
    if (any(lessThan(c.xyz, vec3(0.0))) || any(greaterThan(c.xyz, vec3(1.0)))) return 1.0;
    float lit = 0.0;
    // A disc turned per pixel: sixteen samples would band, four turned ones give fine noise that the eye takes for softness.
    float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    for (int k = 0; k < 8; ++k) {
        float angle = turn + 2.3999632 * float(k), radius = 2.6 * sqrt((float(k) + 0.5) / 8.0);
        vec2 offset = vec2(cos(angle), sin(angle)) * radius * shadowTexel;
        lit += texture(shadowMap, vec3(c.xy + offset, c.z - bias));
    }
    return lit / 8.0;
}
vec3 skyAt(vec3 n) { return mix(groundColour, skyColour, 0.5 + 0.5 * n.y); }`;

export const COLOUR_MAP = /* glsl */ `
uniform sampler2D colourMap;
vec3 mapColour(float t) { return texture(colourMap, vec2(clamp(t, 0.0, 1.0) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb; }`;

/** From light to the screen: a gentle shoulder, then sRGB. */
export const OUTPUT = /* glsl */ `
vec3 toScreen(vec3 c) {
    c = max(c, vec3(0.0));
    c = c * (1.0 + c * 0.12) / (1.0 + c * 0.42);
    return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c));
}`;
