"""Measured data beside a simulation: columns whose headings are names of channels, columns or keys with units."""

import os
import re

import numpy as np

from ._known import Misuse, is_unit, quantity, quantity_name
from ._rows import csv_rows, heading_of, number_of


def _plain(name):
    return re.sub(r"\W+", "_", name).strip("_")


class Measured:
    """From a CSV with headings such as "time [ms]" and "slip [%]", or a mapping (a pandas.DataFrame as well) from such headings to numbers."""

    def __init__(self, data):
        self.path = os.fspath(data) if isinstance(data, (str, os.PathLike)) else "measured data"
        self.name = os.path.basename(self.path)
        self._columns = {}
        for heading, numbers in (_read(self.path) if isinstance(data, (str, os.PathLike)) else data).items():
            name, unit = heading_of(heading)
            self._columns[_plain(name)] = (name, unit, np.asarray(numbers, dtype=float))

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
        own, given, numbers = self._columns[_plain(name)]
        try:
            return numbers * (quantity(f"1 {given}", unit or "1") if given else 1.0)
        except ValueError as error:
            if is_unit(given):
                raise Misuse(f"{self.path}: {own} [{given}]: {quantity_name(unit)} expected ({unit or '1'})") from None
            raise ValueError(f"{self.path}: {own} [{given}]: {error}") from None


def _read(path):
    """Columns of a CSV by heading."""
    rows = csv_rows(path)
    if len(rows) < 2:
        raise ValueError(f"{path}: not a CSV with headings and numbers")
    return {heading: [np.nan if number_of(cell) is None else number_of(cell) for cell in column] for heading, *column in zip(*rows)}
