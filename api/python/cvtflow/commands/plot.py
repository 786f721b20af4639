"""`cvtflow plot`: pictures of records and of sweeps."""

import os

from .._output import Output, inputs_of, picture_path
from ._front import FORCE, SI, UsageError, file_or_result, matplotlib, require, visible

DESCRIPTION = "Draw records or a sweep: curves, orders, losses, maps; SVG, PNG or CSV"
FOOTER = """
cvtflow plot run.h5 slip efficiency          cvtflow plot a.h5 b.h5 shaft_1/speed   (both in one picture)
cvtflow plot run.h5 'tips/axial_force[7]'    cvtflow plot run.h5 tight_tension --orders -o orders.png
cvtflow plot SWEEP --x load.torque --y start.ratio --colour slip_mean --where clamping.driven=20000
cvtflow plot run.h5 --x ratio slip           cvtflow plot run.h5 --x shaft_1/speed efficiency tight_tension
cvtflow plot run.h5 slip --with bench.csv    cvtflow plot SWEEP --x load.torque --y efficiency --with bench.csv
For channels of more than four numbers, minimum, mean and maximum are drawn.
A file that exists is replaced with --force, or under its default name in results/.
"""
ENDINGS = (".svg", ".png", ".pdf", ".csv")


def declare(parser):
    add = parser.add_argument
    add("words", metavar="FILE ... [CHANNEL ...]", nargs="+", type=file_or_result(files=True),
        help="Records or sweeps, then channels or groups of channels (default: channels without a group)")
    add("-o", "--output", metavar="FILE",
        help="Picture or table to write: FILE.svg, FILE.png, FILE.pdf or FILE.csv (default: beside the input, .svg)")
    add("--orders", action="store_true", help="Draw amplitudes over orders of the pin passing frequency")
    add("--every-output", action="store_true",
        help="Draw every output, also for more than 60 pin periods (default then, but for lengths: means over each period)")
    add("--round", action="store_true", help="Draw quantities of the followed pin around the chain's path")
    add("--losses", action="store_true", help="Draw mean losses by kind as bars with their shares; over time: cvtflow plot FILE loss")
    add("--wear", action="store_true", help="Draw wear over the sheaves' radii and over the tips (record.channels = wear/*)")
    add("--x", metavar="COLUMN", help="Along the horizontal axis: column of a sweep, or channel of a record instead of time")
    add("--y", metavar="COLUMN", help="Sweeps: column along the vertical axis")
    add("--colour", metavar="COLUMN", help="Sweeps: column drawn as a map with contours")
    add("--with", metavar="FILE", dest="measured",
        help='Measured data as points: a CSV with headings such as "time [ms]", "slip [%]"')
    add("--where", metavar="COLUMN=VALUE", action="append", default=[], help="Sweeps: only cases with that value; may be repeated")
    add("--si", action="store_true", help=SI)
    add("--force", action="store_true", help=FORCE)


def _sorted_words(words):
    """Files, which come first, and channels: a word that names both a folder and a channel is the channel, behind a record."""
    files, of_record = 1, not os.path.isdir(words[0])
    while files < len(words) and os.path.exists(words[files]) and not (of_record and os.path.isdir(words[files])):
        files += 1
    return words[:files], words[files:]


def _of_records(given, files, channels):
    from .. import plots
    from . import _inputs

    if given.y or given.colour or given.where:
        raise UsageError(f"--y, --colour and --where are for sweeps; {files[0]} is not a sweep")
    if (given.measured or given.x) and (given.wear or given.round or given.orders or given.losses):
        raise UsageError("--with and --x are for curves of channels, and for sweeps")
    if given.wear and len(files) > 1:
        raise UsageError("--wear draws one record")
    records, si = _inputs.records(files), given.si
    if given.wear:
        return plots.wear(records[0])
    if given.round:
        return plots.round_of_pin(records, si=si)
    if given.orders:
        return plots.orders(records, channels, si=si)
    if given.losses:
        return plots.losses(records)
    return plots.curves(records, channels, given.x or "", _inputs.measured(given.measured), given.every_output, si=si)


def _of_sweeps(given, files, channels):
    from .. import maps
    from . import _inputs

    if given.orders or given.round or given.losses or given.wear or channels:
        raise UsageError(f"channels, --orders, --round, --losses and --wear are for records; {files[0]} is a sweep")
    if not given.x or not given.y:
        raise UsageError("a sweep needs --x COLUMN and --y COLUMN; cvtflow table shows its columns")
    if given.measured and given.colour:
        raise UsageError("--with adds points to curves, not to a map (--colour)")
    sweeps = [_inputs.results(file, given.where) for file in files]
    if given.colour:
        return maps.maps(sweeps, given.x, given.y, given.colour, where=given.where, si=given.si)
    return maps.lines(sweeps, given.x, given.y, measured=_inputs.measured(given.measured), where=given.where, si=given.si)


def act(given):
    require("plot", "numpy", "matplotlib", "h5py")
    files, channels = _sorted_words(given.words)
    path = picture_path(given.output, files[0], "plot.svg")
    kind = os.path.splitext(path)[1]
    if kind not in ENDINGS:
        raise UsageError(f"-o {path}: expected FILE.svg, FILE.png, FILE.pdf or FILE.csv")
    output = Output(path, inputs_of([*files, given.measured]), given.force, named=bool(given.output))
    matplotlib()
    from .. import _figures
    from . import _inputs

    _figures.in_notebooks = False
    drawn = (_of_sweeps if _inputs.is_sweep(files[0]) else _of_records)(given, files, channels)
    if not drawn.panels:
        raise UsageError(f"nothing to draw: name a channel (cvtflow info {files[0]})")
    output.write(_figures.csv(drawn.panels) if kind == ".csv" else _figures.picture(drawn, kind[1:]))
    print(visible(path))
