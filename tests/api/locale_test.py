"""FMU, C interface and Python in a host with a decimal comma, which Qt and GTK hosts set: the same numbers as in "C".

    tests/api/locale_test.py CVTFLOW LIBRARY SCENES COMPILER      with or without the Python package (PYTHONPATH)
"""

import ctypes
import locale
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

# A locale with a decimal comma for tests, compiled into a temporary folder: no package of the system is needed.
NAME = "de_DE.UTF-8"


def restart_with_decimal_comma():
    """Starts this test anew with LOCPATH set, since the C library reads it once. Exit status 77: there is no localedef."""
    if "CVTFLOW_LOCALE" in os.environ:
        return
    if shutil.which("localedef") is None:
        print("skipped: no localedef (Debian: libc-bin, locales)")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", f"{folder}/{NAME}"], capture_output=True, text=True)
        if not os.path.exists(f"{folder}/{NAME}/LC_NUMERIC"):
            print(f"skipped: localedef cannot compile {NAME} (Debian: locales): {made.stderr.strip()}")
            sys.exit(77)
        environment = {**os.environ, "LOCPATH": folder, "CVTFLOW_LOCALE": NAME, "PYTHONUTF8": "1"}
        sys.exit(subprocess.run([sys.executable, *sys.argv], env=environment).returncode)


restart_with_decimal_comma()
PROGRAM, LIBRARY, SCENES, COMPILER = sys.argv[1:5]
SOURCE = pathlib.Path(__file__).resolve().parent
del sys.argv[1:]
sys.argv.append(PROGRAM)  # of fmu_stages_test
from fmu_stages_test import DEEP, OK, Fmu  # noqa: E402

try:
    import cvtflow
except ImportError:
    cvtflow = None
FRICTION = "plate.friction_coefficient"


def in_both(action):
    """Results of an action in "C" and with a decimal comma."""
    results = []
    for name in ("C", NAME):
        locale.setlocale(locale.LC_ALL, name)
        try:
            results.append(action())
        finally:
            locale.setlocale(locale.LC_ALL, "C")
    return results


class DecimalComma(unittest.TestCase):
    def test_it_is_the_locale_of_these_tests(self):
        libc = ctypes.CDLL(None)
        libc.strtod.restype = ctypes.c_double
        self.assertEqual(in_both(lambda: libc.strtod(b"0,5", None)), [0.0, 0.5])

    def fmu_values(self, version):
        """Status and value of a parameter as it is, after 0 and after 0.08; then the machine after a step."""
        with tempfile.TemporaryDirectory() as folder:
            fmu = Fmu(folder, version)
            values = [fmu.get(FRICTION)]
            for value in (0.0, 0.08):
                values += [fmu.set(FRICTION, value), fmu.get(FRICTION)]
            values += [fmu.setup(), fmu.enter(), fmu.exit(), fmu.step(0.0, 1e-5), fmu.get("ratio"), fmu.get("slip")]
            fmu.call("FreeInstance")
            return values

    def test_parameters_of_an_fmu_are_read_and_set_also_to_zero(self):
        for version in (2, 3) if DEEP else (3,):
            with self.subTest(fmi=version):
                plain, comma = in_both(lambda: self.fmu_values(version))
                self.assertEqual(plain[:9], [0.1, OK, 0.0, OK, 0.08, OK, OK, OK, OK])
                self.assertEqual(comma, plain)

    def test_an_importer_in_c_reads_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            fmu, steps = Fmu(folder, 3), f"{folder}/fmu_steps"
            subprocess.run([COMPILER, "-std=c11", "-D_GNU_SOURCE", str(SOURCE / "fmu_steps.c"), "-o", steps, "-ldl"], check=True)
            read = [str(fmu.references[name]) for name in (FRICTION, "ratio", "slip")]
            command = [steps, fmu.library._name, f"{folder}/fmi3/resources", "3", "4", "1e-5", str(fmu.references["load_torque"]), "5", *read]

            def run(name):
                return subprocess.run(command, check=True, capture_output=True, env={**os.environ, "LC_ALL": name}).stdout

            self.assertEqual(run(NAME), run("C"))

    def test_the_c_interface_reads_scenes_and_writes_errors_alike(self):
        cvt = ctypes.CDLL(LIBRARY)
        cvt.cvtflow_time.restype = ctypes.c_double

        class Message(ctypes.Structure):
            _fields_ = [("size", ctypes.c_uint32), ("code", ctypes.c_int32), ("text", ctypes.c_char * 1016)]

        def run():
            message, scene, brief, simulation = Message(ctypes.sizeof(Message)), *(ctypes.c_void_p() for _ in range(3))
            texts = (ctypes.c_char_p * 3)(b"start.settling_time=0.3 ms", b"start.ramp_time=0.3 ms", b"plate.friction_coefficient=0.125")
            cvt.cvtflow_scene_read(f"{SCENES}/tiny.toml".encode(), ctypes.byref(scene), ctypes.byref(message))
            cvt.cvtflow_scene_with(scene, texts, ctypes.c_size_t(3), ctypes.byref(brief), ctypes.byref(message))
            self.assertEqual(message.text, b"")
            cvt.cvtflow_create(brief, None, ctypes.byref(simulation), ctypes.byref(message))
            cvt.cvtflow_advance_to(simulation, ctypes.c_double(-2.5e-4), ctypes.byref(message))
            reached = cvt.cvtflow_time(simulation)
            cvt.cvtflow_advance_to(simulation, ctypes.c_double(-1.5), ctypes.byref(message))
            self.assertIn(b"-1.5 s is before", message.text)
            cvt.cvtflow_destroy(simulation)
            return reached, message.text

        plain, comma = in_both(run)
        self.assertEqual(comma, plain)

    @unittest.skipIf(cvtflow is None, "no Python package")
    def test_python_reads_scenes_and_ends_by_ctrl_c_alike(self):
        def run():
            simulation = cvtflow.Simulation(cvtflow.Scene.ready("tiny").with_("run.output_interval=2.5e-05 s"))
            simulation.advance_to("0.1 ms")
            bits, timer = simulation.hash(), threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                simulation.advance_to("30 ms")  # seconds of wall time
            self.assertLess(simulation.time, 20e-3)
            with self.assertRaises(cvtflow.Error) as refused:
                cvtflow.Scene.ready("tiny").with_(FRICTION + "=0,08")
            return bits, str(refused.exception), cvtflow.Scene.ready("tiny").value(FRICTION)

        plain, comma = in_both(run)
        self.assertEqual(comma, plain)

    def test_the_program_prints_the_same(self):
        def run(name):
            command = [PROGRAM, "run", "tiny", "--until", "20 us", "-o", "none"]
            done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": name})
            self.assertEqual(done.returncode, 0, done.stderr)
            return [line for line in done.stdout.splitlines() if line.strip().startswith(("strand", "torque", "speed ratio", "slip", "creep", "state"))]

        self.assertEqual(run(NAME), run("C"))
        self.assertEqual(len(run("C")), 6)


if __name__ == "__main__":
    unittest.main()
