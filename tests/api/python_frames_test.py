"""Records, recordings and sweeps as scientists use them: frames, states, transitions, elements, plots."""

import importlib.util
import os
import shutil
import tempfile
import unittest
from pathlib import Path

from python_fixture import BRIEF, SOURCE, main, press_after, program, tiny

import numpy as np

import cvtflow

HAS = {name: importlib.util.find_spec(name) is not None for name in ("pandas", "matplotlib", "scipy", "xarray", "h5netcdf")}
if HAS["matplotlib"]:
    import matplotlib

    matplotlib.use("Agg")

pandas_only = unittest.skipUnless(HAS["pandas"], "pandas is not installed")
scipy_only = unittest.skipUnless(HAS["scipy"], "SciPy is not installed")
matplotlib_only = unittest.skipUnless(HAS["matplotlib"], "Matplotlib is not installed")
xarray_only = unittest.skipUnless(HAS["xarray"] and HAS["h5netcdf"], "xarray or h5netcdf is not installed")

RECORDED = {}  # contents and simulation by settings
RESULTS = []


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.file = os.path.join(self.folder, "r.h5")

    def recorded(self, *settings, until="50 us"):
        """A record of tiny, made by a simulation; once for all tests."""
        if (settings, until) not in RECORDED:
            simulation = cvtflow.Simulation(tiny('start.state=""', "run.state_interval=20 us", *settings))
            with cvtflow.Recording(simulation, self.file, replace=True) as recording:
                simulation.advance_to(0.0)
                simulation.advance_to("20 us")  # where calls end does not matter
                simulation.advance_to(until)
            self.assertIsInstance(recording, cvtflow.Recording)
            RECORDED[settings, until] = Path(self.file).read_bytes(), simulation
        contents, simulation = RECORDED[settings, until]
        Path(self.file).unlink(missing_ok=True)  # HDF5 would take it for a file that is open
        Path(self.file).write_bytes(contents)
        return cvtflow.Record(self.file), simulation


class Recordings(Folder):
    def test_a_recording_equals_the_record_of_the_program(self):
        record, simulation = self.recorded()
        settings = [word for setting in [*BRIEF, "run.state_interval=20 us"] for word in ("--set", setting)]
        other = self.folder + "/program.h5"
        program("run", SOURCE + "/scenes/tiny.toml", *settings, "--settle", "--until", "50 us", "-q", "-o", other)
        there = cvtflow.Record(other)
        self.assertEqual((record.status, list(record)), ("finished", list(there)))
        for name in record:
            np.testing.assert_array_equal(record[name], there[name], err_msg=name)
        np.testing.assert_array_equal(record.states.unknowns, there.states.unknowns)
        np.testing.assert_array_equal(record.transitions, there.transitions)
        for name in ("energy_error_ratio", "state_hash", "method", "step_taken"):
            self.assertEqual(record.attributes[name], there.attributes[name])
        self.assertGreater(record.attributes["wall_seconds"], 0.0)
        self.assertEqual(record.channels["slip"][-1], simulation.channels["slip"])
        self.assertEqual(record.channels.shaft_1.torque[-1], simulation.channels.shaft_1.torque)
        self.assertEqual(repr(record.channels.info["slip"]), repr(simulation.channels.info["slip"]))

    def test_outputs_between_the_ends_of_steps(self):
        """Nothing of a run depends on close outputs, and they not on where calls end; they are within an output's change of short steps'."""

        def rows(interval, ends, **more):
            simulation = cvtflow.Simulation(cvtflow.Scene({"name": "rigid", "detail.level": "rigid", "run.output_interval": interval,
                                                           "start.settling_time": "6 ms", **more}))
            with cvtflow.Recording(simulation, self.file, replace=True):
                for end in ends:
                    simulation.advance_to(end)
            record = cvtflow.Record(self.file)
            return {name: np.array(record[name]) for name in record}

        apart, close, called = rows("50 us", ["1 ms"]), rows("10 us", ["1 ms"]), rows("10 us", np.arange(1, 140) * 7.3e-6)
        short = rows("10 us", ["1 ms"], **{"run.step": "1 us"})
        np.testing.assert_allclose(close["time"], 1e-5 * np.arange(101), rtol=1e-12)
        for name, values in close.items():
            np.testing.assert_array_equal(values[::5], apart[name], err_msg=name)
            np.testing.assert_array_equal(values, called[name][:101], err_msg=name)
        for name in ("tight_tension", "slip", "shaft_2/speed", "loss/tip_friction"):
            change = np.abs(np.diff(short[name])).max()
            self.assertLess(np.abs(close[name] - short[name]).max(), 0.5 * change, name)

    def test_calls_that_end_between_outputs_add_no_rows(self):
        simulation = cvtflow.Simulation(tiny('start.state=""'))
        with cvtflow.Recording(simulation, self.file):
            for time_requested in ["3 us", "17 us", "30 us"]:
                simulation.advance_to(time_requested)
        np.testing.assert_allclose(cvtflow.Record(self.file)["time"], [0.0, 1e-5, 2e-5, 3e-5], atol=1e-12)

    def test_a_recording_that_is_interrupted_keeps_its_rows(self):
        simulation = cvtflow.Simulation(tiny())
        simulation.advance_to(0.0)
        with self.assertRaises(ZeroDivisionError):
            with cvtflow.Recording(simulation, self.file):
                simulation.advance_to("30 us")
                1 / 0
        record = cvtflow.Record(self.file)
        self.assertIn("cancelled", record.status)
        self.assertEqual(record.rows, 4)

    def test_one_recording_at_a_time_and_none_after_its_end(self):
        simulation = cvtflow.Simulation(tiny())
        recording = cvtflow.Recording(simulation, Path(self.file))
        self.assertRaises(cvtflow.StateError, cvtflow.Recording, simulation, self.folder + "/other.h5")
        simulation.advance_to("10 us")
        self.assertEqual(recording.finish().rows, 2)
        self.assertRaises(cvtflow.StateError, recording.finish)
        self.assertRaises(cvtflow.RecordError, cvtflow.Recording, simulation, self.file)
        cvtflow.Recording(simulation, self.file, replace=True).finish()
        cvtflow.Recording(simulation, self.folder + "/other.h5").finish()
        self.assertRaises(cvtflow.RecordError, cvtflow.Recording, simulation, self.folder + "/none/r.h5")


