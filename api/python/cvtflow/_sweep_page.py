"""Pages of sweeps: how their cases ended, a picture of any columns over any others, maps, and all cases as a table that can be sorted."""

import collections
import math

import numpy as np

from . import _known, maps
from ._channels import shown, unit_of
from ._comparison import keys_that_differ, letters
from ._courses import detail_text
from ._page import heading, pairs, picture, provenance, section, table, text

_BOOKKEEPING = {"case", "energy_residual", "energy_error_ratio", "steps", "evaluations", "transitions", "truncated",
                "settling_evaluations", "wall", "threads"}
_MOST_MAPS, _MOST_FRAMES = 12, 4  # with all their frames; frames of one result


def statuses(sweeps):
    """How many cases ended how, with which notes."""
    found = []
    for results in sweeps:
        status, count = list(results["status"]), len(results["status"])
        items = [("good" if name == "ok" else "bad", name, f": {cases} of {count} cases")
                 for name, cases in sorted(collections.Counter(status).items())]
        words = collections.Counter(word for cell in results.get("notes", []) for word in str(cell).replace(";", " ").split())
        items += [("note", f"note {name}", f": {cases} of {count} cases") for name, cases in sorted(words.items())]
        found.append({"heading": results.path if len(sweeps) > 1 else "",
                      "notes": [{"kind": kind, "name": name, "text": words} for kind, name, words in items]})
    return found


def is_number(results, name):
    """Whether the cells of a column are numbers."""
    return np.asarray(results[name]).dtype.kind in "fiu"


def _varies(results, name):
    return len(set(np.asarray(results[name]).tolist())) > 1


def _shown(results, name, si):
    return shown(name, results.info[name].unit, si) if is_number(results, name) else (name, 1.0)


def picture_data(sweeps, si):
    """For sweep.js: the columns that all sweeps have, with the numbers of all cases, and which sweep and how each case ended."""
    names = [name for name in sweeps[0] if is_number(sweeps[0], name) and all(name in other and is_number(other, name) for other in sweeps)]
    columns = []
    for name in names:
        label, factor = _shown(sweeps[0], name, si)
        values = np.concatenate([factor * np.asarray(results[name], dtype=float) for results in sweeps])
        columns.append({"n": name, "label": label, "axis": _known.is_key(name), "v": values.tolist()})
    return {"sweep": {"columns": columns, "cases": [status for results in sweeps for status in results["status"]],
                      "names": [results.path for results in sweeps],
                      "of": [k for k, results in enumerate(sweeps) for _ in results["status"]]}}


def _cases(results, key, si):
    headings, columns = [], []
    for name in results:
        label, factor = _shown(results, name, si)
        unit = unit_of(label)
        headings.append((f"{name} [{unit}]" if unit else name, results.info[name].description))
        if is_number(results, name):
            values = factor * np.asarray(results[name], dtype=float)
            columns.append([{"shown": f"{each:.6g}", "value": f"{each:.17g}"} if math.isfinite(each) else {"shown": "–", "value": None}
                            for each in values.tolist()])
        else:
            columns.append([str(each) for each in results[name]])
    return table(headings, [list(row) for row in zip(*columns)], key=key, tall=True)


def _result_names(results):
    return [name for name in results if is_number(results, name) and _varies(results, name) and not _known.is_key(name)
            and name not in _BOOKKEEPING and not name.startswith("error_of_")]


