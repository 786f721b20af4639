"""Pictures of records: curves, orders, losses, wear, the way of a pin, differences of two. Each function returns the Matplotlib figure."""

import math

import numpy as np

from . import _known
from ._channels import shown, split
from ._courses import (chosen, conditions, course, differing, find, heading, info_of, labels, missing, name_of, named, overview, sampling, sparse,
                       time_text, values)  # noqa: F401 (also of pages)
from ._figures import Line, Panel, colour, dashes, draw
from ._numbers import mean, pattern_length, period_means, spectrum, thinned

_COLUMNS = 1500  # of pixels, or of half pixels
_STRETCHES = 10000  # of a curve that is drawn over another one
_MAX_ORDER, _END_ORDER = 20, 12.5  # up to which multiples are marked; where the axis ends
_MAX_PATTERN = 6  # links of a pattern whose multiples can still be distinguished
_VISIBLE = 0.01  # of the largest of a group
_MARKS = {"measured": {"color": "#222222", "marker": "o", "markerfacecolor": "none", "linestyle": "none"}}


class Panels:
    """Panels of one unit each, in the order of first use. One number without a unit is a quantity of its own: ratio and efficiency share no
    axis."""

    def __init__(self, si):
        self.si, self.found, self._names = si, {}, {}

    def of(self, name, unit):
        """The panel of a quantity, and the factor from SI to its unit."""
        label, factor = shown(name, unit, self.si)
        kind = name if unit == "1" else label.rpartition(" [")[2].rstrip("]")
        panel = self.found.setdefault(kind, Panel(name, "", label))
        names = self._names.setdefault(kind, [name])
        if name not in names:
            names.append(name)
            dimension = _known.dimension(kind.replace("·", "*"))
            panel.y = f"{dimension} [{kind}]".strip()
        panel.title = ", ".join(names)
        return panel, factor

    def finished(self):
        """Panels whose titles are short, without names where there is one curve."""
        for panel in self.found.values():
            if len(panel.title) > 80:
                group = panel.lines[0].name.partition("/")[0] if panel.lines else ""
                shared = group and all(line.name.startswith(group + "/") for line in panel.lines)
                panel.title = f"{group + ': ' if shared else ''}{len(panel.lines)} channels"
            if len(panel.lines) == 1:
                panel.lines[0].name = ""
        return list(self.found.values())


def _largest(line):
    finite = np.abs(line.y[np.isfinite(line.y)])
    return float(finite.max()) if len(finite) else 0.0


def _remove_small(panels, words):
    """Removes curves that are zero throughout, unless all are; and of a group those below 1 % of its largest that no word names. Returns
    their names."""
    if all(_largest(line) == 0.0 for panel in panels.values() for line in panel.lines):
        return ""
    zeros, small = [], []
    for panel in panels.values():
        group = {}
        for line in panel.lines:
            key = line.name.partition("/")[0]
            group[key] = max(group.get(key, 0.0), _largest(line))
        kept = []
        for line in panel.lines:
            is_named = not words or any(line.name == word or line.name.startswith(word + ",") for word in words)
            if _largest(line) == 0.0:
                zeros.append(line.name)
            elif not is_named and _largest(line) < _VISIBLE * group[line.name.partition("/")[0]]:
                small.append(line.name)
            else:
                kept.append(line)
        panel.lines = kept
    for kind in [kind for kind, panel in panels.items() if not panel.lines]:
        del panels[kind]
    return (f"; zero: {', '.join(zeros)}" if zeros else "") + (f"; below 1 %: {', '.join(small)}" if small else "")


def _across(record, x, si, end):
    """Name, label and factor of what is along the horizontal axis."""
    if not x or x == "time":
        return ("time", "time [s]", 1.0) if si or end >= 1.0 else ("time", "time [ms]", 1e3)
    names = find(record, x)
    if len(names) > 1:
        raise _known.Misuse(f"--x {x}: {len(names)} curves; choose one number, such as {names[0]}")
    return (names[0], *shown(names[0], info_of(record, names[0]).unit, si))


