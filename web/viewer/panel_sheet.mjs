/** The panel on a narrow screen: a sheet that a button opens. */
const NARROW = matchMedia("(max-width: 760px)");

export class PanelSheet {
    /** @param {HTMLElement} panel @param {HTMLButtonElement} handle @param {() => void} changed */
    constructor(panel, handle, changed) {
        this.panel = panel;
        this.handle = handle;
        this.changed = changed;
        handle.addEventListener("click", () => this.#set(!this.isOpen));
        NARROW.addEventListener("change", changed);
    }

    #set(isOpen) {
        this.panel.classList.toggle("open", isOpen);
        document.body.classList.toggle("sheet-open", isOpen);
        this.handle.setAttribute("aria-expanded", String(isOpen));
        this.handle.textContent = isOpen ? "Close settings" : "Settings";
        this.changed();
    }

    get isOpen() {
        return this.panel.classList.contains("open");
    }

    /** Pixels of the picture that panel and bar cover, at its right and at its bottom. */
    get insets() {
        if (this.panel.hidden) return { right: 0, bottom: 0 };
        if (!NARROW.matches) return { right: 336, bottom: 56 };
        return { right: 0, bottom: this.isOpen ? this.panel.clientHeight : 160 };
    }
}
