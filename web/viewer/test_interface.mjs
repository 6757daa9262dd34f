/**
 * `window.wispPage`: what tests of the page read. Tests act through pointer, keys and controls like everybody else.
 *
 * @param {import("./viewer.mjs").Viewer} viewer
 */
export function testInterface(viewer) {
    return {
        /** What is known about the run. */
        state() {
            const { session, playback } = viewer, player = session ?? playback;
            if (!player) return { isOpen: false };
            return {
                isOpen: true, ...player.state, kind: session ? "scene" : "recording",
                speed: player.clock.speed, tool: viewer.pointer.tool,
                ms: viewer.cost.ms, passes: viewer.cost.passes, frameCost: viewer.frameCost.stats,
                rms: session?.distance ?? null, usesReference: session?.usesReference ?? false,
                parameters: session ? session.scene.parameters.map((parameter) => ({ ...parameter, value: session.parameters[parameter.name] ?? parameter.value })) : [],
                hashes: session ? { rows: session.hashes.rows, excluded: session.hashes.excluded } : null,
                bodies: player.bodies.map(({ index, name, kind, vertexCount, strandCount, moves, hidden }) => (
                    { index, name, kind, vertexCount, strandCount, moves, hidden })),
            };
        },
        /** @returns {Promise<{step: number, hash: string}>} of the main world now */
        hash: () => viewer.session.hash(),
        /** @returns {Promise<{text: string, hash: string, step: number}>} what "Save scene" writes */
        savedScene: () => viewer.session.saveScene(),
        /** @returns {number[]} m, as shown */
        vertex: (body, vertex) => viewer.vertex(body, vertex).toArray(),
        /** @returns {number[]} of a surface, as drawn */
        triangles: (body) => Array.from(viewer.bodies[body].triangles),
        /** @returns {[number, number]} pixels */
        vertexOnScreen: (body, vertex) => viewer.onScreen(viewer.vertex(body, vertex)),
    };
}
