"""Tuned scenes: the choice that was measured for a scene and an accuracy, kept by content for the next time."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from . import _tune
from ._errors import ArgumentError, Error
from ._library import described, encoded, in_si, plain
from ._scene import Scene, opened
from ._simulation import Simulation, Threads
from ._tune import Choice, Settings, chosen


class Tuning(NamedTuple):
    """A scene with the settings for a target accuracy; the choice as text; the largest measured error; whether the choice came from the
    cache."""

    scene: Scene
    choice: str
    error: float
    kept: bool

    def __repr__(self) -> str:
        return f"<cvtflow.Tuning scene={self.scene!r}, choice={self.choice!r}, error={self.error!r}, kept={self.kept!r}>"


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


def tuned(scene: Scene, settings: Settings, folder: str, say: Callable[[str], Any] = lambda text: None) -> tuple[Choice, float, float, Any, Any]:
    """(choice, step [s], largest error, file of its start state or None: the scene's, wall time of the search [s] or None: it was kept) for a
    scene: as kept in the folder, else measured and kept there. Raises AccuracyError."""
    place = os.path.join(folder, key_of(scene, settings))
    try:
        with open(os.open(place + ".json", os.O_RDONLY | os.O_NONBLOCK), encoding="utf-8") as file:
            kept = json.load(file)
        choice, state = Choice(*kept["choice"]), place + ".h5" if kept["state"] else None
        Simulation(chosen(scene, choice, kept["step"], state), Threads.caller())
        return choice, kept["step"], kept["error"], state, None
    except (OSError, ValueError, KeyError, TypeError, Error):
        pass  # none, or a damaged one
    with _tune.points_of(scene, settings, say=say) as points:
        row = _tune.taken(found := _tune.search(points, settings))
        choice, error = _tune.choice_of(row), max(row["errors"])
        state = points.state(choice)
        own = state == scene["start.state"]
        try:
            os.makedirs(folder, exist_ok=True)
            if not own:
                replace(place + ".h5", Path(state).read_bytes())
            replace(place + ".json", json.dumps({"choice": choice, "step": row["step"], "error": error, "state": not own}).encode())
        except OSError:  # the next time it is measured again
            return choice, row["step"], error, None if own else "", found["wall"]
        return choice, row["step"], error, None if own else place + ".h5", found["wall"]


def replace(path: str, data: bytes) -> None:
    """Writes a file, which takes its name when it is complete."""
    with tempfile.NamedTemporaryFile(dir=os.path.dirname(path), delete=False) as file:
        file.write(data)
    os.replace(file.name, path)


@plain("tune")
def tune(scene: Scene | str | os.PathLike[str], accuracy: float | str = 0.01, outputs: Sequence[str] = (), budget: float | str = 0.0,
         folder: str | os.PathLike[str] = "") -> Tuning:
    """The cheapest detail, method and step with which outputs (slip, efficiency, tight_tension, tips) are as accurate ("1 %"): measured, or
    taken from the cache. Takes seconds to minutes. Ctrl-C ends it."""
    scene, target, longest = opened(scene), in_si(accuracy, "accuracy", "1"), in_si(budget, "budget", "s")
    if not 0.0 < target <= 0.5:
        raise ArgumentError(f"accuracy: {target:g} is outside (0, 0.5]")
    place = os.fsdecode(encoded(folder, (str, os.PathLike))) or usual_folder()
    choice, step, error, state, wall = tuned(scene, Settings(target, tuple(outputs), budget=longest), place)
    return Tuning(chosen(scene, choice, step, state), choice.text(), error, wall is None)
