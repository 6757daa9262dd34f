/** The API reference: doxygen's pages in the frame of the site, and an index of all names from its tag file. */
import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { footer, head, header, page } from "./frame.mjs";

// Doxygen's own indices: the tag file makes a better one.
const indices = /^(annotated|classes|files|functions|globals|index|pages)(_.*)?\.html$/;

const groups = [
    { title: "Hosts", note: "What a program includes that has a world.", test: /\/wisp\/[^/]*$/ },
    { title: "Effects", note: "One header for each effect; a host includes those that it uses.", test: /\/modules\// },
    { title: "Modules", note: "For effects of your own, in <code>&lt;wisp/module/&gt;</code>.", test: /\/wisp\/module\// },
];

const words = { struct: "struct", define: "macro", typedef: "type", enumeration: "enum", function: "function", variable: "variable" };

const field = (text, name) => text.match(new RegExp(`<${name}>(.*?)</${name}>`))?.[1] ?? "";

/** The headers of a tag file, each with its names. */
function headersOf(tags) {
    const compounds = [...tags.matchAll(/<compound kind="(\w+)">([\s\S]*?)<\/compound>/g)];
    const structs = new Map(compounds.filter(([, kind]) => kind === "struct" || kind === "union")
        .map(([, , text]) => [field(text, "name"), field(text, "filename")]));
    return compounds.filter(([, kind]) => kind === "file").map(([, , text]) => {
        const names = [...text.matchAll(/<class kind="struct">(.*?)<\/class>/g)]
            .filter(([, name]) => structs.has(name))
            .map(([, name]) => ({ name, word: words.struct, to: structs.get(name) }));
        for (const [, kind, member] of text.matchAll(/<member kind="(\w+)">([\s\S]*?)<\/member>/g)) {
            if (words[kind] && field(member, "name") !== "") {
                names.push({ name: field(member, "name"), word: words[kind], to: `${field(member, "anchorfile")}#${field(member, "anchor")}` });
            }
        }
        return { file: field(text, "name"), place: field(text, "path") + field(text, "name"), to: field(text, "filename"), names };
    });
}

/** The sentence that doxygen has at the top of a header's page. */
const sentenceOf = (text) =>
    text.match(/<div class="contents">\s*<p>([\s\S]*?)<\/p>/)?.[1].replace(/<a href="#details">.*?<\/a>/, "").replace(/<\/?a[^>]*>/g, "").trim() ?? "";

function indexPage(site, headers) {
    const parts = groups.map(({ title, note, test }) => {
        const files = headers.filter(({ place }) => test.test(place)).map(({ file, to, sentence, names }) => {
            const lines = names.map(({ name, word, to: link }) =>
                `<li data-name="${name.toLowerCase()}"><a href="${link}">${name}</a> <span>${word}</span></li>`);
            const details = lines.length === 0 ? "" :
                `<details class="names"><summary>${lines.length} names<span class="hidden-text"> of ${file}</span></summary><ul>${lines.join("\n")}</ul></details>`;
            return `<section class="api-header"><h3><a href="${to}">${file}</a></h3><p>${sentence}</p>${details}</section>`;
        });
        return `<h2>${title}</h2><p>${note}</p>${files.join("\n")}`;
    });
    const body = `<main id="content" class="text"><h1>API reference</h1>
<p>The public headers of Wisp ${site.version}. <a href="../docs/embedding.html">Embedding</a> tells how they go together.</p>
<p class="filter"><label for="filter">Find a name</label> <input id="filter" type="search" autocomplete="off" spellcheck="false"> <output id="count" for="filter"></output></p>
${parts.join("\n")}</main>`;
    return page(site, { path: "api/index.html", title: "API reference", description: "The public headers of Wisp", current: "api/index.html", body });
}

/** Puts doxygen's pages of `folder` into the site. */
export async function writeApi(site, folder, output) {
    await mkdir(join(output, "api"), { recursive: true });
    const headers = headersOf(await readFile(join(folder, "wisp.tag"), "utf8"));
    const names = (await readdir(folder)).filter((name) => name.endsWith(".html") && !indices.test(name));
    for (const name of names) {
        const path = `api/${name}`;
        const text = (await readFile(join(folder, name), "utf8"))
            .replace("<!-- site: head -->", () => head(path, "", ["base.css", "api.css"], ""))
            .replace("<!-- site: header -->", () => header(path, site.navigation, "api/index.html"))
            .replace("<!-- site: footer -->", () => footer(site));
        await writeFile(join(output, path), text);
        for (const known of headers.filter(({ to }) => to === name)) known.sentence = sentenceOf(text);
    }
    await writeFile(join(output, "api/index.html"), indexPage(site, headers));
}
