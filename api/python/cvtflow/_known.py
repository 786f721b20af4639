"""What the library knows about names and units."""

import difflib
import functools
import math
import re

from ._errors import SceneError
from ._library import described, display_unit, quantity  # noqa: F401 (for others)


class Misuse(ValueError):
    """An option that the data do not have: exit status 2 of the program."""


class UnknownName(Misuse, KeyError):
    """A channel or column that does not exist."""

    __str__ = Misuse.__str__


@functools.lru_cache(maxsize=None)
def rows_of(what):
    """Rows of a subject by their names: "keys", "channels", "notes"."""
    return {row["name"]: row for row in described(what)}


def quantity_name(unit):
    """"a force" of "kN"; empty where it is not known."""
    return described("units")["quantities"].get(unit or "1", "")


def dimension(unit):
    """"force" of "kN"; empty where it is not known."""
    return quantity_name(unit).partition(" ")[2]


def is_unit(text):
    """Whether a text is a unit of a quantity that scenes or channels have."""
    for unit in described("units")["quantities"]:
        try:
            quantity(f"1 {text}", unit)
            return True
        except ValueError:
            pass
    return False


def sums(name):
    """Channels so far by sum, from which the mean of a quotient follows: of an efficiency losses, a pump, what presses, drive and load; of
    the speed ratio the angles of both shafts. Empty for another channel."""
    return rows_of("channels").get(name, {"sums": None})["sums"] or []


def quotient_of(changes):
    """Of the changes of two sums their quotient, infinite or NaN where shaft 2 has not turned. Of five [J] 1 - losses/input; NaN where no
    energy flows: without input, without load (a hundredth of the input at least), and where more is lost than comes in."""
    if len(changes) == 2:
        import numpy as np

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
    """Whether a channel or group exists that is recorded only where record.channels names it; None: there is none of that name."""
    channels = rows_of("channels")
    if name in channels:
        return channels[name]["on_demand"]
    return True if any(each.startswith(name + "/") for each in channels) else None


def suggestion(name, names):
    """` (did you mean "..."?)`, or nothing."""
    near = difflib.get_close_matches(name, sorted(names), 1)
    return f' (did you mean "{near[0]}"?)' if near else ""


def read_scene(text):
    """The Scene of a text with its keys, without its start state: that file may no longer exist. Raises SceneError."""
    from ._scene import Scene

    return Scene.parse(re.sub(r"(?m)^state = .*$", "", text), "scene")


def scene_of(record):
    """The scene of a Record; None where it cannot be read."""
    try:
        return read_scene(record.attributes.get("parameters", ""))
    except SceneError:
        return None


def scene_of_sweep(results):
    """What the cases of Results share, by the sweep's definition; None of a CSV, or where this version cannot read it."""
    lines = [line for line in str(results.attributes.get("definition", "")).splitlines() if line.partition(" = ")[0] in rows_of("keys")]
    try:
        return read_scene("\n".join(lines)) if lines else None
    except SceneError:
        return None


def value_text(scene, key):
    """A value of a scene as it is entered: 8 N*m, 20 us."""
    return shown_value(scene.value(key), rows_of("keys")[key]["unit"]).replace('"', "")


def shown_value(plain, unit):
    """A value as TOML with its unit: the SI unit, or the first of those that people use in which the number is shorter and the same."""
    if unit in ("", "1") or plain.startswith('"'):
        return plain
    shortest = f"{plain} {unit}"
    try:
        value = float(plain)
    except ValueError:  # a table
        return shortest
    if "e" not in plain and len(plain) <= 4:
        return shortest
    in_si = True
    for usual in described("units")["usual"].get(unit, []):
        number = _plain_number(value / quantity(f"1 {usual}", unit))
        text = f"{number} {usual}"
        if number and quantity(text, unit) == value and len(text) <= len(shortest) - (not in_si):
            shortest, in_si = text, False
    return shortest


def _plain_number(value):
    """Six digits without an exponent; empty where one would be shorter."""
    number = repr(float(f"{value:.6g}")).removesuffix(".0")
    digits = number.strip("-").rstrip("0")
    long = abs(value) >= 1e4 and len(number.strip("-")) > len(digits) + 2 + (len(digits) > 1)
    return "" if "e" in number or long or 0.0 < abs(value) < 0.1 else number


@functools.lru_cache(maxsize=None)
def is_key(column):
    """Whether a column is a key of scenes: load_torque."""
    return column in {name.replace(".", "_") for name in rows_of("keys")}
