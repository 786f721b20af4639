"""Many variants of a scene, as `cvtflow batch` and the scripts for Slurm run them."""

import os
import threading
from pathlib import Path

from ._cvtflow import SweepFile, Table


def _text(value):
    """A value of a sweep file: texts carry units, numbers are in the key's own."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return repr(float(value)) if not isinstance(value, int) else repr(value)


def _list(values):
    return "[" + ", ".join(_text(value) for value in values) + "]"


class Sweep:
    """Every combination of values of some keys of a scene, and the scalars wanted of each.

    sweep = cvtflow.Sweep("tiny", {"load.torque": ["6 N*m", "12 N*m"]}, ["slip mean", "efficiency mean"],
                          settings={"run.until": "0.2 ms"})
    sweep.run("results/loads")["slip_mean"]   # an array

    Keys whose values vary together are given as one tuple: {("clamping.driving", "clamping.driven"): [("3 kN", "2 kN"), ...]}.
    write() gives the file that `cvtflow batch` and tools/slurm/submit take; results() reads what they left, of one machine or of many.
    """

    def __init__(self, scene, axes, scalars, *, settings=None, detail=None, start=None, from_=None, name=None):
        self.scene, self.axes, self.scalars = str(scene), dict(axes), list(scalars)
        self.settings, self.detail, self.start, self.from_ = dict(settings or {}), detail, start, from_
        self.name = name

    @property
    def text(self):
        """The sweep file."""
        lines = ["[sweep]", f"scene = {_text(self.scene)}"]
        lines += [f"name = {_text(self.name)}"] if self.name else []
        lines += [f"detail = {_text(self.detail)}"] if self.detail else []
        if self.settings:
            lines += ["[set]"] + [f"{key} = {_text(value)}" for key, value in self.settings.items()]
        for keys, values in self.axes.items():
            lines += ["[[axes]]"] + self._axis(keys, list(values))
        lines += ["[outputs]", f"scalars = {_list(self.scalars)}"]
        lines += [f"from = {_text(self.from_)}"] if self.from_ else []
        lines += ["[start]", f"mode = {_text(self.start)}"] if self.start else []
        return "\n".join(lines) + "\n"

    @staticmethod
    def _axis(keys, values):
        if isinstance(keys, str):
            return [f"key = {_text(keys)}", f"values = {_list(values)}"]
        columns = zip(*values)
        rows = [f"{{key = {_text(key)}, values = {_list(column)}}}" for key, column in zip(keys, columns)]
        return ["zip = [" + ", ".join(rows) + "]"]

    def write(self, path):
        """Writes the sweep file and checks it. Raises SceneError with every problem in it."""
        Path(path).write_text(self.text, encoding="utf-8")
        return SweepFile.read(str(path))

    def run(self, folder, threads=0, progress=None):
        """Runs what is missing in the folder, on so many threads (0: all), and returns results(folder).

        progress  called as progress(SweepProgress) after each case, on a worker's thread
        Ctrl-C ends it; running cases leave checkpoints, and the next call goes on.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        sweep = self.write(folder / "sweep.toml")
        _interruptible(sweep, lambda: sweep.run(str(folder), threads, progress))
        return self.results(folder)

    @staticmethod
    def results(folder):
        """A dict of arrays (lists for texts) by column, in the order of cases, from a folder or a table."""
        path = Path(folder)
        table = Table(str(path / "cases.h5" if path.is_dir() else path))
        return {column.name: table.read(column.name) for column in table.columns()}

    @staticmethod
    def frame(folder):
        """The results as a pandas.DataFrame, with the case as index. Raises ImportError where pandas is not installed."""
        import pandas

        return pandas.DataFrame(Sweep.results(folder)).set_index("case")

    def submit(self, folder, *arguments):
        """Hands the sweep to Slurm by the installed script. Returns what it printed."""
        import subprocess

        script = os.environ.get("CVTFLOW_SLURM_SUBMIT") or _script()
        file = Path(folder).with_suffix(".toml")
        file.parent.mkdir(parents=True, exist_ok=True)
        self.write(file)
        return subprocess.run([script, str(file), str(folder), *arguments], check=True, capture_output=True, text=True).stdout


def _script():
    """tools/slurm/submit of the installation that this module is part of."""
    for parent in Path(__file__).resolve().parents:
        found = parent / "share/cvtflow/slurm/submit"
        if found.is_file():
            return str(found)
    raise FileNotFoundError("no share/cvtflow/slurm/submit above this module; set CVTFLOW_SLURM_SUBMIT")


def _interruptible(sweep, action):
    """Runs `action` on a thread of its own, so that this one can be interrupted."""
    thrown = []

    def work():
        try:
            action()
        except BaseException as error:
            thrown.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.1)
    except BaseException:
        sweep.cancel()
        thread.join()
        raise
    if thrown:
        raise thrown[0]
