"""Channels by name, of a simulation now and of records over time."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from ._known import display_unit, suggestion

REDUCTIONS = ("mean", "median", "max", "min", "final", "rms")


def shown(name, unit, si=False):
    """Label and factor from SI with which pictures show a channel or a column, as the program does: ("mean slip [%]", 100)."""
    unit, factor = (unit, 1.0) if si else display_unit(name, unit)
    first, _, last = name.rpartition("_")
    words = f"{last} {first}" if last in REDUCTIONS and first else name
    return words.replace("_", " ") + ("" if unit in ("", "1") else f" [{unit.replace('*', '·')}]"), factor


def unit_of(label):
    """"kN" of "tight tension [kN]"; empty without a unit."""
    return label.rpartition(" [")[2].rstrip("]") if label.endswith("]") and " [" in label else ""


def split(name):
    """"links/tension[3]" as its channel and element; the element is None without one."""
    if not isinstance(name, str):
        raise TypeError(f'a channel has a name, such as "slip", and no number: {name!r}')
    found = re.fullmatch(r"(.*)\[(\d+)\]", name) if name.endswith("]") else None
    return (found.group(1), int(found.group(2))) if found else (name, None)


def unknown(name, names):
    """The KeyError of a name that does not exist."""
    return KeyError(f"unknown channel '{name}'" + suggestion(name, names))


class Channels(Mapping[str, Any]):
    """Values by the names of channels: channels["slip"], channels["links/tension[3]"], channels.shaft_1.torque; channels.info has their
    units."""

    def __init__(self, read: Any, columns: list[Any], known: dict[str, Any], prefix: str = "") -> None:
        """read: values of a name; known: what has been found of these columns by the prefix of a group, filled here"""
        self._read, self._columns, self._known, self._prefix = read, columns, known, prefix

    def _names(self):
        """Columns by the rest of their names behind the prefix, and the names of the groups among them."""
        if self._prefix not in self._known:
            info = {column.name[len(self._prefix):]: column for column in self._columns if column.name.startswith(self._prefix)}
            self._known[self._prefix] = info, {name.split("/")[0] for name in info if "/" in name}
        return self._known[self._prefix]

    @property
    def info(self) -> dict[str, Any]:
        """Column (name, unit, description, width) of every channel, by name."""
        return dict(self._names()[0])

    def __getitem__(self, name: str) -> Any:
        return self._read(self._prefix + name if self._prefix else name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names()[0])

    def __len__(self) -> int:
        return len(self._names()[0])

    def __contains__(self, name: object) -> bool:
        return name in self._names()[0]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        info, groups = self._names()
        if name in info:
            return self[name]
        if name in groups:
            group = self.__dict__[name] = Channels(self._read, self._columns, self._known, f"{self._prefix}{name}/")  # found directly from now on
            return group
        raise AttributeError(unknown(name, {*info, *groups}).args[0])

    def __dir__(self):
        return [*super().__dir__(), *self._names()[1], *(name for name in self._names()[0] if "/" not in name)]

    def _ipython_key_completions_(self):
        return list(self.info)

    def __repr__(self):
        lines = [f"{name}  [{column.unit}]{f' x {column.width}' if column.width > 1 else ''}  {column.description}"
                 for name, column in self.info.items()]
        return "\n".join(lines)


def of_simulation(simulation, columns, known):
    """The channels of a simulation: numbers, and arrays of their own."""

    def read(name):
        channel, element = split(name)
        try:
            values = simulation.channel(channel)
        except ValueError:
            raise unknown(name, [column.name for column in columns]) from None
        if element is not None and element >= len(values):
            raise KeyError(f"{name}: {channel} has {len(values)} elements")
        return float(values[element or 0]) if element is not None or len(values) == 1 else values.copy()

    return Channels(read, columns, known)
