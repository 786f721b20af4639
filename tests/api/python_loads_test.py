"""Wear and load cycles of a record, as the program states them."""

import json
import unittest

from python_fixture import main, program, tiny
from python_frames_test import Folder, matplotlib_only

import numpy as np

import cvtflow
from cvtflow._loads import Load
from cvtflow._numbers import cycles

WORN = "record.channels=wear/*", "run.output_interval=1 us", "wear.coefficient=1e-16"


class Wear(Folder):
    @matplotlib_only
    def test_is_drawn_over_the_radius_and_over_the_tips_of_a_link(self):
        record, _ = self.recorded(*WORN)
        figure, worn = record.plot_wear(), record.wear()
        self.assertRegex(figure._suptitle.get_text().replace("\n", " "), r"sums over [\d.e-]+ rounds of the chain; 51 outputs sum to [\d.e-]+ J "
                         r"of the [\d.e-]+ J that friction of tips dissipated")
        self.assertIn("coefficient 1e-16", figure.axes[2].get_title(loc="left"))
        for axis, name, factor in zip(figure.axes, ("energy", "pressure_speed", "sheave_depth"), (1e-3, 1e-6, 1e6)):
            self.assertEqual([rings.get_label()[:9] for rings in axis.patches], ["sheave 1-", "sheave 1+", "sheave 2-", "sheave 2+"])
            np.testing.assert_allclose([rings.get_data().values for rings in axis.patches], factor * worn[name])
        counts = [steps.get_data().values.sum() for steps in figure.axes[3].patches]
        pressed = np.isfinite(worn["tip_depth"]).reshape(-1, 4).sum(axis=0)
        np.testing.assert_array_equal(counts, pressed)  # every tip that pressed is counted once, in its group
        self.assertEqual(figure.axes[3].get_legend().get_texts()[3].get_text(), "front half, +z")

    def test_sums_are_over_whole_rounds_of_the_chain(self):
        class Run(dict):
            scene, pin_frequency = {"chain.pins": 10}, 10.0  # a round of 1 s

        first, rounds = cvtflow._wear.whole_rounds(Run(time=np.arange(0.0, 2.45, 0.1)))
        self.assertEqual(first, 4)
        self.assertAlmostEqual(rounds, 2.0)
        self.assertEqual(cvtflow._wear.whole_rounds(Run(time=np.array([0.0, 0.6]))), (0, 0.6))

    def test_is_a_depth_in_a_thousand_hours(self):
        record, _ = self.recorded(*WORN)
        worn, time = record.wear(), record["time"]
        ring = worn["radius"][1] - worn["radius"][0]
        power = record["loss/tip_friction"]
        rubbed = 0.5 * np.diff(time) @ (power[1:] + power[:-1])
        self.assertGreater(rubbed, 0.0)
        self.assertAlmostEqual(worn["energy"].sum() * ring, rubbed, delta=6e-8 * rubbed, msg="forces of tips are floats")
        volume = 1e-16 * 0.5 * np.diff(time) @ (record["wear/force_speed"][1:] + record["wear/force_speed"][:-1]) * 3.6e6 / time[-1]
        band = 2.0 * np.pi * worn["radius"] * ring / np.cos(tiny()["tip.angle"])  # of a cone
        np.testing.assert_allclose(worn["sheave_depth"] * band, volume.reshape(4, -1), rtol=1e-12)
        np.testing.assert_array_equal(worn["pressure_speed"].ravel(), record["wear/pressure_speed"].max(axis=0))
        np.testing.assert_array_equal(np.isfinite(worn["tip_depth"]), record["wear/tip_pressure"].max(axis=0) > 0.0)

    def test_of_a_crowned_end_is_slower_the_larger_its_spot(self):
        spot, crown, face = 0.7e-6, 28e-3, 15.65e-6
        depth = cvtflow._wear.worn_depth(np.array([1e-18, 0.2e-9, 2e-9, 2.1e-9]), spot, crown, face)
        self.assertAlmostEqual(depth[0], 1e-18 / spot, delta=1e-4 * depth[0])
        self.assertAlmostEqual(spot * depth[1] + np.pi * crown * depth[1]**2, 0.2e-9, delta=1e-15)
        self.assertAlmostEqual(depth[3] - depth[2], 0.1e-9 / face, delta=1e-12)  # the whole end

    @matplotlib_only
    def test_without_wear_panels_are_empty(self):
        record, _ = self.recorded(*WORN[:2], "wear.coefficient=0")
        self.assertEqual(np.nanmax(record.wear()["tip_depth"]), 0.0)
        self.assertEqual(len(record.plot_wear().axes[3].patches), 0)

    def test_requires_its_channels_and_two_rows(self):
        with self.assertRaisesRegex(ValueError, r"no channel wear/friction_power; record it with --set record.channels=wear/\*"):
            self.recorded()[0].wear()
        with self.assertRaisesRegex(ValueError, "wear requires 2 rows at least"):
            self.recorded("record.channels=wear/*", "run.output_interval=1 ms", "run.state_interval=1 ms")[0].wear()


