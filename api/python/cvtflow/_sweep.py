"""Many variants of a scene, as `cvtflow batch` runs them."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ._errors import RecordError, SceneError, StateError
from ._scene import Scene, flat, is_path, opened, resolve
from ._sweep_file import SweepFile, file_text
from ._tables import Results


_WITH_ROWS = (5, 6, 7, 8)  # exit statuses of a sweep whose table says what failed


class Sweep:
    """Every combination of values of some keys of a scene, and the requested scalars.

    sweep = cvtflow.Sweep(cvtflow.Scene.ready("tiny"), {"load.torque": ["6 N*m", "12 N*m"]}, ["slip mean", "efficiency mean"],
                          settings={"until": "0.2 ms"})
    results = sweep.run("results/loads")
    results["slip_mean"]                                   # an array
    results.plot(x="load.torque", y="efficiency mean")     # with Matplotlib; results.frame(): a pandas.DataFrame

    scene  a Scene, the name of a ready one, or a file
    scalars  a scalar such as "slip mean", or a list of them
    axes   values by key, as Scene.with_() takes keys; a range is {"from": 6, "to": "12 N*m", "count": 4, "scale": "log"};
           keys that vary together are one tuple: {("clamping.driving", "clamping.driven"): [("3 kN", "2 kN"), ...]};
           rows of a file are {"csv": "points.csv"}, with "columns": {"M": "load.torque"} those of a measured file;
           a sample is {"sample": "latin-hypercube", "count": 20, "seed": 1, "keys": {"load.torque": ("6 N*m", "12 N*m")}}, or "random";
           several of these are a list: [{"load.torque": [6, 12]}, {"csv": "points.csv"}]
    start  scene, settle or shared, or the keys of [start]: {"mode": "settle", "continuation": "load.torque"}
    from_  outputs before this time do not count
    budget    largest wall time of a case ("10 min"; numbers are in s), or {"steps": 100000, "wall": "10 min"}
    accuracy  limit of the error of every scalar ("1 %"), or {"target": "1 %", "verify": 5, "seed": 1}: the sweep chooses detail, method and
              step, and columns error_of_... contain the errors of the cases that it verifies
    Malformed axes raise TypeError or ValueError, keys, values and scalars that a sweep file cannot have SceneError.
    write() gives the file that `cvtflow batch` takes; results() reads what they left, of one machine or of many.
    """

    def __init__(self, scene: Scene | str | os.PathLike[str], axes: Any, scalars: str | Iterable[str], *,
                 settings: Mapping[str, Any] | None = None, detail: str | None = None, start: str | Mapping[str, Any] | None = None,
                 from_: float | str | None = None, name: str | None = None, budget: str | float | Mapping[str, Any] | None = None,
                 accuracy: str | float | Mapping[str, Any] | None = None) -> None:
        self.scene, self.axes, self.scalars = scene, _axes(axes), [scalars] if isinstance(scalars, str) else list(scalars)
        self.settings, self.detail, self.start, self.from_ = dict(settings or {}), detail, start, from_
        self.name, self.budget, self.accuracy = name, budget, accuracy
        _check(self._files(Path("sweep.toml")))

    def __repr__(self):
        counts = [len(values) if isinstance(values, list) else values.get("count", "?") for _, values in self.axes]
        lengths = [f"{keys if isinstance(keys, str) else ' with '.join(keys)} ({count})" for (keys, _), count in zip(self.axes, counts)]
        cases = "?" if "?" in counts else math.prod(counts)  # the rows of a file are not counted
        name = self.scene.name if isinstance(self.scene, Scene) else self.scene
        return f"<cvtflow.Sweep of {name}: {cases} cases over {', '.join(lengths)}; {', '.join(self.scalars)}>"

    def _scene(self):
        """The scene, for the resolution of short keys."""
        return opened(self.scene)

    def _place(self):
        """The scene's entry in a sweep file, which may be in any folder."""
        return os.path.abspath(self.scene) if is_path(self.scene) else self.scene

    @property
    def text(self) -> str:
        """The sweep file."""
        return self._text("sweep.scene.toml" if isinstance(self.scene, Scene) else self._place())

    def _text(self, scene):
        outputs = {"scalars": self.scalars} | ({"from": self.from_} if self.from_ else {})
        sections = {"set": dict(flat(self._scene(), self.settings))} if self.settings else {}
        sections |= {"axes": [self._axis(*axis) for axis in self.axes], "outputs": outputs}
        for section, first, given in (("start", "mode", self.start), ("budget", "wall", self.budget), ("accuracy", "target", self.accuracy)):
            if given is not None:
                sections[section] = given if isinstance(given, Mapping) else {first: given}
        return file_text(sections, scene=scene, name=self.name, detail=self.detail)

    def _axis(self, keys, values):
        """An axis as a sweep file has it."""
        if keys in ("csv", "sample"):
            return self._points(values)
        if isinstance(keys, str):
            return {"key": resolve(self._scene(), keys), **(values if isinstance(values, Mapping) else {"values": values})}
        return {"zip": [{"key": resolve(self._scene(), key), "values": column} for key, column in zip(keys, zip(*values))]}

    def _points(self, axis):
        """A csv or a sample as a sweep file has it, from short names of keys and a path relative to the working directory."""
        axis, scene = dict(axis), self._scene()
        if "csv" in axis:
            axis["csv"] = os.path.abspath(axis["csv"])
        if isinstance(axis.get("columns"), Mapping):
            axis["columns"] = [{"column": column, "key": resolve(scene, key)} for column, key in axis["columns"].items()]
        if isinstance(axis.get("keys"), Mapping):
            axis["keys"] = [{"key": resolve(scene, key), **_ends(key, ends)} for key, ends in axis["keys"].items()]
        return axis

    def write(self, path: str | os.PathLike[str], force: bool = False) -> SweepFile:
        """Writes the sweep file, and a Scene beside it, and checks the sweep. Raises SceneError with every problem.

        A file that exists with other contents is replaced only with `force`; else RecordError is raised and no file is changed.
        """
        files = self._files(Path(path))
        _check(files)
        _write(files, force)
        return SweepFile.read(str(path))

    def _files(self, path):
        """Text by file: the sweep file, and a Scene beside it."""
        if not isinstance(self.scene, Scene):
            return {path: self._text(self._place())}
        name = path.name[:-5] if path.name.endswith(".toml") else path.name
        scene = path.with_name(name + ".scene.toml")
        return {path: self._text(scene.name), scene: self.scene.text}

    def run(self, folder: str | os.PathLike[str], threads: int = 0, progress: Any = True, client: Any = None,
            keep_going: bool = False) -> Results:
        """Runs what is missing in the folder, on so many threads (0: all), and returns results(folder).

        progress  True: one line that replaces itself, where stderr is a terminal or in a notebook, else nothing; False or None: nothing;
                  a function: called as progress(SweepProgress) after each case, on a worker's thread
        client    a distributed.Client: every worker of that Dask cluster becomes a worker of the sweep, by `cvtflow batch`, on so
                  many threads each. The folder is one that all of them see, and the program `cvtflow` is on their PATH. Progress is
                  looked up once a second. Raises RuntimeError with what a worker printed that could not work.
        keep_going  runs all cases, also where the first dozen fail alike, which else raises StateError; not with a client
        Ctrl-C ends it, and the next call continues with the cases that have not ended. Raises StateError if the folder holds another sweep,
        whose files stay as they are.
        """
        folder = Path(folder)
        if client is not None:
            return self._run_on(client, folder.absolute(), threads, progress)
        folder.mkdir(parents=True, exist_ok=True)
        if self.accuracy is not None:
            return self._run_verified(folder, threads, progress, keep_going)
        if (folder / "sweep.json").exists() and not self._has_files(folder):
            with tempfile.TemporaryDirectory() as elsewhere:  # of another sweep: it is refused; else it continues
                _run(self.write(Path(elsewhere, "sweep.toml")), folder, threads, progress, keep_going)
        else:
            _run(self.write(folder / "sweep.toml"), folder, threads, progress, keep_going)
        return self.results(folder)

    def _run_verified(self, folder, threads, progress, keep_going):
        from . import _verified_sweep

        with tempfile.TemporaryDirectory() as elsewhere:
            path = Path(elsewhere, "sweep.toml")
            self.write(path)
            _verified_sweep.tune(path, folder, threads)
            _run(SweepFile.read(folder / "tuned.toml"), folder, threads, progress, keep_going)
            _verified_sweep.verify(folder, threads)
        return self.results(folder)

    def _has_files(self, folder):
        """Whether a folder has the files of this sweep."""
        return all(_has(file, text) for file, text in self._files(folder / "sweep.toml").items())

    def _run_on(self, client, folder, threads, progress):
        from distributed import Event

        folder.mkdir(parents=True, exist_ok=True)
        if (folder / "sweep.json").exists() and not self._has_files(folder):
            raise StateError(f"{folder}: results of another sweep")
        self.write(folder / "sweep.toml")
        stop = Event(f"cvtflow-{folder}", client=client)
        stop.clear()
        now = before = _done(folder)
        begin = time.monotonic()
        tasks = [client.submit(_work, str(folder), threads, workers=[place], allow_other_workers=True, pure=False)  # if that one is lost
                 for place in client.scheduler_info()["workers"]]
        report = _reporter(progress)
        try:
            while True:
                over = all(task.done() for task in tasks)
                if report:
                    now = _done(folder, now)
                    report(SimpleNamespace(cases=now["cases"], before=before["done"], done=now["done"] - before["done"], failed=now["failed"],
                                           wall=time.monotonic() - begin))
                if isinstance(report, Line):
                    report.show("\n" if over else "")
                if over:
                    break
                time.sleep(1.0)
        except BaseException:
            stop.set()
            raise
        for task in tasks:
            task.result()
        return self.results(folder)

    @staticmethod
    def results(folder: str | os.PathLike[str]) -> Results:
        """The Results in a folder, finished or not, or in a CSV of them."""
        return Results(folder)

    def submit(self, folder: str | os.PathLike[str], *arguments: str, workers: int = 10) -> str:
        """Submits a job array of workers to Slurm, with further arguments of `sbatch`, such as "--time=4:00:00". Returns the job's number.
        The sweep file is FOLDER.toml; one of another sweep, which a job may be reading, is not replaced (RecordError). Raises
        FileNotFoundError where `sbatch` or `cvtflow` is not on the PATH, subprocess.CalledProcessError where Slurm refuses the job."""
        import shlex
        import shutil

        folder, program = Path(folder).absolute(), shutil.which("cvtflow")
        if program is None:
            raise FileNotFoundError("cvtflow: no such program on the PATH, which workers run")
        files = self._files(folder.with_name(folder.name + ".toml"))
        folder.parent.mkdir(parents=True, exist_ok=True)
        _check(files)
        _write(files)
        worker = shlex.join(["exec", program, "batch", str(next(iter(files))), "-o", str(folder)])
        return subprocess.run(["sbatch", "--parsable", f"--array=1-{workers}", "--requeue", *arguments, "--wrap", worker], check=True,
                              stdout=subprocess.PIPE, text=True).stdout.strip()


