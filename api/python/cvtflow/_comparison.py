"""Records side by side: keys that differ, key figures, and differences as means over pin periods with their scatter."""

import math

import numpy as np

from . import _known, plots
from ._channels import shown, unit_of
from ._courses import differing_scenes, time_text
from ._figures import Line, Panel, draw
from ._numbers import mean, period_means, thinned
from ._page import folded, heading, number, picture, table, text

_LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
_FEW = 4  # pin periods, below which means over them have no scatter
_COLUMNS = 1500


def letters(count):
    """Names of records in tables."""
    return [_LETTERS[k] if k < len(_LETTERS) else str(k + 1) for k in range(count)]


class Span:
    """The time that all records share, from its last fifth on or completely; whole pin periods of the first record. begin, end [s]; period:
    of the pins; 0: too few of them, and rows are compared one by one."""

    def __init__(self, records, late):
        begin, self.end = max(record["time"][0] for record in records), min(record["time"][-1] for record in records)
        pins = records[0].pin_frequency or 0.0
        self.common = self.end >= begin
        begin = begin + 0.8 * (self.end - begin) if late else begin
        whole = math.floor((self.end - begin) * pins * (1.0 + 1e-9))
        self.period = 1.0 / pins if whole >= _FEW else 0.0
        self.begin = self.end - whole / pins if self.period else begin
        self.periods = whole if self.period else 0

    def mean(self, record, name):
        """Mean of a channel; of an efficiency or the ratio the quotient of sums."""
        rows = (record["time"] >= self.begin - 1e-12) & (record["time"] <= self.end + 1e-12)
        return _known.mean_of_quotient(record, name, self.begin, mean(record[name][rows]), self.end)

    def difference(self, a, b, name):
        """Times [s] and B - A there: means over pin periods, or rows of A where there are too few."""
        time = a["time"]
        time = time[(time >= self.begin - 1e-12) & (time <= self.end + 1e-12)]
        gap = np.interp(time, b["time"], b[name]) - a[name][np.isin(a["time"], time)]
        return period_means(time, gap, self.period) if self.period and len(time) > 1 else (time, gap)


def keys_that_differ(scenes, facts, of="scenes"):
    """Blocks that name the keys in which scenes, or what the cases of sweeps share, differ."""
    keys, count = differing_scenes(scenes), len(scenes)
    if keys is None:
        return [text(f"This program cannot read all {of}.")]
    if not keys:
        return [text(f"Every key of {'both' if count == 2 else 'the'} {of} has the same value.")]
    rows = [[key, *(_known.value_text(scene, key) for scene in scenes), facts.keys.get(key, ("", ""))[1]] for key in keys]
    return [table(["key", *letters(count), "meaning"], rows, "keys", f"Keys of the {of} that differ", "key",
                  styles={0: "code", count + 1: "meaning"})]


def _side_by_side(records, names, span, si, caption):
    """A row per quantity: its mean in each record, and of each other record what it differs by, how much that scatters, and its share."""
    rows = []
    for name in names:
        label, factor = shown(name, records[0].info[name].unit, si)
        means = [span.mean(record, name) for record in records]
        cells = [name, unit_of(label), *(number(factor * each) for each in means)]
        for record, value in zip(records[1:], means[1:]):
            gaps = span.difference(records[0], record, name)[1]
            gaps = gaps[np.isfinite(gaps)]
            scatter = float(np.std(gaps, ddof=1)) if len(gaps) > 1 else math.nan
            relative = 100.0 * (value - means[0]) / abs(means[0]) if means[0] else math.nan
            cells += [number(factor * (value - means[0]), "{:+.4g}"), number(factor * scatter, "± {:.2g}"), number(relative, "{:+.3g} %")]
        rows.append([*cells, records[0].info[name].description])
    headings = ["channel", "unit", *letters(len(records))]
    for letter in letters(len(records))[1:]:
        headings += [f"{letter} - A", ("scatter", "standard deviation of the differences, pin period by pin period"), "of A"]
    return table([*headings, "meaning"], rows, "sortable figures", caption, "difference", styles={len(headings): "meaning"})


