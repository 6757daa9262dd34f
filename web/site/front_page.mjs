/** The front page and the gallery: README.md and the scenes of site.json. Nothing that README.md says is written a second time. */
import { posix } from "node:path";
import { page } from "./frame.mjs";
import { escape } from "./escape.mjs";
import { plain } from "./markdown.mjs";

/** A scene with its picture; where there is room, a click runs it in place. */
function card(scene, level) {
    const { name, title, text } = scene;
    return `<article class="card" data-live>
<a class="poster" href="live/${name}.html" aria-label="Run live: ${escape(title)}">
<img src="live/${name}.png" alt="${escape(text)}" width="960" height="600"${level === 1 ? "" : ` loading="lazy"`}>
<span class="run" aria-hidden="true">Run live</span>
</a>
<div class="about"><h${level + 1}>${escape(title)}</h${level + 1}>
<p>${escape(text)}</p>
<p class="more"><a href="live/${name}.html">Whole window<span class="hidden-text">: ${escape(title)}</span></a></p></div>
</article>`;
}

/** README.md in parts: title, sentence, picture, facts, and its sections. */
function partsOf(tokens) {
    const parts = { picture: [], sections: [] };
    for (const token of tokens) {
        const section = parts.sections.at(-1);
        if (token.type === "heading" && token.depth === 1) parts.title = plain(token.tokens);
        else if (token.type === "heading" && token.depth === 2) parts.sections.push([token]);
        else if (section) section.push(token);
        else if (token.type === "list") parts.facts ??= token;
        else if (token.type === "paragraph" && token.tokens[0].type === "image") parts.picture = [token];
        else if (token.type === "paragraph") parts.sentence ??= token;
    }
    for (const name of ["title", "sentence", "facts"]) {
        if (!parts[name]) throw new Error(`README.md: there is no ${name} before the first section`);
    }
    return parts;
}

export function frontPage(site, readme) {
    const { title, sentence, picture, facts, sections } = partsOf(readme.tokens);
    const html = (tokens) => readme.parser.parser(tokens);
    const hero = site.gallery.find(({ name }) => name === site.hero);
    const [first, ...others] = sections.map((tokens) => `<section>${html(tokens)}</section>`);
    const links = site.navigation.slice(0, 2).map(({ title: text, path }, index) =>
        `<a class="button${index === 0 ? " primary" : ""}" href="${path}">${text}</a>`);
    const gallery = site.gallery.filter((scene) => scene !== hero).map(({ name, title: text }) =>
        `<li><a href="gallery.html#${name}"><img src="live/${name}.png" alt="" width="960" height="600" loading="lazy">${escape(text)}</a></li>`);
    const body = `<main id="content" class="front">
<div class="hero"><div class="lead"><h1>${escape(title)}</h1>${html([sentence])}<p class="links">${links.join("\n")}</p></div>
${hero ? card(hero, 1) : `<div class="picture">${html(picture)}</div>`}</div>
<div class="facts">${html([facts])}</div>
${first}
${gallery.length > 0 ? `<ul class="strip">${gallery.join("\n")}</ul>` : ""}
${others.join("\n")}
</main>`;
    return page(site, { path: "index.html", title, description: plain(sentence.tokens), current: "index.html", body, wide: true });
}

export function galleryPage(site) {
    const cards = site.gallery.map((scene) => `<section id="${scene.name}">${card(scene, 1)}</section>`);
    const body = `<main id="content" class="gallery"><h1>Gallery</h1>
<p class="intro">Each picture runs its scene in your browser, with the bits of the native program. A page is one file of about 3 MB with all that it
needs; <code>./dev wisp view SCENE -o page.html</code> makes one of a scene of yours.</p>
<div class="cards">${cards.join("\n")}</div></main>`;
    return page(site, { path: "gallery.html", title: "Gallery", description: "Scenes of Wisp that run in the browser",
        current: "gallery.html", body, wide: true });
}

/** The scenes of site.json whose live pages are in `names`. */
export function galleryOf(settings, names) {
    return settings.gallery
        .map((scene) => ({ ...scene, name: posix.basename(scene.scene, ".yaml") }))
        .filter(({ name }) => names.includes(`${name}.html`) && names.includes(`${name}.png`));
}
