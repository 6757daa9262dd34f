/** Lines that the engine logs, such as an entity that was halted. They travel to the page with the next frame. */
export const engineLog = {
    /** While the worker asks for values that may not be there. */
    isQuiet: false,
    /** @type {string[]} */
    lines: [],

    print(line) {
        if (!engineLog.isQuiet && engineLog.lines.length < 20) engineLog.lines.push(line);
    },

    /** @returns {string[]} */
    take() {
        return engineLog.lines.splice(0);
    },
};
