"""Curves of records by name, and what is stated about records beside them."""

import numpy as np

from . import _known
from ._channels import split
from ._numbers import period_means
from .commands._columns import time_text

_LONG_RUN = 60.0  # pin periods beyond which vibrations would be a solid band


def name_of(record):
    """The name of its scene."""
    return str(record.attributes.get("scene", ""))


def step_text(attributes):
    """"50 ns", "auto (4.63 us)"."""
    setting, taken = (float(attributes.get(name) or 0.0) for name in ("step", "step_taken"))
    shown, used = time_text(setting) if setting > 0.0 else "auto", time_text(taken) if taken > 0.0 else ""
    return shown if used in ("", shown) else f"{shown} ({used}{' taken' if setting > 0.0 else ''})"


def detail_text(scene):
    """Level and dials of a model, in words: fine (lumped plates, 2 joint points, elastic pulleys); piecewise friction."""
    points = scene["detail.joint_points"]
    pins = f"{scene['detail.pins']} pins" if scene["detail.pins"] != "halves" else f"{points} joint point{'s' if points > 1 else ''}"
    pulleys = "no" if scene["detail.pulleys"] == "absent" else scene["detail.pulleys"]
    plates = "every plate" if scene["detail.plates"] == "each" else "lumped plates"
    dials = f"{plates}, {pins}, {pulleys} pulleys"
    friction = f"{scene['detail.friction']} friction{' with stick and slip' if scene['detail.stick_slip'] else ''}"
    level = level_text(scene)
    return f"{dials}; {friction}" if level == "own detail" else f"{level} ({dials}); {friction}"


def level_text(scene):
    """The level of detail of a scene: "fine"."""
    return "own detail" if scene["detail.level"] in ("", "given") else scene["detail.level"]


def conditions(record):
    """baseline, fine, rk4, step 50 ns."""
    if not record.attributes:
        return ""
    levels = [] if record.scene is None else [level_text(record.scene)]
    return ", ".join([name_of(record), *levels, str(record.attributes.get("method", "unknown")), f"step {step_text(record.attributes)}"])


def heading(records):
    return "; ".join(dict.fromkeys(filter(None, map(conditions, records))))


def differing(records):
    """As differing_scenes(), of the scenes of records."""
    return differing_scenes([record.scene for record in records])


def differing_scenes(scenes):
    """Keys in which scenes differ; None where one could not be read. Of two levels of detail, the level alone."""
    if any(scene is None for scene in scenes):
        return None
    keys = [key for key in _known.rows_of("keys") if not key.startswith("scene.")]
    found = [key for key in keys if any(not _same(scene[key], scenes[0][key]) for scene in scenes)]
    levels = {scene["detail.level"] for scene in scenes}
    if len(levels) > 1 and all(levels):
        found = [key for key in found if not key.startswith("detail.") or key in ("detail.level", "detail.pulleys")]
    return found


def _same(a, b):
    return np.array_equal(a, b) if isinstance(a, (list, np.ndarray)) or isinstance(b, (list, np.ndarray)) else a == b


def labels(records):
    """By which records of one picture are told apart: their paths, and the key in which alone they differ."""
    if len(records) == 1:
        return [""]
    keys = differing(records)
    setting = [f" ({keys[0]} {_known.value_text(record.scene, keys[0])})" if keys and len(keys) == 1 else "" for record in records]
    return [f"{record.path}{text}" for record, text in zip(records, setting)]


def named(name, label):
    return f"{name}, {label}" if label else name


def sparse(record):
    """How far outputs are apart where that is more than half a pin period; empty if less."""
    time = record["time"]
    if not record.pin_frequency or len(time) < 2:
        return ""
    between = (time[-1] - time[0]) / (len(time) - 1)
    if 2.0 * record.pin_frequency * between < 1.0:
        return ""
    return f"outputs are {time_text(between)} apart, and pins pass at {record.pin_frequency:.4g} Hz"