class Rainflow(Folder):
    def there(self, *arguments):
        """The load that `cvtflow table --rainflow` writes for the record."""
        return json.loads(program("table", self.file, "--rainflow", *arguments, "--json"))["loads"][0]

    def test_is_that_of_the_program(self):
        record, _ = self.recorded("run.output_interval=200 ns")
        for name, begin, until in [("tight_tension", None, None), ("links/tension[3]", None, None), ("slip", "4.9 us", 4e-5)]:
            there = self.there(name, *(() if begin is None else ("--from", begin, "--until", str(until))))
            found = record.rainflow(name, begin, until)
            self.assertGreater(len(found), 3)
            self.assertEqual([dict(zip(found.dtype.names, each.tolist())) for each in found], there["cycles"])
            classes = np.histogram(found["range"], 16, (0.0, found["range"].max()), weights=found["count"])[0]
            self.assertEqual(classes.tolist(), [each["count"] for each in there["classes"]])

    def test_counts_the_example_of_the_standard(self):
        rows = cvtflow.run(tiny(), "20 us", channels=["slip"])
        rows["time"] = np.arange(12.0)
        rows["slip"] = np.array([-2.0, -1.0, 1.0, 1.0, -3.0, 5.0, -1.0, 3.0, np.nan, -4.0, 4.0, -2.0])  # ASTM E1049, figure 6
        found = rows.rainflow("slip")
        self.assertEqual(found["range"].tolist(), [3.0, 4.0, 4.0, 8.0, 9.0, 8.0, 6.0])
        self.assertEqual(found["count"].tolist(), [0.5, 0.5, 1.0, 0.5, 0.5, 0.5, 0.5])
        self.assertEqual(found["from_time"].tolist()[0:3], [0.0, 2.0, 6.0])
        self.assertEqual(rows.rainflow("slip", 2.0, "3 s")["range"].tolist(), [])
        self.assertEqual(len(rows.rainflow("slip", 99.0)), 0)
        rows["slip"] = np.array([0.0, 5.0, 1.0, 3.0, 1.0, 6.0, *[np.nan] * 6])  # of equal ranges the earlier one is a cycle
        self.assertEqual(rows.rainflow("slip")[["range", "from_time"]].tolist(), [(2.0, 2.0), (4.0, 1.0), (6.0, 0.0)])

    def test_histories_without_cycles_have_none(self):
        for history in ([], [3.0], [3.0] * 10):
            self.assertEqual(len(cycles(np.arange(len(history)), np.array(history))), 0)
        self.assertEqual(cycles(np.arange(3), np.array([0.0, 1.0, 2.0])).tolist(), [(2.0, 1.0, 0.5, 0.0, 2.0)])

    def test_every_stretch_between_reversals_is_counted_once(self):
        history = np.random.default_rng(7).normal(size=2000)
        found = cycles(np.arange(2000.0), history)
        turns = np.count_nonzero(np.diff(np.sign(np.diff(history)))) + 2
        self.assertEqual(2.0 * found["count"].sum(), turns - 1)  # a cycle has two of them, half a cycle one
        self.assertEqual(found["range"].max(), np.ptp(history))
        ends = history[found["to_time"].astype(int)] - history[found["from_time"].astype(int)]
        np.testing.assert_array_equal(found["range"], np.abs(ends))

    def test_classes_hold_all_cycles(self):
        load = Load("slip", "1", np.arange(9.0), np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
        classes = load.classes(3)  # borders 3, 6, 9
        self.assertEqual([each["count"] for each in classes], [0.5, 2.0, 1.5])
        self.assertEqual((classes[1]["largest"], classes[0]["mean"]), (6.0, -0.5))  # from -2 to 1
        self.assertEqual(Load("slip", "1", np.empty(0), np.empty(0)).classes(2)[1]["count"], 0.0)

    def test_takes_one_number(self):
        record, _ = self.recorded()
        with self.assertRaisesRegex(ValueError, r"links/tension: choose one number, such as links/tension\[0\]"):
            record.rainflow("links/tension")
        self.assertRaisesRegex(KeyError, 'did you mean "tight_tension"', record.rainflow, "tight_tensoin")


main() if __name__ == "__main__" else None
