"""Tuning: operating points, outputs and their errors, the rule that takes a choice."""

import json
import math
import time
import unittest
from pathlib import Path

from python_fixture import SOURCE, main, press_after, tiny
from python_frames_test import Folder

import cvtflow
from cvtflow import _tune

BRIEF = _tune.Settings(outputs=("tight_tension", "slack_tension"), settling=0.5e-3, average=0.5e-3)


class OperatingPoints(unittest.TestCase):
    def points(self, scene, unseen=0, **settings):
        """Names of the points, values by key, contents of their sweep."""
        with _tune.points_of(scene, _tune.Settings(**settings), unseen) as points:
            return points.names, {row["key"]: row["values"] for row in points._sweep["axes"][0]["zip"]}, points._sweep

    def test_of_a_scene_with_constant_inputs_are_its_start_and_two_near_it(self):
        names, values, sweep = self.points(tiny(), settling=1e-3, average=2e-3)
        self.assertEqual((names[0], len(set(names)), sweep["outputs"]["from"]), ("start", 3, "0.001 s"))
        self.assertEqual(values["run.until"], [0.003] * 3)
        start, *near = values["clamping.driving"]
        self.assertEqual(start, tiny()["clamping.driving"])
        self.assertTrue(all(0.0 < abs(force / start - 1.0) < 0.05 for force in near))
        further = self.points(tiny(), 3)[1]["clamping.driving"]
        self.assertFalse({*near} & {*further})  # --verify tries none of them again

    def test_hold_every_table_at_its_ends_and_the_others_as_they_begin(self):
        scene = tiny("load.torque=[[0, 10], [1, 14], [2, 4]]", "clamping.driven=[[0, 5000], [1, 6000]]")
        names, values, _ = self.points(scene)
        self.assertEqual(names[:4], ["start", "load.torque = 4 N*m", "load.torque = 14 N*m", "clamping.driven = 6000 N"])
        self.assertEqual(values["load.torque"][:4], [10.0, 4.0, 14.0, 10.0])
        self.assertEqual(values["clamping.driven"][:4], [5000.0, 5000.0, 5000.0, 6000.0])
        self.assertEqual(set(values["clamping.driving"][:4]), {scene["clamping.driving"]})
        self.assertEqual(len(names), 6)  # two more, between

    def test_that_are_unseen_lie_between_those_ends(self):
        scene = tiny("load.torque=[[0, 10], [1, 16], [2, 4]]")
        names, values, _ = self.points(scene, 20)
        self.assertTrue(all(4.0 < torque < 16.0 for torque in values["load.torque"]))
        self.assertGreater(max(values["load.torque"]) - min(values["load.torque"]), 6.0)  # twenty of twelve N m
        self.assertTrue(all(0.0 < abs(force / 7700.0 - 1.0) < 0.05 for force in values["clamping.driving"]))
        self.assertEqual(self.points(scene, 20)[0], names)
        self.assertNotEqual(self.points(scene.with_(run__seed=8), 20)[0], names)

    def test_are_refused_where_inputs_cannot_be_held(self):
        for setting in ("load.mode=coupling", "load.mode=speed"):
            with self.assertRaisesRegex(cvtflow.SceneError, 'tune with load.mode = "torque"'):
                self.points(tiny("load.speed=100", setting))


class Outputs(unittest.TestCase):
    def test_without_names_are_the_usual_figures_that_the_machine_has(self):
        self.assertEqual([name for name, *_ in _tune.outputs_of((), True)], ["slip", "efficiency", "tight_tension", "tips"])
        self.assertEqual([name for name, *_ in _tune.outputs_of((), False)], ["tight_tension"])
        with self.assertRaisesRegex(cvtflow.SceneError, "slip requires pulleys"):
            _tune.outputs_of(["slip"], False)

    def test_have_relative_errors_with_those_of_the_reference_and_those_of_efficiency_are_percentage_points(self):
        points = _tune.Points(tiny(), {}, [(name, 0, scale) for name, _, scale in _tune.outputs_of(
            ["slip", "efficiency", "losses", "tight_tension", "slip median"], True)])
        with points:
            errors = points.errors(([2e-5, 0.94, 0.94, 1100.0, math.nan], ""), ([1e-5, 0.95, 0.95, 1000.0, 1.0], [0.0, 0.0, 0.0, 0.05, 0.0]))
            self.assertTrue(all(math.isinf(error) for error in points.errors(([0.0] * 5, "failed"), ([1.0] * 5, [0.0] * 5))))
        for error, right in zip(errors, (0.1, 0.01, 0.2, 0.15, math.inf)):  # a slip of 1e-5 counts as 1e-4
            self.assertAlmostEqual(error, right)


class References(unittest.TestCase):
    def test_that_have_not_converged_run_again_alone_but_in_a_sweep_with_the_others(self):
        for only, again in (None, [[0, 1], [1], [1]]), ("corners", [[], [], []]):
            steps = []

            def run(choice, some=()):
                steps.append(list(some))
                return [([1.0 / len(steps) if point else 1.0], "", "") for point in some or (0, 1)]

            with _tune.Points(tiny(), {}, [("slip", "slip mean", None)], only=only) as points:
                points.run = run
                found = points.references(1e-3)
            self.assertEqual(steps, [[], *again])
            self.assertEqual(found[0][0], ([1.0], [0.0]))
            self.assertRegex(found[1][1], "^full has not converged at 0.0625 of its automatic step; twice that step has errors of 33 %")


