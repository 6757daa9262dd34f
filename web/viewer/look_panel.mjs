/** Colours by a value, their legend, and the theme. */
import { mapGradient, niceAbove } from "./colour_map.mjs";
import { h, section, segments, setText } from "./dom.mjs";

const UNITS = {
    strain: { title: "Strain of edges, %", factor: 100 },
    speed: { title: "Speed, m/s", factor: 1 },
};

export class LookPanel {
    /** The value at the end of the colour map, in the value's own unit. */
    #top = 0;
    #what = "none";

    /**
     * @param {HTMLElement} legend
     * @param {{colour: (what: string|null) => void, theme: (name: string) => void}} on
     */
    constructor(legend, on) {
        this.legend = legend;
        this.title = h("span");
        this.low = h("span", {}, "0");
        this.high = h("span");
        legend.append(this.title, h("div", { class: "map", style: `background:${mapGradient()}` }), h("div", { class: "ends" }, this.low, this.high));
        this.choice = segments("Colour by", [["none", "Body"], ["strain", "Strain"], ["speed", "Speed"]], "none", (what) => {
            this.#what = what;
            this.#top = 0;
            on.colour(what === "none" ? null : what);
            this.#show();
        });
        this.theme = segments("Theme", [["system", "System"], ["light", "Light"], ["dark", "Dark"]], "system", on.theme);
        this.element = section("Appearance", false,
            h("div", { class: "line" }, h("span", { class: "note grow" }, "Colour by"), this.choice.element),
            h("div", { class: "line" }, h("span", { class: "note grow" }, "Theme"), this.theme.element)).element;
        this.#show();
    }

    /** @param {object[]} bodies */
    open(bodies) {
        for (const what of ["strain", "speed"]) this.choice.enable(what, bodies.some((body) => body.has?.[what]));
        this.restart();
    }

    restart() {
        this.#top = 0;
        this.#show();
    }

    /** The scale only grows, so that colours do not flicker. @param {object} frame */
    add(frame) {
        if (this.#what === "none" || !(frame.largest > 0) || frame.largest <= this.#top) return;
        this.#top = niceAbove(frame.largest);
        this.#show();
    }

    /** From a value to its place in the map; 0 shows no values. */
    get scale() {
        return this.#what === "none" ? 0 : this.#top > 0 ? 1 / this.#top : 1;
    }

    #show() {
        this.legend.hidden = this.#what === "none";
        if (this.#what === "none") return;
        const { title, factor } = UNITS[this.#what];
        setText(this.title, title);
        const high = this.#top > 0 ? String(+(this.#top * factor).toPrecision(3)) : "";
        setText(this.high, high);
        this.legend.setAttribute("aria-label", `Legend: ${title}, from 0 to ${high}`);
    }
}
