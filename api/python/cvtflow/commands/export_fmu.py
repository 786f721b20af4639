"""`cvtflow export-fmu`: a scene as an FMU."""

import glob
import hashlib
import math
import os
import re
import time
from html import escape

from ._front import FORCE, UsageError, require, say, visible
from ._output import Output, with_marks
from ._scenes import declare_scene, load

DESCRIPTION = "Write a scene as an FMU for other simulators (FMI 2.0 or 3.0)"
FOOTER = """
The FMU needs no library but C's. It begins with the scene's state, or the settled one, and runs on its caller's thread with the bits of cvtflow run.
An instance in which a parameter is changed settles again. docs/fmi.md lists what FMI offers and this FMU does not.
"""
SHORTCUTS = (("--method", "run.method", "NAME", "Integration method, a name from the catalogue; auto: by detail and friction law"),
             ("--step", "run.step", "TIME", "Time step; auto: 0.85 of the stability limit, evaluated every ms"))
USUAL_OUTPUTS = ("shaft_1/speed", "shaft_2/speed", "shaft_1/torque", "shaft_1/chain_torque", "shaft_2/chain_torque", "shaft_1/clamping",
                 "shaft_2/clamping", "ratio", "slip", "efficiency", "loss/total", "balance/error_ratio")
USUAL_PARAMETERS = ("drive.inertia", "drive.governor_frequency", "load.inertia", "load.linear", "load.quadratic",
                    "plate.friction_coefficient", "joint.friction_coefficient", "tip.friction_coefficient", "tip.friction_scale",
                    "pulley.cylinder_damping", "clamping.safety", "control.proportional", "control.integral")
_NOT_SHOWN = ("N*m", "J", "W", "K")  # their usual units have other dimensions' names, or an offset
_HERE = os.path.dirname(os.path.abspath(__file__))


def declare(parser):
    declare_scene(parser, SHORTCUTS, settle=True)
    add = parser.add_argument
    add("-o", "--output", metavar="FILE.fmu", help="File to write; must not exist (default: SCENE.fmu, replaced with a notice)")
    add("--force", action="store_true", help=FORCE)
    add("--fmi", metavar="N", type=int, choices=(2, 3), default=3, help="Version of the standard, 2 or 3 (default: 3)")
    for option, what, text in (("--inputs", "NAME,...", "Inputs by name, separated by commas (default: all inputs of the scene)"),
                               ("--outputs", "CHANNEL,...", "Channels, separated by commas, or all (default: a dozen)"),
                               ("--parameters", "KEY,...", "Keys of the machine, separated by commas, or all (default: a dozen); the others "
                                                           "stay as exported")):
        add(option, metavar=what, default="", help=text)
    add("--author", metavar="NAME", default="", help="Author in the model description (default: none)")
    add("-q", "--quiet", action="store_true", help="Print errors only")


def _chosen(option, requested, known, everything, usual):
    """The requested names; all of them for "all"; the usual ones that the scene has if none is requested."""
    from .._known import suggestion

    names = [name for name in requested.split(",") if name]
    if names == ["all"]:
        return list(everything)
    for name in names:
        if name not in known:
            raise UsageError(f"{option}: the scene has no '{name}'{suggestion(name, known)}")
    return names or [name for name in usual if name in known] or list(everything)


def _magnitude(value):
    """The power of ten below a number; None for none."""
    return 10.0 ** math.floor(math.log10(abs(value))) if value and math.isfinite(value) else None


def _shown(unit):
    """The unit in which people read a quantity; empty for the SI unit."""
    from .._known import described

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
    from .._fmu import Variable
    from .._known import rows_of

    rows = {}
    for name, info in rows_of("inputs").items():
        try:
            start = simulation.input(name)
        except (ValueError, RuntimeError):  # not in this scene
            continue
        row = Variable("input", "ratio_target" if name == "ratio" else name, info["unit"], info["text"], start=start, source=name)
        key = _key_of_input(name, rows_of("keys"))
        rows[name] = _ranged(row, key) if key else row
    usual = [name for name in rows if not name.endswith("_angle")]  # an importer that sets every input would hold an angle at its start
    kept = _chosen("--inputs", requested, rows, rows, usual)
    return [row for name, row in rows.items() if name in kept]


