"""Pictures as data, drawn by Matplotlib in one style: panels below one another, of curves, bars or a map; the same numbers as CSV."""

import dataclasses
import io
import itertools
import math
import os
import re
import sys
import textwrap

import matplotlib
import numpy as np

STYLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cvtflow.mplstyle")
_LEGEND = 30  # characters of a line of a legend
_WIDTH, _HEIGHT, _LOW = 8.6, 5.4, 3.0  # of a picture with one panel, of one of several [inch]
_DASHES = ["solid", "dashed", "dotted", "dashdot"]


@dataclasses.dataclass
class Line:
    """A curve or points. Points that are not finite interrupt it."""

    name: str
    x: np.ndarray
    y: np.ndarray
    style: dict = dataclasses.field(default_factory=dict)  # of Axes.plot; {"stairs": edges} draws steps
    sets_ends: bool = True  # whether axes reach its points


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


def _own():
    return matplotlib.rc_params_from_file(STYLE, use_default_template=False)


def colour(number):
    """The colour of the curve of that number."""
    colours = _own()["axes.prop_cycle"].by_key()["color"]
    return "#" + colours[number % len(colours)].lstrip("#")


def dashes(number):
    """Where colours repeat, lines differ."""
    return _DASHES[number // len(_own()["axes.prop_cycle"]) % len(_DASHES)]


def figure(width, height):
    """A figure; with pyplot, if the caller uses it, so that notebooks and windows show it."""
    pyplot = sys.modules.get("matplotlib.pyplot")
    if pyplot is not None:
        return pyplot.figure(figsize=(width, height), layout="constrained")
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def plain(text):
    """A text of a file in a picture: dollars are no formula."""
    return str(text).replace("$", r"\$")


def wrapped(name, width=_LEGEND):
    """A name in lines of a legend, also broken behind slashes of a path."""
    lines = textwrap.wrap(name.replace("/", "/\u200b"), width, break_on_hyphens=False, break_long_words=True) if len(name) > width else [name]
    return plain("\n".join(lines).replace("\u200b", ""))


def draw(panels, heading="", ax=None):
    """A figure of panels below one another. heading: conditions above them. ax: Axes, one for each panel; None: a new figure."""
    with style():
        if ax is not None:
            axes = list(np.atleast_1d(ax).flat)
            made = axes[0].figure
        else:
            heights = [panel.height or (_LOW if len(panels) > 1 else _HEIGHT) for panel in panels]
            lines = textwrap.wrap(heading, 118)
            made = figure(_WIDTH, sum(heights) + 0.18 * len(lines))
            axes = made.subplots(len(panels), 1, squeeze=False, gridspec_kw={"height_ratios": heights})[:, 0]
            if lines:
                made.suptitle(plain("\n".join(lines)), x=0.01, ha="left", fontsize=8.5, color="#555555")
            for first, other in zip(itertools.repeat(0), range(1, len(panels))):
                if panels[other].x == panels[first].x and panels[other].scales[0] == panels[first].scales[0]:
                    axes[other].sharex(axes[first])
        if len(axes) < len(panels):
            raise ValueError(f"ax: {len(panels)} panels require as many Axes")
        for axis, panel in zip(axes, panels):
            _fill(axis, panel)
        made.panels = panels
    return made


def _fill(axis, panel):
    axis.set_title(plain(panel.title), wrap=False)
    for which, scale in zip("xy", panel.scales):
        kind, *more = [scale] if isinstance(scale, str) else scale
        getattr(axis, f"set_{which}scale")(kind, **({"linthresh": more[0]} if more else {}))
        if kind == "log" and which in "xy" and panel.fields:
            _plain_log(getattr(axis, f"{which}axis"))
    for name, tint, x, y, inside in panel.regions:
        _region(axis, name, tint, x, y, inside)
    if panel.bars:
        _bars(axis, panel)
    for field in panel.fields:
        _field(axis, field, panel.scales)
    _lines(axis, panel)
    if not panel.bars:
        axis.set_xlabel(plain(panel.x))
        axis.set_ylabel(plain(panel.y))
    if panel.x_ends:
        axis.set_xlim(*panel.x_ends)
    if panel.y_ends:
        axis.set_ylim(*panel.y_ends)
    if panel.equal:
        axis.set_aspect("equal", adjustable="datalim")
    if axis.get_legend_handles_labels()[0]:
        axis.legend(loc="upper left", bbox_to_anchor=(1.0 if not panel.fields else 0.0, 1.0 if not panel.fields else -0.16),
                    borderaxespad=0.4, ncols=3 if panel.fields else 1)


def _plain_log(axis):
    """A speed ratio over one decade or two: 0.5, 1, 2 instead of powers."""
    from matplotlib.ticker import FuncFormatter, LogLocator

    axis.set_major_locator(LogLocator(10.0, subs=(1.0, 2.0, 5.0)))
    axis.set_minor_locator(LogLocator(10.0, subs=(1.5, 3.0, 4.0, 7.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(FuncFormatter(lambda value, _: ""))


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
    for line in panel.lines:
        look = dict(line.style)
        if "color" not in look:
            number = next(free)
            look |= {"color": colour(number)} | ({"linestyle": dashes(number)} if "linestyle" not in look and dashes(number) != "solid" else {})
        label = wrapped(line.name) if line.name else None
        edges = look.pop("stairs", None)
        if edges is not None:
            fill = look.pop("fill", False)
            axis.stairs(line.y, edges, label=label, **look)
            if fill:
                axis.stairs(line.y, edges, fill=True, alpha=0.15, color=look["color"])
            continue
        ends = axis.axis() if not line.sets_ends else None
        axis.plot(line.x, line.y, label=label, **look)
        if ends:
            axis.axis(ends)


def _levels(low, high):
    """Round levels of a map, about eight; a map of one value has one colour."""
    from matplotlib.ticker import MaxNLocator

    if not high > low or high - low < 1e-9 * max(abs(low), abs(high)):
        pad = max(abs(low), 1e-12) * 1e-3
        return np.array([low - pad, low + pad])
    return MaxNLocator(9, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)


def _field(axis, field, scales):
    """Colours with labelled contours, by triangles between the cases; cases at one line, or fewer than four: coloured points."""
    finite = np.isfinite(field.values) & np.isfinite(field.x) & np.isfinite(field.y)
    x, y, values = field.x[finite], field.y[finite], field.values[finite]
    if not len(values):
        _bad_cases(axis, field, None)
        return
    levels = _levels(*(field.range or (values.min(), values.max())))
    triangles = _triangles(x, y, scales) if len(values) > 3 and len(levels) > 2 else None
    if triangles is None:
        drawn = axis.scatter(x, y, c=values, s=40, vmin=levels[0], vmax=levels[-1], zorder=2)
    else:
        smooth = np.linspace(levels[0], levels[-1], 8 * (len(levels) - 1) + 1)
        drawn = axis.tricontourf(triangles, values, levels=smooth, zorder=1)
        for part in drawn.collections if hasattr(drawn, "collections") else [drawn]:
            part.set_edgecolor("face")  # no white seams between the colours
        lines = axis.tricontour(triangles, values, levels=levels, colors="white", zorder=1.5)
        axis.clabel(lines, fontsize=9, colors="black", inline=True)
        for text in lines.labelTexts:
            text.set_bbox({"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.8})
        axis.plot(x, y, ".", color="black", markersize=2.5, zorder=2)
    bar = axis.figure.colorbar(drawn, ax=axis, pad=0.02, aspect=30)
    if len(levels) > 2:
        bar.set_ticks([level for level in levels if levels[0] <= level <= levels[-1]])
    bar.set_label(plain(field.label))
    bar.outline.set_visible(False)
    _bad_cases(axis, field, triangles)


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


def _bad_cases(axis, field, triangles):
    """Cells of cases that failed, or whose means are not steady: hatched, counted in the legend."""
    xs, ys = np.unique(field.x[np.isfinite(field.x)]), np.unique(field.y[np.isfinite(field.y)])
    for name, rows, hatch in field.bad:
        for row in rows:
            box = [_cell(value, sorted_values, scale) for value, sorted_values, scale in
                   ((field.x[row], xs, axis.get_xscale()), (field.y[row], ys, axis.get_yscale()))]
            if all(box):
                (left, right), (bottom, top) = box
                axis.fill([left, right, right, left], [bottom, bottom, top, top], fill=False, hatch=hatch, linewidth=0.0, edgecolor="#444444",
                          zorder=1.8)
        axis.fill([], [], fill=False, hatch=hatch, edgecolor="#444444", label=f"{name} ({len(rows)})")


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

    def quoted(cell):
        return '"' + cell.replace('"', '""') + '"'

    def put(panel, series, x, y, value=None):
        cells = [quoted(panel.title), quoted(series), f"{x:.9g}", f"{y:.9g}"] + ([value or ""] if with_values else [])
        text.write(",".join([*cells, quoted(panel.x), quoted(panel.y)]) + "\n")

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


def picture(made, kind, mark=""):
    """A figure as bytes of SVG or PNG, the same every time. mark: text in its head"""
    with style():
        text = io.BytesIO()
        if kind == "png":
            made.savefig(text, format="png", metadata={"Software": mark} if mark else {"Software": None})
            return text.getvalue()
        made.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg = text.getvalue().decode()
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"\n <metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r' d="([^"]*)"', lambda path: ' d="' + re.sub(r"(\.\d\d)\d+", r"\1", path[1]) + '"', svg)
    return (svg.replace(">", f">\n<!-- {mark} -->", 1) if mark else svg).encode()
