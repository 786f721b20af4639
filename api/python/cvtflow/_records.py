"""Records of runs, read when asked."""

from collections.abc import Mapping

from ._cvtflow import RecordFile


class Record(Mapping):
    """The record of a run as a mapping from names of channels to arrays; "time" [s] is among them.

    record = cvtflow.Record("results/tiny.h5")
    record["links/tension"]            # all rows, [rows, links]; read now
    record.read("ratio", 100, 50)      # 50 rows from row 100 on
    """

    def __init__(self, path):
        self._file = RecordFile(str(path))
        self._channels = {row.name: row for row in self._file.channels()}
        self.path = str(path)

    status = property(lambda self: self._file.status, doc="finished, running, unreliable, or what ended the run.")
    attributes = property(lambda self: self._file.attributes(), doc="Of the whole file, by name.")
    channels = property(lambda self: dict(self._channels), doc="Column (unit, description, width) of every channel, by name.")
    rows = property(lambda self: self._file.rows(), doc="Rows that were there when the file was opened.")

    def read(self, channel, first=0, count=None):
        """Rows of a channel: [count] or [count, width]."""
        return self._file.read(channel, first, count)

    def state_times(self):
        """Times of the states recorded [s]."""
        return self._file.state_times()

    def __getitem__(self, name):
        if name != "time" and name not in self._channels:
            raise KeyError(name)
        return self._file.read(name)

    def __iter__(self):
        yield "time"
        yield from self._channels

    def __len__(self):
        return 1 + len(self._channels)

    def __repr__(self):
        return f"<cvtflow.Record {self.path}: {self.status}, {self.rows} rows of {len(self._channels)} channels>"
