/** The brush for frozen hair: parameters of the next commands, undo and redo, and the scene with all of them as a file. */
import { h, number, section, setText, slider } from "./dom.mjs";

const logarithmic = (low, high) => ({
    to: (x) => low * (high / low) ** x,
    from: (value) => Math.log(Math.max(low, value) / low) / Math.log(high / low),
});
const millimetres = (x) => `${number(1000 * x, 2)} mm`;

export class EditorPanel {
    /** @param {{climate: (temperature: number, wetness: number) => Promise<number>, undo: Function, redo: Function, save: Function}} on */
    constructor(on) {
        this.on = on;
        this.rows = {};
        this.undo = h("button", { type: "button", onclick: () => on.undo(), disabled: true }, "Undo");
        this.redo = h("button", { type: "button", onclick: () => on.redo(), disabled: true }, "Redo");
        this.save = h("button", { type: "button", class: "primary", onclick: () => on.save() }, "Save scene");
        this.cost = h("p", { class: "note" }, "");
        this.count = h("p", { class: "note", role: "status" }, "");
        this.sliders = h("div", { class: "section", style: "padding:0" });
        const built = section("Frozen hair", true,
            h("p", {}, "With the brush, press on the hair: strands within its radius turn towards that point and freeze. Strokes add up."),
            this.sliders, h("div", { class: "line" }, this.undo, this.redo, h("span", { class: "grow" }), this.save), this.count, this.cost);
        this.element = built.element;
        this.brief = built.brief;
        this.element.hidden = true;
    }

    /** @param {object|null} values of frozen hair, as the engine gives them */
    open(values) {
        this.element.hidden = !values;
        if (!values) return;
        this.values = { ...values };
        const size = values.reach || 0.1;
        const lengths = logarithmic(size / 20, size * 8), clumps = logarithmic((values.clumpRadius || 0.01) / 10, (values.clumpRadius || 0.01) * 10);
        const stiffness = logarithmic(0.1, 1000);
        const rows = [
            ["reach", "Brush radius", lengths, millimetres],
            ["bendStiffness", "Freeze stiffness", stiffness, (x) => number(x, 2)],
            ["intensity", "Intensity x", null, (x) => x.toFixed(2), 0, 1],
            ["clumpRadius", "Clump radius h", clumps, millimetres],
            ["temperature", "Temperature", null, (x) => `${x.toFixed(0)} \u00b0C`, -40, 20],
            ["wetness", "Wetness", null, (x) => `${(100 * x).toFixed(0)} %`, 0, 1],
        ].filter(([key]) => this.#isUsed(key, values));
        this.sliders.replaceChildren(...rows.map(([key, label, scale, text, min, max]) => {
            const to = scale?.to ?? ((x) => x), from = scale?.from ?? ((x) => x);
            const row = slider({
                label, min: min ?? 0, max: max ?? 1, step: "any", value: from(values[key]), text: (x) => text(to(x)),
                input: (x) => {
                    this.values[key] = to(x);
                    if (key === "temperature" || key === "wetness") this.#followClimate();
                },
            });
            this.rows[key] = { set: (value) => row.set(from(value)) };
            return row.element;
        }));
    }

    /** A parameter of a stage that the scene leaves out would do nothing. */
    #isUsed(key, values) {
        if (key === "reach" || key === "intensity") return values.aligns;
        return key === "clumpRadius" ? values.clumps : values.freezes;
    }

    /** The climate sets the stiffness, as it does in a scene. */
    async #followClimate() {
        const stiffness = await this.on.climate(this.values.temperature, this.values.wetness);
        this.values.bendStiffness = this.values.stretchStiffness = stiffness;
        this.rows.bendStiffness?.set(stiffness);
    }

    /** Parameters of the next command. */
    get parameters() {
        const { intensity, reach, stretchStiffness, bendStiffness, clumpRadius } = this.values;
        return { intensity, reach, stretchStiffness, bendStiffness, clumpRadius };
    }

    get radius() {
        return this.values?.reach ?? 0;
    }

    /** @param {{commands: number, canUndo: boolean, canRedo: boolean}} strokes */
    update(strokes) {
        this.undo.disabled = !strokes.canUndo;
        this.redo.disabled = !strokes.canRedo;
        setText(this.count, `${strokes.commands} command${strokes.commands === 1 ? "" : "s"}`);
    }

    /** @param {number} ms of the step that carried a command out */
    showCost(ms) {
        setText(this.cost, `Last command: ${ms.toFixed(1)} ms`);
        setText(this.brief, `${ms.toFixed(1)} ms per command`);
    }
}
