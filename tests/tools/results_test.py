"""Commands that read results: `info`, `table --rainflow`, `diff` and `export`; files for other programs by `export-fmu`."""

import json
import math
import os
import re
import resource
import subprocess
import xml.etree.ElementTree
import zipfile
import zlib
from pathlib import Path

import h5py
import numpy as np

from program import BRIEFLY, BUILD, Program, attribute, channel, depth, fact, main, read, write, write_sweep

SETTLED = "--set start.settling_time=1ms --set start.ramp_time=0.5ms"


class Info(Program):
    def test_states_the_step_that_was_taken(self):
        self.cvtflow(f"run tiny --method auto --until '0.1 ms' -q -o auto.h5 {SETTLED}")
        self.assertAlmostEqual(attribute("auto.h5", "step_taken"), 2.5e-6, delta=0.5e-6)
        self.matches(self.out("info auto.h5"), r"\n  method              leapfrog-sweep, step auto \([0-9.]+ us\), seed 0\n")
        self.cvtflow(f"run {BRIEFLY} -q -o given.h5")
        self.assertAlmostEqual(attribute("given.h5", "step_taken"), 50e-9, delta=1e-12)
        self.has(self.out("info given.h5"), "step 50 ns, seed 0\n")
        self.cvtflow(f"settle tiny -q -o a.state {SETTLED}")
        self.matches(self.out("info a.state"), r"rk4 with step auto \([0-9.]+ ns\), 1 ms of settling\n")
        with h5py.File("auto.h5", "r+") as file:  # of an earlier program
            del file.attrs["step_taken"]
        self.has(self.out("info auto.h5"), "leapfrog-sweep, step auto, seed 0\n")

    def test_shows_records_and_states(self):
        self.cvtflow(f"run {BRIEFLY} -q -o r.h5")
        text = self.out("info r.h5")
        self.assertTrue(text.startswith("r.h5: record of a run, "))
        self.has(text, "\n  status              finished\n", "\n  scene               tiny\n", "\n  program             cvtflow ",
                 "\n  rows                3, t = 0 s to 20 us\n")
        self.matches(text, r"\n  links/tension +N +3 x 24 +[0-9.e+-]+ \.\.\. ", r"\n  transitions +[0-9]+ +time pin tip from to ")
        self.cvtflow("settle tiny -q -o s.h5 --time 20us --set start.ramp_time=10us")
        text = self.out("info s.h5")
        self.assertTrue(text.startswith("s.h5: state, "))
        self.has(text, "\n  time                0 s\n", "\n  unknowns            1 032\n", "\n  state hash ",
                 "\n  settled with        scene tiny, 24 pins\n", " 20 us of settling\n")

    def test_describes_the_table_of_a_sweep(self):
        write_sweep("6")
        self.batch("-q")
        self.has(self.out("info out"), "out: results of a sweep\n", " ok\n", "status              finished", "cvtflow table out",
                 "energy_residual", fact("out", "results_hash"))

    def test_a_cycle_that_is_missed_is_the_status_of_run_record_and_case(self):
        """A vehicle of 100 kg that has to gain 10 km/h in 50 ms, more than the chain can transfer; or that rolls on at 30 km/h."""
        for speed, status in (("30", 0), ("40", 8)):
            write("car.toml", f'[detail]\nlevel = "rigid"\n[vehicle]\nmass = "100 kg"\n[cycle]\nspeed = [["0 s", "30 km/h"], ["50 ms", '
                              f'"{speed} km/h"]]\npedal_time = "10 ms"\n[clamping]\ndriving = "20 kN"\ndriven = "15 kN"\n[control]\n'
                              f'enabled = true\n[start]\nsettling_time = "5 ms"\nramp_time = "2 ms"\n[run]\nuntil = "50 ms"\n')
            missed = self.out("run car.toml -o car.h5 --force", status)
        self.has(missed, "car: cycle_missed at t = 0.05 s\n")
        self.matches(missed, r"\n  note                the machine misses its cycle: speed of shaft 2 is off by 7[0-9.]+ %")
        self.has(self.out("info car.h5"), "\n  status              cycle_missed: the machine misses its cycle: ")
        write("sweep.toml", '[sweep]\nscene = "car.toml"\n[[axes]]\nkey = "vehicle.mass"\nvalues = ["100 kg"]\n[outputs]\nrecords = true\n'
                            'scalars = ["ratio mean", "efficiency mean"]\n')
        self.batch("-q", 5)
        self.assertEqual(self.column("status"), {0: "cycle_missed"})
        self.has(self.column("notes")[0], "cycle_missed")
        self.assertFalse(math.isnan(self.column("ratio_mean")[0]), "a case that has run completely has scalars")
        self.assertAlmostEqual(attribute("out/records/case-000000.h5", "step_taken"), 7.1e-6, delta=0.5e-6, msg="of rigid pins")


