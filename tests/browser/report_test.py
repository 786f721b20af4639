#!/usr/bin/python3
"""Reports in a real browser: opened from a file, clicked, scrubbed, compared with the record. Exit status 77: packages are missing.

    tests/browser/report_test.py CVTFLOW SOURCE_DIR

Needs Debian's chromium, python3-h5py, python3-matplotlib, python3-jinja2, libjs-dygraphs and libjs-three.
"""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from browser import SKIPPED, Browser, BrowserError, require

require("h5py", "python3-h5py", "numpy", "python3-numpy", "matplotlib", "python3-matplotlib", "jinja2", "python3-jinja2")
import h5py
import numpy

CVTFLOW, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
folder = tempfile.TemporaryDirectory(prefix="cvtflow-report-")
os.chdir(folder.name)


def cvtflow(*words):
    return subprocess.run([CVTFLOW, *words], check=True, capture_output=True, text=True).stdout


cvtflow("run", "tiny", "--settle", "--set", "start.settling_time=20 us", "--set", "start.ramp_time=10 us", "--until", "400 us",
        "--set", "run.output_interval=2 us", "--set", "run.state_interval=10 us", "-o", "run.h5", "-q")
made = subprocess.run([CVTFLOW, "report", "run.h5"], capture_output=True, text=True)
if "libjs-dygraphs" in made.stderr:
    print("skipped: " + made.stderr.strip())
    sys.exit(SKIPPED)
if made.returncode != 0:
    sys.exit(made.stderr)
cvtflow("report", "run.h5", "run.h5", "-o", "both.html")
cvtflow("report", os.path.join(SOURCE, "scenes/sweeps/slip_efficiency_results.csv"), "-o", "sweep.html")
cvtflow("run", "control", "--until", "0.1 ms", "-o", "control.h5", "-q")
cvtflow("report", "control.h5")


MARKUP = ["<img src=x onerror=window.ran=1>", "\"><svg onload=window.ran=1>", "'-window.ran=1-'", "javascript:window.ran=1"]


def forged_record(name, whole):
    """A copy of the record in which every text is hostile; `whole`: also the scene, without which there is no chain."""
    shutil.copy("run.h5", name)
    with h5py.File(name, "r+") as file:
        objects = []
        file.visititems(lambda path, each: objects.append(path) if isinstance(each, h5py.Dataset) else None)
        for number, path in enumerate(objects):
            spoil(file[path].attrs, number)
            group, _, base = path.rpartition("/")
            if base != "time" and not group.startswith("states"):
                file.move(path, f"{group}/{base}{MARKUP[number % len(MARKUP)]}".replace("</", "<|"))
        spoil(file.attrs, 0, () if whole else ("parameters",))


def spoil(attributes, number, kept=()):
    for k, key in enumerate(sorted(attributes)):
        if attributes[key].__class__ in (bytes, numpy.bytes_, str) and key not in (*kept, "format", "CLASS", "NAME"):
            text = (MARKUP[(number + k) % len(MARKUP)] + "</script><script>window.ran=1</script>").encode()
            attributes.create(key, numpy.bytes_(text))


for forged, whole in (("forged.h5", True), ("<img src=x onerror=window.ran=1>.h5", False)):
    forged_record(forged, whole)
    cvtflow("report", forged, "-o", "forged_whole.html" if whole else "forged.html")
cvtflow("report", "forged.h5", "<img src=x onerror=window.ran=1>.h5", "-o", "forged_both.html")
with open("forged.csv", "w", newline="") as table:
    rows = csv.writer(table)
    rows.writerow(["case", "status", "load<img src=x onerror=window.ran=1>", "slip_mean", MARKUP[0], "error"])
    for case in range(6):
        rows.writerow([case, "ok", case, case * case, MARKUP[case % len(MARKUP)], MARKUP[0]])
cvtflow("report", "forged.csv", "-o", "forged_sweep.html")


def in_percent(channel):
    """Factor from the record to the page."""
    return 100 if "slip" in channel or channel == "efficiency" else 1


def shown_factor(channel):
    """From the record to the page: per cent, rpm, kN."""
    return 30 / numpy.pi if channel.endswith("/speed") else 1e-3 if "tension" in channel or channel.endswith("/clamping") else in_percent(channel)


class Page(unittest.TestCase):
    """A page that is opened anew for each test, and must neither complain nor ask for anything."""

    page = "run.html"

    def setUp(self):
        self.browser = browser
        browser.call("Emulation.setEmulatedMedia", {"media": "", "features": []})
        browser.complaints.clear()
        browser.requests.clear()
        browser.open(self.page)
        self.value = self.browser.value

    def tearDown(self):
        self.assertEqual(self.browser.complaints, [])
        self.assertEqual(self.browser.requests, [])

    def at(self, expression):
        """Middle of an element in the window, once it is in view [px]."""
        box = self.value(f"""(() => {{ const e = {expression}; e.scrollIntoView({{block: "center"}});
            const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; }})()""")
        return box