def sampling(record):
    """Whether curves through such outputs are samples, or means over their interval (record.means); empty if they are not so far apart."""
    how = sparse(record)
    means = how and record.scene is not None and record.scene["record.means"]
    return "outputs are means over their interval" if means else how and how + ": curves are samples"


def find(record, word, parts=None):
    """Names of what a word means: a channel, or its parts; a group; one number of a channel. Raises Misuse with the closest name. parts: names of
    the parts of a channel by its name and width, None: those of curves"""
    parts = parts or _parts
    channel, element = split(word)
    if channel in record.info:
        width = record.info[channel].width
        if element is not None and element >= width:
            raise _known.UnknownName(f"{word}: {channel} has {width} elements, numbered from 0")
        return [word] if element is not None or width == 1 else parts(channel, width)
    if word.endswith("]"):
        if element is None:
            raise _known.Misuse(f"{word}: the element number is not valid")
        word = channel
    group = [part for name, column in record.info.items() if name.startswith(word + "/") for part in parts(name, column.width)]
    if group and element is None:
        return group
    raise _known.UnknownName(f"{word}: {missing(record, word)}")


def how_to_record(name):
    """Advice for a channel or group that was not recorded; empty: there is none of that name."""
    on_demand = _known.is_on_demand(name)
    if on_demand is None:
        return ""
    group = "" if name in _known.rows_of("channels") else "/*"
    return f"record it with --set record.channels={name}{group}" if on_demand else "the machine has no pulleys"


def missing(record, word):
    """Why a record has no channel or group of that name, and how to record it."""
    if how := how_to_record(word):
        return f"{record.path} was recorded without this channel ({how})"
    return f"neither a file nor a channel of {record.path or 'the run'}{_known.suggestion(word, record.info)}"


def _parts(channel, width):
    """Of more than four numbers, three curves."""
    if width == 1:
        return [channel]
    return [f"{channel}[{k}]" for k in range(width)] if width <= 4 else [f"{channel} ({part})" for part in ("least", "mean", "largest")]


_EXTREMES = {"least": np.fmin.reduce, "mean": None, "largest": np.fmax.reduce}


def values(record, name):
    """Numbers of what find() names, [rows]. Wide channels are read in blocks: a long run has gigabytes of them."""
    channel, _, part = name.partition(" (")
    if not part:
        return record[name]
    found, block = [], max(1, 2**20 // record.info[channel].width)
    for first in range(0, record.rows, block):
        rows = record.read(channel, first, min(block, record.rows - first))
        with np.errstate(invalid="ignore"):
            finite = np.isfinite(rows)
            sums = np.where(finite, rows, 0.0).sum(axis=1) / finite.sum(axis=1)
        found.append(_EXTREMES[part[:-1]](rows, axis=1) if _EXTREMES[part[:-1]] else sums)
    return np.concatenate(found)


def info_of(record, name):
    return record.info[split(name.partition(" (")[0])[0]]


def overview(record):
    """Names of scalar channels outside any group: the main quantities of a run."""
    return [name for name, column in record.info.items() if column.width == 1 and "/" not in name]


def chosen(record, words):
    return [name for word in words for name in find(record, word)] if words else overview(record)


def _averaged(record, unit, every_output=False):
    """The pin period of a run that is longer than 60 of them [s]; 0: every output is drawn, also of lengths, whose swings such means hide."""
    time, pins = record["time"], record.pin_frequency
    span = time[-1] - time[0]
    long = pins and span * pins >= _LONG_RUN and len(time) >= 4.0 * span * pins
    return 1.0 / pins if long and unit != "m" and not every_output else 0.0


def course(record, name, every_output=False):
    """Times [s] and values in SI of a curve, and the pin period over which they are means; 0: every output."""
    period = _averaged(record, info_of(record, name).unit, every_output)
    time, numbers = record["time"], values(record, name)
    return (*(period_means(time, numbers, period) if period else (time, numbers)), period)
