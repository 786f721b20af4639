"""Many variants of a scene, as `cvtflow batch` and the scripts for Slurm run them."""

import math
import os
import re
import tempfile
import threading
from pathlib import Path

import numpy as np

from ._channels import shown
from ._cvtflow import RecordError, Scene, SceneError, SweepFile, Table, quantity
from ._scene import all_keys, flat, resolve, suggestion, toml


def _list(values):
    return "[" + ", ".join(toml(value) for value in values) + "]"


def _middle(line, size):
    """Length of a line [1] and its middle, where a label is farthest from its ends. size: width and height of the map"""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*(np.diff(line, axis=0) / size).T))))
    return along[-1], [np.interp(0.5 * along[-1], along, line[:, k]) for k in (0, 1)]


class Results(dict):
    """Results of a sweep: arrays (lists for texts) by column, in the order of cases. info contains units and descriptions by column."""

    def __init__(self, table):
        if not isinstance(table, Table):
            raise TypeError(f"Results() takes a Table, not {type(table).__name__}; Sweep.results(folder) reads a sweep's folder")
        super().__init__((column.name, table.read(column.name)) for column in table.columns())
        self.info = {column.name: column for column in table.columns()}

    def frame(self):
        """A pandas.DataFrame with the case as index; units by column are in frame.attrs["units"]. Raises ImportError without pandas."""
        import pandas

        frame = pandas.DataFrame(self).astype({"case": int}).set_index("case")
        frame.attrs["units"] = {name: column.unit for name, column in self.info.items()}
        return frame

    def column(self, name):
        """The name of a column: slip_mean also as "slip mean", load_torque as "load.torque", or as "torque" where no other key ends so."""
        if not isinstance(name, str):
            raise TypeError(f"a column is named by a text, not by {type(name).__name__} {name!r}")
        plain = re.sub(r"\W+", "_", name).strip("_")
        if plain in self:
            return plain
        keys = [key.replace(".", "_") for key in all_keys() if key.rpartition(".")[2] == plain]
        if len(meant := [key for key in keys if key in self]) == 1:
            return meant[0]
        raise KeyError(f"unknown column '{name}'" + suggestion(plain, self))

    def where(self, **values):
        """The Results of the cases with these values, numbers in SI or texts with a unit: where(load__torque="6 N*m", status="ok"). A list
        means any of its values. Raises ValueError for a number that no case has."""
        kept = np.ones(len(self["case"]), dtype=bool)
        for name, value in values.items():
            name = self.column(name.replace("__", "_"))
            unit = self.info[name].unit
            own, allowed = np.asarray(self[name]), value if isinstance(value, (list, tuple, np.ndarray)) else [value]
            if unit:
                allowed = [quantity(each, unit) if isinstance(each, str) else each for each in allowed]
                matches = np.any([np.isclose(own, each, rtol=1e-12, atol=0.0) for each in allowed], axis=0)
                if not np.any(matches):
                    there = ", ".join(f"{each:.6g}" for each in np.unique(own)[:6])
                    raise ValueError(f"no case has {name} = {value!r}; in {unit} there are {there}{', …' if len(np.unique(own)) > 6 else ''}")
            else:
                matches = np.any([own == each for each in allowed], axis=0)
            kept &= matches
        some = dict.__new__(Results)
        some.update({name: np.asarray(column)[kept] for name, column in self.items()})
        some.info = self.info
        return some

    def plot(self, x, y, by=None, ax=None, si=False, **style):
        """Draws a column over another with Matplotlib, one line for each value of the others that vary. Returns the Axes.

        by     a column, or a list of them, that lines are drawn for; None: every key of the scene that varies beside x
        ax     None: a new figure
        si     whether units are SI, as those of the values, instead of bar, l/min, rpm, kN, mm and %
        style  is passed to Axes.plot
        """
        import matplotlib.pyplot as pyplot

        x, y = self.column(x), self.column(y)
        by = self._other_axes(x, y) if by is None else [self.column(name) for name in ([by] if isinstance(by, str) else by)]
        axes = ax or pyplot.subplots(layout="constrained")[1]
        across, up = self._shown(x, si)[1], self._shown(y, si)[1]
        cases = list(zip(*(self[name] for name in by))) if by else [()] * len(across)
        for group in sorted(set(cases)):
            chosen = np.array([number for number, case in enumerate(cases) if case == group])
            chosen = chosen[np.argsort(across[chosen], kind="stable")]
            label = ", ".join(self._setting(name, value, si) for name, value in zip(by, group)) or None
            axes.plot(across[chosen], up[chosen], label=label, **{"marker": "o", **style})
        axes.set(xlabel=self._shown(x, si)[0], ylabel=self._shown(y, si)[0])
        if by:
            axes.legend()
        return axes

    def map(self, x, y, value, ax=None, si=False, **style):
        """Draws a column as colours over two others with Matplotlib: a smooth map with contours where the cases form a grid, else points.
        Returns the Axes. Raises ValueError for several cases at one point: where() chooses among them.

        si     as in plot()
        style  is passed to Axes.contourf or Axes.scatter
        """
        import matplotlib.pyplot as pyplot

        x, y, value = (self.column(name) for name in (x, y, value))
        across, up, colours = (self._shown(name, si)[1] for name in (x, y, value))
        xs, column = np.unique(across, return_inverse=True)
        ys, row = np.unique(up, return_inverse=True)
        grid = np.full((len(ys), len(xs)), np.nan)
        if len(set(zip(column, row))) < len(column):
            among = ", ".join(self._other_axes(x, y))
            raise ValueError(f"several cases at one point of {x} and {y}: choose with where() among {among}")
        grid[row, column] = colours
        axes = ax or pyplot.subplots(layout="constrained")[1]
        if min(grid.shape) > 1 and np.isfinite(grid).all():
            drawn = axes.contourf(xs, ys, grid, **{"levels": 12, **style})
            lines = axes.contour(drawn, colors="black", linewidths=0.8)
            longest = [max(_middle(line, (np.ptp(xs), np.ptp(ys))) for line in level) for level in lines.allsegs if level]
            axes.clabel(lines, manual=[middle for length, middle in longest if length > 0.15])  # shorter lines have no room
        else:
            drawn = axes.scatter(across, up, c=colours, **style)
        axes.figure.colorbar(drawn, ax=axes, label=self._shown(value, si)[0])
        axes.set(xlabel=self._shown(x, si)[0], ylabel=self._shown(y, si)[0])
        return axes

    def pivot(self, index, columns, values):
        """A pandas.DataFrame of one column over two others, in SI units. Raises ValueError for several cases at one point."""
        index, columns, values = (self.column(name) for name in (index, columns, values))
        return self.frame().pivot(index=index, columns=columns, values=values)

    def axes(self):
        """The columns of keys of the scene that vary and distinguish the cases: one that only follows another is left out."""
        keys, found, known = {name.replace(".", "_") for name in all_keys()}, [], 1
        for name in self:
            distinct = len(set(zip(*(self[each] for each in [*found, name])))) if name in keys else 0
            if distinct > known:
                found, known = [*found, name], distinct
        return found

    def to_xarray(self):
        """An xarray.Dataset with a dimension for each of axes() and a variable for each other column; points without a case are NaN, or
        empty texts. Units are attributes. Raises ImportError where xarray is not installed, ValueError for several cases at one point."""
        import xarray

        axes = self.axes()
        points = [np.unique(self[name], return_inverse=True) for name in axes]
        place, shape = tuple(inverse for _, inverse in points), tuple(len(values) for values, _ in points)
        if len(set(zip(*place))) < len(self["case"]):
            raise ValueError(f"several cases at one point of {', '.join(axes)}: choose with where()")
        made = {}
        for name, column in self.items():
            if name not in axes:
                text = isinstance(column[0], str)
                grid = np.full(shape, "" if text else np.nan, dtype=object if text else float)
                grid[place] = column
                made[name] = (axes, grid, {"units": self.info[name].unit, "long_name": self.info[name].description})
        coords = {name: (name, values, {"units": self.info[name].unit}) for name, (values, _) in zip(axes, points)}
        return xarray.Dataset(made, coords=coords)

    def _other_axes(self, x, y):
        """Columns of keys that vary while x does not: what varies with x, as keys of one axis do, makes no line of its own."""
        keys = {name.replace(".", "_") for name in all_keys()}
        return [name for name in self if name in keys - {x, y} and len(set(zip(self[x], self[name]))) > len(set(self[x]))]

    def _shown(self, name, si):
        """Label and values with which pictures show a column."""
        label, factor = shown(name, self.info[name].unit, si)
        return label, factor * np.asarray(self[name], dtype=float)

    def _setting(self, name, value, si):
        """load torque = 6 N·m, of a legend."""
        label, factor = shown(name, self.info[name].unit, si)
        words, _, unit = label.partition(" [")
        return f"{words} = {_short(factor * value if isinstance(value, (int, float)) else value)} {unit.rstrip(']')}".rstrip()

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
    scalars  a scalar such as "slip mean", or a list of them
    axes   values by key, as Scene.with_() takes keys; keys that vary together are one tuple:
           {("clamping.driving", "clamping.driven"): [("3 kN", "2 kN"), ...]}
    write() gives the file that `cvtflow batch` and tools/slurm/submit take; results() reads what they left, of one machine or of many.
    """

    def __init__(self, scene, axes, scalars, *, settings=None, detail=None, start=None, from_=None, name=None):
        self.scene, self.axes, self.scalars = scene, dict(axes), [scalars] if isinstance(scalars, str) else list(scalars)
        self.settings, self.detail, self.start, self.from_ = dict(settings or {}), detail, start, from_
        self.name = name

    def __repr__(self):
        lengths = [f"{keys if isinstance(keys, str) else ' with '.join(keys)} ({len(values)})" for keys, values in self.axes.items()]
        name = self.scene.name if isinstance(self.scene, Scene) else self.scene
        cases = math.prod(len(values) for values in self.axes.values())
        return f"<cvtflow.Sweep of {name}: {cases} cases over {', '.join(lengths)}; {', '.join(self.scalars)}>"

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

        Existing files are replaced only if a Sweep has written them, which their first line states. Raises RecordError for others.
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
        Ctrl-C ends it; running cases leave checkpoints, and the next call continues. Raises StateError if the folder holds another sweep,
        whose files stay as they are.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        files = self._files(folder / "sweep.toml")
        if (folder / "cases.h5").exists() and not all(file.is_file() and file.read_bytes() == text.encode() for file, text in files.items()):
            with tempfile.TemporaryDirectory() as elsewhere:  # of another sweep: it is refused; else it continues
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


class Fit:
    """Result of fit(): values by key in SI, confidence intervals by key, residuals (simulated less measured) by column, and the scene."""

    def __init__(self, scene, values, confidence, residuals, level):
        self.scene, self.values, self.confidence, self.residuals, self.level = scene, values, confidence, residuals, level

    def __repr__(self):
        lines = [f"{key} = {value:.5g} ({self.confidence[key][0]:.5g} to {self.confidence[key][1]:.5g} at {100 * self.level:g} %)"
                 for key, value in self.values.items()]
        rest = [f"{name}: {math.sqrt(np.mean(each ** 2)):.3g} rms" for name, each in self.residuals.items()]
        return f"<cvtflow.Fit {', '.join(lines)}; residuals {', '.join(rest)}>"


def fit(scene, parameters, measured, *, deviations=None, level=0.95, settings=None, threads=0, step=0.02):
    """Adjusts keys of a scene to measured values by least squares (scipy.optimize.least_squares). Returns a Fit.

    fit("baseline", {"tip.friction_coefficient": (0.05, 0.14)}, {"load.torque": [60, 120, 180], "slip mean": [0.0015, 0.0028, 0.0046]})

    parameters  least and largest value by key, in SI or with units; the search begins at the value of the scene
    measured    arrays of equal length by name, or a pandas.DataFrame: keys of the scene are operating points, other names are scalars of a
                sweep ("slip mean", "efficiency mean", "thrust_ratio mean") with their measured values, in SI
    deviations  standard deviation of a measured value by scalar; None: 1 % of its largest magnitude
    level       of the confidence intervals, from the Jacobian and the residuals; infinite without more values than parameters
    settings    further values of keys by name, such as run.until
    step        relative change of a key for its derivative
    Raises ImportError where SciPy is not installed, ValueError for malformed arguments, RuntimeError for a case without a result.
    """
    from scipy.optimize import least_squares
    from scipy.stats import t as student

    scene = Sweep(scene, {}, [])._scene().with_(settings or {})
    columns = {name: np.asarray(measured[name], dtype=float) for name in measured}
    points = {name: each for name, each in columns.items() if name in all_keys()}
    targets = {name: each for name, each in columns.items() if name not in points}
    if not points or not targets or len({len(each) for each in columns.values()}) != 1:
        raise ValueError("measured: one key of the scene or more, and one scalar or more, of equal lengths")
    if not hasattr(parameters, "values") or not all(isinstance(ends, (tuple, list)) and len(ends) == 2 for ends in parameters.values()):
        raise TypeError('parameters: least and largest value by key, such as {"tip.friction_coefficient": (0.05, 0.14)}')
    keys = [resolve(scene, name) for name in parameters]
    low, high = np.array([[_in_si(key, value) for value in ends] for key, ends in zip(keys, parameters.values())], dtype=float).T
    if not np.all(low < high):
        raise ValueError("parameters: the least value of a key is not below its largest")
    scale = {name: (deviations or {}).get(name, 0.01 * np.max(np.abs(each))) for name, each in targets.items()}

    def residuals_at(values):
        rows = list(zip(*points.values()))
        axes = {tuple(points): rows} if len(points) > 1 else {key: list(each) for key, each in points.items()}
        sweep = Sweep(scene.with_({key: float(value) for key, value in zip(keys, values)}), axes, list(targets))
        with tempfile.TemporaryDirectory() as folder:
            results = sweep.run(folder, threads)
        for number, status in enumerate(results["status"]):
            if status != "ok":
                raise RuntimeError(f"case {number} of {dict(zip(keys, values))} ended with the status {status}")
        return {name: np.asarray(results[results.column(name)]) - each for name, each in targets.items()}

    def weighted(values):
        return np.concatenate([each / scale[name] for name, each in residuals_at(values).items()])

    first = np.clip([float(scene[key]) for key in keys], low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    found = least_squares(weighted, first, bounds=(low, high), x_scale=high - low, diff_step=step, xtol=1e-4, ftol=1e-8)
    free = len(found.fun) - len(keys)
    covariance = np.linalg.pinv(found.jac.T @ found.jac)
    spread = np.sqrt(np.diag(covariance) * (2.0 * found.cost / free)) if free > 0 else np.full(len(keys), np.inf)
    reach = spread * (student.ppf(0.5 + 0.5 * level, free) if free > 0 else 1.0)
    values = {key: float(value) for key, value in zip(keys, found.x)}
    intervals = {key: (float(value - each), float(value + each)) for key, value, each in zip(keys, found.x, reach)}
    return Fit(scene.with_(values), values, intervals, residuals_at(found.x), level)


def _in_si(key, value):
    return quantity(value, all_keys()[key].unit) if isinstance(value, str) else float(value)


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