def _frames(results, x, y, si):
    """The cases that a map over x and y shows: all where only these vary, else those of each value of a third key, of many values some;
    every other key must follow from the third one and y. None: there is no such key."""
    keys = [name for name in results if _known.is_key(name) and name not in (x, y) and _varies(results, name)]

    def follow(rows, names):
        places = list(zip(*(np.asarray(results[name])[rows].tolist() for name in (y, *names))))
        return len(set(places)) == len({place[0] for place in places})

    if follow(slice(None), keys):
        return [results]
    for third in (name for name in keys if is_number(results, name)):
        column = np.asarray(results[third])
        values = np.unique(column).tolist()
        if all(follow(column == value, [name for name in keys if name != third]) for value in values):
            count = min(len(values), _MOST_FRAMES)
            chosen = [values[k * (len(values) - 1) // max(1, count - 1)] for k in range(count)]
            return [_framed(results.where(**{third: value}), third, value, si) for value in chosen]
    return None


def _framed(frame, key, value, si):
    """Results named by the value of a key."""
    label, factor = _shown(frame, key, si)
    frame.name = f"{label.partition(' [')[0]} {factor * value:.4g} {unit_of(label)}".rstrip()
    return frame


def _maps(results, si):
    """Maps over the last axis and another one with one case at each point; none where there are several."""
    axes = [name for name in results.axes() if is_number(results, name)]
    for other in reversed(axes[:-1]):
        frames, found = _frames(results, axes[-1], other, si), []
        for name in _result_names(results) if frames else []:
            try:
                is_new = not all(maps.is_trivial(frame, axes[-1], other, name) for frame in frames)
                if is_new and len(found) < min(6, _MOST_MAPS // len(frames)):
                    found.append(maps.maps(frames, axes[-1], other, name, si=si))
            except _known.Misuse:  # several cases at one point, which the picture above shows; or no number in a frame
                pass
        if found:
            return found
    return []


def _measured(sweeps, measured, si):
    """Measured outputs over the measured key."""
    results = sweeps[0]
    there = [name for name in results if is_number(results, name) and measured.has(name, results.info[name].unit)]
    keys, outputs = [name for name in there if _known.is_key(name)], [name for name in there if not _known.is_key(name)]
    if not keys or not outputs:
        raise _known.Misuse(f"--with {measured.path}: a key and an output of {results.path} are needed among its headings: "
                            f"{measured.names()}")
    return [picture(maps.lines(sweeps, keys[0], name, measured=measured, si=si), f"measured-{k}") for k, name in enumerate(outputs)]


def _simulated(results, facts):
    """Detail and keys that all cases share; none where the table does not contain them."""
    scene = _known.scene_of_sweep(results)
    if scene is None:
        return []
    rows = [row for row in facts.not_default(scene) if row[0].replace(".", "_") not in results]
    return [pairs([("detail", detail_text(scene))]), *facts.differences(rows, "cases")]


def parts(sweeps, facts, measured=None, si=False):
    """Template values of a page of sweeps."""
    several, sections = len(sweeps) > 1, []
    titled = [heading(results.path) if several else None for results in sweeps]
    descriptions = [text(each.attributes["description"]) for each in sweeps if each.attributes.get("description")]
    drawn = [_maps(results, si) for results in sweeps]
    how = "Only cases with status ok are shown." + ("" if any(drawn) else " Maps with contours: cvtflow plot SWEEP --x --y --colour.")
    sections.append(section("map", "Picture", [*descriptions, text(how, "small")], "cases"))

    def every(make):
        return [block for k in range(len(sweeps)) if (made := make(k)) for block in ([titled[k]] if several else []) + made]

    if blocks := every(lambda k: _simulated(sweeps[k], facts)):
        if several:
            named = "; ".join(f"{letter}: {results.path}" for letter, results in zip(letters(len(sweeps)), sweeps))
            blocks = [text(named), *keys_that_differ([_known.scene_of_sweep(results) for results in sweeps], facts, "sweeps"), *blocks]
        sections.append(section("simulated", "What was simulated", blocks))
    if measured is not None:
        sections.append(section("measured", "Measured data", _measured(sweeps, measured, si)))
    if blocks := every(lambda k: [picture(figure, f"map-{k}-{number_of}") for number_of, figure in enumerate(drawn[k])]):
        sections.append(section("maps", "Maps", blocks))
    sections.append(section("cases", "Cases", every(lambda k: [_cases(sweeps[k], f"cases-table{k or ''}", si)])))
    sections.append(section("provenance", "Provenance", every(lambda k: _origin(sweeps[k]))))
    return {"title": "cvtflow: sweep " + ", ".join(dict.fromkeys(results.name for results in sweeps)), "statuses": statuses(sweeps),
            "sections": sections, "data": picture_data(sweeps, si), "scripts": ["report.js", "sweep.js"]}


def _origin(results):
    if not results.attributes:
        return [text("A CSV file contains no provenance. The report of the sweep's folder shows it.")]
    return provenance(results.attributes)
