"""Records, sweeps, display and documentation texts of the Python package."""

import contextlib
import enum
import importlib
import inspect
import io
import os
import pty
import re
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock
from pathlib import Path

from python_fixture import SOURCE, main, program, tiny
from python_frames_test import Folder

import numpy as np

import cvtflow
from cvtflow import _errors, _known

LOADS = {"load.torque": ["6 N*m", "12 N*m"], ("clamping.driving", "clamping.driven"): [("7 kN", "5 kN"), ("8 kN", "6 kN")]}
SETTLED = {"start.settling_time": "20 us", "start.ramp_time": "10 us"}
SETTINGS = {"run.until": "0.05 ms", **SETTLED}


class Quotients(Folder):
    """Means that are quotients: the efficiency of a run in which shaft 2 takes 12 N m for 15 ms, then brings 4 N m; the ratio of one in which
    shaft 1 slows down to half its speed."""

    SETTINGS = ["start.settling_time=5 ms", "start.ramp_time=2 ms", "run.output_interval=20 us", "run.state_interval=10 ms",
                "run.until=24.2 ms"]
    OF = {"efficiency": ("load.torque=[[0,12],[15e-3,12],[15.1e-3,-4]]", r"efficiency ([0-9.]+) %", 100.0, 1e-3),
          "ratio": ("drive.speed=[[0,100],[8e-3,100],[12e-3,50],[16e-3,100]]", r"speed ratio +([0-9.]+) ", 1.0, 8e-3),
          "slip": ("run.output_interval=1.1 ms", r"\n  slip +([0-9.]+) %", 100.0, 1e-5),  # outputs see pins in one place
          "loss_slip": ("run.output_interval=1.1 ms", r"creep loss +([0-9.]+) %", 100.0, 1e-5)}

    def shown(self, page, row):
        """The numbers of a row of a page, in the unit that it shows."""
        text = Path(page).read_text()
        begin = text.rindex(row)  # of a comparison that of the whole time
        return [float(number) for number in re.findall(r'data-value="([^"]*)"', text[begin:text.index("</tr>", begin)])]

    def test_are_one_in_summary_report_difference_sweep_and_python(self):
        for channel in self.OF:
            with self.subTest(channel):
                self.check(channel, *self.OF[channel])

    def check(self, channel, setting, line, factor, window):
        folder, settings = f"{self.folder}/{channel}", [*self.SETTINGS, setting]
        os.mkdir(folder)
        scene, file = cvtflow.Scene.ready("tiny").with_detail("rigid").with_("run.method=auto", *settings), folder + "/b.h5"
        words = [word for each in settings for word in ("--set", each)]
        summary = program("run", "tiny", "--detail", "rigid", "--method", "auto", *words, "-o", file)
        expected = float(re.search(line, summary).group(1)) / factor
        record = cvtflow.Record(file)
        Path(f"{folder}/other.h5").write_bytes(Path(file).read_bytes())
        for page, arguments in (("report", [file]), ("both", [file, f"{folder}/other.h5"])):
            program("report", *arguments, "-o", f"{folder}/{page}.html")
        rows = cvtflow.run(scene, channels=[channel])
        self.assertEqual(set(rows), {channel, "time"})
        results = cvtflow.Sweep(scene, {"load.inertia": [scene["load.inertia"]]}, [f"{channel} mean"]).run(folder + "/s")
        ways = {"report": self.shown(f"{folder}/report.html", f'data-channel="{channel}"')[0] / factor,
                "difference": self.shown(f"{folder}/both.html", f'data-difference="{channel}"')[0] / factor,
                "scalar of a sweep": results[f"{channel}_mean"][0], "record": record.means()[channel], "record from 0": record.means(0.0)[channel]}
        ways |= {"run()": rows.means(0.0)[channel]} if rows._sums else {}
        ways |= {"column of a sweep": results[channel][0]} if channel in results else {}
        sweep = 1.1e-3 if "slip" in channel else window  # a pin period of ten at the begin, where slip is 1.1 % below its mean
        for way, value in ways.items():
            self.assertAlmostEqual(value, expected, delta=sweep if "sweep" in way else window, msg=way)
        self.assertAlmostEqual(ways["record"], expected, delta=6e-5)  # of the same window
        for way in ("report", "difference"):
            self.assertAlmostEqual(ways[way], ways["record"], delta=1e-8, msg=way)
        instants = record["efficiency"]
        if channel == "efficiency":
            self.assertGreater(abs(np.nanmean(instants) - expected), 3e-3)
            self.assertTrue(np.isnan(instants).any(), "where shafts take nothing")
        self.assertTrue(np.all(instants[np.isfinite(instants)] >= 0.0))

    def test_is_undefined_where_shaft_2_is_at_rest(self):
        rows = cvtflow.run(tiny(), "40 us", channels=["ratio"], interval="10 us")
        turned = rows._sums["shaft_2/angle"]
        turned[:] = [1.0, 1.0, 1.0, 2.0, 3.0]
        self.assertFalse(np.isfinite(_known.quotient_of([1.0, 0.0])) or np.isfinite(_known.quotient_of([0.0, 0.0])))
        gained = rows._sums["shaft_1/angle"][-1] - rows._sums["shaft_1/angle"][0]
        self.assertAlmostEqual(rows.means(0.0)["ratio"], gained / 2.0, delta=1e-12)


