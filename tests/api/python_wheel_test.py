"""The wheel: what the build back-end packs from a build that exists, and that it asks for nothing from elsewhere."""

import hashlib
import base64
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from python_fixture import DEEP, SOURCE, main

import cvtflow

sys.path.insert(0, SOURCE + "/api/python")
import build_backend  # noqa: E402

BUILD = Path(cvtflow.__file__).absolute().parents[2]


class Wheel(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.addCleanup(setattr, build_backend, "build", build_backend.build)
        build_backend.build = lambda settings: BUILD  # it is there already

    def test_it_needs_nothing_that_would_have_to_be_fetched(self):
        self.assertEqual(build_backend.get_requires_for_build_wheel(), [])
        self.assertIn("requires = []", Path(SOURCE, "pyproject.toml").read_text())

    def test_the_extension_loads_where_there_is_no_numpy(self):
        """pip builds in a separate environment, in which the stub is asked of the module."""
        package = Path(self.folder, "cvtflow")
        package.mkdir()
        module = Path(cvtflow._cvtflow.__file__)
        (package / module.name).symlink_to(module)
        done = subprocess.run([sys.executable, "-S", SOURCE + "/api/python/stubs.py", self.folder], capture_output=True, text=True,
                              env={"LD_LIBRARY_PATH": str(BUILD)})  # as the back-end does
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((package / "_cvtflow.pyi").read_text(), module.with_name("_cvtflow.pyi").read_text())

    @unittest.skipUnless(DEEP, "deep")
    def test_it_holds_the_whole_package_and_works_alone(self):
        name = build_backend.build_wheel(self.folder)
        site = Path(self.folder, "site")
        with zipfile.ZipFile(Path(self.folder, name)) as wheel:
            names = wheel.namelist()
            wheel.extractall(site)
            record = next(each for each in names if each.endswith("/RECORD"))
            for row in wheel.read(record).decode().splitlines():
                file, digest, _ = row.rsplit(",", 2)
                if digest:
                    made = base64.urlsafe_b64encode(hashlib.sha256(wheel.read(file)).digest()).rstrip(b"=").decode()
                    self.assertEqual(digest, "sha256=" + made, file)
        for source in [*Path(SOURCE, "api/python/cvtflow").iterdir(), Path("_cvtflow.pyi")]:
            if source.suffix in (".py", ".pyi", ".typed") or source.name == "py.typed":
                self.assertIn(f"cvtflow/{source.name}", names)
        program = """import cvtflow
print(cvtflow.__file__, cvtflow.Simulation(cvtflow.Scene.ready("tiny")).size())
simulation = cvtflow.Simulation(cvtflow.Scene.ready("tiny").with_("start.settling_time=20 us", "start.ramp_time=10 us"))
with cvtflow.Recording(simulation, "r.h5"):
    simulation.advance_to("20 us")
cvtflow.Record("r.h5").plot("slip").savefig("r.png")
cvtflow.report("r.h5", "r.html")"""
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=self.folder,
                              env={"PYTHONPATH": str(site), "LD_LIBRARY_PATH": str(site / "cvtflow/lib"), "LC_ALL": "C"})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(done.stdout.startswith(str(site)), done.stdout)
        self.assertIn('data-channel="slip"', Path(self.folder, "r.html").read_text())

    @unittest.skipUnless(DEEP, "deep")
    def test_a_bundle_contains_all_libraries_that_not_every_distribution_has(self):
        name = build_backend.build_wheel(self.folder, {"bundle": "ON"})
        self.assertRegex(name, r"-manylinux_2_\d+_\w+\.whl$")
        site = Path(self.folder, "site")
        with zipfile.ZipFile(Path(self.folder, name)) as wheel:
            self.assertIn(f"Tag: {name[:-4].split('-', 2)[2]}\n", wheel.read(next(n for n in wheel.namelist() if n.endswith("/WHEEL"))).decode())
            wheel.extractall(site)
        libraries = site / "cvtflow/lib"
        listed = subprocess.run(["ldd", next(libraries.glob("libcvtflow.so.*"))], capture_output=True, text=True,
                                env={"LD_LIBRARY_PATH": str(libraries)}).stdout  # a build for a bundle has the path in its libraries
        outside = [line.split()[0] for line in listed.splitlines() if "=> /" in line and str(libraries) not in line]
        self.assertRegex(" ".join(outside), r"\blibc\.so")
        self.assertIn("libhdf5", listed)
        self.assertEqual([each for each in outside if not build_backend.EVERYWHERE.match(each)], [])


main() if __name__ == "__main__" else None
