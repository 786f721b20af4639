#!/usr/bin/python3
"""What pages of `cvtflow report` contain. Exit status 77: packages are missing.

    tests/tools/pages_test.py CVTFLOW SOURCE_DIR
"""

import functools
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import h5py
    import jinja2  # noqa: F401
    import matplotlib  # noqa: F401
    import numpy as np

    from program import Program, ran, write
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

CVTFLOW, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
folder = tempfile.TemporaryDirectory(prefix="cvtflow-pages-")
os.chdir(folder.name)
SWEEP = SOURCE + "/scenes/sweeps/slip_efficiency_results.csv"


def cvtflow(*words):
    return ran([CVTFLOW, *words])


def record(name, *words, scene="tiny"):
    """A run; of tiny a brief one."""
    brief = ["--until", "20 us", "--step", "50 ns", "--set", "start.settling_time=20 us", "--set", "start.ramp_time=10 us",
             "--set", "run.output_interval=1 us"] if scene == "tiny" else []
    done = cvtflow("run", scene, *brief, *words, "-o", name, "-q", "--force")
    assert done.returncode in (0, 6), done.stderr


@functools.lru_cache(maxsize=None)
def _page(stamp, *files):
    return cvtflow("report", *files, "-o", "page.html", "--force"), os.path.exists("page.html") and Path("page.html").read_text("utf-8")


def page(*files, expected=0):
    """The text of a page of files, each made once; or the message, of another exit status."""
    done, text = _page(tuple(os.path.exists(file) and os.path.getmtime(file) for file in files), *files)
    assert done.returncode == expected, done.stderr
    return done.stderr if expected else text


class Pages(unittest.TestCase):
    """Pages are long: messages contain what is missing, and a screen of the page."""

    has, lacks = Program.has, Program.lacks

    def matches(self, text, *expressions):
        for each in expressions:
            self.assertTrue(re.search(each, text, re.DOTALL), f"no match: {each}")


def part(text, section):
    """The section of a page."""
    begin = text.index(f'<section id="{section}"')
    return text[begin:text.index("</section>", begin)]


def numbers(text, row):
    """Numbers of the row of a table with that attribute, as the page sorts them."""
    begin = text.index(row)
    return [float(each) for each in re.findall(r'data-value="([^"]*)"', text[begin:text.index("</tr>", begin)])]


def attribute(name, **values):
    """A copy of run.h5 with other attributes."""
    shutil.copy("run.h5", name)
    with h5py.File(name, "r+") as file:
        for key, value in values.items():
            file.attrs.create(key, np.bytes_(value.encode()) if isinstance(value, str) else value)
    return name


record("run.h5", "--set", "load.torque=7 N*m")


