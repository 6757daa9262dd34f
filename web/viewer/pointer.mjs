/** What the pointer does in the view beside moving the camera: it drags vertices and colliders, or brushes frozen hair. */
import { Plane, Raycaster, Vector2, Vector3 } from "three";
import { pick } from "./pick.mjs";

const MOUSE_REACH = 14, TOUCH_REACH = 26; // pixels around the pointer in which a strand is found

export class Pointer {
    #raycaster = new Raycaster();
    #held = null;
    #isBrushing = false;
    #waiting = null; // the place of the next command, while one is under way
    tool = "drag";

    /**
     * @param {import("./viewer.mjs").Viewer} viewer
     * @param {HTMLElement} view @param {HTMLCanvasElement} canvas
     */
    constructor(viewer, view, canvas) {
        this.viewer = viewer;
        this.canvas = canvas;
        this.mark = document.createElement("div");
        this.mark.className = "mark";
        this.mark.hidden = true;
        view.append(this.mark);
        // Before the camera's own listeners, so that it stays still while something is held.
        view.addEventListener("pointerdown", (event) => this.#down(event), true);
        view.addEventListener("pointermove", (event) => this.#move(event), true);
        for (const type of ["pointerup", "pointercancel"]) view.addEventListener(type, (event) => this.#up(event), true);
        view.addEventListener("pointerleave", () => this.#isBrushing || (this.mark.hidden = true));
    }

    setTool(tool) {
        this.tool = tool;
        this.canvas.classList.toggle("brush", tool === "brush");
        this.mark.hidden = true;
    }

    /** Everything is let go: the scene starts again. */
    release() {
        this.#held = null;
        this.#isBrushing = false;
        this.#waiting = null;
        this.mark.hidden = true;
        this.viewer.camera.controls.enabled = true;
        this.canvas.classList.remove("grabbing");
    }

    #aim(event) {
        const box = this.canvas.getBoundingClientRect();
        const x = ((event.clientX - box.left) / box.width) * 2 - 1, y = 1 - ((event.clientY - box.top) / box.height) * 2;
        this.#raycaster.setFromCamera(new Vector2(x, y), this.viewer.stage.camera);
        return { x, y, width: box.width, height: box.height, reach: event.pointerType === "touch" ? TOUCH_REACH : MOUSE_REACH };
    }

    #pick(event, accepts) {
        const { viewer } = this, points = viewer.shownPoints;
        return points && pick(viewer.bodies, points, viewer.stage.camera, this.#raycaster, this.#aim(event), accepts);
    }

    #down(event) {
        if (event.target !== this.canvas || event.button !== 0 || this.#held || this.#isBrushing || !this.viewer.session) return;
        if (this.tool === "drag" && !event.ctrlKey && !event.metaKey) this.#take(event);
        else if (this.tool === "brush") this.#beginStroke(event);
    }

    #take(event) {
        const found = this.#pick(event, (body) => this.viewer.canGrab(body));
        if (!found) return;
        const { body, vertex } = found, session = this.viewer.session;
        const points = this.viewer.shownPoints[body.index];
        const isCollider = body.kind === "collider";
        const start = isCollider ? found.point.clone() : new Vector3().fromArray(points, 3 * vertex);
        const normal = this.viewer.stage.camera.getWorldDirection(new Vector3());
        this.#held = { id: event.pointerId, body, vertex, isCollider, start, grip: found.point, plane: new Plane().setFromNormalAndCoplanarPoint(normal, found.point) };
        session.input(isCollider ? { type: "grabCollider", body: body.index } : { type: "grab", body: body.index, vertex, value: start.toArray() });
        this.viewer.camera.controls.enabled = false;
        this.canvas.setPointerCapture(event.pointerId);
        this.canvas.classList.add("grabbing");
        this.#markAt(start, 7);
        event.stopPropagation();
    }

    #move(event) {
        const held = this.#held;
        if (held && event.pointerId === held.id) return this.#drag(event);
        if (this.tool === "brush" && this.viewer.session) this.#brushMove(event);
    }

    #drag(event) {
        const held = this.#held;
        this.#aim(event);
        const at = this.#raycaster.ray.intersectPlane(held.plane, new Vector3());
        if (!at) return;
        // What was gripped beside its vertex stays that far beside it.
        const offset = at.sub(held.grip), target = held.start.clone().add(offset);
        const body = held.body.index;
        this.viewer.session.input(held.isCollider
            ? { type: "moveCollider", body, value: offset.toArray() }
            : { type: "drag", body, vertex: held.vertex, value: target.toArray() });
        this.#markAt(target, 7);
    }

    #up(event) {
        if (this.#held && event.pointerId === this.#held.id) {
            const { body, vertex, isCollider } = this.#held;
            if (!isCollider) this.viewer.session?.input({ type: "letGo", body: body.index, vertex });
            this.release();
        } else if (this.#isBrushing) {
            this.#isBrushing = false;
            this.viewer.camera.controls.enabled = true;
            if (event.pointerType === "touch") this.mark.hidden = true;
        }
    }

    // ---- the brush ----

    #frozen(event) {
        return this.#pick(event, (body) => Boolean(this.viewer.session.frozen[body.index]));
    }

    async #beginStroke(event) {
        const found = this.#frozen(event);
        if (!found) return;
        this.#isBrushing = true;
        this.viewer.camera.controls.enabled = false;
        this.canvas.setPointerCapture(event.pointerId);
        event.stopPropagation();
        if (await this.viewer.beginStroke()) this.viewer.command(found.body, found.point.toArray());
    }

    #brushMove(event) {
        const found = this.#frozen(event);
        this.mark.hidden = !found;
        if (!found) return;
        this.#markAt(found.point, this.#pixels(found.point, this.viewer.brushRadius));
        if (!this.#isBrushing) return;
        // One command at a time: the hand may be faster than the hair.
        if (this.viewer.session.isBusy) this.#waiting = found;
        else this.viewer.command(found.body, found.point.toArray());
    }

    /** A command has been carried out. */
    commandDone() {
        const waiting = this.#waiting;
        this.#waiting = null;
        if (waiting && this.#isBrushing) this.viewer.command(waiting.body, waiting.point.toArray());
    }

    // ---- the mark at the pointer ----

    #pixels(point, radius) {
        const { camera } = this.viewer.stage;
        const depth = -point.clone().applyMatrix4(camera.matrixWorldInverse).z;
        return (radius * camera.projectionMatrix.elements[5] * this.canvas.clientHeight) / (2 * Math.max(depth, 1e-6));
    }

    #markAt(point, radius) {
        const [x, y] = this.viewer.onScreen(point);
        this.mark.hidden = false;
        this.mark.style.transform = `translate(${x}px, ${y}px)`;
        this.mark.style.setProperty("--size", `${Math.round(2 * radius)}px`);
    }
}
