/**
 * Hair as ribbons that face the camera. Two vertices per vertex of a strand are computed on the GPU from the texture of points; the
 * page does nothing per vertex. Light is that of a thin fibre (Kajiya and Kay 1989) with two highlights, the second one tinted and
 * shifted towards the tip (Marschner et al. 2003 explain why there are two).
 */
import { BufferAttribute, BufferGeometry, Color, DoubleSide, GLSL3, Mesh, ShaderMaterial, Vector2 } from "three";
import { COLOUR_MAP, LIGHT, OUTPUT, PLACES, VALUES } from "./glsl.mjs";
import { HAIR } from "./body_colours.mjs";
import { spreadOrder } from "./pixel_ratio.mjs";
import { numbersTexture, triplesTexture } from "./point_textures.mjs";

const VERTEX = /* glsl */ `
${PLACES}${VALUES}
in vec4 strand; // flags (1: has a vertex before, 2: after), side, place along the strand, random number; of 255 each
uniform highp sampler2D widths, colours;
uniform bool hasWidth, hasColour;
uniform float width, minPixels;
uniform vec2 viewport;
uniform vec3 hairColour;
out vec3 world, tangent, base;
out float along, random, value;
void main() {
    int i = gl_VertexID >> 1;
    int flags = int(strand.x + 0.5);
    vec3 p = placeOf(i);
    // The direction of the later frame will do for both.
    vec3 t = texelFetch(pointsNow, texelOf((flags & 2) != 0 ? i + 1 : i), 0).xyz - texelFetch(pointsNow, texelOf((flags & 1) != 0 ? i - 1 : i), 0).xyz;
    float size = length(t);
    tangent = size > 0.0 ? t / size : vec3(0.0, 1.0, 0.0);
    along = strand.z / 255.0;
    random = strand.w / 255.0;
    base = hasColour ? texelFetch(colours, texelOf(i), 0).rgb : hairColour;
    value = valueOf(i);
    vec4 view = viewMatrix * vec4(p, 1.0);
    vec3 viewTangent = mat3(viewMatrix) * tangent;
    bool isParallel = projectionMatrix[3][3] == 1.0; // the shadow's camera
    vec3 eye = isParallel ? vec3(0.0, 0.0, 1.0) : normalize(-view.xyz);
    vec3 across = cross(viewTangent, eye);
    float length2 = dot(across, across);
    across = length2 > 1e-12 ? across * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
    float pixel = 2.0 * (isParallel ? 1.0 : -view.z) / (projectionMatrix[1][1] * viewport.y);
    float wanted = (hasWidth ? texelFetch(widths, texelOf(i), 0).r : width) * mix(1.0, 0.45, hasWidth ? 0.0 : along);
    // Hair thinner than a pixel is drawn a pixel wide. Covering part of it would need an order of drawing, or leave the same
    // samples of each pixel open however many strands lie over each other.
    float least = minPixels * pixel;
    view.xyz += across * (strand.y - 0.5) * max(wanted, least);
    world = p;
    gl_Position = projectionMatrix * view;
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
${LIGHT}${COLOUR_MAP}${OUTPUT}
in vec3 world, tangent, base;
in float along, random, value;
out vec4 colour;
float highlight(vec3 t, vec3 h, float shift, float power) {
    // Scales of a hair tilt its surface; the same as tilting the tangent towards the half vector.
    float d = dot(t, h) + shift;
    return pow(max(0.0, 1.0 - d * d), 0.5 * power);
}
void main() {
    vec3 t = normalize(tangent), v = normalize(cameraPosition - world), l = keyDirection, h = normalize(l + v);
    float sinTL = sqrt(max(0.0, 1.0 - dot(t, l) * dot(t, l)));
    float shift = (random - 0.5) * 0.16;
    float lit = shadowAt(world + l * 2.0 * shadowBias, 0.0015);
    vec3 b = value >= 0.0 ? mapColour(value) : base * (0.65 + 0.70 * random);
    vec3 n = normalize(v - t * dot(v, t));
    vec3 diffuse = b * (keyColour * 0.5 * sinTL * mix(0.2, 1.0, lit) + skyAt(n) * (0.5 + 0.4 * along));
    // Light from behind passes along the edge of the hair.
    vec3 rim = skyColour * b * 0.6 * pow(max(0.0, 1.0 - abs(dot(v, vec3(0.0, 1.0, 0.0)))), 2.0) * highlight(t, normalize(v + vec3(0.5, 0.3, -0.8)), shift, 14.0);
    float first = highlight(t, h, 0.10 + shift, 110.0), second = highlight(t, h, -0.12 + shift, 26.0);
    vec3 shine = keyColour * lit * (0.10 * first + 0.45 * second * b);
    colour = vec4(toScreen(diffuse + rim + (value >= 0.0 ? 0.2 : 1.0) * shine), 1.0);
}`;

