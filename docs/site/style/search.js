/* Results of the search: the reference of a key or channel, user pages, … decisions, each with the section and a line of text around the hit. */
"use strict";

document.addEventListener("DOMContentLoaded", () => {
    const before = 60, length = 140;   // characters of an excerpt: in front of the hit, and from it
    const typed = (new URLSearchParams(location.search).get("q") || "").trim().toLowerCase();
    const words = splitQuery(typed).filter((word) => word.length > 2);
    const stemmer = new Stemmer(), shown = new Set();
    const patterns = words.map((word) => new RegExp(word + "|" + stemmer.stemWord(word).replace(/i$/, ""), "i"));
    const anything = new RegExp([_escapeRegExp(typed), ...patterns.map((pattern) => pattern.source)].join("|"), "gi");
    const definition = typed + " · ";   // of a reference page: a row that begins with the query

    // The row of a reference page that the query names, user and reference pages that contain the query as typed, then those that contain its words, then all other pages.
    Scorer.score = ([page, , , , score]) => {
        const {group, sections} = searchPages[page];
        const contains = (part) => sections.some(({title, text}) => (title + " · " + text).toLowerCase().includes(part));
        const defines = group === 1 && contains("· " + definition);
        return score + (defines ? 2000 : 0) - 1000 * (group < 2 && contains(typed) ? group : group + 2);
    };

    // The passage with most of the query, or the beginning.
    const passageOf = (sections, group) => {
        const beginnings = group === 1 ? [typed, definition] : [typed];
        let best = {value: 0, section: sections[0], at: 0};
        for (const section of sections)
            for (const {index} of section.text.matchAll(anything)) {
                const passage = section.text.substr(index, length).toLowerCase();
                const whole = beginnings.filter((beginning) => passage.startsWith(beginning)).length;
                const value = whole * (words.length + 1) + patterns.filter((pattern) => pattern.test(passage)).length;
                if (value > best.value) best = {value, section, at: index};
            }
        return best;
    };

    const addExcerpt = (item) => {
        if (item.tagName !== "LI") return;
        const link = item.firstChild, [page, anchor] = link.getAttribute("href").split(".html");
        if (item.children.length > 1) {   // a name of the C++ interface has its description; one of an enum of C is listed with and without it
            return shown.has(page + anchor) ? item.remove() : shown.add(page + anchor);
        }
        const {group, sections} = searchPages[page], own = sections.filter(({id}) => "#" + id === anchor);
        const {section, at} = passageOf(own.length ? own : sections, group);
        const text = section.text, target = `${page}.html#${section.id}`;
        if (shown.has(target)) return item.remove();
        shown.add(target);
        if (!anchor && section !== sections[0]) {
            link.setAttribute("href", target);
            link.append(" > " + section.title);
        }
        const begin = at > before ? text.indexOf(" ", at - before) : 0;
        const end = (text + " ").indexOf(" ", Math.min(at + length, text.length));
        const excerpt = item.appendChild(document.createElement("p"));
        excerpt.textContent = (begin > 0 ? "… " : "") + text.slice(begin, end).replace(/^ (· )?/, "") + (end < text.length ? " …" : "");
        [typed, ...words].forEach((word) => _highlightText(excerpt, word, "highlighted"));
    };
    new MutationObserver((changes) => changes.forEach((change) => change.addedNodes.forEach(addExcerpt)))
        .observe(document.getElementById("search-results"), {childList: true, subtree: true});
});