def _check(files):
    """Reads the sweep in a folder of its own, so that nothing is replaced if it is wrong. Raises SceneError with the places in `files`."""
    first = next(iter(files))
    with tempfile.TemporaryDirectory() as folder:
        for file, text in files.items():
            Path(folder, file.name).write_text(text, encoding="utf-8")
        try:
            SweepFile.read(str(Path(folder, first.name)))
        except SceneError as error:
            raise SceneError(str(error).replace(folder, str(first.parent))) from None


def _write(files, force=False):
    """Writes those files that do not have their text yet; all places are checked before. Raises RecordError."""
    from ._output import Output, OutputError

    for last in [False] * 25 + [True]:  # of processes that begin a sweep together one writes, in this half second
        try:
            outputs = {file: Output(str(file), force=force) for file, text in files.items() if not _has(file, text)}
            for file, output in outputs.items():
                output.write(files[file].encode())
            return
        except OutputError as error:
            if last:
                raise RecordError(str(error).replace("--force", "write() with force=True")) from None
            time.sleep(0.02)


def _has(file, text):
    return file.is_file() and file.read_bytes() == text.encode()


def _axes(given):
    """(keys, values) of every axis: a list of values, a range, or ("csv" or "sample", the whole axis). Raises TypeError, ValueError."""
    axes = []
    for each in given if isinstance(given, (list, tuple)) else [given]:
        if not isinstance(each, Mapping):
            raise TypeError(f"axes: values by key, or a list of such dicts, not {each!r}")
        kind = next((kind for kind in ("csv", "sample") if kind in each), None)
        for keys, values in [(kind, dict(each))] if kind else each.items():
            if not isinstance(values, Iterable) or isinstance(values, (str, bytes)):
                raise TypeError(f"axes: {keys} takes a list of values, not {values!r}")
            values = dict(values) if isinstance(values, Mapping) else list(values)
            if isinstance(keys, tuple) and not all(isinstance(row, Iterable) and len(row) == len(keys) for row in values):
                raise ValueError(f"axes: {', '.join(keys)}: each value is a tuple of {len(keys)}")
            axes.append((keys, values))
    return axes


