"""Results over time, with units, frames and plots: a run as one call, and records of runs, read on demand."""

import math
import os
import re
from collections.abc import Mapping

import numpy as np

from . import _wear
from ._channels import Channels, Columns, shown, split, unknown
from ._cvtflow import RecordFile, Scene, Simulation, Threads, _efficiency_of, _energies_of_efficiency, quantity

_MILLI = 1e3
_CYCLE = [(name, float) for name in ("range", "mean", "count", "from_time", "to_time")]


def _mean(values):
    """Of the finite values; NaN where there are none."""
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else math.nan


def _spectrum(times, values):
    """Frequencies [Hz] and amplitudes in a Hann window over all values, as of `cvtflow plot --orders`."""
    distance = times[1] - times[0]
    if abs(times[-1] - times[-2] - distance) > 1e-3 * distance:  # the last output of a run
        values = values[:-1]
    values = np.where(np.isfinite(values), values, _mean(values))
    place = np.arange(len(values)) - 0.5 * len(values)
    window = 0.5 + 0.5 * np.cos(2.0 * np.pi * place / len(values))
    slope = window @ (values * place) / (window @ place ** 2)  # a drift leaks into low orders
    values = values - window @ values / window.sum() - slope * place
    padded = 2 << (len(values) - 1).bit_length()
    return np.fft.rfftfreq(padded, distance), 2.0 * np.abs(np.fft.rfft(window * values, padded)) / window.sum()


def _reversals(history):
    """Indices of the first value, every peak and valley (of equal neighbours the first), the last value."""
    kept = np.flatnonzero(np.append(True, history[1:] != history[:-1])[:len(history)])
    if len(kept) < 2:
        return kept
    rises = np.diff(history[kept]) > 0.0
    return kept[np.concatenate(([True], rises[1:] != rises[:-1], [True]))]


def _cycles(time, history):
    """Cycles of a load by rainflow counting, ASTM E1049-85 (2017), section 5.4.4, in the order in which they are counted; halves that
    remain come last: an array as of Series.rainflow().

    time, history  [rows], [s] and any unit, finite
    """
    load, counted, waiting = history.tolist(), [], []  # waiting: reversals that belong to no cycle yet

    def count(a, b, number):
        counted.append((abs(load[b] - load[a]), 0.5 * (load[a] + load[b]), number, time[a], time[b]))

    for turn in _reversals(history):
        waiting.append(turn)
        while len(waiting) >= 3:
            before, middle, last = waiting[-3:]
            if abs(load[last] - load[middle]) < abs(load[middle] - load[before]):
                break
            has_start = len(waiting) == 3  # half a cycle, whose first point is the start of the history
            count(before, middle, 0.5 if has_start else 1.0)
            del waiting[-3:-2 if has_start else -1]
    for a, b in zip(waiting, waiting[1:]):
        count(a, b, 0.5)
    return np.array(counted, dtype=_CYCLE)


def _names(channels):
    """One name, or several."""
    return [channels] if isinstance(channels, str) else channels


