/** Light or dark: as the system says, or as chosen. */
const KEY = "wisp-theme";
const LIGHT = matchMedia("(prefers-color-scheme: light)");

/** A page from a file may be denied storage. */
function stored() {
    try {
        return localStorage.getItem(KEY);
    } catch {
        return null;
    }
}

export class Theme {
    /** @param {(name: "light"|"dark") => void} change */
    constructor(change) {
        this.change = change;
        this.choice = stored() ?? "system";
        LIGHT.addEventListener("change", () => this.#apply());
        this.#apply();
    }

    /** @param {"system"|"light"|"dark"} choice */
    choose(choice) {
        this.choice = choice;
        try {
            localStorage.setItem(KEY, choice);
        } catch {
            // The choice then lasts as long as the page.
        }
        this.#apply();
    }

    get name() {
        return this.choice === "system" ? (LIGHT.matches ? "light" : "dark") : this.choice;
    }

    #apply() {
        document.documentElement.dataset.theme = this.name;
        this.change(this.name);
    }
}