def curves(records, channels=(), x="", measured=None, every_output=False, si=False, ax=None, **style):
    """Channels over time, or over another channel: those of one unit in one panel. Of runs longer than 60 pin periods, means over each. records:
    one or more; measured: Measured; the others as of Series.plot()."""
    panels, notes = Panels(si), {}
    end = max(record["time"][-1] for record in records)
    for record, label in zip(records, labels(records)):
        notes[sampling(record)] = None
        across, x_label, scale = _across(record, x, si, end)
        for name in chosen(record, channels):
            if name == across or (across == "time" and name == "control/target" and "ratio" in channels and controls_ratio(record)):
                continue
            info = info_of(record, name)
            panel, factor = panels.of(name, info.unit)
            panel.x = x_label
            time, numbers, period = course(record, name, every_output or (across != "time" and info_of(record, across).unit == "m"))
            notes[f"means over pin periods ({time_text(period)})" if period else ""] = None
            if across == "time":
                if name == "ratio" and controls_ratio(record) and "control/target" in record.info:
                    panel.lines.append(Line(named("control/target", label), *thinned(scale * record["time"], record["control/target"], _COLUMNS),
                                            {"color": "#555555", "linestyle": "dashed"}))
                along, columns = scale * time, _COLUMNS
            else:
                along, columns = scale * values(record, across), _STRETCHES
                along = along if not period else scale * period_means(record["time"], values(record, across), period)[1]
            panel.lines.append(Line(named(name, label), *thinned(along, factor * numbers, columns), dict(style)))
    if measured is not None:
        _add_measured(panels, records[0], channels, measured, across, scale)
    removed = _remove_small(panels.found, channels)
    return draw(panels.finished(), "; ".join(filter(None, [heading(records), *notes])) + removed, ax)


def controls_ratio(record):
    return record.scene is not None and record.scene["control.quantity"] == "ratio" and bool(record.scene["control.enabled"])


def _add_measured(panels, record, channels, measured, across, scale):
    """Points of the measured columns among the curves of the first record."""
    drawn = chosen(record, channels)
    there = [name for name in drawn if measured.has(name, info_of(record, name).unit)]
    if not there:
        raise _known.Misuse(f"--with {measured.path}: its columns ({measured.names()}) are none of the channels that are drawn "
                            f"({', '.join(drawn[:8])}{', …' if len(drawn) > 8 else ''})")
    along = measured.column(across, "s" if across == "time" else info_of(record, across).unit)
    for name in there:
        panel, factor = panels.of(name, info_of(record, name).unit)
        up = measured.column(name, info_of(record, name).unit)
        panel.lines.append(Line(f"{name}, {measured.name}", scale * along, factor * up, dict(_MARKS["measured"])))


def repetitions(record):
    """What repeats as the chain runs: (name, frequency [Hz], whether multiples are marked, colour; empty: too dense to be drawn). First the
    passing pins."""
    pins = record.pin_frequency
    if not pins:
        return []
    links = record.scene["chain.pins"]
    pattern = pattern_length(np.atleast_1d(record.scene["chain.pitch"]), links)
    found = [("pins", pins, True, "#999999")]
    found += [("pitch pattern", pins / pattern, pattern <= _MAX_PATTERN, "#b8860b")] if pattern > 1 else []
    found.append(("round of the chain", pins / links, False, ""))
    for shaft, tint in (("1", "#333333"), ("2", "#aa3377")):
        speed = mean(record[f"shaft_{shaft}/speed"]) / (2.0 * math.pi) if f"shaft_{shaft}/speed" in record.info else 0.0
        found += [(f"shaft {shaft}", speed, False, tint)] if speed > 0.0 else []
    return found


def order_marks(found, end):
    """Lines at the orders of repetitions up to an order: (label, orders, colour, whether of the pins)."""
    marks, pins = [], found[0][1]
    for number, (name, frequency, multiples, tint) in enumerate(found):
        first = frequency / pins
        last = min(end, _MAX_ORDER if multiples else first) * (1.0 + 1e-12)
        orders = first * np.arange(1, int(last / first) + 1)
        if number:
            orders = orders[np.abs(orders - np.round(orders)) > 1e-6]  # pins pass there
        if tint and len(orders):
            text = f"{'pins pass' if number == 0 else name}: {frequency:.4g} Hz{' and multiples' if multiples else ''}"
            marks.append((text, orders, tint, number == 0))
    return marks


def orders_text(found):
    """order 1 = 1404 Hz; shaft 1 0.0237."""
    others = ", ".join(f"{name} {frequency / found[0][1]:.3g}" for name, frequency, *_ in found[1:])
    return f"order 1 = {found[0][1]:.4g} Hz" + (f"; {others}" if others else "")


