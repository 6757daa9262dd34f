/** Checks a site: every link inside it leads to a file and an anchor, and no page asks another machine for anything. */
import { readFile, readdir } from "node:fs/promises";
import { join, posix, relative } from "node:path";

const decode = (text) => text.replaceAll("&amp;", "&").replaceAll("&quot;", '"').replaceAll("&#39;", "'");

// Elements and rules that load what they name; an <a> only leads there.
const loads = /<(?:script|img|iframe|link|source|video|audio|embed|object|use|image)\b[^>]*?\s(?:src|href|data|srcset)="((?:[a-z]+:)?\/\/[^"]*)"/gi;
const styleLoads = /(?:url\(\s*["']?|@import\s+["'])((?:[a-z]+:)?\/\/[^"')]*)/gi;

async function filesOf(folder) {
    const entries = await readdir(folder, { recursive: true, withFileTypes: true });
    return entries.filter((entry) => entry.isFile()).map((entry) => relative(folder, join(entry.parentPath ?? entry.path, entry.name))).sort();
}

function anchorsOf(text) {
    return new Set([...text.matchAll(/\s(?:id|name)="([^"]*)"/g)].map(([, name]) => decode(name)));
}

/** Sentences about what is wrong. Pages in live/ hold a program and are not read: their own tests do that. */
export async function checkSite(folder) {
    const files = await filesOf(folder);
    const known = new Set(files);
    const problems = [];
    const anchors = new Map();
    const pages = new Map();
    for (const file of files) {
        if (!/\.(html|css)$/.test(file) || file.startsWith("live/")) continue;
        const text = await readFile(join(folder, file), "utf8");
        for (const [, to] of [...text.matchAll(loads), ...text.matchAll(styleLoads)]) {
            problems.push(`${file}: loads '${to}' from elsewhere`);
        }
        if (file.endsWith(".html")) {
            pages.set(file, text);
            anchors.set(file, anchorsOf(text));
        }
    }
    for (const [file, text] of pages) {
        for (const href of new Set([...text.matchAll(/\s(?:href|src)="([^"]*)"/g)].map(([, to]) => decode(to)))) {
            if (/^[a-z]+:/i.test(href)) continue;
            const [path, fragment] = href.split("#");
            const target = path === "" ? file : posix.normalize(posix.join(posix.dirname(file), decodeURIComponent(path)));
            if (!known.has(target)) problems.push(`${file}: link to '${href}': there is no such file`);
            else if (fragment && anchors.has(target) && !anchors.get(target).has(decodeURIComponent(fragment))) {
                problems.push(`${file}: link to '${href}': there is no such heading`);
            }
        }
    }
    return problems;
}
