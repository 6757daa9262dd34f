/** The page: what is shown, what the panels say, and what users do with it. */
import { Vector3 } from "three";
import { AccuracyPanel } from "./accuracy_panel.mjs";
import { CameraControl } from "./camera_control.mjs";
import { CostPanel } from "./cost_panel.mjs";
import { count, setText } from "./dom.mjs";
import { EditorPanel } from "./editor_panel.mjs";
import { ForcesPanel } from "./forces_panel.mjs";
import { FrameCost } from "./frame_cost.mjs";
import { HashPanel } from "./hash_panel.mjs";
import { Keyboard } from "./keyboard.mjs";
import { LookPanel } from "./look_panel.mjs";
import { PanelSheet } from "./panel_sheet.mjs";
import { PixelRatio } from "./pixel_ratio.mjs";
import { Playback } from "./playback.mjs";
import { Pointer } from "./pointer.mjs";
import { Search, sentenceOf } from "./search.mjs";
import { Session } from "./session.mjs";
import { Stage } from "./stage.mjs";
import { Theme } from "./theme.mjs";
import { TransportBar } from "./transport_bar.mjs";

/** ms between updates of numbers: faster ones cannot be read. */
const UPDATE_MS = 120;
/** Vertices up to which a reference runs from the start; it takes many times the steps. */
const REFERENCE_VERTICES = 600;

/** What tells one picture of the same view from another. */
const pictureOf = (shown) => `${shown.from.step} ${shown.to.step} ${shown.mix}`;

const byId = (id) => document.getElementById(id);

export class Viewer {
    /** @type {Session|null} */
    session = null;
    /** @type {Playback|null} */
    playback = null;
    shownPoints = null;
    frameCost = new FrameCost();
    pixels = new PixelRatio();
    #search = new Search();
    #looks = null; // of a frame that has arrived and is not drawn yet
    #lastUpdate = 0;
    #counters = null;
    #commands = 0;
    #isPreparing = false;
    #refused = new Set(); // bodies that cannot be held
    #isDirty = true;
    #drawn = "";
    #looped = 0; // ms, when the browser last asked for a picture
    #wasDrawn = false;
    #rate = { time: 0, at: 0, value: null };

