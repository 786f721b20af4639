"""An FMU under Wine gives the bits that it gives on Linux. Exit status 77: no Wine, no mingw-w64, or no Windows library was built.

    tests/api/fmu_windows_test.py CVTFLOW CC        CC: C compiler of this system
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
import zipfile

PROGRAM, CC = sys.argv[1:3]
del sys.argv[1:3]
SOURCE = pathlib.Path(__file__).with_name("fmu_steps.c")
MINGW = shutil.which("x86_64-w64-mingw32-gcc-posix") or shutil.which("x86_64-w64-mingw32-gcc")
WINE = shutil.which("wine64") or shutil.which("wine") or shutil.which("wine64", path="/usr/lib/wine")
PLACES = {2: ("linux64", "win64"), 3: ("x86_64-linux", "x86_64-windows")}


class Windows(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="fmu windows ")
        cls.folder = pathlib.Path(cls.scratch.name)
        # Wine keeps a folder of its own, and Windows' libraries need no more of it than that.
        cls.environment = {**os.environ, "WINEPREFIX": str(cls.folder / "wine"), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
        subprocess.run([CC, "-O1", str(SOURCE), "-o", str(cls.folder / "steps"), "-ldl"], check=True)
        subprocess.run([MINGW, "-O1", str(SOURCE), "-o", str(cls.folder / "steps.exe"), "-static"], check=True)

    @classmethod
    def tearDownClass(cls):
        subprocess.run([str(pathlib.Path(WINE).with_name("wineserver")) if pathlib.Path(WINE).with_name("wineserver").exists() else "wineserver", "-k"],
                       env=cls.environment, check=False)
        cls.scratch.cleanup()

    def exported(self, version, *more):
        """Folder of an exported FMU, and the value references of its variables."""
        inside = self.folder / f"fmi {version}"
        shutil.rmtree(inside, ignore_errors=True)
        file = self.folder / "one.fmu"
        subprocess.run([PROGRAM, "export-fmu", "tiny", "-o", str(file), "-q", "--force", "--fmi", str(version), *more], check=True)
        with zipfile.ZipFile(file) as parts:
            parts.extractall(inside)
        root = xml.etree.ElementTree.parse(inside / "modelDescription.xml").getroot()
        return inside, {row.get("name"): row.get("valueReference") for row in root.find("ModelVariables")}

    def steps(self, inside, version, windows, references):
        library = inside / "binaries" / PLACES[version][windows] / ("tiny.dll" if windows else "tiny.so")
        root = f"Z:{inside}" if windows else str(inside)
        resources = f"{root}/resources" + ("/" if version == 3 else "")
        if version == 2:
            resources = ("file:///" if windows else "file://") + resources.replace(" ", "%20")
        command = [WINE, str(self.folder / "steps.exe")] if windows else [str(self.folder / "steps")]
        done = subprocess.run([*command, str(library), resources, str(version), "20", "1e-5", references["load_torque"], "9.5",
                               *(references[name] for name in ("time", "ratio", "slip", "efficiency", "shaft_1.chain_torque"))],
                              capture_output=True, text=True, env=self.environment, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.split()

    def test_bits_are_those_of_linux(self):
        for version in (2, 3):
            with self.subTest(fmi=version):
                inside, references = self.exported(version)
                here, there = (self.steps(inside, version, windows, references) for windows in (0, 1))
                self.assertEqual(len(here), 3 * 21 * 5)
                self.assertEqual(there, here)

    def test_parts_that_need_settling_and_control_are_the_same(self):
        inside, references = self.exported(3, "--set", 'start.state=""', "--set", "start.settling_time=0.1 ms", "--set", "start.ramp_time=50 us",
                                           "--set", "control.enabled=true", "--set", "run.method=rk4", "--set", "run.step=20 ns")
        self.assertEqual(self.steps(inside, 3, 1, references), self.steps(inside, 3, 0, references))


def has_windows_library():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([PROGRAM, "export-fmu", "tiny", "-o", f"{folder}/one.fmu", "-q"], check=True)
        with zipfile.ZipFile(f"{folder}/one.fmu") as parts:
            return "binaries/x86_64-windows/tiny.dll" in parts.namelist()


if __name__ == "__main__":
    missing = "Wine" if not WINE else "mingw-w64" if not MINGW else "" if has_windows_library() else "the target cvtflow_fmu_windows"
    if missing:
        print(f"skipped: {missing} is missing")
        sys.exit(77)
    unittest.main(verbosity=2)
