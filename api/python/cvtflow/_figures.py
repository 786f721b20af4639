"""Pictures as data, drawn by Matplotlib in one style: panels below one another, of curves, bars or a map; the same numbers as CSV."""

import dataclasses
import functools
import importlib
import io
import itertools
import math
import os
import re
import sys
import textwrap

import matplotlib
import numpy as np

from .commands._columns import csv_cell

STYLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cvtflow.mplstyle")
_LEGEND = 26  # characters of a name in a legend beside the frame
_WIDTH, _HEIGHT, _LOW = 8.6, 5.4, 3.0  # of a picture with one panel, of one of several [inch]
_MANY_DECADES = 1e3  # between the ends of an axis, where it has no minor ticks
_FEW_DECADES = 200.0  # the same, where it has numbers at 2 and 5 as well
_DASHES = ["solid", "dashed", "dotted", "dashdot"]
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclasses.dataclass
class Line:
    """A curve or points. Points that are not finite interrupt it."""

    name: str
    x: np.ndarray
    y: np.ndarray
    style: dict = dataclasses.field(default_factory=dict)  # of Axes.plot; {"stairs": edges} draws steps
    sets_ends: bool = True  # whether axes reach its points
    in_legend: bool = True


@dataclasses.dataclass
class Field:
    """A quantity over two others, case by case. bad: groups of cases without a value of their own, (name, indices, hatch)."""

    label: str
    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    bad: list = dataclasses.field(default_factory=list)
    range: tuple = ()  # of the colours; empty: that of the values


@dataclasses.dataclass
class Panel:
    """A frame with its axes. bars: (name, [(value, text) of each kind]); kinds: names of what is side by side."""

    title: str
    x: str
    y: str
    lines: list = dataclasses.field(default_factory=list)
    bars: list = dataclasses.field(default_factory=list)
    kinds: list = dataclasses.field(default_factory=list)
    fields: list = dataclasses.field(default_factory=list)
    regions: list = dataclasses.field(default_factory=list)  # (name, colour, x, y, inside [y, x])
    scales: tuple = ("linear", "linear")  # or "log", or ("symlog", linear up to)
    x_ends: tuple = ()
    y_ends: tuple = ()
    equal: bool = False
    height: float = 0.0  # [inch]; 0: by the number of panels


def style():
    """The context in which pictures are drawn."""
    return matplotlib.rc_context({name: value for name, value in matplotlib.rcParamsDefault.items() if name not in _KEPT} | _own())


_KEPT = ("backend", "backend_fallback", "interactive", "toolbar", "timezone", "webagg.address", "webagg.port", "webagg.port_retries",
         "webagg.open_in_browser", "savefig.directory", "examples.directory", "date.epoch", "tk.window_focus", "animation.writer")


@functools.lru_cache(maxsize=None)
def _own():
    return matplotlib.rc_params_from_file(STYLE, use_default_template=False)


def colour(number):
    """The colour of the curve of that number."""
    colours = _own()["axes.prop_cycle"].by_key()["color"]
    return "#" + colours[number % len(colours)].lstrip("#")


