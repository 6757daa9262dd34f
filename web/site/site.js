"use strict";
// A classic script: browsers load no modules from files.

// A picture of the gallery becomes its live page where there is room; elsewhere the link opens the page.
for (const card of document.querySelectorAll("[data-live]")) {
    const link = card.querySelector("a.poster");
    link.addEventListener("click", (event) => {
        if (event.metaKey || event.ctrlKey || event.shiftKey || matchMedia("(max-width: 760px)").matches) return;
        event.preventDefault();
        for (const other of document.querySelectorAll("[data-live].running")) stop(other);
        const frame = document.createElement("iframe");
        frame.src = link.href;
        frame.title = link.getAttribute("aria-label");
        frame.className = "poster";
        card.classList.add("running");
        link.hidden = true;
        link.after(frame);
        card.scrollIntoView({ block: "nearest" });
        frame.focus();
    });
}

function stop(card) {
    card.querySelector("iframe").remove();
    card.querySelector("a.poster").hidden = false;
    card.classList.remove("running");
}

// Contents are open beside the text, and closed above it.
if (matchMedia("(max-width: 1180px)").matches) {
    for (const contents of document.querySelectorAll("details.contents")) contents.open = false;
}

// The heading that is being read is marked in the contents.
const places = [...document.querySelectorAll("details.contents a")];
if (places.length > 0) {
    const headings = places.map((link) => document.getElementById(decodeURIComponent(link.hash.slice(1))));
    const mark = () => {
        const next = headings.findIndex((heading) => heading.getBoundingClientRect().top > 120);
        const current = (next < 0 ? headings.length : next) - 1;
        places.forEach((link, index) => link.classList.toggle("current", index === current));
    };
    addEventListener("scroll", mark, { passive: true });
    mark();
}

// Names of the API by what is typed.
const filter = document.getElementById("filter");
if (filter) {
    const lines = [...document.querySelectorAll("[data-name]")];
    const count = document.getElementById("count");
    const apply = () => {
        const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
        let shown = 0;
        for (const line of lines) {
            line.hidden = !words.every((word) => line.dataset.name.includes(word));
            shown += line.hidden ? 0 : 1;
        }
        for (const group of document.querySelectorAll("details.names")) {
            group.closest("section").hidden = group.querySelector("[data-name]:not([hidden])") === null;
            group.open = words.length > 0;
        }
        count.textContent = words.length > 0 ? `${shown} of ${lines.length} names` : `${lines.length} names`;
    };
    filter.addEventListener("input", apply);
    apply();
}
