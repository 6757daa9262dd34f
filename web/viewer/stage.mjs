/** The picture: camera, light, shadow and the drawings of all bodies. */
import {
    Box3, Color, DepthTexture, LessEqualCompare, Matrix4, OrthographicCamera, PerspectiveCamera, Scene, UnsignedIntType,
    Vector2, Vector3, Vector4, WebGLRenderTarget, WebGLRenderer, LinearFilter,
} from "three";
import { mapTexture } from "./colour_map.mjs";
import { GroundDrawing } from "./ground_drawing.mjs";
import { OutlineDrawing } from "./outline_drawing.mjs";
import { PointTextures } from "./point_textures.mjs";
import { StrandDrawing } from "./strand_drawing.mjs";
import { SurfaceDrawing } from "./surface_drawing.mjs";

const SHADOW_SIZE = 2048;

const THEMES = {
    dark: {
        background: 0x15171a, sky: [0.34, 0.39, 0.46], ground: [0.12, 0.115, 0.11], key: [1.70, 1.63, 1.52],
        line: [0.55, 0.58, 0.62, 0.22], shade: 0.5, ink: [1.0, 0.80, 0.42, 0.62],
    },
    light: {
        background: 0xe9eaec, sky: [0.46, 0.50, 0.56], ground: [0.27, 0.26, 0.24], key: [1.72, 1.66, 1.56],
        line: [0.30, 0.33, 0.38, 0.22], shade: 0.26, ink: [0.75, 0.30, 0.02, 0.66],
    },
};

function boxOf(points, count) {
    const box = new Box3(), p = new Vector3();
    for (let i = 0; i < 3 * count; i += 3) box.expandByPoint(p.set(points[i], points[i + 1], points[i + 2]));
    return box;
}

export class Stage {
    #shadowCamera = new OrthographicCamera();
    #shadowTarget;
    #drawings = [];
    #outlines = [];
    #grounds = [];

    /** @param {HTMLCanvasElement} canvas */
    constructor(canvas) {
        const context = canvas.getContext("webgl2", { alpha: false, antialias: true, powerPreference: "high-performance" });
        this.renderer = new WebGLRenderer({ canvas, context });
        this.renderer.autoClear = true;
        this.scene = new Scene();
        this.camera = new PerspectiveCamera(36, 1, 0.01, 100);
        this.#shadowTarget = this.#makeShadowTarget();
        this.shared = {
            keyDirection: { value: new Vector3(-0.58, 0.72, 0.46).normalize() },
            keyColour: { value: new Color() }, skyColour: { value: new Color() }, groundColour: { value: new Color() },
            shadowMap: { value: this.#shadowTarget.depthTexture }, shadowMatrix: { value: new Matrix4() },
            shadowTexel: { value: 1 / SHADOW_SIZE }, shadowBias: { value: 0 },
            colourMap: { value: mapTexture() }, viewport: { value: new Vector2(1, 1) },
            line: { value: new Vector4() }, shade: { value: 0 }, ink: { value: new Vector4() },
        };
        this.centre = new Vector3();
        this.radius = 1;
        this.setTheme("dark");
    }

    #makeShadowTarget() {
        const target = new WebGLRenderTarget(SHADOW_SIZE, SHADOW_SIZE, { depthBuffer: true });
        const depth = new DepthTexture(SHADOW_SIZE, SHADOW_SIZE, UnsignedIntType);
        depth.compareFunction = LessEqualCompare;
        depth.magFilter = depth.minFilter = LinearFilter;
        target.depthTexture = depth;
        return target;
    }

    /** @param {"dark"|"light"} name */
    setTheme(name) {
        const theme = THEMES[name];
        this.renderer.setClearColor(new Color(theme.background));
        this.shared.keyColour.value.setRGB(...theme.key);
        this.shared.skyColour.value.setRGB(...theme.sky);
        this.shared.groundColour.value.setRGB(...theme.ground);
        this.shared.line.value.set(...theme.line);
        this.shared.shade.value = theme.shade;
        this.shared.ink.value.set(...theme.ink);
    }

    /**
     * New bodies. @param {object[]} bodies @param {Float32Array[]} points of their first frame
     * @param {boolean} withOutlines of a reference
     */
    setBodies(bodies, points, withOutlines) {
        this.#clear();
        this.#measure(bodies, points);
        const numbers = {};
        bodies.forEach((body, b) => {
            if (body.kind === "plane" || body.hidden || body.vertexCount === 0 || !(body.triangles || body.offsets)) return;
            const number = numbers[body.kind] = (numbers[body.kind] ?? -1) + 1;
            const textures = new PointTextures(body.vertexCount);
            const drawing = body.kind === "strands"
                ? new StrandDrawing(body, textures, this.shared)
                : new SurfaceDrawing(body, number, textures, this.shared);
            this.#drawings.push({ b, textures, drawing });
            this.scene.add(drawing.object);
            if (!withOutlines || !body.moves) return;
            const ghost = new PointTextures(body.vertexCount);
            const outline = new OutlineDrawing(body, ghost, this.shared);
            this.#outlines.push({ b, textures: ghost, drawing: outline });
            outline.object.visible = false;
            this.scene.add(outline.object);
        });
        for (const body of bodies) if (body.kind === "plane") this.#addGround(body, points[body.index]);
        this.#placeShadow();
    }

