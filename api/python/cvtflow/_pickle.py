"""Simulations as bytes: the scene and the state."""

import re

from ._cvtflow import Scene, SceneError, Simulation, StartStateError, State, Threads


def _threads(way, count):
    return (lambda _: Threads.caller(), Threads.present, Threads.own)[way](count)


def _restore(text, state, way, count, segments):
    """The scene's state file may no longer exist; the saved state replaces it."""
    try:
        simulation = Simulation(Scene.parse(text), _threads(way, count), segments)
    except (SceneError, StartStateError):
        alone = re.sub(r"(?m)^state = .*$", "", text)
        simulation = Simulation(Scene.parse(alone), _threads(way, count), segments)
    simulation.set_state(State.from_bytes(state))
    return simulation


def _reduce(self):
    threads = self.threads
    return _restore, (self.scene.text, self.state().bytes(), threads.way, threads.count, self.segments)


def install(simulation):
    """Makes the class picklable, without callbacks."""
    simulation.__reduce__ = _reduce
