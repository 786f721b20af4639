"""Dynamics of chain-driven continuously variable transmissions.

    import cvtflow
    scene = cvtflow.Scene.ready("tiny").with_(until="1 ms", load__torque="8 N*m")
    simulation = cvtflow.Simulation(scene)
    simulation.advance_to("1 ms")                     # the interpreter's lock is free meanwhile
    simulation.channels["slip"]                       # a number; dir(simulation.channels) lists what there is
    rows = cvtflow.run(scene, channels=["ratio"])     # a dict of arrays over time
    rows.plot("ratio")                                # with Matplotlib

Numbers are in SI units, texts carry their units. scene.keys() lists what a scene is made of. Simulations step side by side on threads of
Python. Names are those of the C++ interface.
"""

from . import _classes

_classes.install()  # before the names below are taken

from ._cvtflow import *  # noqa: E402,F401,F403
from ._cvtflow import Scene as Scene
from ._cvtflow import Simulation as Simulation
from ._cvtflow import library_version as library_version
from ._fit import Fit as Fit
from ._fit import fit as fit
from ._results import Rows as Rows
from ._results import run as run
from ._scene import ready_scenes as ready_scenes
from ._series import Record as Record
from ._sweep import Sweep as Sweep
from ._tables import Results as Results
from .pages import report as report

__version__ = library_version()

Scene.__module__ = Simulation.__module__ = "cvtflow"
