"""Pictures of sweeps: lines over a column, maps over two. Each function returns the Matplotlib figure."""

import numpy as np

from . import _known
from ._channels import shown, unit_of
from ._courses import level_text
from ._figures import Field, Line, Panel, colour, draw
from ._numbers import belt_radii
from .plots import _MARKS

_LIMIT = "#D00000"
_SAME_LIMIT = 1e-3  # less than the width of a line


def _numbers(results, name, si=False):
    """Label and values of a column of numbers as pictures show them. Raises Misuse."""
    column = results.column(name)
    label, factor = shown(column, results.info[column].unit, si)
    try:
        values = np.asarray(results[column], dtype=float)
    except ValueError:
        values = np.array([np.nan])
    if not np.isfinite(values).any():
        raise _known.Misuse(f"{name}: the cells of this column are not numbers")
    return label, factor * values


def _words(label):
    return label.partition(" [")[0]


def _states(results):
    """Whether cases ended well, and whether they ended without means that are steady: [cases] each. A table without status has good ones."""
    status = np.asarray(results.get("status", ["ok"] * len(next(iter(results.values())))), dtype=object)
    notes = np.asarray(results.get("notes", [""] * len(status)), dtype=object)
    unsteady = (status == "not_steady") | np.array(["unsteady" in str(note) for note in notes])
    return status == "ok", unsteady


def _heading(results, good):
    scene = _known.scene_of_sweep(results)
    level = "" if scene is None or any(name.startswith("detail_") for name in results.axes()) else f"{level_text(scene)}, "
    count = f"{len(good)} cases" if good.all() else f"{good.sum()} of {len(good)} cases, those that ended well"
    return f"sweep {results.name}, {level}{count}"


def _setting(results, name, value, si):
    """load torque 6 N·m, of a legend."""
    label, factor = shown(name, results.info[name].unit, si)
    return f"{_words(label)} {value if isinstance(value, str) else f'{factor * value:.6g}'} {unit_of(label)}".rstrip()


def _require_cases(results, good):
    if not good.any():
        raise _known.Misuse(f"{results.path}: no case ended well")


def lines(sweeps, x, y, by=None, measured=None, si=False, where=(), ax=None, **style):
    """A column over another, one line for each value of the others that vary; of several sweeps in one frame. Rings: cases that are not steady.
    sweeps: Results, one or more; measured: Measured; where: conditions that chose the cases, for the heading; the others as of Results.plot()."""
    x_label, y_label = _numbers(sweeps[0], x, si)[0], _numbers(sweeps[0], y, si)[0]
    panel = Panel(f"{_words(y_label)} over {_words(x_label)}", x_label, y_label)
    headings, circled = [], []
    for number, results in enumerate(sweeps):
        good, unsteady = _states(results)
        across, up = _numbers(results, x, si)[1], _numbers(results, y, si)[1]
        good |= unsteady & np.isfinite(up)
        _require_cases(results, good)
        headings.append(_heading(results, good))
        circled.append(np.array([across, up])[:, good & unsteady])
        names = [results.column(x), results.column(y)]
        if by is None:
            groups = results.axes(names[0], names)
        else:
            groups = [results.column(name) for name in ([by] if isinstance(by, str) else by)]
        cases = list(zip(*(results[name] for name in groups))) if groups else [()] * len(across)
        own = {"marker": "os^Dv"[number % 5]} | ({"linestyle": ["solid", "dashed", "dotted"][number % 3]} if number else {})
        for place, group in enumerate(sorted({case for case, fine in zip(cases, good) if fine}, key=_sortable)):
            rows = np.array([row for row, case in enumerate(cases) if case == group and good[row]])
            rows = rows[np.argsort(across[rows], kind="stable")]
            name = ", ".join(_setting(results, each, value, si) for each, value in zip(groups, group))
            if len(sweeps) > 1:
                name = f"{name}, {results.name}" if name else results.name
                own["color"] = colour(place if groups else number)
            panel.lines.append(Line(name, across[rows], up[rows], own | style))
    if (points := np.concatenate(circled, axis=1)).size:
        panel.lines.append(Line(f"not steady ({points.shape[1]})", *points, {"linestyle": "none", "marker": "o", "markersize": 9, "markerfacecolor": "none", "color": "#333333"}))
    along = np.concatenate([line.x[np.isfinite(line.x)] for line in panel.lines] or [np.zeros(1)])
    margin = 0.03 * np.ptp(along)
    panel.x_ends = (along.min() - margin, along.max() + margin) if margin > 0.0 and measured is None else ()
    if measured is not None:
        info = [(sweeps[0].column(name), sweeps[0].info[sweeps[0].column(name)].unit) for name in (x, y)]
        points = [shown(name, unit, si)[1] * measured.column(name, unit) for name, unit in info]
        panel.lines.append(Line(measured.name, *points, dict(_MARKS["measured"])))
    return draw([panel], "; ".join([*headings, *where]), ax)


