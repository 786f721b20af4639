"""Pictures as `cvtflow plot` draws them, and what it says where it cannot."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

from program import BRIEFLY, PROGRAM, SOURCE, Program, channel, csv_of, main, read, write

TABLE = ("case,status,load_torque,start_ratio,slip_mean\n0,ok,10,1,0.1\n1,ok,20,1,0.2\n2,ok,10,2,0.3\n3,ok,20,2,0.4\n4,deep_tip,30,2,9\n")
PIN_SPEED = 2000 / 60 * 2 * np.pi * 54.44e-3 / 8.12e-3  # of baseline: speed times radius over pitch, 1404 Hz


class PlotCommand(Program):
    def make(self):
        self.record("run.h5", "--until '40 us'")

    def record(self, name, more="", status=0):
        self.cvtflow(f"run {BRIEFLY} -q -o {name} --set 'run.output_interval=1 us' {more}", status)

    def svg(self, line):
        self.cvtflow(f"plot {line} -o p.svg --force")
        return read("p.svg")

    def csv(self, line, series=None):
        """Points of a series of a picture's CSV, or of all by series."""
        self.cvtflow(f"plot {line} -o p.csv --force")
        points = {name: values for (_, name), values in csv_of("p.csv").items()}
        return points if series is None else points[series]

    def test_draws_every_kind_of_picture_of_a_record(self):
        for kind in ("", "links/tension", "shaft_1 slip", "links/tension[3]", "tight_tension --orders", "--round", "--losses"):
            self.assertEqual(self.out(f"plot run.h5 {kind} -o p.svg --force"), "p.svg\n")
            self.assertTrue(read("p.svg").startswith("<svg"), kind)

    def test_draws_pdf_and_a_channel_with_the_name_of_a_folder(self):
        os.mkdir("slip")
        for name in ("a.pdf", "b.pdf"):
            self.cvtflow(f"plot run.h5 slip -o {name}")
        self.assertTrue(Path("a.pdf").read_bytes().startswith(b"%PDF-"))
        self.assertEqual(Path("a.pdf").read_bytes(), Path("b.pdf").read_bytes())

    def test_the_csv_has_the_numbers_of_the_record(self):
        drawn = self.csv("run.h5 ratio", "ratio")
        self.assertEqual(read("p.csv").splitlines()[0], "plot,series,x,y,x axis,y axis")
        np.testing.assert_allclose(drawn[:, 0], 1e3 * channel("run.h5", "time"), atol=1e-9)
        np.testing.assert_allclose(drawn[:, 1], channel("run.h5", "ratio"), rtol=1e-8)  # nine digits

    def test_shows_units_of_engineers_or_si(self):
        speed, tension = (channel("run.h5", name)[0] for name in ("shaft_1/speed", "tight_tension"))
        shown = self.csv("run.h5 shaft_1/speed tight_tension")
        self.assertAlmostEqual(shown["shaft_1/speed"][0, 1], speed * 30 / np.pi, delta=1e-5)
        self.assertAlmostEqual(shown["tight_tension"][0, 1], 1e-3 * tension, delta=1e-8)
        self.has(read("p.csv"), "speed [rpm]", "tight tension [kN]")
        self.csv("run.h5 tips/axial_force[0]")
        self.has(read("p.csv"), "tips/axial force[0] [kN]")
        si = self.csv("run.h5 shaft_1/speed tight_tension slip --si")
        self.assertAlmostEqual(si["shaft_1/speed"][0, 1], speed, delta=1e-6)
        self.assertAlmostEqual(si["tight_tension"][0, 1], tension, delta=1e-5)
        self.assertAlmostEqual(si["tight_tension"][-1, 0], 40e-6, delta=1e-12)  # seconds
        self.has(read("p.csv"), "speed [rad/s]", "tight tension [N]", ',"time [s]","slip"\n')

    def test_orders_of_the_baseline_peak_where_pins_pass_and_at_twice_that(self):
        self.cvtflow("run baseline -q -o baseline.h5 --step auto --until '40 ms'")
        spectrum = self.csv("baseline.h5 tight_tension --orders", "tight_tension")
        self.has(read("p.csv"), "pins pass: 14", "order of the passing pins")
        for order in (1, 2):
            near = spectrum[abs(spectrum[:, 0] - order) <= 0.3]
            self.assertAlmostEqual(near[near[:, 1].argmax(), 0], order, delta=25 / PIN_SPEED)  # a line of 40 ms

    def test_orders_of_mixed_pitches_peak_where_the_pattern_repeats(self):
        self.cvtflow("""run tiny -q -o mixed.h5 --set 'chain.pitch=["6.6 mm", "9.64 mm"]' --set 'start.state=""' --method auto --step auto
                     --set 'start.settling_time=20 ms' --until '100 ms'""")
        drawn = {series.partition(":")[0]: points for series, points in self.csv("mixed.h5 tight_tension --orders").items()}
        self.assertGreater(len(drawn["pitch pattern"]), 3)
        self.assertAlmostEqual(drawn["pitch pattern"][0, 0], 0.5, delta=1e-9, msg="two links")
        self.assertEqual(len(drawn["shaft 1"]), 2, "one line")
        spectrum = drawn["tight_tension"]
        for order in (0.5, 1.5, 2.5):  # marks are where the vibrations are: beside them, at quarters, hardly any (measured: a tenth)
            at, beside = (spectrum[abs(spectrum[:, 0] - place) < 0.125, 1].max() for place in (order, order - 0.25))
            self.assertGreater(at, 4 * beside, order)

    def test_a_long_run_is_drawn_as_means_over_pin_periods(self):
        self.cvtflow("run control -o long.h5 -q --until '50 ms'")
        means, every = self.csv("long.h5 slip", "slip"), self.csv("long.h5 slip --every-output", "slip")
        self.assertEqual(len(every), 2501)
        self.assertTrue(60 < len(means) < 80, "50 ms of 0.71 ms")
        self.assertAlmostEqual(means[1, 0] - means[0, 0], 1e3 / PIN_SPEED, delta=0.01)
        self.assertEqual(len(self.csv("long.h5 loss", "loss/joint_friction")), len(means), "losses as well")
        self.assertTrue(((0.1 < means[:, 1]) & (means[:, 1] < 0.6)).all(), means)  # per cent

    def test_lengths_of_a_long_run_are_drawn_at_every_output(self):
        """The mean of a swing hides it: the strand moves by more than its means do."""
        self.cvtflow("run control --detail rigid -o long.h5 -q --until '50 ms' --set 'guide.stiffness=1 N/m' --set 'start.settling_time=5 "
                     "ms'")
        drawn, recorded = self.csv("long.h5 guide/slack_deflection slip"), 1e3 * channel("long.h5", "guide/slack_deflection")
        for extreme in (np.min, np.max):
            np.testing.assert_allclose(extreme(drawn["guide/slack_deflection"][:, 1]), extreme(recorded), rtol=1e-7)  # nine digits
        self.assertLess(len(drawn["slip"]), 80, "means over pin periods")

    def test_draws_a_channel_over_another_row_by_row(self):
        drawn = self.csv("run.h5 --x ratio slip", "slip")
        np.testing.assert_allclose(drawn, np.transpose([channel("run.h5", "ratio"), 100 * channel("run.h5", "slip")]), rtol=1e-8)
        self.has(self.svg("run.h5 --x ratio slip"), ">ratio</text>")
        write("bench.csv", "ratio,slip [%]\n1.01,1.5\n")
        self.assertEqual(self.csv("run.h5 --x ratio slip --with bench.csv", "slip, bench.csv").tolist(), [[1.01, 1.5]])

    def test_several_records_stand_in_one_picture(self):
        shutil.copy("run.h5", "other.h5")
        self.has(self.svg("run.h5 other.h5 slip"), "slip, run.h5<", "slip, other.h5<", "tiny, own detail, rk4")
        self.record("heavy.h5", "--until '40 us' --set load.torque=7")
        self.has(self.svg("run.h5 heavy.h5 slip"), ">slip, heavy.h5 (load.torque 7 N*m)<")  # the one key that differs

    def test_draws_sweeps_as_curves_and_as_maps(self):
        write("cases.csv", TABLE)
        by_column = self.svg("cases.csv --x load.torque --y slip_mean")
        self.has(by_column, ">start ratio 2<", "4 of 5 cases", ">mean slip [%]<", ">load torque [N·m]<")
        self.assertEqual(self.svg("cases.csv --x load.torque --y 'slip mean'"), by_column, "as in the sweep's file")
        self.lacks(by_column, "not steady")
        write("knee.csv", TABLE + "5,not_steady,40,1,0.9\n6,not_steady,40,2,nan\n")
        self.has(self.svg("knee.csv --x load.torque --y slip_mean"), "5 of 7 cases", ">not steady (1)<")
        self.has(self.svg("cases.csv --x load.torque --y start.ratio --colour slip_mean"),
                 ">mean slip over load torque and start ratio<", ">failed (1)<")

    def test_takes_conditions_with_units(self):
        line = f"'{SOURCE}/scenes/sweeps/slip_efficiency_results.csv' --x load_torque --y efficiency --where"
        self.csv(f"{line} 'clamping.driven=20 kN'")
        drawn = read("p.csv")
        self.csv(f"{line} clamping.driven=20000")
        self.assertEqual(read("p.csv"), drawn)
        self.err(f"plot {line} 'clamping.driven=21 kN'", 2)

    def test_draws_measured_data_as_points(self):
        write("bench.csv", "time [us],slip [%],shaft_1_speed [rpm],oil [degC]\n0,1.5,2000,80\n20,1.6,,80\n")
        drawn = self.csv("run.h5 slip shaft_1/speed --with bench.csv")
        np.testing.assert_allclose(drawn["slip, bench.csv"], [[0, 1.5], [0.02, 1.6]], atol=1e-12)  # milliseconds, as the axis
        self.assertEqual(len(drawn["shaft_1/speed, bench.csv"]), 1, "an empty cell is no point")
        write("cases.csv", TABLE)
        write("bench.csv", "load.torque [N*m];slip_mean [%]\n10;9,5\n20;21\n")
        line = "cases.csv --x load.torque --with bench.csv --y"
        self.assertEqual(self.csv(f"{line} slip_mean", "bench.csv").tolist(), [[10, 9.5], [20, 21]])
        self.err(f"plot {line} start.ratio", 2)  # it has no such column
        self.err(f"plot {line} start.ratio --colour slip_mean", 2)

    def test_losses_are_bars_of_means_and_kinds_that_are_zero_are_only_named(self):
        self.record("free.h5", "--set pulley.cylinder_damping=0")  # the cylinders do not damp
        self.assertEqual(channel("free.h5", "loss/cylinder").mean(), 0)
        text = self.svg("free.h5 --losses")
        self.has(text, ">tip friction<", "; zero: cylinder<", "Losses by kind: ")
        self.lacks(text, ">cylinder<")
        self.cvtflow("plot free.h5 --losses -o losses.csv")
        drawn = float(re.search('"tip friction",[^,]*,([^,]*)', read("losses.csv"))[1])
        np.testing.assert_allclose(drawn, channel("free.h5", "loss/tip_friction").mean(), rtol=1e-7)

    def test_curves_that_are_zero_or_lie_on_the_axis_are_named_in_the_subtitle_alone(self):
        for line, shown, hidden in (("slip control/limited", ("; zero: control/limited<",), (">control/limited<",)),
                                    ("control/limited", (">control/limited<",), ()),  # there is no other
                                    ("loss", (">loss: ", "; below 1 %: ", ">loss/inner<"), (">loss/joint_damping<",)),
                                    ("loss/inner loss/joint_damping", (">loss/joint_damping<",), ())):  # it was asked for
            text = self.svg(f"run.h5 {line}")
            self.has(text, *shown)
            self.lacks(text, *hidden)

    def test_outputs_are_means_over_their_interval_where_the_scene_asks_for_them(self):
        """Means of 1 ms beside those of outputs every 10 us of the same steps, by the trapezoidal rule; sums are those of the instant."""
        self.cvtflow("settle baseline -q --detail rigid -o settled.h5")
        for name, settings in (("means", "--set 'run.output_interval=1 ms' --set record.means=true"),
                               ("dense", "--set 'run.output_interval=10 us'")):
            self.cvtflow(f"run baseline -q --detail rigid --step '5 us' --until '4 ms' --set 'run.state_interval=1 ms' "
                         f"--set start.state=settled.h5 -o {name}.h5 {settings}")
        self.assertEqual(len(channel("means.h5", "time")), 5)
        for name in ("tight_tension", "slip", "loss/tip_friction", "shaft_2/torque", "chain_speed"):
            rows, dense = channel("means.h5", name), channel("dense.h5", name)
            stride = (len(dense) - 1) // 4
            for k in range(1, 5):
                part = dense[(k - 1) * stride:k * stride + 1]
                spread = abs(part - part[-1]).max()  # a tenth of it: a mean has 14 samples, ten per pin period, of a curve that jumps
                self.assertAlmostEqual(rows[k], 0.5 * (part[1:] + part[:-1]).mean(), delta=0.1 * spread + 1e-12 * abs(rows[k]), msg=name)
            self.assertAlmostEqual(rows[0], dense[0], delta=1e-4 * abs(dense[0]), msg="of the instant: nothing was before")
        total, dense = (channel(f"{name}.h5", "dissipated/total")[-1] for name in ("means", "dense"))
        self.assertAlmostEqual(total, dense, delta=1e-3 * dense)  # losses are sampled, at other steps
        self.has(self.svg("means.h5 slip"), "; outputs are means over their interval<")

    def test_the_target_of_a_ratio_is_drawn_in_its_panel(self):
        self.record("held.h5", "--set control.enabled=true --set control.ratio=1.1 --until '40 us'")
        for line in ("ratio", "ratio control/target"):
            self.csv(f"held.h5 {line}")
            points = csv_of("p.csv")
            self.assertEqual(len(points["ratio", "control/target"]), len(points["ratio", "ratio"]))
            self.assertEqual(points["ratio", "control/target"][-1, 1], 1.1)
            self.assertNotIn(("control/target", "control/target"), points)
        self.assertNotIn("control/target", self.csv("run.h5 ratio"), "nothing controls it")

    def test_of_a_sweep_states_its_level_and_where_a_map_is_largest(self):
        write("sweep.toml", '[sweep]\nscene = "tiny"\ndetail = "fine"\n[set]\nrun.until = "20 us"\nstart.state = ""\nstart.settling_time = '
                            '"20 us"\nstart.ramp_time = "10 us"\n[[axes]]\nkey = "load.torque"\nvalues = [6, 7]\n[[axes]]\n'
                            'key = "drive.speed"\nvalues = ["900 rpm", "1000 rpm"]\n[outputs]\nscalars = ["slip mean"]\n')
        self.batch("-q", folder="swept")
        self.has(self.svg("swept --x load.torque --y drive.speed --colour 'slip mean'"), ">sweep sweep, fine, 4 cases; ring: largest, ")
        self.cvtflow("report swept -o page.html")
        self.has(page := read("page.html"), "What was simulated", "24 pins", "common to all cases")
        self.lacks(page, "<td><code>load.torque</code></td>")

    def test_the_torque_limit_is_that_of_coulomb_on_the_driven_pulley_on_the_side_of_the_load(self):
        """2 mu S_2 r_2/cos(beta), with 9 digits; none where the clamping force follows the load."""
        radius = (24 * 8.12e-3 - 2 * 47e-3) / (2 * np.pi)  # of both pulleys at ratio 1
        for loads, clamping, sign in (("6, 30", "", 1), ("-6, -30", "", -1), ("6, 30", "clamping.safety = 1.3\n", None)):
            write("sweep.toml", f'[sweep]\nscene = "tiny"\n[set]\nrun.until = "20 us"\nstart.state = ""\nstart.settling_time = "20 us"\n'
                                f'start.ramp_time = "10 us"\n{clamping}[[axes]]\nkey = "load.torque"\nvalues = [{loads}]\n[[axes]]\n'
                                f'key = "start.ratio"\nvalues = [1, 1.2]\n[outputs]\nscalars = ["slip mean"]\n')
            self.batch("-q", folder=f"swept{sign}")
            limits = self.csv(f"swept{sign} --x load.torque --y start.ratio --colour 'slip mean'").get("torque limit")
            if sign is None:
                self.assertIsNone(limits)
                continue
            (torque, _), (other, ratio) = limits
            self.assertAlmostEqual(torque, sign * 2 * 0.09 * 5700 * radius / np.cos(np.radians(11)), delta=1e-7)
            self.assertAlmostEqual(other / torque, 1.2 / 1.1, delta=0.01)  # the sum of the radii hardly changes
            self.assertEqual(ratio, 1.2)

    def test_outputs_that_pins_overtake_are_samples_without_orders(self):
        """Pins of tiny pass every 2.5 ms."""
        self.record("slow.h5", "--until '20 ms' --step '200 ns' --set 'run.output_interval=2 ms' --set 'run.state_interval=2 ms'", (0, 6))
        self.matches(self.svg("slow.h5 slip"), "outputs are 2 ms apart, and pins pass at [0-9.]+ Hz: curves are samples")
        self.has(self.err("plot slow.h5 slip --orders", 2), "spectra require run.output_interval below ")

    def test_reads_tables_with_semicolons_and_decimal_commas(self):
        write("german.csv", "case;status;load_torque;slip_mean\n0;ok;10,5;0,001\n1;ok;20;0,002\n")
        self.csv("german.csv --x load.torque --y slip_mean")
        self.has(read("p.csv"), ",10.5,0.1,")

    def test_reports_what_is_wrong(self):
        write("cases.csv", TABLE)
        write("twice.csv", "status,load_torque,start_ratio,tip_angle,slip_mean\nok,1,1,1,1\nok,1,1,2,2\n")
        for name, text in (("grip", "time,grip\n0,1\n"), ("newton", "time [us],slip [N]\n0,1.5\n"), ("timeless", "slip [%]\n1.5\n"),
                           ("hogshead", "time [us],slip [hogshead]\n0,1.5\n")):
            write(f"{name}.csv", text)
        for line, status, text in (
                ("run.h5 slp", 2, 'slp: neither a file nor a channel of run.h5 (did you mean "slip"?)'),
                ("run.h5 links/tension[99]", 2, "elements, numbered from 0"),
                ("run.h5 shaft_1/slip", 2, "cvtflow: shaft_1/slip: run.h5 was recorded without this channel (record it with --set "
                                           "record.channels=shaft_1/slip)\n"),
                ("none.h5", 1, "none.h5: No such file or directory"),
                ("run.h5 -o p.gif", 2, "expected FILE.svg, FILE.png, FILE.pdf or FILE.csv"),
                ("run.h5 --y slip", 2, "are for sweeps"),
                ("run.h5 --x shaft_1 slip", 2, "--x shaft_1: "),
                ("run.h5 --x slip --losses", 2, "--with and --x are for curves of channels"),
                ("run.h5 ratio --with grip.csv", 2,
                 "--with grip.csv: its columns (time, grip) are none of the channels that are drawn (ratio)"),
                ("run.h5 --losses --with grip.csv", 2, ""),
                ("run.h5 slip --with newton.csv", 2, "newton.csv: slip [N]: a plain number expected (1)"),
                ("run.h5 slip --with hogshead.csv", 1, "hogshead.csv: slip [hogshead]: "),
                ("run.h5 slip --with timeless.csv", 2, "--with timeless.csv: no column 'time', only slip"),
                ("run.h5 slip --with none.csv", 1, ""),
                ("cases.csv --x load.torqe --y slip_mean", 2, 'did you mean "load_torque"?'),
                ("cases.csv --x load.torque --y status", 2, "not numbers"),
                ("cases.csv --orders", 2, "is a sweep"),
                ("cases.csv --x load.torque --y slip_mean --where start.ratio=7", 2, "no case of cases.csv is left; start_ratio is "),
                ("twice.csv --x load.torque --y start.ratio --colour slip_mean", 2, "among tip_angle"),
                ("run.h5 -o none/p.svg", 1, "none/p.svg: cannot create: the folder 'none' does not exist")):
            self.has(self.err(f"plot {line}", status), text)

    def test_without_python_or_a_library_reports_what_to_install(self):
        write("bare", '#!/bin/sh\nexec /usr/bin/python3 -S "$@"\n')  # without the packages of Debian
        os.chmod("bare", 0o755)
        here = os.getcwd()
        for python, status, text in (
                (f"{here}/none", 1, f"plot requires Python, and {here}/none cannot be started: No such file or directory"),
                (f"{here}/bare", 1, "plot requires numpy, matplotlib, h5py for /usr/bin/python3 (Debian: apt-get install python3-numpy "),
                ("./bare", 2, "CVTFLOW_PYTHON=./bare: expected an absolute path")):
            self.has(self.cvtflow("plot run.h5 -o p.png", status, CVTFLOW_PYTHON=python).err, text)
            self.assertFalse(os.path.exists("p.png"))

    def test_a_program_without_its_package_starts_no_other(self):
        """The package in a parent folder is not the program's, nor one that another user put where it would be installed."""
        Path("me/bin").mkdir(parents=True)
        shutil.copy(PROGRAM, "me/bin/cvtflow")
        for place in ("python", "me/python", "me/bin/python"):
            write(f"{place}/cvtflow/__main__.py", "print('a stranger runs')\n")
        for _ in range(2 if os.geteuid() == 0 else 1):
            done = subprocess.run(["me/bin/cvtflow", "plot", "run.h5", "slip", "-o", "p.svg"], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.has(done.stderr, "install cvtflow completely")
            place = Path(re.search(r"is not in (.*?),", done.stderr)[1])
            self.assertEqual(place.parts[:len(Path("me").resolve().parts)], Path("me").resolve().parts)
            write(place / "cvtflow/__main__.py", "print('a stranger runs')\n")
            shutil.chown(place / "cvtflow/__main__.py", 65534)

    def test_the_environment_of_a_user_has_no_effect(self):
        """Modules, settings and packages of the working folder, of PYTHONPATH, of a home without permission to write; another locale."""
        drawn, here = self.svg("run.h5 slip"), os.getcwd()
        for file in ("matplotlib.py", "numpy.py", "json.py", "cvtflow.py", "sitecustomize.py", "matplotlibrc"):
            write(file, "raise SystemExit('of the working folder')\n")
        for settings in ({"PYTHONPATH": here, "PYTHONHOME": here, "MATPLOTLIBRC": here, "MPLBACKEND": "module://evil", "PATH": here},
                         {"HOME": "/proc/none", "LANG": "de_DE.UTF-8", "LC_ALL": "de_DE.UTF-8"},
                         {"HOME": "", "LC_ALL": "C", "MPLCONFIGDIR": here}):
            self.assertEqual(self.cvtflow("plot run.h5 slip -o p.svg --force", **settings).err, "")
            self.assertEqual(read("p.svg"), drawn)

    def test_takes_paths_of_any_bytes(self):
        for name in ("a b%s.h5", "line\nbreak.h5", "ümläut.h5", os.fsdecode(b"latin\xfc.h5"), "<b>&$x$.h5"):
            shutil.copy("run.h5", name)
            self.cvtflow(["plot", name, "run.h5", "slip", "-o", "p.svg", "--force"])
            self.assertTrue(read("p.svg").startswith("<svg"), name)

    def test_overwrites_nothing_that_it_reads(self):
        shutil.copy("run.h5", "run.svg")
        self.err("plot run.svg -o run.svg --force")
        self.assertEqual(self.out("plot run.svg"), "run.svg.svg\n")
        self.assertEqual(Path("run.svg").read_bytes(), Path("run.h5").read_bytes())


if __name__ == "__main__":
    main()
