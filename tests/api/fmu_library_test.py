"""FMUs in a second importer that others wrote, FMI Library (fmu_importer.c). Exit status 77: its source was not there when tests were built."""

import concurrent.futures
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
import zipfile

import cvtflow

PROGRAM, COMPILER, IMPORTER = (os.environ.get(f"CVTFLOW_{name}", "") for name in ("PROGRAM", "CXX", "FMU_IMPORTER"))
if not IMPORTER:
    print("skipped: no source of FMI Library (-DCVTFLOW_PEERS=folder with fmi-library)")
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
                    other.writestr(name, pathlib.Path(binary).read_bytes() if name.endswith(".so") else parts.read(name))
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

    def test_the_library_made_of_its_sources_gives_its_bits(self):
        names, files = ["ratio", "shaft_1.angle"], {}
        for version in (2, 3):
            export(self.file, "tiny", version, "--sources", "--outputs", "ratio,shaft_1/angle")
            folder = f"{self.folder.name}/{version}"
            with zipfile.ZipFile(self.file) as parts:
                parts.extractall(folder)
            description = xml.etree.ElementTree.parse(f"{folder}/{'modelDescription' if version == 2 else 'sources/buildDescription'}.xml")
            files[version] = [row.get("name") for row in description.iter("File" if version == 2 else "SourceFile")]
            self.assertEqual(sorted(files[version]), sorted(f"groups/{name}" for name in os.listdir(f"{folder}/sources/groups")))
        # The words of build.txt, not optimised and two files at a time: minutes less.
        words = pathlib.Path(folder, "sources/build.txt").read_text().split()
        self.assertEqual([word for word in words if word.endswith(".cpp")], files[3])
        options = [word for word in words if not word.endswith(".cpp") and word not in ("-O3", "-shared")] + ["-O0"]

        def compiled(name):
            made = subprocess.run([COMPILER, *options, "-c", name, "-o", f"{name}.o"], cwd=f"{folder}/sources", capture_output=True, text=True)
            return made.stderr if made.returncode else ""

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            self.assertEqual([said for said in pool.map(compiled, files[3]) if said], [])
        library = f"{folder}/of_sources.so"
        subprocess.run([COMPILER, "-shared", *(f"{name}.o" for name in files[3]), "-o", library], cwd=f"{folder}/sources", check=True)
        expected, _ = imported(self.file, 20, 1e-5, ("load_torque", 9.5), names)
        rows, _ = imported(self.file, 20, 1e-5, ("load_torque", 9.5), names, library)
        self.assertEqual(rows, expected)


if __name__ == "__main__":
    unittest.main(verbosity=2)
