"""Dynamics of chain-driven continuously variable transmissions.

    import cvtflow
    scene = cvtflow.Scene.ready("tiny").with_(until="1 ms", load__torque="8 N*m")
    simulation = cvtflow.Simulation(scene)
    simulation.advance_to("1 ms")                     # the interpreter's lock is free meanwhile
    simulation.channels["slip"]                       # a number; dir(simulation.channels) lists what there is
    rows = cvtflow.run(scene, channels=["ratio"])     # a dict of arrays over time
    rows.plot("ratio")                                # with Matplotlib

Numbers are in SI units, texts carry their units. scene.keys() lists what a scene is made of. Simulations step side by side on threads of
Python. Names are those of the C interface.
"""

import importlib
import typing

if typing.TYPE_CHECKING:
    from ._errors import *  # noqa: F401,F403
    from ._fit import Fit as Fit, fit as fit
    from ._library import Column as Column, Counters as Counters, Energy as Energy, SweepProgress as SweepProgress
    from ._library import Transition as Transition, display_unit as display_unit, library_version as library_version, quantity as quantity
    from ._library import shutdown as shutdown
    from ._results import Rows as Rows, run as run
    from ._scene import KeyInfo as KeyInfo, Scene as Scene, ready_scenes as ready_scenes, scene_keys as scene_keys
    from ._scene_fmu import export_fmu as export_fmu
    from ._series import Record as Record
    from ._simulation import Input as Input, Recording as Recording, Simulation as Simulation, State as State, Threads as Threads
    from ._sweep import Sweep as Sweep
    from ._sweep_file import SweepFile as SweepFile
    from ._tables import Results as Results
    from ._tune import Tuning as Tuning, tune as tune
    from .pages import report as report

# Names by module, which is imported when one of them is used: a command that needs little starts in little time.
_MODULES = {
    "_errors": "Error Fault ArgumentError SceneError StartStateError StateError BusyError ForkedError CancelledError OutOfMemoryError "
               "InternalError CallbackError RecordError NonFiniteError PenetrationError LeftSheaveError MaxStepsError MaxWallError BlowUpError "
               "OtherFaultError",
    "_library": "Column Counters Energy SweepProgress Transition display_unit library_version quantity shutdown",
    "_scene": "KeyInfo Scene ready_scenes scene_keys",
    "_simulation": "Input Recording Simulation State Threads",
    "_results": "Rows run",
    "_series": "Record",
    "_sweep": "Sweep",
    "_sweep_file": "SweepFile",
    "_tables": "Results",
    "_tune": "Tuning tune",
    "_fit": "Fit fit",
    "_scene_fmu": "export_fmu",
    "pages": "report",
}
_PLACES = {name: module for module, names in _MODULES.items() for name in names.split()}
__all__ = list(_PLACES)


def __getattr__(name: str) -> typing.Any:
    if name == "__version__":
        return __getattr__("library_version")()
    if name not in _PLACES:
        raise AttributeError(f"module 'cvtflow' has no attribute '{name}'")
    value = getattr(importlib.import_module("." + _PLACES[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*globals(), *__all__]
