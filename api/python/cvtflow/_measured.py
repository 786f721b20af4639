"""Measured data beside a simulation: columns whose headings are names of channels, columns or keys with units."""

import csv
import os
import re

import numpy as np

from ._known import Misuse, quantity, received


def _plain(name):
    return re.sub(r"\W+", "_", name).strip("_")


class Measured:
    """From a CSV with headings such as "time [ms]" and "slip [%]", or a mapping (a pandas.DataFrame as well) from such headings to numbers."""

    def __init__(self, data):
        self.path = os.fspath(data) if isinstance(data, (str, os.PathLike)) else "measured data"
        self.name = os.path.basename(self.path)
        self._columns = {}
        for heading, numbers in (_read(self.path) if isinstance(data, (str, os.PathLike)) else data).items():
            name, _, unit = heading.partition("[")
            self._columns[_plain(name)] = (name.strip(), unit.rstrip("] "), np.asarray(numbers, dtype=float))

    @classmethod
    def received(cls, described):
        """As the program has read it, in SI."""
        made = cls({})
        made.path, made.name = described["path"], described["name"]
        for column in described["columns"]:
            made._columns[_plain(column["name"])] = (column["name"], column["unit"], np.array(column["values"], dtype=float), column["dimension"])
        return made

    def names(self):
        """time, slip."""
        return ", ".join(name for name, *_ in self._columns.values())

    def has(self, name, unit):
        """Whether there is a column of that name. Raises Misuse for a unit of another dimension."""
        return _plain(name) in self._columns and self.column(name, unit) is not None

    def column(self, name, unit):
        """Numbers in SI; `unit` is that of the channel. Raises Misuse."""
        if _plain(name) not in self._columns:
            raise Misuse(f"--with {self.path}: no column '{name}', only {self.names()}")
        own, given, numbers, *dimension = self._columns[_plain(name)]
        if dimension:
            expected = received["dimensions"].get(unit or "1", "")
            if given and dimension[0] != expected:
                raise Misuse(f"{self.path}: {own} [{given}]: {expected} expected ({unit})")
            return numbers
        return numbers * (quantity(f"1 {given}", unit) if given else 1.0)


def _read(path):
    """Columns of a CSV by heading; decimal commas where cells are separated by semicolons."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        text = file.read()
    separator = max(";\t,", key=text.partition("\n")[0].count)
    rows = [row for row in csv.reader(text.splitlines(), delimiter=separator) if any(row)]

    def number(cell):
        try:
            return float(cell.replace(",", ".") if separator != "," else cell)
        except ValueError:
            return np.nan

    return {heading: [number(cell) for cell in column] for heading, *column in zip(*rows)}
