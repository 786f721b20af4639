"""Pages: one file of HTML each that needs no network, from the templates, the style and the scripts in the folder page/."""

import base64
import functools
import hashlib
import json
import math
import os
import re

import numpy as np

from ._courses import step_text

HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page")
DEBIAN = {"dygraph.min.js": "dygraphs", "dygraph.min.css": "dygraphs", "three.min.js": "three"}  # libjs-dygraphs, libjs-three


@functools.lru_cache(maxsize=None)
def asset(name):
    """Text of a file of page/, or of a library: Debian's, or that of `npm ci` in page/. Raises OSError with what to install."""
    library = DEBIAN.get(name)
    places = [HERE]
    if library:
        places = [f"/usr/share/javascript/{library}", *(f"{HERE}/node_modules/{library}/{each}" for each in ("dist", "build"))]
    for place in places:
        path = os.path.join(place, name)
        if os.path.isfile(path):
            with open(path, encoding="utf-8") as file:
                return file.read()
    raise OSError(f"reports require {name}: install Debian's libjs-dygraphs and libjs-three, or run npm ci in {HERE}; cvtflow plot "
                  "requires neither")


def packed(values, kind):
    """Numbers in base64, little-endian, as typed arrays of JavaScript take them. kind: "<f4" """
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


def quantised(values):
    """Values as 16-bit integers between their least and largest: {"from", "to", "v"}."""
    values = np.asarray(values, dtype=float)
    finite = values[np.isfinite(values)]
    least, most = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    share = (np.where(np.isfinite(values), values, least) - least) / (most - least) if most > least else np.zeros(values.shape)
    return {"from": least, "to": most, "v": packed(np.rint(65535.0 * share), "<u2")}


def number(value, form="{:.6g}"):
    """A cell of a table: what is shown, and by what it is sorted."""
    value = math.nan if value is None else float(value)
    return {"shown": form.format(value) if math.isfinite(value) else "–", "value": f"{value:.9g}" if math.isfinite(value) else None}


def power_text(value):
    """"14.9 kW" of W."""
    return f"{value:.3g} W" if abs(value) < 999.5 else f"{1e-3 * value:.3g} kW"


def attribute_rows(attributes):
    """Attributes of a record or sweep: pairs of name and text; and those of several lines."""
    short, long = [], []
    for name, value in attributes.items():
        if name in ("step_taken", "note_texts", "errors_of_means", "means"):  # beside "step"; with the notes; with the key figures
            continue
        text = value if isinstance(value, str) else f"{float(value):.6g}" if isinstance(value, (float, np.floating)) else str(value)
        if name == "step":
            text = step_text(attributes)
        (long if "\n" in text else short).append((name, text))
    return short, long


def inline_svg(figure, name):
    """A figure as markup for the middle of a page, whose ids begin with its name."""
    from ._figures import picture as drawn

    svg = re.sub(r"<style type=\"text/css\">.*?</style>|<!--.*?-->", "", drawn(figure, "svg").decode(), flags=re.DOTALL)
    svg = re.sub(r'(\bid="|href="#|url\(#)', lambda found: found[0] + name + "-", svg)
    return svg.replace("<svg ", '<svg role="img" stroke-linejoin="round" ', 1)


def _in_script(data):
    """JSON, escaped for an element <script>; numbers that are not finite are null."""
    return json.dumps(finite(data), ensure_ascii=True, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def finite(data):
    """Data for JSON: numbers that are not finite are None."""
    if isinstance(data, dict):
        return {key: finite(each) for key, each in data.items()}
    if isinstance(data, (list, tuple)):
        return [finite(each) for each in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


def _environment():
    import jinja2

    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE), autoescape=True, undefined=jinja2.StrictUndefined,
                                     trim_blocks=True, lstrip_blocks=True)
    environment.filters["trusted"] = jinja2.filters.do_mark_safe  # of what this module makes
    return environment


def written(template, scripts, data, **values):
    """A page. template: a file of page/; scripts: names of assets in their order, which alone run: the content security policy names their
    hashes; data: JSON for them; values: for the template, texts of which are escaped."""
    bodies = [f"\n{asset(name)}\n" for name in scripts]
    hashes = ["'sha256-" + base64.b64encode(hashlib.sha256(body.encode()).digest()).decode("ascii") + "'" for body in bodies]
    foreign = [name for name in scripts if name in DEBIAN]
    style = (asset("dygraph.min.css") if "dygraph.min.js" in scripts else "") + "\n" + asset("report.css")
    return _environment().get_template(template).render(
        policy=f"default-src 'none'; script-src {' '.join(hashes) or repr('none')}; style-src 'unsafe-inline'; img-src data: blob:; "
               "base-uri 'none'; form-action 'none'",
        style=style, scripts=bodies, data=_in_script(data),
        licences=asset("licenses.txt").partition("\n--")[0] + "\n" if foreign else "", **values)


def section(key, title, blocks, part="blocks", **more):
    """A section; part: its macro in parts.html."""
    return {"id": key, "title": title, "part": part, "blocks": blocks, **more}


def heading(text):
    """A heading within a section."""
    return {"kind": "heading", "text": text}


def text(words, style=""):
    """A paragraph. style: its class"""
    return {"kind": "text", "text": words, "style": style}


def pairs(rows):
    """A table of names and texts."""
    return {"kind": "pairs", "rows": rows}


def folded(summary, blocks):
    """Blocks that a click unfolds."""
    return {"kind": "folded", "summary": summary, "blocks": blocks}


def table(headings, rows, style="sortable", caption="", row="", key="", tall=False, styles=None):
    """A table. headings: texts, or pairs with what a pointer over them shows; rows: cells, texts or number(); row: name of an attribute
    data-… that contains the first cell; key: its id; tall: scrolls by itself; styles: classes by column"""
    headings = [{"text": each, "title": ""} if isinstance(each, str) else {"text": each[0], "title": each[1]} for each in headings]
    classes = [(styles or {}).get(k, "") for k in range(len(headings))]
    return {"kind": "table", "headings": headings, "rows": [{"name": cells[0], "cells": cells} for cells in rows], "style": style,
            "caption": caption, "row": row, "id": key, "tall": tall, "styles": classes}


def picture(figure, name):
    """A figure; its name begins the ids in it."""
    return {"kind": "picture", "svg": inline_svg(figure, name)}


def provenance(attributes):
    """Attributes of a record or sweep: short ones as a table, texts of several lines folded."""
    short, long = attribute_rows(attributes)
    return [pairs(short), *({"kind": "source", "summary": name, "text": value} for name, value in long)]
