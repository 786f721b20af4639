"""Pages of records: what was found, simulated and recorded, of one or of several side by side."""

import math
import re

import numpy as np

from . import _known, _motion, plots
from ._channels import shown, unit_of
from ._comparison import comparison
from ._courses import detail_text, time_text
from ._numbers import mean
from ._page import heading, number, packed, pairs, picture, power_text, provenance, section, table, text
from ._trip import vehicle

_BYTES_OF_CURVES = 1_500_000  # of all records together, as text
_MOST_STATES = 1000  # of running chains together
_SEAL = b"CVTFSEAL"  # begins the last 32 bytes of a finished record


def statuses(records, facts):
    """Status and notes of each record, shown first."""
    found = []
    for record in records:
        attributes, notes = record.attributes, []
        status = record.status
        kind = "good" if status == "finished" else "bad"
        notes.append((kind, status, " (still being written, or left by a killed run)" if status == "running" else ""))
        if "energy_error_ratio" in attributes:
            doubt = float(attributes["energy_error_ratio"])
            closes = "closes" if doubt <= 1.0 else "does not close, the results are unreliable"
            notes.append(("good" if doubt <= 1.0 else "bad", "",
                          f"energy balance {closes}: residual {attributes.get('energy_residual_relative', math.nan):.3g} of the losses, "
                          f"{doubt:.2g} of the tolerance"))
        notes += [("note", name, ": " + words) for name, words in _notes(attributes, facts)]
        if not _sealed(record.place):
            notes.append(("note", "", "the record has no seal: its numbers cannot be verified"))
        found.append({"heading": record.path if len(records) > 1 else "",
                      "notes": [{"kind": kind, "name": name, "text": words} for kind, name, words in notes]})
    return found


def _notes(attributes, facts):
    """Names of notes, and what they state: with figures, where the record has them."""
    stated = dict(line.split(": ", 1) for line in str(attributes.get("note_texts", "")).splitlines() if ": " in line)
    return [(name, stated.get(name) or facts.notes.get(name, "")) for name in str(attributes.get("notes", "")).split("; ") if name]


def _sealed(path):
    with open(path, "rb") as file:
        file.seek(0, 2)
        file.seek(max(0, file.tell() - 32))
        return file.read(8) == _SEAL


