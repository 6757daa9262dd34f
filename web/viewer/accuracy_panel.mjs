/** What accuracy costs: the settings of the scene, the distance to a converged run, and the search for settings that meet an error. */
import { h, number, section, setText, slider } from "./dom.mjs";
import { StripChart } from "./strip_chart.mjs";

/** A setting with its unit of meaning, where its name alone would not say it. */
const HINTS = {
    substeps: "Parts that a step is cut into",
    iterations: "Projections of all constraints per substep",
    tethers: "Limits of the distance to the pins; help coarse settings",
    coarse_substeps: "Substeps of the coarse sheets that carry load; 0 is none",
};

function parameterText(parameter, value) {
    const isSwitch = parameter.values.length === 2 && parameter.values.includes(0) && parameter.values.includes(1);
    return isSwitch ? (value ? "on" : "off") : String(+value.toPrecision(3));
}

export class AccuracyPanel {
    /** @type {Map<string, object>} */
    #sliders = new Map();
    #parameters = [];
    #scene = null;

    /**
     * @param {{parameters: (values: object) => void, reference: (isOn: boolean) => void, tune: (error: number) => void, stopTune: () => void}} on
     */
    constructor(on) {
        this.on = on;
        this.toggle = h("input", { type: "checkbox", onchange: () => on.reference(this.toggle.checked) });
        this.distance = h("span", { class: "big" }, "-");
        this.lag = h("span", { class: "note" });
        this.canvas = h("canvas", { class: "strip", role: "img", "aria-label": "Distance to the reference over time" });
        this.chart = new StripChart(this.canvas, "mm");
        this.result = h("div", { class: "section", style: "padding:0" },
            h("div", { class: "line" }, this.distance, h("span", { class: "note grow" }, "from the reference (root mean square)")),
            this.canvas, this.lag);
        this.parameters = h("div", { class: "section", style: "padding:0" });
        this.own = h("button", { type: "button", onclick: () => this.#applyAll(this.#ownValues()) }, "Scene's own settings");
        this.#buildTune();
        const built = section("Accuracy", true,
            h("label", { class: "check" }, this.toggle, "Compare with a converged reference"),
            this.result, this.parameters, h("div", { class: "line" }, this.own), this.tune);
        this.element = built.element;
        this.brief = built.brief;
    }

    #buildTune() {
        this.target = h("input", { type: "number", min: 0, step: "any", value: 5, "aria-label": "Error to meet, millimetres" });
        this.find = h("button", { type: "submit", class: "primary" }, "Find");
        this.stop = h("button", { type: "button", hidden: true, onclick: () => this.on.stopTune() }, "Stop");
        this.progress = h("progress", { hidden: true, "aria-label": "Progress of the search" });
        this.answer = h("p", { class: "note", role: "status" });
        const submit = (event) => {
            event.preventDefault();
            const error = this.target.valueAsNumber;
            if (error > 0) this.on.tune(error / 1000);
            else this.showAnswer("The error must be above 0 mm.", "bad");
        };
        this.tune = h("form", { class: "section", style: "padding:0", onsubmit: submit, novalidate: true },
            h("div", { class: "line" }, h("span", {}, "Find me"), this.target, h("span", { class: "grow" }, "mm"), this.find, this.stop),
            this.progress, this.answer);
    }

    /** @param {object} scene @param {object} parameters @param {boolean} usesReference */
    open(scene, parameters, usesReference) {
        const isNew = scene !== this.#scene;
        this.#scene = scene;
        // Off, which the engine lists last, is at the left of a slider.
        this.#parameters = scene.parameters.map((parameter) => {
            return parameter.values.includes(0) ? { ...parameter, values: [...parameter.values].sort((a, b) => a - b) } : parameter;
        });
        this.element.hidden = scene.parameters.length === 0;
        if (isNew) {
            this.#buildParameters();
            this.showAnswer("");
        }
        for (const parameter of this.#parameters) {
            const row = this.#sliders.get(parameter.name), value = parameters[parameter.name] ?? parameter.value;
            row.set(parameter.values.indexOf(value));
            row.element.classList.toggle("changed", value !== parameter.value);
        }
        this.own.disabled = scene.parameters.every((parameter) => (parameters[parameter.name] ?? parameter.value) === parameter.value);
        this.toggle.checked = usesReference;
        this.result.hidden = !usesReference;
        this.chart.clear();
        setText(this.distance, "-");
        setText(this.brief, "");
    }

    #buildParameters() {
        this.#sliders.clear();
        const rows = this.#parameters.map((parameter) => {
            const key = parameter.name.split(".").at(-1);
            const row = slider({
                label: parameter.name.replaceAll(".", " ").replaceAll("_", " "),
                min: 0, max: parameter.values.length - 1, step: 1, value: parameter.values.indexOf(parameter.value),
                text: (i) => parameterText(parameter, parameter.values[i]),
                change: () => this.#applyAll(this.#values()),
            });
            row.element.title = HINTS[key] ?? "";
            this.#sliders.set(parameter.name, row);
            return row.element;
        });
        this.parameters.replaceChildren(...rows);
    }

    #values() {
        return Object.fromEntries(this.#parameters.map((parameter) => [parameter.name, parameter.values[this.#sliders.get(parameter.name).value]]));
    }

    #ownValues() {
        return Object.fromEntries(this.#parameters.map((parameter) => [parameter.name, parameter.value]));
    }

    #applyAll(values) {
        this.on.parameters(values);
    }

    /** @param {number} time s @param {number} distance m */
    add(time, distance) {
        this.chart.add(time, 1000 * distance);
    }

    /** @param {number|null} distance m @param {number} lag steps */
    update(distance, lag) {
        if (this.result.hidden) return;
        if (distance !== null) {
            const text = number(1000 * distance, 3);
            this.distance.replaceChildren(text, h("small", {}, " mm"));
            setText(this.brief, `${text} mm`);
            this.canvas.setAttribute("aria-label", `Distance to the reference over time, now ${text} millimetres`);
        }
        setText(this.lag, lag > 1 ? `The scene waits for the reference, ${lag} steps behind.` : "");
        if (this.element.open) this.chart.draw();
    }

    /** @param {boolean} isSearching */
    setSearching(isSearching) {
        this.find.hidden = isSearching;
        this.stop.hidden = this.progress.hidden = !isSearching;
        this.progress.removeAttribute("value");
        for (const row of this.#sliders.values()) row.range.disabled = isSearching;
        this.toggle.disabled = this.own.disabled = isSearching;
    }

    showProgress(runs, maxRuns) {
        this.progress.max = maxRuns;
        this.progress.value = runs;
        this.showAnswer(`Measured ${runs} of at most ${maxRuns} runs. The scene stands still meanwhile.`);
    }

    /** @param {string} text @param {""|"good"|"bad"} [tone] */
    showAnswer(text, tone = "") {
        this.answer.className = tone || "note";
        setText(this.answer, text);
    }
}