class Sweeps(Folder):
    def test_columns_equal_those_of_the_program(self):
        sweep = cvtflow.Sweep("tiny", LOADS, ["slip mean", "efficiency mean"], settings=SETTINGS)
        here = sweep.run(self.folder + "/here", threads=2)
        file = self.folder + "/loads.toml"
        self.assertEqual(sweep.write(file).cases, 4)
        program("batch", file, "-q", "-o", self.folder + "/there")
        there = cvtflow.Sweep.results(self.folder + "/there")
        self.assertEqual(list(here), list(there))
        for name in set(here) - {"wall"}:  # what differs from run to run
            np.testing.assert_array_equal(here[name], there[name])
        np.testing.assert_array_equal(here["load_torque"], [6, 6, 12, 12])
        counts = {"case", "steps", "evaluations", "transitions", "truncated", "settling_evaluations"}
        self.assertLessEqual(counts, {name for name in here if np.asarray(here[name]).dtype == np.int64})
        self.assertEqual(here["load_torque"].dtype, np.float64)
        self.assertEqual(here.where(steps=int(here["steps"][0]), case=[0])["case"].tolist(), [0])
        tables = importlib.import_module("cvtflow._tables")
        self.assertEqual(tables._column("steps", np.array([1.0, np.nan])).dtype, np.float64)  # a case that did not run has none

    def test_a_finished_sweep_is_read_and_not_run_again(self):
        sweep, calls = cvtflow.Sweep("tiny", {"load.torque": [6.0, 7.0]}, ["slip mean"], settings=SETTINGS), []
        sweep.run(self.folder, 1, lambda now: calls.append(now.done))
        self.assertEqual(calls[-1], 2)
        calls.clear()
        sweep.run(self.folder, 1, lambda now: calls.append(now.done))
        self.assertNotIn(1, calls)
        self.assertRaises(cvtflow.StateError, cvtflow.Sweep("tiny", {"load.torque": [8.0]}, ["slip mean"]).run, self.folder)

    def test_axes_are_rows_of_a_file_samples_and_ranges(self):
        Path(self.folder, "points.csv").write_text("M,force [kN]\n6 N*m,5\n9 N*m,5.5\n12 N*m,6\n")
        os.chdir(self.folder)
        self.addCleanup(os.chdir, SOURCE)
        rows = {"csv": "points.csv", "columns": {"M": "load.torque", "force": "clamping.driven"}}
        sweep = cvtflow.Sweep("tiny", rows, ["slip mean"], settings=SETTINGS)
        self.assertEqual(repr(sweep), "<cvtflow.Sweep of tiny: ? cases over csv (?); slip mean>")
        results = sweep.run(self.folder + "/rows")
        np.testing.assert_array_equal(results["load_torque"], [6, 9, 12])
        np.testing.assert_array_equal(results["clamping_driven"], [5000, 5500, 6000])
        sample = {"sample": "latin-hypercube", "count": 4, "seed": np.int64(3), "keys": {"load__torque": ("6 N*m", 12)}}
        sweeps = [cvtflow.Sweep("tiny", {**sample, "seed": seed}, ["slip mean"], settings=SETTINGS) for seed in (3, 3, 4)]
        drawn = [sweep.run(f"{self.folder}/{number}")["load_torque"] for number, sweep in enumerate(sweeps)]
        np.testing.assert_array_equal(drawn[0], drawn[1])
        self.assertTrue((drawn[0] != drawn[2]).any())
        np.testing.assert_array_equal(np.sort((drawn[0] - 6) // 1.5), [0, 1, 2, 3])  # one in each quarter of the range
        torque = {"load.torque": {"from": 6, "to": "12 N*m", "count": 3}}
        force = {**sample, "keys": {"clamping.driven": {"from": "5 kN", "to": "6 kN"}}}
        sweep = cvtflow.Sweep("tiny", [torque, force], ["slip mean"])
        self.assertEqual(repr(sweep), "<cvtflow.Sweep of tiny: 12 cases over load.torque (3), sample (4); slip mean>")
        self.assertEqual(sweep.write("s.toml").cases, 12)

    def test_malformed_axes_are_named(self):
        for axes, kind, words in [
            (3, TypeError, "axes: values by key, or a list of such dicts, not 3"),
            ({"load.torque": "6 N*m"}, TypeError, "axes: load.torque takes a list of values, not '6 N.m'"),
            ({("load.torque", "chain.pins"): [(1, 2, 3)]}, ValueError, "axes: load.torque, chain.pins: each value is a tuple of 2"),
            ({"sample": "random", "count": 2, "keys": {"load.torque": 5}}, TypeError, r"axes: load.torque takes \(from, to\), not 5"),
            ({"sample": "randm", "count": 2, "keys": {"load.torque": (5, 6)}}, cvtflow.SceneError, 'did you mean "random"'),
            ({"csv": "none.csv"}, cvtflow.SceneError, "axes.csv: no file"),
            ({"load.torqe": [6.0]}, cvtflow.SceneError, r"sweep.toml:\d+:\d+: .*did you mean"),
        ]:
            with self.assertRaisesRegex(kind, words):
                cvtflow.Sweep("tiny", axes, ["slip mean"]).write(self.folder + "/s.toml")

    def test_a_case_has_a_budget(self):
        sweep = cvtflow.Sweep("tiny", {"load.torque": [6.0]}, ["slip mean"], settings=SETTINGS, budget={"steps": 10})
        self.assertEqual(sweep.run(self.folder)["status"], ["budget"])
        self.assertIn('[budget]\nwall = "10 min"\n', cvtflow.Sweep("tiny", {"load.torque": [6.0]}, ["slip mean"], budget="10 min").text)
        with self.assertRaisesRegex(cvtflow.SceneError, 'budget.stps: unknown key .did you mean "steps"'):
            cvtflow.Sweep("tiny", {"load.torque": [6.0]}, ["slip mean"], budget={"stps": 10}).write(self.folder + "/s.toml")


class Progress(Folder):
    RUN = f"""import sys, cvtflow
cvtflow.Sweep("tiny", {{"load.torque": [6.0, 7.0, 8.0]}}, ["slip mean"], settings={{"run.until": "1 ms", **{SETTLED}}}).run(sys.argv[1], 1)"""

    def test_a_terminal_has_one_line_and_a_pipe_none(self):
        done = subprocess.run([sys.executable, "-c", self.RUN, self.folder + "/pipe"], capture_output=True, text=True, check=True)
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        ours, theirs = pty.openpty()
        subprocess.run([sys.executable, "-c", self.RUN, self.folder + "/terminal"], stderr=theirs, check=True)
        os.close(theirs)
        lines = os.read(ours, 65536).decode()
        os.close(ours)
        self.assertEqual(lines.count("\n"), 1)
        self.assertEqual(lines.split("\r")[-2].rstrip(), "3 of 3 cases")  # the terminal ends a line with \r\n

    def test_a_notebook_has_one_line(self):
        notebook, cell = types.ModuleType("IPython"), io.StringIO()
        notebook.get_ipython = lambda: types.SimpleNamespace(kernel=None)
        sweep = cvtflow.Sweep("tiny", {"load.torque": [6.0, 7.0]}, ["slip mean"], settings=SETTINGS)
        with unittest.mock.patch.dict(sys.modules, {"IPython": notebook}), contextlib.redirect_stdout(cell):
            sweep.run(self.folder + "/silent", progress=False)
            self.assertEqual(cell.getvalue(), "")
            sweep.run(self.folder + "/shown")
        self.assertRegex(cell.getvalue(), r"^\r[^\n]*2 of 2 cases *\n$")
        with self.assertRaisesRegex(TypeError, "progress: True, False or a function of a SweepProgress, not 'bar'"):
            sweep.run(self.folder + "/shown", progress="bar")


class SweepFiles(Folder):
    """What write(), run() and submit() may replace."""

    def setUp(self):
        super().setUp()
        programs = Path(self.folder, "bin")
        programs.mkdir()
        for name in ("sbatch", "cvtflow"):
            Path(programs, name).write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
            Path(programs, name).chmod(0o755)
        self.enterContext(unittest.mock.patch.dict(os.environ, {"PATH": f"{programs}:{os.environ['PATH']}"}))

    def sweep(self, load=6.0, scene="tiny"):
        return cvtflow.Sweep(scene, {"load.torque": [load]}, ["slip mean"], settings=SETTINGS)

    def test_folders_whose_names_differ_behind_a_dot_have_files_of_their_own(self):
        for number, load in ((1, 6.0), (2, 7.0)):
            self.sweep(load, tiny()).submit(f"{self.folder}/study-0.{number}")
        for number, load in ((1, "6.0"), (2, "7.0")):
            self.assertIn(f"values = [{load}]", Path(self.folder, f"study-0.{number}.toml").read_text())
            self.assertTrue(Path(self.folder, f"study-0.{number}.scene.toml").exists())

    def test_a_job_keeps_the_sweep_file_that_it_reads(self):
        self.sweep(6.0).submit(self.folder + "/study")
        before = Path(self.folder, "study.toml").read_text()
        with self.assertRaisesRegex(cvtflow.RecordError, r"study.toml: already exists; write\(\) with force=True replaces it"):
            self.sweep(7.0).submit(self.folder + "/study")
        self.assertEqual(Path(self.folder, "study.toml").read_text(), before)
        self.sweep(6.0).submit(self.folder + "/study")

    def test_no_file_of_the_users_is_replaced(self):
        for name, act in (("sweep.toml", lambda sweep: sweep.run(self.folder)), ("study.toml", lambda sweep: sweep.submit(self.folder + "/study")),
                          ("s.toml", lambda sweep: sweep.write(self.folder + "/s.toml")),
                          ("s.scene.toml", lambda sweep: sweep.write(self.folder + "/s.toml"))):
            mine = Path(self.folder, name)
            mine.write_text("mine")
            self.assertRaises(cvtflow.RecordError, act, self.sweep(6.0, tiny()))
            self.assertEqual(mine.read_text(), "mine")
            self.assertFalse(mine.with_name("s.scene.toml" if name == "s.toml" else "s.toml").exists())
            mine.unlink()
        Path(self.folder, "notes").write_text("mine")
        Path(self.folder, "s.toml").symlink_to("notes")
        self.assertRaises(cvtflow.RecordError, self.sweep().write, self.folder + "/s.toml")
        self.assertEqual(Path(self.folder, "notes").read_text(), "mine")

    def test_a_sweep_that_is_refused_changes_no_file(self):
        self.sweep(6.0, tiny()).run(self.folder, 1)
        before = {file.name: file.read_bytes() for file in Path(self.folder).iterdir() if file.is_file()}
        self.assertRaises(cvtflow.StateError, self.sweep(8.0, tiny("load.torque=9 N*m")).run, self.folder)
        with self.assertRaises(cvtflow.SceneError):
            cvtflow.Sweep("tiny", {"load.torqe": [6.0]}, ["slip mean"]).write(self.folder + "/sweep.toml")
        for name, contents in before.items():
            self.assertEqual(Path(self.folder, name).read_bytes(), contents, name)

    def test_slurm_gets_an_array_of_workers_of_a_folder(self):
        told = self.sweep().submit(self.folder + "/a b", "--time=1:00", workers=3).split("\n")
        self.assertEqual(told[:-1], ["--parsable", "--array=1-3", "--requeue", "--time=1:00", "--wrap"])
        self.assertEqual(told[-1], f"exec {self.folder}/bin/cvtflow batch '{self.folder}/a b.toml' -o '{self.folder}/a b'")
        self.assertEqual(cvtflow.SweepFile.read(self.folder + "/a b.toml").cases, 1)
        with unittest.mock.patch.dict(os.environ, {"PATH": self.folder}):
            self.assertRaisesRegex(FileNotFoundError, "cvtflow: no such program", self.sweep().submit, self.folder + "/other")


class Faces(unittest.TestCase):
    def test_notebooks_see_a_table_and_a_picture(self):
        html = cvtflow.Simulation(tiny())._repr_html_()
        for part in ("<caption>tiny", "<th>time</th><td>-0.0003 s", "<svg", "<polyline"):
            self.assertIn(part, html)
        self.assertIn("[load]", tiny()._repr_html_())
        rows = cvtflow.run(tiny(), channels=["slip", "tight_tension"])
        self.assertRegex(rows._repr_html_(), r"<th>tight_tension</th><td>[0-9.]+ N</td>.*<title>slip over time</title>.*<polyline")
        results = cvtflow.Sweep(tiny(), {"load.torque": [6.0, 12.0]}, "slip mean").run(self.enterContext(tempfile.TemporaryDirectory()))
        self.assertRegex(results._repr_html_(), r"<th>load_torque</th><td>6 to 12 N\*m</td>.*<title>slip_mean over the cases</title>")

    def test_every_name_is_documented_and_has_types(self):
        package = Path(cvtflow.__file__).read_text()
        checked = re.findall(r"(\w+) as \1\b", package)
        errors = {name for name in cvtflow.__all__ if isinstance(getattr(cvtflow, name), type) and issubclass(getattr(cvtflow, name), Exception)}
        self.assertEqual(sorted(checked), sorted(set(cvtflow.__all__) - errors), "what type checkers see")
        self.assertEqual(errors, {name for name, each in vars(_errors).items() if isinstance(each, type)})
        for name in cvtflow.__all__:
            member = getattr(cvtflow, name)
            self.assertTrue(member.__doc__, name)
            self.assertFalse(name in errors and len(member.__doc__) < 10, name)
            if not inspect.isclass(member):
                self.has_types(name, member)
            elif name not in errors and not issubclass(member, (enum.Enum, tuple)):
                for key, of_class in vars(member).items():
                    function = inspect.unwrap(getattr(of_class, "fget", None) or getattr(of_class, "__func__", of_class))
                    if not key.startswith("_") and inspect.isfunction(function) and function.__name__ != "<lambda>":
                        self.assertTrue(of_class.__doc__ and len(of_class.__doc__) > 3, f"{name}.{key}")
                        self.has_types(f"{name}.{key}", function)

    def has_types(self, name, function):
        signature = inspect.signature(function)
        self.assertNotEqual(signature.return_annotation, signature.empty, name)
        for parameter in signature.parameters.values():
            self.assertTrue(parameter.name == "self" or parameter.annotation is not parameter.empty, f"{name}: {parameter.name}")


main() if __name__ == "__main__" else None
