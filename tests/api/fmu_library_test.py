"""FMUs in a second importer that others wrote, FMI Library (fmu_importer.c). Exit status 77: its source was not there when tests were built."""

import os
import struct
import subprocess
import sys
import tempfile
import unittest

import cvtflow

PROGRAM, IMPORTER = (os.environ.get(f"CVTFLOW_{name}", "") for name in ("PROGRAM", "FMU_IMPORTER"))
if not IMPORTER:
    print("skipped: no source of FMI Library (-DCVTFLOW_PEERS=folder with fmi-library)")
    sys.exit(77)


def export(file, scene, version, *more):
    subprocess.run([PROGRAM, "export-fmu", scene, "-o", file, "--force", "-q", "--fmi", str(version), *more], check=True)


def imported(file, steps, length, change, names):
    """Values of the variables after every step, and what was written to standard error. change: name and value of the input that is set
    half-way"""
    with tempfile.TemporaryDirectory() as folder:
        os.mkdir(f"{folder}/inside")
        done = subprocess.run([IMPORTER, file, f"{folder}/inside", str(steps), repr(length), *map(str, change), *names], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    rows = [line.split()[2] for line in done.stdout.splitlines() if line.split()[1:2] and line.split()[1] in names]
    values = [struct.unpack(">d", bytes.fromhex(word))[0] for word in rows]
    return [values[row:row + len(names)] for row in range(0, len(values), len(names))], done.stderr


def alone(scene, steps, length, change, names):
    """The same values by the core in this process."""
    simulation, rows = cvtflow.Simulation(cvtflow.Scene.ready(scene)), []
    simulation.advance_to(0.0)
    for number in range(steps + 1):
        rows.append([simulation.channel(name)[0] for name in names])
        if number == steps // 2 and change[0] != "-":
            simulation.set_input(*change)
        if number < steps:
            simulation.advance_to(number * length + length)
    return rows


class FmiLibrary(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="fmus for a library ")
        cls.file = f"{cls.folder.name}/one.fmu"

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_bits_are_those_of_the_core(self):
        for scene, steps, length, change, names, outputs in (
                ("tiny", 20, 1e-5, ("load_torque", 9.5), ["ratio", "shaft_1/angle", "shaft_2/speed", "efficiency"],
                 "ratio,shaft_1/angle,shaft_2/speed,efficiency"),
                ("ece15", 200, 1e-3, ("-", 0), ["vehicle/speed", "vehicle/kinetic", "vehicle/rolling", "vehicle/clutch", "ratio", "shaft_2/speed"],
                 "vehicle/*,ratio,shaft_2/speed")):
            expected = alone(scene, steps, length, change, names)
            for version in (2, 3):
                with self.subTest(scene=scene, fmi=version):
                    export(self.file, scene, version, "--outputs", outputs)
                    rows, said = imported(self.file, steps, length, change, [name.replace("/", ".") for name in names])
                    self.assertEqual(rows, expected)
                    print(f"\n{scene}, FMI {version}: {said.strip()}", file=sys.stderr)

    def test_unreliable_results_are_a_warning_in_one_step(self):
        for version in (2, 3):
            with self.subTest(fmi=version):
                export(self.file, "tiny", version, "--method", "rk4", "--step", "140 ns", "--set", "start.settling_time=5 ms")
                rows, said = imported(self.file, 20, 1e-4, ("-", 0), ["unreliable"])
                flags = [row[0] != 0.0 for row in rows]
                self.assertEqual(flags, sorted(flags))
                self.assertEqual((flags[0], flags[-1]), (False, True))
                self.assertEqual(said.count("do_step: status 1"), 1, said)
                self.assertIn("log: status 1, logStatusWarning: unreliable: the residual of the energy balance", said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
