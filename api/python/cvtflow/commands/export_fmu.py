"""`cvtflow export-fmu`: a scene as an FMU."""

from .._output import Output
from ._front import FORCE, UsageError, require, say, visible
from ._scenes import declare_scene, load

DESCRIPTION = "Write a scene as an FMU for other simulators (FMI 2.0 or 3.0)"
FOOTER = """
The FMU needs no library but C's. It begins with the scene's state, or the settled one, and runs on its caller's thread with the bits of cvtflow run.
An instance in which a parameter is changed settles again. docs/fmi.md lists what FMI offers and this FMU does not.
"""
SHORTCUTS = (("--method", "run.method", "NAME", "Integration method, a name from the catalogue; auto: by detail and friction law"),
             ("--step", "run.step", "TIME", "Time step; auto: 0.85 of the stability limit, evaluated every ms"))


def declare(parser):
    declare_scene(parser, SHORTCUTS, settle=True)
    add = parser.add_argument
    add("-o", "--output", metavar="FILE.fmu", help="File to write; must not exist (default: SCENE.fmu)")
    add("--force", action="store_true", help=FORCE)
    add("--fmi", metavar="N", choices=("2", "2.0", "3", "3.0"), default="3", help="Version of the standard, 2 or 3 (default: 3)")
    for option, what, text in (("--inputs", "NAME,...", "Inputs by name, separated by commas (default: all inputs of the scene)"),
                               ("--outputs", "CHANNEL,...", "Channels, separated by commas, or all (default: a dozen)"),
                               ("--parameters", "KEY,...", "Keys of the machine, separated by commas, or all (default: a dozen); the others "
                                                           "stay as exported")):
        add(option, metavar=what, default="", help=text)
    add("--author", metavar="NAME", default="", help="Author in the model description (default: none)")
    add("-q", "--quiet", action="store_true", help="Print errors only")


def act(given):
    require("export-fmu", "numpy")
    from .. import _scene_fmu

    scene = load(given, SHORTCUTS, given.quiet)
    if any(ord(letter) < 32 or 0xD800 <= ord(letter) < 0xE000 for letter in given.author):
        raise UsageError("--author: a text in UTF-8 without control characters is expected")
    path = given.output or f"{scene.name}.fmu"
    output = Output(path, [given.scene, scene["start.state"]], given.force, named=bool(given.output))
    if output.notice and not given.quiet:
        say(output.notice)
    files, alone = _scene_fmu.libraries()
    simulation = _scene_fmu.settled(scene)
    names = [each.split(",") for each in (given.inputs, given.outputs, given.parameters)]
    version = int(given.fmi[0])
    data = _scene_fmu.content(simulation, files, version, *names, given.author)
    output.write(data)
    for notice in simulation.notices():
        say(notice)
    if not given.quiet:
        size = f"{1e-6 * len(data):.1f} MB" if len(data) >= 1e6 else f"{1e-3 * len(data):.1f} kB"
        systems = f"Linux only ({alone})" if alone else "Linux and Windows"
        print(f"{visible(path)}: FMI {version}.0 for co-simulation, {systems}, {size}")
    return 0 if simulation.energy().reliable else 6
