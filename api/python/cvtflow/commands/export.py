"""`cvtflow export`: a record for other programs."""

import io
import math
import os
import re
from html import escape

from .._output import Output, OutputError, give_name, sync_folder
from ._front import FORCE, UsageError, between, file_or_result, require, say

DESCRIPTION = "Write a record for other programs: channels as CSV, pins and plates for ParaView"
FOOTER = """
ParaView shows the forces that were recorded: with --set 'record.channels=["plates/*", "tips/*", "halves/*", "joints/*"]' all of them.
"""


def declare(parser):
    add = parser.add_argument
    add("record", type=file_or_result(files=True), help="Record of a run; ParaView shows its states (run.state_interval)")
    add("channels", metavar="CHANNEL", nargs="*", help="With --csv: channels, groups or elements (default: all channels of one number)")
    add("--csv", metavar="FILE", help="Table to write: one row per output, one column per number, units in the heading")
    add("--vtk", metavar="FILE.pvd",
        help="Collection to write for ParaView; its states go to the folder FILE: pins, plates and sheaves with forces")
    add("--every", metavar="COUNT", type=between(int, 1, 1_000_000), default=1, help="Write every COUNT-th state only")
    add("--force", action="store_true", help=FORCE)


def act(given):
    require("export", "numpy", "h5py")
    if bool(given.vtk) == bool(given.csv):
        raise UsageError("exactly one of --csv FILE and --vtk FILE.pvd is required")
    if given.vtk and given.channels:
        raise UsageError("channels require --csv")
    if given.vtk and os.path.splitext(given.vtk)[1] != ".pvd":
        raise UsageError(f"--vtk {given.vtk}: the name must end in .pvd")
    from . import _inputs

    record = _inputs.records([given.record])[0]
    what = _csv(given, record) if given.csv else _vtk(given, record)
    print(f"  {'written':<20}{what}")


def _csv(given, record):
    from .._courses import find

    def parts(channel, width):
        return [channel] if width == 1 else [f"{channel}[{k}]" for k in range(width)]

    names = [name for word in given.channels for name in find(record, word, parts)]
    names = names or [name for name, column in record.info.items() if column.width == 1]
    output = Output(given.csv, inputs=[given.record], force=given.force)
    units = {name: record.info[name.partition("[")[0]].unit or "1" for name in names}
    kept = {}  # a channel is read once for all its elements
    columns = [record["time"]]
    for name in names:
        channel, _, element = name.partition("[")
        values = kept.setdefault(channel, record[channel])
        columns.append(values[:, int(element[:-1])] if element else values)
    text = io.StringIO()
    text.write(",".join(["time [s]", *(f"{name} [{unit}]" for name, unit in units.items())]) + "\n")
    for row in zip(*(column.tolist() for column in columns)):
        text.write(",".join("" if value != value or abs(value) == math.inf else repr(value).removesuffix(".0") for value in row) + "\n")
    output.write(text.getvalue().encode())
    if output.notice:
        say(output.notice)
    return f"{given.csv}, {record.rows} row{'s' * (record.rows != 1)} of {len(columns)} columns"


def _vtk(given, record):
    from .. import _vtk as vtk

    output = Output(given.vtk, inputs=[given.record], force=given.force)
    if not len(record.states):
        raise ValueError(f"{record.path}: contains no states")
    if record.scene is None:
        raise ValueError(f"{record.path}: contains no parameters of a machine")
    solids = vtk.Solids(record)
    folder = os.path.splitext(given.vtk)[0]
    name, growing = os.path.basename(folder), folder + ".part"
    own = re.compile(re.escape(name) + r"_(\d{6,})\.vtu(\.part)?")
    for place in (folder, growing):
        if os.path.islink(place):
            raise OutputError(f"{place}: cannot be created: a symbolic link; name its target")
        if os.path.lexists(place) and not os.path.isdir(place):
            raise OutputError(f"{place}: cannot be created: a file, not a folder")
        for entry in sorted(os.listdir(place)) if os.path.isdir(place) else ():
            if not own.fullmatch(entry):
                continue
            if os.path.islink(file := os.path.join(place, entry)):
                raise OutputError(f"{file}: cannot create: a symbolic link; name its target")
            if not given.force or not os.path.isfile(file):
                raise OutputError(f"{file}: already exists; --force replaces the series there")
    there = os.path.isdir(folder)
    try:
        os.makedirs(folder, exist_ok=True)
        rows = _files(solids, range(0, len(record.states), given.every), growing, name)
        for _, entry in rows:
            give_name(os.path.join(growing, entry), os.path.join(folder, entry), lambda: given.force)
        output.write(vtk.collection([(time, escape(f"{name}/{entry}")) for time, entry in rows]).encode())
    except OSError as error:
        if not there and os.path.isdir(folder) and not os.listdir(folder):
            os.rmdir(folder)
        if isinstance(error, OutputError):
            raise
        for entry in filter(own.fullmatch, os.listdir(growing) if os.path.isdir(growing) else ()):
            os.remove(os.path.join(growing, entry))
        raise OutputError(f"{folder}: cannot write: {error.strerror}") from None
    finally:
        if os.path.isdir(growing) and not os.listdir(growing):
            os.rmdir(growing)
    for entry in os.listdir(folder):
        if (found := own.fullmatch(entry)) and int(found[1]) >= len(rows):
            os.remove(os.path.join(folder, entry))
    if output.notice:
        say(output.notice)
    size = sum(os.path.getsize(os.path.join(folder, entry)) for _, entry in rows) + os.path.getsize(given.vtk)
    return f"{given.vtk}, {len(rows)} state{'s' * (len(rows) != 1)} of {len(solids.offsets)} cells, {1e-6 * size:.3g} MB"


def _files(solids, numbers, growing, name):
    """Writes the states, synced. Returns (time [s], name of the file) of each."""
    os.makedirs(growing, exist_ok=True)
    rows = []
    for count, number in enumerate(numbers):
        rows.append((float(solids.record.states.time[number]), f"{name}_{count:06}.vtu"))
        with open(os.path.join(growing, rows[-1][1]), "wb") as file:
            file.write(solids.file(number))
            file.flush()
            os.fsync(file.fileno())
    sync_folder(growing)
    return rows
