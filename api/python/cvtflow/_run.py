"""A run as one call."""

import math

import numpy as np

from ._cvtflow import Simulation, Threads, quantity
from ._channels import split
from ._series import Series


class Rows(Series, dict):
    """Result of run(): arrays over time by name. info contains their units; frame() and plot() as for a Record."""

    def __init__(self, values, info):
        super().__init__(values)
        self.info = info

    def __repr__(self):
        return f"<cvtflow.Rows: {len(self['time'])} rows of {', '.join(self)}>"


def _channel(name):
    return split(name)[0]


def _seconds(value):
    return quantity(value, "s") if isinstance(value, str) else value


def run(scene, until=None, *, channels=("ratio", "slip", "efficiency"), interval=None, inputs=None, threads=None):
    """Runs a scene and returns a dict of arrays over time: "time" [s] and the channels, [rows] or [rows, width], in SI units.

    until     end ("0.1 ms"; numbers are in s); None: run.until of the scene
    channels  names, elements such as "links/tension[3]" among them
    interval  time between rows; None: run.output_interval
    inputs    called as inputs(time, simulation) before each row; returns a dict of inputs to set, or None
    threads   cvtflow.Threads; None: the calling thread

    A start that has to settle does so first. Rows are taken at the first step at or after every multiple of the interval, as in a record.
    """
    simulation = scene if isinstance(scene, Simulation) else Simulation(scene, threads or Threads.caller())
    until = simulation.scene["run.until"] if until is None else _seconds(until)
    interval = simulation.scene["run.output_interval"] if interval is None else _seconds(interval)
    if not interval > 0.0:
        raise ValueError("interval: must be positive")
    now = simulation.channels
    for name in channels:
        now[name]  # raises what is wrong with a name before anything runs
    info = {name: column for name, column in now.info.items() if name in map(_channel, channels)}
    if simulation.time < 0.0:
        simulation.advance_to(0.0)
    first = math.ceil(simulation.time / interval * (1.0 - 1e-9))
    rows = {"time": []} | {name: [] for name in channels}
    for number in range(first, math.floor(until / interval * (1.0 + 1e-9)) + 1):
        simulation.advance_to(number * interval)
        for name, value in ((inputs(simulation.time, simulation) if inputs else None) or {}).items():
            simulation.set_input(name, value)
        rows["time"].append(simulation.time)
        for name in channels:
            rows[name].append(now[name])
    return Rows({name: np.array(values, dtype=float) for name, values in rows.items()}, info)
