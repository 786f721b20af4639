"""Records, sweeps and measured data that commands read."""

import collections
import os

import numpy as np

from .. import _known
from .._measured import Measured, csv_rows, heading_of, number_of
from .._series import Record
from .._sweep_file import Table
from .._tables import Results
from ._front import UsageError

Column = collections.namedtuple("Column", "name unit description")


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


class _Table:
    """The columns of a CSV that `cvtflow table --csv` printed, as Results takes them."""

    def __init__(self, path):
        self.path, rows = path, csv_rows(path)
        headings = [heading_of(cell) for cell in rows[0]] if rows else []
        if len(rows) < 2 or "status" not in [name for name, _ in headings]:
            raise ValueError(f"{path}: not a sweep's table as cvtflow table --csv prints it")
        units = {name.replace(".", "_"): row["unit"] for name, row in _known.rows_of("keys").items()}
        self._cells = {name: list(column) for (name, _), column in zip(headings, zip(*rows[1:]))}
        self._columns = [Column(name, unit or units.get(name, ""), "") for name, unit in headings]

    def attributes(self):
        return {}

    def columns(self):
        return self._columns

    def read(self, name):
        numbers = [number_of(cell) for cell in self._cells[name]]
        if all(each is None for each in numbers):
            return self._cells[name]
        return np.array([np.nan if each is None else each for each in numbers])


def is_sweep(path):
    """Whether a path is that of a sweep: a folder, a table of cases, or a CSV."""
    if os.path.isdir(path) or path.endswith(".csv") or os.path.basename(path) == "cases.h5":
        return True
    try:
        Table(path)
        return True
    except (RuntimeError, ValueError):  # ValueError: its message has a name that is no text
        return False


def _table_path(path):
    """The table of a sweep: the path itself, or cases.h5 in a folder. Raises ValueError for a folder without one, with the records in it."""
    table, shown = os.path.join(path, "cases.h5"), 3
    if not os.path.isdir(path):
        return path
    if os.path.lexists(table):
        return table
    files = sorted(os.path.join(path, name) for name in os.listdir(path) if name.endswith(".h5"))
    some = ", ".join(files[:shown]) + (", …" if len(files) > shown else "")
    raise ValueError(f"{path}: a folder without the table of a sweep (cases.h5)"
                     + (f"; it contains {some}: name one of these files" if files else ""))


def results(path, conditions=()):
    """The Results of a sweep's folder, its table, or a CSV of it. conditions: COLUMN=VALUE that cases must meet. Raises UsageError where none
    does."""
    if path.endswith(".csv"):
        found = Results(_Table(path))
        found.name = os.path.splitext(os.path.basename(path))[0]
    else:
        found = Results(Table(_table_path(path)))
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