class RunReport(Page):
    def setUp(self):
        super().setUp()
        self.record = h5py.File("run.h5")
        self.addCleanup(self.record.close)

    def test_key_figures_are_those_of_the_record(self):
        rows = self.value("""[...document.querySelectorAll("#figures tbody tr")].map((r) =>
            [r.dataset.channel, r.cells[1].textContent, ...[...r.querySelectorAll("[data-value]")].map((c) => Number(c.dataset.value))])""")
        self.assertGreater(len(rows), 4)
        for name, unit, *figures in rows:
            values = self.record["channels/" + name][:] * shown_factor(name)
            values = values[numpy.isfinite(values)]  # a share of nothing is none
            self.assertEqual(unit == "%", in_percent(name) == 100, name)
            self.assertEqual(len(figures) == 0, len(values) == 0, name)
            if not figures:
                continue
            for shown, true in zip(figures[-2:], (values.min(), values.max())):  # means: pages_test, python_results_test
                self.assertAlmostEqual(shown, true, delta=1e-8 * abs(true) + 1e-300)  # nine digits

    def open_on_a_phone(self):
        self.browser.resize(390, 844, mobile=True)
        self.addCleanup(self.browser.resize, 1200, 900)
        self.browser.open(self.page)

    def test_what_a_controller_holds_is_dashed_in_the_panel_of_the_ratio(self):
        self.browser.open("control.html")
        labels = self.value("curves.charts[0].getLabels()")
        self.assertEqual(labels[1:], ["ratio", "control/target"])
        self.assertEqual(self.value("curves.charts[0].getOption('strokePattern', 'control/target')"), [6, 4])
        self.assertIsNone(self.value("curves.charts[0].getOption('strokePattern', 'ratio')"))

    def test_every_curve_is_that_of_the_record(self):
        names = self.value("[...curves.runs[0].curves.keys()]")
        for name in ("ratio", "slip", "shaft_1/speed", "tight_tension"):
            self.assertIn(name, names)
            shown = numpy.array(self.value(f"[...curves.of(curves.runs[0], {name!r})]"))
            true = self.record["channels/" + name][:] * shown_factor(name)
            numpy.testing.assert_allclose(shown, true, rtol=1e-7)  # 24 bits

    def test_slip_and_efficiency_have_panels_of_their_own_in_per_cent(self):
        self.value("""(() => { curves.chosen = new Set(["slip", "friction_slip", "efficiency", "ratio"]); curves.draw(); })()""")
        labels = self.value("curves.charts.map((c) => c.getOption('ylabel'))")
        self.assertEqual(labels, ["slip [%]", "friction_slip [%]", "efficiency [%]", "ratio"])
        self.assertIn("slip [%]", self.value("[...document.querySelectorAll('#colour option')].map((o) => o.textContent)"))

    def test_a_click_draws_a_channel_and_the_filter_finds_it(self):
        before = self.value("document.querySelectorAll('.panel canvas').length")
        self.value("""(() => { const f = document.getElementById("filter"); f.value = "touching";
            f.dispatchEvent(new Event("input")); })()""")
        self.assertEqual(self.value("[...document.querySelectorAll('#channels label')].filter((l) => !l.hidden).length"), 1)
        self.browser.click(*self.at("document.querySelector('#channels label:not([hidden]) input')"))
        self.assertGreater(self.value("document.querySelectorAll('.panel canvas').length"), before)
        self.assertTrue(self.value("curves.chosen.has('tips/touching')"))

    def test_buttons_zoom_all_curves_together(self):
        self.browser.click(*self.at("document.querySelector('[data-zoom=\"0.5\"]')"))
        windows = self.value("curves.charts.map((c) => c.xAxisRange())")
        for window in windows:
            self.assertAlmostEqual(window[0], 0.1, delta=1e-6)  # the middle half of 0 to 0.4 ms
            self.assertAlmostEqual(window[1], 0.3, delta=1e-6)
        self.browser.click(*self.at("document.getElementById('whole')"))
        self.assertAlmostEqual(self.value("curves.charts[0].xAxisRange()[1]"), 0.4, delta=1e-6)

    def test_scrubbing_moves_the_chain_to_the_recorded_states(self):
        times = self.value("[...chain.t]")
        numpy.testing.assert_allclose(times, self.record["states/time"][:], rtol=1e-12)
        last = len(times) - 1
        self.value(f"""(() => {{ const m = document.getElementById("moment"); m.value = {last};
            m.dispatchEvent(new Event("input")); }})()""")
        self.assertEqual(self.value("document.getElementById('moment-text').textContent"), "0.4 ms")
        place = self.record["channels/followed_pin/position"][-1]
        shown = self.value("(() => { const p = chain.where[0]; return [p.x, p.y, p.z]; })()")
        numpy.testing.assert_allclose(shown, 1e3 * place, atol=0.005)  # 300 mm in 65,535 parts [mm]

    def test_what_is_said_of_a_pin_is_in_the_record(self):
        self.value("chain.show(chain.t.length - 1); chain.pick(0)")
        self.assertIn("pin 0 at 0.4 ms", self.value("document.getElementById('pin').textContent"))
        tension = 1e-3 * self.record["channels/links/tension"][:]  # the page shows kN
        shown = self.value("chain.at(chain.colours.find((c) => c.name === 'tension').values, 0, chain.t.length - 1)")
        self.assertAlmostEqual(shown, tension[-1, 0], delta=(tension.max() - tension.min()) / 65535)
        tips = 1e-3 * numpy.abs(self.record["channels/tips/axial_force"][-1])
        pins = range(self.value("chain.motion.pins"))
        force = [self.value(f"chain.at(chain.colours[0].values, {pin}, chain.t.length - 1)") for pin in pins]
        self.assertAlmostEqual(2 * sum(force), tips.sum(), delta=1e-3 * tips.sum() + 1e-4)

    def test_a_click_on_a_pin_plots_it(self):
        self.at("document.getElementById('chain')")
        place = self.value("(() => { const p = chain.screen(3); return [p.x, p.y]; })()")
        self.browser.click(*place)
        near = self.value("chain.pin")
        distance = self.value(f"(() => {{ const p = chain.screen({near}); return Math.hypot(p.x - {place[0]}, p.y - {place[1]}); }})()")
        self.assertLess(distance, 2.0)  # it, or one that hides it [px]
        self.assertIn(f"of pin {near}", self.value("document.getElementById('pin-plot').textContent"))

    def test_the_chain_is_drawn_and_runs(self):
        seen = "(() => { chain.frame(); const g = chain.renderer.getContext(), w = g.drawingBufferWidth, h = g.drawingBufferHeight;" \
               "const p = new Uint8Array(4 * w * h); g.readPixels(0, 0, w, h, g.RGBA, g.UNSIGNED_BYTE, p);" \
               "let n = 0; for (let k = 3; k < p.length; k += 4) n += p[k] === 255; return n / (w * h); })()"
        self.assertGreater(self.value(seen), 0.005)  # solid pixels
        self.value("document.getElementById('speed').value = 1000")
        self.browser.click(*self.at("document.getElementById('play')"))
        # A machine that is busy with other things may take seconds for a picture in software.
        moved = self.value("(async () => { for (let k = 0; k < 300 && chain.moment === 0; ++k)"
                           "await new Promise((done) => setTimeout(done, 100)); return chain.moment; })()")
        self.assertGreater(moved, 0.0)

    def test_the_chain_runs_where_a_picture_takes_longer_than_the_record(self):
        self.value("document.getElementById('speed').value = 1000")   # 0.4 s for the 400 us
        self.value("chain.frame = () => { const from = performance.now(); while (performance.now() - from < 450) ; }")
        self.value("chain.play(true)")
        moved = self.value("(async () => { const seen = []; for (let k = 0; k < 4; ++k) {"
                           "await new Promise((done) => setTimeout(done, 450)); seen.push(chain.moment); }"
                           "chain.play(false); return Math.max(...seen); })()")
        self.assertGreater(moved, 0.0)

    def test_keys_turn_the_chain_and_step_through_states(self):
        self.value("document.getElementById('chain').focus()")
        turn = self.value("chain.view.turn")
        self.browser.key("ArrowRight")
        self.assertAlmostEqual(self.value("chain.view.turn"), turn + 0.1)
        self.browser.key(".")
        self.assertEqual(self.value("chain.moment"), 1)
        self.browser.key("p")
        self.assertEqual(self.value("chain.pin"), 0)

    def test_what_can_be_clicked_can_be_reached_by_keys(self):
        unreachable = self.value("""[...document.querySelectorAll("button, select, input, a, canvas#chain")]
            .filter((e) => e.tabIndex < 0).length""")
        self.assertEqual(unreachable, 0)
        unnamed = self.value("""[...document.querySelectorAll("button, select, input")]
            .filter((e) => e.offsetParent && !e.textContent && !e.labels?.length).length""")
        self.assertEqual(unnamed, 0)


