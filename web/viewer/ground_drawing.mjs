/** A plane as a soft grid that fades into the background and takes shadows. */
import { DoubleSide, GLSL3, Mesh, PlaneGeometry, Quaternion, ShaderMaterial, Vector3 } from "three";
import { LIGHT } from "./glsl.mjs";

const VERTEX = /* glsl */ `
out vec3 world;
out vec2 flatPlace;
uniform float size;
void main() {
    vec4 w = modelMatrix * vec4(position * size, 1.0);
    flatPlace = position.xy * size;
    world = w.xyz;
    gl_Position = projectionMatrix * viewMatrix * w;
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
${LIGHT}
in vec3 world;
in vec2 flatPlace;
uniform float size, cell;
uniform vec4 line;
uniform float shade;
uniform vec3 focus;
out vec4 colour;
float grid(float spacing) {
    vec2 at = flatPlace / spacing, width = fwidth(at);
    vec2 near = abs(fract(at - 0.5) - 0.5);
    vec2 lines = 1.0 - smoothstep(width * 0.4, width * 1.4, near);
    // Where lines come closer than pixels they turn into an even tone instead of a pattern.
    vec2 faint = clamp(1.0 - 2.5 * width, 0.0, 1.0);
    return max(lines.x * faint.x, lines.y * faint.y);
}
void main() {
    float fade = 1.0 - smoothstep(0.08, 0.5, length(world - focus) / size);
    float fine = 0.45 * grid(cell), coarse = grid(10.0 * cell);
    float ink = max(fine, coarse) * line.a * fade;
    float dark = (1.0 - shadowAt(world, 0.0006)) * shade * fade;
    float alpha = ink + dark * (1.0 - ink);
    colour = vec4(alpha > 0.0 ? line.rgb * ink / alpha : vec3(0.0), alpha);
}`;

export class GroundDrawing {
    /**
     * @param {Vector3} point @param {Vector3} normal @param {number} radius of the scene, m
     * @param {Vector3} focus middle of the scene: the grid is strongest below it
     */
    constructor(point, normal, radius, focus, shared) {
        const cell = 10 ** Math.round(Math.log10(radius * 0.25));
        this.material = new ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, glslVersion: GLSL3, transparent: true, depthWrite: false,
            uniforms: {
                ...shared, size: { value: radius * 16 }, cell: { value: cell }, line: shared.line, shade: shared.shade,
                focus: { value: new Vector3() },
            },
        });
        this.object = new Mesh(new PlaneGeometry(2, 2), this.material);
        const n = normal.clone().normalize();
        if (n.y < 0) n.negate();
        this.object.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), n));
        // The grid's middle is below the scene, on a line of the grid.
        const below = focus.clone().addScaledVector(n, -focus.clone().sub(point).dot(n));
        const snap = (x) => Math.round(x / (10 * cell)) * 10 * cell;
        if (Math.abs(n.y) > 0.99) below.set(snap(below.x), below.y, snap(below.z));
        this.object.position.copy(below);
        this.object.frustumCulled = false;
        this.object.renderOrder = -1;
        this.material.uniforms.focus.value.copy(below);
    }

    dispose() {
        this.object.geometry.dispose();
        this.material.dispose();
    }
}
