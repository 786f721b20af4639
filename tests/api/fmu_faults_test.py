"""An FMU under calls that are wrong: NULL for every pointer, faults within a step, damaged snapshots. Needs nothing but Python's standard
library and nm.

    tests/api/fmu_faults_test.py CVTFLOW
"""

import contextlib
import ctypes
import os
import subprocess
import tempfile
import unittest

from fmu_stages_test import DEEP, ERROR, OK, WARNING, Fmu

# Arguments after the instance: i number, d time, b flag, n count, r a value reference, p pointer, s a state.
STATES = {"GetFMU{}": "p", "SetFMU{}": "s", "FreeFMU{}": "p", "SerializedFMU{}Size": "sp", "SerializeFMU{}": "spN"}
PLAIN = {name: "" for name in ("ExitInitializationMode", "Terminate", "Reset")}
FMI2 = {**PLAIN, **{name.format("state"): kinds for name, kinds in STATES.items()}, "DeSerializeFMUstate": "pnp", "SetDebugLogging": "inp",
        "SetupExperiment": "iddid", "EnterInitializationMode": "", "GetReal": "pnp", "SetReal": "pnp", "DoStep": "ddi", "GetRealStatus": "2p",
        **{way + kind: "pnp" for way in ("Get", "Set") for kind in ("Integer", "Boolean", "String")}, "CancelStep": "",
        "GetDirectionalDerivative": "pnpnpp", "SetRealInputDerivatives": "pnpp", "GetRealOutputDerivatives": "pnpp",
        **{f"Get{kind}Status": "ip" for kind in ("", "Integer", "Boolean", "String")}}
TYPES3 = [f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)] + ["Float32", "Float64", "Boolean", "String"]
FMI3 = {**PLAIN, **{name.format("State"): kinds for name, kinds in STATES.items()}, "DeserializeFMUState": "pnp", "SetDebugLogging": "bnp",
        "EnterInitializationMode": "bddbd", "DoStep": "ddbpppp", **{way + kind: "pnpn" for way in ("Get", "Set") for kind in TYPES3},
        "GetNumberOfVariableDependencies": "rp", "GetBinary": "pnppn", "SetBinary": "pnppn", "GetClock": "pnp", "SetClock": "pnp",
        "GetVariableDependencies": "rppppn", "GetDirectionalDerivative": "pnpnpnpn", "GetAdjointDerivative": "pnpnpnpn",
        "GetOutputDerivatives": "pnppn", "GetIntervalDecimal": "pnpp", "GetIntervalFraction": "pnppp", "GetShiftDecimal": "pnp",
        "GetShiftFraction": "pnpp", "SetIntervalDecimal": "pnp", "SetIntervalFraction": "pnpp", "SetShiftDecimal": "pnp",
        "SetShiftFraction": "pnpp", "UpdateDiscreteStates": "pppppp", "ActivateModelPartition": "rd", "CompletedIntegratorStep": "bpp",
        "SetTime": "d", "SetContinuousStates": "pn", "GetContinuousStateDerivatives": "pn", "GetEventIndicators": "pn",
        "GetContinuousStates": "pn", "GetNominalsOfContinuousStates": "pn", "GetNumberOfEventIndicators": "p",
        "GetNumberOfContinuousStates": "p", **{name: "" for name in (
            "EnterEventMode", "EnterStepMode", "EnterConfigurationMode", "ExitConfigurationMode", "EvaluateDiscreteStates",
            "EnterContinuousTimeMode")}}
MAKERS = {2: {"Instantiate": "p1pppbb"}, 3: {"InstantiateCoSimulation": "pppbbbbpnppp", "InstantiateModelExchange": "pppbbpp",
                                             "InstantiateScheduledExecution": "pppbbppppp"}}
FUNCTIONS = {2: FMI2, 3: FMI3}
VERSIONS = (2, 3) if DEEP else (3,)
UPDATE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_double, *[ctypes.c_bool] * 4, ctypes.POINTER(ctypes.c_bool),
                          ctypes.POINTER(ctypes.c_double))


def argument(kind, null, state):
    if kind in "ps":
        pointer = state if kind == "s" else ctypes.create_string_buffer(1 << 20)
        return None if null else pointer
    return {"i": ctypes.c_int(1), "1": ctypes.c_int(1), "2": ctypes.c_int(2), "d": ctypes.c_double(0.0), "b": ctypes.c_bool(False), "n": ctypes.c_size_t(1),
            "N": ctypes.c_size_t(1 << 20), "r": ctypes.c_uint32(0)}[kind]


