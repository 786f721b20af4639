"""Measured data beside a simulation: columns whose headings are names of channels, columns or keys with units."""

import os

import numpy as np

from ._known import Misuse, is_unit, quantity, quantity_name
from ._rows import column_name, csv_rows, heading_of, number_of


class Measured:
    """From a CSV with headings such as "time [ms]" and "slip [%]", from a MAT file, or from a mapping (a pandas.DataFrame as well) from such
    headings to numbers."""

    def __init__(self, data):
        self.path = os.fspath(data) if isinstance(data, (str, os.PathLike)) else "measured data"
        self.name = os.path.basename(self.path)
        self._columns = {}
        for heading, numbers in (_read(self.path) if isinstance(data, (str, os.PathLike)) else data).items():
            name, unit = heading_of(heading)
            self._columns[column_name(name)] = (name, unit, np.asarray(numbers, dtype=float))

    def __iter__(self):
        """Names without their units, as they are written."""
        return (name for name, *_ in self._columns.values())

    def names(self):
        """time, slip."""
        return ", ".join(self)

    def has(self, name, unit):
        """Whether there is a column of that name. Raises Misuse for a unit of another dimension."""
        return column_name(name) in self._columns and self.column(name, unit) is not None

    def column(self, name, unit):
        """Numbers in SI; `unit` is that of the channel. Raises Misuse."""
        if column_name(name) not in self._columns:
            raise Misuse(f"--with {self.path}: no column '{name}', only {self.names()}")
        own, given, numbers = self._columns[column_name(name)]
        try:
            return numbers * (quantity(f"1 {given}", unit or "1") if given else 1.0)
        except ValueError as error:
            if is_unit(given):
                raise Misuse(f"{self.path}: {own} [{given}]: {quantity_name(unit)} expected ({unit or '1'})") from None
            raise ValueError(f"{self.path}: {own} [{given}]: {error}") from None


def _read(path):
    """Columns of a CSV or MAT file by heading."""
    if path.endswith(".mat"):
        return _read_mat(path)
    rows = csv_rows(path)
    if len(rows) < 2:
        raise ValueError(f"{path}: not a CSV with headings and numbers")
    return {heading: [np.nan if number_of(cell) is None else number_of(cell) for cell in column] for heading, *column in zip(*rows)}


def _read_mat(path):
    """Columns of a MAT file: its vectors, whose names have _ for every other sign; the struct `units` has the unit of each as a text."""
    try:
        from scipy.io import loadmat
    except ImportError:
        raise ImportError(f"{path}: a MAT file requires scipy (Debian: apt-get install python3-scipy)") from None
    try:
        found = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        raise ValueError(f"{path}: of MATLAB's version 7.3; write it by save('{os.path.basename(path)}', …, '-v7')") from None
    except OSError:
        raise
    except Exception as error:  # SciPy raises errors of any kind for other bytes
        raise ValueError(f"{path}: not a MAT file: {error}") from None
    units = found.pop("units", {})
    arrays = {name: np.asarray(values) for name, values in found.items() if not name.startswith("__")}
    vectors = {name: values for name, values in arrays.items() if values.ndim == 1 and values.dtype.kind in "iuf"}
    if not vectors or len({len(each) for each in vectors.values()}) != 1:
        raise ValueError(f"{path}: its vectors have different lengths, or there is none: {', '.join(vectors)}")
    return {f"{name} [{units[name]}]" if name in units else name: values for name, values in vectors.items()}
