"""Dynamics of chain-driven continuously variable transmissions.

    import cvtflow
    scene = cvtflow.Scene.ready("tiny").with_("run.until=1 ms")
    simulation = cvtflow.Simulation(scene)
    simulation.advance_to(1e-3)                       # [s]; the interpreter's lock is free meanwhile
    simulation.channel("links/tension")               # [N], a NumPy array
    result = cvtflow.run(scene, channels=["ratio"])   # a dict of arrays over time

Names are those of the C++ interface; all numbers are in SI units. Simulations step side by side on threads of Python.
"""

from ._cvtflow import *  # noqa: F401,F403
from ._cvtflow import Scene, Simulation, library_version
from . import _display, _pickle
from ._records import Record
from ._run import run
from ._sweep import Sweep

__version__ = library_version()

Scene.__module__ = Simulation.__module__ = "cvtflow"
_pickle.install(Simulation)
_display.install(Scene, Simulation)