def outcome(action):
    """Result of `action` in a separate process; a crash is its signal's number below 0."""
    child = os.fork()
    if child == 0:
        status = 100
        with contextlib.suppress(Exception):
            status = action()
        os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def ready(folder, version, **more):
    fmu = Fmu(folder, version, **more)
    assert [fmu.setup(), fmu.enter(), fmu.exit()] == [OK] * 3
    return fmu


def name_of(fmu, name):
    return name if fmu.version == 3 else name.replace("State", "state").replace("Deserialize", "DeSerialize")


def snapshot(fmu):
    state = ctypes.c_void_p(None)
    assert fmu.call(name_of(fmu, "GetFMUState"), ctypes.byref(state)) == OK
    return state


def each_version(test):
    """A test for each version of the standard, with a folder."""
    def tests(self):
        for version in VERSIONS:
            with self.subTest(fmi=version), tempfile.TemporaryDirectory() as folder:
                test(self, folder, version)

    return tests


class Null(unittest.TestCase):
    @each_version
    def test_every_function_is_in_the_table(self, folder, version):
        lines = subprocess.run(["nm", "-D", "--defined-only", Fmu(folder, version).library._name], capture_output=True, text=True, check=True).stdout
        names = {line.split()[-1][4:] for line in lines.splitlines() if line.split()[-1].startswith(f"fmi{version}")}
        plain = {"GetVersion", "FreeInstance"} | ({"GetTypesPlatform"} if version == 2 else set())
        self.assertEqual(names, {*FUNCTIONS[version], *MAKERS[version], *plain})

    @each_version
    def test_null_for_any_pointer_is_an_error(self, folder, version):
        fmu = ready(folder, version)
        state = snapshot(fmu)
        for name, kinds in FUNCTIONS[version].items():
            pointers = [index for index, kind in enumerate(kinds) if kind in "ps"]
            for nulls in [[index] for index in pointers] + [pointers] * (len(pointers) > 1):
                values = [argument(kind, index in nulls, state) for index, kind in enumerate(kinds)]
                with self.subTest(name=name, nulls=nulls):
                    self.assertEqual(outcome(lambda: fmu.call(name, *values)), ERROR)

    @each_version
    def test_no_instance_is_an_error(self, folder, version):
        fmu = ready(folder, version)
        for name, kinds in FUNCTIONS[version].items():
            values = [argument(kind, False, None) for kind in kinds]
            with self.subTest(name=name):
                self.assertEqual(outcome(lambda: fmu.function(name)(None, *values)), ERROR)
        self.assertEqual(outcome(lambda: fmu.function("FreeInstance")(None) and OK), OK)

    @each_version
    def test_no_instance_is_made_of_nulls(self, folder, version):
        fmu = ready(folder, version)
        for name, kinds in MAKERS[version].items():
            make = fmu.function(name)
            make.restype = ctypes.c_void_p
            nulls = [argument(kind, True, None) for kind in kinds]
            with self.subTest(name=name):
                self.assertEqual(outcome(lambda: OK if make(*nulls) is None else 1), OK)

    @each_version
    def test_no_values_need_no_pointers(self, folder, version):
        none = ctypes.c_size_t(0)
        name, more = ("GetReal", []) if version == 2 else ("GetFloat64", [none])
        self.assertEqual(ready(folder, version).call(name, None, none, None, *more), OK)


class Faults(unittest.TestCase):
    """A clamping force of 1e7 N ends a step of tiny early on."""

    LENGTH = 0.02

    @each_version
    def test_the_last_successful_time_is_before_the_step_that_failed(self, folder, version):
        fmu = ready(folder, version)
        self.assertEqual([fmu.step(0.0, 1e-5), fmu.set("clamping_driving", 1e7), fmu.step(1e-5, self.LENGTH)], [OK, OK, ERROR])
        if version == 2:
            self.assertEqual(fmu.call("GetRealStatus", 2, ctypes.byref(fmu.reached)), OK)
        self.assertEqual(fmu.reached.value, 1e-5)

    def test_nothing_calls_back_after_a_fault(self):
        with tempfile.TemporaryDirectory() as folder:
            seen = []
            fmu = Fmu(folder, 3, update=UPDATE(lambda _, time, *more: seen.append(time)))
            self.assertEqual([fmu.set("tip.friction_coefficient", 0.08), fmu.enter()], [OK, OK])
            state = snapshot(fmu)  # its start has not settled yet: the initialisation steps
            self.assertEqual([fmu.exit(), fmu.set("clamping_driving", 1e7), fmu.step(0.0, self.LENGTH)], [OK, OK, ERROR])
            before = len(seen)
            self.assertEqual(outcome(lambda: fmu.call("SetFMUState", state) or fmu.exit()), OK)
            self.assertEqual([fmu.call("SetFMUState", state), fmu.exit()], [OK, OK])
            self.assertEqual(len(seen), before)

    @each_version
    def test_a_time_that_a_step_cannot_change_is_an_error(self, folder, version):
        for start in (1e300, float("nan"), float("inf")):
            fmu = Fmu(f"{folder}/{start}", version)
            self.assertIn(ERROR, [fmu.setup(start), fmu.enter(start), fmu.exit(), fmu.step(start, 1e-5)], start)
        self.assertEqual(ready(f"{folder}/late", version).step(0.0, 1e300), ERROR)  # it would not end


