/** Gravity and wind. */
import { h, section, slider, vectorInput } from "./dom.mjs";

export class ForcesPanel {
    /** @param {{gravity: (v: number[]) => void, wind: (v: number[]) => void}} on */
    constructor(on) {
        this.gravity = vectorInput("Gravity", "m/s\u00b2", [0, -9.81, 0], on.gravity);
        this.speed = slider({
            label: "Wind, m/s", min: 0, max: 15, step: 0.1, value: 0, text: (x) => x.toFixed(1), input: () => this.#sendWind(on),
        });
        this.heading = slider({
            label: "From, degrees", min: 0, max: 355, step: 5, value: 0, text: (x) => `${x}\u00b0`, input: () => this.#sendWind(on),
        });
        this.element = section("Forces", false, this.gravity.element, this.speed.element, this.heading.element,
            h("p", {}, "Wind replaces that of the scene until the scene changes it.")).element;
    }

    #sendWind(on) {
        // Until a speed is set the wind is the scene's, and a heading alone must not still it.
        this.isBlowing ||= this.speed.value > 0;
        if (!this.isBlowing) return;
        const angle = (this.heading.value * Math.PI) / 180, speed = this.speed.value;
        // 0 degrees blows along x, as the wind of most scenes.
        on.wind([speed * Math.cos(angle), 0, -speed * Math.sin(angle)]);
    }

    /** @param {number[]} gravity of the scene */
    open(gravity) {
        this.gravity.set(gravity);
        this.speed.set(0);
        this.heading.set(0);
        this.isBlowing = false;
    }
}