    constructor() {
        const canvas = byId("canvas");
        this.stage = new Stage(canvas);
        this.camera = new CameraControl(this.stage, canvas);
        this.pointer = new Pointer(this, byId("view"), canvas);
        this.sheet = new PanelSheet(byId("panel"), byId("sheet-handle"), () => this.#resize());
        this.theme = new Theme((name) => {
            this.stage.setTheme(name);
            this.#isDirty = true;
        });
        this.#buildPanels();
        this.keyboard = new Keyboard(byId("help"), {
            toggle: () => this.toggle(), step: () => this.step(), reset: () => this.reset(), undo: () => this.undo(), redo: () => this.redo(),
            orbit: (x, y) => this.camera.orbit(x, y), pan: (x, y) => this.camera.pan(x, y), zoom: (f) => this.camera.zoom(f),
            frame: () => this.camera.frame(),
            speed: (s) => this.#chooseSpeed(s), tool: (t) => this.#chooseTool(t),
        });
        new ResizeObserver(() => this.#resize()).observe(byId("view"));
        this.#resize();
        requestAnimationFrame((now) => this.#loop(now));
    }

    #buildPanels() {
        this.bar = new TransportBar(byId("bar"), {
            toggle: () => this.toggle(), step: () => this.step(), reset: () => this.reset(), help: () => this.keyboard.help(),
            speed: (s) => (this.player.clock.speed = s), tool: (t) => this.#chooseTool(t), seek: (frame) => this.#seek(frame),
        });
        this.cost = new CostPanel();
        this.accuracy = new AccuracyPanel({
            parameters: (parameters) => this.#restart({ parameters }), reference: (usesReference) => this.#restart({ usesReference }),
            tune: (error) => this.#tune(error), stopTune: () => this.#search.stop(),
        });
        this.editor = new EditorPanel({
            climate: (temperature, wetness) => this.session.climate(this.#frozenBody, temperature, wetness), undo: () => this.undo(), redo: () => this.redo(),
            save: () => this.#save(),
        });
        this.hashPanel = new HashPanel();
        this.forces = new ForcesPanel({
            gravity: (value) => this.session.input({ type: "gravity", value }),
            wind: (value) => this.session.input({ type: "wind", value }),
        });
        this.look = new LookPanel(byId("legend"), {
            colour: (what) => {
                this.session?.setColour(what);
                this.#isDirty = true;
            }, theme: (choice) => this.theme.choose(choice),
        });
        this.look.theme.set(this.theme.choice);
        byId("sections").append(this.cost.element, this.accuracy.element, this.editor.element, this.forces.element, this.look.element,
            this.hashPanel.element);
    }

    /** Whatever plays: a scene or a recording. */
    get player() {
        return this.session ?? this.playback;
    }

    get bodies() {
        return this.player?.bodies ?? [];
    }

    // ---- opening ----

    /** @param {import("./data.mjs").PageData} data */
    async open(data) {
        this.#notice(null);
        this.#close();
        if (data.kind === "recording") await this.#openRecording(data);
        else await this.#openScene(data);
        setText(byId("title"), data.title);
        document.title = `${data.title} - Wisp`;
        byId("panel").hidden = false;
        this.#resize();
        this.camera.frame();
    }

    #close() {
        this.#search.stop();
        this.player?.close();
        this.session = this.playback = null;
        this.shownPoints = null;
    }

    async #openScene(data) {
        const session = new Session({
            frame: (frame) => this.#frame(frame), reference: (frame) => this.accuracy.add(frame.time, frame.distance),
            change: () => this.#changed(), failed: (message) => this.#notice(message),
        });
        try {
            await session.open(data.name, data.files, data.hashes);
            // Which bodies there are is known when the world is made.
            this.session = session;
            await session.start();
        } catch (error) {
            session.close();
            this.session = null;
            throw error;
        }
        this.#describe();
        const frozen = Object.values(session.frozen)[0] ?? null;
        this.editor.open(frozen);
        const standsStill = session.scene.parameters.length === 0 && frozen !== null;
        this.bar.open({ frameCount: null, hasBrush: frozen !== null });
        this.#chooseTool(frozen ? "brush" : "drag");
        this.forces.open(session.scene.gravity);
        this.look.open(session.bodies);
        for (const panel of [this.cost, this.forces, this.hashPanel]) panel.element.hidden = false;
        this.forces.element.hidden = standsStill;
        const vertices = this.#movingVertices();
        if (session.scene.parameters.length > 0 && vertices <= REFERENCE_VERTICES) await this.#restart({ usesReference: true });
        // Frozen hair has its shape after one step, and then waits for a command.
        if (standsStill) session.step();
        else session.play();
    }

    async #openRecording(data) {
        const playback = new Playback({
            frame: (frame) => this.#frame(frame), change: () => this.#changed(), failed: (message) => this.#notice(message),
        });
        this.playback = playback;
        try {
            await playback.open(data.files[data.name]);
        } catch (error) {
            playback.close();
            this.playback = null;
            throw error;
        }
        this.#describe();
        this.bar.open({ frameCount: playback.frameCount, hasBrush: false });
        this.editor.open(null);
        this.look.open([]);
        for (const panel of [this.cost, this.accuracy, this.forces, this.hashPanel]) panel.element.hidden = true;
        playback.play();
    }

