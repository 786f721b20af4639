"""The reduced model in C (reduced.c): its variables, its table, its FMUs. A C compiler makes them."""

import ctypes
import math
import os
import shutil
import subprocess
import tempfile
import uuid
from html import escape

import numpy as np

from . import _fmu

VALUES = ("thrust", "slip", "loss", "shift", "tips", "tight", "slack", "limit")  # of a point of the map, as reduced.c numbers them
# Enumerator in C, name, unit, causality, start value (None: of the map), meaning.
VARIABLES = [
    ("SPEED_1", "speed_1", "rad/s", "input", None, "speed of shaft 1; with drive_mode 1 its start value"),
    ("TORQUE_1", "torque_1", "N.m", "input", 0.0, "torque of the drive on shaft 1, with drive_mode 1"),
    ("TORQUE_2", "torque_2", "N.m", "input", None, "torque of the load against shaft 2; negative: shaft 2 drives"),
    ("CLAMPING_1", "clamping_1", "N", "input", None, "clamping force of shaft 1, with shift_mode 0"),
    ("CLAMPING_2", "clamping_2", "N", "input", None, "clamping force of shaft 2"),
    ("RATIO_TARGET", "ratio_target", "1", "input", 1.0, "target of the ratio, with shift_mode 1"),
    ("DRIVE_MODE", "drive_mode", "1", "parameter", 0.0, "0: speed_1 is given; 1: torque_1 is, and the speed is a state"),
    ("SHIFT_MODE", "shift_mode", "1", "parameter", 0.0, "0: clamping_1 is given; 1: ratio_target is, and clamping_applied follows"),
    ("RATIO_START", "ratio_start", "1", "parameter", 1.0, "ratio at the start"),
    ("INERTIA_1", "inertia_1", "kg.m2", "parameter", None, "moment of inertia of shaft 1 and what turns with it"),
    ("INERTIA_2", "inertia_2", "kg.m2", "parameter", None, "moment of inertia of shaft 2 and what turns with it"),
    ("TIME_CONSTANT", "time_constant", "s", "parameter", 0.1, "time in which the ratio follows its target"),
    ("CLAMPING_LIMIT", "clamping_limit", "N", "parameter", None, "largest clamping force of shaft 1, with shift_mode 1"),
    ("RATIO", "ratio", "1", "output", None, "speed of shaft 1 over that of shaft 2"),
    ("SLIP_OUT", "slip", "1", "output", None, "slip of the chain on both pulleys"),
    ("EFFICIENCY", "efficiency", "1", "output", None, "power out over power in; 0 without load"),
    ("SHAFT_1_SPEED", "shaft_1.speed", "rad/s", "output", None, "speed of shaft 1"),
    ("SHAFT_2_SPEED", "shaft_2.speed", "rad/s", "output", None, "speed of shaft 2"),
    ("DRIVE_TORQUE", "shaft_1.torque", "N.m", "output", None, "torque that the chain takes from shaft 1, mean over the last 1 ms"),
    ("LIMIT_2", "shaft_2.torque_limit", "N.m", "output", None,
     "load from which the chain slips; where no load of the map does: 2 mu S_2 r_2/cos(beta)"),
    ("APPLIED", "clamping_applied", "N", "output", None, "clamping force of shaft 1"),
    ("CLAMPING_BALANCE", "clamping_balance", "N", "output", None, "clamping force of shaft 1 that would keep the ratio"),
    ("TIGHT_TENSION", "tight_tension", "N", "output", None, "tension of the tight strand"),
    ("SLACK_TENSION", "slack_tension", "N", "output", None, "tension of the slack strand"),
    ("LOSSES", "loss", "W", "output", None, "power of all losses of the chain, mean over the last 1 ms"),
    ("TIP_LOSSES", "loss_tips", "W", "output", None, "power that the tips lose"),
    ("OUTSIDE", "outside", "1", "output", None, "sum of what is outside the map, whose edge counts: 1 ratio, 2 load, 4 clamping, 8 speed"),
    ("TIME", "time", "s", "independent", None, "time"),
]
_UNITS = {"rad/s": {"rad": 1, "s": -1}, "N.m": {"kg": 1, "m": 2, "s": -2}, "N": {"kg": 1, "m": 1, "s": -2}, "kg.m2": {"kg": 1, "m": 2},
          "s": {"s": 1}, "W": {"kg": 1, "m": 2, "s": -3}}
_SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "reduced.c")


def _numbers(values):
    return "{" + ", ".join(f"{value:.9g}" for value in values) + "}"


def _axis(values):
    return _numbers([*values, *(1.0 / np.diff(values))])


def _nested(table):
    return _numbers(table) if table.ndim == 1 else "{" + ",\n".join(_nested(each) for each in table) + "}"


class Small:
    """A map with its shift law as C, its library, and its FMUs."""

    def __init__(self, machine, axes, values, scene):
        self.axes = axes
        middle = {name: float(axes[name][len(axes[name]) // 2]) for name in ("speed", "clamping")}
        shaft = 2 * scene["pulley.sheave_polar_inertia"] + scene["pulley.shaft_polar_inertia"]
        start = {"speed_1": middle["speed"], "clamping_2": middle["clamping"], "clamping_1": middle["clamping"],
                 "torque_2": 0.5 * machine.limit(1.0, middle["clamping"]), "inertia_1": shaft + scene["drive.inertia"],
                 "inertia_2": shaft + scene["load.inertia"], "clamping_limit": float(axes["clamping"][-1] * 1.5)}
        self.start = [start.get(name, value) if value is None else value for _, name, _, _, value, _ in VARIABLES]
        self.start = [0.0 if value is None else value for value in self.start]
        table = np.stack([values[name] for name in VALUES], axis=-1)
        sizes = {"SPEEDS": "speed", "CLAMPINGS": "clamping", "RATIOS": "ratio", "LOADS": "load"}
        self.identity = "{" + str(uuid.uuid5(uuid.NAMESPACE_URL, table.tobytes().hex()[:4096] + str(table.sum()))) + "}"
        factors = [machine.limit(ratio, 1.0) for ratio in axes["ratio"]]
        settable = sum(row[3] in ("input", "parameter") for row in VARIABLES)
        self.header = "\n".join([
            f'#define IDENTITY "{self.identity}"',
            "enum { " + ", ".join(f"{size} = {len(axes[axis])}" for size, axis in sizes.items()) + f", VALUES = {len(VALUES)} }};",
            "enum { " + ", ".join(row[0] for row in VARIABLES) + f", COUNT, SETTABLE = {settable} }};",
            f"static const double start_values[COUNT] = {_numbers(self.start)};",
            f"static const double ratio_axis[2 * RATIOS - 1] = {_axis(np.log(axes['ratio']))}; /* ln */",
            f"static const double ratio_ends[2] = {_numbers(axes['ratio'][[0, -1]] * [0.9, 1.1])}; /* stops of the sheaves */",
            f"static const double load_axis[2 * LOADS - 1] = {_axis(axes['load'])}; /* shares of 2 mu S_2 r_2/cos(beta) */",
            f"static const double clamping_axis[2 * CLAMPINGS - 1] = {_axis(np.log(axes['clamping']))}; /* ln [N] */",
            f"static const double speed_axis[2 * SPEEDS - 1] = {_axis(axes['speed'])}; /* [rad/s] */",
            f"static const double limit_per_force[RATIOS] = {_numbers(factors)}; /* [m] */",
            "/* " + ", ".join(VALUES) + " */",
            "static const double map[SPEEDS][CLAMPINGS][RATIOS][LOADS][VALUES] = {",
            *(_nested(each) + "," for each in table), "};", ""])

    def compiled(self, fmi, compiler="cc"):
        """The bytes of a shared library. Raises RuntimeError with the compiler's message."""
        with tempfile.TemporaryDirectory(prefix="cvtflow-") as folder:
            with open(os.path.join(folder, "map.h"), "w", encoding="utf-8") as file:
                file.write(self.header)
            made = os.path.join(folder, "made.so")  # with an ending, or mingw-w64 adds one
            words = [compiler, "-std=c99", "-O3", "-shared", "-fvisibility=hidden", *["-fPIC"] * (compiler == "cc"), f"-DFMI={fmi}"]
            try:
                done = subprocess.run([*words, f"-I{folder}", "-o", made, _SOURCE, "-lm"], capture_output=True, text=True)
            except FileNotFoundError:
                raise RuntimeError(f"the reduced model requires a C compiler as {compiler} (Debian: apt-get install gcc)") from None
            if done.returncode:
                raise RuntimeError(f"{compiler}: {done.stderr.strip()}")
            with open(made, "rb") as file:
                return file.read()

    def load(self):
        """A running Model of it."""
        return Model(self.compiled(0), self.start)

    def fmu(self, name, fmi, description):
        """The bytes of an FMU for co-simulation, and the systems that it has libraries for."""
        rows = [_fmu.Variable("time" if kind == "independent" else kind, variable, unit, meaning, start=start)
                for (_, variable, unit, kind, _, meaning), start in zip(VARIABLES, self.start)]
        model = _fmu.Model(name, name, self.identity, description, rows, {unit: (powers, {}) for unit, powers in _UNITS.items()}, "cvtflow",
                           1.0, 1e-3, capabilities=("canHandleVariableCommunicationStepSize", "canGetAndSetFMUState"), sources=("reduced.c",))
        parts, made = {"modelDescription.xml": _fmu.model_description(model, fmi)}, []
        for system, compiler in (("Linux", "cc"), ("Windows", "x86_64-w64-mingw32-gcc")):
            if compiler == "cc" or shutil.which(compiler):
                parts[_fmu.library_place(system, name, fmi)] = self.compiled(fmi, compiler)
                made.append(_fmu.SYSTEMS[system][0][3])
        with open(_SOURCE, encoding="utf-8") as source:
            parts["sources/reduced.c"] = source.read().replace('#include "map.h"', f'#define FMI {fmi}\n#include "map.h"')
        parts["sources/map.h"] = self.header
        if fmi == 3:
            parts["sources/buildDescription.xml"] = _fmu.build_description(model)
        parts["documentation/index.html"] = _fmu.page("Reduced variator", [f"<pre>{escape(description)}</pre>"], rows)
        return _fmu.packed(parts), made


class Model:
    """An instance of the reduced model, by ctypes: variables by name."""

    def __init__(self, library, start):
        with tempfile.NamedTemporaryFile(suffix=".so") as file:
            file.write(library)
            file.flush()
            self._code = ctypes.CDLL(file.name)
        self._code.reduced_create.restype = ctypes.c_void_p
        self._code.reduced_advance.argtypes = [ctypes.c_void_p, ctypes.c_double]
        self._code.reduced_values_at.argtypes = [ctypes.c_double] * 4 + [ctypes.c_void_p]
        self._numbers = {row[1]: number for number, row in enumerate(VARIABLES)}
        self._start = dict(zip(self._numbers, start))
        self._made = ctypes.c_void_p(self._code.reduced_create())

    def __del__(self):
        self._code.reduced_free(self._made)

    def set(self, **values):
        """Sets inputs and parameters."""
        for name, value in values.items():
            if self._code.reduced_set(self._made, ctypes.byref(ctypes.c_uint(self._numbers[name])), ctypes.c_size_t(1),
                                      ctypes.byref(ctypes.c_double(value))):
                raise ValueError(f"{name} = {value}")

    def get(self, name):
        """Value of a variable."""
        value = ctypes.c_double()
        self._code.reduced_get(self._made, ctypes.byref(ctypes.c_uint(self._numbers[name])), ctypes.c_size_t(1), ctypes.byref(value))
        return value.value

    def begin(self, **values):
        """Sets values and starts."""
        self.set(**values)
        self._code.reduced_initialise(self._made)

    def advance(self, length):
        """Advances by a time [s], in steps of 1 ms."""
        if self._code.reduced_advance(self._made, length):
            raise ValueError(f"a step of {length} s")

    def values_at(self, ratio, share, clamping, speed):
        """Values of the map by name, and what is outside."""
        made = (ctypes.c_double * (len(VALUES) + 1))()  # and the slope of slip
        outside = self._code.reduced_values_at(math.log(ratio), share, math.log(clamping), speed, made)
        return dict(zip(VALUES, made)), outside