def _ends(key, ends):
    """Interval of a key in a sample, given as (from, to) or as a sweep file has it."""
    if not isinstance(ends, Mapping) and not (isinstance(ends, (tuple, list)) and len(ends) == 2):
        raise TypeError(f"axes: {key} takes (from, to), not {ends!r}")
    return ends if isinstance(ends, Mapping) else {"from": ends[0], "to": ends[1]}


def _work(folder, threads):
    """A worker of a sweep, as a task of Dask."""
    from distributed import Event

    stop = Event(f"cvtflow-{folder}")
    command = ["cvtflow", "batch", f"{folder}/sweep.toml", "-o", folder, "-q", *(["--threads", str(threads)] if threads else [])]
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said)
        while process.poll() is None:
            if stop.wait(timeout="1s"):
                process.terminate()
        if process.returncode not in (0, *_WITH_ROWS, 130):
            said.seek(0)
            raise RuntimeError(f"{' '.join(command)}: exit status {process.returncode}: {said.read().strip()}")


def _done(folder, last={"cases": 0, "done": 0, "failed": 0}):
    """How far the sweep in a folder is; as `last` before it has begun."""
    told = subprocess.run(["cvtflow", "info", str(folder), "--json"], capture_output=True, text=True)
    return json.loads(told.stdout) if told.returncode == 0 else last


