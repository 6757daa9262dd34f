/** What all pages of the site have: head, header with its links, and where a file lies as seen from a page. */
import { posix } from "node:path";
import { escape } from "./escape.mjs";

/** The address of `to`, a path in the site, in a page at `from`. */
export function address(from, to) {
    return posix.relative(posix.dirname(from), to);
}

export function head(path, title, styles, description) {
    const links = styles.map((style) => `<link rel="stylesheet" href="${address(path, style)}">`);
    return [
        `<meta charset="utf-8">`,
        `<meta name="viewport" content="width=device-width, initial-scale=1">`,
        `<meta name="color-scheme" content="light dark">`,
        ...(description ? [`<meta name="description" content="${escape(description)}">`] : []),
        ...(title ? [`<title>${escape(title)}</title>`] : []),
        // A browser asks for favicon.ico if a page has no icon.
        `<link rel="icon" href="${address(path, "icon.svg")}">`,
        ...links,
    ].join("\n");
}

/** `current` is the path of the link that the page belongs to. */
export function header(path, navigation, current) {
    const items = navigation.map(({ title, path: to }) => {
        const mark = to === current ? (to === path ? ` aria-current="page"` : ` aria-current="true"`) : "";
        return `<li><a href="${address(path, to)}"${mark}>${title}</a></li>`;
    });
    return `<a class="skip" href="#content">Skip to the text</a>
<header class="site"><div>
<a class="brand" href="${address(path, "index.html")}"><img src="${address(path, "icon.svg")}" alt="" width="22" height="22">Wisp</a>
<nav aria-label="Site"><ul>${items.join("")}</ul></nav>
</div></header>`;
}

export function footer(site) {
    return `<footer class="site"><div>Wisp ${escape(site.version)}, MIT licence</div></footer>`;
}

export function page(site, { path, title, description, current, body, wide }) {
    const name = title === "Wisp" ? title : `${title} - Wisp`;
    return `<!DOCTYPE html>
<html lang="en">
<head>
${head(path, name, ["base.css", "pages.css"], description)}
</head>
<body${wide ? ` class="wide"` : ""}>
${header(path, site.navigation, current)}
${body}
${footer(site)}
<script src="${address(path, "site.js")}"></script>
</body>
</html>
`;
}