class Series:
    """Arrays over time by name, "time" [s] among them. Derived classes define __getitem__ and info (name -> Column)."""

    def frame(self, channels=None):
        """A pandas.DataFrame with the time [s] as index; channels of several numbers become columns "links/tension[0]", ...

        channels  a name or several; None: all of one number per row
        Units by column are in frame.attrs["units"]. Raises ImportError where pandas is not installed.
        """
        import pandas

        names = [name for name, column in self.info.items() if column.width == 1] if channels is None else _names(channels)
        columns, units = {}, {}
        for name in names:
            values = self[name]
            parts = {name: values} if values.ndim == 1 else {f"{name}[{k}]": values[:, k] for k in range(values.shape[1])}
            columns.update(parts)
            units.update(dict.fromkeys(parts, self.info[split(name)[0]].unit))
        frame = pandas.DataFrame(columns, index=pandas.Index(self["time"], name="time"))
        frame.attrs["units"] = units
        return frame

    def to_xarray(self, channels=None):
        """An xarray.Dataset over the time [s]; links/tension has the dimensions time and links_tension_number. Units are attributes.
        channels as in frame(). Raises ImportError where xarray is not installed."""
        import xarray

        names = [name for name, column in self.info.items() if column.width == 1] if channels is None else _names(channels)
        made = {}
        for name in names:
            values, column = self[name], self.info[split(name)[0]]
            axes = ["time"] if values.ndim == 1 else ["time", f"{name.replace('/', '_')}_number"]
            made[name] = (axes, values, {"units": column.unit, "long_name": column.description})
        return xarray.Dataset(made, coords={"time": ("time", self["time"], {"units": "s"})})

    def means(self, begin=None):
        """Means of all channels of one number from `begin` [s] (a text carries its unit; None: the middle) to the end, by the trapezoidal
        rule: a dict by name, in SI. Of a Record, `begin` moves to where whole pin periods remain. Rows that are not finite count as none.
        An efficiency is the quotient of the energies in that time, as in the summary of a run; NaN where none flows. Raises ValueError for
        fewer than two rows from there on."""
        time = self["time"]
        begin = 0.5 * (time[0] + time[-1]) if begin is None else _seconds(begin)
        if period := self._pin_period():
            begin = time[-1] - period * max(1, math.floor((time[-1] - begin) / period * (1.0 + 1e-9)))
        rows = time >= begin - 1e-9 * (time[-1] - time[0])
        if np.count_nonzero(rows) < 2:
            raise ValueError(f"means: fewer than two rows from {begin:.6g} s on")
        made = {}
        for name in (name for name, column in self.info.items() if column.width == 1 and name != "time"):
            if sums := _energies_of_efficiency(name):
                made[name] = _efficiency_of([sum(self._gained(energy, begin) for energy in energies) for energies in sums])
                continue
            values = self[name]
            finite = rows & np.isfinite(values)
            weight = np.gradient(time[finite]) if np.count_nonzero(finite) > 1 else np.ones(np.count_nonzero(finite))
            weight[[0, -1]] *= 0.5 if len(weight) > 1 else 1.0
            made[name] = float(weight @ values[finite] / weight.sum()) if weight.size else math.nan
        return made

    def _energy(self, name):
        """A channel of energy so far; None: not recorded."""
        return self[name] if name in self.info else None

    def _gained(self, name, begin):
        """Of a channel of energy, from `begin` [s] to the end; 0 where it is not recorded."""
        energy = self._energy(name)
        return 0.0 if energy is None else float(energy[-1] - np.interp(begin, self["time"], energy))

    def rainflow(self, channel, begin=None, until=None):
        """Load cycles of a channel of one number, as `cvtflow table --rainflow` counts them (ASTM E1049): an array with the fields range
        and mean [unit of the channel], count (1; 0.5 for half a cycle), from_time and to_time [s].

        begin  of the rows that count [s] (a text carries its unit); None: 0
        until  likewise their end; None: that of all rows

        Rows that are not finite count as none. Raises ValueError for a channel of several numbers.
        """
        time, values = self["time"], self[channel]
        if values.ndim > 1:
            raise ValueError(f"{channel}: choose one number, such as {channel}[0]")
        rows = np.isfinite(values) & (time >= (0.0 if begin is None else _seconds(begin)))
        if until is not None:
            rows &= time <= _seconds(until)
        return _cycles(time[rows], values[rows])

    def _pin_period(self):
        """[s]; None where it is not known."""

    def plot(self, *channels, x="time", ax=None, si=False, **style):
        """Draws channels over time, or over another channel, with Matplotlib: those of one unit in one panel, panels with a shared
        horizontal axis. Returns the Axes, or an array of them.

        x      channel along the horizontal axis
        ax     Axes, or one for each unit; None: a new figure
        si     whether units are SI, as those of the values, instead of bar, l/min, rpm, kN, mm and %
        style  is passed to Axes.plot
        """
        import matplotlib.pyplot as pyplot

        panels = {}
        for name in channels:
            label, factor = shown(name, self.info[split(name)[0]].unit, si)
            unit = label.rpartition(" [")[2] if label.endswith("]") and " [" in label else ""
            panels.setdefault(unit, []).append((name, label, factor))
        if not panels:
            raise TypeError("plot() takes the names of one channel or more")
        if ax is None:
            size = (6.4, max(3.6, 0.6 + 2.0 * len(panels)))
            ax = pyplot.subplots(len(panels), sharex=True, squeeze=False, figsize=size, layout="constrained")[1][:, 0]
        axes = np.atleast_1d(ax)
        time = ("time [s]", 1.0) if si else ("time [ms]", _MILLI)
        along, scale = time if x == "time" else shown(x, self.info[split(x)[0]].unit, si)
        for axis, (unit, names) in zip(axes, panels.items()):
            for name, _, factor in names:
                axis.plot(scale * self[x], factor * self[name], label=name, **style)
            axis.set_ylabel(names[0][1] if len(names) == 1 else unit and f"[{unit}")
            if len(names) > 1:
                axis.legend()
        axes[-1].set_xlabel(along)
        return axes[0] if len(axes) == 1 else axes


