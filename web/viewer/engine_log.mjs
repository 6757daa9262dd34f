/** Lines that the engine logs, such as an entity that was halted. They travel to the page with the next frame. */
export const engineLog = {
    /** @type {string[]} */
    lines: [],

    print(line) {
        if (engineLog.lines.length < 20) engineLog.lines.push(line);
    },

    /** @returns {string[]} */
    take() {
        return engineLog.lines.splice(0);
    },
};