def _outputs(simulation, requested, arrays):
    from .._fmu import Variable

    info = simulation.channels.info
    single = []  # groups such as "vehicle/*" as their channels
    for name in requested.split(","):
        group = [each for each in info if name.endswith("/*") and each.startswith(name[:-1])]
        single += group or [name]
    rows = []
    scalars = [name for name, column in info.items() if column.width == 1]
    for channel in _chosen("--outputs", ",".join(single), info, scalars, USUAL_OUTPUTS):
        column, now = info[channel], simulation.channel(channel)
        whole = arrays or column.width == 1
        for element in range(1 if whole else column.width):
            name = channel.replace("/", ".")
            rows.append(Variable("output", name if whole else f"{name}[{element}]", column.unit, column.description,
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
    from .._fmu import Variable
    from .._known import rows_of

    keys = {name: row for name, row in rows_of("keys").items()
            if row["kind"] == "number" and not name.startswith(("run.", "start.")) and not _follows(scene, name)}
    return [_ranged(Variable("parameter", name, keys[name]["unit"], keys[name]["text"], start=float(scene[name]), source=name), keys[name])
            for name in _chosen("--parameters", requested, keys, keys, USUAL_PARAMETERS)]


def _variables(simulation, given):
    from .._fmu import Variable

    found = {"time": Variable("time", "time", "s", "simulated time", source="time")}
    for rows in (_inputs(simulation, given.inputs), _outputs(simulation, given.outputs, given.fmi == 3),
                 _parameters(simulation.scene, given.parameters)):
        for row in rows:
            if row.name in found and row.kind == "output":
                continue  # a channel named twice is one variable
            if row.name in found:
                row.name += "_parameter"
            found[row.name] = row
    return [*found.values(), Variable("flag", "unreliable", "1", "whether the energy balance does not close, so that results are wrong",
                                      source="unreliable")]


def _units(variables):
    """Units in use by name: exponents of kg, m, s, rad, and the factor to what people read."""
    from .._known import described, quantity

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
    from .._numbers import belt_radii

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
    from .._known import described

    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not epoch:
        return described("build")["date"]
    if not epoch.isascii() or not epoch.isdigit() or int(epoch) > 253402300799:  # year 9999
        raise UsageError(f"SOURCE_DATE_EPOCH: '{epoch}' is no number of seconds since 1970")
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(epoch)))


def _library(name):
    """The path of an FMU's library: beside the program as it was built, or in lib/cvtflow or lib/ARCHITECTURE/cvtflow of an installation;
    None: there is none."""
    program = os.path.dirname(os.environ.get("CVTFLOW_PROGRAM", "/none/none"))
    lib = os.path.join(os.path.dirname(program), "lib")
    places = [os.path.join(program, name), os.path.join(lib, "cvtflow", name), *sorted(glob.glob(f"{glob.escape(lib)}/*/cvtflow/{name}"))]
    return next((place for place in places if os.path.exists(place)), None)


def _libraries():
    """Libraries by system, and why there is none for Windows; empty: there is one. One that is older than that for Linux is left out."""
    linux, windows = _library("cvtflow_fmu.so"), _library("cvtflow_fmu.dll")
    if linux is None:
        raise ValueError("cvtflow_fmu.so: found neither beside this program nor in lib/cvtflow of its installation (cmake --build build "
                         "--target cvtflow_fmu; x86-64 only)")
    if windows is None:
        return {"Linux": linux}, "no cvtflow_fmu.dll: docs/fmi.md"
    if os.stat(windows).st_mtime_ns < os.stat(linux).st_mtime_ns:
        return {"Linux": linux}, ("cvtflow_fmu.dll is older than cvtflow_fmu.so and is left out: cmake --build build --target "
                                  "cvtflow_fmu_windows")
    return {"Linux": linux, "Windows": windows}, ""


def _bytes(*place):
    with open(os.path.join(_HERE, "..", *place), "rb") as file:
        return file.read()


def _identifier(name):
    """A name reduced to letters, digits and underscores: the name of the FMU's library."""
    plain = re.sub(r"[^A-Za-z0-9]", "_", name)
    return plain if plain and not plain[0].isdigit() else f"fmu_{plain}"