class States:
    """The recorded states: states[3] are the unknowns of the fourth, states.unknowns those of all, states.phases the phases of the tips."""

    def __init__(self, file):
        self._file = file
        self.time = file.state_times()

    def __len__(self):
        return len(self.time)

    def __getitem__(self, number):
        count = len(self)
        if not -count <= number < count:
            raise IndexError(f"state {number} of {count}")
        return self._file.state(number % count)

    @property
    def unknowns(self):
        """[states, unknowns], in the order of Simulation.unknowns()."""
        return np.array([self._file.state(number) for number in range(len(self))])

    @property
    def phases(self):
        """[states, tips]: 0 free, 1 touching, 2 sticking, 3 slipping."""
        return np.array([self._file.phases(number) for number in range(len(self))])

    def __repr__(self):
        span = f" from {self.time[0]:.6g} to {self.time[-1]:.6g} s" if len(self) else ""
        return f"<cvtflow.States: {len(self)}{span}>"


class Record(Series, Mapping):
    """The record of a run as a mapping from names of channels to arrays; "time" [s] is among them.

        record = cvtflow.Record("results/tiny.h5")
        record["links/tension"]            # all rows, [rows, links]; read now
        record["links/tension[3]"]         # of the fourth link, [rows]
        record.read("ratio", 50, 20)       # 20 rows from row 50 on
        record.frame()                     # a pandas.DataFrame
        record.plot("slip")                # with Matplotlib; over another channel: record.plot("slip", x="ratio")

    Numbers are in SI units.
    """

    def __init__(self, path):
        self._file = RecordFile(os.fspath(path))
        self._columns = self._file.channels()
        self.path = str(path)

    status = property(lambda self: self._file.status, doc="finished, running, unreliable, cycle_missed: …, or the cause of an early end.")
    attributes = property(lambda self: self._file.attributes(), doc="Of the whole file, by name.")
    channels = property(lambda self: Channels(self.__getitem__, Columns(self._columns)), doc="Arrays by name; channels.info: their units.")
    info = property(lambda self: {row.name: row for row in self._columns}, doc="Column (unit, description, width) of channels, by name.")
    rows = property(lambda self: self._file.rows(), doc="Number of rows when the file was opened.")
    states = property(lambda self: States(self._file), doc="The recorded states: time, unknowns, phases.")
    transitions = property(lambda self: self._file.transitions(),
                           doc="Changes of a tip's phase: an array with fields time, pin, tip, phase_from, phase_to.")

    def _scene(self):
        return Scene.parse(re.sub(r"(?m)^state = .*$", "", self.attributes["parameters"]))  # that file may no longer exist

    def _pin_period(self):
        scene = self._scene()
        pins, pitch = scene["chain.pins"], np.atleast_1d(scene["chain.pitch"])
        speed = _mean(self["chain_speed"]) if "chain_speed" in self else 0.0
        return np.resize(pitch, pins).mean() / speed if speed > 0.0 else None  # links repeat the pitches

    def plot_losses(self, ax=None):
        """Draws the mean losses by kind [W] as bars with their shares, the largest first, with Matplotlib, as `cvtflow plot --losses` does.
        Returns the Axes. ax: as in plot(). Raises ValueError for a record without losses."""
        import matplotlib.pyplot as pyplot

        kinds = {name[5:].replace("_", " "): _mean(self[name]) for name in self.info if name.startswith("loss/") and name != "loss/total"}
        if not kinds:
            raise ValueError(f"{self.path}: the record has no losses")
        total = sum(kinds.values())
        kinds = {name: kinds[name] for name in sorted(kinds, key=kinds.get, reverse=True) if kinds[name] != 0.0} or {"all kinds": 0.0}
        axes = pyplot.subplots(layout="constrained")[1] if ax is None else ax
        bars = axes.barh(list(kinds), list(kinds.values()))
        shares = [f" ({100.0 * each / total:.1f} %)" if total > 0.0 else "" for each in kinds.values()]
        axes.bar_label(bars, [f" {each:.4g} W{share}" for each, share in zip(kinds.values(), shares)])
        axes.margins(x=0.35)  # room for the labels
        axes.invert_yaxis()
        axes.set(xlabel="mean power dissipated [W]", title=f"Losses by kind: {total:.4g} W on average")
        return axes

    def plot_orders(self, *channels, ax=None, si=False, **style):
        """Draws amplitudes of channels of one number over multiples of the pin passing frequency with Matplotlib, as
        `cvtflow plot --orders` does; over the frequency [Hz] where no pins pass. Returns the Axes. ax, si, style:
        as in plot(), in one panel.

        Raises ValueError for fewer than 8 rows, rows further apart than half a pin period, or a channel of several numbers.
        """
        import matplotlib.pyplot as pyplot

        time, period = self["time"], self._pin_period()
        passing = 1.0 / period if period else None  # [Hz]
        if not channels:
            raise TypeError("plot_orders() takes the names of one channel or more")
        if len(time) < 8 or 2.0 * (passing or 0.0) * (time[-1] - time[0]) >= len(time) - 1:
            raise ValueError(f"{self.path}: orders require 8 rows at least, and a run.output_interval below half a pin period")
        axes = pyplot.subplots(layout="constrained")[1] if ax is None else ax
        for name in channels:
            values = self[name]
            if values.ndim > 1:
                raise ValueError(f"{name}: choose one number, such as {name}[0]")
            label, factor = shown(name, self.info[split(name)[0]].unit, si)
            frequency, amplitude = _spectrum(time, values)
            axes.semilogy(frequency / (passing or 1.0), factor * amplitude, label=label, **style)
        axes.set(xlabel="order of the passing pins" if passing else "frequency [Hz]", ylabel="amplitude")
        axes.set_xlim(0.0, min(frequency[-1] / passing, 12.5) if passing else frequency[-1])
        axes.legend()
        return axes

    def wear(self):
        """Wear by Archard's law, of a record with the channels wear/* (record.channels=wear/*), as `cvtflow plot --wear` states it:
        a dict of arrays in SI.

        radius          middles of the rings of a sheave [rings], m
        energy          friction energy of the tips per radius, of sheaves 1-, 1+, 2-, 2+ [4, rings], J/m
        pressure_speed  largest Hertz pressure of a tip times its sliding speed [4, rings], Pa m/s
        sheave_depth    worn in 1,000 hours of what the record shows, with wear.coefficient [4, rings], m
        tip_depth       likewise [tips], m; NaN for tips that never pressed

        Raises ValueError without these channels, or for fewer than 2 rows.
        """
        return _wear.wear(self, self._scene())

    def plot_wear(self, ax=None):
        """Draws wear() with Matplotlib in four panels, as `cvtflow plot --wear` does: over the radius of each sheave friction energy,
        pressure times sliding speed and worn depth, and the number of tips by worn depth. Returns the four Axes, [2, 2].

        ax  four Axes, in any shape; None: a new figure

        Raises ValueError as wear() does.
        """
        return _wear.draw(self, self._scene(), ax)

    def read(self, channel, first=0, count=None):
        """Rows of a channel, or of an element: [count] or [count, width]."""
        name, element = split(channel)
        rows = self._file.read(name, first, count)
        if element is None:
            return rows
        if rows.ndim == 1 or element >= rows.shape[1]:
            raise KeyError(f"{channel}: {name} has {1 if rows.ndim == 1 else rows.shape[1]} elements")
        return rows[:, element]

    def __getitem__(self, name):
        if name != "time" and split(name)[0] not in self.info:
            raise unknown(name, ["time", *self.info])
        return self.read(name)

    def __iter__(self):
        yield "time"
        yield from self.info

    def __len__(self):
        return 1 + len(self._columns)

    def _ipython_key_completions_(self):
        return list(self)

    def __repr__(self):
        return f"<cvtflow.Record {self.path}: {self.status}, {self.rows} rows of {len(self._columns)} channels>"


