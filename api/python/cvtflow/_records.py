"""Records of runs, read on demand."""

from collections.abc import Mapping

import numpy as np

from ._channels import Channels, Columns, split, unknown
from ._cvtflow import RecordFile
from ._series import Series


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
    record.read("ratio", 100, 50)      # 50 rows from row 100 on
    record.frame()                     # a pandas.DataFrame
    record.plot("slip")                # with Matplotlib
    """

    def __init__(self, path):
        self._file = RecordFile(str(path))
        self._columns = self._file.channels()
        self.path = str(path)

    status = property(lambda self: self._file.status, doc="finished, running, unreliable, or the cause of an early end.")
    attributes = property(lambda self: self._file.attributes(), doc="Of the whole file, by name.")
    channels = property(lambda self: Channels(self.__getitem__, Columns(self._columns)), doc="Arrays by name; channels.info: their units.")
    info = property(lambda self: {row.name: row for row in self._columns}, doc="Column (unit, description, width) of channels, by name.")
    rows = property(lambda self: self._file.rows(), doc="Number of rows when the file was opened.")
    states = property(lambda self: States(self._file), doc="The recorded states: time, unknowns, phases.")
    transitions = property(lambda self: self._file.transitions(),
                           doc="Changes of a tip's phase: an array with fields time, pin, tip, phase_from, phase_to.")

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