class Comparison(Page):
    page = "both.html"

    def test_curves_of_both_stand_in_one_panel(self):
        self.assertEqual(self.value("curves.charts[0].getLabels().length"), 3)
        self.assertIn("run.h5", self.value("document.querySelector('.dygraph-legend').textContent"))  # which is which is seen at once

    def test_the_chain_of_the_other_record_runs_where_it_is_chosen(self):
        self.value("chain.pick(1); chain.show(1); window.first = chain; 0")
        self.value("(() => { const s = document.getElementById('chain-record'); s.value = 1; s.dispatchEvent(new Event('change')); })()")
        self.assertEqual(self.value("[chain !== first, chain.moment, document.getElementById('chain-record').value]"), [True, 0, "1"])
        self.value("document.getElementById('play').click()")
        moved = self.value("(async () => { for (let k = 0; k < 300 && chain.moment === 0; ++k)"
                           "await new Promise((done) => setTimeout(done, 100)); return [chain.moment > 0, first.moment]; })()")
        self.assertEqual(moved, [True, 1])


class SweepReport(Page):
    page = "sweep.html"

    def column(self, name):
        return self.value(f"""(() => {{ const t = document.getElementById("cases-table");
            const c = [...t.tHead.rows[0].cells].findIndex((h) => h.textContent.startsWith({name!r}));
            return [...t.tBodies[0].rows].map((r) => Number(r.cells[c].dataset.value)); }})()""")

    def test_a_click_on_a_heading_sorts_the_cases(self):
        before = self.column("slip_mean")
        with open(os.path.join(SOURCE, "scenes/sweeps/slip_efficiency_results.csv"), newline="") as table:
            rows = [100 * float(row["slip_mean"]) for row in csv.DictReader(table)]
        numpy.testing.assert_allclose(before, rows, rtol=1e-15)
        heading = "[...document.querySelectorAll('#cases-table th button')].find((b) => b.textContent === 'slip_mean [%]')"
        self.browser.click(*self.at(heading))
        self.assertEqual(self.column("slip_mean"), sorted(before))
        self.browser.click(*self.at(heading))
        self.assertEqual(self.column("slip_mean"), sorted(before, reverse=True))

    def test_the_picture_shows_every_case_that_ended_well(self):
        self.assertEqual(self.value("document.querySelectorAll('#map-view .case').length"), 36)
        self.value("""(() => { const s = document.getElementById("map-y"); s.value = "efficiency";
            s.dispatchEvent(new Event("change")); })()""")
        self.assertIn("efficiency", self.value("document.getElementById('map-view').textContent"))
        self.assertEqual(self.value("document.querySelectorAll('#map-view .case').length"), 36)


