/** Where the time of a step goes: a stacked bar of its passes against the time of a picture. */
import { h, number, section, setText } from "./dom.mjs";

const PICTURE_MS = 1000 / 60;
const MAX_PASSES = 7;
/** Part that a new measurement has in what is shown: about half a second at 60 steps per second. */
const SMOOTHING = 0.06;
const WARM_UP = 5; // steps
/** Counters of work done; the others tell of limits reached and failures. */
const WORK = new Set(["steps", "plans", "neighbours", "neighbour searches", "first order substeps"]);
/** Hues of equal lightness, far apart for neighbours. */
const COLOURS = ["#6d9eeb", "#e0a458", "#5fb3a1", "#d27a8f", "#9a8ad8", "#8fb55a", "#c98f6b", "#8b929b"];

export class CostPanel {
    /** @type {Map<string, number>} smoothed ms by pass */
    #passes = new Map();
    #total = 0;
    #count = 0;

    constructor() {
        this.total = h("span", {}, "-");
        this.bars = h("div", { class: "bars", role: "img", "aria-label": "Time of a step" });
        this.scale = h("div", { class: "scale", "aria-hidden": "true" });
        this.list = h("ul", { class: "passes" });
        this.rows = [];
        this.warning = h("p", { class: "warm", hidden: true });
        const built = section("Time of a step", true,
            h("div", { class: "big" }, this.total, h("small", {}, " ms of 16.7 ms")), this.bars, this.scale, this.list, this.warning);
        this.element = built.element;
        this.brief = built.brief;
    }

    reset() {
        this.#passes.clear();
        this.#total = this.#count = 0;
    }

    /** @param {object} frame */
    add(frame) {
        if (frame.stepMs <= 0) return;
        // The first steps compile the plan, and the browser still compiles the engine: they count until there are others.
        ++this.#count;
        const weight = this.#count <= WARM_UP ? 1 : Math.max(SMOOTHING, 1 / (this.#count - WARM_UP));
        const seen = new Set();
        for (const { pass, seconds } of frame.profile) {
            const before = this.#passes.get(pass) ?? 0;
            this.#passes.set(pass, before + weight * (1000 * seconds - before));
            seen.add(pass);
        }
        for (const [pass, ms] of this.#passes) if (!seen.has(pass)) this.#passes.set(pass, ms * (1 - weight));
        this.#total += weight * (frame.stepMs - this.#total);
    }

    get ms() {
        return this.#total;
    }

    get passes() {
        return [...this.#passes].sort((a, b) => b[1] - a[1]);
    }

    /** Write what was added. Called a few times per second. */
    update(counters) {
        const sorted = this.passes.filter(([, ms]) => ms > 0);
        const shown = sorted.slice(0, MAX_PASSES);
        const rest = Math.max(0, this.#total - shown.reduce((sum, [, ms]) => sum + ms, 0));
        if (rest > 0) shown.push(["other", rest]);
        const full = Math.max(PICTURE_MS, Math.ceil(this.#total / PICTURE_MS) * PICTURE_MS);
        while (this.rows.length < shown.length) this.#addRow();
        this.rows.forEach((row, k) => {
            const pass = shown[k];
            for (const part of [row.bar, row.swatch, row.name, row.ms]) part.hidden = !pass;
            if (!pass) return;
            row.bar.style.width = `${(100 * pass[1]) / full}%`;
            row.bar.title = `${pass[0]}: ${number(pass[1])} ms`;
            setText(row.name, pass[0]);
            setText(row.ms, pass[1].toFixed(pass[1] < 10 ? 2 : 1));
        });
        setText(this.total, this.#count > 0 ? this.#total.toFixed(this.#total < 10 ? 2 : 1) : "-");
        this.total.className = this.#total > PICTURE_MS ? "bad" : "";
        setText(this.brief, this.#count > 0 ? `${this.#total.toFixed(2)} ms` : "");
        this.bars.setAttribute("aria-label",
            `Time of a step: ${number(this.#total)} ms. ${shown.map(([pass, ms]) => `${pass} ${number(ms, 2)} ms`).join(", ")}.`);
        this.#updateScale(full);
        const lines = Object.entries(counters ?? {}).filter(([name]) => !WORK.has(name)).map(([name, n]) => `${name}: ${n}`);
        this.warning.hidden = lines.length === 0;
        setText(this.warning, lines.join(", "));
    }

    #addRow() {
        const colour = COLOURS[Math.min(this.rows.length, COLOURS.length - 1)];
        const bar = h("i", { style: `background:${colour}` }), swatch = h("i", { style: `background:${colour}` });
        const name = h("span"), ms = h("b");
        this.bars.append(bar);
        this.list.append(swatch, name, ms);
        this.rows.push({ bar, swatch, name, ms });
    }

    #updateScale(full) {
        const marks = Math.round(full / PICTURE_MS);
        const key = String(marks);
        if (this.scale.dataset.marks === key) return;
        this.scale.dataset.marks = key;
        const stride = Math.ceil(marks / 4);
        const spans = [];
        // The last label needs the space before it.
        for (let k = stride; k < 0.8 * marks; k += stride) {
            spans.push(h("span", { style: `left:${(100 * k) / marks}%` }, (k * PICTURE_MS).toFixed(1)));
        }
        spans.push(h("span", { style: "left:100%" }, `${full.toFixed(1)} ms`));
        this.scale.replaceChildren(...spans);
    }
}