    #movingVertices() {
        return this.bodies.reduce((sum, body) => sum + (body.moves ? body.vertexCount : 0), 0);
    }

    #describe() {
        const strands = this.bodies.reduce((sum, body) => sum + (body.hidden ? 0 : body.strandCount ?? 0), 0);
        const vertices = this.bodies.reduce((sum, body) => sum + (body.moves && !body.hidden ? body.vertexCount : 0), 0);
        const drawn = this.pixels.strands < 1 ? ` (1 in ${1 / this.pixels.strands} drawn: slow graphics)` : "";
        const parts = [strands > 0 ? `${count(strands)} strands${drawn}` : null, `${count(vertices)} vertices`, `Wisp ${this.player.version}`];
        setText(byId("subtitle"), parts.filter(Boolean).join(", "));
    }

    // ---- running ----

    async #restart(changes) {
        if (!this.session || this.#search.isRunning) return;
        this.#notice(null);
        this.pointer.release();
        const wasPlaying = this.session.clock.isPlaying;
        try {
            await this.session.start(changes);
            this.cost.reset();
            if (wasPlaying) this.session.play();
        } catch (error) {
            this.#notice(error.message);
        }
        this.accuracy.open(this.session.scene, this.session.parameters, this.session.usesReference);
    }

    /** A frame has arrived. @param {object} frame */
    #frame(frame) {
        if (frame.isFirst || !this.shownPoints) {
            if (!this.player) return;
            this.#looks = null;
            this.shownPoints = frame.points;
            this.#commands = 0;
            this.stage.setBodies(this.bodies, frame.points, this.session?.usesReference ?? false);
            this.stage.showStrands(this.pixels.strands);
            if (this.session) this.accuracy.open(this.session.scene, this.session.parameters, this.session.usesReference);
            this.look.restart();
        }
        if (frame.looks) this.#looks = frame;
        this.#isDirty = true;
        if (frame.notice ?? frame.log.at(-1)) this.#notice(frame.notice ?? frame.log.at(-1));
        if (frame.refused.length !== this.#refused.size) {
            this.#refused = new Set(frame.refused);
            this.pointer.release();
        }
        this.cost.add(frame);
        this.look.add(frame);
        this.#counters = frame.counters ?? this.#counters;
        if (!frame.strokes) return;
        this.editor.update(frame.strokes);
        if (frame.strokes.commands > this.#commands && frame.stepMs > 0) this.editor.showCost(frame.stepMs);
        this.#commands = frame.strokes.commands;
        this.pointer.commandDone();
    }

    #loop(now) {
        requestAnimationFrame((next) => this.#loop(next));
        const start = performance.now();
        if (this.#wasDrawn) this.#resolution(now - this.#looped);
        this.#wasDrawn = false;
        this.#looped = now;
        const shown = this.player?.tick(now);
        if (shown) {
            this.shownPoints = shown.to.points;
            if (this.#looks) this.stage.showLooks(this.#looks);
            this.#isDirty ||= this.#looks !== null;
            this.#looks = null;
            this.stage.show(shown, this.look.scale);
        }
        const hasMoved = this.camera.update();
        if (shown && (this.#isDirty || hasMoved || this.#drawn !== pictureOf(shown))) {
            this.stage.render();
            this.#drawn = pictureOf(shown);
            this.#isDirty = false;
            this.#wasDrawn = true;
        }
        if (now - this.#lastUpdate > UPDATE_MS) this.#updateNumbers(now);
        if (shown) this.frameCost.add(performance.now() - start);
    }

    #updateNumbers(now) {
        this.#lastUpdate = now;
        if (!this.player) return;
        const state = this.player.state;
        this.#measureRate(now, state);
        const clock = this.player.clock;
        const isSlow = this.#rate.value !== null && this.#rate.value < 0.93 * clock.speed;
        this.bar.update({ ...state, rate: this.session && (clock.speed !== 1 || isSlow) ? this.#rate.value : null }, this.playback !== null);
        if (!this.session) return;
        this.cost.update(this.#counters);
        this.accuracy.update(this.session.distance, state.followed === null ? 0 : state.step - state.followed);
        this.hashPanel.update(this.session.hashes);
    }

    #measureRate(now, state) {
        const rate = this.#rate, lapse = (now - rate.at) / 1000;
        if (!state.isPlaying || state.time < rate.time) Object.assign(rate, { value: null, at: now, time: state.time });
        else if (lapse > 1) Object.assign(rate, { value: (state.time - rate.time) / lapse, at: now, time: state.time });
    }

    #changed() {
        if (!this.player) return;
        const { step, isPlaying, hasFailed } = this.player.state;
        const unit = this.playback ? "frame" : "step";
        setText(byId("live"), hasFailed ? "Stopped." : isPlaying ? "Playing." : `Paused at ${unit} ${step}.`);
    }

    /** @param {string|null} message a sentence to show, or nothing */
    #notice(message) {
        byId("notice").hidden = message === null;
        setText(byId("notice"), message ?? "");
    }

    // ---- what users do ----

    toggle() {
        if (!this.player || this.#search.isRunning) return;
        if (this.player.clock.isPlaying) this.player.pause();
        else this.player.play();
    }

    step() {
        if (!this.#search.isRunning) this.player?.step();
    }

    reset() {
        if (this.playback) this.#seek(0);
        else this.#restart({});
    }

    #seek(frame) {
        this.playback.pause();
        this.playback.seek(frame);
    }

    #chooseSpeed(speed) {
        if (!this.player) return;
        this.bar.speed.set(speed);
        this.player.clock.speed = Number(speed);
    }

    #chooseTool(tool) {
        if (tool === "brush" && this.editor.element.hidden) return;
        this.bar.tools.set(tool);
        this.pointer.setTool(tool);
    }

    async #tune(error) {
        const { session } = this;
        if (!session || this.#search.isRunning) return;
        const wasPlaying = session.clock.isPlaying;
        // Times are only meaningful while nothing else computes.
        session.pause();
        this.accuracy.setSearching(true);
        this.accuracy.showAnswer("Runs the reference of the search first.");
        let found = null, failure = null;
        try {
            found = await this.#search.run(session.name, session.files, error, (runs, most) => this.accuracy.showProgress(runs, most));
        } catch (problem) {
            failure = problem.message;
        }
        this.accuracy.setSearching(false);
        if (session !== this.session) return;
        if (wasPlaying) session.play();
        if (found?.meetsTarget) await this.#restart({ parameters: found.parameters });
        this.accuracy.showAnswer(failure ?? (found ? sentenceOf(found, error) : "Stopped."), failure || found?.meetsTarget === false ? "bad" : found ? "good" : "");
    }

    // ---- frozen hair ----

    get brushRadius() {
        return this.editor.radius;
    }

    get #frozenBody() {
        return Number(Object.keys(this.session.frozen)[0]);
    }

    /** Strokes add up only in a scene that says so: at the first one, the scene starts again as such. */
    async beginStroke() {
        const { session } = this;
        if (!session.canComb) {
            this.#isPreparing = true;
            try {
                await session.start({ strokes: true });
            } catch (error) {
                this.#notice(error.message);
                return false;
            } finally {
                this.#isPreparing = false;
            }
        }
        session.input({ type: "stroke" });
        return true;
    }

    /** @param {object} body @param {number[]} cursor m */
    command(body, cursor) {
        const { session } = this;
        if (this.#isPreparing) return;
        session.input({ type: "command", body: body.index, value: cursor, values: this.editor.parameters });
        if (!session.clock.isPlaying) session.applyNow(1);
    }

    undo() {
        this.#travel("undo");
    }

    redo() {
        this.#travel("redo");
    }

    #travel(type) {
        if (!this.session || this.editor.element.hidden) return;
        this.session.input({ type });
        this.session.applyNow(0);
    }

    async #save() {
        try {
            const { text } = await this.session.saveScene();
            const name = this.session.name.split("/").at(-1).replace(/(\.[a-z]+)$/i, "_edited$1");
            const link = document.createElement("a");
            link.href = URL.createObjectURL(new Blob([text], { type: "application/yaml" }));
            link.download = name;
            link.click();
            setTimeout(() => URL.revokeObjectURL(link.href), 10000);
        } catch (error) {
            this.#notice(error.message);
        }
    }

    // ---- geometry ----

    /** Whether a body's vertices can be held. */
    canGrab(body) {
        return (body.moves || body.kind === "collider") && !body.isFrozenHair && !this.#refused.has(body.index);
    }

    /** @param {Vector3} point @returns {[number, number]} pixels from the view's corner */
    onScreen(point) {
        const p = point.clone().project(this.stage.camera), canvas = byId("canvas");
        return [((p.x + 1) / 2) * canvas.clientWidth, ((1 - p.y) / 2) * canvas.clientHeight];
    }

    /** @param {number} body @param {number} vertex @returns {Vector3} */
    vertex(body, vertex) {
        return new Vector3().fromArray(this.shownPoints[body], 3 * vertex);
    }

    /** On slow graphics fewer pixels and strands are drawn, so that motion stays smooth. */
    #resolution(lapse) {
        if (!this.pixels.picture(lapse)) return;
        this.stage.showStrands(this.pixels.strands);
        this.#describe();
        this.#resize();
    }

    #resize() {
        const view = byId("view"), width = Math.max(1, view.clientWidth), height = Math.max(1, view.clientHeight);
        this.stage.resize(width, height, this.pixels.ratio);
        const { right, bottom } = this.sheet.insets;
        this.camera.setInsets(right, bottom, width, height);
        this.#isDirty = true;
    }
}
