"""A scene as an FMU: its variables from the catalogues of inputs, channels and keys, its state, its documents."""

from __future__ import annotations

import glob
import hashlib
import math
import os
import pathlib
import time
from collections.abc import Sequence
from html import escape

from . import _fmu
from ._errors import Error
from ._known import Misuse, described, quantity, rows_of, suggestion
from ._numbers import belt_radii
from ._simulation import Simulation, Threads

USUAL_OUTPUTS = ("shaft_1/speed", "shaft_2/speed", "shaft_1/torque", "shaft_1/chain_torque", "shaft_2/chain_torque", "shaft_1/clamping",
                 "shaft_2/clamping", "ratio", "slip", "efficiency", "loss/total", "balance/error_ratio")
USUAL_PARAMETERS = ("drive.inertia", "drive.governor_frequency", "load.inertia", "load.linear", "load.quadratic",
                    "plate.friction_coefficient", "joint.friction_coefficient", "tip.friction_coefficient", "tip.friction_scale",
                    "pulley.cylinder_damping", "clamping.safety", "control.proportional", "control.integral")
_NOT_SHOWN = ("N*m", "J", "W", "K")  # their usual units have other dimensions' names, or an offset
_HERE = os.path.dirname(os.path.realpath(__file__))


def _chosen(option, requested, known, everything, usual):
    """The requested names; all of them for "all"; the usual ones that the scene has if none is requested."""
    names = [name for name in requested if name]
    if names == ["all"]:
        return list(everything)
    for name in names:
        if name not in known:
            raise Misuse(f"{option}: the scene has no '{name}'{suggestion(name, known) or ', only ' + ', '.join(known)}")
    return names or [name for name in usual if name in known] or list(everything)


def _magnitude(value):
    """The power of ten below a number; None for none."""
    return 10.0 ** math.floor(math.log10(abs(value))) if value and math.isfinite(value) else None


def _shown(unit):
    """The unit in which people read a quantity; empty for the SI unit."""
    return "" if unit in _NOT_SHOWN else next(iter(described("units")["usual"].get(unit, [])), "")


def _ranged(variable, key):
    """A variable with the range of a key."""
    variable.least, variable.most = key["range"]
    variable.nominal, variable.shown = _magnitude(variable.start), _shown(variable.unit)
    return variable


def _key_of_input(name, keys):
    """The key whose table an input replaces: load.torque of load_torque, control.ratio of ratio, hydraulics.driven_pressure of
    pressure_driven."""
    spelt = (name, f"control_{name}", f"hydraulics_{name.removeprefix('pressure_')}_pressure")
    return next((row for row in keys.values() if row["kind"] == "time_table" and row["name"].replace(".", "_") in spelt), None)


def _inputs(simulation, requested):
    rows = {}
    for name, info in rows_of("inputs").items():
        try:
            start = simulation.input(name)
        except Error:  # not in this scene
            continue
        row = _fmu.Variable("input", "ratio_target" if name == "ratio" else name, info["unit"], info["text"], start=start, source=name)
        key = _key_of_input(name, rows_of("keys"))
        rows[name] = _ranged(row, key) if key else row
    usual = [name for name in rows if not name.endswith("_angle")]  # an importer that sets every input would hold an angle at its start
    kept = _chosen("--inputs", requested, rows, rows, usual)
    return [row for name, row in rows.items() if name in kept]


def _outputs(simulation, requested, arrays):
    info = simulation.channels.info
    single = []  # groups such as "vehicle/*" as their channels
    for name in requested:
        group = [each for each in info if name.endswith("/*") and each.startswith(name[:-1])]
        single += group or [name]
    rows = []
    scalars = [name for name, column in info.items() if column.width == 1]
    for channel in _chosen("--outputs", single, info, scalars, USUAL_OUTPUTS):
        column, now = info[channel], simulation.channel(channel)
        whole = arrays or column.width == 1
        for element in range(1 if whole else column.width):
            name = channel.replace("/", ".")
            rows.append(_fmu.Variable("output", name if whole else f"{name}[{element}]", column.unit, column.description,
                                 column.width if whole else 1, source=channel, element=element,
                                 nominal=_magnitude(max(map(abs, now.tolist()))), shown=_shown(column.unit)))
    return rows


def _follows(scene, key):
    """Whether a key follows from others of its scene."""
    if key in ("control.proportional", "control.integral"):
        return scene["control.gains"] == "found"
    if key == "tip.friction_coefficient":
        return scene["tip.friction_law"] == "table" and len(scene["tip.friction_table"]) > 0
    return key in ("load.inertia", "load.quadratic") and scene["vehicle.mass"] > 0.0


