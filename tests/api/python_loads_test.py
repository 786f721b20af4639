"""Wear and load cycles of a record, as the program states them."""

import csv
import json

from python_fixture import main, program, tiny
from python_frames_test import Folder, matplotlib_only

import numpy as np

import cvtflow

WORN = "record.channels=wear/*", "run.output_interval=1 us", "wear.coefficient=1e-16"


class Wear(Folder):
    @matplotlib_only
    def test_is_drawn_as_the_program_draws_it(self):
        record, _ = self.recorded(*WORN)
        there = {}
        program("plot", self.file, "--wear", "-o", self.folder + "/w.csv")
        with open(self.folder + "/w.csv", newline="") as file:
            for row in csv.DictReader(file):
                there.setdefault(row["plot"], {}).setdefault(row["series"], []).append((float(row["x"]), float(row["y"])))
        axes = record.plot_wear()
        self.assertEqual([axis.get_title().split("\n")[0] for axis in axes.flat], list(there))
        self.assertRegex(axes[0, 0].get_title(), r"\n51 outputs sum to [\d.e-]+ J of the [\d.e-]+ J that friction of tips dissipated")
        for axis, curves in zip(axes.flat[:3], there.values()):
            drawn = {line.get_label(): np.transpose(line.get_data()) for line in axis.lines}
            self.assertEqual(list(drawn), list(curves))
            for name, points in drawn.items():
                np.testing.assert_allclose(points[np.isfinite(points[:, 1])], curves[name], rtol=1e-8)  # with 9 digits
        steps = axes[1, 1].patches[0].get_data()
        (staircase,) = there["Worn depth of the tips in 1,000 hours"].values()
        np.testing.assert_allclose(np.repeat(steps.edges, 2), [x for x, _ in staircase], rtol=1e-8)
        np.testing.assert_array_equal([0.0, *np.repeat(steps.values, 2), 0.0], [y for _, y in staircase])
        self.assertIs(record.plot_wear(ax=axes), axes)

    def test_is_a_depth_in_a_thousand_hours(self):
        record, _ = self.recorded(*WORN)
        worn, time = record.wear(), record["time"]
        ring = worn["radius"][1] - worn["radius"][0]
        power = record["loss/tip_friction"]
        rubbed = 0.5 * np.diff(time) @ (power[1:] + power[:-1])
        self.assertGreater(rubbed, 0.0)
        self.assertAlmostEqual(worn["energy"].sum() * ring, rubbed, delta=1e-9 * rubbed)
        volume = 1e-16 * 0.5 * np.diff(time) @ (record["wear/force_speed"][1:] + record["wear/force_speed"][:-1]) * 3.6e6 / time[-1]
        band = 2.0 * np.pi * worn["radius"] * ring / np.cos(tiny()["tip.angle"])  # of a cone
        np.testing.assert_allclose(worn["sheave_depth"] * band, volume.reshape(4, -1), rtol=1e-12)
        np.testing.assert_array_equal(worn["pressure_speed"].ravel(), record["wear/pressure_speed"].max(axis=0))
        np.testing.assert_array_equal(np.isfinite(worn["tip_depth"]), record["wear/tip_pressure"].max(axis=0) > 0.0)

    @matplotlib_only
    def test_without_wear_panels_are_empty(self):
        record, _ = self.recorded(*WORN[:2], "wear.coefficient=0")
        self.assertEqual(np.nanmax(record.wear()["tip_depth"]), 0.0)
        self.assertEqual(len(record.plot_wear()[1, 1].patches), 0)
        program("plot", self.file, "--wear", "-o", self.folder + "/w.csv")
        with open(self.folder + "/w.csv", newline="") as file:
            self.assertNotIn("Worn depth of the tips in 1,000 hours", [row["plot"] for row in csv.DictReader(file)])

    def test_requires_its_channels_and_two_rows(self):
        with self.assertRaisesRegex(ValueError, r"no channel wear/friction_power; record it with record.channels=wear/\*"):
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
            cycles = record.rainflow(name, begin, until)
            self.assertGreater(len(cycles), 3)
            self.assertEqual([dict(zip(cycles.dtype.names, each.tolist())) for each in cycles], there["cycles"])
            classes = np.histogram(cycles["range"], 16, (0.0, cycles["range"].max()), weights=cycles["count"])[0]
            self.assertEqual(classes.tolist(), [each["count"] for each in there["classes"]])

    def test_counts_the_example_of_the_standard(self):
        rows = cvtflow.run(tiny(), "20 us", channels=["slip"])
        rows["time"] = np.arange(12.0)
        rows["slip"] = np.array([-2.0, -1.0, 1.0, 1.0, -3.0, 5.0, -1.0, 3.0, np.nan, -4.0, 4.0, -2.0])  # ASTM E1049, figure 6
        cycles = rows.rainflow("slip")
        self.assertEqual(cycles["range"].tolist(), [3.0, 4.0, 4.0, 8.0, 9.0, 8.0, 6.0])
        self.assertEqual(cycles["count"].tolist(), [0.5, 0.5, 1.0, 0.5, 0.5, 0.5, 0.5])
        self.assertEqual(cycles["from_time"].tolist()[0:3], [0.0, 2.0, 6.0])
        self.assertEqual(rows.rainflow("slip", 2.0, "3 s")["range"].tolist(), [])
        self.assertEqual(len(rows.rainflow("slip", 99.0)), 0)
        rows["slip"] = np.array([0.0, 5.0, 1.0, 3.0, 1.0, 6.0, *[np.nan] * 6])  # of equal ranges the earlier one is a cycle
        self.assertEqual(rows.rainflow("slip")[["range", "from_time"]].tolist(), [(2.0, 2.0), (4.0, 1.0), (6.0, 0.0)])

    def test_takes_one_number(self):
        record, _ = self.recorded()
        with self.assertRaisesRegex(ValueError, r"links/tension: choose one number, such as links/tension\[0\]"):
            record.rainflow("links/tension")
        self.assertRaisesRegex(KeyError, 'did you mean "tight_tension"', record.rainflow, "tight_tensoin")


main() if __name__ == "__main__" else None
