/** Pages of the tree: Markdown files, what they link to, and where each of them lies in the site. */
import { cp, mkdir, readFile, readdir, stat, writeFile } from "node:fs/promises";
import { dirname, join, posix } from "node:path";
import { address, page } from "./frame.mjs";
import { escape } from "./escape.mjs";
import { markdown, plain } from "./markdown.mjs";

// A browser shows these; it would offer to download the others, so they become text.
const shown = new Set([".png", ".svg", ".json", ".txt"]);

/** Where a file of the tree lies in the site. */
export function placeOf(file) {
    if (posix.basename(file) === "README.md") return posix.join(posix.dirname(file), "index.html");
    if (file.endsWith(".md")) return file.replace(/\.md$/, ".html");
    return shown.has(posix.extname(file)) ? file : `${file}.txt`;
}

const kindOf = async (path) => {
    try {
        return (await stat(path)).isDirectory() ? "folder" : "file";
    } catch {
        return "none";
    }
};

export class TreePages {
    /** `problems` receives a sentence for each link that leads nowhere. */
    constructor(tree, problems) {
        this.tree = tree;
        this.problems = problems;
        this.pages = new Map(); // path of a Markdown file to what is known of it
        this.files = new Set();
        this.folders = new Set();
        this.queue = [];
    }

    /** Reads a page, and all that it links to. */
    async add(file) {
        this.queue.push(file);
        while (this.queue.length > 0) {
            const next = this.queue.shift();
            if (!this.pages.has(next)) await this.#read(next);
        }
    }

    async #read(file) {
        const text = await readFile(join(this.tree, file), "utf8");
        const targets = new Map();
        // All pages are read before the first is rendered.
        const parser = markdown((href) => {
            const { to, page: target } = targets.get(href);
            return { to, title: this.pages.get(target)?.title };
        });
        const tokens = parser.lexer(text);
        const hrefs = new Set();
        walk(tokens, (token) => {
            if (token.type === "link" || token.type === "image") hrefs.add(token.href);
        });
        for (const href of hrefs) targets.set(href, await this.#target(file, href));
        const title = tokens.find((token) => token.type === "heading" && token.depth === 1);
        const first = tokens.find((token) => token.type === "paragraph" && token.tokens[0].type !== "image");
        this.pages.set(file, {
            tokens,
            parser,
            title: title ? plain(title.tokens) : posix.basename(file, ".md"),
            summary: first ? plain(first.tokens) : "",
        });
    }

    async #target(file, href) {
        if (/^[a-z]+:/i.test(href) || href.startsWith("#")) return { to: href };
        const [path, fragment] = href.split("#");
        const target = posix.normalize(posix.join(posix.dirname(file), decodeURIComponent(path))).replace(/\/$/, "");
        const kind = target.startsWith("..") ? "none" : await kindOf(join(this.tree, target));
        if (kind === "none") {
            this.problems.push(`${file}: link to '${href}': there is no such file`);
            return { to: href };
        }
        const place = kind === "folder" ? await this.#folder(target) : this.#file(target);
        return { to: address(placeOf(file), place) + (fragment ? `#${fragment}` : ""), page: target };
    }

    #file(file) {
        if (file.endsWith(".md")) this.queue.push(file);
        else this.files.add(file);
        return placeOf(file);
    }

    async #folder(folder) {
        const readme = posix.join(folder, "README.md");
        if ((await kindOf(join(this.tree, readme))) === "file") return this.#file(readme);
        this.folders.add(folder);
        return posix.join(folder, "index.html");
    }

    /** Copies files that pages link to, and lists the folders. */
    async writeFiles(site, output) {
        for (const folder of this.folders) {
            const entries = await readdir(join(this.tree, folder), { withFileTypes: true });
            const names = entries.filter((entry) => entry.isFile()).map((entry) => entry.name).sort();
            for (const name of names) this.files.add(posix.join(folder, name));
            const place = posix.join(folder, "index.html");
            const items = names.map((name) => {
                const to = address(place, placeOf(posix.join(folder, name)));
                return `<li><a href="${escape(to)}">${escape(name)}</a></li>`;
            });
            const body = `<main id="content" class="text"><h1>${escape(folder)}</h1><ul>${items.join("\n")}</ul></main>`;
            await put(output, place, page(site, { path: place, title: folder, body }));
        }
        for (const file of this.files) {
            await mkdir(dirname(join(output, placeOf(file))), { recursive: true });
            await cp(join(this.tree, file), join(output, placeOf(file)));
        }
    }
}

function walk(tokens, visit) {
    for (const token of tokens) {
        visit(token);
        if (token.tokens) walk(token.tokens, visit);
        for (const item of token.items ?? []) walk([item], visit);
        for (const cell of [...(token.header ?? []), ...(token.rows ?? []).flat()]) walk(cell.tokens, visit);
    }
}

export async function put(output, path, text) {
    await mkdir(dirname(join(output, path)), { recursive: true });
    await writeFile(join(output, path), text);
}