def orders(records, channels=(), si=False, ax=None, **style):
    """Amplitudes over multiples of the pin passing frequency, over the frequency [Hz] where no pins pass. Parameters as of curves()."""
    panels, marks = Panels(si), repetitions(records[0])
    unit = marks[0][1] if marks else 1.0
    end = math.inf
    for record, label in zip(records, labels(records)):
        for name in chosen(record, channels):
            if how := sparse(record):
                limit = time_text(0.5 / record.pin_frequency)
                raise _known.Misuse(f"{record.path}: {how}: spectra require run.output_interval below {limit}")
            if record.rows < 8:
                raise _known.Misuse(f"{record.path}: orders need 8 rows at least")
            frequency, amplitude = spectrum(record["time"], values(record, name))
            panel, factor = panels.of(name, info_of(record, name).unit)
            panel.x = "order of the passing pins" if marks else "frequency [Hz]"
            end = min(end, frequency[-1] / unit)
            panel.lines.append(Line(named(name, label), frequency / unit, factor * amplitude, dict(style)))
    end = min(end, _END_ORDER) if marks else end
    found = list(panels.found.values())
    for panel in found:
        panel.y = f"amplitude of {panel.y}" if len(panel.lines) == 1 else f"amplitude, {panel.y}"
        panel.lines[0].in_legend = len(panel.lines) > 1  # else the title names it
        _finish_orders(panel, marks, end, panel is found[-1])
        if len(panel.title) > 80:
            panel.title = f"{len(panel.lines)} channels"
    return draw(found, heading(records) + ("; " + orders_text(marks) if marks else ""), ax)


def _finish_orders(panel, marks, end, is_last):
    """Axis without empty decades, six at most; lines of what repeats below the spectra, named in the last panel."""
    within = np.concatenate([line.y[(line.x <= end) & (line.y > 0.0)] for line in panel.lines] or [np.ones(1)])
    within = within if len(within) else np.ones(1)
    largest = within.max()
    bottom, top = max(1e-6 * largest, 0.5 * within.min()), 2.0 * largest
    panel.scales, panel.x_ends, panel.y_ends = ("linear", "log"), (0.0, end), (bottom, top)
    for number, line in enumerate(panel.lines):
        line.style = {"color": colour(number), "linestyle": dashes(number)} | line.style
        shown_part = line.x <= end * 1.02
        line.x, line.y = thinned(line.x[shown_part], line.y[shown_part], _COLUMNS)
    lines = []
    for text, at, tint, pins in order_marks(marks, end) if marks else []:
        x, y = np.repeat(at, 3), np.tile([bottom, top, math.nan], len(at))
        look = {"color": tint, "linestyle": "dashed" if pins else "dotted", "linewidth": 1.0 if pins else 1.4}
        lines.append(Line(text, x, y, look, in_legend=is_last))
    panel.lines = lines + panel.lines


def round_of_pin(records, si=False, ax=None):
    """Where the followed pin is as it goes round the chain's path."""
    label, factor = shown("position", "m", si)
    unit = label.rpartition(" ")[2]
    panel = Panel("Round of the followed pin", f"x {unit}", f"y {unit}", equal=True)
    for record, name in zip(records, labels(records)):
        place = next((each for each, column in record.info.items() if column.width == 3 and column.unit == "m"), None)
        if place is None:
            raise _known.Misuse(f"{record.path}: the record has no channel with a place in space")
        rows = factor * record[place]
        panel.lines.append(Line(name, rows[:, 0], rows[:, 1]))
    spans = [np.ptp(np.concatenate([np.asarray(getattr(line, axis)) for line in panel.lines])) or 1.0 for axis in "xy"]
    panel.height = min(9.0, max(2.4, 1.2 + 7.6 * spans[1] / spans[0]))
    return draw([panel], heading(records), ax)


def loss_kinds(record):
    """Mean losses by kind [W], the largest first."""
    kinds = {name[5:].replace("_", " "): mean(values(record, name)) for name in record.info if name.startswith("loss/") and name != "loss/total"}
    if not kinds:
        raise _known.Misuse(f"{record.path}: the record has no losses")
    return {name: kinds[name] for name in sorted(kinds, key=kinds.get, reverse=True)}


def losses(records, ax=None):
    """Mean losses by kind as bars with their shares, the largest first; of several records side by side, with the difference of two."""
    kinds = [loss_kinds(record) for record in records]
    totals = [sum(each.values()) for each in kinds]
    names = list(dict.fromkeys(name for each in kinds for name in each))
    zeros = [name for name in names if all(each.get(name, 0.0) == 0.0 for each in kinds)]
    rows = []
    for name in [name for name in names if name not in zeros]:
        row = []
        for each, total in zip(kinds, totals):
            value = each.get(name, 0.0)
            text = f"{value:.4g} W" + (f" ({100.0 * value / total:.1f} %)" if total > 0.0 else "")
            if row and len(records) == 2:
                text += f", {value - row[0][0]:+.3g} W"
            row.append((value, text))
        rows.append((name, row))
    title = "Losses by kind: " + ", ".join(f"{total:.4g} W" for total in totals) + " on average"
    panel = Panel(title, "", "mean power dissipated [W]", bars=rows or [("all kinds", [(0.0, "0 W")] * len(records))],
                  kinds=labels(records) if len(records) > 1 else [])
    panel.height = max(2.2, 1.0 + (0.34 if len(records) == 1 else 0.3 * len(records)) * max(1, len(rows)))
    return draw([panel], heading(records) + (f"; zero: {', '.join(zeros)}" if zeros else ""), ax)