class Records(Folder):
    def test_elements_states_and_transitions_are_read(self):
        record, simulation = self.recorded()
        np.testing.assert_array_equal(record["links/tension[3]"], record["links/tension"][:, 3])
        np.testing.assert_array_equal(record.read("links/tension[3]", 2, 2), record["links/tension"][2:4, 3])
        self.assertRaises(cvtflow.ArgumentError, record.read, "ratio", 5, 2)
        self.assertEqual((record.rows, record["links/tension"].shape, record.channels.info["links/tension"].unit), (6, (6, 24), "N"))
        self.assertEqual(sorted(record), sorted(["time", *record.channels]))
        self.assertEqual(record.attributes["program_version"], cvtflow.__version__)
        states = record.states
        self.assertEqual(len(states), 3)
        np.testing.assert_allclose(states.time, [0.0, 2e-5, 4e-5], atol=1e-7)
        self.assertEqual(states.unknowns.shape, (3, simulation.size()))
        np.testing.assert_array_equal(states[-1], states.unknowns[2])
        self.assertEqual(states.phases.shape, (3, 4 * 24))
        self.assertLessEqual(set(np.unique(states.phases)), {0, 1})
        self.assertEqual(len(record.transitions), simulation.counters().transitions)
        self.assertEqual(record.transitions.dtype.names, ("time", "pin", "tip", "phase_from", "phase_to"))
        self.assertTrue((record.transitions["phase_from"] != record.transitions["phase_to"]).all())
        self.assertRaises(IndexError, lambda: states[3])
        self.assertIn("3 from 0 to", repr(states))
        for name, words in [("rato", 'did you mean "ratio"'), ("links/tension[24]", "has 24 elements"), ("ratio[0]", "has 1 elements")]:
            with self.assertRaisesRegex(KeyError, words):
                record[name]

    @pandas_only
    def test_a_record_becomes_a_frame(self):
        record, _ = self.recorded()
        frame = record.frame()
        self.assertEqual((frame.index.name, len(frame)), ("time", record.rows))
        np.testing.assert_array_equal(frame["ratio"], record["ratio"])
        self.assertNotIn("links/tension", frame)
        wide = record.frame(["slip", "links/tension", "sheaves/axial_force[2]"])
        self.assertEqual(list(wide), ["slip", *(f"links/tension[{k}]" for k in range(24)), "sheaves/axial_force[2]"])
        np.testing.assert_array_equal(wide["links/tension[5]"], record["links/tension"][:, 5])
        self.assertEqual(wide.attrs["units"]["links/tension[5]"], "N")

    @pandas_only
    def test_a_run_becomes_a_frame(self):
        rows = cvtflow.run(tiny(), "20 us", channels=["ratio", "links/tension[3]"])
        self.assertEqual(list(rows.frame(["links/tension[3]"])), ["links/tension[3]"])
        self.assertEqual(list(rows.frame("links/tension[3]")), ["links/tension[3]"])
        self.assertEqual(list(cvtflow.run(tiny(), "20 us", channels="slip")), ["time", "slip"])
        self.assertRaisesRegex(ValueError, "until: -0.001 s is before 0 s", cvtflow.run, tiny(), "-1 ms")
        self.assertEqual(rows.info["links/tension"].unit, "N")
        self.assertIn("3 rows of time, ratio", repr(rows))
        self.assertRaisesRegex(KeyError, "did you mean", cvtflow.run, tiny(), "20 us", channels=["rato"])

    @matplotlib_only
    def test_channels_are_drawn_in_one_call(self):
        record, _ = self.recorded()
        axes = record.plot("slip").axes[0]
        self.assertEqual((axes.get_ylabel(), axes.get_xlabel()), ("slip [%]", "time [ms]"))
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), 100.0 * record["slip"])
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), 1e3 * record["time"])
        both = record.plot("tight_tension", "slack_tension", "shaft_1/torque", color="black").axes
        self.assertEqual([axes.get_ylabel() for axes in both], ["force [kN]", "shaft 1/torque [N·m]"])
        self.assertEqual([len(axes.lines) for axes in both], [2, 1])
        self.assertEqual(both[0].lines[1].get_color(), "black")
        si = record.plot("tight_tension", si=True).axes[0]
        self.assertEqual((si.get_ylabel(), si.get_xlabel()), ("tight tension [N]", "time [s]"))
        np.testing.assert_array_equal(si.lines[0].get_ydata(), record["tight_tension"])
        over = record.plot("slip", x="shaft_1/speed").axes[0]
        self.assertEqual((over.get_ylabel(), over.get_xlabel()), ("slip [%]", "shaft 1/speed [rpm]"))
        np.testing.assert_allclose(over.lines[0].get_xdata(), 30.0 / np.pi * record["shaft_1/speed"])
        self.assertRaises(KeyError, record.plot, "slip", x="slp")
        self.assertIs(record.plot("links/tension[3]", ax=axes), axes.figure)
        self.assertEqual(len(axes.lines), 2)
        rows = cvtflow.run(tiny(), "20 us", channels=["ratio"])
        self.assertRaisesRegex(KeyError, 'ratoi: there are time, ratio .did you mean "ratio"', lambda: rows["ratoi"])
        self.assertEqual(rows.plot("ratio").axes[0].get_ylabel(), "ratio")

    def test_means_are_by_the_trapezoidal_rule_over_whole_pin_periods(self):
        rows = cvtflow.run(tiny(), "40 us", channels=["slip"], interval="1 us")
        rows["time"] = np.array([0.0, 1.0, 3.0, 4.0, 8.0])
        rows["slip"] = np.array([9.0, np.nan, 3.0, 4.0, 8.0])  # the time itself, where it is one
        self.assertAlmostEqual(rows.means("3 s")["slip"], 5.5)
        self.assertAlmostEqual(rows.means(1.0)["slip"], 5.5)  # the row that is not a number counts as none
        with self.assertRaisesRegex(ValueError, "fewer than two rows"):
            rows.means(7.9)
        program("run", "baseline", "--detail", "rigid", "--until", "4 ms", "-q", "-o", f"{self.folder}/b.h5")
        record = cvtflow.Record(f"{self.folder}/b.h5")
        time, speed = record["time"], record["chain_speed"]
        period = float(np.mean(cvtflow.Scene.ready("baseline")["chain.pitch"])) / speed.mean()
        window = time >= time[-1] - 2 * period - 1e-9  # of 2 ms two periods of 0.7 ms are whole
        value = record["tight_tension"][window]
        expected = float(((value[1:] + value[:-1]) / 2 @ np.diff(time[window])) / (time[window][-1] - time[window][0]))
        self.assertAlmostEqual(record.means("2 ms")["tight_tension"], expected, delta=1e-9 * expected)

    @xarray_only
    def test_records_open_with_named_times_and_units_without_this_package(self):
        import xarray

        record, _ = self.recorded()
        alone = shutil.copy(self.file, self.folder + "/alone.h5")  # HDF5 opens one file in one way
        with xarray.open_dataset(alone, engine="h5netcdf", group="channels") as there:
            self.assertEqual((there.slip.dims, there.time.attrs["units"], there.tight_tension.attrs["units"]), (("time",), "s", "N"))
            np.testing.assert_array_equal(there.time, record["time"])
            np.testing.assert_array_equal(there.slip, record["slip"])
        for group, name, axis, values in (("channels/links", "tension", "link", record["links/tension"]),
                                          ("channels/followed_pin", "position", "axis", record["followed_pin/position"]),
                                          ("states", "y", "unknown", record.states.unknowns)):
            with xarray.open_dataset(alone, engine="h5netcdf", group=group) as there:
                self.assertEqual(there[name].dims, ("time", axis))
                np.testing.assert_array_equal(there[name], values)