def _ranges(records, names, si):
    """Least and largest value of each record."""
    rows = []
    for name in names:
        label, factor = shown(name, records[0].info[name].unit, si)
        cells = [name, unit_of(label)]
        for record in records:
            values = record[name][np.isfinite(record[name])]
            cells += [number(factor * each) for each in ((values.min(), values.max()) if len(values) else (math.nan, math.nan))]
        rows.append(cells)
    headings = [f"{letter}, {what}" for letter in letters(len(records)) for what in ("least", "largest")]
    return table(["channel", "unit", *headings], rows, "sortable", "Least and largest value of the whole record")


def _pictures(a, b, names, letter, si):
    """Differences over the common time in one picture, a frame for each quantity that differs."""
    span, panels, same = Span([a, b], late=False), [], []
    scale, time_label = (1.0, "time [s]") if si or span.end >= 1.0 else (1e3, "time [ms]")
    for name in names:
        label, factor = shown(name, a.info[name].unit, si)
        time, gaps = span.difference(a, b, name)
        if not (np.isfinite(gaps) & (gaps != 0.0)).any():
            same.append(name)
            continue
        gaps = factor * gaps
        centre, spread = mean(gaps), float(np.nanstd(gaps))
        panel = Panel(f"{name}: {letter} - A", time_label, label if "[" in label else f"{letter} - A", height=1.9)
        ends = scale * np.array([time[0], time[-1]])
        panel.lines += [Line("", *thinned(scale * time, gaps, _COLUMNS), {}),
                        Line("mean" if not panels else "", ends, [centre, centre], {"color": "#555555", "linestyle": "dashed"})]
        panel.lines += [Line("± standard deviation" if sign < 0 and not panels else "", ends, [centre + sign * spread] * 2,
                             {"color": "#999999", "linestyle": "dotted"}) for sign in (-1, 1)]
        panels.append(panel)
    how = f"means over pin periods of A ({time_text(span.period)})" if span.period else "outputs of A"
    blocks = [picture(draw(panels, f"A: {a.path}, {letter}: {b.path}; {how}"), f"differences-{letter}")] if panels else []
    return blocks + ([text(f"The same in every common row: {', '.join(same)}.")] if same else [])


def comparison(records, facts, si):
    """Blocks of the section that compares records with the first of them."""
    named = letters(len(records))
    blocks = [text("; ".join(f"{letter}: {record.path}" for letter, record in zip(named, records)))]
    blocks += keys_that_differ([record.scene for record in records], facts)
    late, whole = Span(records, late=True), Span(records, late=False)
    if not whole.common:
        return [*blocks, text("The records have no common time, so their rows cannot be compared.")]
    if any(len(record["time"]) != len(records[0]["time"]) or (record["time"] != records[0]["time"]).any() for record in records[1:]):
        blocks.append(text(f"Compared from {time_text(whole.begin)} to {time_text(whole.end)}, at the times of A; the others are "
                           "interpolated to these times."))
    names = [name for name in plots.overview(records[0]) if all(name in record.info for record in records)]
    caption = f"Means over {late.periods} whole pin periods, the last fifth of the common time" if late.period else \
        "Means of the last fifth of the common time"
    blocks.append(_side_by_side(records, names, late, si, caption))
    caption = f"Means over {whole.periods} whole pin periods, the common time" if whole.period else "Means of all common rows"
    blocks.append(folded("Means of the whole common time; least and largest",
                         [_side_by_side(records, names, whole, si, caption), _ranges(records, names, si)]))
    for letter, record in zip(named, records):
        others = [name for name in plots.overview(record) if name not in names]
        blocks += [text(f"Not of all records: {letter} has {', '.join(others)}.")] if others else []
    for letter, record in zip(named[1:], records[1:]):
        blocks += [heading(f"Differences {letter} - A"), *_pictures(records[0], record, names, letter, si)]
    return blocks
