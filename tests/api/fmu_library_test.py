"""FMUs in a second importer that others wrote, FMI Library (fmu_importer.c). Exit status 77: its source was not there when tests were built."""

import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

import cvtflow

PROGRAM, IMPORTER = os.environ["CVTFLOW_PROGRAM"], os.environ.get("CVTFLOW_FMU_IMPORTER", "")
if not IMPORTER:
    print("skipped: no source of FMI Library (-DCVTFLOW_FMI_LIBRARY=folder)")
    sys.exit(77)


def export(file, scene, version, *more):
    subprocess.run([PROGRAM, "export-fmu", scene, "-o", file, "--force", "-q", "--fmi", str(version), *more], check=True)


def imported(file, steps, length, change, names, binary=None):
    """Values of the variables after every step, and what was written to standard error.

    change: name and value of the input that is set half-way; binary: a file that replaces the FMU's library
    """
    with tempfile.TemporaryDirectory() as folder:
        if binary:
            with zipfile.ZipFile(file) as parts, zipfile.ZipFile(f"{folder}/other.fmu", "w") as other:
                for name in parts.namelist():
                    other.writestr(name, open(binary, "rb").read() if name.endswith(".so") else parts.read(name))
            file = f"{folder}/other.fmu"
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
        names = ["ratio", "shaft_1/angle", "shaft_2/speed", "efficiency"]
        expected = alone("tiny", 20, 1e-5, ("load_torque", 9.5), names)
        for version in (2, 3):
            with self.subTest(fmi=version):
                export(self.file, "tiny", version, "--outputs", ",".join(names))
                rows, said = imported(self.file, 20, 1e-5, ("load_torque", 9.5), [name.replace("/", ".") for name in names])
                self.assertEqual(rows, expected)
                print(f"\ntiny, FMI {version}: {said.strip()}", file=sys.stderr)

    def test_a_car_drives_by_steps_of_a_millisecond(self):
        names = ["vehicle/speed", "vehicle/kinetic", "vehicle/rolling", "ratio", "shaft_2/speed"]
        expected = alone("ece15", 200, 1e-3, ("-", 0), names)
        for version in (2, 3):
            with self.subTest(fmi=version):
                export(self.file, "ece15", version, "--outputs", "vehicle/*,ratio,shaft_2/speed")
                rows, said = imported(self.file, 200, 1e-3, ("-", 0), [name.replace("/", ".") for name in names])
                self.assertEqual(rows, expected)
                print(f"\nece15, FMI {version}: {said.strip()}", file=sys.stderr)

    def test_unreliable_results_are_a_warning_in_one_step(self):
        for version in (2, 3):
            with self.subTest(fmi=version):
                export(self.file, "tiny", version, "--method", "rk4", "--step", "200 ns")
                rows, said = imported(self.file, 10, 1e-5, ("-", 0), ["unreliable"])
                flags = [row[0] != 0.0 for row in rows]
                self.assertEqual(flags, sorted(flags))
                self.assertEqual((flags[0], flags[-1]), (False, True))
                self.assertEqual(said.count("do_step: status 1"), 1, said)
                self.assertIn("log: status 1, logStatusWarning: unreliable: the residual of the energy balance", said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
