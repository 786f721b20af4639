"""Columns of sweeps as people see them: names of columns, cells, tables of text."""

import difflib
import math

from .._rows import column_name
from ._front import UsageError


def column_of(rows, word, option=""):
    """The Column that a word means: a name, a key with dots, or a scalar ("slip mean"). Raises UsageError."""
    plain = column_name(word)
    for column in rows.columns:
        if column.name == plain:
            return column
    near = difflib.get_close_matches(plain, [column.name for column in rows.columns], 1)
    raise UsageError(f"{option or word}: the table {rows.path} has no such column" + (f' (did you mean "{near[0]}"?)' if near else ""))


def heading_of(column, si):
    """Name and unit, and the factor to it from SI: ("slip_mean [%]", 100.0)."""
    unit, factor = (column.unit, 1.0) if si else column.shown
    return (f"{column.name} [{unit}]" if unit not in ("", "1") else column.name), factor


def exact(value):
    """A number so that it reads back as the same: 6, 0.25, nan."""
    return repr(value).removesuffix(".0") if isinstance(value, float) else value


def short(value, factor=1.0, digits=6):
    """A cell as people read it."""
    if not isinstance(value, float):
        return value
    return "-" if math.isnan(value) else f"{factor * value:.{digits}g}"


def time_text(value):
    """"12.5 ms": a time [s] in the unit in which its number is short."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if abs(value) >= 0.99995 * size:
            return f"{value / size:.4g} {unit}"
    return f"{value:.4g} s"


def csv_cell(text, guarded=False, quoted=False):
    """A text as a cell of CSV, in quotes where it must be. guarded: with ' before what spreadsheets take for a formula; quoted: always"""
    text = f"'{text}" if guarded and text[:1] in ("=", "+", "-", "@", "\t") else text
    return '"' + text.replace('"', '""') + '"' if quoted or set(text) & set(',;"\n') else text


def table(headings, lines, left, indent=0):
    """Lines of cells under headings, as wide as their longest cell. left: whether a column is aligned so."""
    widths = [max(map(len, column)) for column in zip(headings, *lines)]
    shown = [headings, ["-" * width for width in widths], *lines]
    return "".join((" " * indent + "  ".join(cell.ljust(width) if is_left else cell.rjust(width) for cell, width, is_left
                                              in zip(line, widths, left))).rstrip() + "\n" for line in shown)
