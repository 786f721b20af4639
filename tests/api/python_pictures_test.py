"""Pictures: numbers behind them, marks of maps and orders, and the files that `cvtflow plot` makes of them."""

import importlib
import unittest
import xml.etree.ElementTree
from unittest import mock

from python_fixture import main, program, tiny
from python_frames_test import Folder, matplotlib_only

import numpy as np

import cvtflow

numbers = importlib.import_module("cvtflow._numbers")
try:
    from cvtflow import maps, plots
except ImportError:  # without Matplotlib
    plots = None


class Numbers(unittest.TestCase):
    def sine(self, frequency, count, drift=0.0):
        time = 1e-3 * np.arange(count)
        return time, 5.0 + 3.0 * np.sin(2.0 * np.pi * frequency * time) + drift * np.arange(count) / count

    def test_a_sine_peaks_at_its_frequency_with_its_amplitude(self):
        """Lines of the padded spectrum are 1/1.024 s apart for 512 values, 1/2.048 s for 777; a Hann window loses 1 % an eighth beside one."""
        for frequency, count, drift, off, loss in ((125.0, 512, 0.0, 1e-9, 1e-3), (21.0 / 1.024, 512, 300.0, 1e-9, 0.03), (123.4, 777, 0.0, 0.25, 0.03)):
            line, amplitude = numbers.spectrum(*self.sine(frequency, count, drift))
            peak = int(np.argmax(amplitude))
            self.assertAlmostEqual(line[peak], frequency, delta=off)
            self.assertAlmostEqual(amplitude[peak], 3.0, delta=loss)
            self.assertLess(amplitude[line < 10.0].max(), 0.03)  # neither mean nor drift leak there

    def test_a_last_output_at_another_distance_is_left_out(self):
        time, values = self.sine(125.0, 512)
        longer = numbers.spectrum(np.append(time, time[-1] + 1e-4), np.append(values, 1e6))
        np.testing.assert_array_equal(longer[1], numbers.spectrum(time, values)[1])

    def test_pitches_repeat_after_the_shortest_pattern_that_divides_the_chain(self):
        for pitch, links, length in (([8.0], 84, 1), ([8.0, 8.0], 84, 1), ([7.0, 9.0], 84, 2), ([7.0, 9.0] * 2, 84, 2), ([7.0, 7.0, 9.0], 84, 3),
                                     ([7.0, 9.0], 7, 7)):
            self.assertEqual(numbers.pattern_length(np.array(pitch), links), length, pitch)

    def test_means_over_pin_periods_leave_out_what_is_not_finite_and_a_period_that_is_cut(self):
        time = np.arange(0.0, 3.55, 0.1)
        values = np.where(time < 1.0 - 1e-9, 2.0, 4.0) + 0.5 * (-1.0) ** np.arange(len(time))
        values[3] = np.nan  # 2 - 0.5, of ten
        middles, means = numbers.period_means(time, values, 1.0)
        np.testing.assert_allclose(middles, [0.5, 1.5, 2.5])
        np.testing.assert_allclose(means, [(20.0 - 1.5) / 9.0, 4.0, 4.0])

    def test_thinning_keeps_minima_and_maxima(self):
        x, y = np.arange(100000.0), np.sin(np.arange(100000.0))
        y[12345], y[54321] = 7.0, -7.0
        thin_x, thin_y = numbers.thinned(x, y, 1500)
        self.assertLessEqual(len(thin_x), 3000)
        self.assertEqual((thin_x[np.argmax(thin_y)], thin_x[np.argmin(thin_y)]), (12345.0, 54321.0))
        self.assertTrue((np.diff(thin_x) > 0.0).all())


class Table:
    """Of cases, as the program sends one."""

    path, facts = "cases", {"sweep": "some"}

    def __init__(self, **columns):
        self.cells = {name: np.array(values) for name, values in columns.items()}
        self.columns = [type("Column", (), {"name": name, "unit": "N*m" if name == "load_torque" else "1", "description": ""}) for name in columns]


def grid(**more):
    """Slip 1 + load + 2 ratio over 3 x 3 cases."""
    load, ratio = (each.ravel() for each in np.meshgrid([10.0, 20.0, 30.0], [0.5, 1.0, 2.0]))
    return Table(**({"case": np.arange(9), "status": ["ok"] * 9, "load_torque": load, "start_ratio": ratio, "slip_mean": 1.0 + load + 2.0 * ratio} | more))


