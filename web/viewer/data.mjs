/** What the page carries inside itself: engine, worker and, if `wisp view` wrote it, a scene or a recording. */

function textOf(id) {
    return document.getElementById(id)?.textContent ?? "";
}

/** @param {string} text @returns {Uint8Array} */
export function bytesOfBase64(text) {
    const binary = atob(text.trim());
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

let engine = null;

export function engineBytes() {
    engine ??= bytesOfBase64(textOf("wisp-wasm"));
    return engine;
}

export function workerText() {
    return new TextDecoder().decode(bytesOfBase64(textOf("wisp-worker")));
}

/**
 * @typedef {object} PageData
 * @property {"scene"|"recording"} kind
 * @property {string} name entry of `files`
 * @property {string} title
 * @property {Record<string, Uint8Array>} files
 * @property {{every: number, isa: string, values: string[]}|null} hashes of the native run
 *
 * @returns {PageData|null} null: the page asks for files
 */
export function pageData() {
    const data = JSON.parse(textOf("wisp-data") || "null");
    if (!data) return null;
    const files = {};
    for (const [name, text] of Object.entries(data.files)) files[name] = bytesOfBase64(text);
    return {
        kind: data.kind, name: data.name, title: data.title ?? data.name, files,
        hashes: data.hashes?.values?.length > 0 ? data.hashes : null,
    };
}
