/** Keys, and the dialog that lists them. */
import { h } from "./dom.mjs";

const KEYS = [
    ["Space", "play or pause"], [".", "one step"], ["R", "start again"], ["Arrows", "orbit"], ["Shift + arrows", "pan"],
    ["+ and -", "zoom"], ["0", "show all"], ["1 to 4", "speed 1, 1/2, 1/4, 1/10"], ["D, O, B", "pointer drags, orbits, brushes"],
    ["Ctrl + Z, Ctrl + Y", "undo and redo a stroke"], ["?", "this list"],
];

/** Elements that use keys themselves. */
const TAKES_KEYS = "input, select, textarea, button, summary, dialog, [role=region]";

export class Keyboard {
    /** @param {HTMLDialogElement} dialog @param {Record<string, Function>} on */
    constructor(dialog, on) {
        this.dialog = dialog;
        dialog.append(h("h2", { id: "help-title" }, "Keys and pointer"),
            h("dl", {}, ...KEYS.flatMap(([key, what]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, what)])),
            h("p", { class: "note", style: "margin-bottom:14px" }, "Drag a vertex or a collider to move it; empty space orbits, the right button or ",
                "two fingers pan, the wheel or a pinch zooms. A held vertex stays with the pointer until you let go."),
            h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close")));
        addEventListener("keydown", (event) => this.#key(event, on));
    }

    help() {
        this.dialog.showModal();
    }

    #key(event, on) {
        if (this.dialog.open || event.altKey) return;
        const isControl = event.target instanceof Element && event.target.matches(TAKES_KEYS);
        if (event.ctrlKey || event.metaKey) {
            const key = event.key.toLowerCase();
            if (isControl && event.target.matches("input[type=number]")) return;
            if (key === "z") this.#do(event, event.shiftKey ? on.redo : on.undo);
            else if (key === "y") this.#do(event, on.redo);
            return;
        }
        if (isControl && (event.target.matches("input, select") || event.key === " " || event.key === "Enter")) return;
        const orbit = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (orbit && !event.target.matches?.("[role=region]")) return this.#do(event, () => (event.shiftKey ? on.pan : on.orbit)(...orbit));
        const action = {
            " ": on.toggle, ".": on.step, r: on.reset, R: on.reset, "+": () => on.zoom(1 / 1.15), "=": () => on.zoom(1 / 1.15),
            "-": () => on.zoom(1.15), 0: on.frame, "?": () => this.help(), 1: () => on.speed("1"), 2: () => on.speed("0.5"),
            3: () => on.speed("0.25"), 4: () => on.speed("0.1"), d: () => on.tool("drag"), o: () => on.tool("orbit"), b: () => on.tool("brush"),
        }[event.key];
        if (action) this.#do(event, action);
    }

    #do(event, action) {
        event.preventDefault();
        action?.();
    }
}