class OneRecord(Pages):
    def test_is_one_file_that_asks_for_no_other(self):
        text = page("run.h5")
        self.assertIsNone(re.search(r'<(script|link|img|iframe)[^>]*(src|href)="(?!data:)', text))
        self.has(text, "default-src 'none'")
        self.assertLess(len(text), 5_000_000)

    def test_contains_the_licences_of_its_scripts(self):
        notice = (text := page("run.h5"))[text.rindex("<!--"):]
        for words in ("three.js authors", "Dan Vanderkam", "Permission is hereby granted", "OTHER DEALINGS IN THE"):
            self.has(notice, words)
        self.assertNotIn("--", notice[4:notice.index("-->")], "which would end a comment")
        licences = cvtflow("list", "licenses").stdout
        for library in ("three.js authors", "CLI11", "toml++", "JSON for Modern C++"):
            self.has(licences, library)

    def test_states_what_was_simulated_and_what_is_not_the_default(self):
        text = page("run.h5")
        places = [text.index(each) for each in ('class="status"', ">Key figures</h2>", ">What was simulated</h2>", ">Curves</h2>")]
        self.assertEqual(places, sorted(places))
        self.matches(text, r'data-default="load.torque"><td[^>]*>load.torque</td><td[^>]*>7 N\*m</td>')
        self.lacks(text, 'data-default="chain.pitch"')
        self.has(text, "shaft 1 drives (")

    def test_states_the_operating_point_and_means_with_the_digits_of_their_errors(self):
        text = part(page(attribute("known.h5", errors_of_means="ratio: 0.0012\ntight tension: 25\nthrust ratio: 7e-15\n")), "figures")
        self.matches(text, r'data-channel="ratio".*?>1\.\d{4}<.*?>± 0\.0012<', r'data-channel="tight_tension".*?>[\d.]+<.*?>± 0\.025<',
                     r'data-channel="thrust_ratio".*?>1\.\d{1,5}<.*?>± 0<')
        for channel in ("shaft_1/speed", "shaft_1/torque", "shaft_1/clamping", "shaft_2/clamping"):
            self.has(text, f'data-channel="{channel}"')

    def test_gives_keys_in_the_units_of_their_table(self):
        record("own.h5", "--set", "tip.angle=10 deg", "--set", "drive.speed=1800 rpm")
        self.matches(text := page("own.h5"), r'"tip.angle"><td[^>]*>tip.angle</td><td[^>]*>10 deg</td><td[^>]*>11 deg</td>')
        self.matches(text, r"<td[^>]*>drive.speed</td><td[^>]*>1800 rpm</td>")

    def test_has_the_step_that_was_taken_in_its_provenance(self):
        text = page("run.h5")
        self.has(text, '<th scope="row">step</th><td>50 ns</td>')
        self.lacks(text, "step_taken")

    def test_states_notes_with_their_figures(self):
        texts = "unsteady: change of slip 7 %\ngross_slip: slips by 4 %\n"
        text = page(attribute("noted.h5", notes="unsteady; gross_slip", note_texts=texts))
        self.has(text, "<b>unsteady</b>: change of slip 7 %")
        self.has(text, "<b>gross_slip</b>: slips by 4 %")
        text = page(attribute("old.h5", notes="gross_slip", note_texts=""))
        self.has(text, "<b>gross_slip</b>: mean slip above 3 % in a fiftieth of the run")
        record("loaded.h5", "--set", "load.torque=60 N*m", "--until", "60 us")
        with h5py.File("loaded.h5") as file:
            stated = file.attrs["note_texts"].decode().splitlines()
            self.assertEqual([line.split(": ")[0] for line in stated], file.attrs["notes"].decode().split("; "))
        self.assertTrue(stated)
        for line in stated:
            self.has(html.unescape(page("loaded.h5")), line.split(": ", 1)[1])

    def test_has_no_spectra_of_outputs_that_pins_overtake_and_of_changing_states(self):
        """Pins of tiny pass every 2.5 ms."""
        record("slow.h5", "--until", "20 ms", "--step", "200 ns", "--set", "run.output_interval=2 ms", "--set", "run.state_interval=2 ms")
        for notes, why in (("", "outputs are 2 ms apart, and pins pass at "), ("unsteady", "the run is unsteady")):
            with h5py.File("slow.h5", "r+") as file:
                file.attrs.create("notes", np.bytes_(notes.encode()))
            self.has(page("slow.h5"), "No spectra: slow.h5: " + why)

    def test_warns_of_a_record_without_its_seal(self):
        with open("run.h5", "rb") as file:
            whole = file.read()
        with open("cut.h5", "wb") as file:
            file.write(whole[:-32])
        self.has(page("cut.h5"), "has no seal")
        self.lacks(page("run.h5"), "has no seal")

    def test_states_why_it_shows_no_chain_of_a_machine_that_is_gone(self):
        done = cvtflow("report", attribute("gone.h5", parameters='[detail]\npins = "whole"\n'), "-o", "gone.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.has(done.stderr, "gone.h5: the page shows no chain: cannot read the parameters of its machine: scene:2:8: detail.pins: "
                              '"whole" is not one of halves, rigid')

    def test_contains_energies_by_kind_and_the_wear_that_was_recorded(self):
        text = page("run.h5")
        with h5py.File("run.h5") as file:
            friction = file["channels/dissipated/tip_friction"][:]
        row = re.search(r'<td class="">dissipated/tip_friction</td><td class="number" data-value="([^"]*)"', text)
        self.assertAlmostEqual(float(row[1]), friction[-1] - friction[0], delta=1e-8 * friction[-1])  # nine digits
        self.lacks(text, 'id="wear"')
        for channels, shown in (("wear/*", True), ("wear/friction_power", False)):
            record("worn.h5", "--set", "record.channels=" + channels)
            self.assertEqual("Friction energy of the tips by radius" in page("worn.h5"), shown, channels)

    def test_keeps_texts_of_a_scene_out_of_its_markup(self):
        record("evil.h5", "--set", "scene.description=</script><b>&%s $x$\\n")
        text = page("evil.h5")
        self.has(text, "&lt;/script&gt;&lt;b&gt;&amp;%s $x$")
        self.lacks(text, "</script><b>")

    def test_shows_slip_and_efficiency_in_per_cent(self):
        text = page("run.h5")
        for channel, unit in (("slip", "%"), ("friction_slip", "%"), ("loss_slip", "%"), ("efficiency", "%"), ("ratio", "")):
            self.matches(text, f'<tr data-channel="{channel}"><td class="">{channel}</td><td class="">{unit}</td>')

    def test_shows_si_units_on_request(self):
        self.matches(page("run.h5", "--si"), '<tr data-channel="slip"><td class="">slip</td><td class=""></td>')

    def test_draws_what_a_controller_holds_beside_it(self):
        record("control.h5", "--until", "0.1 ms", scene="control")
        self.has(page("control.h5"), '"targets":{"ratio":"control/target"}')
        self.has(page("run.h5"), '"targets":{}')


