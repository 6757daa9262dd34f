/** A value over the last seconds of the scene. */
import { niceAbove } from "./colour_map.mjs";
import { styleColour } from "./dom.mjs";

const SPAN = 10; // s

export class StripChart {
    /** @type {{time: number, value: number}[]} */
    #samples = [];

    /** @param {HTMLCanvasElement} canvas @param {string} unit */
    constructor(canvas, unit) {
        this.canvas = canvas;
        this.unit = unit;
    }

    clear() {
        this.#samples.length = 0;
    }

    add(time, value) {
        this.#samples.push({ time, value });
        while (this.#samples[0].time < time - SPAN) this.#samples.shift();
    }

    draw() {
        const { canvas } = this, ratio = devicePixelRatio;
        const width = canvas.clientWidth, height = canvas.clientHeight;
        if (width === 0) return;
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
        const context = canvas.getContext("2d");
        context.scale(ratio, ratio);
        const samples = this.#samples;
        const largest = samples.reduce((m, s) => Math.max(m, s.value), 0);
        const top = largest > 0 ? niceAbove(largest) : 1;
        const bottomSpace = 16, plot = height - bottomSpace - 4;
        const end = Math.max(SPAN, samples.at(-1)?.time ?? 0);
        const x = (time) => ((time - end + SPAN) / SPAN) * width, y = (value) => 4 + plot * (1 - value / top);
        context.font = `11px ${getComputedStyle(canvas).fontFamily}`;
        context.strokeStyle = styleColour("--line");
        context.fillStyle = styleColour("--dim");
        context.lineWidth = 1;
        for (const part of [0, 0.5, 1]) {
            const at = Math.round(y(part * top)) + 0.5;
            context.beginPath();
            context.moveTo(0, at);
            context.lineTo(width, at);
            context.stroke();
        }
        context.fillText(`${+top.toPrecision(2)} ${this.unit}`, 2, y(top) + 12);
        context.fillText(`${(end - SPAN).toFixed(0)} s`, 2, height - 3);
        context.textAlign = "right";
        context.fillText(`${end.toFixed(0)} s`, width - 2, height - 3);
        if (samples.length < 2) return;
        context.strokeStyle = styleColour("--warm");
        context.lineWidth = 1.5;
        context.lineJoin = "round";
        context.beginPath();
        for (const { time, value } of samples) context.lineTo(x(time), y(value));
        context.stroke();
    }
}
