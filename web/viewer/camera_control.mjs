/** The camera: orbit, pan and zoom by pointer, touch and keys. */
import { MOUSE, Spherical, TOUCH, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const KEY_ANGLE = Math.PI / 36;

export class CameraControl {
    /** @param {import("./stage.mjs").Stage} stage @param {HTMLElement} element */
    constructor(stage, element) {
        this.stage = stage;
        this.camera = stage.camera;
        this.controls = new OrbitControls(stage.camera, element);
        this.controls.enableDamping = true;
        this.controls.dampingFactor = 0.12;
        this.controls.zoomToCursor = true;
        this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
        this.controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
        this.controls.maxPolarAngle = 0.98 * Math.PI;
    }

    /** Part of the picture that the panel does not cover, as [left, bottom] insets in pixels. */
    setInsets(right, bottom, width, height) {
        this.insets = { right, bottom, width, height };
        // The middle of the scene is in the middle of what is free.
        if (right > 0 || bottom > 0) this.camera.setViewOffset(width, height, right / 2, bottom / 2, width, height);
        else this.camera.clearViewOffset();
    }

    /** Show the whole scene, from a little above. */
    frame() {
        const { centre, radius } = this.stage, { camera, controls } = this;
        const { right, bottom, width, height } = this.insets ?? { right: 0, bottom: 0, width: 1, height: 1 };
        const half = (camera.fov * Math.PI) / 360;
        const free = Math.min((height - bottom) / height, (width - right) / height);
        const distance = (1.12 * radius) / (Math.sin(half) * Math.max(0.25, free));
        camera.near = distance / 400;
        camera.far = distance * 60;
        camera.position.copy(centre).addScaledVector(new Vector3(0.42, 0.26, 0.87).normalize(), distance);
        camera.updateProjectionMatrix();
        controls.target.copy(centre);
        controls.minDistance = distance / 60;
        controls.maxDistance = distance * 12;
        controls.update();
    }

    orbit(x, y) {
        const { camera, controls } = this;
        const offset = camera.position.clone().sub(controls.target), s = new Spherical().setFromVector3(offset);
        s.theta += x * KEY_ANGLE;
        s.phi = Math.min(controls.maxPolarAngle, Math.max(0.02, s.phi - y * KEY_ANGLE));
        camera.position.copy(controls.target).add(offset.setFromSpherical(s));
        controls.update();
    }

    pan(x, y) {
        const { camera, controls } = this;
        const step = 0.05 * camera.position.distanceTo(controls.target);
        const move = new Vector3().setFromMatrixColumn(camera.matrix, 0).multiplyScalar(-x * step)
            .addScaledVector(new Vector3().setFromMatrixColumn(camera.matrix, 1), y * step);
        camera.position.add(move);
        controls.target.add(move);
        controls.update();
    }

    zoom(factor) {
        const { camera, controls } = this;
        const offset = camera.position.clone().sub(controls.target);
        const distance = Math.min(controls.maxDistance, Math.max(controls.minDistance, offset.length() * factor));
        camera.position.copy(controls.target).addScaledVector(offset.normalize(), distance);
        controls.update();
    }

    /** @returns {boolean} whether the camera has moved since the last call */
    update() {
        this.controls.update();
        const key = [...this.camera.position, ...this.camera.quaternion].join();
        const hasMoved = key !== this.last;
        this.last = key;
        return hasMoved;
    }
}
