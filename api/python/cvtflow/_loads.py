"""Load cycles of a record, as `cvtflow table --rainflow` prints them: text by classes of range, CSV of every cycle, JSON of both."""

import json

import numpy as np

from ._courses import how_to_record, time_text
from ._known import Misuse, display_unit, suggestion
from ._numbers import Array, cycles
from ._page import finite
from .commands._columns import csv_cell, table


class Load:
    """One number of a channel over the time that counts, and its cycles."""

    def __init__(self, name: str, unit: str, time: Array, history: Array) -> None:
        self.name, self.unit, self.time = name, unit, time
        self.cycles = cycles(time, history)

    def rounds(self, round_time):
        """Length in rounds of the chain; 0 where their duration [s] is 0: unknown."""
        return float(self.time[-1] - self.time[0]) / round_time if round_time > 0.0 and len(self.time) else 0.0

    def equivalent_range(self, exponent, rounds):
        """One cycle of it per round of the chain (per record, if shorter) does the same damage by Miner's rule:
        (sum n_i range_i^m / rounds)^(1/m) [unit]."""
        if not len(self.cycles):
            return 0.0
        largest = float(self.cycles["range"].max())
        total = float(self.cycles["count"] @ (self.cycles["range"] / largest)**exponent)
        return largest * (total / max(1.0, rounds))**(1.0 / exponent)

    def classes(self, count):
        """Cycles of like range, (k, k + 1] · largest/count: dicts with range, cycles, weighted mean, largest range."""
        ranges, numbers = self.cycles["range"], self.cycles["count"]
        borders = ranges.max(initial=0.0) * np.arange(count + 1) / count
        place = np.minimum(np.searchsorted(borders[1:], ranges), count - 1)  # rounding of the last border
        sums, means = (np.bincount(place, weights, count) for weights in (numbers, numbers * self.cycles["mean"]))
        largest = np.zeros(count)
        np.maximum.at(largest, place, ranges)
        means = np.divide(means, sums, out=np.zeros(count), where=sums > 0.0)
        rows = zip(borders.tolist(), borders[1:].tolist(), sums.tolist(), means.tolist(), largest.tolist())
        return [dict(zip(("from", "to", "count", "mean", "largest"), row)) for row in rows]


def _elements(record, request):
    """Names of the numbers that a request means, their channel, and their places in it. Raises Misuse."""
    name, bracket, index = request.partition("[")
    if name not in record.info:
        if how := how_to_record(name):
            raise Misuse(f"--rainflow {name}: the run was recorded without this channel ({how})")
        raise Misuse(f"--rainflow {name}: the record has no such channel{suggestion(name, record.info)} (cvtflow info shows them)")
    width = record.info[name].width
    if not bracket and width > 1:
        raise Misuse(f"--rainflow {name}: it has {width} numbers; write {name}[0] ... {name}[{width - 1}], or {name}[*]")
    places = range(width)
    if bracket and index != "*]":
        places = [place for place in places if index == f"{place}]"]
    if not places:
        raise Misuse(f"--rainflow {request}: elements are numbered 0 to {width - 1}")
    return name, [(place, name if width == 1 else f"{name}[{place}]") for place in places]


def loads(record, requests, begin, until):
    """A Load for each number that requests name. begin, until: times [s]; rows that are not finite count as none"""
    time, found = record["time"], []
    for channel, elements in [_elements(record, request) for request in requests]:
        values = record[channel].reshape(len(time), -1)
        for place, name in elements:
            rows = np.isfinite(values[:, place]) & (time >= begin) & (time <= until)
            found.append(Load(name, record.info[channel].unit, time[rows], values[rows, place]))
    return found


def _text(load, classes, exponent, round_time, si):
    unit, factor = (load.unit, 1.0) if si else display_unit(load.name, load.unit)
    unit = "" if unit == "1" else unit
    outputs = f"{len(load.time)} outputs from {time_text(load.time[0])} to {time_text(load.time[-1])}" if len(load.time) else "no outputs"
    rows = [[f"{factor * each[key]:.6g}" for key in ("from", "to")] + [f"{each['count']:.6g}"] +
            [f"{factor * each[key]:.6g}" for key in ("mean", "largest")] for each in load.classes(classes) if each["count"]]
    headings = [f"range from [{unit}]", f"to [{unit}]", "cycles", f"mean [{unit}]", f"largest range [{unit}]"]
    rounds = load.rounds(round_time)
    each = f"one cycle per round of the chain ({rounds:.3g} rounds)" if rounds >= 1.0 else "one cycle in the record"
    note = (f"  note: the record covers {rounds:.2g} of a round of the chain ({time_text(round_time)}); no link has seen all of its loads\n"
            if 0.0 < rounds < 1.0 else "")
    shown = table(headings, rows, [False] * 5, 2) if rows else "  no cycles\n"
    return (f"{load.name}: rainflow counts (ASTM E1049) of {outputs}\n{shown}  damage-equivalent range "
            f"{factor * load.equivalent_range(exponent, rounds):.6g} {unit} (exponent {exponent:g}, {each})\n{note}")


def _csv(found):
    rows = [[csv_cell(load.name, True), csv_cell(load.unit, True), *(repr(value).removesuffix(".0") for value in row)]
            for load in found for row in load.cycles.tolist()]
    return "".join(",".join(row) + "\n" for row in [["load", "unit", "range", "mean", "cycles", "from_time", "to_time"], *rows])


def _json(load, classes, exponent, round_time):
    rounds = load.rounds(round_time)
    damage = {"exponent": exponent, "range": load.equivalent_range(exponent, rounds), "reference_cycles": max(1.0, rounds),
              "rounds": rounds}
    return {"load": load.name, "unit": load.unit, "outputs": len(load.time), "damage_equivalent": damage,
            "classes": load.classes(classes), "cycles": [dict(zip(load.cycles.dtype.names, row)) for row in load.cycles.tolist()]}


PROVENANCE = ("program_version", "commit", "compiler", "build_type", "instruction_set", "cpu", "cores", "os", "date")


def printed(record, channels, begin, until, classes, exponent, kind, si):
    """The text that `cvtflow table --rainflow` prints. begin, until: times [s]; kind: "text", "csv" or "json"."""
    found = loads(record, channels, begin, until)
    round_time = record.scene["chain.pins"] / record.pin_frequency if record.pin_frequency else 0.0
    how = classes, exponent, round_time
    if kind == "csv":
        return _csv(found)
    if kind == "text":
        return "\n".join(_text(load, *how, si) for load in found)
    attributes = {name: record.attributes[name] for name in PROVENANCE if name in record.attributes}
    page = {"record": record.path, "method": "ASTM E1049 rainflow", "loads": [_json(load, *how) for load in found],
            "provenance": {name: value.item() if hasattr(value, "item") else value for name, value in attributes.items()}}
    return json.dumps(finite(page), indent=2, ensure_ascii=False) + "\n"