def _parameters(scene, requested):
    """Numbers of the machine. Keys that determine the size of the state, the method or the run remain as exported, as do those that follow."""
    keys = {name: row for name, row in rows_of("keys").items()
            if row["kind"] == "number" and not name.startswith(("run.", "start.")) and not _follows(scene, name)}
    return [_ranged(_fmu.Variable("parameter", name, keys[name]["unit"], keys[name]["text"], start=float(scene[name]), source=name), keys[name])
            for name in _chosen("--parameters", requested, keys, keys, USUAL_PARAMETERS)]


def _variables(simulation, fmi, inputs, outputs, parameters):
    found = {"time": _fmu.Variable("time", "time", "s", "simulated time", source="time")}
    for rows in (_inputs(simulation, inputs), _outputs(simulation, outputs, fmi == 3), _parameters(simulation.scene, parameters)):
        for row in rows:
            if row.name in found and row.kind == "output":
                continue  # a channel named twice is one variable
            if row.name in found:
                row.name += "_parameter"
            found[row.name] = row
    return [*found.values(), _fmu.Variable("flag", "unreliable", "1", "whether the energy balance does not close, so that results are wrong",
                                      source="unreliable")]


def _units(variables):
    """Units in use by name: exponents of kg, m, s, rad, and the factor to what people read."""
    exponents, found = described("units")["exponents"], {}
    for row in variables:
        if row.unit != "1":
            found[row.unit] = (exponents.get(row.unit), {row.shown: 1.0 / quantity(f"1 {row.shown}", row.unit)} if row.shown else {})
    return found


def _terminals(variables):
    """A bus for each shaft: its inputs, and the outputs whose names begin with it. The ratio belongs to both shafts, so to none."""
    groups = {"shaft_1": ("The driving shaft.", {}), "shaft_2": ("The driven shaft.", {})}
    for row in variables:
        if row.kind == "input" and row.source != "ratio":
            shaft = "shaft_1" if row.source.startswith("drive_") or row.source.endswith("_driving") else "shaft_2"
            groups[shaft][1][row.name] = row.name
        elif row.kind == "output" and row.name.partition(".")[0] in groups and "." in row.name:
            shaft, _, member = row.name.partition(".")
            groups[shaft][1][member] = row.name
    return groups


def _until(scene):
    """End of the default experiment [s]: that of the run, at the latest."""
    if not isinstance(scene["run.until"], str):
        return float(scene["run.until"])
    length = scene["chain.pins"] * float(_mean(scene["chain.pitch"]))
    driven = scene["control.reference_speed"] if scene["drive.mode"] == "torque" else abs(_first(scene["drive.speed"]))
    radius = belt_radii(length, scene["pulley.centre_distance"], scene["start.ratio"])[0]
    return scene["run.steady_limit"] * length / max(1e-2, driven * radius)


def _mean(value):
    return sum(value) / len(value) if isinstance(value, list) else value


def _first(value):
    return value if isinstance(value, (int, float)) else value[0][1]