class Rule(unittest.TestCase):
    def found(self, accuracy, **settings):
        with _tune.points_of(tiny("run.step=auto"), BRIEF._replace(accuracy=accuracy, **settings)) as points:
            return _tune.search(points, BRIEF._replace(accuracy=accuracy, **settings))

    def test_takes_the_cheapest_choice_whose_errors_times_the_margin_are_within_the_target(self):
        found = self.found(0.2)
        rows, number = found["choices"], found["chosen"]
        self.assertLessEqual(2.0 * max(rows[number]["errors"]), 0.2)
        for row in rows[:number]:
            self.assertLessEqual(row["work_per_second"], rows[number]["work_per_second"])
            self.assertTrue(not row["tried"] or 2.0 * max(row["errors"]) > 0.2, row)
            self.assertNotIn(row["standing"], ("chosen", ""))
        self.assertEqual({row["standing"] for row in rows[number + 1:]}, {"more expensive than the chosen one"})
        self.assertTrue(found["references"][0].startswith("full, leapfrog-sweep at "))
        self.assertLessEqual({"rigid", "fine", "full"}, {row["detail"] for row in rows})
        again = self.found(0.2)
        self.assertEqual((again["chosen"], [row["errors"] for row in again["choices"]]), (number, [row["errors"] for row in rows]))

    def test_measures_every_choice_and_never_takes_what_breaks_down(self):
        found = self.found(0.5, all=True, levels=("full", "fine detail.plates=lumped"), methods=("leapfrog-sweep@0.5us", "leapfrog-sweep@20us"))
        self.assertEqual([(row["detail"], row["tried"], row["step"]) for row in found["choices"]],
                         [("full", True, 0.5e-6), ("fine detail.plates=lumped", True, 0.5e-6)])
        self.assertEqual([line.partition(": ")[0] for line in found["left_out"]],
                         ["leapfrog-sweep@20us at full", "leapfrog-sweep@20us at fine detail.plates=lumped"])
        self.assertLess(max(found["choices"][0]["errors"]), max(found["choices"][1]["errors"]))
        self.assertEqual([row["front"] for row in found["choices"]], [True, False])  # the second one costs more

    def test_names_the_nearest_where_nothing_is_accurate_enough(self):
        nearest = {"detail": "fine", "method": "m", "share": 1.0, "step": 0.0, "tried": True, "errors": [0.02], "standing": "slip has an error"}
        found = {"accuracy": 0.01, "margin": 2.0, "choices": [nearest | {"errors": [0.5]}, nearest]}
        self.assertEqual(_tune.why_none(found), "no tried choice is within 1 % (with a margin of 2); nearest: fine, m, automatic step: slip has an error")


class Tuning(unittest.TestCase):
    def test_finds_a_scene_for_an_accuracy(self):
        found = cvtflow.tune("free_ring", accuracy="5 %", outputs=["tight_tension"])
        self.assertLessEqual(found.error, 0.05)
        self.assertIn(found.scene.value("run.method").strip('"'), found.choice)
        simulation = cvtflow.Simulation(found.scene.with_("run.until=0.1 ms"))
        simulation.advance_to(1e-4)
        self.assertAlmostEqual(simulation.time, 1e-4, places=12)

    def test_ends_with_the_signal_that_python_gets(self):
        scene = cvtflow.Scene.read(SOURCE + "/scenes/baseline.toml")
        begin = time.process_time()
        pressed = press_after(lambda: time.process_time() > begin + 0.3)
        with self.assertRaises(KeyboardInterrupt):
            cvtflow.tune(scene, accuracy=0.01)
        self.assertLess(time.process_time() - pressed[0], 1.0)

    def test_refuses_outputs_that_there_are_not(self):
        scene = cvtflow.Scene.read(SOURCE + "/scenes/free_ring.toml")
        self.assertRaises(cvtflow.SceneError, cvtflow.tune, scene, 0.05, ["slop"])


class VerifiedSweeps(Folder):
    def test_are_tuned_at_their_corners_and_have_the_errors_of_verified_cases(self):
        sweep = cvtflow.Sweep(tiny("run.step=auto"), {"load.torque": [6, 8, 10, 12]}, ["tight_tension mean"], settings={"until": "1 ms"},
                              from_="0.4 ms", start="settle", accuracy={"target": "20 %", "verify": 3})
        self.assertIn('[accuracy]\ntarget = "20 %"\nverify = 3\n', sweep.text)
        results = sweep.run(self.folder, progress=False)
        self.assertEqual(sum(math.isfinite(error) for error in results["error_of_tight_tension_mean"]), 3)
        self.assertLess(max(error for error in results["error_of_tight_tension_mean"] if math.isfinite(error)), 0.2)
        self.assertGreater(max(error for error in results["error_of_tight_tension_mean"] if math.isfinite(error)), 0.0)
        known = json.loads(Path(self.folder, "accuracy.json").read_text())
        self.assertEqual(results.attributes["accuracy_choice"], known["choice"])
        again = sweep.run(self.folder, progress=False)
        self.assertEqual(list(again["error_of_tight_tension_mean"]).count(0.0), 0)
        self.assertEqual(json.loads(Path(self.folder, "accuracy.json").read_text()), known)  # neither tuned nor verified anew


main() if __name__ == "__main__" else None
