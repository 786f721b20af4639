"""Sweep files, read, checked and run by the library; tables of cases by h5py."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, NamedTuple

from ._errors import CancelledError, RecordError
from ._known import require_file
from ._library import ON_PROGRESS, SweepProgress, c, check, encoded, interruptible, message, plain


class SweepFile:
    """A sweep file, read and checked. cases: their number."""

    def __init__(self, path: str, cases: int) -> None:
        self._path, self.cases, self._ends = path, cases, False

    @staticmethod
    @plain("SweepFile.read")
    def read(path: str | os.PathLike[str]) -> SweepFile:
        """Raises SceneError with every problem in it."""
        cases: list[int] = []
        progress = ON_PROGRESS(lambda now, _: cases.append(now.contents.cases) or 0)
        check(c.sweep_run(encoded(path, (str, os.PathLike)), None, 1, progress, None, message()))
        return SweepFile(os.fspath(path), cases[0])

    def cancel(self) -> None:
        """Requests the end of run() in another thread; running cases write checkpoints."""
        self._ends = True

    def run(self, folder: str | os.PathLike[str], threads: int = 0, progress: Callable[[SweepProgress], Any] | None = None,
            waiting: Callable[[str], Any] = lambda end: None) -> bool:
        """Runs the cases that are missing in the folder. False after cancel(). Ctrl-C ends it; running cases leave checkpoints.

        progress  called after each case, on a worker's thread
        waiting   called at intervals with "", and in the end with a line break, on the caller's thread
        """
        thrown: list[BaseException] = []
        done = [-1]  # the library calls at intervals, too

        def report(now, _):
            try:
                if progress is not None and now.contents.done != done[0]:
                    done[0] = now.contents.done
                    progress(SweepProgress.from_buffer_copy(now.contents))
            except BaseException as error:
                thrown.append(error)
            return int(self._ends or bool(thrown))

        function, path, place = ON_PROGRESS(report), encoded(self._path), encoded(folder, (str, os.PathLike))
        self._ends = False
        try:
            interruptible(lambda: check(c.sweep_run(path, place, threads, function, None, message())), self.cancel, waiting)
        except CancelledError:
            if thrown:
                raise thrown[0] from None
            return False
        return True


class TableColumn(NamedTuple):
    """A column of a table: name, unit ("1" for a plain number, empty for texts), description."""

    name: str
    unit: str
    description: str


class Table:
    """Results of a sweep (cases.h5), in the order of cases."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        import h5py
        import numpy

        require_file(path)
        try:
            try:
                file = h5py.File(path, "r")
            except OSError:  # it is being written, or its writer was killed
                file = h5py.File(path, "r", libver="latest", swmr=True)
            with file:
                rows = file["cases"][:]
                texts = [[_text(each) for each in file["cases"].attrs[name]] for name in ("columns", "units", "descriptions")]
                self._attributes = {name: _text(value) for name, value in file.attrs.items()}
        except (OSError, KeyError) as error:
            raise RecordError(f"{path}: not a table of cases that can be read: {error}") from None
        self._columns = [TableColumn(*each) for each in zip(*texts)]
        self._rows, self._numpy = rows[numpy.argsort(rows["case"], kind="stable")], numpy

    def attributes(self) -> dict[str, Any]:
        """Of the whole table, by name."""
        return self._attributes

    def columns(self) -> list[TableColumn]:
        """Names and units."""
        return self._columns

    def rows(self) -> int:
        """Number of cases."""
        return len(self._rows)

    def read(self, column: str) -> Any:
        """A column [rows]: an array of numbers, or a list of texts."""
        values = self._rows[column]
        return [_text(each) for each in values] if values.dtype.kind in "SO" else values.astype(float)


def _text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value
