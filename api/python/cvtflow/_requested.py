"""Requests of the program as calls of the drawing functions."""


def made(request):
    """The bytes of the file that a request describes."""
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
