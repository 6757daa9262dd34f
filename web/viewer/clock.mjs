/**
 * Time of the page. A step is always the scene's own dt, whatever the screen does: this clock says which time to show and how many
 * steps are due, and the picture is interpolated between the two frames around it.
 */

/** After a longer pause of the browser, time goes on from where it was instead of catching up. */
const MAX_LAPSE = 0.1;

export class Clock {
    /** s of the scene, shown now */
    shown = 0;
    speed = 1;
    isPlaying = false;
    #last = null;

    /** @param {number} time s of the scene */
    reset(time) {
        this.shown = time;
        this.#last = null;
    }

    /**
     * @param {number} now ms, of the screen's frame
     * @param {number} limit s of the scene: the last frame that has arrived; what is not there cannot be shown
     */
    tick(now, limit) {
        const lapse = this.#last === null ? 0 : Math.min(MAX_LAPSE, (now - this.#last) / 1000);
        this.#last = now;
        if (this.isPlaying) this.shown = Math.min(this.shown + lapse * this.speed, limit);
    }

    pause() {
        this.isPlaying = false;
    }

    play() {
        this.isPlaying = true;
        this.#last = null;
    }
}