@matplotlib_only
class Maps(unittest.TestCase):
    def axes(self, table, y="start_ratio", value="slip_mean"):
        return cvtflow.Results(table).map("load.torque", y, value).axes[0]

    def test_a_speed_ratio_is_placed_logarithmically(self):
        for column, scale in (("start_ratio", "log"), ("ratio_mean", "log"), ("thrust_ratio_mean", "linear")):
            table = grid(**{column: grid().cells["start_ratio"]})
            axes = self.axes(table, column)
            self.assertEqual((axes.get_xscale(), axes.get_yscale()), ("linear", scale), column)
        self.assertEqual(self.axes(grid(ratio_mean=grid().cells["start_ratio"] - 0.5), "ratio_mean").get_yscale(), "linear")  # 0 has no logarithm

    def test_contours_lie_on_a_plane_also_over_results_that_form_no_grid(self):
        for shift in (0.0, 0.003):
            y = 1.0 + np.arange(9) // 3 + shift * np.arange(9)
            load = grid().cells["load_torque"]
            axes = self.axes(grid(thrust_ratio_mean=y, slip_mean=load + 5.0 * y), "thrust_ratio_mean")
            lines = [path for part in axes.collections if part.get_linewidth()[0] == 0.9 for path in part.get_paths()]
            self.assertGreater(len(lines), 3)
            for path in lines:
                along = 100.0 * (path.vertices @ [1.0, 5.0])
                self.assertLess(np.ptp(along), 1e-6 * abs(along).max())

    def test_failed_and_unsteady_cases_are_hatched_and_counted(self):
        status = ["ok"] * 9
        status[4], status[8] = "deep_tip", "not_steady"
        slip = grid().cells["slip_mean"]
        slip[4] = np.nan
        axes = self.axes(grid(status=status, slip_mean=slip))
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["failed (1)", "not steady (1)"])
        self.assertEqual(sorted(patch.get_hatch() for patch in axes.patches), ["//", "//", "xxx", "xxx"])  # a cell and its entry
        failed = next(patch for patch in axes.patches if patch.get_hatch() == "xxx")
        self.assertTrue(failed.get_path().contains_point((20.0, 1.0)))

    def test_the_torque_limit_is_a_line_that_sets_no_ends(self):
        for sign in (1.0, -1.0):
            table = grid(load_torque=sign * grid().cells["load_torque"])
            with mock.patch.object(maps, "load_limits", lambda _: sign * np.repeat([15.0, 22.0, 50.0], 3)):
                axes = self.axes(table)
            line = next(line for line in axes.lines if line.get_label() == "torque limit")
            np.testing.assert_array_equal(line.get_data(), [sign * np.array([15.0, 22.0, 50.0]), [0.5, 1.0, 2.0]])
            self.assertLess(abs(sum(axes.get_xlim()) - sign * 40.0), 2.0)
        for limits in (np.full(9, 99.0), np.arange(9.0) + 15.0, np.full(9, np.nan)):  # beyond the loads; two at one ratio; none
            with mock.patch.object(maps, "load_limits", lambda _: limits):
                self.assertNotIn("torque limit", [line.get_label() for line in self.axes(table).lines])

    def test_cases_that_also_ran_at_reference_quality_are_marked(self):
        errors = np.where(np.arange(9) == 5, 0.03, np.nan)
        marked = next(line for line in self.axes(grid(error_of_slip_mean=errors)).lines if line.get_label() == "verified")
        np.testing.assert_array_equal(marked.get_xydata(), [[30.0, 1.0]])
        axes = self.axes(grid(error_of_slip_mean=errors, settled_for=np.ones(9)))  # errors of means that are steady
        self.assertNotIn("verified", [line.get_label() for line in axes.lines])


@matplotlib_only
class Orders(unittest.TestCase):
    def test_marks_are_at_pins_between_them_and_at_each_shaft_once(self):
        found = [("pins", 1200.0, True, "#111"), ("pitch pattern", 400.0, True, "#222"), ("round of the chain", 20.0, False, ""),
                 ("shaft 1", 30.0, False, "#333")]
        marks = plots.order_marks(found, 2.5)  # rounds are too close to one another to be drawn
        self.assertEqual([name for name, *_ in marks], ["pins pass: 1200 Hz and multiples", "pitch pattern: 400 Hz and multiples", "shaft 1: 30 Hz"])
        for (_, orders, *_), expected in zip(marks, ([1.0, 2.0], [1 / 3, 2 / 3, 4 / 3, 5 / 3, 7 / 3], [0.025])):
            np.testing.assert_allclose(orders, expected)
        self.assertEqual(plots.orders_text(found), "order 1 = 1200 Hz; pitch pattern 0.333, round of the chain 0.0167, shaft 1 0.025")


@matplotlib_only
class Files(Folder):
    def drawn(self, *words, name="p.svg"):
        program("plot", *words, "--force", "-o", f"{self.folder}/{name}")
        with open(f"{self.folder}/{name}", "rb") as file:
            return file.read()

    def test_an_svg_is_well_formed_text_the_same_every_time(self):
        self.recorded(until="50 us")
        svg = self.drawn(self.file, "slip", "tight_tension", "slack_tension")
        self.assertEqual(svg, self.drawn(self.file, "slip", "tight_tension", "slack_tension", name="q.svg"))
        self.assertTrue(svg.startswith(b"<svg"))
        texts = [element.text for element in xml.etree.ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]
        for text in ("slip [%]", "force [kN]", "tight_tension", "time [ms]"):
            self.assertIn(text, texts)

    def test_what_markup_or_formulas_would_read_is_text(self):
        simulation = cvtflow.Simulation(tiny())
        simulation.advance_to(0.0)
        file = f"{self.folder}/a <b> & $c_1$ 100 %.h5"
        with cvtflow.Recording(simulation, file):
            simulation.advance_to("30 us")
        svg = self.drawn(file, file, "slip")
        texts = "".join(element.text or "" for element in xml.etree.ElementTree.fromstring(svg).iter())
        self.assertIn("a <b> & $c_1$ 100 %.h5", texts.replace("\n", ""))

    def test_a_picture_may_be_a_png(self):
        self.recorded(until="50 us")
        png = self.drawn(self.file, "slip", name="p.png")
        self.assertTrue(png.startswith(b"\x89PNG"))

    def test_losses_of_two_records_are_side_by_side(self):
        record, _ = self.recorded()
        axes = record.plot_losses(others=[record]).axes[0]
        self.assertEqual(len(axes.containers), 2)
        self.assertIn("+0 W", axes.texts[-1].get_text())
        self.assertEqual(np.abs(record.plot_differences(record, "slip").axes[0].lines[-1].get_ydata()).max(), 0.0)


main() if __name__ == "__main__" else None
