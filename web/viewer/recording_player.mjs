/** Frames of a `.wisp` recording, packed like those of a simulation. */
import { BufferPool, paddedLength } from "./buffer_pool.mjs";
import { trianglesOf } from "./surface_topology.mjs";

export class RecordingPlayer {
    constructor(recording) {
        this.recording = recording;
        this.pool = new BufferPool();
        this.bodies = recording.bodies.map((body) => ({
            ...body,
            triangles: body.triangles ? Int32Array.from(body.triangles) : null,
            offsets: body.offsets ? Int32Array.from(body.offsets) : null,
        }));
    }

    describe() {
        const count = this.recording.frameCount;
        const times = Array.from({ length: count }, (_, frame) => this.#timeOf(frame));
        return { bodies: this.bodies, frameCount: count, times };
    }

    #timeOf(frame) {
        this.recording.seek(frame);
        return this.recording.time;
    }

    /** @param {number} index @returns {{frame: object, transfer: ArrayBuffer[]}} */
    seek(index) {
        this.recording.seek(index);
        const points = this.bodies.map((body) => {
            const array = this.pool.take(paddedLength(body.vertexCount, 3));
            array.set(this.recording.points(body));
            return array;
        });
        const frame = {
            step: index, time: this.recording.time, points, triangles: trianglesOf(this.recording, this.bodies), values: points.map(() => null), looks: null,
            stepMs: 0, profile: [], counters: null, hashes: [], largest: 0, strokes: null, refused: [], log: [],
        };
        return { frame, transfer: points.map((array) => array.buffer) };
    }
}
