"""Records, sweeps and measured data that commands read."""

import os

import numpy as np

from .. import _known, _rows
from .._measured import Measured, number_of
from .._series import Record
from .._tables import Results
from ._front import UsageError


def records(paths):
    """Records of these paths. Raises ValueError for one without rows, or whose times do not increase."""
    found = [Record(path) for path in paths]
    for record in found:
        time = record["time"]
        if not len(time):
            raise ValueError(f"{record.path}: the record contains no rows yet")
        if not np.isfinite(time).all() or (np.diff(time) < 0.0).any():
            raise ValueError(f"{record.path}: damaged: times do not increase")
    return found


def is_sweep(path):
    """Whether a path is that of a sweep: a folder, or a CSV."""
    return os.path.isdir(path) or path.endswith(".csv")


def results(path, conditions=()):
    """The Results of a sweep's folder, its results.csv, or a CSV of it. conditions: COLUMN=VALUE that cases must meet. Raises UsageError where
    none does."""
    rows = _rows.read(path)
    if not rows.facts:
        units = {name.replace(".", "_"): row["unit"] for name, row in _known.rows_of("keys").items()}
        rows.columns = [each if each.unit else each._replace(unit=units.get(each.name, "")) for each in rows.columns]
    found = Results(rows)
    found.path = os.fsencode(path).decode("utf-8", "replace")
    for condition in conditions:
        found = _kept(found, condition)
    return found


def _kept(found, condition):
    word, equals, value = condition.partition("=")
    if not equals:
        raise UsageError(f"--where {condition}: expected COLUMN=VALUE")
    name = found.column(word)
    own, unit = found[name], found.info[name].unit
    number = number_of(value)
    if number is None:
        try:
            number = _known.quantity(value, unit or "1")
        except ValueError:
            number = np.nan
    kept = np.array([each == value or each == number for each in (own.tolist() if hasattr(own, "tolist") else own)])
    if not kept.any():
        shown, factor = _known.display_unit(name, unit)
        label = "" if shown in ("", "1") else f" {shown}"
        there = dict.fromkeys(each if isinstance(each, str) else f"{factor * each:.6g}{label}" for each in own)
        few = 6
        raise UsageError(f"--where {condition}: no case of {found.path} is left; {name} is {', '.join(list(there)[:few])}"
                         + (", …" if len(there) > few else ""))
    return found.only(kept)


def measured(path):
    """Measured data of a CSV; None for no path."""
    return Measured(path) if path else None