class Forged(Page):
    """Pages of files in which every text is markup: it is shown as text."""

    page = "forged.html"

    def test_nothing_of_a_file_runs(self):
        act = """(() => { for (const s of document.querySelectorAll("select")) for (const o of s.options)
            { s.value = o.value; s.dispatchEvent(new Event("change")); }
            for (const b of document.querySelectorAll("th button")) b.click(); })()"""
        draw = """(() => { for (const box of document.querySelectorAll("#channels input")) curves.chosen.add(box.value);
            curves.draw(); curves.charts.forEach((c) => c.setSelection(1)); })()"""
        for page, action in (("forged", draw + "; chain.pick(0)"), ("forged_whole", draw), ("forged_both", draw), ("forged_sweep", act)):
            with self.subTest(page):  # a record, one without a scene, a comparison, a sweep
                self.browser.open(page + ".html")
                self.value(action)
                self.value("new Promise((done) => setTimeout(done, 300))")
                self.assertIsNone(self.value("window.ran"))
                self.assertEqual(self.value("document.querySelectorAll('img, [onload], [onerror], [onmouseover]').length"), 0)
                if page == "forged":
                    self.assertIn("onerror=window.ran", self.value("document.body.textContent"))  # it is there, as text

    def test_a_script_that_came_in_all_the_same_would_not_run(self):
        self.value("""document.body.insertAdjacentHTML("beforeend", "<img src=x onerror=window.ran=1>")""")
        self.value("""(() => { const s = document.createElement("script"); s.textContent = "window.ran = 2"; document.body.append(s); })()""")
        self.value("new Promise((done) => setTimeout(done, 300))")
        self.assertIsNone(self.value("window.ran"))
        self.assertGreater(len(self.browser.complaints), 0)
        self.browser.complaints.clear()


if __name__ == "__main__":
    with Browser() as browser:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
