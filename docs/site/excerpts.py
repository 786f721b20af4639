"""Texts of all pages for the search, which shows a line around each hit (style/search.js) and puts user pages first.

A page opened from a file cannot fetch the others. Their texts are therefore in a script, which only the page of the search loads.
"""

import json
import pathlib
import re

from docutils import nodes
from sphinx import addnodes


def write_keys_in_full(section):
    """A table below a title as [load] lists keys: `torque` becomes `load.torque`, as users type it."""
    if prefix := re.fullmatch(r"\[(\w+)\]", section[0].astext()):
        for body in section.findall(nodes.tbody):
            for row in body:
                row[0].insert(0, nodes.inline("", prefix[1] + "."))
                row[0].child_text_separator = ""


def sections(page):
    """Identifier, title and text of every section; a dot separates blocks and cells of tables."""
    for comment in list(page.findall(nodes.raw)):
        comment.parent.remove(comment)
    found = []
    for section in page.findall(nodes.section):
        write_keys_in_full(section)
        title, *blocks = (block.astext() for block in section if not isinstance(block, nodes.section))
        text = re.sub(r"\s*\n\s*\n\s*", " · ", "\n\n".join(filter(None, blocks)).strip())
        found.append({"id": section["ids"][0], "title": title, "text": " ".join(text.split())})
    return found


def write_texts(app, error):
    """Each page with its group: 0 for user pages; 1 for reference pages, 2 … for those after them, in the order of the sidebar."""
    if error is not None:
        return
    tables = list(app.env.get_doctree(app.config.root_doc).findall(addnodes.toctree))
    reference = [table["caption"] for table in tables].index("Reference")
    groups = {page: max(0, number - reference + 1) for number, table in enumerate(tables) for page in table["includefiles"]}
    pages = {page: {"group": groups.get(page, len(tables)), "sections": sections(app.env.get_doctree(page))}
             for page in sorted(app.env.found_docs)}
    target = pathlib.Path(app.outdir) / "_static/search_pages.js"
    target.write_text(f"const searchPages = {json.dumps(pages, ensure_ascii=False)};\n", encoding="utf-8")


def add_scripts(app, page, *unused):
    if page == "search":
        app.add_js_file("search_pages.js")
        app.add_js_file("search.js")


def setup(app):
    app.connect("html-page-context", add_scripts)
    app.connect("build-finished", write_texts)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
