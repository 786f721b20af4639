"""Many variants of a scene, as `cvtflow batch` and the scripts for Slurm run them."""

import os
import re
import tempfile
import threading
from pathlib import Path

from ._cvtflow import RecordError, Scene, SceneError, SweepFile, Table
from ._scene import all_keys, flat, resolve, suggestion, toml


def _list(values):
    return "[" + ", ".join(toml(value) for value in values) + "]"


class Results(dict):
    """Results of a sweep: arrays (lists for texts) by column, in the order of cases. info contains units and descriptions by column."""

    def __init__(self, table):
        super().__init__((column.name, table.read(column.name)) for column in table.columns())
        self.info = {column.name: column for column in table.columns()}

    def frame(self):
        """A pandas.DataFrame with the case as index; units by column are in frame.attrs["units"]. Raises ImportError without pandas."""
        import pandas

        frame = pandas.DataFrame(self).astype({"case": int}).set_index("case")
        frame.attrs["units"] = {name: column.unit for name, column in self.info.items()}
        return frame

    def column(self, name):
        """The name of a column: slip_mean also as "slip mean", load_torque as "load.torque"."""
        plain = re.sub(r"\W+", "_", name).strip("_")
        if plain in self:
            return plain
        raise KeyError(f"unknown column '{name}'" + suggestion(plain, self))

    def plot(self, x, y, by=None, ax=None, **style):
        """Draws a column over another with Matplotlib, one line for each value of the others that vary. Returns the Axes.

        by     a column, or a list of them, that lines are drawn for; None: every key of the scene that varies beside x
        ax     None: a new figure
        style  goes to Axes.plot
        """
        import matplotlib.pyplot as pyplot
        import numpy as np

        x, y = self.column(x), self.column(y)
        by = self._other_axes(x, y) if by is None else [self.column(name) for name in ([by] if isinstance(by, str) else by)]
        axes = ax or pyplot.subplots(layout="constrained")[1]
        cases = list(zip(*(self[name] for name in by))) if by else [()] * len(self[x])
        for group in sorted(set(cases)):
            chosen = np.array([number for number, case in enumerate(cases) if case == group])
            chosen = chosen[np.argsort(np.asarray(self[x])[chosen], kind="stable")]
            label = ", ".join(f"{self._label(name)} = {_short(value)}" for name, value in zip(by, group)) or None
            axes.plot(np.asarray(self[x])[chosen], np.asarray(self[y])[chosen], label=label, **{"marker": "o", **style})
        axes.set(xlabel=self._label(x), ylabel=self._label(y))
        if by:
            axes.legend()
        return axes

    def _other_axes(self, x, y):
        """Columns of keys that vary while x does not: what varies with x, as keys of one axis do, makes no line of its own."""
        keys = {name.replace(".", "_") for name in all_keys()}
        return [name for name in self if name in keys - {x, y} and len(set(zip(self[x], self[name]))) > len(set(self[x]))]

    def _label(self, name):
        unit = self.info[name].unit
        return name if unit in ("", "1") else f"{name} [{unit}]"

    def __repr__(self):
        return f"<cvtflow.Results: {len(self['case'])} cases of {', '.join(self)}>"


def _short(value):
    return f"{value:.6g}" if isinstance(value, (int, float)) else str(value)


