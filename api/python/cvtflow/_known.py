"""What the library knows about names and units. A drawing process of the program (_draw.py), which has no compiled module, receives it."""

import difflib
import functools
import math
import os
import re

import numpy as np


class Misuse(ValueError):
    """An option that the data do not have: exit status 2 of the program."""


class UnknownName(Misuse, KeyError):
    """A channel or column that does not exist."""

    __str__ = Misuse.__str__


received = {}  # by such a process: "display", "dimensions", "channels", "quotients", "dials"


@functools.lru_cache(maxsize=None)
def _compiled():
    from . import _cvtflow

    return _cvtflow


def display_unit(name, unit):
    """Unit in which pictures show a quantity, and the factor to it from SI: ("rpm", 9.549…)."""
    if not received:
        return _compiled().display_unit(name, unit)
    plain = name.replace("/", "_").replace(".", "_")
    for si, part, shown, factor in received["display"]:
        if si == (unit or "1") and part in plain:
            return shown, factor
    return unit, 1.0


def dimension(unit):
    """"force" of "kN"; empty where it is not known."""
    return (received or {"dimensions": {}})["dimensions"].get(unit, "").partition(" ")[2]


def sums(name):
    """Channels so far by sum, from which the mean of a quotient follows: of an efficiency losses, a pump, what presses, drive and load; of
    the speed ratio the angles of both shafts. Empty for another channel."""
    return received["quotients"].get(name, []) if received else _compiled()._sums_of_quotient(name)


def quotient_of(changes):
    """Of the changes of two sums their quotient, infinite or NaN where shaft 2 has not turned. Of five [J] 1 - losses/input; NaN where no
    energy flows: without input, without load (a hundredth of the input at least), and where more is lost than comes in."""
    if len(changes) == 2:
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.divide(*changes))
    lost, pump, clamping, *shafts = changes
    given = max(0.0, pump if pump > 0.0 else clamping) + sum(max(0.0, shaft) for shaft in shafts)
    taken = sum(max(0.0, -shaft) for shaft in shafts)
    return 1.0 - lost / given if given > 0.0 and taken >= 0.01 * given and lost <= given else math.nan


def mean_of_quotient(record, name, begin, otherwise, end=None):
    """The mean of an efficiency or the speed ratio between two times of a record [s], over whole pin periods, as in the summary of a run.
    `otherwise` of another channel. end: None: that of the record"""
    end = record["time"][-1] if end is None else end
    if record.pin_frequency and (periods := math.floor((end - begin) * record.pin_frequency * (1.0 + 1e-9))):
        begin = max(begin, end - periods / record.pin_frequency)
    found = record._quotient(name, begin, end)
    return otherwise if found is None else found


def is_on_demand(name):
    """Whether a channel or group exists that this program records only where record.channels names it; None: there is none of that name.
    Without the program's list: None."""
    channels = received.get("channels", {})
    if name in channels:
        return channels[name]
    return True if any(each.startswith(name + "/") for each in channels) else None


def suggestion(name, names):
    """` (did you mean "..."?)`, or nothing."""
    near = difflib.get_close_matches(name, sorted(names), 1)
    return f' (did you mean "{near[0]}"?)' if near else ""


def quantity(text, unit):
    """The number of a text with its unit, in SI."""
    return _compiled().quantity(text, unit)


def record_file(path):
    """An opened record: as RecordFile of the compiled module, or by h5py."""
    if not received:
        return _compiled().RecordFile(os.fspath(path))
    from ._reading import RecordFile

    return RecordFile(path)


def scene_of(record):
    """The scene of a Record; None where it cannot be read."""
    if received:
        return received["scenes"][record.path]
    text = re.sub(r"(?m)^state = .*$", "", record.attributes.get("parameters", ""))  # that file may no longer exist
    try:
        return _compiled().Scene.parse(text)
    except _compiled().SceneError:
        return None


def keys(scene):
    """Names of all keys of a scene."""
    return list(scene) if received else [key.name for key in _compiled().scene_keys()]


def value_text(record, key):
    """A value of a record's scene as it is entered: 8 N*m."""
    if received:
        return received["texts"][record.path][key].replace('"', "")
    unit = next(each.unit for each in _compiled().scene_keys() if each.name == key)
    value = record.scene[key]
    return f"{value:.6g} {unit}" if isinstance(value, float) and unit not in ("", "1") else str(value)


@functools.lru_cache(maxsize=None)
def is_key(column):
    """Whether a column is a key of scenes: load_torque."""
    return column in received["keys"] if received else column in {key.name.replace(".", "_") for key in _compiled().scene_keys()}