class RainflowOfARecord(Program):
    """Cycles themselves: python_loads_test, which compares those of `cvtflow table` with the package's and with the standard's example."""

    def make(self):
        self.cvtflow(f"run {BRIEFLY} -q -o run.h5 --set 'record.channels=followed_pin/*' --set 'run.output_interval=200 ns'")

    def table(self, more):
        return self.out(f"table run.h5 --rainflow {more}")

    def test_is_that_of_its_channel_with_classes_and_a_damage_equivalent_range(self):
        history = channel("run.h5", "followed_pin/half_axial_force")[:, 1]
        load, = json.loads(self.table("followed_pin/half_axial_force[1] --exponent 3 --json"))["loads"]
        counts, ranges = (np.array([cycle[name] for cycle in load["cycles"]]) for name in ("count", "range"))
        self.assertEqual((load["unit"], ranges.max()), ("N", np.ptp(history)))
        self.assertEqual(2 * counts.sum(), np.count_nonzero(np.diff(np.sign(np.diff(history)))) + 1, "stretches between reversals")
        self.assertEqual(counts.sum(), sum(each["count"] for each in load["classes"]))
        damage = np.cbrt(counts @ ranges ** 3)
        self.assertAlmostEqual(load["damage_equivalent"]["range"], damage, delta=1e-9 * damage, msg="once in the record")
        self.assertEqual(load["damage_equivalent"]["reference_cycles"], 1)

    def test_has_a_text_a_table_and_a_window_and_reports_that_the_record_is_short(self):
        self.has(self.table("followed_pin/plate_tension[*] --classes 4"),
                 "followed_pin/plate_tension[0]: rainflow counts (ASTM E1049) of 101 outputs from 0 s to 20 us\n")
        csv = self.table("tight_tension --rainflow slip --csv")
        self.assertTrue(csv.startswith("load,unit,range,mean,cycles,from_time,to_time\ntight_tension,N,"))
        self.has(csv, "\nslip,1,")
        self.has(self.table("tight_tension --from '4.9 us' --until 1.01e-5"), "of 26 outputs from 5 us to 10 us")
        self.has(self.table("tight_tension --from '1 s'"), "no outputs\n  no cycles\n")
        self.has(self.table("tight_tension"), " kN (exponent 5, one cycle in the record)\n", "of a round of the chain (")  # 20 us of 58 ms

    def test_reports_what_it_cannot_count(self):
        for line, why in (("--rainflow tight_tensoin", 'the record has no such channel (did you mean "tight_tension"?)'),
                          ("--rainflow tips/normal_force[0]", "without this channel (record it with --set "
                                                              "record.channels=tips/normal_force)"),
                          ("--rainflow followed_pin/position", "it has 3 numbers; write followed_pin/position[0] ... "
                                                               "followed_pin/position[2]"),
                          ("--rainflow followed_pin/position[3]", "elements are numbered 0 to 2"),
                          ("--rainflow followed_pin/position[x]", "elements are numbered 0 to 2"),
                          ("--rainflow slip --json --csv", "--csv or --json, not both"),
                          ("--rainflow slip --status ok", "--column and --status apply to sweeps"),
                          ("--rainflow slip --from '3 kg'", "--from 3 kg: not a time"),
                          ("--rainflow slip --exponent 0", ""),
                          ("--json", "require --rainflow")):
            refused = self.cvtflow(f"table run.h5 {line}", 2)
            self.has(refused.err, why)
            self.assertEqual(refused.out, "")
        self.err("table none.h5 --rainflow slip")


