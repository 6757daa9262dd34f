/** Small helpers for elements. */

/**
 * @param {string} tag @param {Record<string, any>} [attributes] `on...` are listeners, `class` and others are attributes
 * @param {...(Node|string|null|undefined|false)} children
 * @returns {any}
 */
export function h(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (value === null || value === undefined || value === false) continue;
        if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
        else element.setAttribute(name, value === true ? "" : String(value));
    }
    element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
    return element;
}

let nextId = 1;
export const newId = (prefix) => `${prefix}-${nextId++}`;

/** Set a text only if it differs, so that screen readers and layout are not disturbed. */
export function setText(element, text) {
    if (element.textContent !== text) element.textContent = text;
}

/** @param {number} x @param {number} [digits] significant ones */
export function number(x, digits = 3) {
    if (x === 0) return "0";
    if (!Number.isFinite(x)) return String(x);
    const size = Math.abs(x);
    if (size >= 1e5 || size < 1e-4) return x.toExponential(Math.max(0, digits - 1));
    return x.toFixed(Math.max(0, Math.min(6, digits - 1 - Math.floor(Math.log10(size)))));
}

/** Whole numbers with thin spaces between thousands. */
export function count(x) {
    return String(x).replace(/\B(?=(\d{3})+$)/g, "\u2009");
}

/** A collapsible section of the panel. @returns {{element: HTMLDetailsElement, body: HTMLElement, brief: HTMLElement}} */
export function section(title, isOpen, ...children) {
    const brief = h("span", { class: "brief" });
    const body = h("div", { class: "section" }, ...children);
    const element = h("details", { open: isOpen }, h("summary", {}, h("span", {}, title), brief), body);
    return { element, body, brief };
}

/**
 * A slider with label and value.
 * @param {{label: string, min: number, max: number, step: number|"any", value: number, text: (x: number) => string,
 *          input?: (x: number) => void, change?: (x: number) => void}} options
 */
export function slider(options) {
    const id = newId("slider");
    const output = h("output", { for: id });
    const range = h("input", { type: "range", id, min: options.min, max: options.max, step: options.step, value: options.value });
    const show = () => {
        setText(output, options.text(range.valueAsNumber));
        range.setAttribute("aria-valuetext", options.text(range.valueAsNumber));
    };
    range.addEventListener("input", () => {
        show();
        options.input?.(range.valueAsNumber);
    });
    range.addEventListener("change", () => options.change?.(range.valueAsNumber));
    show();
    const element = h("div", { class: "row" }, h("label", { for: id }, options.label), range, output);
    const set = (value) => {
        range.value = value;
        show();
    };
    return { element, range, set, get value() { return range.valueAsNumber; } };
}

/**
 * One of a few choices.
 * @param {string} label for screen readers @param {[string, string][]} choices value and text
 * @param {string} value @param {(value: string) => void} change
 */
export function segments(label, choices, value, change) {
    const name = newId("choice");
    const inputs = choices.map(([choice, text, hint]) => {
        const input = h("input", { type: "radio", name, value: choice, checked: choice === value, onchange: () => change(choice) });
        return { input, label: h("label", { title: hint }, input, h("span", {}, text)) };
    });
    const element = h("fieldset", { class: "segments" }, h("legend", { class: "hidden-text" }, label), ...inputs.map((i) => i.label));
    const set = (next) => {
        for (const { input } of inputs) input.checked = input.value === next;
    };
    const enable = (choice, isEnabled) => {
        for (const { input } of inputs) if (input.value === choice) input.disabled = !isEnabled;
    };
    return { element, set, enable, get value() { return inputs.find(({ input }) => input.checked)?.input.value; } };
}

/** Three numbers. @param {(value: number[]) => void} change */
export function vectorInput(label, unit, value, change) {
    const inputs = ["x", "y", "z"].map((axis, k) => h("input", {
        type: "number", step: "any", value: number(value[k]), "aria-label": `${label}, ${axis}, ${unit}`,
        onchange: () => {
            const numbers = inputs.map((input) => input.valueAsNumber);
            if (numbers.every(Number.isFinite)) change(numbers);
        },
    }));
    const set = (next) => inputs.forEach((input, k) => (input.value = number(next[k])));
    return {
        element: h("div", {}, h("div", { class: "note" }, `${label}, ${unit}`), h("div", { class: "vector" }, ...inputs)),
        set,
    };
}

/** A colour that the style defines, for canvases. */
export function styleColour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