    #addGround(body, points) {
        // A plane comes as a square.
        const [a, b, c] = [0, 3, 6].map((i) => new Vector3().fromArray(points, i));
        const normal = b.sub(a).cross(c.sub(a));
        const ground = new GroundDrawing(a, normal, this.radius, this.centre, this.shared);
        this.#grounds.push(ground);
        this.scene.add(ground.object);
    }

    #clear() {
        for (const list of [this.#drawings, this.#outlines]) {
            for (const { drawing, textures } of list) {
                this.scene.remove(drawing.object);
                drawing.dispose();
                textures.dispose();
            }
            list.length = 0;
        }
        for (const ground of this.#grounds) {
            this.scene.remove(ground.object);
            ground.dispose();
        }
        this.#grounds.length = 0;
    }

    /** Middle and size of what is there at the start: all that moves, and what it can fall on. */
    #measure(bodies, points) {
        const moving = new Box3(), all = new Box3();
        for (const body of bodies) {
            if (body.kind === "plane" || body.hidden || !points[body.index]) continue;
            const box = boxOf(points[body.index], body.vertexCount);
            all.union(box);
            if (body.moves) moving.union(box);
        }
        if (all.isEmpty()) all.set(new Vector3(-1, 0, -1), new Vector3(1, 1, 1));
        const box = moving.isEmpty() ? all : moving;
        // A collider much larger than what moves would make that small.
        const size = box.getSize(new Vector3()).length();
        if (all.getSize(new Vector3()).length() < 2.2 * size) box.copy(all);
        for (const body of bodies) {
            if (body.kind !== "plane") continue;
            const height = points[body.index][1], drop = box.min.y - height;
            if (drop > 0 && drop < size) box.min.y = height;
        }
        box.getCenter(this.centre);
        this.radius = Math.max(1e-3, box.getSize(new Vector3()).length() / 2);
    }

    #placeShadow() {
        const camera = this.#shadowCamera, reach = 2.2 * this.radius;
        camera.left = camera.bottom = -reach;
        camera.right = camera.top = reach;
        camera.near = 0.05 * reach;
        camera.far = 8 * reach;
        camera.position.copy(this.centre).addScaledVector(this.shared.keyDirection.value, 4 * reach);
        camera.lookAt(this.centre);
        camera.updateMatrixWorld();
        camera.updateProjectionMatrix();
        const toTexture = new Matrix4().set(0.5, 0, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0, 1);
        this.shared.shadowMatrix.value.copy(toTexture).multiply(camera.projectionMatrix).multiply(camera.matrixWorldInverse);
        this.shared.shadowBias.value = 3 * (2 * reach) / SHADOW_SIZE;
    }

    /**
     * @param {{from: object, to: object, mix: number, reference?: {from: object, to: object}|null}} shown frames around the time
     * that is shown
     * @param {number} valueScale from a value to its place in the colour map
     */
    show({ from, to, mix, reference }, valueScale) {
        for (const { b, textures, drawing } of this.#drawings) {
            textures.show(from.points[b], to.points[b], mix);
            // vertices that the earlier frame has are in both
            if (from.triangles?.[b]) drawing.showTriangles(from.triangles[b]);
            drawing.showValues(to.values[b], valueScale);
        }
        for (const { b, textures, drawing } of this.#outlines) {
            drawing.object.visible = Boolean(reference);
            if (!reference) continue;
            textures.show(reference.from.points[b], reference.to.points[b], mix);
            if (reference.from.triangles?.[b]) drawing.showTriangles(reference.from.triangles[b]);
        }
    }

    /** @param {object} frame whose widths and colours have changed */
    showLooks(frame) {
        for (const { b, drawing } of this.#drawings) drawing.showLooks(frame.looks[b]);
    }

    /** @param {number} part of the strands to draw */
    showStrands(part) {
        for (const { drawing } of this.#drawings) drawing.showPart?.(part);
    }

    resize(width, height, ratio) {
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.shared.viewport.value.set(width * ratio, height * ratio);
    }

    #renderShadow() {
        const others = [...this.#outlines.map(({ drawing }) => drawing), ...this.#grounds];
        const visible = others.map(({ object }) => object.visible);
        for (const { object } of others) object.visible = false;
        for (const { drawing } of this.#drawings) drawing.object.material = drawing.depthMaterial;
        this.shared.shadowMap.value = null;
        this.renderer.setRenderTarget(this.#shadowTarget);
        this.renderer.render(this.scene, this.#shadowCamera);
        this.renderer.setRenderTarget(null);
        this.shared.shadowMap.value = this.#shadowTarget.depthTexture;
        for (const { drawing } of this.#drawings) drawing.object.material = drawing.material;
        others.forEach(({ object }, k) => (object.visible = visible[k]));
    }

    render() {
        this.#renderShadow();
        this.renderer.render(this.scene, this.camera);
    }
}
