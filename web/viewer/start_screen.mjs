/** Without data of its own the page asks for a scene and the files that it reads, or for a recording. */
import { h, setText } from "./dom.mjs";

const SCENE = /\.(ya?ml|json)$/i;
const RECORDING = /\.wisp$/i;

/** Files of a drop, with those in folders under their relative paths. @returns {Promise<[string, File][]>} */
async function filesOfDrop(transfer) {
    const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
    if (entries.length === 0) return [...transfer.files].map((file) => [file.name, file]);
    const found = [];
    const visit = async (entry, folder) => {
        if (entry.isFile) {
            found.push([folder + entry.name, await new Promise((resolve, reject) => entry.file(resolve, reject))]);
            return;
        }
        const reader = entry.createReader();
        for (;;) {
            const list = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
            if (list.length === 0) return;
            for (const child of list) await visit(child, `${folder}${entry.name}/`);
        }
    };
    for (const entry of entries) await visit(entry, "");
    return found;
}

export class StartScreen {
    /** @param {HTMLElement} element @param {(data: import("./data.mjs").PageData) => Promise<void>} open */
    constructor(element, open) {
        this.element = element;
        this.open = open;
        this.error = h("p", { class: "error", role: "alert" });
        this.input = h("input", { type: "file", multiple: true, hidden: true, onchange: () => this.#take([...this.input.files].map((f) => [f.name, f])) });
        const choose = h("button", { type: "button", class: "primary", onclick: () => this.input.click() }, "Choose files");
        this.drop = h("div", { class: "drop" }, h("h1", {}, "Open a scene"),
            h("p", {}, "Drop a scene (.yaml or .json) together with the meshes and grooms that it reads, or a recording (.wisp). ",
                "Nothing leaves this computer."),
            h("div", {}, choose, this.input), this.error);
        element.append(this.drop);
        addEventListener("dragover", (event) => {
            event.preventDefault();
            this.drop.classList.add("over");
        });
        addEventListener("dragleave", () => this.drop.classList.remove("over"));
        addEventListener("drop", async (event) => {
            event.preventDefault();
            this.drop.classList.remove("over");
            this.#take(await filesOfDrop(event.dataTransfer));
        });
    }

    show() {
        this.element.hidden = false;
    }

    fail(message) {
        setText(this.error, message);
    }

    /** @param {[string, File][]} list */
    async #take(list) {
        this.fail("");
        try {
            const main = list.find(([name]) => SCENE.test(name)) ?? list.find(([name]) => RECORDING.test(name));
            if (!main) throw new Error(`Got ${list.map(([name]) => name).join(", ") || "no file"}, expected a scene (.yaml, .json) or a recording (.wisp).`);
            // Paths of a scene's files are relative to its folder.
            const folder = main[0].includes("/") ? main[0].slice(0, main[0].lastIndexOf("/") + 1) : "";
            const files = {};
            for (const [name, file] of list) {
                const path = name.startsWith(folder) ? name.slice(folder.length) : name;
                files[path] = new Uint8Array(await file.arrayBuffer());
            }
            const name = main[0].slice(folder.length);
            await this.open({ kind: RECORDING.test(name) ? "recording" : "scene", name, title: name, files, hashes: null });
            this.element.hidden = true;
        } catch (error) {
            this.show();
            this.fail(error.message);
        }
    }
}
