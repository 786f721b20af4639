"""Sweep files, read, checked and run by the library."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any

from ._errors import CancelledError
from ._library import ON_PROGRESS, SweepProgress, c, check, encoded, interruptible, message, plain
from ._scene import toml


def file_text(sections: Mapping[str, Any], **head: Any) -> str:
    """The text of a sweep file. sections: all but [sweep], a list of axes among them; head: keys of [sweep], None: without that one"""
    lines = []
    for name, given in {"sweep": {key: value for key, value in head.items() if value}, **sections}.items():
        for values in given if isinstance(given, list) else [given]:
            lines += [f"[[{name}]]" if isinstance(given, list) else f"[{name}]", *(f"{key} = {toml(value)}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


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
        place = encoded(path, (str, os.PathLike))  # Ctrl-C would be lost in a callback on this thread
        interruptible(lambda: check(c.sweep_run(place, None, 1, 0, progress, None, message())), lambda: None)
        return SweepFile(os.fspath(path), cases[0])

    def cancel(self) -> None:
        """Requests the end of run() in another thread; cases that it interrupts run again later."""
        self._ends = True

    def run(self, folder: str | os.PathLike[str], threads: int = 0, progress: Callable[[SweepProgress], Any] | None = None,
            waiting: Callable[[str], Any] = lambda end: None, keep_going: bool = False) -> bool:
        """Runs the cases that have no row in the folder. False after cancel(). Ctrl-C ends it.

        progress  called after each case, on a worker's thread
        waiting   called at intervals with "", and in the end with a line break, on the caller's thread
        keep_going  runs all cases, also where the first dozen fail alike, which else raises StateError
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
            interruptible(lambda: check(c.sweep_run(path, place, threads, keep_going, function, None, message())), self.cancel, waiting)
        except CancelledError:
            if thrown:
                raise thrown[0] from None
            return False
        return True
