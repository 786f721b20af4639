"""A run as one call."""

import math

import numpy as np

from ._cvtflow import Scene, Simulation, Threads


def _seconds(scene, key):
    return float(scene.value(key).strip('"').split()[0])


def run(scene, until=None, *, channels=("ratio", "slip", "efficiency"), interval=None, inputs=None, threads=None):
    """Runs a scene and returns a dict of arrays over time: "time" [s] and the channels, [rows] or [rows, width], in SI units.

    until     end [s]; None: run.until of the scene
    interval  time between rows [s]; None: run.output_interval
    inputs    called as inputs(time, simulation) before each row; returns a dict of inputs to set, or None
    threads   cvtflow.Threads; None: the calling thread

    A start that has to settle does so first. Rows are taken at the first step at or after every multiple of the interval, as in a record.
    """
    simulation = scene if isinstance(scene, Simulation) else Simulation(scene, threads or Threads.caller())
    until = _seconds(simulation.scene, "run.until") if until is None else until
    interval = _seconds(simulation.scene, "run.output_interval") if interval is None else interval
    if not interval > 0.0:
        raise ValueError("interval: must be positive")
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
            rows[name].append(simulation.channel(name).copy())
    return {name: np.asarray(values) if name == "time" else _stacked(values) for name, values in rows.items()}


def _stacked(values):
    table = np.array(values, dtype=float)
    return table[:, 0] if table.ndim == 2 and table.shape[1] == 1 else table
