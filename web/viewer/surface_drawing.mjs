/**
 * Cloth, balloons and colliders. The vertex shader reads vertices from textures and adds up the normals of the triangles around each,
 * so that a frame costs the page one upload. Folds are made readable by three means: a key light with shadows, a darker hue where
 * the surface is hollow, and light along the silhouette.
 */
import { BufferAttribute, BufferGeometry, Color, DoubleSide, GLSL3, Mesh, ShaderMaterial } from "three";
import { colourOf } from "./body_colours.mjs";
import { COLOUR_MAP, LIGHT, OUTPUT, PLACES, RING, VALUES } from "./glsl.mjs";
import { numbersTexture, pairsTexture } from "./point_textures.mjs";
import { areEqual, ringOf } from "./surface_topology.mjs";

const VERTEX = /* glsl */ `
${PLACES}${VALUES}${RING}
out vec3 world, facing;
out float hollow, value;
void main() {
    int i = gl_VertexID;
    vec3 p = placeOf(i);
    vec4 n = normalOf(i, p);
    world = p;
    facing = n.xyz;
    hollow = n.w;
    value = valueOf(i);
    gl_Position = projectionMatrix * viewMatrix * vec4(p, 1.0);
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
${LIGHT}${COLOUR_MAP}${OUTPUT}
uniform vec3 front, back;
uniform float gloss, opacity;
in vec3 world, facing;
in float hollow, value;
out vec4 colour;
void main() {
    float side = gl_FrontFacing ? 1.0 : -1.0;
    vec3 n = normalize(facing) * side, v = normalize(cameraPosition - world), l = keyDirection;
    vec3 base = value >= 0.0 ? mapColour(value) : gl_FrontFacing ? front : back;
    float cosine = dot(n, l);
    // Light wraps around thin things a little: some passes through the threads.
    float direct = clamp((cosine + 0.12) / 1.12, 0.0, 1.0);
    float lit = shadowAt(world + n * shadowBias, 0.0008);
    float cavity = clamp(1.0 - 2.2 * hollow * side, 0.45, 1.25);
    vec3 h = normalize(l + v);
    float rim = pow(1.0 - clamp(dot(n, v), 0.0, 1.0), 3.5);
    float shine = gloss * pow(clamp(dot(n, h), 0.0, 1.0), 48.0);
    vec3 light = keyColour * direct * mix(0.10, 1.0, lit) * mix(1.0, cavity, 0.5) + skyAt(n) * cavity;
    vec3 sheen = skyColour * rim * 0.38 + keyColour * shine * lit;
    colour = vec4(toScreen(base * light + (value >= 0.0 ? 0.25 : 1.0) * sheen * (0.15 + 0.85 * base)), opacity);
}`;

const DEPTH_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 world, facing;
in float hollow, value;
void main() {}`;

export class SurfaceDrawing {
    /**
     * @param {object} body @param {number} number of the body among those of its kind
     * @param {import("./point_textures.mjs").PointTextures} points @param {object} shared uniforms of light and colour map
     */
    constructor(body, number, points, shared) {
        this.body = body;
        const ring = ringOf(body.triangles, body.vertexCount);
        this.ring = pairsTexture(ring.array, ring.count);
        this.values = numbersTexture(null, body.vertexCount);
        const [r, g, b] = colourOf(body, number);
        // The back is paler, so that a fold shows which side is out.
        const pale = body.kind === "cloth" ? 0.42 : 0;
        const uniforms = {
            ...points.uniforms, ...shared,
            ring: { value: this.ring }, values: { value: this.values }, valueScale: { value: 0 },
            front: { value: new Color(r, g, b) },
            back: { value: new Color(r + pale * (0.62 - r), g + pale * (0.60 - g), b + pale * (0.57 - b)) },
            gloss: { value: body.kind === "balloon" ? 0.55 : body.kind === "collider" ? 0.08 : 0.05 },
            opacity: { value: 1 },
        };
        this.uniforms = uniforms;
        const geometry = new BufferGeometry();
        geometry.setIndex(new BufferAttribute(Uint32Array.from(body.triangles), 1));
        this.material = new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, side: DoubleSide, glslVersion: GLSL3 });
        this.depthMaterial = new ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: DEPTH_FRAGMENT, uniforms, side: DoubleSide, glslVersion: GLSL3, colorWrite: false,
        });
        this.object = new Mesh(geometry, this.material);
        this.object.frustumCulled = false;
    }

    /** Other triangles, as many as before, where the body has torn. The pointer finds them too. @param {Int32Array} triangles */
    showTriangles(triangles) {
        if (areEqual(triangles, this.body.triangles)) return;
        this.body.triangles = triangles;
        const index = this.object.geometry.index;
        index.array.set(triangles);
        index.needsUpdate = true;
        this.ring.image.data = ringOf(triangles, this.body.vertexCount).array;
        this.ring.needsUpdate = true;
    }

    /** @param {Float32Array|null} values @param {number} scale from a value to its place in the colour map; 0: no values */
    showValues(values, scale) {
        this.uniforms.valueScale.value = values ? scale : 0;
        if (!values || values === this.values.image.data) return;
        this.values.image.data = values;
        this.values.needsUpdate = true;
    }

    showLooks() {
        // Surfaces have no appearance of their own.
    }

    dispose() {
        this.object.geometry.dispose();
        this.material.dispose();
        this.depthMaterial.dispose();
        this.ring.dispose();
        this.values.dispose();
    }
}