def generation_date():
    """SOURCE_DATE_EPOCH, else the date of the commit that the library was built from: UTC, ISO 8601. Empty if neither is known."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not epoch:
        return described("build")["date"]
    if not epoch.isascii() or not epoch.isdigit() or int(epoch) > 253402300799:  # year 9999
        raise Misuse(f"SOURCE_DATE_EPOCH: '{epoch}' is no number of seconds since 1970")
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(epoch)))


def _library(name):
    """The path of an FMU's library: of a wheel, beside the program as it was built, or in lib/cvtflow or lib/ARCHITECTURE/cvtflow of an
    installation; None: there is none."""
    parents = list(pathlib.Path(_HERE).parents)  # dist-packages, python3, lib, prefix; in the build folder two more
    lib, built = (str(parents[k]) if len(parents) > k else "/" for k in (2, 5))
    places = [os.path.join(_HERE, "lib", "cvtflow", name), os.path.join(lib, "cvtflow", name),
              *sorted(glob.glob(f"{glob.escape(lib)}/*/cvtflow/{name}")),
              *[os.path.join(built, name)] * (os.path.basename(os.path.dirname(os.path.dirname(lib))) == "prefix")]
    return next((place for place in places if os.path.isfile(place)), None)


def libraries():
    """Libraries by system, and why there is none for Windows; empty: there is one. One that is older than that for Linux is left out, but for
    those of a wheel, which were checked when it was made, and whose times are those of its installation."""
    linux, windows = _library("cvtflow_fmu.so"), _library("cvtflow_fmu.dll")
    if linux is None:
        raise ValueError("cvtflow_fmu.so: found neither beside this program nor in lib/cvtflow of its installation (cmake --build build "
                         "--target cvtflow_fmu; x86-64 only)")
    if windows is None:
        return {"Linux": linux}, "no cvtflow_fmu.dll: docs/fmi.md"
    if not windows.startswith(_HERE) and os.stat(windows).st_mtime_ns < os.stat(linux).st_mtime_ns:
        return {"Linux": linux}, ("cvtflow_fmu.dll is older than cvtflow_fmu.so and is left out: cmake --build build --target "
                                  "cvtflow_windows")
    return {"Linux": linux, "Windows": windows}, ""


def _bytes(*place):
    with open(os.path.join(_HERE, *place), "rb") as file:
        return file.read()


def content(simulation, files, fmi=3, inputs=(), outputs=(), parameters=(), author=""):
    """The bytes of the FMU of a simulation, which is at t = 0. files: libraries by system; the rest as of export_fmu()."""
    scene = simulation.scene
    third, version = fmi == 3, described("build")["version"]
    variables = _variables(simulation, fmi, inputs, outputs, parameters)
    text = scene.with_("start.state=", 'run.schedule="auto"').text  # the state is inside, and the caller's thread is the only one
    state = simulation.state().bytes()
    table = "".join(f"{number} {row.kind} {row.width} {row.source} {row.element}\n" for number, row in enumerate(variables))
    token = hashlib.sha256(text.encode() + state + table.encode()).hexdigest()[:16]
    until = _until(scene)
    long = scene["vehicle.mass"] > 0.0 or until >= 0.05  # controllers of vehicles run every 1 to 10 ms
    capabilities = ["canHandleVariableCommunicationStepSize", "canGetAndSetFMUState", "canSerializeFMUState"]
    if third:
        capabilities += ["providesIntermediateUpdate", "mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate"]
    model = _fmu.Model(scene.name, _fmu.identifier(scene.name), f"{{{token}}}", scene.description, variables, _units(variables),
                       f"cvtflow {version}", until, min(1e-3 if long else 1e-4, until), author, generation_date(), tuple(capabilities),
                       ("logStatusError", "logStatusWarning"))
    words = [escape(scene.description),
             f"A chain-driven continuously variable transmission for co-simulation by FMI {fmi}.0, exported by cvtflow {version}. It "
             "runs on the thread of its importer. Communication steps may have any length; inputs are constant within a step. The FMU starts "
             "from a settled state; after a change of a parameter it settles again while its initialisation ends.",
             "Where the balance of energy does not close, results are wrong: <code>unreliable</code> becomes true, the step in which it does "
             "returns a warning, and the log states the reason.", '<a href="licenses/license.txt">Licences</a>']
    parts = {"modelDescription.xml": _fmu.model_description(model, fmi)}
    for system, path in files.items():
        with open(path, "rb") as file:
            parts[_fmu.library_place(system, model.identifier, fmi)] = file.read()
    parts |= {"resources/scene.toml": text, "resources/state.bin": state, "resources/variables.txt": table}
    if third:
        parts["terminalsAndIcons/terminalsAndIcons.xml"] = _fmu.terminals(_terminals(variables))
    parts["documentation/index.html"] = _fmu.page(scene.name, words, variables)
    parts["documentation/licenses/license.txt"] = b"\n".join([_bytes("fmu", "LICENSE"), 80 * b"-", _bytes("page", "licenses.txt")])
    icons = {"terminalsAndIcons/icon.png": "icon.png", "terminalsAndIcons/icon.svg": "icon.svg"} if third else {"model.png": "icon.png"}
    return _fmu.packed(parts | {name: _bytes("fmu", icon) for name, icon in icons.items()})


def settled(scene):
    """A Simulation at t = 0, where a geometric start has settled."""
    simulation = Simulation(scene, Threads.caller())
    if simulation.time < 0.0:
        simulation.advance_to(0.0)
    return simulation


def export_fmu(scene: object, path: str | os.PathLike[str], fmi: int = 3, *, inputs: Sequence[str] = (), outputs: Sequence[str] = (),
               parameters: Sequence[str] = (), author: str = "") -> None:
    """Writes a scene as an FMU for co-simulation, as `cvtflow export-fmu` does; it begins with the scene's state, or settles now.

    scene       a Scene, its path or the name of a ready one
    fmi         version of the standard, 2 or 3
    inputs      names; none: all inputs of the scene
    outputs     channels, or groups such as "vehicle/*"; none: a dozen; ["all"]: all of one number
    parameters  keys of the machine; none: a dozen; ["all"]: all numbers
    author      in the description

    Raises ValueError for a name that the scene does not have, and where the library for FMUs was not built.
    """
    data = content(settled(scene), libraries()[0], fmi, inputs, outputs, parameters, author)
    with open(path, "wb") as file:
        file.write(data)