class Vehicle(Pages):
    def test_has_consumption_energies_and_the_largest_miss(self):
        record("car.h5", "--detail", "rigid", "--set", "cycle.begin=11 s", "--until", "0.4 s", scene="ece15")
        text = part(page("car.h5"), "vehicle")
        with h5py.File("car.h5") as file:
            gained = {name: values[-1] - values[0] for name, values in ((name, file["channels/" + name][:]) for name in
                      ("vehicle/distance", "work/drive", "vehicle/kinetic"))}
        expected = gained["work/drive"] / 3.6e6 / (gained["vehicle/distance"] / 1e5)  # kWh over 100 km
        self.has(text, f"{expected:.4g} kWh/100 km")
        kinetic = re.search(r'<td class="">kinetic</td><td class="number" data-value="([^"]*)"', text)
        self.assertAlmostEqual(float(kinetic[1]), 1e-3 * gained["vehicle/kinetic"], delta=1e-8)
        self.matches(text, r"<th scope=\"row\">largest miss</th><td>[-+0-9.e]+ km/h at ")
        self.has(text, "Speed against the cycle")
        self.lacks(page("run.h5"), 'id="vehicle"')


class SeveralRecords(Pages):
    @classmethod
    def setUpClass(cls):
        record("other.h5", "--set", "load.torque=8 N*m")
        cls.text = page("run.h5", "other.h5")

    def test_states_the_key_that_differs_and_what_all_share_once(self):
        self.matches(self.text, r'data-key="load.torque"><td[^>]*>load.torque</td><td[^>]*>7 N\*m</td><td[^>]*>8 N\*m</td>')
        self.lacks(self.text, 'data-key="chain.pitch"')
        self.has(self.text, "<title>cvtflow: tiny: load.torque 7 N*m, load.torque 8 N*m</title>")
        simulated = part(self.text, "simulated")
        self.assertEqual(simulated.count("24 pins around"), 1)
        self.has(simulated, "common to all records")
        self.lacks(simulated, 'data-default="load.torque"')

    def test_has_one_table_of_key_figures_with_differences_and_their_scatter(self):
        with h5py.File("run.h5") as a, h5py.File("other.h5") as b:
            rows = [file["channels/tight_tension"][16:] * 1e-3 for file in (a, b)]  # of 0 to 20 us the last fifth [kN]
        shown = numbers(self.text, 'data-difference="tight_tension"')
        gap = rows[1] - rows[0]
        for value, true in zip(shown, (rows[0].mean(), rows[1].mean(), gap.mean(), gap.std(ddof=1), 100.0 * gap.mean() / rows[0].mean())):
            self.assertAlmostEqual(value, true, delta=1e-6)  # nine digits, and what rounding of the outputs' times changes
        self.assertEqual(part(self.text, "figures").count("<th class=\"\">channel</th>"), 3)  # last fifth; whole time; least and largest
        self.has(self.text, "tight_tension: B - A")

    def test_has_losses_in_one_picture_and_chains_of_both(self):
        self.assertEqual(part(self.text, "losses").count("<svg"), 1)
        self.assertEqual(re.findall(r'<option value="\d">(.*?)</option>', part(self.text, "running")), ["run.h5", "other.h5"])
        self.assertEqual(self.text.count('"recorded":'), 2)

    def test_has_no_difference_between_equal_records(self):
        shutil.copy("run.h5", "copy.h5")
        text = page("run.h5", "copy.h5")
        self.has(text, "Every key of both scenes has the same value")
        self.has(text, "The same in every common row: ratio")

    def test_counts_two_levels_of_detail_as_one_difference(self):
        for level in ("full", "fine"):
            record(level + ".h5", "--detail", level)
        text = page("full.h5", "fine.h5")
        self.has(text, "<title>cvtflow: tiny: detail.level full, detail.level fine</title>")
        self.has(text, 'data-key="detail.level"')
        self.lacks(text, 'data-key="detail.joint_points"')


