"""Pictures of experiments as data, which the Python package's style draws, in the interpreter that has Matplotlib."""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys

MARKS = {"none": "", "dot": "o", "small_dot": ".", "ring": "o", "square": "s", "diamond": "D", "triangle": "^", "cross": "x"}
PACKAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "api/python/cvtflow"


def axis(label, scale="linear", **ends):
    """`scale`: linear or log; `ends`: from, to."""
    return {"label": label, "scale": scale, "from": None, "to": None, **ends}


def line(name, points, **style):
    """A series of [x, y] without marks."""
    return {"name": name, "points": points, "mark": "none", "line": "solid", **style}


def draw(file, *plots):
    """Plots {title, subtitle, x, y, series, height} below one another as an SVG or PNG file; none without points."""
    plots = [plot for plot in plots if any(series["points"] for series in plot["series"])]
    if not plots:
        return
    subprocess.run([os.environ.get("CVTFLOW_PYTHON", "/usr/bin/python3"), "-I", "-B", __file__, file], input=json.dumps(plots).encode(),
                   check=True)


def _draw(file, plots):
    spec = importlib.util.spec_from_file_location("cvtflow", PACKAGE / "__init__.py", submodule_search_locations=[str(PACKAGE)])
    sys.modules["cvtflow"] = importlib.util.module_from_spec(spec)  # without the library
    from cvtflow.commands import _front

    _front.matplotlib()
    import numpy as np
    from cvtflow import _figures

    _figures.in_notebooks = False
    panels = []
    for plot in plots:
        x, y = plot["x"], plot["y"]
        panels.append(_figures.Panel(plot["title"], x["label"], y["label"], scales=(x["scale"], y["scale"]), height=plot.get("height", 540.0) / 100.0))
        panels[-1].x_ends, panels[-1].y_ends = (() if axis["from"] is None and axis["to"] is None else (axis["from"], axis["to"]) for axis in (x, y))
        for each in plot["series"]:
            style = {"linestyle": each.get("line", "none"), "linewidth": each.get("width", 1.6), "marker": MARKS[each.get("mark", "dot")]}
            style |= ({"markerfacecolor": "none"} if each.get("mark") == "ring" else {}) | ({"color": each["colour"]} if each.get("colour") else {})
            points = (np.array(values, dtype=float) for values in zip(*each["points"])) if each["points"] else (np.empty(0), np.empty(0))
            panels[-1].lines.append(_figures.Line(each["name"], *points, style, each.get("sets_ends", True)))
    pathlib.Path(file).write_bytes(_figures.picture(_figures.draw(panels, plots[0].get("subtitle", "")), pathlib.Path(file).suffix[1:]))


if __name__ == "__main__":
    _draw(sys.argv[1], json.load(sys.stdin))
