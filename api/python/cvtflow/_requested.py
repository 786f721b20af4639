"""Requests of the program as calls of the drawing functions."""


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


def made(request):
    """The bytes of the file that a request describes."""
    if request["command"] == "rainflow":
        from . import _loads

        return _loads.requested(request, records(request)[0])
    from . import _figures

    _figures.in_notebooks = False
    if request["command"] == "chart":
        panels = [_figures.panel_of(each) for each in request["panels"]]
        drawn = None if request["format"] == "csv" else _figures.draw(panels, request.get("heading", ""))
    else:
        from . import plots

        drawn = plots.choices(request["tuning"])
        panels = drawn.panels
    return _figures.csv(panels) if request["format"] == "csv" else _figures.picture(drawn, request["format"], request.get("mark", ""))
