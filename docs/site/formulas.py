"""Formulas of the pages, set by KaTeX while Sphinx builds: pages need no script and no network.

A formula that KaTeX cannot set, or that contains a character which its fonts lack, is a warning at its place. tools/docs fails on these.
"""

import json
import pathlib
import re
import shutil
import subprocess

from docutils import nodes
from sphinx.util import logging

KATEX = pathlib.Path("/usr/share/javascript/katex")
# One formula in, one answer out, both a line of JSON.
SCRIPT = """
const katex = require(process.argv[1]);
require("readline").createInterface({input: process.stdin}).on("line", (line) => {
    const [formula, displayMode] = JSON.parse(line), answer = {};
    console.warn = (text) => { answer.error = text; };
    try { answer.html = katex.renderToString(formula, {displayMode, strict: "error"}); } catch (error) { answer.error = error.message; }
    console.log(JSON.stringify(answer));
});
"""


class Setter:
    """A process of Node.js that sets one formula after the other; it begins with the first and ends with its input."""

    def __init__(self):
        self.process = None

    def set(self, formula, display):
        if self.process is None:
            self.process = subprocess.Popen(["node", "-e", SCRIPT, str(KATEX / "katex.js")], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            text=True, encoding="utf-8")
        print(json.dumps([formula, display]), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())


setter = Setter()


def html_of(node, display):
    answer = setter.set(node.astext(), display)
    if "error" in answer:
        logging.getLogger(__name__).warning("%s: %s", answer["error"], node.astext(), location=node)
    return answer.get("html", "")


def visit_line(translator, node):
    """Keeps brackets and commas beside a formula, and a short formula, on one line."""
    html, head, tail = html_of(node, False), node.get("head", ""), node.get("tail", "")
    whole = html.count('class="base"') == 1 or len(node.astext()) < 20
    translator.body.append(f'<span class="unbroken">{head}{html}{tail}</span>' if whole else head + html + tail)
    raise nodes.SkipNode


def visit_block(translator, node):
    translator.body.append(html_of(node, True))
    raise nodes.SkipNode


def move_commas(app, page, name):
    """Brackets and commas beside a formula become the formula's: a browser may break a line on either side of an inline block."""
    for formula in page.findall(nodes.math):
        beside = formula.parent
        index = beside.index(formula)
        if index > 0 and isinstance(beside[index - 1], nodes.Text):
            text, formula["head"] = re.fullmatch(r"(.*?)([(]*)", beside[index - 1], re.DOTALL).groups()
            beside[index - 1] = nodes.Text(text)
        if index + 1 < len(beside) and isinstance(beside[index + 1], nodes.Text):
            formula["tail"], text = re.fullmatch(r"([),.;:]*)(.*)", beside[index + 1], re.DOTALL).groups()
            beside[index + 1] = nodes.Text(text)


def name_directive(app, page, source):
    """A block ```math, as hosts of repositories read it, is MyST's directive."""
    source[0] = re.sub(r"^```math$", "```{math}", source[0], flags=re.MULTILINE)


def copy_fonts(app, error):
    if error is None:
        shutil.copytree(KATEX, pathlib.Path(app.outdir) / "_static/katex", dirs_exist_ok=True,
                        ignore=lambda folder, names: [name for name in names if not name.endswith((".min.css", ".woff2", "fonts"))])


def setup(app):
    app.add_html_math_renderer("katex", (visit_line, None), (visit_block, None))
    app.add_css_file("katex/katex.min.css")
    app.connect("source-read", name_directive)
    app.connect("doctree-resolved", move_commas)
    app.connect("build-finished", copy_fonts)
    return {"parallel_read_safe": True, "parallel_write_safe": False}