const DEPTH_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 world, tangent, base;
in float along, random, value;
void main() {}`;

/** Ribbons of all strands: two vertices per vertex, two triangles per segment. */
function ribbonsOf(offsets, vertexCount) {
    const attributes = new Uint8Array(8 * vertexCount);
    const strands = offsets.length - 1;
    const indices = new Uint32Array(6 * Math.max(0, vertexCount - strands));
    let at = 0;
    for (const s of spreadOrder(strands)) {
        const begin = offsets[s], end = offsets[s + 1];
        // A fixed hash of its number gives a strand its random number.
        const random = (Math.imul(s + 1, 2654435761) >>> 24) & 255;
        for (let i = begin; i < end; ++i) {
            const flags = (i > begin ? 1 : 0) | (i + 1 < end ? 2 : 0);
            const along = end - begin > 1 ? Math.round(255 * (i - begin) / (end - begin - 1)) : 0;
            attributes.set([flags, 0, along, random, flags, 1, along, random], 8 * i);
            if (i + 1 < end) {
                indices.set([2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 1, 2 * i + 3, 2 * i + 2], at);
                at += 6;
            }
        }
    }
    return { attributes, indices: indices.subarray(0, at) };
}

export class StrandDrawing {
    /** @param {object} body @param {import("./point_textures.mjs").PointTextures} points @param {object} shared uniforms */
    constructor(body, points, shared) {
        this.count = body.vertexCount;
        this.values = numbersTexture(null, body.vertexCount);
        this.widths = null;
        this.colours = null;
        const uniforms = {
            ...points.uniforms, ...shared,
            values: { value: this.values }, valueScale: { value: 0 },
            widths: { value: null }, colours: { value: null }, hasWidth: { value: false }, hasColour: { value: false },
            // A model has a hundredth of the hairs of a head: the fewer there are, the more each stands for.
            width: { value: 4e-4 * Math.min(3, Math.max(1, Math.sqrt(10000 / body.strandCount))) },
            minPixels: { value: 0.9 },
            hairColour: { value: new Color(...HAIR) },
        };
        this.uniforms = uniforms;
        const { attributes, indices } = ribbonsOf(body.offsets, body.vertexCount);
        const geometry = new BufferGeometry();
        geometry.setAttribute("strand", new BufferAttribute(attributes, 4));
        geometry.setIndex(new BufferAttribute(indices, 1));
        this.material = new ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, side: DoubleSide, glslVersion: GLSL3,
        });
        const depthUniforms = { ...uniforms, minPixels: { value: 1.0 }, viewport: { value: new Vector2(2048, 2048) } };
        this.depthMaterial = new ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: DEPTH_FRAGMENT, uniforms: depthUniforms, side: DoubleSide, glslVersion: GLSL3,
            colorWrite: false,
        });
        this.object = new Mesh(geometry, this.material);
        this.object.frustumCulled = false;
    }

    showValues(values, scale) {
        this.#set("valueScale", values ? scale : 0);
        if (!values || values === this.values.image.data) return;
        this.values.image.data = values;
        this.values.needsUpdate = true;
    }

    /** @param {{width: Float32Array|null, colour: Float32Array|null}} looks */
    showLooks(looks) {
        this.widths?.dispose();
        this.colours?.dispose();
        this.widths = looks.width ? numbersTexture(looks.width, this.count) : null;
        this.colours = looks.colour ? triplesTexture(looks.colour, this.count) : null;
        this.#set("widths", this.widths);
        this.#set("colours", this.colours);
        this.#set("hasWidth", this.widths !== null);
        this.#set("hasColour", this.colours !== null);
    }

    /** @param {number} part of the strands to draw, evenly spread */
    showPart(part) {
        const count = this.object.geometry.index.count;
        this.object.geometry.setDrawRange(0, part < 1 ? 6 * Math.ceil(part * count / 6) : count);
    }

    #set(name, value) {
        // The same uniform object is in both materials.
        this.uniforms[name].value = value;
    }

    dispose() {
        this.object.geometry.dispose();
        this.material.dispose();
        this.depthMaterial.dispose();
        this.values.dispose();
        this.widths?.dispose();
        this.colours?.dispose();
    }
}
