"""`cvtflow draw`, which programs of cvtflow call and no user: a picture of what stdin describes as JSON, on stdout.

"format": svg, png or csv; "mark": text in the head; "tuning": choices of `cvtflow tune --json`, or "panels" and their "heading".
"""

import json
import os
import sys

from ._front import matplotlib, require

DESCRIPTION = "Draw what stdin describes"


def declare(parser):
    """Takes no arguments."""


def act(given):
    require("a picture", "numpy", "matplotlib")
    request, output = json.load(sys.stdin.buffer), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is a message
    matplotlib()
    from .. import _figures

    _figures.in_notebooks = False
    if "tuning" in request:
        from .. import plots

        drawn = plots.choices(request["tuning"])
    else:
        drawn = _figures.draw([_figures.panel_of(each) for each in request["panels"]], request.get("heading", ""))
    output.write(_figures.csv(drawn.panels) if request["format"] == "csv"
                 else _figures.picture(drawn, request["format"], request.get("mark", "")))
    output.close()
