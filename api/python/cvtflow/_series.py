"""Results over time with units, frames and plots, and records of runs, read on demand."""

from __future__ import annotations

import functools
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from . import _known, _wear
from ._channels import Channels, split, unknown
from ._errors import ArgumentError, RecordError
from ._library import Column, c, check, message
from ._notebook import shown, with_unit
from ._numbers import Array, cycles, integral, mean


def seconds(value: float | str) -> float:
    """A time: a number in s, or a text with its unit."""
    return _known.quantity(value, "s") if isinstance(value, str) else value


class Series:
    """Arrays over time by name, "time" [s] among them. Derived classes define __getitem__ and info (name -> Column)."""

    def _chosen(self, channels):
        """(name, values, Column) of a name or several; None: of all of one number per row."""
        names = [name for name, column in self.info.items() if column.width == 1] if channels is None else channels
        return [(name, self[name], self.info[split(name)[0]]) for name in ([names] if isinstance(names, str) else names)]

    def frame(self, channels: str | Sequence[str] | None = None) -> Any:
        """A pandas.DataFrame with the time [s] as index; channels of several numbers become columns "links/tension[0]", ...

        channels  a name or several; None: all of one number per row
        Units by column are in frame.attrs["units"]. Raises ImportError where pandas is not installed.
        """
        import pandas

        columns, units = {}, {}
        for name, values, column in self._chosen(channels):
            parts = {name: values} if values.ndim == 1 else {f"{name}[{k}]": values[:, k] for k in range(values.shape[1])}
            columns.update(parts)
            units.update(dict.fromkeys(parts, column.unit))
        frame = pandas.DataFrame(columns, index=pandas.Index(self["time"], name="time"))
        frame.attrs["units"] = units
        return frame

    def to_xarray(self, channels: str | Sequence[str] | None = None) -> Any:
        """An xarray.Dataset over the time [s]; links/tension has the dimensions time and links_tension_number. Units are attributes.
        channels as in frame(). Raises ImportError where xarray is not installed."""
        import xarray

        made = {name: (["time", f"{name.replace('/', '_')}_number"][:values.ndim], values, {"units": column.unit, "long_name": column.description})
                for name, values, column in self._chosen(channels)}
        return xarray.Dataset(made, coords={"time": ("time", self["time"], {"units": "s"})})

    def means(self, begin: float | str | None = None) -> dict[str, float]:
        """Means of all channels of one number from `begin` [s] (a text carries its unit; None: the first row) to the end, by the trapezoidal
        rule: a dict by name, in SI. Of a Record, `begin` moves to where whole pin periods remain (None: where the means of the run's summary
        begin), and what the summary has of that time is as there, over all samples of the run. Rows that are not finite count as none.
        An efficiency is the quotient of the energies in that time, as in the summary of a run; NaN where none flows. The ratio is that of
        the angles; infinite or NaN where shaft 2 does not turn. Raises ValueError for fewer than two rows from there on."""
        time = self["time"]
        begin = self._begin() if begin is None else seconds(begin)
        if period := self._pin_period():
            begin = time[-1] - period * max(1, math.floor((time[-1] - begin) / period * (1.0 + 1e-9)))
        rows = time >= begin - 1e-9 * (time[-1] - time[0])
        if np.count_nonzero(rows) < 2:
            raise ValueError(f"means: fewer than two rows from {begin:.6g} s on")
        made = {}
        for name in (name for name, column in self.info.items() if column.width == 1 and name != "time"):
            if (quotient := self._quotient(name, begin, time[-1])) is not None:
                made[name] = quotient
                continue
            finite = rows & np.isfinite(values := self[name])
            count = np.count_nonzero(finite)
            made[name] = float(integral(time[finite], values[finite]) / np.ptp(time[finite])) if count > 1 else mean(values[finite])
        return made

    def _repr_html_(self) -> str:
        """Means with their units, and the course of slip, or else of the first channel."""
        if len(self["time"]) < 2:
            return ""
        rows = [(name, with_unit(value, self.info[name].unit)) for name, value in self.means().items() if "/" not in name]
        names = [name for name, column in self.info.items() if column.width == 1 and name != "time"]
        drawn = "slip" if "slip" in names else (names or ["time"])[0]
        return shown(str(getattr(self, "path", "run")), rows, self[drawn][:: max(1, len(self["time"]) // 360)], f"{drawn} over time")

    def _begin(self):
        return self["time"][0]

    def _sum(self, name):
        """A channel so far; None: not recorded."""
        return self[name] if name in self.info else None

    def _quotient(self, name, begin, end):
        """Quotient of sums between two times [s], of which those not recorded are 0; None of a channel that is no such quotient."""
        def gained(part):
            values = self._sum(part)
            return 0.0 if values is None else float(np.diff(np.interp([begin, end], self["time"], values))[0])

        sums = _known.sums(name)
        return _known.quotient_of([sum(map(gained, each)) for each in sums]) if sums else None

    def rainflow(self, channel: str, begin: float | str | None = None, until: float | str | None = None) -> Array:
        """Load cycles of a channel of one number, as `cvtflow table --rainflow` counts them (ASTM E1049): an array with the fields range
        and mean [unit of the channel], count (1; 0.5 for half a cycle), from_time and to_time [s].

        begin  of the rows that count [s] (a text carries its unit); None: 0
        until  likewise their end; None: that of all rows

        Rows that are not finite count as none. Raises ValueError for a channel of several numbers.
        """
        time, values = self["time"], self[channel]
        if values.ndim > 1:
            raise ValueError(f"{channel}: choose one number, such as {channel}[0]")
        rows = np.isfinite(values) & (time >= (0.0 if begin is None else seconds(begin)))
        if until is not None:
            rows &= time <= seconds(until)
        return cycles(time[rows], values[rows])

    def _pin_period(self):
        """[s]; None where it is not known."""

    def plot(self, *channels: str, x: str = "time", others: Sequence[Series] = (), measured: Any = None, every_output: bool = False,
             si: bool = False, ax: Any = None, **style: Any) -> Any:
        """Draws channels over time, or over another channel, with Matplotlib, as `cvtflow plot` does: those of one unit in one panel, panels
        with a shared horizontal axis. Returns the Figure.

        channels  channels, groups ("shaft_1"), or numbers of one ("links/tension[3]"); none: the main quantities of a run
        x         channel along the horizontal axis
        others    further records in the same picture
        measured  measured data as points: a CSV with headings such as "time [ms]", or a mapping (a DataFrame) with such keys
        every_output  draws every output, also of runs of more than 60 pin periods, of which means over each are drawn otherwise
        si        whether units are SI, as those of the values, instead of bar, l/min, rpm, kN, mm and %
        ax        Axes, one for each panel; None: a new figure
        style     is passed to Axes.plot
        """
        from . import _measured, plots

        points = None if measured is None else _measured.Measured(measured)
        return plots.curves([self, *others], channels, x, points, every_output, si, ax, **style)

    path: str = ""
    scene: Any = None
    pin_frequency: Any = None
    info: Any

    attributes = property(lambda self: {}, doc="Of the whole file, by name.")
    rows = property(lambda self: len(self["time"]), doc="Number of rows.")

    def read(self, channel: str, first: int = 0, count: int | None = None) -> Array:
        """Rows of a channel: [count] or [count, width]."""
        return self[channel][first:None if count is None else first + count]


class States:
    """The recorded states: states[3] are the unknowns of the fourth, states.unknowns those of all, states.phases the phases of the tips."""

    def __init__(self, group: Any) -> None:
        self._group, self.time = group, group["time"][:] if group else np.empty(0)

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, number: int) -> Array:
        return self._group["y"][range(len(self))[number]]

    def _rows(self, name):
        return self._group[name][:len(self)] if name in self._group else np.empty((len(self), 0), dtype=np.uint8)

    unknowns = property(lambda self: self._rows("y"), doc="[states, unknowns], in the order of Simulation.unknowns().")
    phases = property(lambda self: self._rows("phases"), doc="[states, tips]: 0 free, 1 touching, 2 sticking, 3 slipping.")

    def __repr__(self):
        span = f" from {self.time[0]:.6g} to {self.time[-1]:.6g} s" if len(self) else ""
        return f"<cvtflow.States: {len(self)}{span}>"


def _text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def _opened(path):
    """The HDF5 file of a record, what it contains by name, and the times of its rows. Raises RecordError, TypeError."""
    import h5py

    c.alone or check(c.record_check(os.fsencode(path), message()))
    try:
        try:
            file = h5py.File(path, "r")
        except OSError:  # it is being written, or its writer was killed
            file = h5py.File(path, "r", libver="latest", swmr=True)
        found = []
        file["channels"].visititems(lambda name, item: found.append((name, item)) if hasattr(item, "shape") and name != "time" else None)
        found.sort(key=lambda each: int(each[1].attrs.get("index", 0)))
        texts = [[_text(item.attrs.get(each, b"")) for each in ("units", "description")] for _, item in found]
        info = {name: Column(name, *text, item.shape[1] if item.ndim > 1 else 1) for (name, item), text in zip(found, texts)}
        return file, info, file["channels/time"][:].astype(float)
    except (OSError, KeyError) as error:
        raise RecordError(f"{os.fspath(path)}: not a record that can be read: {error}") from None


class Record(Series, Mapping[str, Array]):
    """The record of a run as a mapping from names of channels to arrays; "time" [s] is among them.

        record = cvtflow.Record("results/tiny.h5")
        record["links/tension"]            # all rows, [rows, links]; read now
        record["links/tension[3]"]         # of the fourth link, [rows]
        record.read("ratio", 50, 20)       # 20 rows from row 50 on
        record.frame()                     # a pandas.DataFrame
        record.plot("slip")                # with Matplotlib; over another channel: record.plot("slip", x="ratio")

    Numbers are in SI units.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.place, self.path = path, os.fsencode(path).decode("utf-8", "replace")  # of what pages and messages show
        self._file, self.info, self._time = _opened(os.fspath(path))

    @functools.cached_property
    def scene(self) -> Any:
        """What the run simulated, a mapping from keys to values in SI; None where this version of cvtflow cannot read it."""
        return _known.scene_of(self)

    @functools.cached_property
    def pin_frequency(self) -> float | None:
        """Pins that pass a place, by the mean speed of the chain and its mean pitch [Hz]; None where the record does not contain them."""
        speed = mean(self["chain_speed"]) if self.scene is not None and "chain_speed" in self.info else 0.0
        return speed / np.resize(np.atleast_1d(self.scene["chain.pitch"]), self.scene["chain.pins"]).mean() if speed > 0.0 else None

    def _pin_period(self):
        return 1.0 / self.pin_frequency if self.pin_frequency else None

    @functools.cached_property
    def _spans(self):
        """Means of the run's summary by name, with their begin and end [s]: of the run, and of its last fifth."""
        return [{name: float(value) for name, value in re.findall(r"(\S+) (-?[\d.]+(?:e[-+]\d+)?|nan)", line)}
                for line in str(self.attributes.get("means", "")).splitlines() if line.startswith("begin ")]

    def _begin(self):
        return self._spans[0]["begin"] if self._spans else super()._begin()

    def _quotient(self, name, begin, end):
        period = self._pin_period() or math.inf
        near = min(max(1.01 * period, 1e-3 * (end - begin)), 0.5 * (end - begin))  # both count whole periods, by other lengths of them
        span = min(self._spans, key=lambda each: abs(begin - each["begin"]), default={})
        if name in span and end - begin > 0.99 * period and max(abs(begin - span["begin"]), abs(end - span["end"])) <= near:
            return span[name]
        return super()._quotient(name, begin, end)

    status = property(lambda self: self.attributes.get("status", ""), doc="finished, running, unreliable, cycle_missed: …, or the cause of an early end.")
    attributes = property(lambda self: {name: _text(value) for name, value in self._file.attrs.items()}, doc="Of the whole file, by name.")
    channels = property(lambda self: Channels(self.__getitem__, list(self.info.values()), {}), doc="Arrays by name; channels.info: their units.")
    rows = property(lambda self: len(self._time), doc="Number of rows when the file was opened.")
    states = property(lambda self: States(self._file.get("states", {})), doc="The recorded states: time, unknowns, phases.")

    @property
    def transitions(self) -> Array:
        """Changes of a tip's phase: an array with fields time, pin, tip, phase_from, phase_to."""
        rows = self._file["tables/transitions"][:]
        rows.dtype.names = [{"from": "phase_from", "to": "phase_to"}.get(name, name) for name in rows.dtype.names]
        return rows

    def plot_orders(self, *channels: str, others: Sequence[Series] = (), si: bool = False, ax: Any = None, **style: Any) -> Any:
        """Draws amplitudes of channels over multiples of the pin passing frequency, as `cvtflow plot --orders` does; over the frequency [Hz]
        where no pins pass. Returns the Figure. Parameters as of plot(). Raises ValueError for fewer than 8 rows, or rows further apart than
        half a pin period."""
        from . import plots

        return plots.orders([self, *others], channels, si, ax, **style)

    def plot_losses(self, others: Sequence[Series] = (), ax: Any = None) -> Any:
        """Draws the mean losses by kind [W] as bars with their shares, the largest first, as `cvtflow plot --losses` does; those of other
        records beside them. Returns the Figure. Raises ValueError for a record without losses."""
        from . import plots

        return plots.losses([self, *others], ax)

    def plot_round(self, others: Sequence[Series] = (), si: bool = False, ax: Any = None) -> Any:
        """Draws where the followed pin is as it goes round, as `cvtflow plot --round` does. Returns the Figure."""
        from . import plots

        return plots.round_of_pin([self, *others], si, ax)

    def plot_differences(self, other: Series, *channels: str, si: bool = False, ax: Any = None) -> Any:
        """Draws other - self over time, as means over pin periods with the band of their scatter within each. Returns the Figure. channels,
        si, ax: as in plot()."""
        from . import plots

        return plots.differences([self, other], channels, si, ax)

    def plot_wear(self, ax: Any = None) -> Any:
        """Draws wear() in four panels, as `cvtflow plot --wear` does: over the radius of each sheave friction energy, pressure times sliding
        speed and worn depth, and the number of tips by worn depth. Returns the Figure. Raises ValueError as wear() does."""
        from . import plots

        return plots.wear(self, ax)

    def wear(self) -> dict[str, Any]:
        """Wear by Archard's law, of a record with the channels wear/* (record.channels=wear/*), as `cvtflow plot --wear` states it:
        a dict of arrays in SI.

        radius          middles of the rings of a sheave [rings], m
        energy          friction energy of the tips per radius, of sheaves 1-, 1+, 2-, 2+ [4, rings], J/m
        pressure_speed  largest Hertz pressure of a tip times its sliding speed [4, rings], Pa m/s
        sheave_depth    worn in 1,000 hours of what the record shows, with wear.coefficient [4, rings], m
        tip_volume      worn from each tip likewise [tips], m^3
        tip_spot        largest contact spot of each tip [tips], m^2
        tip_depth       likewise [tips], m; contact spots grow with it; NaN for tips that never pressed

        Raises ValueError without these channels, or for fewer than 2 rows.
        """
        return _wear.wear(self)

    def read(self, channel: str, first: int = 0, count: int | None = None) -> Array:
        """Rows of a channel, or of an element: [count] or [count, width]."""
        name, element = split(channel)
        last = self.rows if count is None else first + count
        if not 0 <= first <= last <= self.rows:
            raise ArgumentError(f"rows {first} to {last} of {self.rows}")
        rows = self._file["channels"][name][first:last].astype(float)
        width = rows.shape[1] if rows.ndim > 1 else 1
        if element is not None and (width == 1 or element >= width):
            raise KeyError(f"{channel}: {name} has {width} elements")
        return rows[:, element or 0] if rows.ndim > 1 and (width == 1 or element is not None) else rows

    def __getitem__(self, name: str) -> Array:
        if name == "time":
            return self._time.copy()
        if split(name)[0] not in self.info:
            raise unknown(name, ["time", *self.info])
        return self.read(name)

    def __iter__(self) -> Iterator[str]:
        yield "time"
        yield from self.info

    def __len__(self) -> int:
        return 1 + len(self.info)

    def _ipython_key_completions_(self):
        return list(self)

    def __repr__(self):
        return f"<cvtflow.Record {self.path}: {self.status}, {self.rows} rows of {len(self.info)} channels>"