class Figures(Pages):
    def test_means_of_all_rows_weigh_them_by_time(self):
        with h5py.File("run.h5") as file:
            times, tension = file["channels/time"][:], file["channels/tight_tension"][:]
        mean = np.trapz(tension, times) / (times[-1] - times[0])
        row = re.search(r'<tr data-channel="tight_tension">.*?<td[^>]*data-value="([^"]*)"', page("run.h5", "--si"))
        self.assertAlmostEqual(float(row[1]) / mean, 1.0, delta=1e-8)  # it has nine digits
        self.assertGreater(abs(tension.mean() / mean - 1.0), 1e-7)


class MeasuredData(Pages):
    def test_has_deviations_from_the_curve_that_is_drawn(self):
        """Points beyond the record, 20 us, do not count."""
        write("bench.csv", "time [us],slip [%]\n0,1.5\n20,1.6\n50,9\n")
        with h5py.File("run.h5") as file:
            slip = 100.0 * file["channels/slip"][:]
        text = page("run.h5", "--with", "bench.csv")
        row = re.search(r'>run.h5</td><td class="">slip</td><td class="">%</td><td[^>]*>2</td><td[^>]*data-value="([^"]*)"', text)
        self.assertAlmostEqual(float(row[1]), 0.5 * (slip[0] - 1.5 + slip[-1] - 1.6), delta=1e-7)
        self.has(text, "slip, bench.csv")
        write("bench.csv", "time [us],oil [degC]\n0,80\n")
        self.has(page("run.h5", "--with", "bench.csv", expected=2), "--with bench.csv: no heading is a channel of run.h5: time, oil")

    def test_is_compared_with_means_over_pin_periods_of_a_long_run(self):
        """Of more than 60 of them, and of those until the run was steady."""
        done = cvtflow("run", "control", "--detail", "rigid", "--settle", "--until", "steady", "-o", "long.h5", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(cvtflow("plot", "long.h5", "slip", "-o", "slip.csv").returncode, 0)
        with open("slip.csv") as file:
            points = re.findall(r'^"slip","slip",([^,]*,[^,]*),', file.read(), re.MULTILINE)
        self.assertGreaterEqual(len(points), 60)
        write("bench.csv", f"time [ms],slip [%]\n{points[30]}\n")
        text = page("long.h5", "--with", "bench.csv")
        row = re.search(r'>long.h5</td><td class="">slip</td><td class="">%</td><td[^>]*>1</td><td[^>]*data-value="([^"]*)"', text)
        self.assertAlmostEqual(float(row[1]), 0.0, delta=1e-5)  # outputs swing by some tenths of a per cent about their means
        self.has(text, "mean of the last half, which is steady")


class Sweeps(Pages):
    def test_shows_every_case_and_counts_how_they_ended(self):
        write("cases.csv", "case,status,load_torque,slip_mean,notes\n0,ok,10,0.1,unsteady\n1,deep_tip,20,nan,unsteady gross_slip\n")
        text = page("cases.csv")
        for words in ("<b>ok</b>: 1 of 2 cases", "<b>deep_tip</b>: 1 of 2 cases", "<b>note unsteady</b>: 2 of 2 cases",
                      "<b>note gross_slip</b>: 1 of 2 cases", 'id="cases-table"', "slip_mean [%]</th>"):
            self.has(text, words)
        self.has(text, 'data-value="10">10</td><td class="number" data-value="10">')  # a slip of 0.1 is 10 %, a torque of 10 is 10

    def test_has_maps_of_cases_with_one_at_each_point(self):
        grid = "case,status,start_ratio,load_torque,slip_mean\n0,ok,1,10,0.1\n1,ok,1,20,0.2\n2,ok,2,10,0.3\n3,ok,2,20,0.4\n"
        write("grid.csv", grid)
        write("twice.csv", grid + "4,ok,2,20,0.5\n")
        words = "mean slip over load torque and start ratio"
        self.has(page("grid.csv"), words)
        self.lacks(page("twice.csv"), words)

    def test_has_a_map_for_each_value_of_a_third_key(self):
        text = page(SWEEP)
        for ratio in ("2.4", "1", "0.417"):
            self.matches(text, f"mean slip over load torque and clamping driven: start ratio {re.escape(ratio)}<")

    def test_shows_two_in_one_picture(self):
        write("a.csv", "case,status,load_torque,slip_mean\n0,ok,10,0.01\n1,ok,20,0.02\n")
        write("b.csv", "case,status,load_torque,slip_mean\n0,ok,10,0.03\n1,ok,20,0.04\n")
        text = page("a.csv", "b.csv")
        self.has(text, '"names":["a.csv","b.csv"],"of":[0,0,1,1]')
        self.assertEqual(text.count("<b>ok</b>: 2 of 2 cases"), 2)
        self.has(text, 'id="cases-table1"')
        self.has(page("a.csv", "run.h5", expected=2), "a report covers records, or sweeps")
        for name, torque in (("one", 6), ("two", 7)):
            write(f"{name}.toml", f'[sweep]\nname = "{name}"\ndescription = "Two cases."\nscene = "tiny"\n[set]\nload.torque = {torque}\n'
                                  'run.until = "20 us"\n[[axes]]\nkey = "drive.speed"\nvalues = [100, 101]\n[outputs]\nscalars = ["slip mean"]\n')
            self.assertEqual(cvtflow("batch", f"{name}.toml", "-o", name, "-q").returncode, 0)
        self.matches(page("one", "two"), r"Keys of the sweeps that differ</caption>(?s:.)*load.torque</td>\s*<td[^>]*>6 N\*m</td>\s*<td[^>]*>7 N\*m<")

    def test_has_measured_data_over_a_measured_key(self):
        write("cases.csv", "case,status,load_torque,slip_mean\n0,ok,10,0.01\n1,ok,20,0.02\n")
        write("bench.csv", "load.torque [N*m],slip_mean [%]\n10,0.9\n20,2.1\n")
        text = part(page("cases.csv", "--with", "bench.csv"), "measured")
        self.has(text, ">bench.csv</text>")
        write("bench.csv", "slip_mean [%]\n0.9\n")
        page("cases.csv", "--with", "bench.csv", expected=2)


class Errors(Pages):
    def test_name_what_is_wrong(self):
        write("other.csv", "a,b\n1,2\n")
        self.has(page("none.h5", expected=1), "none.h5: No such file or directory")
        self.has(page("other.csv", expected=1), "not a sweep's table")

    def test_name_what_to_install_where_a_library_is_missing(self):
        write("python", "#!/bin/sh\nexec /usr/bin/python3 -S \"$@\"\n")  # without the system's packages
        os.chmod("python", 0o755)
        done = subprocess.run([CVTFLOW, "report", "run.h5", "-o", "none.html"], capture_output=True, text=True,
                              env=os.environ | {"CVTFLOW_PYTHON": os.path.abspath("python")})
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"apt-get install .*python3-matplotlib.*python3-jinja2")
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertFalse(os.path.exists("none.html"))


class FromPython(Pages):
    """cvtflow.report() with the compiled module, where there is one: the same page but for what the program alone knows."""

    def test_writes_the_page_of_a_record(self):
        done = subprocess.run([sys.executable, "-c", "import cvtflow\nmade = cvtflow.report('run.h5', 'python.html', si=True)\n"
                               "assert made == open('python.html').read()\n"
                               "cvtflow.report(['run.h5', cvtflow.Record('run.h5')], with_={'time [us]': [0], 'slip [%]': [1]})"],
                              capture_output=True, text=True, env=os.environ | {"LC_ALL": "C.UTF-8"})
        if "No module named" in done.stderr:
            self.skipTest("the compiled module is not built")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open("python.html", encoding="utf-8") as file:
            text = file.read()
        pick = r'<tr data-channel="tight_tension">.*?</tr>'
        self.assertEqual(re.search(pick, text)[0], re.search(pick, page("run.h5", "--si"))[0])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
