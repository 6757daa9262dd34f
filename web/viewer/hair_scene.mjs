/**
 * Scenes of frozen hair that was combed by hand. The page combs a scene whose strands have `base: stroke` and no climate, which
 * is a stiffness there; the commands become its `hair_events`, so that `wisp run` makes the same bits.
 */
import { parseDocument } from "yaml";

/** Numbers of the engine are floats: written with the digits that give the same float back. */
function toFloat(value) {
    return Number(Math.fround(value).toPrecision(9));
}

function findStrands(document, name) {
    const list = document.get("strands");
    return list?.items?.find((item) => item.get("name") === name);
}

/** Whether a scene can be combed at all: a copy of strands has no entry of its own. */
export function hasEntry(text, name) {
    return findStrands(parseDocument(text), name) !== undefined;
}

/**
 * The scene as a brush starts from it.
 * @param {string} text of the scene @param {string} name of the strands
 * @param {{freezes: boolean, stiffness: number|null}} hair stiffness that the scene's climate gives, null without a climate
 */
export function combableScene(text, name, hair) {
    const document = parseDocument(text);
    const entry = findStrands(document, name);
    entry.setIn(["frozen_hair", "base"], "stroke");
    entry.deleteIn(["frozen_hair", "update_on"]);
    if (!entry.hasIn(["frozen_hair", "align"])) {
        entry.setIn(["frozen_hair", "align"], document.createNode({}));
    }
    entry.deleteIn(["frozen_hair", "align", "cursor"]);
    if (entry.has("environment")) {
        entry.delete("environment");
        if (hair.freezes && hair.stiffness !== null) {
            entry.setIn(["frozen_hair", "freeze", "stretch_stiffness"], toFloat(hair.stiffness));
            entry.setIn(["frozen_hair", "freeze", "bend_stiffness"], toFloat(hair.stiffness));
        }
    }
    const events = document.get("hair_events");
    if (events) {
        events.items = events.items.filter((event) => event.get("strands") !== name);
        if (events.items.length === 0) document.delete("hair_events");
    }
    return document.toString({ lineWidth: 0 });
}

/** Whether the strokes of a scene add up already, so that a brush goes on from where the scene is. */
export function isCombable(text, name) {
    return findStrands(parseDocument(text), name).getIn(["frozen_hair", "base"]) === "stroke";
}

/**
 * @param {string} text of a scene @returns {object[]} its entries of `hair_events`
 */
export function hairEvents(text) {
    return parseDocument(text).toJS().hair_events ?? [];
}

function toEntry(event) {
    return Object.fromEntries(Object.entries(event).map(([key, value]) => {
        if (Array.isArray(value)) return [key, value.map(toFloat)];
        return [key, typeof value === "number" && key !== "step" ? toFloat(value) : value];
    }));
}

/**
 * The scene with the commands that were given.
 * @param {string} text from combableScene()
 * @param {object[]} commands entries of `hair_events`: step, strands, cursor, and the parameters that change from there on
 * @param {number} steps that the page has made
 */
export function combedScene(text, commands, steps) {
    const document = parseDocument(text);
    const entries = commands.filter(({ step }) => step < steps).sort((a, b) => a.step - b.step).map(toEntry);
    const list = document.createNode(entries);
    for (const item of list.items) item.flow = true;
    document.set("hair_events", list);
    document.set("steps", steps);
    // A file that was JSON stays JSON.
    return text.trimStart().startsWith("{")
        ? `${JSON.stringify(document.toJS(), null, 2)}\n`
        : document.toString({ lineWidth: 0 });
}
