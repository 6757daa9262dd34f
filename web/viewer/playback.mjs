/** A recording that plays: frames come from the worker by number, a few ahead of the time that is shown. */
import { Clock } from "./clock.mjs";
import { Engine } from "./engine.mjs";
import { FrameQueue } from "./frame_queue.mjs";

const AHEAD = 3;

export class Playback {
    #engine;
    #queue = new FrameQueue();
    #next = 0; // the frame that is asked for next
    #inFlight = 0;
    #dropped = 0; // frames under way that a jump has made useless

    clock = new Clock();
    bodies = [];
    frameCount = 0;
    /** @type {number[]} s of each frame */
    times = [];
    version = "";

    /** @param {{frame: Function, change: Function, failed: Function}} on */
    constructor(on) {
        this.on = on;
        this.#engine = new Engine({ frame: (frame) => this.#frame(frame), failed: (message) => this.#fail(message) });
    }

    #fail(message) {
        this.clock.pause();
        this.on.failed(message);
        this.on.change();
    }

    /** @param {Uint8Array} bytes of a `.wisp` file */
    async open(bytes) {
        this.version = await this.#engine.load();
        const recording = await this.#engine.ask("openRecording", { bytes });
        this.bodies = recording.bodies;
        this.frameCount = recording.frameCount;
        this.times = recording.times;
        this.seek(0);
    }

    /** Jump to a frame. @param {number} index */
    seek(index) {
        const frame = Math.max(0, Math.min(this.frameCount - 1, index));
        this.#dropped += this.#inFlight;
        this.#inFlight = 0;
        this.#queue.clear();
        this.#next = frame;
        this.clock.reset(this.times[frame]);
        this.#request();
    }

    #request() {
        const frame = this.#next++;
        ++this.#inFlight;
        const failed = (error) => this.#fail(error.message);
        this.#engine.recycle(this.#queue.takeSpent());
        this.#engine.ask("seek", { frame }).catch(failed);
    }

    #frame(frame) {
        if (this.#dropped > 0) {
            --this.#dropped;
            return;
        }
        --this.#inFlight;
        this.#queue.push(frame);
        this.on.frame(frame);
    }

    play() {
        if (this.shownFrame >= this.frameCount - 1) this.seek(0);
        this.clock.play();
        this.on.change();
    }

    pause() {
        this.clock.pause();
        this.on.change();
    }

    step() {
        this.pause();
        this.seek(this.shownFrame + 1);
    }

    /** The last frame at or before the time that is shown. */
    get shownFrame() {
        let frame = 0;
        while (frame + 1 < this.frameCount && this.times[frame + 1] <= this.clock.shown + 1e-9) ++frame;
        return frame;
    }

    /** @param {number} now ms @returns {{from: object, to: object, mix: number}|null} */
    tick(now) {
        while (this.clock.isPlaying && this.#next < this.frameCount && this.#inFlight + this.#queue.count < AHEAD) this.#request();
        if (this.#queue.count === 0) return null;
        this.clock.tick(now, this.#queue.limit(Infinity));
        if (this.clock.isPlaying && this.shownFrame >= this.frameCount - 1) this.pause();
        const [from, to] = this.#queue.around(this.clock.shown, Infinity);
        const span = to.time - from.time;
        return { from, to, mix: span > 0 ? Math.min(1, Math.max(0, (this.clock.shown - from.time) / span)) : 1 };
    }

    get state() {
        return { step: this.shownFrame, time: this.clock.shown, isPlaying: this.clock.isPlaying, hasFailed: false };
    }

    close() {
        this.#engine.stop();
    }
}
