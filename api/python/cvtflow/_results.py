"""Results over time: a run as one call."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ._channels import split
from ._known import UnknownName, suggestion, sums
from ._numbers import Array
from ._scene import Scene
from ._series import Record, Series, seconds  # noqa: F401 (Record: of recordings)
from ._simulation import Simulation, Threads


class Rows(Series, dict[str, Array]):
    """Result of run(): arrays over time by name. info contains their units; frame() and plot() as for a Record."""

    def __init__(self, values: Mapping[str, Array], info: Mapping[str, Any], sums: Any = None) -> None:
        super().__init__(values)
        self.info, self._sums = info, sums or {}

    def _sum(self, name):
        return self._sums.get(name)

    def __missing__(self, name: str) -> Array:
        raise UnknownName(f"{name}: there are {', '.join(self)}" + suggestion(name, self))

    def __repr__(self):
        return f"<cvtflow.Rows: {len(self['time'])} rows of {', '.join(self)}>"


def run(scene: Scene | Simulation | str, until: float | str | None = None, *,
        channels: str | Sequence[str] = ("ratio", "slip", "efficiency"), interval: float | str | None = None,
        inputs: Callable[[float, Simulation], Mapping[str, float] | None] | None = None, threads: Threads | None = None) -> Rows:
    """Runs a scene and returns a dict of arrays over time: "time" [s] and the channels, [rows] or [rows, width], in SI units.

    until     end ("0.1 ms"; numbers are in s); None: run.until of the scene
    channels  a name or several, elements such as "links/tension[3]" among them
    interval  time between rows; None: run.output_interval
    inputs    called as inputs(time, simulation) before each row; returns a dict of inputs to set, or None
    threads   cvtflow.Threads; None: the calling thread

    A start that has to settle does so first. Rows are taken at the first step at or after every multiple of the interval, as in a record.
    """
    simulation = scene if isinstance(scene, Simulation) else Simulation(scene, threads or Threads.caller())
    until = simulation.scene["run.until"] if until is None else seconds(until)
    interval = simulation.scene["run.output_interval"] if interval is None else seconds(interval)
    if not interval > 0.0:
        raise ValueError("interval: must be positive")
    if not until >= max(0.0, simulation.time):
        raise ValueError(f"until: {until:g} s is before {max(0.0, simulation.time):g} s, where the run begins")
    channels = [channels] if isinstance(channels, str) else channels
    now = simulation.channels
    for name in channels:
        now[name]  # raises what is wrong with a name before anything runs
    info = {name: column for name, column in now.info.items() if name in [split(each)[0] for each in channels]}
    if simulation.time < 0.0:
        simulation.advance_to(0.0)
    first = math.ceil(simulation.time / interval * (1.0 - 1e-9))
    sums_of = {name for channel in channels for parts in sums(channel) for name in parts if name in now}
    rows = {"time": []} | {name: [] for name in channels} | {name: [] for name in sums_of}
    for number in range(first, math.floor(until / interval * (1.0 + 1e-9)) + 1):
        simulation.advance_to(number * interval)
        for name, value in ((inputs(simulation.time, simulation) if inputs else None) or {}).items():
            simulation.set_input(name, value)
        rows["time"].append(simulation.time)
        for name in rows.keys() - {"time"}:
            rows[name].append(now[name])
    made = {name: np.array(values, dtype=float) for name, values in rows.items()}
    return Rows({name: made[name] for name in ("time", *channels)}, info, {name: made[name] for name in sums_of})
