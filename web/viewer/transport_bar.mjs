/** Play, step, start again, slow motion, tools; for a recording a slider over its frames. */
import { h, number, segments, setText } from "./dom.mjs";

const ICONS = {
    play: "M6 4.2v11.6a.8.8 0 0 0 1.2.7l9.6-5.8a.8.8 0 0 0 0-1.4L7.2 3.5A.8.8 0 0 0 6 4.2z",
    pause: "M5.5 3.5h3v13h-3zM11.5 3.5h3v13h-3z",
    step: "M4 4.2v11.6a.8.8 0 0 0 1.2.7L13 11v5h2.5V4H13v5L5.2 3.5A.8.8 0 0 0 4 4.2z",
    reset: "M10 3.5a6.5 6.5 0 1 0 6.3 8.1l-2-.5A4.5 4.5 0 1 1 10 5.5c1.2 0 2.3.5 3.1 1.300L10.9 9H17V3l-2.4 2.4A6.5 6.5 0 0 0 10 3.5z",
};

function icon(name) {
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.setAttribute("viewBox", "0 0 20 20");
    svg.setAttribute("aria-hidden", "true");
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("d", ICONS[name]);
    svg.append(path);
    return svg;
}

function iconButton(name, label, key, onclick) {
    return h("button", { type: "button", class: "icon", "aria-label": label, title: `${label} (${key})`, onclick }, icon(name));
}

export class TransportBar {
    #isPlaying = false;

    /**
     * @param {HTMLElement} element
     * @param {{toggle: Function, step: Function, reset: Function, speed: (s: number) => void, tool: (t: string) => void,
     *          seek: (frame: number) => void}} on
     */
    constructor(element, on) {
        this.element = element;
        this.playButton = iconButton("play", "Play", "space", on.toggle);
        this.stepButton = iconButton("step", "Step", "full stop", on.step);
        this.resetButton = iconButton("reset", "Start again", "R", on.reset);
        this.speed = segments("Speed", [["1", "1"], ["0.5", "1/2"], ["0.25", "1/4"], ["0.1", "1/10"]], "1", (s) => on.speed(Number(s)));
        this.tools = segments("Pointer", [
            ["drag", "Drag", "Drag vertices and colliders; empty space orbits"],
            ["orbit", "Orbit", "The pointer only moves the camera"],
            ["brush", "Brush", "Point at frozen hair"],
        ], "drag", on.tool);
        this.clock = h("span", { class: "clock" });
        this.scrub = h("input", {
            type: "range", class: "scrub", min: 0, max: 0, step: 1, value: 0, "aria-label": "Frame of the recording",
            oninput: () => on.seek(this.scrub.valueAsNumber), hidden: true,
        });
        this.divider = h("span", { class: "divider" });
        element.append(this.playButton, this.stepButton, this.resetButton, this.scrub, this.speed.element, this.clock, this.divider,
            this.tools.element);
    }

    /** @param {{frameCount: number|null, hasBrush: boolean}} what the page shows */
    open({ frameCount, hasBrush }) {
        const isRecording = frameCount !== null;
        this.element.hidden = false;
        this.scrub.hidden = !isRecording;
        this.scrub.max = String(Math.max(0, (frameCount ?? 1) - 1));
        this.divider.hidden = this.tools.element.hidden = isRecording;
        this.tools.enable("brush", hasBrush);
        const brush = [...this.tools.element.querySelectorAll("label")].at(-1);
        brush.hidden = !hasBrush;
    }

    /** @param {{step: number, time: number, isPlaying: boolean, rate: number|null}} state */
    update({ step, time, isPlaying, rate }, isRecording) {
        if (isPlaying !== this.#isPlaying) {
            this.#isPlaying = isPlaying;
            this.playButton.replaceChildren(icon(isPlaying ? "pause" : "play"));
            const label = isPlaying ? "Pause" : "Play";
            this.playButton.setAttribute("aria-label", label);
            this.playButton.title = `${label} (space)`;
        }
        const slower = rate !== null && isPlaying ? `, ${number(rate, 2)}\u00d7 real time` : "";
        setText(this.clock, `${time.toFixed(2)} s, ${isRecording ? "frame" : "step"} ${step}${slower}`);
        if (isRecording && document.activeElement !== this.scrub) this.scrub.value = String(step);
        this.scrub.setAttribute("aria-valuetext", `frame ${step}, ${time.toFixed(2)} seconds`);
    }
}