def _sortable(case):
    """Numbers by size, texts behind them."""
    return [(1, 0.0, value) if isinstance(value, str) else (0, value, "") for value in case]


def is_trivial(results, x, y, value):
    """Whether a map would only draw one of its own axes: a mean ratio over the start ratio that it keeps."""
    colours = _numbers(results, value)[1]
    for name in (x, y):
        along = _numbers(results, name)[1]
        both = np.isfinite(colours) & np.isfinite(along)
        span = np.ptp(along[both]) if both.any() else 0.0
        if span > 0.0 and np.abs(colours - along)[both].max() < 0.02 * span:
            return True
    return False


def _scale(name, values):
    """A speed ratio: 1/2 is as far from 1 as 2 is, because the pulleys change places. Every other axis is linear."""
    ratio = name in ("start_ratio", "control_ratio") or name.startswith("ratio_")
    return "log" if ratio and (values[np.isfinite(values)] > 0.0).all() else "linear"


def _beginning(value):
    """Of a table over time what it is at t = 0."""
    return value if np.ndim(value) == 0 else float(np.interp(0.0, *np.transpose(value)))


def _load_limit(value):
    """The load of safety factor 1 of a case, 2 mu S_2 r_2/cos(beta) on the side of zero on which its load is [N m], as load.torque states it;
    NaN where clamping forces depend on the run. value: of a key of its scene"""
    controlled = value("control.enabled")
    if value("clamping.safety") > 0.0 or value("hydraulics.mode") != "none" or value("load.mode") != "torque" or (
            controlled and (value("control.quantity") != "ratio" or value("control.driven") in ("safety", "slip"))):
        return np.nan
    ratio = np.reshape(value("control.ratio"), (-1, 2))[-1, 1] if controlled and np.ndim(value("control.ratio")) else value(
        "control.ratio" if controlled else "start.ratio")
    length = value("chain.pins") * np.resize(value("chain.pitch"), value("chain.pins")).mean()
    first, second = belt_radii(length, value("pulley.centre_distance"), ratio)
    if controlled:  # joints roll, so a bent chain is shorter (tasks/sizing)
        bent = value("joint.radius") * length / value("chain.pins") / 6.4
        first, second = belt_radii(length, value("pulley.centre_distance"), ratio / (1.0 + bent * (second**-2 - first**-2)))
    grip = 2.0 * value("tip.friction_coefficient") * value("tip.friction_scale") / np.cos(value("tip.angle"))
    torque = _beginning(value("load.torque"))
    turning = abs(_beginning(value("drive.speed"))) / ratio
    drag = (value("load.linear") + value("load.quadratic") * turning) * turning
    return np.copysign(grip * second * np.max(np.reshape(value("clamping.driven"), (-1, 2))[:, 1] if np.ndim(value("clamping.driven"))
                                              else value("clamping.driven")), torque + drag) - drag


def load_limits(results):
    """The load of safety factor 1 of each case [cases], N m; None where the table does not contain the machine."""
    scene = _known.scene_of_sweep(results)
    if scene is None:
        return None

    def of_case(number):
        return lambda key: results[column][number] if (column := key.replace(".", "_")) in results else scene[key]

    return np.array([_load_limit(of_case(number)) for number in range(len(results["case"]))])