def late_row(record):
    """The row from which the means of key figures begin: the last half of a run that ends when it is steady, else its last fifth."""
    steady = record.scene is not None and "steady" in str(record.scene["run.until"])
    return min(record.rows - 1, record.rows // 2 if steady else 4 * record.rows // 5), steady


def late_means(record):
    """Means by channel from there to the end, over whole pin periods as those of the summary; and the time from which they are [s]."""
    time, (row, steady) = record["time"], late_row(record)
    begin, period = record._begin() if steady else time[row], 1.0 / record.pin_frequency if record.pin_frequency else 0.0
    if period and time[-1] - begin >= period:
        begin = time[-1] - period * math.floor((time[-1] - begin) / period * (1.0 + 1e-9))
    rows = time >= begin - 1e-9 * (time[-1] - time[0])
    if period and time[-1] - begin >= period * (1.0 - 1e-9) and np.count_nonzero(rows) > 1:
        return record.means(begin), begin
    return {name: _known.mean_of_quotient(record, name, begin, mean(record[name][row:])) for name in _main(record)}, begin


def _main(record):
    """Channels of the operating point, and the main quantities."""
    point = [f"shaft_{shaft}/{name}" for name in ("speed", "torque", "clamping", "pressure") for shaft in (1, 2)]
    return [name for name in point if name in record.info] + plots.overview(record)


def _errors(record):
    """Errors of means by channel, as the summary states them: of the last half of a run that ends when it is steady, else of all rows."""
    stated = dict(re.findall(r"(?m)^(.+): (-?[\d.]+(?:e[-+]\d+)?|nan|inf)$", str(record.attributes.get("errors_of_means", ""))))
    names = {"tight tension": "tight_tension", "slack tension": "slack_tension", "thrust ratio": "thrust_ratio", "slip by friction": "friction_slip"}
    return {names.get(name, name): float(error) for name, error in stated.items()}


def _digits(error):
    """Format of a mean with two digits of its error."""
    return f"{{:.{max(0, 1 - math.floor(math.log10(error)))}f}}" if 0.0 < error < math.inf else "{:.6g}"


def _figures(record, si):
    """Mean of all rows, of the last ones, least and largest of the operating point and the main quantities, and errors of means."""
    row, steady = late_row(record)
    late, begin = late_means(record)
    whole = record.means(record["time"][0]) if record.rows > 1 else {}
    rows, errors = [], _errors(record)
    for name in _main(record):
        values, column = record[name], record.info[name]
        finite = values[np.isfinite(values)]
        label, factor = shown(name, column.unit, si)
        ends = (finite.min(), finite.max()) if len(finite) else (math.nan, math.nan)
        error = factor * errors.get(name, math.nan) * (errors.get(name, 1.0) > 1e-9 * abs(mean(values)))  # of a constant: rounding
        means = [number(factor * each, _digits(error)) for each in (whole.get(name, mean(values)), late.get(name, math.nan))]
        means.insert(2 if steady else 1, number(error, "± {:.2g}"))
        rows.append([name, unit_of(label), *means, *(number(factor * each) for each in ends), column.description])
    headings = ["mean", "mean of the last half, which is steady" if steady else "mean of the last fifth"]
    headings.insert(2 if steady else 1, ("error", "of the mean before, by its trend and scatter, 95 %"))
    headings = ["channel", "unit", *headings, "least", "largest", "meaning"]
    end = record["time"][-1]
    periods = round((end - begin) * record.pin_frequency) if record.pin_frequency else 0
    how = f"The last means are over {periods} whole pin periods, from {time_text(begin)} on." if periods else ""
    made = table(headings, rows, "sortable figures", record.path, "channel", styles={7: "meaning"})
    return [made, *([text(how, "small")] if how else [])]


def _drive_text(record):
    """shaft 1 drives (31.7 kW in), shaft 2 delivers (31.3 kW)."""
    first, second = (_motion.power_into(record, shaft) for shaft in (1, 2))
    if not (math.isfinite(first) and math.isfinite(second)):
        return ""
    one = first >= second
    given, taken = (first, -second) if one else (second, -first)
    return (f"shaft {1 if one else 2} drives ({power_text(given)} in), shaft {2 if one else 1} "
            f"{'delivers' if taken >= 0.0 else 'also takes'} ({power_text(abs(taken))})")


def _about(record, facts):
    time, scene = record["time"], record.scene
    rows = [("record", record.path), ("scene", plots.name_of(record))]
    if scene is not None:
        rows += [("", scene["scene.description"]), ("detail", detail_text(scene))]
    rows.append(("conditions", plots.conditions(record)))
    if drive := _drive_text(record):
        rows.append(("power", drive))
    count = f"{record.rows:,}".replace(",", " ")
    rows.append(("time", f"{time_text(time[0])} to {time_text(time[-1])}, {count} rows, {len(record.states)} states"))
    return rows


def _simulated(records, facts):
    """Rows that all records share once, then the rest of each; keys that are not the defaults."""
    about = [_about(record, facts) for record in records]
    common = [row for row in about[0] if all(row in other for other in about)]
    blocks = [pairs(common)]
    blocks += [pairs([row for row in rows if row not in common]) for rows in about if any(row not in common for row in rows)]
    if any(record.scene is None for record in records):
        return [*blocks, text("This program cannot read the record's scene.")]
    apart = set(plots.differing(records) or ()) if len(records) > 1 else set()
    return blocks + facts.differences([row for row in facts.not_default(records[0].scene) if row[0] not in apart],
                                      "records" if len(records) > 1 else "")


def curve_data(record, most, si):
    """All curves of a record, in at most about that many bytes of text: {"label", "rows", "shown", "t", "targets", "curves": [{"n", "u",
    "d", "v" or "c"}]}."""
    found = []
    for channel, column in record.info.items():
        for name in plots.find(record, channel):
            label, factor = shown(channel, column.unit, si)
            found.append((name, unit_of(label), column.description, factor * plots.values(record, name)))
    moving = sum(bool((values != values[0]).any()) for *_, values in found)
    points = int(most / (6 * (moving + 2)))  # a float takes 5.3 bytes of base64
    columns = max(1, points // 2) if record.rows > points else 0
    time, curves = _thinned_times(record["time"], columns), []
    for name, unit, description, values in found:
        entry = {"n": name, "u": unit, "d": description}
        if (values != values[0]).any():
            entry["v"] = packed(_extremes(values, columns), "<f4")
        else:
            entry["c"] = float(values[0])
        curves.append(entry)
    held = {"ratio": "control/target"} if "control/target" in record.info and plots.controls_ratio(record) else {}  # drawn beside it
    return {"label": record.path, "rows": record.rows, "shown": len(time), "t": packed(time, "<f8"), "targets": held, "curves": curves}


def _edges(rows, columns):
    return np.arange(columns + 1) * rows // columns


def _thinned_times(time, columns):
    """Of each group of rows its first time and that of its middle."""
    if not columns:
        return time
    edges = _edges(len(time), columns)
    return np.column_stack([time[edges[:-1]], time[(edges[:-1] + edges[1:]) // 2]]).ravel()


def _extremes(values, columns):
    """Of each group of rows its minimum and its maximum, in their order."""
    if not columns:
        return values
    edges = _edges(len(values), columns)[:-1]
    low, high = np.fmin.reduceat(values, edges), np.fmax.reduceat(values, edges)
    first_low = np.array([_place(part, least) < _place(part, most) for part, least, most in zip(np.split(values, edges[1:]), low, high)])
    return np.column_stack([np.where(first_low, low, high), np.where(first_low, high, low)]).ravel()


def _place(part, value):
    return int(np.argmax(part == value))


def _thinning(data):
    return [text(f"{run['label']}: {run['rows']} rows, thinned to {run['shown']} points: each group of rows keeps its minimum and maximum.",
                 "small") for run in data if run["rows"] != run["shown"]]


def _chains(records, data, si):
    """Sections of the running chains; fills data["motions"]."""
    motions = [(record, _motion.Motion(record, _MOST_STATES // len(records))) for record in records
               if record.scene is not None and len(record.states.time)]
    motions = [(record, motion) for record, motion in motions if len(motion.times)]
    if not motions:
        return [section("running", "Running chain", [text("The record has no states that this program can show.")])]
    data["motions"] = [_motion.data(record, motion, si) for record, motion in motions]
    counts = "; ".join(f"{record.path + ': ' if len(motions) > 1 else ''}{len(motion.times)} of {motion.recorded} recorded states"
                       for record, motion in motions)
    how = text(f"{counts}. Drag to turn, wheel to zoom, click a pin to plot it. Displacements are not magnified; between states the "
               "chain is interpolated.", "small")
    made = [section("running", "Running chain", [how], "running", records=[record.path for record, _ in motions])]
    with_forces = [(record, motion) for record, motion in motions if motion.has_pulleys and motion.pin_force is not None]
    if with_forces:
        figure = _motion.pin_forces([motion for _, motion in with_forces], plots.labels([record for record, _ in with_forces]),
                                    "; ".join(dict.fromkeys(plots.conditions(record) for record, _ in with_forces)), si)
        made.append(section("pin-forces", "Pin forces", [picture(figure, "pin-forces")]))
    return made


def _losses(records):
    """Bars of all records in one chart, and energies over the record by kind, side by side."""
    blocks, gained = [picture(plots.losses(records), "losses")], {}
    for number_of, record in enumerate(records):
        for name, column in record.info.items():
            if column.unit == "J" and column.width == 1 and name.partition("/")[0] in ("work", "dissipated", "hydraulics"):
                values = record[name]
                gained.setdefault(name, [column.description, [math.nan] * len(records)])[1][number_of] = float(values[-1] - values[0])
    rows = [[name, *(number(each) for each in values), words] for name, (words, values) in gained.items() if any(values)]
    if rows:
        headings = ["channel", *(["J"] if len(records) == 1 else [f"{record.path} [J]" for record in records]), "meaning"]
        blocks.append(table(headings, rows, caption="Energies over the record", styles={len(records) + 1: "meaning"}))
    return blocks


def without_spectra(record):
    """Why a record has no spectra; empty if it has."""
    time = record["time"]
    if len(time) < 8 or not time[1] > time[0]:
        return "spectra require at least 8 rows"
    if "unsteady" in str(record.attributes.get("notes", "")):
        return "the run is unsteady, and a spectrum would contain the change of the operating point"
    if how := plots.sparse(record):
        return f"{how}: spectra require run.output_interval below {time_text(0.5 / record.pin_frequency)}"
    return ""


def _moves(values):
    finite = values[np.isfinite(values)]
    return len(finite) > 0 and np.ptp(finite) > 0.0


def _spectra(records, si):
    for record in records:
        if why := without_spectra(record):
            return [text(f"No spectra: {record.path}: {why}.")]
    names = [name for name in plots.overview(records[0]) if all(name in record.info for record in records) and _moves(records[0][name])]
    names = [name for name in names if records[0].info[name].unit != "1"] or names  # what is heard: forces, torques, speeds
    return [picture(plots.orders(records, names, si=si), "spectra")] if names else [text("No spectra: every quantity is constant.")]


def _measured(records, measured, si):
    """Curves of the channels that were measured with the points, and how far the records are from these."""
    first = records[0]
    names = [name for name, column in first.info.items() if column.width == 1 and measured.has(name, column.unit)]
    if not names:
        raise _known.Misuse(f"--with {measured.path}: no heading is a channel of {first.path}: {measured.names()}")
    time, rows = measured.column("time", "s"), []
    for name in names:
        label, factor = shown(name, first.info[name].unit, si)
        points = measured.column(name, first.info[name].unit)
        for record in (record for record in records if name in record.info):
            along, values, _ = plots.course(record, name)
            within = (time >= along[0]) & (time <= along[-1])
            apart = factor * (np.interp(time[within], along, values) - points[within])
            apart = apart[np.isfinite(apart)]
            largest = apart[np.argmax(abs(apart))] if len(apart) else math.nan
            rows.append([record.path, name, unit_of(label), number(len(apart), "{:.0f}"), number(mean(apart), "{:+.4g}"),
                         number(math.sqrt(mean(apart**2)) if len(apart) else math.nan, "{:.4g}"), number(largest, "{:+.4g}")])
    return [picture(plots.curves(records, names, measured=measured, si=si), "measured"),
            table(["record", "channel", "unit", "points", "mean", "root mean square", "largest"], rows,
                  caption="Simulated - measured, at the measured times within the record, between the points of the curves that are drawn")]


def _wear(records):
    blocks = []
    for k, record in enumerate(records):
        blocks += [heading(record.path)] if len(records) > 1 else []
        blocks.append(picture(plots.wear(record), f"wear{k}"))
    return blocks


def _has_wear(record):
    return record.scene is not None and record.rows > 1 and all(
        f"wear/{name}" in record.info for name in ("friction_power", "force_speed", "pressure_speed", "tip_pressure", "tip_force_speed"))


def title(records):
    """baseline; of several records "baseline, tiny" or "baseline: load.torque 7 N*m, load.torque 8 N*m"."""
    names = list(dict.fromkeys(plots.name_of(record) for record in records))
    keys = plots.differing(records) if len(records) > 1 else []
    settings = [f"{keys[0]} {_known.value_text(record.scene, keys[0])}" for record in records] if keys and len(keys) == 1 else []
    return "cvtflow: " + ", ".join(names) + (": " + ", ".join(settings) if settings else "")


def parts(records, facts, measured=None, si=False):
    """Template values of a page of records: what written() takes."""
    end = max(record["time"][-1] for record in records)
    seconds = si or end >= 1.0
    data = {"runs": [curve_data(record, _BYTES_OF_CURVES // len(records), si) for record in records],
            "time": {"u": "s" if seconds else "ms", "f": 1.0 if seconds else 1e3}}
    sections = []
    if len(records) > 1:
        sections.append(section("figures", "Key figures side by side", comparison(records, facts, si)))
    else:
        sections.append(section("figures", "Key figures", _figures(records[0], si)))
    for k, record in enumerate(records):
        if blocks := vehicle(record, f"vehicle{k}"):
            sections.append(section(f"vehicle{k or ''}", "Vehicle" + (f": {record.path}" if len(records) > 1 else ""), blocks))
    if measured is not None:
        sections.append(section("measured", "Measured data", _measured(records, measured, si)))
    sections.append(section("simulated", "What was simulated", _simulated(records, facts)))
    sections.append(section("curves", "Curves", _thinning(data["runs"]), "curves"))
    sections += _chains(records, data, si)
    if all(any(name.startswith("loss/") for name in record.info) for record in records):
        sections.append(section("losses", "Losses", _losses(records)))
    if all(_has_wear(record) for record in records):
        sections.append(section("wear", "Wear", _wear(records)))
    sections.append(section("spectra", "Spectra", _spectra(records, si)))
    sections.append(section("provenance", "Provenance",
                            [block for record in records for block in [heading(record.path), *provenance(record.attributes)]]))
    scripts = ["dygraph.min.js", "report.js"] + (["three.min.js", "solids.js", "chain.js"] if "motions" in data else [])
    return {"title": title(records), "statuses": statuses(records, facts), "sections": sections, "data": data, "scripts": scripts}
