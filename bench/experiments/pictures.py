"""Pictures of experiments as data, which the Python package draws as it does those of the programs."""

import json
import os
import pathlib
import subprocess

DRAWER = pathlib.Path(__file__).resolve().parent.parent.parent / "api/python/cvtflow/_draw.py"


def axis(label, scale="linear", **ends):
    """`scale`: linear, log or symlog; `ends`: from, to."""
    return {"label": label, "scale": scale, "linear_up_to": 1.0, "from": None, "to": None, **ends}


def line(name, points, **style):
    """A series of [x, y] without marks."""
    return {"name": name, "points": points, "mark": "none", "line": "solid", **style}


def draw(file, *plots):
    """Plots {title, subtitle, x, y, series, height} below one another as an SVG or PNG file; none without points."""
    plots = [plot for plot in plots if any(series["points"] for series in plot["series"])]
    if not plots:
        return
    panels = []
    for plot in plots:
        series = [{"mark": "dot", "line": "none", "colour": "", "width": 1.6, "sets_ends": True, **each,
                   "x": [x for x, _ in each["points"]], "y": [y for _, y in each["points"]]} for each in plot["series"]]
        panels.append({"height": 540.0, "regions": [], **plot, "series": series})
    request = {"command": "chart", "format": file.suffix[1:], "heading": plots[0].get("subtitle", ""), "panels": panels}
    done = subprocess.run([os.environ.get("CVTFLOW_PYTHON", "/usr/bin/python3"), "-I", DRAWER], input=json.dumps(request).encode(), stdout=subprocess.PIPE, check=True)
    file.write_bytes(done.stdout)