class Unreliable(unittest.TestCase):
    @each_version
    def test_a_step_that_makes_results_unreliable_warns_once(self, folder, version):
        fmu = ready(folder, version, more=("--method", "rk4", "--step", "140 ns", "--set", "start.settling_time=5 ms"))
        state, one, reference = snapshot(fmu), ctypes.c_size_t(1), (ctypes.c_uint * 1)(fmu.references["unreliable"])

        def unreliable():
            flag = (ctypes.c_int if version == 2 else ctypes.c_bool)()
            room = [one] if version == 3 else []
            self.assertEqual(fmu.call("GetBoolean", reference, one, ctypes.byref(flag), *room), OK)
            return bool(flag.value)

        for _ in range(2):  # also after the return to a reliable state
            self.assertFalse(unreliable())
            statuses = [fmu.step(2e-4 * number, 2e-4) for number in range(10)]
            self.assertEqual(sorted(statuses), [OK] * 9 + [WARNING])
            self.assertTrue(unreliable())
            self.assertEqual(fmu.call(name_of(fmu, "SetFMUState"), state), OK)


class Callbacks(unittest.TestCase):
    """What a callback of a step must not do to its instance."""

    def test_only_values_are_exchanged_within_a_step(self):
        with tempfile.TemporaryDirectory() as folder:
            seen = []

            def update(_, time, *more):
                seen.append((fmu.get("time") == time, fmu.call("Reset"), fmu.call("SetFMUState", state), fmu.call("Terminate"), fmu.step(time, 1e-5),
                             fmu.call("GetFMUState", ctypes.byref(ctypes.c_void_p(None)))))

            fmu = ready(folder, 3, update=UPDATE(update))
            state = snapshot(fmu)
            self.assertEqual(fmu.step(0.0, 5e-5), OK)
            self.assertEqual(set(seen), {(True, *[ERROR] * 5)})
            self.assertEqual(fmu.step(5e-5, 5e-5), OK)

    def test_an_instance_freed_within_a_step_ends_with_it(self):
        with tempfile.TemporaryDirectory() as folder:
            seen = []

            def update(_, time, *more):
                seen.append(time)
                fmu.call("FreeInstance")

            fmu = ready(folder, 3, update=UPDATE(update))
            self.assertEqual(outcome(lambda: fmu.step(0.0, 1e-3) or 10 * len(seen)), 10)


class Snapshots(unittest.TestCase):
    @each_version
    def test_every_changed_byte_of_the_head_is_found(self, folder, version):
        fmu = Fmu(folder, version)
        self.assertEqual([fmu.set("tip.friction_coefficient", 0.08), fmu.setup(), fmu.enter()], [OK] * 3)
        state, size = snapshot(fmu), ctypes.c_size_t()
        self.assertEqual(fmu.call(name_of(fmu, "SerializedFMUStateSize"), state, ctypes.byref(size)), OK)
        whole = (ctypes.c_uint8 * size.value)()
        self.assertEqual(fmu.call(name_of(fmu, "SerializeFMUState"), state, whole, size), OK)

        def read(data, length):
            return fmu.call(name_of(fmu, "DeserializeFMUState"), data, ctypes.c_size_t(length), ctypes.byref(ctypes.c_void_p(None)))

        self.assertEqual(read(whole, size.value), OK)
        head = 64  # mark, version, scene and the first fields; the checksum at the end is of all bytes
        self.assertTrue(bytes(whole).startswith(b"CVTSTATE"))
        for place in (*range(head), size.value // 2, size.value - 1):
            changed = (ctypes.c_uint8 * size.value).from_buffer_copy(whole)
            changed[place] ^= 1
            self.assertEqual(read(changed, size.value), ERROR, place)
        for length in (*range(head), size.value - 1):
            self.assertEqual(read(whole, length), ERROR, length)


if __name__ == "__main__":
    unittest.main()
