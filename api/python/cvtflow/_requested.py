"""Requests of the program as calls of the drawing functions."""


def made(request):
    """The bytes of the picture that a request describes."""
    from . import _figures, plots

    _figures.in_notebooks = False
    return _figures.picture(plots.choices(request["tuning"]), request["format"], request.get("mark", ""))
