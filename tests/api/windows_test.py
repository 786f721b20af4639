"""The core library and an FMU under Wine give the bits that they give on Linux. Exit status 77: no Wine, no mingw-w64, or no library for
Windows was built.

    tests/api/windows_test.py CVTFLOW CC        CC: C compiler of this system
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse
import xml.etree.ElementTree
import zipfile

PROGRAM, CC = sys.argv[1:3]
del sys.argv[1:3]
BUILD = pathlib.Path(PROGRAM).parent
HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE / "fmu_steps.c"
MINGW = shutil.which("x86_64-w64-mingw32-gcc-posix") or shutil.which("x86_64-w64-mingw32-gcc")
WINE = shutil.which("wine64") or shutil.which("wine") or shutil.which("wine64", path="/usr/lib/wine")
SETTLING = ("--set", 'start.state=""', "--set", "start.settling_time=0.1 ms", "--set", "start.ramp_time=50 us")
PLACES = {2: ("linux64", "win64"), 3: ("x86_64-linux", "x86_64-windows")}


class Windows(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="fmu windows ")
        cls.folder = pathlib.Path(cls.scratch.name)
        # Wine keeps a folder, and Windows' libraries need no more of it than that.
        cls.environment = {**os.environ, "WINEPREFIX": str(cls.folder / "wine"), "LC_ALL": "C.UTF-8", "WINEDEBUG": "-all",
                           "WINEDLLOVERRIDES": "mscoree,mshtml="}
        subprocess.run([CC, "-O1", str(SOURCE), "-o", str(cls.folder / "steps"), "-ldl"], check=True)
        subprocess.run([MINGW, "-O1", str(SOURCE), "-o", str(cls.folder / "steps.exe"), "-static"], check=True)

    @classmethod
    def tearDownClass(cls):
        server = pathlib.Path(WINE).with_name("wineserver")
        subprocess.run([str(server) if server.exists() else "wineserver", "-k"], env=cls.environment, check=False)
        cls.scratch.cleanup()

    def host(self, compiler, standard, source, *words):
        """What a host of cvtflow.dll prints."""
        shutil.copy(BUILD / "cvtflow.dll", self.folder)
        subprocess.run([compiler, standard, "-O1", "-DCORE_ONLY", "-I", HERE.parents[1] / "api/include", HERE / source, BUILD / "cvtflow.dll", "-o",
                        self.folder / "host.exe", "-static"], check=True)
        done = subprocess.run([WINE, "host.exe", *words], capture_output=True, text=True, env=self.environment, cwd=self.folder, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_a_program_in_c_finds_what_the_header_promises(self):
        self.assertIn("all as promised", self.host(MINGW, "-std=c11", "c_program.c", "tiny"))

    def test_a_program_in_cpp_gets_the_bits_of_linux(self):
        words = ["tiny", "2e-4", "fine", "start.settling_time=0"]
        here = subprocess.run([BUILD / "tests/api/core_program", *words], capture_output=True, text=True, check=True).stdout
        self.assertEqual(self.host(MINGW.replace("gcc", "g++"), "-std=c++20", "core_program.cpp", *words), here)

    def exported(self, version, *more, scene="tiny"):
        """Folder of an exported FMU, and the value references of its variables."""
        inside = self.folder / f"fmi {version}"
        shutil.rmtree(inside, ignore_errors=True)
        file = self.folder / "one.fmu"
        subprocess.run([PROGRAM, "export-fmu", scene, "-o", str(file), "-q", "--force", "--fmi", str(version), *more], check=True)
        with zipfile.ZipFile(file) as parts:
            parts.extractall(inside)
        root = xml.etree.ElementTree.parse(inside / "modelDescription.xml").getroot()
        return inside, {row.get("name"): row.get("valueReference") for row in root.find("ModelVariables")}

    def steps(self, inside, version, windows, references, resources=None, status=0):
        """Words that the library printed; with another status than 0, its complaint. @param resources: another folder of these"""
        library = inside / "binaries" / PLACES[version][windows] / ("tiny.dll" if windows else "tiny.so")
        folder = resources or inside / "resources"
        resources = f"Z:{folder}" if windows else str(folder)
        if version == 2:
            resources = ("file:///" if windows else "file://") + urllib.parse.quote(resources, safe="/:")
        else:
            resources += "/"
        command = [WINE, str(self.folder / "steps.exe")] if windows else [str(self.folder / "steps")]
        done = subprocess.run([*command, str(library), resources, str(version), "20", "1e-5", references["load_torque"], "9.5",
                               *(references[name] for name in ("time", "ratio", "slip", "efficiency", "shaft_1.chain_torque"))],
                              capture_output=True, text=True, env=self.environment, timeout=300)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout.split() if status == 0 else done.stderr

    def test_bits_are_those_of_linux(self):
        for version in (2, 3):
            with self.subTest(fmi=version):
                inside, references = self.exported(version)
                here, there = (self.steps(inside, version, windows, references) for windows in (0, 1))
                self.assertEqual(len(here), 3 * 21 * 5)
                self.assertGreater(len(set(here)), 4 * 21)  # the numbers change with time
                self.assertEqual(there, here)

    def test_bits_are_those_of_linux_at_every_detail(self):
        """Every family of kernels: pin halves, rigid pins, every plate, stages side by side; settling; control."""
        for more in (("--detail", "rigid"), ("--detail", "fine"), ("--method", "rk4", "--step", "20 ns"),
                     ("--method", "dumka3-p5"), ("--set", "detail.stick_slip=true"),
                     ("--set", "control.enabled=true", "--method", "rk4", "--step", "20 ns")):
            with self.subTest(more=more):
                inside, references = self.exported(3, *SETTLING, *more)
                self.assertEqual(self.steps(inside, 3, 1, references), self.steps(inside, 3, 0, references))

    def test_folders_have_names_of_every_language(self):
        inside, references = self.exported(2)
        place = shutil.copytree(inside / "resources", self.folder / "Müller 変速機" / "resources")
        self.assertEqual(self.steps(inside, 2, 1, references, place), self.steps(inside, 2, 0, references))

    def test_a_library_older_than_that_for_linux_is_left_out(self):
        package, place = self.folder / "lib/python3/dist-packages/cvtflow", self.folder / "lib/cvtflow"  # as installed
        shutil.copytree(BUILD / "python/cvtflow", package)
        place.mkdir()
        newer = [os.stat(shutil.copy2(BUILD / name, place)).st_mtime_ns for name in ("cvtflow_fmu.dll", "cvtflow_fmu.so")][1]
        for age, expected in ((0, "Linux and Windows"), (10**9, "Linux only (cvtflow_fmu.dll is older")):
            os.utime(place / "cvtflow_fmu.dll", ns=(newer - age, newer - age))
            done = subprocess.run(["/usr/bin/python3", "-I", "-B", package / "__main__.py", "export-fmu", "tiny", "-o", self.folder / "old.fmu", "--force"],
                                  capture_output=True, text=True, check=True, env={**os.environ, "CVTFLOW_LIBRARY": str(BUILD / "libcvtflow.so")})
            self.assertIn(expected, done.stdout)
        with zipfile.ZipFile(self.folder / "old.fmu") as parts:
            self.assertNotIn("binaries/x86_64-windows/tiny.dll", parts.namelist())

    def test_missing_resources_are_an_error_not_a_crash(self):
        for version in (2, 3):
            inside, references = self.exported(version)
            no_instance = 5
            self.assertIn("status 3", self.steps(inside, version, 1, references, self.folder / "nowhere", no_instance))


def has_windows_library():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([PROGRAM, "export-fmu", "tiny", "-o", f"{folder}/one.fmu", "-q"], check=True)
        with zipfile.ZipFile(f"{folder}/one.fmu") as parts:
            return "binaries/x86_64-windows/tiny.dll" in parts.namelist()


if __name__ == "__main__":
    missing = "Wine" if not WINE else "mingw-w64" if not MINGW else "" if has_windows_library() else "the target cvtflow_windows"
    if missing:
        print(f"skipped: {missing} is missing")
        sys.exit(77)
    unittest.main(verbosity=2)