def fmu(scene, simulation, given, libraries):
    """The bytes of the FMU."""
    from .. import _fmu
    from .._known import described

    third, version = given.fmi == 3, described("build")["version"]
    variables = _variables(simulation, given)
    text = scene.with_("start.state=", 'run.schedule="auto"').text  # the state is inside, and the caller's thread is the only one
    state = simulation.state().bytes()
    table = "".join(f"{number} {row.kind} {row.width} {row.source} {row.element}\n" for number, row in enumerate(variables))
    token = hashlib.sha256(text.encode() + state + table.encode()).hexdigest()[:16]
    until = _until(scene)
    long = scene["vehicle.mass"] > 0.0 or until >= 0.05  # controllers of vehicles run every 1 to 10 ms
    capabilities = ["canHandleVariableCommunicationStepSize", "canGetAndSetFMUState", "canSerializeFMUState"]
    if third:
        capabilities += ["providesIntermediateUpdate", "mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate"]
    model = _fmu.Model(scene.name, _identifier(scene.name), f"{{{token}}}", scene.description, variables, _units(variables),
                       f"cvtflow {version}", until, min(1e-3 if long else 1e-4, until), given.author, generation_date(), tuple(capabilities),
                       ("logStatusError", "logStatusWarning"))
    words = [escape(scene.description),
             f"A chain-driven continuously variable transmission for co-simulation by FMI {given.fmi}.0, exported by cvtflow {version}. It "
             "runs on the thread of its importer. Communication steps may have any length; inputs are constant within a step. The FMU starts "
             "from a settled state; after a change of a parameter it settles again while its initialisation ends.",
             "Where the balance of energy does not close, results are wrong: <code>unreliable</code> becomes true, the step in which it does "
             "returns a warning, and the log states the reason.", '<a href="licenses/license.txt">Licences</a>']
    parts = {"modelDescription.xml": _fmu.model_description(model, given.fmi)}
    for system, path in libraries.items():
        with open(path, "rb") as file:
            parts[_fmu.library_place(system, model.identifier, given.fmi)] = file.read()
    parts |= {"resources/scene.toml": text, "resources/state.bin": state, "resources/variables.txt": table}
    if third:
        parts["terminalsAndIcons/terminalsAndIcons.xml"] = _fmu.terminals(_terminals(variables))
    parts["documentation/index.html"] = _fmu.page(scene.name, words, variables)
    parts["documentation/licenses/license.txt"] = b"\n".join([_bytes("fmu", "LICENSE"), 80 * b"-", _bytes("page", "licenses.txt")])
    icons = {"terminalsAndIcons/icon.png": "icon.png", "terminalsAndIcons/icon.svg": "icon.svg"} if third else {"model.png": "icon.png"}
    return _fmu.packed(parts | {name: _bytes("fmu", icon) for name, icon in icons.items()})


def act(given):
    require("export-fmu", "numpy")
    from .. import Simulation, Threads

    scene = load(given, SHORTCUTS, given.quiet)
    if any(ord(letter) < 32 or 0xD800 <= ord(letter) < 0xE000 for letter in given.author):
        raise UsageError("--author: a text in UTF-8 without control characters is expected")
    path = given.output or f"{scene.name}.fmu"
    marks = with_marks("modelDescription.xml", 'generationTool="cvtflow ', f'modelName="{escape(scene.name)}"')
    inputs = [given.scene, scene["start.state"]]
    output = Output(path, f"FMU of the scene '{scene.name}'", marks, inputs, given.force, named=bool(given.output))
    if output.notice and not given.quiet:
        say(output.notice)
    libraries, alone = _libraries()
    simulation = Simulation(scene, Threads.caller())
    if simulation.time < 0.0:
        simulation.advance_to(0.0)
    data = fmu(scene, simulation, given, libraries)
    output.write(data)
    for notice in simulation.notices():
        say(notice)
    if not given.quiet:
        size = f"{1e-6 * len(data):.1f} MB" if len(data) >= 1e6 else f"{1e-3 * len(data):.1f} kB"
        systems = f"Linux only ({alone})" if alone else "Linux and Windows"
        print(f"{visible(path)}: FMI {given.fmi}.0 for co-simulation, {systems}, {size}")
    return 0 if simulation.energy().reliable else 6
