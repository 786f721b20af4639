"""Tuned scenes: the choice that was measured for a scene and an accuracy, kept by content for the next time."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from . import _tune
from ._errors import ArgumentError, Error
from ._library import described, encoded, in_si, plain
from ._scene import Scene, opened
from ._simulation import Simulation, Threads
from ._tune import Settings


class Tuning(NamedTuple):
    """A scene with the settings for a target accuracy; the choice as text; the largest measured error; whether the choice came from the
    cache."""

    scene: Scene
    choice: str
    error: float
    kept: bool


def usual_folder() -> str:
    """Folder of the cache: $XDG_CACHE_HOME/cvtflow, else ~/.cache/cvtflow."""
    named = os.environ.get("XDG_CACHE_HOME", "")
    return os.path.join(named if os.path.isabs(named) else os.path.expanduser("~/.cache"), "cvtflow")


def key_of(scene: Scene, settings: Settings) -> str:
    """Hash of all that a choice depends on: scene with the content of its state, settings, program. Not of the budget: a choice that was found
    within one does not depend on it."""
    state = scene["start.state"]
    parts = [scene.with_("start.state=").text, repr(settings._replace(budget=0.0, all=False)), json.dumps(described("build"))]
    return hashlib.sha256("\n".join(parts).encode() + (Path(state).read_bytes() if state else b"")).hexdigest()[:32]


def tuned(scene: Scene, settings: Settings, folder: str, say: Callable[[str], Any] = lambda text: None) -> tuple[Tuning, float]:
    """The Tuning of a scene as kept in the folder, else measured and kept there; wall time of the search [s]. Raises AccuracyError."""
    place = os.path.join(folder, key_of(scene, settings))
    try:
        known = read_kept(place + ".json")
        found = Tuning(Scene.parse(known["scene"], scene.name + ".toml"), known["choice"], known["error"], True)
        Simulation(found.scene, Threads.caller())
        return found, 0.0
    except (ValueError, KeyError, TypeError, Error):
        pass  # none, or a damaged one
    with _tune.points_of(scene, settings, say=say) as points:
        found, wall = settled_on(points, settings, scene, place + ".state")
    with contextlib.suppress(OSError):  # the next time it is measured again
        replace(place + ".json", json.dumps({"scene": found.scene.text, "choice": found.choice, "error": found.error}).encode())
    return found, wall


def settled_on(points: _tune.Points, settings: Settings, scene: Scene, state_file: str) -> tuple[Tuning, float]:
    """The Tuning that a search finds, and its wall time [s]. A state with which the choice begins goes to a file, or where that cannot be
    written, the scene settles by itself. Raises AccuracyError."""
    row = _tune.taken(found := _tune.search(points, settings))
    choice = _tune.choice_of(row)

    def keep(data):
        with contextlib.suppress(OSError):
            replace(state_file, data)
            return os.path.abspath(state_file)
        return ""

    return Tuning(points.scene_of(choice, scene, keep), choice.text(), max(row["errors"]), False), found["wall"]


def read_kept(path: str) -> dict[str, Any]:
    """What a JSON file contains; {}: it is absent or damaged."""
    try:
        with open(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)), encoding="utf-8") as file:  # of a pipe nothing is waited for
            return json.load(file)
    except (OSError, ValueError):
        return {}


def replace(path: str, data: bytes) -> None:
    """Writes a file of the cache, or of a sweep's folder."""
    from ._output import Output

    os.makedirs(os.path.dirname(path), exist_ok=True)
    Output(path, force=True).write(data)


@plain("tune")
def tune(scene: Scene | str | os.PathLike[str], accuracy: float | str = 0.01, outputs: Sequence[str] = (), budget: float | str = 0.0,
         folder: str | os.PathLike[str] = "") -> Tuning:
    """The cheapest detail, method and step with which outputs (slip, efficiency, tight_tension, tips) are as accurate ("1 %"): measured, or
    taken from the cache. Takes seconds to minutes. Ctrl-C ends it."""
    scene, target, longest = opened(scene), in_si(accuracy, "accuracy", "1"), in_si(budget, "budget", "s")
    if not 0.0 < target <= 0.5:
        raise ArgumentError(f"accuracy: {target:g} is outside (0, 0.5]")
    place = os.fsdecode(encoded(folder, (str, os.PathLike))) or usual_folder()
    return tuned(scene, Settings(target, tuple(outputs), budget=longest), place)[0]
