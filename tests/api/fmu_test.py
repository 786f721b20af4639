"""FMUs in an importer that others wrote (FMPy, at CVTFLOW_FMPY). Exit status 77: it is not there."""

import itertools
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

FMPY = os.environ.get("CVTFLOW_FMPY", "")
try:
    sys.path.insert(0, FMPY)
    import numpy as np
    from fmpy import extract, read_model_description, simulate_fmu
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave
    from fmpy.validation import validate_fmu
    from lxml import etree
except ImportError as missing:
    print(f"skipped: {missing} (CVTFLOW_FMPY is '{FMPY}')")
    sys.exit(77)

import cvtflow

PROGRAM = os.environ["CVTFLOW_PROGRAM"]
OUTPUTS = ["ratio", "shaft_1/angle", "links/tension"]
STEP = 1e-5  # [s], the time between outputs of tiny


def export(file, version, *more):
    done = subprocess.run([PROGRAM, "export-fmu", "tiny", "-o", file, "--force", "-q", "--fmi", str(version), *more], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def in_process(*settings):
    """The same simulation in this process, settled."""
    simulation = cvtflow.Simulation(cvtflow.Scene.ready("tiny").with_(*settings))
    simulation.advance_to(0.0)
    return simulation


class Slave:
    """One instance, whichever the version."""

    def __init__(self, file, version, start=0.0, name="one", parameters=None, **more):
        self.folder, self.version = tempfile.TemporaryDirectory(prefix="with a space "), version
        extract(file, unzipdir=self.folder.name)
        description = read_model_description(self.folder.name)
        self.references = {row.name: row.valueReference for row in description.modelVariables}
        made = FMU3Slave if version == 3 else FMU2Slave
        self.fmu = made(guid=description.guid, unzipDirectory=self.folder.name, modelIdentifier=description.coSimulation.modelIdentifier,
                        instanceName=name)
        self.fmu.instantiate(**more)
        for key, value in (parameters or {}).items():
            self.set(key, value)
        self.begin(start)

    def begin(self, start):
        if self.version == 3:
            self.fmu.enterInitializationMode(startTime=start)
        else:
            self.fmu.setupExperiment(startTime=start)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, name, value):
        (self.fmu.setFloat64 if self.version == 3 else self.fmu.setReal)([self.references[name]], [value])

    def get(self, name):
        return (self.fmu.getFloat64 if self.version == 3 else self.fmu.getReal)([self.references[name]])[0]

    def step(self, begin, length):
        return self.fmu.doStep(currentCommunicationPoint=begin, communicationStepSize=length)

    def state(self):
        return self.fmu.getFMUState() if self.version == 3 else self.fmu.getFMUstate()

    def set_state(self, state):
        (self.fmu.setFMUState if self.version == 3 else self.fmu.setFMUstate)(state)

    def serialised(self, state):
        return (self.fmu.serializeFMUState if self.version == 3 else self.fmu.serializeFMUstate)(state)

    def deserialised(self, data):
        return (self.fmu.deserializeFMUState if self.version == 3 else self.fmu.deSerializeFMUstate)(data)

    def free(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        self.folder.cleanup()


def both(test):
    """A test for both versions of the standard."""
    def tests(self):
        for version, file in self.files.items():
            with self.subTest(fmi=version):
                test(self, file, version)

    return tests


class Both(unittest.TestCase):
    """Every test for both versions of the standard."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="some fmus ")
        cls.files = {version: f"{cls.folder.name}/tiny {version}.fmu" for version in (2, 3)}
        for version, file in cls.files.items():
            export(file, version, "--outputs", ",".join(OUTPUTS))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def slave(self, *words, **more):
        made = Slave(*words, **more)
        self.addCleanup(made.free)
        return made

    @both
    def test_they_are_valid(self, file, version):
        self.assertEqual(validate_fmu(file), [])
        names, larger = [], f"{self.folder.name}/all.fmu"
        for more in ((), ("--outputs", "all", "--parameters", "all")):
            export(larger, version, *more)
            self.assertEqual(validate_fmu(larger), [])
            names.append({row.name for row in read_model_description(larger).modelVariables})
        self.assertLess({"time", "load_torque", "slip", "efficiency", "shaft_2.speed", "tip.friction_coefficient"}, names[0])
        self.assertLess(names[0], names[1])
        self.assertTrue(len(names[0]) < 35 and len(names[1]) > 120)

    @both
    def test_they_need_nothing_but_the_c_library(self, file, version):
        with zipfile.ZipFile(file) as parts, tempfile.TemporaryDirectory() as folder:
            name = f"binaries/{'x86_64-linux' if version == 3 else 'linux64'}/tiny.so"
            said = subprocess.run(["ldd", parts.extract(name, folder)], capture_output=True, text=True, env={"PATH": os.environ["PATH"]})
            libraries = {line.split()[0].rpartition("/")[2].partition(".")[0] for line in said.stdout.splitlines()}
            self.assertLessEqual(libraries, {"linux-vdso", "libm", "libc", "ld-linux-x86-64"})
            shown = subprocess.run(["nm", "-D", "--defined-only", parts.extract(name, folder)], capture_output=True, text=True).stdout
            self.assertEqual([line for line in shown.splitlines() if not line.split()[-1].startswith(("fmi2", "fmi3"))], [])

    @both
    def test_bits_equal_those_of_the_program(self, file, version):
        record_file = f"{self.folder.name}/record{version}.h5"
        subprocess.run([PROGRAM, "run", "tiny", "--until", "0.2 ms", "-q", "-o", record_file], check=True)
        record = cvtflow.Record(record_file)
        rows = simulate_fmu(file, stop_time=2e-4, step_size=STEP, output_interval=STEP)
        np.testing.assert_array_equal(rows["ratio"], record["ratio"])
        np.testing.assert_array_equal(rows["shaft_1.angle"], record["shaft_1/angle"])
        tension = rows["links.tension"] if version == 3 else np.stack([rows[f"links.tension[{k}]"] for k in range(24)], axis=1)
        np.testing.assert_array_equal(tension.astype(np.float32), record["links/tension"])  # a file has floats there

    @both
    def test_communication_steps_of_any_length_stop_where_the_library_does(self, file, version):
        for lengths in ([3e-6] * 30, [STEP] * 9, [1e-6, 7e-6, 2.3e-5, 4e-7, 5.86e-5]):
            slave, alone, time = self.slave(file, version), in_process(), 0.0
            for length in lengths:
                slave.step(time, length)
                time += length
                alone.advance_to(time)
                for name in ("ratio", "shaft_1.angle"):
                    self.assertEqual(slave.get(name), alone.channel(name.replace(".", "/"))[0])

    @both
    def test_inputs_and_start_times_count(self, file, version):
        slave, late = self.slave(file, version), self.slave(file, version, start=2.0)
        alone = in_process()
        for simulation in (slave, late):
            simulation.set("load_torque", 5.0)
        alone.set_input("load_torque", 5.0)
        alone.advance_to(STEP)
        slave.step(0.0, STEP)
        late.step(2.0, STEP)
        self.assertEqual(slave.get("load_torque"), 5.0)
        self.assertEqual(slave.get("ratio"), alone.channel("ratio")[0])
        self.assertAlmostEqual(late.get("ratio"), slave.get("ratio"), delta=1e-9)  # 2 + 1e-5 - 2 is not 1e-5

    @both
    def test_two_instances_do_not_know_each_other(self, file, version):
        one, other = self.slave(file, version, name="one"), Slave(file, version, name="other")
        other.set("load_torque", 5.0)
        for number in range(5):
            one.step(number * STEP, STEP)
            other.step(number * STEP, STEP)
        other.free()
        alone = self.slave(file, version)
        for number in range(5):
            alone.step(number * STEP, STEP)
        self.assertEqual(one.get("ratio"), alone.get("ratio"))

    @both
    def test_states_are_restored_also_into_another_instance(self, file, version):
        slave = self.slave(file, version)
        slave.step(0.0, STEP)
        slave.set("load_torque", 7.0)
        state = slave.state()
        data = slave.serialised(state)
        slave.step(STEP, STEP)
        expected = slave.get("ratio")
        slave.set_state(state)
        slave.step(STEP, STEP)
        self.assertEqual(slave.get("ratio"), expected)
        other = self.slave(file, version)
        other.set_state(other.deserialised(data))
        self.assertEqual(other.get("load_torque"), 7.0)
        other.step(STEP, STEP)
        self.assertEqual(other.get("ratio"), expected)

    def test_a_parameter_changes_the_machine_which_settles_anew(self):
        slave = self.slave(self.files[3], 3, parameters={"tip.friction_coefficient": 0.08})
        self.assertEqual(slave.get("tip.friction_coefficient"), 0.08)
        self.assertEqual(slave.get("ratio"), in_process("tip.friction_coefficient=0.08", 'start.state=""').channel("ratio")[0])
        self.assertRaises(Exception, slave.set, "tip.friction_coefficient", 0.09)  # too late

    @both
    def test_importers_are_told_what_is_wrong(self, file, version):
        slave = self.slave(file, version)
        for action in (lambda: slave.set("ratio", 1.0), lambda: slave.set("clamping_driving", -1.0), lambda: slave.step(1.0, STEP)):
            self.assertRaises(Exception, action)
        slave.step(0.0, STEP)  # and goes on

    @both
    def test_they_are_loaded_and_unloaded_a_hundred_times(self, file, version):
        first = None
        for _ in range(100):
            slave = Slave(file, version)
            slave.step(0.0, 1e-6)
            first = first or slave.get("ratio")
            self.assertEqual(slave.get("ratio"), first)
            slave.free()
        self.assertNotIn("tiny.so", Path("/proc/self/maps").read_text())

    def test_a_step_ends_where_the_importer_asks(self):
        """Of FMI 3.0 alone."""
        seen = []

        def update(_environment, time, _set, get_allowed, _finished, can_return, requested, _when):
            seen.append((time, get_allowed, can_return))
            if len(seen) == 3:
                requested[0] = True

        slave = self.slave(self.files[3], 3, earlyReturnAllowed=True, intermediateUpdate=update)
        _, _, early, reached = slave.step(0.0, 1e-4)
        self.assertTrue(early)
        self.assertAlmostEqual(reached, 3 * STEP, delta=1e-12)
        self.assertEqual([row[1:] for row in seen], [(True, True)] * 3)
        slave.step(reached, STEP)


class Vehicle(unittest.TestCase):
    """The example of a vehicle behind shaft 2, coupled every millisecond."""

    EXAMPLE = str(Path(__file__).resolve().parents[2] / "examples/python/vehicle.py")

    def run_example(self, *words):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([FMPY, os.environ.get("PYTHONPATH", "")])}
        done = subprocess.run([sys.executable, self.EXAMPLE, *words], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        complaint = "Failed to add logger proxy function"  # by FMPy, where its compiled part is missing
        return "".join(line for line in done.stdout.splitlines(keepends=True) if not line.startswith(complaint))

    def test_as_fmu_it_is_what_it_is_in_this_process(self):
        with tempfile.TemporaryDirectory() as folder:
            scene, file = f"{folder}/vehicle.toml", f"{folder}/vehicle.fmu"
            command = self.run_example("--scene", scene).split()
            self.assertEqual(command[:3], ["cvtflow", "export-fmu", scene])
            outputs = command[command.index("--outputs") + 1]
            subprocess.run([PROGRAM, "export-fmu", scene, "-o", file, "-q", "--outputs", outputs], check=True)
            self.assertEqual(self.run_example("5", "--fmu", file), self.run_example("5"))


class Description(unittest.TestCase):
    """What importers show."""

    def parts(self, version, *more, environment=None):
        """Roots of the XML files in an FMU, by their names."""
        with tempfile.TemporaryDirectory() as folder:
            command = [PROGRAM, "export-fmu", "tiny", "-o", f"{folder}/one.fmu", "-q", "--fmi", str(version), *more]
            subprocess.run(command, check=True, env={**os.environ, **(environment or {})})
            with zipfile.ZipFile(f"{folder}/one.fmu") as file:
                return {name: etree.fromstring(file.read(name)) for name in file.namelist() if name.endswith(".xml")}

    def test_all_xml_follows_the_schemas_of_the_standard(self):
        everything = ["--outputs", "all", "--parameters", "all", "--set", "control.enabled=true"]
        for version, more in itertools.product((2, 3), ([], everything)):
            for name, root in self.parts(version, *more).items():
                kind = {"modelDescription.xml": "ModelDescription", "terminalsAndIcons/terminalsAndIcons.xml": "TerminalsAndIcons"}[name]
                schema = etree.XMLSchema(file=f"{FMPY}/fmpy/schema/fmi{version}/fmi{version}{kind}.xsd")
                self.assertTrue(schema.validate(root), (version, more, name, schema.error_log))

    def test_names_are_structured_and_unique(self):
        grammar = re.compile(r"[A-Za-z_]\w*(\[\d+\])?(\.[A-Za-z_]\w*(\[\d+\])?)*")
        root = self.parts(2, "--outputs", "all", "--set", "control.enabled=true")["modelDescription.xml"]
        self.assertEqual(root.get("variableNamingConvention"), "structured")
        names = [row.get("name") for row in root.iter("ScalarVariable")]
        self.assertEqual([name for name in names if not grammar.fullmatch(name)], [])
        self.assertEqual(len(names), len(set(names)))
        self.assertLess({"ratio", "ratio_target"}, set(names))
        elements = [row.get("name") for row in self.parts(2, "--outputs", "links/tension")["modelDescription.xml"].iter("ScalarVariable")]
        self.assertLess({"links.tension[0]", "links.tension[23]"}, set(elements))

    def test_numbers_have_their_range_magnitude_and_units(self):
        root = self.parts(3, "--outputs", "all")["modelDescription.xml"]
        shown = {(unit.get("name"), row.get("name")): float(row.get("factor")) for unit in root.iter("Unit") for row in unit.iter("DisplayUnit")}
        self.assertAlmostEqual(shown["rad/s", "rpm"], 60 / (2 * math.pi))
        rows = {row.get("name"): row.attrib for row in root.iter("Float64")}
        for row in rows.values():
            self.assertIn((row.get("unit"), row["displayUnit"]) if "displayUnit" in row else ("rad/s", "rpm"), shown)
            self.assertGreater(float(row.get("nominal", 1)), 0.0)
            if row["causality"] in ("input", "parameter"):
                self.assertLessEqual(float(row["min"]), float(row["start"]))
                self.assertLessEqual(float(row["start"]), float(row["max"]))
        self.assertEqual(rows["tip.friction_coefficient"]["nominal"], "0.01")
        self.assertEqual(float(rows["load_torque"]["start"]), 12.0)

    def test_page_licence_and_icon_are_where_the_standard_has_them(self):
        places = {2: {"model.png"}, 3: {"terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"}}
        for version, icons in places.items():
            with self.subTest(fmi=version), tempfile.TemporaryDirectory() as folder:
                export(f"{folder}/one.fmu", version)
                with zipfile.ZipFile(f"{folder}/one.fmu") as file:
                    self.assertLessEqual(icons | {"documentation/index.html", "documentation/licenses/license.txt"}, set(file.namelist()))
                    self.assertTrue(all(file.read(icon).startswith((b"\x89PNG", b"<svg")) for icon in icons))
                    page, licences = (file.read(f"documentation/{name}").decode() for name in ("index.html", "licenses/license.txt"))
                for name in ("tip.friction_coefficient", "unreliable", "shaft_2.speed"):
                    self.assertIn(f"<td>{name}</td>", page)
                for text in ("Apache License", "Niels Lohmann", "Victor Zverovich", "Mark Gillard"):
                    self.assertIn(text, licences)

    def test_author_and_date_are_stated(self):
        plain = self.parts(3)["modelDescription.xml"]
        self.assertIsNone(plain.get("author"))
        self.assertRegex(plain.get("generationDateAndTime"), r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ$")  # of the commit
        stated = self.parts(3, "--author", "A & B", environment={"SOURCE_DATE_EPOCH": "1700000000"})["modelDescription.xml"]
        self.assertEqual((stated.get("author"), stated.get("generationDateAndTime")), ("A & B", "2023-11-14T22:13:20Z"))
        wrong = subprocess.run([PROGRAM, "export-fmu", "tiny", "-o", "/dev/null"], capture_output=True, text=True,
                               env={**os.environ, "SOURCE_DATE_EPOCH": "today"})
        self.assertNotEqual(wrong.returncode, 0)


class Exporting(unittest.TestCase):
    def test_the_same_scene_makes_the_same_file(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("one", "other"):
                export(f"{folder}/{name}", 3)
            self.assertEqual(Path(folder, "one").read_bytes(), Path(folder, "other").read_bytes())


if __name__ == "__main__":
    unittest.main(verbosity=2)
