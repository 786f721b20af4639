"""The tables by which Python calls the library, against cvtflow.h; the core library in place of the full one; how little is imported."""

import ctypes
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from python_fixture import SOURCE, main, program

import cvtflow
from cvtflow import _errors, _library

LETTERS = {"void": "v", "const char*": "s", "cvtflow_code": "i", "int32_t": "i", "double": "d", "size_t": "n", "uint64_t": "u"}
TYPES = {"uint32_t": ctypes.c_uint32, "int32_t": ctypes.c_int32, "int64_t": ctypes.c_int64, "double": ctypes.c_double,
         "size_t": ctypes.c_size_t, "const char*": ctypes.c_char_p, "char": ctypes.c_char}
STRUCTS = {"message": _library.Message, "options": _library.Options, "counters": _library.Counters, "energy": _library.Energy,
           "channel_info": _library.Info, "transition": _library.Transition, "progress": _library.SweepProgress}


def letter(argument):
    kind = re.sub(r" ?\w+$", "", argument.strip())
    return "f" if kind.endswith("_function") else LETTERS.get(kind) or ("p" if kind.endswith("*") else f"?{argument}")


class Header(unittest.TestCase):
    def setUp(self):
        text = re.sub(r"/\*.*?\*/", "", Path(SOURCE, "api/include/cvtflow/cvtflow.h").read_text(), flags=re.S)
        self.text = re.sub(r"\s+", " ", re.sub(r"(?m)^#.*(\\\n.*)*$", "", text))

    def test_has_the_functions_of_the_table(self):
        found = {}
        for result, name, arguments in re.findall(r"CVTFLOW_API ([^;()]*?) ?cvtflow_(\w+)\(([^;]*?)\);", self.text):
            parts = [] if arguments.strip() == "void" else arguments.split(",")
            found[name] = " ".join([LETTERS.get(result) or "p", *map(letter, parts)])
        table = dict(entry.strip().split(" ", 1) for entry in f"{_library.BRIEF}; {_library.LONG}".replace("\n", " ").split(";"))
        self.assertEqual(table, found)
        self.assertGreater(len(table), 40)

    def test_has_the_structs(self):
        found = dict.fromkeys(STRUCTS)
        for body, name in re.findall(r"typedef struct cvtflow_\w+ \{(.*?)\} cvtflow_(\w+);", self.text):
            fields = []
            for kind, names in re.findall(r" ?([\w ]*?\w\*?) (\w+(?:\[\d+\])?(?:, \w+)*);", body):
                for each in names.split(", "):
                    array = re.match(r"(\w+)\[(\d+)\]", each)
                    fields.append((array[1], TYPES[kind] * int(array[2])) if array else (each, TYPES[kind]))
            found[name] = fields
        self.assertEqual(set(found), set(STRUCTS))
        for name, fields in found.items():
            own = [(each.removeprefix("phase_").lstrip("_"), kind) for each, kind in STRUCTS[name]._fields_]
            if name == "message":  # ours has more room
                self.assertEqual(own.pop()[0], fields.pop()[0])
            self.assertEqual(own, fields, name)

    def test_has_the_codes_of_the_exceptions(self):
        self.assertEqual({row["name"] for row in _library.described("codes")}, set(_errors.BY_CODE))
        for row in _library.described("codes"):
            self.assertEqual(issubclass(_errors.BY_CODE[row["name"]], _errors.Fault), row["fault"], row["name"])


class Core(unittest.TestCase):
    """The core library, as packages for Windows have it."""

    CORE = Path(os.environ["CVTFLOW_BUILD"], "libcvtflow-core.so")

    def setUp(self):
        if not self.CORE.exists():
            self.skipTest("the core library is not built")

    def run_with_core(self, program, *words):
        done = subprocess.run([sys.executable, *(words or ["-c", "import cvtflow\n" + program])], capture_output=True, text=True,
                              env={**os.environ, "CVTFLOW_LIBRARY": str(self.CORE)})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout + done.stderr

    def test_passes_the_tests_of_what_it_has(self):
        for part, classes in (("scene", "Units Channels Faces WrongTypes"), ("simulation", "Calls Running Failing Cost")):
            shown = self.run_with_core("", str(Path(__file__).with_name(f"python_{part}_test.py")), *classes.split())
            self.assertGreater(int(re.search(r"Ran (\d+) tests", shown)[1]), 5)
            self.assertNotIn("skipped", shown)

    def test_simulates_with_the_same_bits(self):
        program = """
scene = cvtflow.Scene.ready("tiny").with_("start.state=", "start.settling_time=20 us", "start.ramp_time=10 us")
simulation = cvtflow.Simulation(scene)
simulation.advance_to("10 us")
state = simulation.state()
other = simulation.copy()
other.advance_to("20 us")
simulation.set_state(state)
simulation.advance_to("20 us")
print(simulation.hash() == other.hash(), simulation.hash(), simulation.channels["slip"], len(cvtflow.ready_scenes()) > 5)
"""
        shown = self.run_with_core(program)
        self.assertTrue(shown.startswith("True "))
        full = subprocess.run([sys.executable, "-c", "import cvtflow\n" + program], capture_output=True, text=True, check=True, cwd=SOURCE).stdout
        self.assertEqual(shown, full)

    def test_reads_records_and_scenes_and_draws_them(self):
        with tempfile.TemporaryDirectory() as folder:
            record = Path(folder, "tiny.h5")
            program("run", "tiny", "--until", "100 us", "-q", "-o", str(record))
            shown = self.run_with_core(f"""
record = cvtflow.Record({str(record)!r})
record.plot("slip").savefig({str(record)!r} + ".svg")
print(record.status, record.rows, cvtflow.Scene.read({SOURCE!r} + "/scenes/tiny.toml") == cvtflow.Scene.ready("tiny"))""")
            self.assertIn(f"{cvtflow.Record(record).status} {cvtflow.Record(record).rows} True\n", shown)  # Matplotlib may say more
            self.assertIn("<svg", Path(folder, "tiny.h5.svg").read_text())

    def test_says_what_it_has_not(self):
        shown = self.run_with_core("""
simulation = cvtflow.Simulation("tiny")
for action in (lambda: cvtflow.Recording(simulation, "r.h5"), lambda: cvtflow.SweepFile.read("s.toml"), cvtflow.shutdown):
    try:
        action()
        print("done")
    except cvtflow.StateError as error:
        print(error)
""")
        self.assertEqual(shown.count("this library has no files and no threads of its own; install cvtflow with its program"), 3, shown)


class Imports(unittest.TestCase):
    def imported(self, program):
        done = subprocess.run([sys.executable, "-c", f"import sys, cvtflow\n{program}\nprint(*sys.modules)"], capture_output=True, text=True,
                              check=True)
        return set(done.stdout.split())

    def test_scenes_and_units_need_no_numpy_and_the_package_alone_no_library(self):
        self.assertNotIn("ctypes", self.imported(""))
        self.assertFalse({"numpy", "h5py", "pandas", "matplotlib"} & self.imported('cvtflow.Scene.ready("tiny")["run.step"]'))


main() if __name__ == "__main__" else None
