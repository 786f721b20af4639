"""Results of sweeps as columns, with units, frames and plots."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _rows
from ._known import UnknownName, is_key, quantity, suggestion
from ._notebook import shown, with_unit


COUNTS = ("case", "steps", "evaluations", "transitions", "truncated", "settling_evaluations")


def _column(name, values):
    """Numbers as an array, counts as int64 where every case has one."""
    if isinstance(values, list) and not (values and isinstance(values[0], str)):
        values = np.array(values, dtype=float)
    return values.astype(np.int64) if name in COUNTS and np.isfinite(values).all() else values


class Results(dict[str, Any]):
    """Results of a sweep: arrays [cases] (lists for texts) by column, in the order of cases; counts (steps, evaluations, …) are int64. info
    contains units and descriptions by column."""

    def __init__(self, table: Any) -> None:
        """table: a sweep's folder, its results.csv or another CSV of it, also of a running sweep. Raises OSError, ValueError."""
        if isinstance(table, (str, os.PathLike)):
            table = _rows.read(table)
        if not hasattr(table, "cells"):
            raise TypeError(f"Results() takes a sweep's folder, not {type(table).__name__}")
        super().__init__((column.name, _column(column.name, table.cells[column.name])) for column in table.columns)
        self.info = {column.name: column for column in table.columns}
        self.path, self.attributes, self.name = table.path, table.facts, str(table.facts.get("sweep", ""))

    def frame(self) -> Any:
        """A pandas.DataFrame with the case as index; units by column are in frame.attrs["units"]. Raises ImportError without pandas."""
        import pandas

        frame = pandas.DataFrame(self).set_index("case")
        frame.attrs["units"] = {name: column.unit for name, column in self.info.items()}
        return frame

    def column(self, name: str) -> str:
        """The name of a column: slip_mean also as "slip mean", load_torque as "load.torque", or as "torque" where no other key ends so."""
        if not isinstance(name, str):
            raise TypeError(f"a column is named by a text, not by {type(name).__name__} {name!r}")
        plain = _rows.column_name(name)
        if plain in self:
            return plain
        if len(meant := [key for key in self if is_key(key) and key.endswith("_" + plain)]) == 1:
            return meant[0]
        raise UnknownName(f"{name}: the table {self.path} has no such column" + suggestion(plain, self))

    def where(self, **values: Any) -> Results:
        """The Results of the cases with these values, numbers in SI or texts with a unit: where(load__torque="6 N*m", status="ok"). A list
        means any of its values. Raises ValueError for a number that no case has."""
        kept = np.ones(len(self["case"]), dtype=bool)
        for name, value in values.items():
            name = self.column(name.replace("__", "_"))
            unit = self.info[name].unit
            own, allowed = np.asarray(self[name]), value if isinstance(value, (list, tuple, np.ndarray)) else [value]
            if unit:
                allowed = [quantity(each, unit) if isinstance(each, str) else each for each in allowed]
                matches = np.any([np.isclose(own, each, rtol=1e-12, atol=0.0) for each in allowed], axis=0)
                if not np.any(matches):
                    there = ", ".join(f"{each:.6g}" for each in np.unique(own)[:6])
                    raise ValueError(f"no case has {name} = {value!r}; in {unit} there are {there}{', …' if len(np.unique(own)) > 6 else ''}")
            else:
                matches = np.any([own == each for each in allowed], axis=0)
            kept &= matches
        return self.only(kept)

    def only(self, kept: Any) -> Results:
        """The Results of some cases. kept: [cases] whether a case remains"""
        some = dict.__new__(Results)
        some.update({name: np.asarray(column)[kept] for name, column in self.items()})
        some.info, some.path, some.name, some.attributes = self.info, self.path, self.name, self.attributes
        return some

    def plot(self, x: str, y: str, by: str | Sequence[str] | None = None, others: Sequence[Results] = (), measured: Any = None,
             si: bool = False, ax: Any = None, **style: Any) -> Any:
        """Draws a column over another with Matplotlib, one line for each value of the others that vary, as `cvtflow plot` does. Returns the
        Figure.

        by        a column, or a list of them, that lines are drawn for; None: every key of the scene that varies beside x
        others    Results of further sweeps in the same frame
        measured  measured data as points: a CSV with headings such as "slip_mean [%]", or a mapping (a DataFrame) with such keys
        si        whether units are SI, as those of the values, instead of bar, l/min, rpm, kN, mm and %
        ax        Axes; None: a new figure
        style     is passed to Axes.plot
        """
        from . import _measured, maps

        points = None if measured is None else _measured.Measured(measured)
        return maps.lines([self, *others], x, y, by, points, si, ax=ax, **style)

    def map(self, x: str, y: str, value: str, others: Sequence[Results] = (), si: bool = False, ax: Any = None) -> Any:
        """Draws a column as colours with contours over two others, which may be results, as `cvtflow plot --colour` does. Cases that failed, or
        are not steady, are hatched. Returns the Figure. others: further sweeps below it, with the same colours. Raises ValueError for several
        cases at one point: where() chooses among them."""
        from . import maps

        return maps.maps([self, *others], x, y, value, si, ax=ax)

    def pivot(self, index: str, columns: str, values: str) -> Any:
        """A pandas.DataFrame of one column over two others, in SI units. Raises ValueError for several cases at one point."""
        index, columns, values = (self.column(name) for name in (index, columns, values))
        return self.frame().pivot(index=index, columns=columns, values=values)

    def axes(self, along: str | None = None, but: Sequence[str] = ()) -> list[str]:
        """The columns of keys of the scene that vary and distinguish the cases: one that only follows another, the column `along`, or those in
        `but`, is left out."""
        found, known = [], 1
        for name in [name for name in self if is_key(name) and name != along and name not in but and not self._follows(name, along)]:
            distinct = len(set(zip(*(self[each] for each in [*found, name]))))
            if distinct > known:
                found, known = [*found, name], distinct
        return found

    def _follows(self, name, along):
        """Whether a column changes with another one, as keys of one axis do; such a column makes no line of its own."""
        if along is None:
            return False
        own, given = set(self[name]), set(self[along])
        return len(own) >= len(given) and len(set(zip(self[along], self[name]))) == len(given)

    def to_xarray(self) -> Any:
        """An xarray.Dataset with a dimension for each of axes() and a variable for each other column; points without a case are NaN, or
        empty texts. Units are attributes. Raises ImportError where xarray is not installed, ValueError for several cases at one point."""
        axes = self.axes()
        frame = self.frame().reset_index().set_index(axes) if axes else None
        if frame is None or not frame.index.is_unique:
            raise ValueError(f"several cases at one point of {', '.join(axes)}: choose with where()")
        made = frame.sort_index().to_xarray()
        made = made.assign({name: each.fillna("") for name, each in made.items() if isinstance(self[name][0], str)})
        for name in made.variables:
            made[name].attrs.update(units=self.info[name].unit, long_name=self.info[name].description)
        return made

    def _repr_html_(self) -> str:
        """What varies, with its range, and a column of results over the cases."""
        scalars = [name for name in self if re.search("_(mean|median|min|max|rms|final)$", name)]
        rows = [("cases", str(len(self["case"])))]
        for name in [*self.axes(), *scalars]:
            if not isinstance(column := self[name], list):
                rows.append((name, f"{with_unit(np.nanmin(column), '')} to {with_unit(np.nanmax(column), self.info[name].unit)}"))
        drawn = (scalars or ["case"])[0]
        return shown(self.name or "sweep", rows, self[drawn], f"{drawn} over the cases")

    def __repr__(self):
        return f"<cvtflow.Results: {len(self['case'])} cases of {', '.join(self)}>"
