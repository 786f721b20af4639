"""`cvtflow draw`, which `cvtflow tune` calls and no user: a picture of what stdin describes as JSON, on stdout.

"tuning": choices as of `cvtflow tune --json`; "mark": text in the head.
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
    from .. import _figures, plots

    _figures.in_notebooks = False
    output.write(_figures.picture(plots.choices(request["tuning"]), "svg", request["mark"]))
    output.close()
