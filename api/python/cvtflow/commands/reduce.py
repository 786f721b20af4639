"""`cvtflow reduce`: a machine's steady map and shift law. `cvtflow clamp` takes the same arguments."""

import os

from .._output import default_place
from ._front import FORCE, between, matplotlib, require
from ._scenes import declare_scene, load

DESCRIPTION = "Reduce a machine to its steady map and shift law: tables and an FMU with measured errors"
FOOTER = """
Results of the sweeps stay in the folder: the same line continues after Ctrl-C. SciPy (python3-scipy) writes map.mat, and a C compiler
makes the FMUs.
"""
_LARGEST = 1 << 20  # bytes of a file of axes


def declare(parser, command="reduce", files="tables, picture and FMUs"):
    declare_scene(parser)
    add = parser.add_argument
    add("-o", "--output", metavar="DIR", help=f"Folder for {files} (default: results/NAME_{command})")
    add("--axes", metavar="FILE", help="TOML file of axes, instead of the scene's ranges (docs/reduce.md)")
    add("--force", action="store_true", help=FORCE)
    add("--threads", metavar="COUNT", type=between(int, 1, 1024), default=0, help="Threads of the sweeps (default: all)")


def request_of(given, command, margin=None):
    """What a command line requests, by name: the scene with its keys and as TOML, where results go, axes, threads, level of detail."""
    from .._scene import value_of

    require(command, "numpy", "matplotlib", "h5py")
    scene = load(given)
    axes = ""
    if given.axes:
        try:
            with open(given.axes, encoding="utf-8") as file:
                axes = file.read(_LARGEST)
        except (OSError, ValueError) as error:
            raise ValueError(f"--axes {given.axes}: {error.strerror if isinstance(error, OSError) else error}") from None
    place = given.output or default_place(f"{scene.name}_{command}")
    matplotlib()
    return {"name": scene.name, "scene": {key: value_of(scene.value(key)) for key in scene}, "text": scene.text, "place": place,
            "folder": os.path.abspath(place), "axes": axes, "threads": given.threads,
            "detail": given.detail or "rigid", "margin": margin, "force": given.force, "named": bool(given.output)}


def carried_out(function, request):
    """Prints the lines of a function of a request. Returns its exit status."""
    from .. import _figures

    _figures.in_notebooks = False
    status, lines = function(request)
    print("\n".join(lines))
    return status


def act(given):
    request = request_of(given, "reduce")
    from .._reduction import reduce

    return carried_out(reduce, request)