class Sweep:
    """Every combination of values of some keys of a scene, and the requested scalars.

    sweep = cvtflow.Sweep(cvtflow.Scene.ready("tiny"), {"load.torque": ["6 N*m", "12 N*m"]}, ["slip mean", "efficiency mean"],
                          settings={"until": "0.2 ms"})
    results = sweep.run("results/loads")
    results["slip_mean"]                                   # an array
    results.plot(x="load.torque", y="efficiency mean")     # with Matplotlib; results.frame(): a pandas.DataFrame

    scene  a Scene, the name of a ready one, or a file
    axes   values by key, as Scene.with_() takes keys; keys that vary together are one tuple:
           {("clamping.driving", "clamping.driven"): [("3 kN", "2 kN"), ...]}
    write() gives the file that `cvtflow batch` and tools/slurm/submit take; results() reads what they left, of one machine or of many.
    """

    def __init__(self, scene, axes, scalars, *, settings=None, detail=None, start=None, from_=None, name=None):
        self.scene, self.axes, self.scalars = scene, dict(axes), list(scalars)
        self.settings, self.detail, self.start, self.from_ = dict(settings or {}), detail, start, from_
        self.name = name

    def _scene(self):
        """The scene, for the resolution of short keys."""
        if isinstance(self.scene, Scene):
            return self.scene
        return Scene.read(self.scene) if _is_path(self.scene) else Scene.ready(self.scene)

    def _place(self):
        """The scene's entry in a sweep file, which may be in any folder."""
        return os.path.abspath(self.scene) if _is_path(self.scene) else self.scene

    @property
    def text(self):
        """The sweep file."""
        return self._text("sweep.scene.toml" if isinstance(self.scene, Scene) else self._place())

    def _text(self, scene):
        lines = ["[sweep]", f"scene = {toml(scene)}"]
        lines += [f"name = {toml(self.name)}"] if self.name else []
        lines += [f"detail = {toml(self.detail)}"] if self.detail else []
        if self.settings:
            lines += ["[set]"] + [f"{key} = {toml(value)}" for key, value in flat(self._scene(), self.settings)]
        for keys, values in self.axes.items():
            lines += ["[[axes]]"] + self._axis(keys, list(values))
        lines += ["[outputs]", f"scalars = {_list(self.scalars)}"]
        lines += [f"from = {toml(self.from_)}"] if self.from_ else []
        lines += ["[start]", f"mode = {toml(self.start)}"] if self.start else []
        return "\n".join(lines) + "\n"

    def _axis(self, keys, values):
        if isinstance(keys, str):
            return [f"key = {toml(resolve(self._scene(), keys))}", f"values = {_list(values)}"]
        columns = zip(*values)
        rows = [f"{{key = {toml(resolve(self._scene(), key))}, values = {_list(column)}}}" for key, column in zip(keys, columns)]
        return ["zip = [" + ", ".join(rows) + "]"]

    def write(self, path):
        """Writes the sweep file, and a Scene beside it, and checks the sweep. Raises SceneError with every problem.

        Existing files are replaced only if a Sweep has written them: their first line says so. Raises RecordError for others.
        """
        files = self._files(Path(path))
        _check(files)
        _replace(files, _is_own)
        return SweepFile.read(str(path))

    def _files(self, path):
        """Text by file: the sweep file, and a Scene beside it."""
        if not isinstance(self.scene, Scene):
            return {path: MARK + self._text(self._place())}
        name = path.name[:-5] if path.name.endswith(".toml") else path.name
        scene = path.with_name(name + ".scene.toml")
        return {path: MARK + self._text(scene.name), scene: MARK + self.scene.text}

    def run(self, folder, threads=0, progress=None):
        """Runs what is missing in the folder, on so many threads (0: all), and returns results(folder).

        progress  called as progress(SweepProgress) after each case, on a worker's thread
        Ctrl-C ends it; running cases leave checkpoints, and the next call goes on. Raises StateError if the folder holds another sweep,
        whose files stay as they are.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        files = self._files(folder / "sweep.toml")
        if (folder / "cases.h5").exists() and not all(file.is_file() and file.read_bytes() == text.encode() for file, text in files.items()):
            with tempfile.TemporaryDirectory() as elsewhere:  # of another sweep: it is refused; else it goes on
                self.write(Path(elsewhere, "sweep.toml")).run(str(folder), threads, progress)
        else:
            self.write(folder / "sweep.toml").run(str(folder), threads, progress)
        return self.results(folder)

    @staticmethod
    def results(folder):
        """The Results in a folder or a table."""
        path = Path(folder)
        return Results(Table(str(path / "cases.h5" if path.is_dir() else path)))

    def submit(self, folder, *arguments):
        """Hands the sweep to Slurm by the installed script. Returns what it printed. The sweep file is FOLDER.toml; one of another sweep,
        which a job may be reading, is not replaced (RecordError)."""
        import subprocess

        script = os.environ.get("CVTFLOW_SLURM_SUBMIT") or _script()
        folder = Path(folder)
        files = self._files(folder.with_name(folder.name + ".toml"))
        folder.parent.mkdir(parents=True, exist_ok=True)
        _check(files)
        _replace(files, lambda there, text: there == text)
        return subprocess.run([script, str(next(iter(files))), str(folder), *arguments], check=True, capture_output=True, text=True).stdout


def _script():
    """tools/slurm/submit of this module's installation: PREFIX/share of PREFIX/lib/pythonX.Y/site-packages/cvtflow, or share of the package."""
    package = Path(__file__).resolve().parent
    places = [package]
    if package.parent.name in ("site-packages", "dist-packages"):
        places.append(package.parents[3])
    for place in places:
        found = place / "share/cvtflow/slurm/submit"
        if found.is_file():
            return str(found)
    raise FileNotFoundError("no share/cvtflow/slurm/submit in this module's installation; set CVTFLOW_SLURM_SUBMIT")


MARK = "# Written by cvtflow.Sweep, which may replace this file.\n"


def _is_own(there, text):
    """Whether a file may be replaced: written by a Sweep, or the same but for the first line (of earlier versions)."""
    return there.startswith(MARK) or MARK + there == text


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


def _replace(files, may_replace):
    """Writes files whose existing contents may be replaced, each at once. Raises RecordError before anything is written."""
    for file, text in files.items():
        if file.is_symlink() or (file.exists() and not file.is_file()):
            raise RecordError(f"{file}: cannot be written: not a plain file")
        if file.exists() and not may_replace(file.read_text(encoding="utf-8", errors="replace"), text):
            raise RecordError(f"{file}: already exists and is not the file of this sweep; move it away, or use another name")
    for file, text in files.items():
        new = file.with_name(f".{file.name}.{os.getpid()}.new")
        with open(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666), "w", encoding="utf-8") as opened:
            opened.write(text)
        os.replace(new, file)


def _is_path(scene):
    return isinstance(scene, os.PathLike) or "/" in scene or scene.endswith(".toml")


_run_uninterrupted = SweepFile.run


def _run(self, folder, threads=0, progress=None):
    """Runs the cases that are missing in folder/cases.h5. False after cancel(). Ctrl-C ends it; running cases leave checkpoints."""
    done, thrown = [], []
    over = threading.Event()  # not Thread.join: interrupted by a signal, Python 3.11 takes the thread for ended

    def work():
        try:
            done.append(_run_uninterrupted(self, folder, threads, progress))
        except BaseException as error:
            thrown.append(error)
        finally:
            over.set()

    threading.Thread(target=work).start()  # so that this one can be interrupted
    try:
        while not over.wait(0.1):
            pass
    except BaseException:
        self.cancel()
        over.wait()
        raise
    if thrown:
        raise thrown[0]
    return done[0]


SweepFile.run = _run
