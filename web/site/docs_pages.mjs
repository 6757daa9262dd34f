/** Pages of documentation: text between the list of pages and the contents of this one. */
import { address, page } from "./frame.mjs";
import { escape } from "./escape.mjs";
import { placeOf } from "./tree_pages.mjs";

function sidebar(groups, pages, path) {
    const lists = groups.map(({ title, pages: files }) => {
        const items = files.map((file) => {
            const mark = placeOf(file) === path ? ` aria-current="page"` : "";
            return `<li><a href="${address(path, placeOf(file))}"${mark}>${escape(pages.get(file).title)}</a></li>`;
        });
        return `<p>${escape(title)}</p><ul>${items.join("\n")}</ul>`;
    });
    return `<nav class="sidebar" aria-label="Pages">${lists.join("\n")}</nav>`;
}

function contents(headings) {
    const items = headings.filter(({ depth }) => depth === 2 || depth === 3);
    if (items.length < 2) return "";
    const links = items.map(({ depth, id, text }) => `<li class="depth${depth}"><a href="#${id}">${escape(text).replaceAll(".", ".<wbr>")}</a></li>`);
    return `<details class="contents" open><summary>On this page</summary><ul>${links.join("\n")}</ul></details>`;
}

/** The page of a Markdown file. */
export function docsPage(site, groups, pages, file) {
    const { tokens, parser, title, summary } = pages.get(file);
    const path = placeOf(file);
    const html = parser.parser(tokens);
    const body = `<div class="docs">${sidebar(groups, pages, path)}
${contents(parser.headings)}
<main id="content" class="text">${html}</main></div>`;
    const own = site.navigation.find((item) => item.path === path);
    return page(site, { path, title, description: summary, current: own ? path : "docs/index.html", body, wide: true });
}

/** The list of all pages, with the sentence that each begins with. */
export function docsIndex(site, groups, pages) {
    const path = "docs/index.html";
    const lists = groups.map(({ title, pages: files }) => {
        const items = files.map((file) => {
            const { title: name, summary } = pages.get(file);
            return `<li><a href="${address(path, placeOf(file))}">${escape(name)}</a> <span>${escape(shorten(summary))}</span></li>`;
        });
        return `<section><h2>${escape(title)}</h2><ul class="index">${items.join("\n")}</ul></section>`;
    });
    const body = `<main id="content" class="text listing"><h1>Docs</h1>${lists.join("\n")}</main>`;
    return page(site, { path, title: "Docs", description: "All pages of documentation", current: path, body });
}

/** The first sentence. */
function shorten(text) {
    const end = text.search(/[.:](?=\s|$)/);
    return end < 0 ? text : `${text.slice(0, end)}.`;
}