def _reporter(progress):
    """What is called with the progress; None: nothing. Raises TypeError."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(f"progress: True, False or a function of a SweepProgress, not {progress!r}")
    return Line() if progress is True else progress or None


def _run(file, folder, threads, progress, keep_going):
    """Runs a SweepFile with the progress of Sweep.run()."""
    report = _reporter(progress)
    file.run(folder, threads, report, report.show if isinstance(report, Line) else lambda end: None, keep_going)


class Line:
    """Progress of a sweep as one line that replaces itself: on stderr if that is a terminal, in a notebook's cell; elsewhere nothing, or
    lines on stderr, in the end and at most every so many seconds before."""

    def __init__(self, every=None):
        shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
        terminal = sys.stderr is not None and sys.stderr.isatty()
        self._stream = sys.stdout if hasattr(shell, "kernel") else sys.stderr if terminal or every else None
        self._every, self._next = 0.0 if terminal else every or 0.0, time.monotonic() + (every or 0.0)
        self._now, self._text = None, ""

    def __call__(self, now):  # on a worker's thread
        self._now = now

    def show(self, end=""):
        """On the caller's thread, to which a notebook's cell belongs."""
        now = self._now
        if now is None or self._stream is None:
            return
        left = now.cases - now.before - now.done
        text = f"{now.cases - left} of {now.cases} cases" + (f", {now.failed} failed" if now.failed else "")
        if left and now.done:
            seconds = math.ceil(now.wall * left / now.done)
            text += f", about {seconds} s left" if seconds < 120 else f", about {seconds // 60} min left"
        if self._every and (end or time.monotonic() > self._next):
            print(text, file=self._stream, flush=True)
            self._next = time.monotonic() + self._every
        elif not self._every and (text != self._text or end):
            print("\r" + text.ljust(len(self._text)), end=end, file=self._stream, flush=True)
        self._text = text
