/** What is under the pointer: the nearest vertex of the nearest body. Runs when a button goes down, not per picture. */
import { Matrix4, Vector3 } from "three";

/** Ray against triangle (Moeller, Trumbore 1997), both sides. @returns {number} distance along the ray, Infinity if it misses */
function hitTriangle(o, d, p, a, b, c) {
    const ax = p[3 * a], ay = p[3 * a + 1], az = p[3 * a + 2];
    const ux = p[3 * b] - ax, uy = p[3 * b + 1] - ay, uz = p[3 * b + 2] - az;
    const vx = p[3 * c] - ax, vy = p[3 * c + 1] - ay, vz = p[3 * c + 2] - az;
    const hx = d.y * vz - d.z * vy, hy = d.z * vx - d.x * vz, hz = d.x * vy - d.y * vx;
    const det = ux * hx + uy * hy + uz * hz;
    if (det === 0) return Infinity;
    const sx = o.x - ax, sy = o.y - ay, sz = o.z - az;
    const u = (sx * hx + sy * hy + sz * hz) / det;
    if (u < 0 || u > 1) return Infinity;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (d.x * qx + d.y * qy + d.z * qz) / det;
    if (v < 0 || u + v > 1) return Infinity;
    const t = (vx * qx + vy * qy + vz * qz) / det;
    return t > 0 ? t : Infinity;
}

function pickSurface(body, points, ray) {
    let best = null;
    const { origin, direction } = ray, t = body.triangles;
    for (let k = 0; k < t.length; k += 3) {
        const distance = hitTriangle(origin, direction, points, t[k], t[k + 1], t[k + 2]);
        if (distance < (best?.distance ?? Infinity)) best = { distance, triangle: k };
    }
    if (!best) return null;
    const at = origin.clone().addScaledVector(direction, best.distance);
    let vertex = -1, least = Infinity;
    for (let c = 0; c < 3; ++c) {
        const i = t[best.triangle + c];
        const d = (points[3 * i] - at.x) ** 2 + (points[3 * i + 1] - at.y) ** 2 + (points[3 * i + 2] - at.z) ** 2;
        if (d < least) [vertex, least] = [i, d];
    }
    return { vertex, distance: best.distance, point: at };
}

function pickStrand(body, points, view, reach) {
    const m = view.matrix.elements, near = view.near;
    let vertex = -1, nearest = Infinity;
    for (let i = 0; i < body.vertexCount; ++i) {
        const x = points[3 * i], y = points[3 * i + 1], z = points[3 * i + 2];
        const w = m[3] * x + m[7] * y + m[11] * z + m[15];
        if (w < near || w >= nearest) continue;
        const sx = ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w - view.x) * view.halfWidth;
        const sy = ((m[1] * x + m[5] * y + m[9] * z + m[13]) / w - view.y) * view.halfHeight;
        if (sx * sx + sy * sy < reach * reach) [vertex, nearest] = [i, w];
    }
    if (vertex < 0) return null;
    const point = new Vector3(points[3 * vertex], points[3 * vertex + 1], points[3 * vertex + 2]);
    return { vertex, distance: point.distanceTo(view.eye), point };
}

/**
 * @param {object[]} bodies @param {Float32Array[]} points
 * @param {import("three").PerspectiveCamera} camera @param {import("three").Raycaster} raycaster at the pointer
 * @param {{x: number, y: number, width: number, height: number, reach: number}} pointer place in [-1, 1], size of the picture and
 *        reach around the pointer in pixels
 * @param {(body: object) => boolean} accepts
 * @returns {{body: object, vertex: number, point: Vector3, distance: number}|null}
 */
export function pick(bodies, points, camera, raycaster, pointer, accepts) {
    const matrix = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const view = {
        matrix, near: camera.near, eye: camera.position, x: pointer.x, y: pointer.y,
        halfWidth: pointer.width / 2, halfHeight: pointer.height / 2,
    };
    let best = null;
    for (const body of bodies) {
        if (body.hidden || body.kind === "plane") continue;
        const found = body.triangles
            ? pickSurface(body, points[body.index], raycaster.ray)
            : body.offsets && pickStrand(body, points[body.index], view, pointer.reach);
        if (found && found.distance < (best?.distance ?? Infinity)) best = { body, ...found };
    }
    // A body in front hides those behind it, even if it cannot be taken itself.
    return best && accepts(best.body) ? best : null;
}