class Sweeps(Folder):
    def results(self, **more):
        scene = tiny("run.until=0.05 ms", "start.settling_time=0.1 ms", "start.ramp_time=0.1 ms")
        axes = {"load.torque": np.array([12.0, 6.0]), ("driving", "clamping__driven"): [("7 kN", "5 kN"), ("8 kN", "6 kN")]}
        sweep = cvtflow.Sweep(scene, axes, ["slip mean", "links/tension[0] max"], **more)
        if more:
            return sweep.run(self.folder)
        if not RESULTS:
            RESULTS.append(sweep.run(self.folder))
        return RESULTS[0]

    def test_a_scene_of_ones_own_is_swept(self):
        results = self.results(settings={"run": {"until": "0.02 ms"}, "description": "mine"})
        np.testing.assert_array_equal(results["load_torque"], [12, 12, 6, 6])
        np.testing.assert_array_equal(results["clamping_driving"], [7000, 8000] * 2)
        self.assertEqual(results.info["load_torque"].unit, "N*m")
        self.assertEqual(results.column("links/tension[0] max"), "links_tension_0_max")
        with self.assertRaisesRegex(KeyError, "did you mean"):
            results.column("slip men")
        self.assertEqual(set(os.listdir(self.folder)) >= {"sweep.toml", "sweep.scene.toml", "results.csv"}, True)
        alone = cvtflow.Sweep.results(self.folder)
        np.testing.assert_array_equal(alone["slip_mean"], results["slip_mean"])

    def test_a_scene_file_counts_from_the_working_directory(self):
        here = os.getcwd()
        try:
            os.chdir(SOURCE)
            sweep = cvtflow.Sweep("scenes/tiny.toml", {"torque": [6.0]}, ["slip mean"])
            self.assertEqual(sweep.write(self.folder + "/s.toml").cases, 1)
            sweep = cvtflow.Sweep(Path("scenes/tiny.toml"), {"torque": [6.0, 7.0]}, ["slip mean"])
            self.assertRaises(cvtflow.RecordError, sweep.write, self.folder + "/s.toml")
            self.assertEqual(sweep.write(self.folder + "/s.toml", force=True).cases, 2)
        finally:
            os.chdir(here)

    @pandas_only
    @matplotlib_only
    def test_results_become_a_frame_and_a_picture(self):
        results = self.results()
        frame = results.frame()
        self.assertEqual(frame.index.dtype, int)
        self.assertEqual((list(frame.index), frame.attrs["units"]["load_torque"]), ([0, 1, 2, 3], "N*m"))
        axes = results.plot(x="load.torque", y="slip mean", by="clamping.driving").axes[0]
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("load torque [N·m]", "mean slip [%]"))
        self.assertEqual(axes.get_title(loc="left"), "mean slip over load torque")
        self.assertEqual([list(line.get_xdata()) for line in axes.lines], [[6, 12], [6, 12], [12, 12, 6, 6]])  # the last: rings
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), 100.0 * results["slip_mean"][[2, 0]])
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()],
                         ["clamping driving 7 kN", "clamping driving 8 kN", "not steady (4)"])
        self.assertIs(results.plot(x="load.torque", y="slip mean", ax=axes), axes.figure)

    @matplotlib_only
    def test_results_have_a_line_for_each_value_of_every_other_axis(self):
        results = self.results()
        axes = results.plot(x="load.torque", y="slip mean").axes[0]
        self.assertEqual([list(line.get_xdata()) for line in axes.lines], [[6, 12], [6, 12], [12, 12, 6, 6]])  # the last: rings
        self.assertEqual(axes.get_legend().get_texts()[0].get_text(), "clamping driving 7 kN")
        axes = results.plot(x="clamping.driving", y="slip mean").axes[0]  # the driven force follows it
        self.assertEqual([list(line.get_xdata()) for line in axes.lines], [[7, 8], [7, 8], [7, 8, 7, 8]])
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["load torque 6 N·m", "load torque 12 N·m", "not steady (4)"])
        axes = results.plot(x="clamping.driving", y="slip mean", si=True).axes[0]
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("clamping driving [N]", "mean slip"))
        self.assertEqual(list(axes.lines[0].get_xdata()), [7000, 8000])
        self.assertEqual(len(results.plot(x="load.torque", y="slip mean", by=[]).axes[0].lines), 2)

    @pandas_only
    def test_results_become_a_table_over_two_axes_and_cases_are_chosen(self):
        results = self.results()
        table = results.pivot("load.torque", "clamping.driving", "slip mean")
        self.assertEqual((list(table.index), list(table.columns)), ([6, 12], [7000, 8000]))
        self.assertEqual(table.loc[12, 8000], results["slip_mean"][1])
        self.assertRaises(ValueError, results.pivot, "load.torque", "status", "slip mean")
        self.assertEqual(results.axes(), ["load_torque", "clamping_driving"])
        light = results.where(load__torque="6 N*m")
        np.testing.assert_array_equal(light["case"], [2, 3])
        np.testing.assert_array_equal(light["slip_mean"], results["slip_mean"][2:])
        self.assertEqual(len(results.where(status="ok", load__torque=12.0)["case"]), 2)
        self.assertEqual(len(results.where(load__torque=["6 N*m", 12.0])["case"]), len(results["case"]))
        with self.assertRaisesRegex(ValueError, r"no case has clamping_driving = 1.0; in N there are \d+, \d+"):
            results.where(clamping__driving=1.0)
        self.assertEqual(len(results.where(status="failed")["case"]), 0)
        self.assertEqual(results.column("torque"), "load_torque")
        with self.assertRaisesRegex(TypeError, "a column is named by a text, not by int 1"):
            results.map(1, 2, 3)
        with self.assertRaisesRegex(TypeError, r"Results\(\) takes a sweep's folder, not int"):
            cvtflow.Results(3)

    @xarray_only
    def test_results_become_an_array_with_named_axes(self):
        results = self.results()
        made = results.to_xarray()
        record, _ = self.recorded()
        rows = record.to_xarray(["slip", "links/tension"])
        self.assertEqual({name: list(values) for name, values in made.coords.items()},
                         {"load_torque": [6, 12], "clamping_driving": [7000, 8000]})
        self.assertEqual((made.slip_mean.dims, made.slip_mean.attrs["units"]), (("load_torque", "clamping_driving"), "1"))
        np.testing.assert_array_equal(made.slip_mean, [results["slip_mean"][[2, 3]], results["slip_mean"][[0, 1]]])
        self.assertEqual(made.status.values.tolist(), [["ok", "ok"]] * 2)
        self.assertEqual(made.steps.dtype, np.int64)
        self.assertEqual(rows["links/tension"].dims, ("time", "links_tension_number"))
        np.testing.assert_array_equal(rows["links/tension"], record["links/tension"])

    @scipy_only
    def test_friction_is_found_from_the_slip_that_it_makes(self):
        scene = cvtflow.Scene.ready("baseline").with_detail("rigid").with_(
            {"start.state": "", "start.settling_time": "4 ms", "start.ramp_time": "2 ms", "run.until": "1 ms"})
        load, scalar = [60.0, 100.0, 140.0], "friction_slip mean"
        key = "tip.friction_coefficient"
        truth = cvtflow.Sweep(scene.with_({key: 0.085}), {"load.torque": load}, [scalar]).run(self.folder)["friction_slip_mean"]
        found = cvtflow.fit(scene, {key: (0.06, 0.12)}, {"load.torque": load, scalar: truth}, deviations={scalar: 1e-5})
        self.assertAlmostEqual(found.values[key], 0.085, delta=1e-4)
        self.assertEqual(found.scene[key], found.values[key])
        low, high = found.confidence[key]
        self.assertTrue(low < found.values[key] < high)
        self.assertLess(np.max(np.abs(found.residuals[scalar])), 1e-2 * np.max(np.abs(truth)))
        self.assertIn("tip.friction_coefficient = 0.08", repr(found))
        noisy = cvtflow.fit(scene, {key: (0.06, 0.12)}, {"load.torque": load, scalar: truth * [1.02, 0.98, 1.02]})
        self.assertGreater(noisy.confidence[key][1] - noisy.confidence[key][0], high - low, "residuals widen it")
        with self.assertRaisesRegex(ValueError, "equal lengths"):
            cvtflow.fit(scene, {key: (0.06, 0.12)}, {"load.torque": load})
        with self.assertRaisesRegex(ValueError, "not below"):
            cvtflow.fit(scene, {key: (0.12, 0.06)}, {"load.torque": load, scalar: truth})
        for wrong in ({"level": 2.0}, {"step": float("nan")}, {"deviations": {scalar: -1.0}}, {"deviations": {"unknown": 1.0}}):
            with self.assertRaises(ValueError):
                cvtflow.fit(scene, {key: (0.06, 0.12)}, {"load.torque": load, scalar: truth}, **wrong)

    @scipy_only
    def test_measured_data_of_csv_and_mat_are_the_same_numbers_in_si(self):
        from cvtflow import _fit, _measured
        from scipy.io import savemat

        Path(self.folder, "rig.csv").write_text("load.torque [kN*m];slip mean [%];thrust_ratio mean\n0,04;0,5;1,1\n0,08;0,75;1,2\n")
        columns = {"load_torque": [0.04, 0.08], "slip_mean": [0.5, 0.75], "thrust_ratio_mean": [1.1, 1.2]}
        savemat(f"{self.folder}/rig.mat", {**columns, "units": {"load_torque": "kN*m", "slip_mean": "%"}, "note": "of a rig"})
        for name in ("rig.csv", "rig.mat"):
            points, targets = _fit._columns(_measured.Measured(f"{self.folder}/{name}"))
            self.assertEqual((list(points), list(targets)), (["load.torque"], ["slip mean", "thrust_ratio mean"]))
            np.testing.assert_allclose([points["load.torque"], *targets.values()], [[40, 80], [0.005, 0.0075], [1.1, 1.2]], rtol=1e-15)
        savemat(f"{self.folder}/uneven.mat", {"slip": [1.0, 2.0], "ratio": [1.0, 2.0, 3.0]})
        Path(self.folder, "text.mat").write_text("time,slip\n")
        for name, message in (("uneven.mat", "different lengths"), ("text.mat", "not a MAT file")):
            with self.assertRaisesRegex(ValueError, message):
                _measured.Measured(f"{self.folder}/{name}")
        with self.assertRaisesRegex(ValueError, 'no key, and no scalar such as "slip mean" .did you mean "slip"'):
            _fit._columns(_measured.Measured({"slipp mean": [1.0]}))

    def test_a_sweep_is_displayed_with_its_axes(self):
        sweep = cvtflow.Sweep("tiny", {"load.torque": [1, 2], ("clamping.driving", "clamping.driven"): [(1, 2)] * 3}, ["slip mean"])
        self.assertEqual(repr(sweep), "<cvtflow.Sweep of tiny: 6 cases over load.torque (2), clamping.driving with clamping.driven (3); "
                                      "slip mean>")

    def test_ctrl_c_ends_a_sweep_file_soon(self):
        loads, done = list(np.linspace(6, 12, 2000)), []
        sweep = cvtflow.Sweep("tiny", {"load.torque": loads}, ["slip mean"], settings={"run.until": "0.2 ms"})
        press_after(lambda: len(done) > 0 and done[-1] > 0)
        with self.assertRaises(KeyboardInterrupt):
            sweep.write(self.folder + "/long.toml").run(self.folder, 1, lambda now: done.append(now.done))
        self.assertLess(len(cvtflow.Sweep.results(self.folder)["case"]), 100)  # of 2000: a case takes 0.1 s


main() if __name__ == "__main__" else None