def dashes(number):
    """Where colours repeat, lines differ."""
    return _DASHES[number // len(_own()["axes.prop_cycle"]) % len(_DASHES)]


in_notebooks = True  # whether figures are pyplot's; the program draws without it, in a third of the time


def figure(width, height):
    """A figure: pyplot's, which notebooks and windows show, but not where the program draws."""
    if in_notebooks:
        from matplotlib import pyplot

        return pyplot.figure(figsize=(width, height), layout="constrained")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(made)
    return made


def plain(text):
    """A text of a file in a picture: dollars are no formula."""
    return str(text).replace("$", r"\$")


def wrapped(name, width=90):
    """A name in lines of a legend, also broken behind slashes of a path."""
    if len(name) <= width:
        return plain(name)
    return plain("\n".join(textwrap.wrap(name.replace("/", "/\u200b"), width, break_on_hyphens=False)).replace("\u200b", ""))


def draw(panels, heading="", ax=None):
    """A figure of panels below one another. heading: conditions above them. ax: Axes, one for each panel; None: a new figure."""
    with style():
        if ax is not None:
            axes = list(np.atleast_1d(ax).flat)
            made = axes[0].figure
        else:
            heights = [(panel.height or (_LOW if len(panels) > 1 else _HEIGHT)) + _legend_height(panel) for panel in panels]
            lines = textwrap.wrap(heading, 130)
            made = figure(_WIDTH, sum(heights) + 0.18 * len(lines))
            axes = made.subplots(len(panels), 1, squeeze=False, gridspec_kw={"height_ratios": heights})[:, 0]
            if lines:
                made.suptitle(plain("\n".join(lines)), x=0.01, ha="left", fontsize=8.5, color="#555555")
            for axis, panel in list(zip(axes, panels))[1:]:
                if panel.x == panels[0].x and panel.scales[0] == panels[0].scales[0] and not panel.bars:
                    axis.sharex(axes[0])
        if len(axes) < len(panels):
            raise ValueError(f"ax: {len(panels)} panels require as many Axes")
        for number, (axis, panel) in enumerate(zip(axes, panels), 1):
            below = panels[number:]
            _fill(axis, panel, ax is not None or not (below and below[0].x == panel.x and below[0].scales[0] == panel.scales[0]))
        made.panels = panels
    return made


def _fill(axis, panel, is_last):
    from matplotlib.ticker import LogLocator, NullLocator

    axis.set_title(plain(panel.title), wrap=False)
    for which, scale in zip("xy", panel.scales):
        kind, *more = [scale] if isinstance(scale, str) else scale
        getattr(axis, f"set_{which}scale")(kind, **({"linthresh": more[0]} if more else {}))
        if kind != "linear":
            _plain_numbers(getattr(axis, f"{which}axis"), kind == "log" and bool(panel.fields))
    for name, tint, x, y, inside in panel.regions:
        _region(axis, name, tint, x, y, inside)
    if panel.bars:
        _bars(axis, panel)
    for field in panel.fields:
        _field(axis, field, panel.scales)
    _lines(axis, panel)
    if not panel.bars:
        axis.set_xlabel(plain(panel.x) if is_last else "")
        axis.set_ylabel(plain(panel.y))
    if panel.x_ends:
        axis.set_xlim(*panel.x_ends)
    if panel.y_ends:
        axis.set_ylim(*panel.y_ends)
    if panel.equal:
        axis.set_aspect("equal", adjustable="datalim")
    for each, ends in ((axis.xaxis, axis.get_xlim()), (axis.yaxis, axis.get_ylim())):
        if each.get_scale() == "log" and ends[1] > _MANY_DECADES * ends[0]:
            each.set_minor_locator(NullLocator())
        elif each.get_scale() == "log" and ends[1] < _FEW_DECADES * ends[0] and not panel.fields:
            each.set_major_locator(LogLocator(10.0, subs=(1.0, 2.0, 5.0)))
    if axis.get_legend_handles_labels()[0]:
        _legend(axis, panel, is_last)


def _legend_names(panel):
    return [line.name for line in panel.lines if line.name and line.in_legend] + panel.kinds


def _legend_columns(panel):
    """Columns of a legend below the frame; 0: it has room beside it."""
    longest = max(map(len, _legend_names(panel)), default=0)
    return max(1, min(4, 112 // (longest + 6))) if longest > _LEGEND or panel.bars and panel.kinds else 0   # texts of bars need the room


def _legend_height(panel):
    """Of a legend below the frame [inch]."""
    columns = _legend_columns(panel)
    return 0.1 + 0.19 * math.ceil(len(_legend_names(panel)) / columns) if columns else 0.0


def _legend(axis, panel, is_last):
    """Beside the frame; below it where names are long, and of a map, whose colours are beside it."""
    from matplotlib.transforms import ScaledTranslation

    columns = 4 if panel.fields else _legend_columns(panel)
    if columns:
        under = axis.transAxes + ScaledTranslation(0.0, -0.5 if is_last else -0.3, axis.figure.dpi_scale_trans)
        axis.legend(loc="upper left", bbox_to_anchor=(0.0, 0.0), bbox_transform=under, borderaxespad=0.0, ncols=columns)
    else:
        axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.4)


def _tick(value, _=None):
    """0.01, 0.002, 10⁻³, 2·10⁻⁵, 10⁴: the number at a tick."""
    exponent = math.floor(math.log10(value) + 1e-9) if value > 0.0 else 0
    leading = f"{value / 10.0 ** exponent:g}"
    if abs(exponent) < 3 or exponent == -3 and leading != "1":
        return f"{value:g}"
    return ("" if leading == "1" else leading + "·") + "10" + str(exponent).translate(_RAISED)


def _plain_numbers(axis, ratio):
    """0.01 and 100 instead of near powers. ratio: of speeds, over one decade or two: 0.5, 1, 2."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    if ratio:
        axis.set_major_locator(LogLocator(10.0, subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
    axis.set_major_formatter(FuncFormatter(_tick))
    axis.set_minor_formatter(NullFormatter())


def _region(axis, name, tint, x, y, inside):
    axis.contourf(x, y, inside.astype(float), levels=[0.5, 1.5], colors=[tint], zorder=0.5)
    if name:
        axis.fill_between([], [], color=tint, label=wrapped(name))


def _bars(axis, panel):
    """Bars from top to bottom; of two kinds side by side, A above B."""
    kinds = max(1, len(panel.kinds))
    thick = 0.8 / kinds
    for kind in range(kinds):
        values = [row[kind][0] for _, row in panel.bars]
        place = np.arange(len(values)) - 0.4 + (kind + 0.5) * thick
        drawn = axis.barh(place, values, thick * 0.92, label=wrapped(panel.kinds[kind]) if panel.kinds else None, color=colour(kind))
        axis.bar_label(drawn, [row[kind][1] for _, row in panel.bars], padding=4, fontsize=9)
    axis.set_yticks(range(len(panel.bars)), [plain(name) for name, _ in panel.bars])
    axis.invert_yaxis()
    axis.grid(False, axis="y")
    axis.tick_params(axis="y", length=0)
    axis.margins(x=0.28, y=0.02)
    axis.set_xlim(left=min(0.0, axis.get_xlim()[0]))
    axis.set_xlabel(plain(panel.y))


def _lines(axis, panel):
    free = itertools.count()
    if any(line.style.get("linestyle") in ("none", "None", "") for line in panel.lines):
        axis.margins(x=0.03)  # points keep off the frame
    for line in panel.lines:
        look = dict(line.style)
        if "color" not in look:
            number = next(free)
            look |= {"color": colour(number)} | ({"linestyle": dashes(number)} if "linestyle" not in look and dashes(number) != "solid" else {})
        label = wrapped(line.name) if line.name and line.in_legend else None
        if "stairs" in look:
            axis.stairs(line.y, look.pop("stairs"), label=label, **look)
            continue
        ends = axis.axis() if not line.sets_ends else None
        axis.plot(line.x, line.y, label=label, **look)
        if ends:
            axis.axis(ends)


def _levels(low, high):
    """Round levels of a map within its values, about eight; none of a map of one value."""
    from matplotlib.ticker import MaxNLocator

    if not high - low > 1e-9 * max(abs(low), abs(high)):
        return np.empty(0)
    levels = MaxNLocator(9, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    return levels[(levels > low) & (levels < high)]


def _field(axis, field, scales):
    """Colours with labelled contours, between the cases of a grid or by triangles; cases on one line, or fewer than four: coloured points."""
    from matplotlib.colors import Normalize

    finite = np.isfinite(field.values) & np.isfinite(field.x) & np.isfinite(field.y)
    x, y, values = field.x[finite], field.y[finite], field.values[finite]
    norm = Normalize(*(field.range or (values.min(), values.max())))
    if not norm.vmax > norm.vmin:
        norm.vmin, norm.vmax = norm.vmin - 1e-3 * abs(norm.vmin) - 1e-12, norm.vmax + 1e-3 * abs(norm.vmax) + 1e-12
    triangles = _triangles(x, y, scales) if len(values) > 3 else None
    if triangles is None:
        drawn = axis.scatter(x, y, c=values, s=40, norm=norm, zorder=2)
        levels = np.empty(0)
    else:
        levels = _levels(norm.vmin, norm.vmax)
        within = levels[(levels > values.min()) & (levels < values.max())]  # of several maps with one scale
        drawn = _coloured(axis, _grid(field, triangles, values, scales) or (triangles, values), norm, within)
        axis.plot(x, y, ".", color="black", markersize=2.5, zorder=2)
    bar = axis.figure.colorbar(drawn, ax=axis, pad=0.02, aspect=30, format=lambda value, _: f"{value:.6g}")
    if len(levels):
        bar.set_ticks(levels)
    bar.set_label(plain(field.label))
    bar.outline.set_visible(False)
    _bad_cases(axis, field, drawn)
    axis.use_sticky_edges = False
    axis.margins(0.03)


def _is_light(tint):
    return np.dot(tint[:3], (0.299, 0.587, 0.114)) > 0.5


def _coloured(axis, what, norm, levels):
    """Colours of a grid (x, y, values) or of triangles with values, contours above them that differ from the colour below."""
    smooth = np.linspace(norm.vmin, norm.vmax, 81)
    by_triangles = len(what) == 2
    drawn = (axis.tricontourf if by_triangles else axis.contourf)(*what, levels=smooth, norm=norm, zorder=1)
    for part in drawn.collections:
        part.set(edgecolor="face", rasterized=True)  # no white seams; in a SVG one image instead of 80 shapes
    if len(levels):
        tints = ["#222222" if _is_light(drawn.cmap(norm(level))) else "white" for level in levels]
        lines = (axis.tricontour if by_triangles else axis.contour)(*what, levels=levels, colors=tints, linewidths=0.9, zorder=1.5)
        axis.clabel(lines, fontsize=9, colors=tints, fmt=lambda value: f"{value:.6g}", inline_spacing=3)
    return drawn


def _grid(field, triangles, values, scales):
    """Values between the cases of a grid, finer; places without a value by the triangles around them. None: the cases form no grid."""
    from matplotlib.tri import LinearTriInterpolator

    xs, ys = (np.unique(each[np.isfinite(each)]) for each in (field.x, field.y))
    if len(xs) * len(ys) > 2 * len(field.values) or len(xs) < 2 or len(ys) < 2:
        return None
    table = np.full((len(ys), len(xs)), np.nan)
    table[np.searchsorted(ys, field.y), np.searchsorted(xs, field.x)] = field.values
    across, up = np.meshgrid(xs, ys)
    between = LinearTriInterpolator(triangles, values)(across, up).filled(np.nan)
    table = np.where(np.isfinite(table), table, between)
    for axis, (places, scale) in enumerate(((ys, scales[1]), (xs, scales[0]))):
        steps = np.arange(0.0, len(places) - 1.0 + 1e-9, 1.0 / max(1, 160 // len(places)))
        below = np.minimum(steps.astype(int), len(places) - 2)
        share = steps - below
        first, second = np.take(table, below, axis), np.take(table, below + 1, axis)
        weight = share[:, None] if axis == 0 else share[None, :]
        table = np.where(weight == 0.0, first, np.where(weight == 1.0, second, first + weight * (second - first)))
        placed = np.log(places) if scale == "log" else places
        finer = placed[below] + share * (placed[below + 1] - placed[below])
        finer = np.exp(finer) if scale == "log" else finer
        xs, ys = (finer, ys) if axis else (xs, finer)
    return xs, ys, np.ma.masked_invalid(table)


def _placed(values, scale):
    """Coordinates as lengths in the picture, 0 … 1."""
    values = np.log(values) if scale == "log" else values
    return (values - values.min()) / (np.ptp(values) or 1.0)


def _triangles(x, y, scales):
    """Triangles between the cases, near equilateral in the picture; None where all lie on a line. Narrow ones at the border, which jump over
    what no case covers, are masked."""
    from matplotlib.tri import TriAnalyzer, Triangulation

    across, up = _placed(x, scales[0]), _placed(y, scales[1])
    if np.linalg.matrix_rank(np.column_stack([across - across[0], up - up[0]]), tol=1e-6) < 2:
        return None
    try:
        of_picture = Triangulation(across, up)
    except (RuntimeError, ValueError):  # cases at one place
        return None
    made = Triangulation(x, y, of_picture.triangles)
    made.set_mask(TriAnalyzer(of_picture).get_flat_tri_mask(0.02, rescale=False))
    return made


def _bad_cases(axis, field, drawn):
    """Cells of cases that failed, or whose means are not steady: hatched, counted in the legend."""
    xs, ys = np.unique(field.x[np.isfinite(field.x)]), np.unique(field.y[np.isfinite(field.y)])
    for name, rows, hatch in field.bad:
        for row in rows:
            box = [_cell(value, places, scale) for value, places, scale in
                   ((field.x[row], xs, axis.get_xscale()), (field.y[row], ys, axis.get_yscale()))]
            if all(box):
                (left, right), (bottom, top) = box
                dark = np.isfinite(field.values[row]) and not _is_light(drawn.cmap(drawn.norm(field.values[row])))
                axis.fill([left, right, right, left], [bottom, bottom, top, top], fill=False, hatch=hatch, linewidth=0.0,
                          edgecolor="#bbbbbb" if dark else "#555555", zorder=1.8)
        axis.fill([], [], fill=False, hatch=hatch, edgecolor="#555555", label=f"{name} ({len(rows)})")


def _cell(value, values, scale):
    """From half way to the neighbour before to half way to the one behind; of many places, as of measured quantities, a fortieth of the axis."""
    if not math.isfinite(value) or not len(values):
        return None
    log = scale == "log" and values[0] > 0.0
    values, value = (np.log(values), math.log(value)) if log else (values, value)
    span = (values[-1] - values[0]) or abs(value) or 1.0
    if len(values) > 40:
        ends = value - span / 80, value + span / 80
    else:
        k = int(np.argmin(np.abs(values - value)))
        before = values[k - 1] if k > 0 else values[k]
        behind = values[k + 1] if k + 1 < len(values) else values[k]
        ends = 0.5 * (value + before), 0.5 * (value + behind)
    return tuple(np.exp(ends)) if log else ends


def csv(panels):
    """What panels show, as rows plot, series, x, y, (value,) x axis, y axis."""
    with_values = any(panel.fields for panel in panels)
    text = io.StringIO()

    def put(panel, series, x, y, value=None):
        title, name, *ends = (csv_cell(cell, quoted=True) for cell in (panel.title, series, panel.x, panel.y))
        cells = [title, name, f"{x:.9g}", f"{y:.9g}"] + ([value or ""] if with_values else [])
        text.write(",".join(cells + ends) + "\n")

    text.write("plot,series,x,y,value,x axis,y axis\n" if with_values else "plot,series,x,y,x axis,y axis\n")
    for panel in panels:
        for field in panel.fields:
            for x, y, value in zip(field.x, field.y, field.values):
                put(panel, field.label, x, y, f"{value:.9g}")
        for number, (name, values) in enumerate(panel.bars):
            for kind, (value, _) in enumerate(values):
                put(panel, f"{name}, {panel.kinds[kind]}" if panel.kinds else name, number, value)
        for line in panel.lines:
            edges = line.style.get("stairs")
            x, y = (np.repeat(edges, 2)[1:-1], np.repeat(line.y, 2)) if edges is not None else (line.x, line.y)
            for across, up in zip(np.asarray(x, dtype=float), np.asarray(y, dtype=float)):
                if math.isfinite(across) and math.isfinite(up):
                    put(panel, line.name or panel.title, across, up)
    return text.getvalue().encode()


def picture(made, kind):
    """A figure as bytes of SVG, PNG or PDF, the same every time."""
    backend = importlib.import_module(f"matplotlib.backends.backend_{'agg' if kind == 'png' else kind}")  # PDF's takes 0.1 s
    engine, canvas, dpi, text = made.get_layout_engine(), made.canvas, made.dpi, io.BytesIO()
    try:
        with style():
            if engine is not None:
                engine.execute(made)
                made.set_layout_engine("none")
            drawn = backend.FigureCanvas(made)
            made.dpi = matplotlib.rcParams["savefig.dpi"]
            if kind == "png":  # Figure.savefig draws everything twice
                drawn.print_png(text, metadata={"Software": None}, pil_kwargs={"compress_level": 3})
            elif kind == "pdf":
                drawn.print_pdf(text, metadata=dict.fromkeys(("CreationDate", "Creator", "Producer")))
            else:
                drawn.print_svg(text, metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    finally:
        made.dpi = dpi
        made.set_canvas(canvas)
        made.set_layout_engine(engine)
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close(made)
    return _plain_svg(text.getvalue().decode()) if kind == "svg" else text.getvalue()


def _plain_svg(svg):
    svg = re.sub(r"\n <metadata>.*?</metadata>", "", svg[svg.index("<svg"):], flags=re.DOTALL)
    svg = re.sub(r' d="([^"]*)"', lambda path: ' d="' + re.sub(r"(\.\d\d)\d+", r"\1", path[1]) + '"', svg)
    return svg.encode()
