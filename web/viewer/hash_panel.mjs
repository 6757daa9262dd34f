/** Hashes of the state beside those that the native program printed. */
import { h, section, setText } from "./dom.mjs";

export class HashPanel {
    #shown = -1;

    constructor() {
        this.verdict = h("p", { role: "status" });
        this.table = h("table", { class: "hashes" },
            h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Step"), h("th", { scope: "col" }, "Here"), h("th", { scope: "col" }, "Native"))),
            this.rows = h("tbody"));
        const built = section("Same bits", true, this.verdict, h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Hashes" }, this.table));
        this.element = built.element;
        this.brief = built.brief;
    }

    /** @param {import("./hash_check.mjs").HashCheck} check */
    update(check) {
        const key = `${check.rows.length} ${check.excluded}`;
        if (key === this.#shown) return;
        this.#shown = key;
        const { verdict, tone, brief } = this.#judge(check);
        setText(this.verdict, verdict);
        this.verdict.className = tone;
        setText(this.brief, brief);
        this.brief.className = `brief ${tone === "note" ? "" : tone}`;
        this.table.classList.toggle("excluded", check.excluded !== null);
        this.table.parentElement.hidden = check.rows.length === 0;
        this.rows.replaceChildren(...check.rows.map((row) => {
            const rowTone = row.isEqual === true ? "good" : row.isEqual === false ? "bad" : "";
            return h("tr", { class: rowTone }, h("td", {}, String(row.step)), h("td", {}, row.hash), h("td", {}, row.native ?? "-"));
        }));
    }

    #judge(check) {
        if (check.excluded) return { verdict: `Not compared: ${check.excluded}.`, tone: "note", brief: "not compared" };
        if (!check.hasNative) {
            return { verdict: `Every ${check.every}th step has a hash. A page made by wisp view compares it with the native run.`, tone: "note", brief: "" };
        }
        const wrong = check.firstDifference;
        if (wrong) return { verdict: `Differs from the native run at step ${wrong.step}.`, tone: "bad", brief: "different" };
        const equal = check.equalCount;
        if (equal === 0) return { verdict: `Every ${check.every}th step is compared with the native run (${check.isa}).`, tone: "note", brief: "" };
        const verdict = `${equal} of ${equal} hashes equal those of the native run (${check.isa}).`;
        return { verdict, tone: "good", brief: `${equal} equal` };
    }
}
