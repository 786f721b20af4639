"""`cvtflow fit`: keys of a scene by measured values."""

import math

from .._output import Output
from . import _scenes
from ._columns import table
from ._front import FORCE, UsageError, between, require, say, visible

DESCRIPTION = "Adjust keys of a scene to measured values, with confidence intervals"
FOOTER = """Headings of the data are keys of the scene (operating points) and scalars of a sweep (measured values), with units:
load.torque [N*m], slip mean [%], efficiency mean [%]. A MAT file has vectors load_torque, slip_mean, and their units in the struct
`units`. Every evaluation is a run of each point: set run.until and the level of detail accordingly."""


def declare(parser):
    add = parser.add_argument
    _scenes.declare_scene(parser)
    add("--with", dest="data", metavar="FILE", required=True, help="Measured data: CSV, or MAT of version 7 or earlier")
    add("--key", action="append", required=True, metavar="KEY=LOW:HIGH", help="Key to adjust between two values; may be repeated")
    add("--deviation", action="append", default=[], metavar="SCALAR=VALUE",
        help="Standard deviation of a measured value (default: 1 %% of the largest)".replace("%%", "%"))
    add("--threads", type=between(int, 1, 1024), default=0, metavar="N", help="Threads of the runs (default: all)")
    add("-o", "--output", metavar="FILE", help="Write the scene with the fitted values")
    add("--force", action="store_true", help=FORCE)


def act(given):
    from .. import fit

    require("fit", "numpy", "scipy")
    ranges = {}
    for each in given.key:
        key, _, ends = each.partition("=")
        low, colon, high = ends.partition(":")
        if not colon:
            raise UsageError(f"--key {each}: expected KEY=LOW:HIGH, such as tip.friction_coefficient=0.05:0.14")
        ranges[key] = low, high
    deviations = {name: float(value) for name, _, value in (each.partition("=") for each in given.deviation)}
    output = Output(given.output, inputs=[given.data, given.scene], force=given.force) if given.output else None
    found = fit(_scenes.load(given), ranges, given.data, deviations=deviations, threads=given.threads)
    lines = [[key, f"{value:.5g}", *(f"{end:.5g}" for end in found.confidence[key]), _unit(key)] for key, value in found.values.items()]
    print(table(["key", "value", "from", f"to ({100 * found.level:g} %)", "unit"], lines, [True, False, False, False, True], 2), end="")
    for name, each in found.residuals.items():
        rms = math.sqrt(sum(value * value for value in each) / len(each))
        print(f"  residuals           {name}: rms {rms:.3g}, largest {max(map(abs, each)):.3g} of {len(each)} points, in SI")
    if found.free < 3:
        say(f"{found.free} measured values more than keys: further points narrow the intervals")
    if output:
        output.write(found.scene.text.encode())
        print(visible(given.output))


def _unit(key):
    from .._scene import all_keys

    unit = all_keys()[key].unit
    return "" if unit == "1" else unit
