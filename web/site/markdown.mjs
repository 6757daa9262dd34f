/** Markdown as GitHub shows it: anchors of headings, tables that scroll inside their own box, links through a function. */
import { Marked } from "marked";
import { escape } from "./escape.mjs";

const unescape = (text) =>
    text.replaceAll("&lt;", "<").replaceAll("&gt;", ">").replaceAll("&quot;", '"').replaceAll("&#39;", "'").replaceAll("&amp;", "&");

/** The anchor that GitHub gives to a heading; `used` counts those of the page. */
function anchor(text, used) {
    const base = text.toLowerCase().replace(/[^\p{L}\p{N}\p{M}\p{Pc} -]/gu, "").replaceAll(" ", "-");
    const count = used.get(base) ?? 0;
    used.set(base, count + 1);
    return count === 0 ? base : `${base}-${count}`;
}

const comments = {
    c: /\/\/.*|\/\*[\s\S]*?\*\//g,
    js: /\/\/.*|\/\*[\s\S]*?\*\//g,
    // Blocks without a language are shell commands, scenes and C: a `#` before a word that is no directive, or `//` after a space.
    "": /(?<=^|\s)#(?= ).*|(?<=^|\s)\/\/(?= ).*/gm,
};

function code(text, language) {
    const pattern = comments[language] ?? comments[""];
    let html = "";
    let end = 0;
    for (const match of text.matchAll(pattern)) {
        html += `${escape(text.slice(end, match.index))}<i>${escape(match[0])}</i>`;
        end = match.index + match[0].length;
    }
    return html + escape(text.slice(end));
}

/**
 * `link(href)` returns where a link or picture of the page leads, `to`, and the title of the page that it leads to, if it is one of the site.
 * A link whose text is the name of a file has that title as text: the site has no such files.
 */
export function markdown(link) {
    const used = new Map();
    const headings = [];
    const renderer = {
        heading({ tokens, depth }) {
            const html = this.parser.parseInline(tokens);
            const text = unescape(html.replace(/<[^>]*>/g, ""));
            const id = anchor(text, used);
            headings.push({ depth, id, text });
            const here = depth === 1 ? "" : ` <a class="here" href="#${id}" aria-label="Link to ${escape(text)}">#</a>`;
            return `<h${depth} id="${id}">${html}${here}</h${depth}>\n`;
        },
        link({ href, tokens }) {
            const { to, title } = link(href);
            const text = this.parser.parseInline(tokens);
            return `<a href="${escape(to)}">${title && text.endsWith(".md") ? escape(title) : text}</a>`;
        },
        image({ href, text }) {
            return `<img src="${escape(link(href).to)}" alt="${escape(text)}" loading="lazy">`;
        },
        code({ text, lang }) {
            return `<pre tabindex="0"><code>${code(text, lang ?? "")}</code></pre>\n`;
        },
        table(token) {
            const row = (cells, tag) => `<tr>${cells.map((cell) => {
                const align = cell.align ? ` class="${cell.align}"` : "";
                return `<${tag}${align}>${this.parser.parseInline(cell.tokens)}</${tag}>`;
            }).join("")}</tr>\n`;
            return `<div class="table" tabindex="0"><table>\n<thead>${row(token.header, "th")}</thead>\n` +
                `<tbody>${token.rows.map((cells) => row(cells, "td")).join("")}</tbody></table></div>\n`;
        },
        // The tree has no HTML in its pages, only comments for tools.
        html({ text }) {
            return text.startsWith("<!--") ? "" : escape(text);
        },
    };
    const marked = new Marked({ renderer });
    return { headings, lexer: (text) => marked.lexer(text), parser: (tokens) => marked.parser(tokens) };
}

/** The text of tokens, for titles and descriptions. */
export function plain(tokens) {
    return tokens.map((token) => (token.tokens ? plain(token.tokens) : unescape(token.text ?? ""))).join("").replace(/\s+/g, " ");
}