class Rows(Series, dict):
    """Result of run(): arrays over time by name. info contains their units; frame() and plot() as for a Record."""

    def __init__(self, values, info, energies=None):
        super().__init__(values)
        self.info, self._energies = info, energies or {}

    def _energy(self, name):
        return self._energies.get(name)

    def __repr__(self):
        return f"<cvtflow.Rows: {len(self['time'])} rows of {', '.join(self)}>"


def _seconds(value):
    return quantity(value, "s") if isinstance(value, str) else value


def run(scene, until=None, *, channels=("ratio", "slip", "efficiency"), interval=None, inputs=None, threads=None):
    """Runs a scene and returns a dict of arrays over time: "time" [s] and the channels, [rows] or [rows, width], in SI units.

    until     end ("0.1 ms"; numbers are in s); None: run.until of the scene
    channels  a name or several, elements such as "links/tension[3]" among them
    interval  time between rows; None: run.output_interval
    inputs    called as inputs(time, simulation) before each row; returns a dict of inputs to set, or None
    threads   cvtflow.Threads; None: the calling thread

    A start that has to settle does so first. Rows are taken at the first step at or after every multiple of the interval, as in a record.
    """
    simulation = scene if isinstance(scene, Simulation) else Simulation(scene, threads or Threads.caller())
    until = simulation.scene["run.until"] if until is None else _seconds(until)
    interval = simulation.scene["run.output_interval"] if interval is None else _seconds(interval)
    if not interval > 0.0:
        raise ValueError("interval: must be positive")
    if not until >= max(0.0, simulation.time):
        raise ValueError(f"until: {until:g} s is before {max(0.0, simulation.time):g} s, where the run begins")
    channels = _names(channels)
    now = simulation.channels
    for name in channels:
        now[name]  # raises what is wrong with a name before anything runs
    info = {name: column for name, column in now.info.items() if name in [split(each)[0] for each in channels]}
    if simulation.time < 0.0:
        simulation.advance_to(0.0)
    first = math.ceil(simulation.time / interval * (1.0 - 1e-9))
    energies = {name for channel in channels for sums in _energies_of_efficiency(channel) for name in sums if name in now}
    rows = {"time": []} | {name: [] for name in channels} | {name: [] for name in energies}
    for number in range(first, math.floor(until / interval * (1.0 + 1e-9)) + 1):
        simulation.advance_to(number * interval)
        for name, value in ((inputs(simulation.time, simulation) if inputs else None) or {}).items():
            simulation.set_input(name, value)
        rows["time"].append(simulation.time)
        for name in rows.keys() - {"time"}:
            rows[name].append(now[name])
    made = {name: np.array(values, dtype=float) for name, values in rows.items()}
    return Rows({name: made[name] for name in ("time", *channels)}, info, {name: made[name] for name in energies})
