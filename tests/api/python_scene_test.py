"""Scenes from dicts and keywords, listing of keys, quantities with units, channels by name, reprs."""

import os
import pickle
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from python_fixture import SOURCE, main, program, tiny

import numpy as np

import cvtflow

RAMP = [[0.0, 8.0], [1e-3, 12.0]]


class Scenes(unittest.TestCase):
    def test_dicts_keywords_and_texts_give_the_same_scene(self):
        requested = tiny("load.torque=8 N*m", "chain.pins=24", "run.until=1 ms")
        for scene in [
            tiny().with_({"load": {"torque": "8 N*m"}, "chain": {"pins": 24}, "run": {"until": 1e-3}}),
            tiny().with_({"load.torque": 8, "chain.pins": np.int64(24), "run.until": np.float64(1e-3)}),
            tiny().with_(load__torque="8000 N*mm", chain__pins=24, until="1 ms"),
            tiny().with_({"load": {"torque": 8.0}}, "run.until=1 ms", chain={"pins": 24}),
            tiny().with_(torque="8 N*m", until="1 ms"),  # drive.torque has no effect while drive.mode is "speed"
        ]:
            self.assertEqual(scene, requested)

    def test_a_scene_is_made_of_a_dict_or_of_keywords(self):
        scene = cvtflow.Scene({"scene": {"name": "mine"}, "run.until": 2e-3}, load={"torque": "80 N*m"})
        self.assertEqual((scene.name, scene["run.until"], scene["load.torque"]), ("mine", 2e-3, 80.0))
        self.assertEqual(cvtflow.Scene(), cvtflow.Scene.parse(""))
        self.assertEqual(cvtflow.Scene("tiny", load__torque="8 N*m"), cvtflow.Scene.ready("tiny").with_(load__torque="8 N*m"))
        with self.assertRaisesRegex(cvtflow.SceneError, "none.toml"):
            cvtflow.Scene("none.toml")
        self.assertEqual(cvtflow.Scene(dict(tiny())), tiny())

    def test_equal_scenes_are_one_key_of_a_dict(self):
        kept = {tiny(): "first"}
        kept[tiny("load.torque=8 N*m")] = "second"
        kept[tiny()] = "third"
        self.assertEqual((len(kept), kept[tiny()]), (2, "third"))
        self.assertEqual(kept[pickle.loads(pickle.dumps(tiny()))], "third")

    def test_tables_over_time_are_lists_and_arrays(self):
        requested = tiny("load.torque=[[0, 8], [1e-3, 12]]")
        time, torque = np.transpose(RAMP)
        for table in [RAMP, np.array(RAMP), (time, torque), [["0 ms", "8 N*m"], ["1 ms", "12 N*m"]]]:
            self.assertEqual(tiny().with_(load__torque=table), requested)
        np.testing.assert_array_equal(requested["load.torque"], RAMP)
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "drive.csv").write_text("time [ms],torque [N*m]\n0,8\n1,12\n")
            csv = {"csv": folder + "/drive.csv", "value": "torque"}
            self.assertEqual(tiny().with_(load={"torque": csv}), requested)

    def test_the_urban_cycle_runs(self):
        simulation = cvtflow.Simulation(cvtflow.Scene.ready("urban_cycle"))
        simulation.advance_to(2e-3)
        self.assertAlmostEqual(simulation.channels["ratio"], 0.93, delta=0.01)
        self.assertGreater(simulation.channels["pump/power"], 50.0)

    def test_a_vehicle_follows_a_cycle(self):
        simulation = cvtflow.Simulation(cvtflow.Scene.ready("ece15").with_({"cycle.begin": "130 s", "start.settling_time": "20 ms"}))
        simulation.advance_to(2e-3)
        speed = (15 + 20 * 6 / 9) / 3.6  # from 15 to 35 km/h within 9 s from the 124th second on
        self.assertAlmostEqual(simulation.channels["vehicle/speed"], speed, delta=0.01)
        self.assertAlmostEqual(simulation.channels["vehicle/distance"], 2e-3 * speed, delta=1e-5)

    def test_a_series_of_pandas_is_a_table_over_time(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        series = pandas.Series([8.0, 12.0], index=[0.0, 1e-3])
        self.assertEqual(tiny().with_(load__torque=series), tiny("load.torque=[[0, 8], [1e-3, 12]]"))

    def test_texts_may_hold_what_toml_gives_a_meaning(self):
        for text in ['[a] "quoted"', "{b}", "back\\slash", "ünïcode \U0001f600", "two\nlines"]:
            self.assertEqual(tiny().with_(scene__description=text).description, text)

    def test_problems_are_told_in_the_words_of_python(self):
        for action, words in [
            (lambda: tiny().with_(torqe=8), r'torqe: unknown key \(did you mean "torque"'),
            (lambda: tiny().with_({"load.torqe": 8}), r'load.torqe=8: load.torqe: unknown key \(did you mean "load.torque"'),
            (lambda: tiny().with_(load__torque="8 N"), r'load.torque="8 N": load.torque: 8 N is a force, expected a torque'),
            (lambda: tiny().with_(inertia=1.0), r"inertia: .*load.inertia.*write __ for the dot"),
            (lambda: tiny().with_({"drive.mode": "torque"}).with_(torque=8), r"torque: drive.torque or load.torque\?"),
            (lambda: tiny().with_("until=1 ms"), r"until=1 ms: until: unknown key \(did you mean \"run.until\""),
        ]:
            with self.assertRaisesRegex(cvtflow.SceneError, words) as caught:
                action()
            self.assertNotIn("--set", str(caught.exception))
            self.assertEqual(caught.exception.code, "scene")
        self.assertRaises(TypeError, tiny().with_, 8)

    def test_ready_scenes_are_those_of_the_program(self):
        ready = cvtflow.ready_scenes()
        listed = program("list", "scenes").split("\n\n")[0].splitlines()[2:]  # below the heading
        self.assertEqual(list(ready), [line.split()[0] for line in listed])
        self.assertEqual(ready["tiny"], cvtflow.Scene.ready("tiny").description)
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.dict(os.environ, CVTFLOW_SCENES=folder):
            Path(folder, "mine.toml").write_text('scene.description = "of my own"')
            Path(folder, "broken.toml").write_text("[load")
            self.assertEqual(cvtflow.ready_scenes()["mine"], "of my own")
            self.assertNotIn("broken", cvtflow.ready_scenes())

    def test_keys_are_listed_with_help_unit_range_and_default(self):
        keys = cvtflow.Scene.keys()
        key = keys["load.torque"]
        self.assertEqual((key.unit, key.range, key.table), ("N*m", (-1e5, 1e5), True))
        self.assertIn("shaft 2", key.help)
        self.assertEqual(key.default, cvtflow.Scene()["load.torque"])
        self.assertEqual(keys["drive.mode"].choices, ["speed", "torque", "coupling"])
        self.assertIsNone(keys["drive.mode"].range)
        self.assertEqual(list(tiny().keys("clamping.")), [name for name in keys if name.startswith("clamping.")])
        for shown in [repr(keys), keys._repr_html_(), repr(key)]:
            self.assertIn("Torque against the travel of shaft 2", shown)
        self.assertEqual(list(tiny()), list(keys))
        for name in keys:
            tiny().value(name)
        with self.assertRaisesRegex(KeyError, "did you mean"):
            keys["load.torqe"]
        with self.assertRaisesRegex(KeyError, "did you mean"):
            tiny()["load.torqe"]

    def test_values_are_numbers_texts_and_lists(self):
        scene = tiny("run.step=auto", "load.torque=9 N*m")
        self.assertEqual((scene["run.step"], scene["torque"], scene["chain__pins"], scene["control.enabled"]), ("auto", 9.0, 24, False))

    def test_a_key_without_effect_is_noticed(self):
        self.assertEqual(cvtflow.Simulation(tiny()).notices(), [])
        self.assertEqual(cvtflow.Simulation(tiny("heat.ambient=300")).notices(), ["heat.ambient: no effect, since heat.enabled is false"])


class Units(unittest.TestCase):
    def test_quantities_have_units_everywhere(self):
        self.assertEqual(cvtflow.quantity("0.1 ms", "s"), 1e-4)
        rows = cvtflow.run(tiny(), until="0.02 ms", interval="10 us", channels=["ratio"])
        np.testing.assert_allclose(rows["time"], [0.0, 1e-5, 2e-5], atol=1e-12)
        simulation, seen = cvtflow.Simulation(tiny()), []
        simulation.on_output("1 us", lambda _: seen.append(simulation.time))
        simulation.advance_to("-297 us")
        self.assertEqual(len(seen), 3)
        simulation.set_input("load_torque", "9000 N*mm")
        self.assertEqual(simulation.input("load_torque"), 9.0)
        for name, torque in (("load.torque", 8.0), ("load__torque", 7.0), (cvtflow.Input.load_torque, 6.0)):
            simulation.set_input(name, torque)
            self.assertEqual((simulation.input(name), simulation.input(input="load_torque")), (torque, torque))
        self.assertRaisesRegex(TypeError, "an input has a name, such as .load_torque., or is an Input, not 3", simulation.input, 3)
        for action, words in [
            (lambda: simulation.advance_to("1 mm"), 'time: "1 mm" is a length, expected a time'),
            (lambda: simulation.advance_to("1"), 'time: "1" has no unit, expected a time'),
            (lambda: simulation.set_input("load_torqe", 9.0), 'there is no .load_torqe. .did you mean "load_torque"'),
            (lambda: simulation.set_input("clamping_driving", -1.0), r"outside \[0, "),
            (lambda: simulation.advance_to("-0.3 ms"), "to go back, set a state"),
            (lambda: simulation.set_input("load_torque", "9 N"), 'load_torque: "9 N" is a force, expected a torque'),
            (lambda: cvtflow.quantity("1 parsec", "m"), "unknown unit"),
        ]:
            with self.assertRaisesRegex(cvtflow.ArgumentError, words):
                action()

    def test_an_accuracy_is_no_length(self):
        scene = cvtflow.Scene.read(SOURCE + "/scenes/free_ring.toml")
        with self.assertRaisesRegex(cvtflow.ArgumentError, "accuracy: .* is a length"):
            cvtflow.tune(scene, accuracy="5 mm")


class Channels(unittest.TestCase):
    def setUp(self):
        self.simulation = cvtflow.Simulation(tiny())

    def test_scalars_are_numbers_and_others_arrays_of_their_own(self):
        channels = self.simulation.channels
        self.assertIsInstance(channels["slip"], float)
        tension = channels["links/tension"]
        np.testing.assert_array_equal(tension, self.simulation.channel("links/tension"))
        self.assertEqual(channels["links/tension[3]"], tension[3])
        before = tension.copy()
        self.simulation.advance_to("-299 us")
        channels["links/tension"]
        np.testing.assert_array_equal(tension, before)
        self.assertEqual(channels.info["shaft_1/torque"].unit, "N*m")
        self.assertEqual((channels.info["links/tension"].width, len(channels)), (24, len(list(channels))))
        self.assertIn("torque", repr(channels))

    def test_names_are_completed(self):
        channels = self.simulation.channels
        self.assertTrue({"slip", "shaft_1", "links"} <= set(dir(channels)))
        self.assertIn("torque", dir(channels.shaft_1))
        self.assertEqual(channels.shaft_1.torque, channels["shaft_1/torque"])
        self.assertIn("shaft_1/torque", channels._ipython_key_completions_())
        for action, error in [(lambda: channels["slop"], KeyError), (lambda: channels.slop, AttributeError)]:
            with self.assertRaisesRegex(error, 'unknown channel .{1,2}slop.{1,2} .did you mean "slip"'):
                action()
        with self.assertRaisesRegex(KeyError, "has 24 elements"):
            channels["links/tension[24]"]
        self.assertNotIn("slop", channels)


class Faces(unittest.TestCase):
    def test_everything_shows_what_it_holds(self):
        simulation = cvtflow.Simulation(tiny())
        simulation.advance_to("-299 us")
        for shown, parts in [
            (simulation.energy(), ["cvtflow.Energy", "residual=", "dissipated=", "reliable=True"]),
            (simulation.counters(), ["cvtflow.Counters", f"steps={simulation.counters().steps},", "transitions="]),
            (simulation.channels.info["shaft_1/torque"], ["cvtflow.Column", "name='shaft_1/torque'", "unit='N*m'", "width=1"]),
            (tiny(), ["cvtflow.Scene tiny", "24 pins", "until 0.001 s"]),
            (simulation, ["cvtflow.Simulation of tiny at -0.000299 s", "unknowns"]),
            (cvtflow.Threads.private_arena(2), ["Threads.private_arena(2)"]),
            (cvtflow.Scene.keys()["run.until"], ["cvtflow.KeyInfo run.until", "default 0.005 s, 1e-09 to 10000 s or steady; The run"]),
            (cvtflow.Scene.keys()["drive.mode"], ["default speed, one of speed, torque, coupling; Shaft 1"]),
            (simulation.state(), [f"cvtflow.State: {len(simulation.state().bytes())} bytes"]),
        ]:
            for part in parts:
                self.assertIn(part, repr(shown))


class WrongTypes(unittest.TestCase):
    def test_messages_state_what_is_taken_and_what_was_given(self):
        simulation = cvtflow.Simulation(tiny())
        for call, message in [
            (lambda: cvtflow.Scene.ready(3), r"^Scene\.ready\(name: str\) was called with \(3\)$"),
            (lambda: cvtflow.Scene.read(3.5), r"^Scene\.read\(path: str \| os\.PathLike\[str\]\) was called with \(3\.5\)$"),
            (lambda: tiny().with_detail(3), r"^Scene\.with_detail\(preset: str\).* was called with \(3\)$"),
            (lambda: tiny()[3], r"^Scene\.__getitem__\(key: str\).* was called with \(3\)$"),
            (lambda: cvtflow.Simulation(3), r"^Simulation\(scene: .*Scene.*threads: Threads = Threads.caller\(\).*\) was called with \(3\)$"),
            (lambda: simulation.set_input("load_torque", [1, 2]), r"^set_input\(.*value.*'load_torque', \[1, 2\]\)$"),
            (lambda: simulation.advance_to(None), r"^advance_to\(time: .*\(None\)$"),
            (lambda: cvtflow.State.from_bytes("x"), r"^State\.from_bytes\(bytes: bytes\).* was called with \('x'\)$"),
            (lambda: cvtflow.Recording(simulation), r"^Recording\(simulation: Simulation, path: .*os\.PathLike.*, replace: .*\) was called with"),
            (lambda: cvtflow.Record(3), r"^expected str, bytes or os.PathLike object, not int$"),
            (lambda: cvtflow.quantity("3 kN"), r"^quantity\(text: str, unit: str\).* was called with \('3 kN'\)$"),
            (lambda: cvtflow.tune(3), r"^tune\(scene: .* was called with \(3\)$"),
            (lambda: cvtflow.Threads(2), r"^Threads has no constructor: Threads\.caller\(\), Threads\.private_arena\(n\)"),
            (lambda: simulation.channels[3], r'^a channel has a name, such as "slip", and no number: 3$'),
        ]:
            with self.assertRaisesRegex(TypeError, message) as caught:
                call()
            self.assertNotRegex(str(caught.exception), " object at 0x|incompatible")


main() if __name__ == "__main__" else None
