"""Records of runs by h5py."""

import h5py
import numpy as np

from ._errors import ArgumentError
from ._library import Column


def _text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


class RecordFile:
    """The record of a run, read on demand."""

    def __init__(self, path):
        try:
            self._file = h5py.File(path, "r")
        except OSError:  # it is being written, or its writer was killed
            self._file = h5py.File(path, "r", libver="latest", swmr=True)
        self._count = len(self._file["channels/time"])

    status = property(lambda self: self.attributes().get("status", ""))

    def attributes(self):
        return {name: _text(value) for name, value in self._file.attrs.items()}

    def rows(self):
        return self._count

    def channels(self):
        found = []

        def take(name, item):
            if isinstance(item, h5py.Dataset) and name != "time":
                texts = (_text(item.attrs.get(each, b"")) for each in ("units", "description"))
                found.append((int(item.attrs.get("index", 0)), Column(name, *texts, item.shape[1] if item.ndim > 1 else 1)))

        self._file["channels"].visititems(take)
        return [column for _, column in sorted(found, key=lambda each: each[0])]

    def read(self, channel, first=0, count=None):
        last = max(first, self._count) if count is None else first + count
        if not 0 <= first <= last <= self._count:
            raise ArgumentError(f"rows {first} to {last} of {self._count}")
        values = self._file["channels"][channel][first:last].astype(float)
        return values[:, 0] if values.ndim > 1 and values.shape[1] == 1 else values

    def state_times(self):
        return self._file["states/time"][:] if "states" in self._file else np.empty(0)

    def state(self, number):
        return self._file["states/y"][number]

    def phases(self, number):
        return self._file["states/phases"][number] if "phases" in self._file["states"] else np.empty(0, dtype=np.uint8)

    def transitions(self):
        rows = self._file["tables/transitions"][:]
        rows.dtype.names = [{"from": "phase_from", "to": "phase_to"}.get(name, name) for name in rows.dtype.names]
        return rows