def wear(record, ax=None):
    """Over the radius of each sheave friction energy of the tips, largest pressure times sliding speed and depth worn in 1,000 hours; and the
    number of tips by worn depth. Sums are over whole rounds of the chain, whose number is stated."""
    from . import _wear

    found = _wear.wear(record)
    width = found["radius"][1] - found["radius"][0]
    edges = 1e3 * np.append(found["radius"] - 0.5 * width, found["radius"][-1] + 0.5 * width)
    used = np.flatnonzero((found["energy"] > 0.0).any(axis=0) | (found["pressure_speed"] > 0.0).any(axis=0))
    ends = (edges[max(0, used[0] - 1)], edges[min(len(edges) - 1, used[-1] + 2)]) if len(used) else ()
    coefficient = record.scene["wear.coefficient"]
    panels = []
    for name, factor, label, title in (
            ("energy", 1e-3, "energy per radius [J/mm]", "Friction energy of the tips by radius"),
            ("pressure_speed", 1e-6, "p v [MPa·m/s]", "Largest pressure times sliding speed"),
            ("sheave_depth", 1e6, "depth [µm]", f"Worn depth of the sheaves in 1,000 hours, Archard's coefficient {coefficient:.3g} 1/Pa")):
        panel = Panel(title, "radius [mm]", label, x_ends=ends)
        for number, (sheave, numbers) in enumerate(zip(_wear.SHEAVES, found[name])):
            rings = {"stairs": edges, "color": colour(number), "linewidth": 2.2 - 0.4 * number}  # where lines meet, all are seen
            panel.lines.append(Line(f"sheave {sheave}", 1e3 * found["radius"], factor * numbers, rings))
        panels.append(panel)
    panels.append(_worn_tips(found["tip_depth"]))
    heading = f"{conditions(record)}; {_wear.rounds_text(found)}{_wear.sampled(record, found, width)}"
    return draw(panels, heading, ax)


def _worn_tips(depth):
    """Numbers of tips by depth, those of a link apart: four tips, front or rear half, at -z or +z."""
    panel = Panel("Worn depth of the tips in 1,000 hours", "depth [µm]", "number of tips")
    pressed = depth[np.isfinite(depth)]
    if not len(pressed) or not pressed.max() > 0.0:
        return panel
    low, high = 1e6 * pressed.min(), 1e6 * pressed.max()
    edges = low + max(high - low, 1e-6 * high) / 24 * np.arange(25)
    for tip, name in enumerate(("rear half, −z", "rear half, +z", "front half, −z", "front half, +z")):
        own = 1e6 * depth[tip::4]
        counts = np.histogram(np.clip(own[np.isfinite(own)], edges[0], edges[-1]), edges)[0].astype(float)
        panel.lines.append(Line(name, 0.5 * (edges[1:] + edges[:-1]), counts, {"stairs": edges, "color": colour(tip), "linewidth": 1.6}))
    return panel


def differences(records, channels=(), si=False, ax=None):
    """B - A of two records over the time of both, as means over pin periods where the chain runs, with the band of their scatter within each:
    two chains out of phase differ at every instant by what passing pins do. Parameters as of curves()."""
    a, b = records
    begin, end = max(record["time"][0] for record in records), min(record["time"][-1] for record in records)
    period = 1.0 / a.pin_frequency if a.pin_frequency and (end - begin) * a.pin_frequency >= 4.0 else 0.0
    panels = Panels(si)
    x_label, scale = ("time [s]", 1.0) if si or end >= 1.0 else ("time [ms]", 1e3)
    for name in [name for name in chosen(a, channels) if split(name.partition(" (")[0])[0] in b.info]:
        panel, factor = panels.of(name, info_of(a, name).unit)
        panel.x = x_label
        time = a["time"][(a["time"] >= begin) & (a["time"] <= end)]
        if not len(time):
            continue
        gap = factor * (np.interp(time, b["time"], values(b, name)) - np.interp(time, a["time"], values(a, name)))
        if period:
            middles, means = period_means(time, gap, period)
            scatter = np.sqrt(np.maximum(0.0, period_means(time, gap**2, period)[1] - means**2))
            for sign in (-1.0, 1.0):
                panel.lines.append(Line("scatter within pin periods" if sign < 0.0 else "", scale * middles, means + sign * scatter,
                                        {"color": "#bbbbbb", "linewidth": 0.8}))
            time, gap = middles, means
        panel.lines.append(Line(name, *thinned(scale * time, gap, _COLUMNS), {}))
        panel.title = f"{panel.title}: B − A"
    found = panels.finished()
    what = f"means over pin periods ({time_text(period)})" if period else "every output"
    return draw(found, f"A: {a.path}, B: {b.path}; {what}", ax)
