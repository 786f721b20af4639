"""The wheel: what setuptools packs from a build that exists, and that it works alone, with its program."""

import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from python_fixture import DEEP, SOURCE, main

import cvtflow

BUILD = Path(cvtflow.__file__).absolute().parents[2]


def wheel(folder, **settings):
    """The wheel that pip makes in a folder, of the build that exists."""
    made = subprocess.run([sys.executable, "-m", "pip", "wheel", SOURCE, "--no-deps", "--no-build-isolation", "--no-index", "-w", folder],
                          capture_output=True, text=True, cwd=folder, env={**os.environ, "CVTFLOW_BUILT": str(BUILD), **settings})
    if "No module named" in made.stdout + made.stderr:
        raise unittest.SkipTest("pip, setuptools or wheel is not installed")
    if made.returncode:
        raise AssertionError(made.stdout + made.stderr)
    return next(Path(folder).glob("*.whl"))


class Wheel(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.site = Path(self.folder, "site")

    def test_it_holds_the_whole_package_and_works_alone(self):
        file = wheel(self.folder)
        self.assertRegex(file.name, r"^cvtflow-[0-9.]+-py3-none-linux_\w+\.whl$")
        subprocess.run([sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "-q", "--target", self.site, file], check=True,
                       cwd=self.folder, env={**os.environ, "PIP_NO_WARN_SCRIPT_LOCATION": "1"})
        names = {str(each.relative_to(self.site)) for each in self.site.rglob("*")}
        package = Path(SOURCE, "api/python")
        for source in package.rglob("*"):
            if source.is_file() and "__pycache__" not in source.parts and source.name not in ("CMakeLists.txt", "package.json",
                                                                                              "package-lock.json"):
                self.assertIn(str(source.relative_to(package)), names)
        program = """import cvtflow
print(cvtflow.__file__, cvtflow.Simulation(cvtflow.Scene.ready("tiny")).size())
simulation = cvtflow.Simulation(cvtflow.Scene.ready("tiny").with_("start.settling_time=20 us", "start.ramp_time=10 us"))
with cvtflow.Recording(simulation, "r.h5"):
    simulation.advance_to("20 us")
print(cvtflow.Record("r.h5").status)"""
        environment = {"PYTHONPATH": str(self.site), "LC_ALL": "C", "PATH": "/usr/bin:/bin"}
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=self.folder, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(done.stdout.startswith(str(self.site)) and done.stdout.endswith("finished\n"), done.stdout)
        for words, shown in (("run tiny --until 20us -q -o p.h5", ""), ("plot r.h5 slip -o r.svg", "r.svg"), ("info p.h5", "status"),
                             ("export-fmu tiny -o t.fmu", "t.fmu: FMI 3.0")):
            ran = subprocess.run([self.site / "bin/cvtflow", *words.split()], capture_output=True, text=True, cwd=self.folder, env=environment)
            self.assertEqual(ran.returncode, 0, f"{words}: {ran.stderr}")
            self.assertIn(shown, ran.stdout + ran.stderr)
        self.assertIn("<svg", Path(self.folder, "r.svg").read_text())

    @unittest.skipUnless((BUILD / "cvtflow.dll").exists(), "the target cvtflow_windows is not built")
    def test_that_for_windows_has_the_core_library_and_no_program(self):
        file = wheel(self.folder, CVTFLOW_WINDOWS="1")
        self.assertRegex(file.name, "-py3-none-win_amd64.whl$")
        with zipfile.ZipFile(file) as opened:
            opened.extractall(self.site)
        self.assertEqual({each.name for each in self.site.glob("cvtflow/lib/**/*.*")}, {"cvtflow.dll", "cvtflow_fmu.dll", "cvtflow_fmu.so"})
        self.assertFalse(Path(self.site, "cvtflow/bin/cvtflow").exists())
        program = """import cvtflow, cvtflow._program
rows = cvtflow.run(cvtflow.Scene.ready("tiny").with_("start.state=", "start.settling_time=20 us", "start.ramp_time=10 us"), "100 us")
rows.plot("slip").savefig("slip.svg")
cvtflow.export_fmu(cvtflow.Scene.ready("tiny").with_("start.state=", "start.settling_time=20 us", "start.ramp_time=10 us"), "tiny.fmu")
cvtflow._program.main()"""
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=self.folder,  # in place of cvtflow.dll
                              env={"PYTHONPATH": str(self.site), "CVTFLOW_LIBRARY": str(BUILD / "libcvtflow-core.so")})
        self.assertRegex(done.stderr, "^cvtflow: .*: this package has the core library alone, .*; the program is in packages for Linux\n$")
        with zipfile.ZipFile(Path(self.folder, "tiny.fmu")) as parts:
            self.assertLess({"binaries/x86_64-windows/tiny.dll", "binaries/x86_64-linux/tiny.so"}, set(parts.namelist()))
        self.assertIn("<svg", Path(self.folder, "slip.svg").read_text())

    @unittest.skipUnless(DEEP, "deep")
    def test_a_bundle_contains_all_libraries_that_not_every_distribution_has(self):
        file = wheel(self.folder, CVTFLOW_BUNDLE="1")
        self.assertRegex(file.name, r"-py3-none-manylinux_2_\d+_\w+\.whl$")
        with zipfile.ZipFile(file) as opened:
            opened.extractall(self.site)
        libraries = self.site / "cvtflow/lib"
        listed = subprocess.run(["ldd", next(libraries.glob("libcvtflow.so.*"))], capture_output=True, text=True,
                                env={"LD_LIBRARY_PATH": str(libraries)}).stdout  # a build for a bundle has the path in its libraries
        outside = [line.split()[0] for line in listed.splitlines() if "=> /" in line and str(libraries) not in line]
        self.assertRegex(" ".join(outside), r"\blibc\.so")
        self.assertIn("libhdf5", listed)
        everywhere = r"(lib(c|m|dl|rt|pthread|resolv|util|stdc\+\+|gcc_s)|ld-linux[\w-]*|linux-vdso)\.so"
        self.assertNotRegex(" ".join(f" {each}" for each in outside), rf" (?!{everywhere})\S")


main() if __name__ == "__main__" else None
