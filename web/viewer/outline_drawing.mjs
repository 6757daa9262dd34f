/**
 * The reference, drawn faintly over the scene: open edges and silhouette of a surface, some strands of hair. Which edges are on the
 * silhouette is decided on the GPU for each picture; the others collapse.
 */
import { BufferAttribute, BufferGeometry, GLSL3, Mesh, ShaderMaterial, DoubleSide } from "three";
import { PLACES } from "./glsl.mjs";
import { areEqual, edgesOf } from "./surface_topology.mjs";

/** Strands of the reference that are drawn: more would hide the main world. */
const MAX_STRANDS = 160;

const VERTEX = /* glsl */ `
${PLACES}
in vec4 edge;      // ends; then the opposite vertices, the second -1 at an open edge, -2 where the line is always drawn
in vec2 corner;    // which end, which side
uniform vec2 viewport;
uniform float pixels;
out float across;
void main() {
    vec3 a = placeOf(int(edge.x)), b = placeOf(int(edge.y));
    bool isDrawn = edge.w < 0.0;
    if (!isDrawn) {
        vec3 c = placeOf(int(edge.z)), d = placeOf(int(edge.w));
        vec3 toEye = cameraPosition - a;
        isDrawn = dot(cross(b - a, c - a), toEye) * dot(cross(d - a, b - a), toEye) < 0.0;
    }
    mat4 m = projectionMatrix * viewMatrix;
    vec4 pa = m * vec4(a, 1.0), pb = m * vec4(b, 1.0);
    across = corner.y;
    if (!isDrawn || pa.w <= 0.0 || pb.w <= 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    vec2 along = (pb.xy / pb.w - pa.xy / pa.w) * viewport;
    float size = length(along);
    vec2 side = size > 0.0 ? vec2(-along.y, along.x) / size : vec2(0.0);
    vec4 p = corner.x < 0.5 ? pa : pb;
    p.xy += side * corner.y * pixels / viewport * p.w;
    gl_Position = p;
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
uniform vec4 ink;
in float across;
out vec4 colour;
void main() {
    float edge = 1.0 - smoothstep(0.35, 1.0, abs(across));
    colour = vec4(ink.rgb, ink.a * edge);
}`;

function segmentsOf(body) {
    if (body.triangles) return edgesOf(body.triangles, body.vertexCount);
    const strands = body.offsets.length - 1, stride = Math.max(1, Math.ceil(strands / MAX_STRANDS));
    const segments = [];
    for (let s = 0; s < strands; s += stride) {
        for (let i = body.offsets[s]; i + 1 < body.offsets[s + 1]; ++i) segments.push(i, i + 1, -2, -2);
    }
    return Int32Array.from(segments);
}

/** @param {Int32Array} segments four numbers each, as edgesOf() has them */
function geometryOf(segments) {
    const count = segments.length / 4;
    const edges = new Float32Array(16 * count), corners = new Int8Array(8 * count), indices = new Uint32Array(6 * count);
    for (let e = 0; e < count; ++e) {
        for (let k = 0; k < 4; ++k) edges.set(segments.subarray(4 * e, 4 * e + 4), 16 * e + 4 * k);
        corners.set([0, -1, 0, 1, 1, -1, 1, 1], 8 * e);
        indices.set([4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 1, 4 * e + 3, 4 * e + 2], 6 * e);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("edge", new BufferAttribute(edges, 4));
    geometry.setAttribute("corner", new BufferAttribute(corners, 2));
    geometry.setIndex(new BufferAttribute(indices, 1));
    return geometry;
}

export class OutlineDrawing {
    constructor(body, points, shared) {
        this.body = body;
        this.triangles = body.triangles;
        this.material = new ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, glslVersion: GLSL3, transparent: true,
            depthTest: false, depthWrite: false,
            uniforms: { ...points.uniforms, viewport: shared.viewport, pixels: { value: body.triangles ? 2.4 : 1.6 }, ink: shared.ink },
        });
        this.object = new Mesh(geometryOf(segmentsOf(body)), this.material);
        this.object.frustumCulled = false;
        this.object.renderOrder = 10;
    }

    /** Other triangles, where the body has torn. @param {Int32Array} triangles */
    showTriangles(triangles) {
        if (areEqual(triangles, this.triangles)) return;
        this.triangles = triangles;
        this.object.geometry.dispose();
        this.object.geometry = geometryOf(edgesOf(triangles, this.body.vertexCount));
    }

    dispose() {
        this.object.geometry.dispose();
        this.material.dispose();
    }
}
