"""Requests of the program as calls of the drawing functions."""

import collections

import numpy as np

from . import _known

Column = collections.namedtuple("Column", "name unit description")


class _Table:
    """The columns of a sweep that the program has read, as Table of the compiled module."""

    def __init__(self, described):
        self.path, self.level = described["path"], described["level"]
        self.limits = np.array(described["limits"], dtype=float)
        self._name, self._columns = described["name"], {column["name"]: column for column in described["columns"]}

    def attributes(self):
        return {"sweep": self._name}

    def columns(self):
        return [Column(column["name"], column["unit"], column["description"]) for column in self._columns.values()]

    def read(self, name):
        column = self._columns[name]
        return np.array(column["values"], dtype=float) if column["number"] else list(column["values"])


def records(request):
    """Records of a request. Their paths in pictures and messages are those that the user has entered."""
    from ._draw import file_of
    from ._series import Record

    found = []
    for described in request["records"]:
        record = Record(file_of(described))
        record.path = described["path"]
        found.append(record)
    return found


def sweeps(request):
    """Results of a request."""
    from ._tables import Results

    return [Results(_Table(described)) for described in request["sweeps"]]


def measured(request):
    """Measured data of a request; None: there are none."""
    from ._measured import Measured

    return Measured.received(request["with"]) if "with" in request else None


def receive(request):
    """Makes what the program knows known to the package."""
    _known.received.update(request["known"])
    described = request.get("records", [])
    _known.received["scenes"] = {each["path"]: each["scene"] for each in described}
    _known.received["texts"] = {each["path"]: each["texts"] for each in described}
    _known.received["keys"] = {column["name"] for each in request.get("sweeps", []) for column in each["columns"] if column["axis"]}


def _plot(request):
    """The figure that `cvtflow plot` requests."""
    from . import maps, plots

    options, kind = request["options"], request["kind"]
    units, chosen = {"si": options["si"]}, options["channels"]
    if kind == "cases":
        return maps.lines(sweeps(request), options["x"], options["y"], measured=measured(request), where=options["where"], **units)
    if kind == "map":
        return maps.maps(sweeps(request), options["x"], options["y"], options["colour"], where=options["where"], **units)
    opened = records(request)
    if kind == "curves":
        return plots.curves(opened, chosen, options["x"], measured(request), options["every_output"], **units)
    if kind == "orders":
        return plots.orders(opened, chosen, **units)
    if kind == "round":
        return plots.round_of_pin(opened, **units)
    if kind == "wear" and len(opened) > 1:
        raise _known.Misuse("--wear draws one record")
    return plots.wear(opened[0]) if kind == "wear" else plots.losses(opened)


def made(request):
    """The bytes of the file that a request describes."""
    _known.received["command"] = request["command"]  # there is no compiled module
    if request["command"] == "report":
        from . import pages

        receive(request)
        return pages.requested(request)
    if request["command"] == "rainflow":
        from . import _loads

        receive(request)
        return _loads.requested(request, records(request)[0])
    if request["command"] in ("reduce", "clamp"):
        from . import _clamp, _reduction

        _known.received.update(request["known"])
        return (_reduction if request["command"] == "reduce" else _clamp).requested(request)
    from . import _figures

    if request["command"] == "chart":
        panels = [_figures.panel_of(each) for each in request["panels"]]
        drawn = None if request["format"] == "csv" else _figures.draw(panels, request.get("heading", ""))
    elif request["command"] == "choices":
        from . import plots

        drawn = plots.choices(request["tuning"])
        panels = drawn.panels
    else:
        receive(request)
        drawn = _plot(request)
        panels = drawn.panels
        if not panels:
            first = request["records"][0]["path"]
            raise _known.Misuse(f"nothing to draw: name a channel (cvtflow info {first})")
    return _figures.csv(panels) if request["format"] == "csv" else _figures.picture(drawn, request["format"], request.get("mark", ""))