def _limits(results, load, other, across, si):
    """The load of safety factor 1 over the other axis as lines, for loads above zero and below it; none where two cases at one place have two
    limits, or no case reaches it."""
    if (limits := load_limits(results)) is None:
        return []
    factor = shown(load, results.info[load].unit, si)[1]
    places, loads = _numbers(results, other, si)[1], _numbers(results, load, si)[1]
    made = []
    for sign in (1.0, -1.0):
        found = {}
        for place, limit in zip(places, factor * limits):
            if np.isfinite(limit) and np.isfinite(place) and np.copysign(1.0, limit) == sign:
                if not abs(found.setdefault(place, limit) - limit) <= _SAME_LIMIT * abs(limit):
                    return []
        curve = np.array(sorted(found.items()))
        if len(curve) < 2 or curve[:, 1].min() > np.nanmax(loads) or curve[:, 1].max() < np.nanmin(loads):
            continue
        x, y = (curve[:, 1], curve[:, 0]) if across else (curve[:, 0], curve[:, 1])
        style = {"color": _LIMIT, "linestyle": "dashed", "linewidth": 2.2, "zorder": 3}
        made.append(Line("" if made else "torque limit", x, y, style, sets_ends=False))
    return made


def _verified(results):
    """Cases that also ran at reference quality: their rows have measured errors. Cases that end when they are steady state errors, too."""
    errors = [np.asarray(results[name], dtype=float) for name in results if name.startswith("error_of_")]
    return np.isfinite(errors).any(axis=0) if errors and "settled_for" not in results else np.zeros(len(next(iter(results.values()))), bool)


def _map(results, x, y, value, si):
    names = [results.column(name) for name in (x, y, value)]
    (x_label, across), (y_label, up), (label, values) = (_numbers(results, name, si) for name in (x, y, value))
    good, unsteady = _states(results)
    _require_cases(results, good | unsteady)
    used = good | (unsteady & np.isfinite(values))
    places = list(zip(across[used], up[used]))
    if len(set(places)) < len(places):
        among = ", ".join(results.axes(but=names[:2])) or "the columns"
        raise _known.Misuse(f"several cases at one point of {names[0]} and {names[1]}: choose with --where COLUMN=VALUE among {among}")
    failed = np.flatnonzero(~good & ~unsteady)
    bad = [("failed", failed, "xxx")] if len(failed) else []
    bad += [("not steady", np.flatnonzero(unsteady), "//")] if unsteady.any() else []
    panel = Panel(f"{_words(label)} over {_words(x_label)} and {_words(y_label)}", x_label, y_label,
                  scales=(_scale(names[0], across), _scale(names[1], up)))
    panel.fields.append(Field(label, across, up, np.where(used, values, np.nan), bad))
    largest = int(np.nanargmax(np.where(used, values, np.nan)))
    panel.lines.append(Line("", across[[largest]], up[[largest]], {"marker": "o", "markersize": 10, "markerfacecolor": "none", "color": _LIMIT,
                                                                   "linestyle": "none", "zorder": 4}))
    for axis, other in ((0, 1), (1, 0)):
        if names[axis] == "load_torque" and _known.is_key(names[other]):
            panel.lines += _limits(results, names[axis], names[other], axis == 0, si)
    if len(verified := np.flatnonzero(_verified(results))):
        panel.lines.append(Line("verified", across[verified], up[verified], {"marker": "D", "color": _LIMIT, "linestyle": "none", "zorder": 4}))
    return panel, f"{_heading(results, good)}; ring: largest, {values[largest]:.4g}"


def maps(sweeps, x, y, value, si=False, where=(), ax=None):
    """A column as colours with labelled contours over two others, which may be measured quantities: by triangles between the cases. Cases that
    failed, or whose means are not steady, are hatched and counted. Above it the torque limit, where one axis is load.torque, and the cases
    that also ran at reference quality. Several sweeps have one scale of colours. Parameters as of lines()."""
    made = [_map(results, x, y, value, si) for results in sweeps]
    everything = np.concatenate([panel.fields[0].values for panel, _ in made])
    for (panel, _), results in zip(made, sweeps):
        panel.fields[0].range = (float(np.nanmin(everything)), float(np.nanmax(everything)))
        if len(made) > 1:
            panel.title, panel.height = f"{panel.title}: {results.name}", 4.6
    return draw([panel for panel, _ in made], "; ".join([*(heading for _, heading in made), *where]), ax)