class Table(Program):
    def test_of_a_thousand_cases_needs_no_package_and_little_time(self):
        """Seconds are of the processor: of the best of five, so that other work on the machine has no part in them."""
        write_sweep("6")
        self.batch()
        heading, *lines = read("out/results.csv").splitlines()
        rest = lines[0].split(",", 3)[3].rpartition(",")[0]
        rows = [f"{number},ok,{number},{rest}" for number in range(1000)]
        write("out/results.csv", "".join(line + "\n" for line in [heading, *(f"{row},{zlib.crc32(row.encode()):08x}" for row in rows)]))
        package = BUILD / "prefix/cvtflow/lib/python3/dist-packages/cvtflow"
        for words in (["table", "out"], ["diff", "out", "out"]):
            command, best = ["/usr/bin/python3", "-I", "-B", "-X", "utf8", str(package / "__main__.py"), *words], 1.0
            for _ in range(5):
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                best = min(best, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
            self.assertLess(best, 0.2, words)
            shown = subprocess.run([*command[:1], "-X", "importtime", *command[1:]], check=True, capture_output=True, text=True).stderr
            loaded = {line.rpartition("|")[2].strip() for line in shown.splitlines()}
            self.assertIn("cvtflow._rows", loaded)
            self.assertEqual(loaded & {"numpy", "h5py", "pandas", "matplotlib", "ctypes", "cvtflow._cvtflow"}, set(), words)


class Diff(Program):
    def make(self):
        write_sweep("6, 12")
        self.batch()

    def test_of_the_same_sweep_on_other_threads_or_as_csv_is_none(self):
        self.batch("--threads 1", folder="again")
        self.has(self.out("diff out again"), "8 cases in out, 8 in again, 8 in both", " 0 differ\n")
        write("out.csv", self.out("table out --csv"))
        self.out("diff out out.csv")
        self.out("diff again/results.csv out.csv")
        write("other.csv", read("out.csv").replace(",ok,", ",budget,", 1))
        self.has(self.out("diff out other.csv", 1), "ok -> budget")

    def test_names_columns_cases_and_the_largest_difference(self):
        write_sweep("12, 18", "41 us")  # half of the cases in common, which run longer
        self.batch(folder="longer")
        found = json.loads(self.out("diff out longer --json", 1))
        self.assertEqual((found["in_both"], found["equal"]), (4, False))
        columns = {each["column"]: each for each in found["columns"]}
        self.assertEqual(columns["steps"]["cases"], 4)
        self.assertGreaterEqual(columns["steps"]["largest"], 20)  # 1 us of steps of 50 ns
        self.assertNotIn("ratio_at_20_us", columns, "the first 20 us are the same")
        self.has(self.out("diff out longer --column slip_mean --tolerance 1", 1),  # cases are missing
                 "1 columns compared, 0 differ by more than 1 of the value\n")
        before, after = (float(each) for each in re.search(r": (\S+) -> (\S+)$", columns["slip_mean"]["example"]).groups())  # in SI
        self.has(self.out("diff out longer --column slip_mean", 1), f"{100 * before:.8g} -> {100 * after:.8g}")

    def test_refuses_tables_whose_cases_have_no_keys(self):
        write("keyless.csv", "case,status,slip_mean\n0,ok,0.1\n1,ok,0.2\n")
        self.has(self.err("diff out keyless.csv", 2), "both tables need the keys in which they differ")
        self.err("diff out out --column no_such", 2)


class Export(Program):
    def make(self):
        """Outputs at every state, so that channels and pictures are of the same instants."""
        self.cvtflow(f"""run {BRIEFLY} -q -o run.h5 --set 'record.channels=["plates/*", "tips/*"]' --set 'run.output_interval=5 us'
                     --set 'run.state_interval=5 us'""")

    def test_is_read_back_by_vtk_with_the_records_forces_and_places(self):
        """Every time step: to the seven digits of its numbers."""
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
        except ImportError:
            self.skipTest("needs VTK for Python (Debian: python3-vtk9)")
        self.has(self.out("export run.h5 --vtk run.pvd"), "run.pvd")
        rows = list(xml.etree.ElementTree.parse("run.pvd").getroot().iter("DataSet"))
        self.assertEqual([float(row.get("timestep")) for row in rows], channel("run.h5", "/states/time").tolist())
        self.assertGreater(len(rows), 3)
        for step, row in enumerate(rows):
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(row.get("file"))
            reader.Update()
            cells, points = reader.GetOutput().GetCellData(), reader.GetOutput().GetPointData()
            tension, part, force = (vtk_to_numpy(array) for array in (cells.GetArray("tension"), cells.GetArray("part"),
                                                                      points.GetArray("tip_force")))
            plates = channel("run.h5", "plates/tension")[step]
            self.assertAlmostEqual(tension[part == 1].sum(), plates.sum(), delta=1e-6 * abs(plates).sum())
            axial, radial, tangential = (channel("run.h5", f"tips/{name}_force")[step] for name in ("axial", "radial", "tangential"))
            size = abs(axial).sum()
            self.assertAlmostEqual(abs(force[:, 2]).sum(), size, delta=1e-6 * size)
            self.assertAlmostEqual(np.hypot(force[:, 0], force[:, 1]).sum(), np.hypot(radial, tangential).sum(), delta=1e-6 * size)
            state = channel("run.h5", "/states/y")[step]  # of the rear half of link 0; P_2(0) = -1/2
            self.assertAlmostEqual(reader.GetOutput().GetPoint(2)[0], state[0] - 0.5 * state[2], delta=1e-7 * abs(state[0]))

    def test_takes_every_nth_state(self):
        self.has(self.out("export run.h5 --vtk run.pvd --every 2"), "3 states")
        self.has(read("run.pvd"), '<DataSet timestep="1e-05" file="run/run_000001.vtu"/>')
        self.assertFalse(os.path.exists("run/run_000003.vtu"))

    def test_writes_channels_as_one_table_with_units(self):
        self.cvtflow("export run.h5 --csv all.csv")
        self.has(read("all.csv").splitlines()[0], "time [s],shaft_1/speed [rad/s],")
        self.cvtflow("export run.h5 ratio links/tension --csv some.csv")
        self.assertTrue(read("some.csv").startswith("time [s],ratio [1],links/tension[0] [N],links/tension[1] [N],"))
        np.testing.assert_array_equal(np.loadtxt("some.csv", delimiter=",", skiprows=1, comments=None), np.column_stack(
            [channel("run.h5", name) for name in ("time", "ratio", "links/tension")]))

    def test_reports_what_it_cannot_write(self):
        for line, status in (("run.h5", 2), ("run.h5 --vtk x.vtk", 2), ("none.h5 --vtk x.pvd", 1), ("run.h5 --vtk none/x.pvd", 1),
                             ("run.h5 --vtk x.pvd --every 0", 2), ("run.h5 slp --csv x.csv", 2)):
            self.err(f"export {line}", status)
        self.assertFalse(os.path.exists("x.pvd"))


class FmuTerminals(Program):
    def terminals(self, more):
        """(name of the terminal, member, variable) of all in an exported FMU."""
        self.cvtflow(f"export-fmu tiny -q -o t.fmu --force {more}")
        with zipfile.ZipFile("t.fmu") as file:
            root = xml.etree.ElementTree.fromstring(file.read("terminalsAndIcons/terminalsAndIcons.xml"))
        self.assertEqual((root.tag, root.get("fmiVersion")), ("fmiTerminalsAndIcons", "3.0"))
        return {(terminal.get("name"), row.get("memberName"), row.get("variableName"), row.get("variableKind"))
                for terminal in root.iter("Terminal") for row in terminal.iter("TerminalMemberVariable")}

    def test_and_the_default_experiment_has_communication_steps_that_cost_little(self):
        """Outputs every 10 us are for pictures; importers took them for the communication step, at three times the cost."""
        for scene, until, step in (("tiny", "1 ms", "0.0001"), ("ece15", "195 s", "0.001"), ("ece15", "20 ms", "0.001"), ("tiny", "20 ms", "0.0001"),
                                   ("tiny", "50 ms", "0.001"), ("tiny", "40 us", "4e-05"), ("tiny", "10 s", "0.001"))[:depth(2, 7)]:
            self.cvtflow(f"export-fmu {scene} -q -o t.fmu --force --set 'run.until={until}'")
            self.has(Path("t.fmu").read_bytes(), f'stepSize="{step}"'.encode())  # the description alone is stored uncompressed

    def test_gather_inputs_and_outputs_by_shaft_and_name_only_variables_that_the_fmu_has(self):
        shafts = self.terminals("--outputs ratio,shaft_1/speed,shaft_2/speed")
        for shaft, names in (("shaft_1", ("clamping_driving", "drive_speed")), ("shaft_2", ("clamping_driven", "load_torque"))):
            rows = {row for row in shafts if row[0] == shaft}
            self.assertLessEqual({(shaft, "speed", f"{shaft}.speed", "signal"), *((shaft, name, name, "signal") for name in names)}, rows)
        self.assertEqual({row[0] for row in shafts}, {"shaft_1", "shaft_2"})
        for row in shafts:
            self.assertNotEqual(row[2], "ratio")
            self.assertEqual(row[0] == "shaft_1", row[2] in ("shaft_1.speed", "clamping_driving", "drive_speed"), row)
        self.assertEqual({row[::2] for row in self.terminals("--inputs load_torque --outputs ratio")}, {("shaft_2", "load_torque")})

    def test_are_in_the_same_file_as_python_writes_it(self):
        self.cvtflow("export-fmu tiny -q -o t.fmu --outputs ratio,links/tension --author me")
        done = subprocess.run(["/usr/bin/python3", "-c", "import cvtflow\ncvtflow.export_fmu('tiny', 'p.fmu', outputs=['ratio', "
                               "'links/tension'], author='me')"], capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        self.assertEqual(Path("p.fmu").read_bytes(), Path("t.fmu").read_bytes())

    def test_are_not_part_of_the_second_version_of_the_standard(self):
        self.cvtflow("export-fmu tiny -q -o t.fmu --fmi 2")
        with zipfile.ZipFile("t.fmu") as file:
            self.assertEqual([name for name in file.namelist() if name.startswith("terminalsAndIcons/")], [])


if __name__ == "__main__":
    main()
