/** Starts the page: with the scene or recording inside it, or with a place to drop one. */
import { pageData } from "./data.mjs";
import { StartScreen } from "./start_screen.mjs";
import { missingFeature } from "./support.mjs";
import { testInterface } from "./test_interface.mjs";
import { Viewer } from "./viewer.mjs";

function stopWith(message) {
    const notice = document.getElementById("notice");
    notice.textContent = message;
    notice.hidden = false;
}

async function main() {
    const missing = missingFeature();
    if (missing) return stopWith(missing);
    const viewer = new Viewer();
    window.wispPage = testInterface(viewer);
    const start = new StartScreen(document.getElementById("start"), (data) => viewer.open(data));
    try {
        const data = pageData();
        if (data) await viewer.open(data);
        else start.show();
    } catch (error) {
        stopWith(error.message);
        start.show();
    }
}

main().catch((error) => stopWith(error.message));
