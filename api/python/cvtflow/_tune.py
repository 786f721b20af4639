"""The cheapest detail, method and step for an accuracy."""

from __future__ import annotations

import os
from collections.abc import Sequence
from ctypes import byref
from typing import NamedTuple

from ._library import ON_ASKED, TuningInfo, c, encoded, in_si, interruptible, plain
from ._scene import Scene, opened


class Tuning(NamedTuple):
    """A scene with the settings for a target accuracy; the choice as text; the largest measured error; whether the choice came from the
    cache."""

    scene: Scene
    choice: str
    error: float
    kept: bool

    def __repr__(self) -> str:
        return f"<cvtflow.Tuning scene={self.scene!r}, choice={self.choice!r}, error={self.error!r}, kept={self.kept!r}>"


@plain("tune")
def tune(scene: Scene | str | os.PathLike[str], accuracy: float | str = 0.01, outputs: Sequence[str] = (), budget: float | str = 0.0,
         folder: str | os.PathLike[str] = "") -> Tuning:
    """The cheapest detail, method and step with which outputs (slip, efficiency, tight_tension, tips) are as accurate ("1 %"): measured, or
    taken from the cache. Takes seconds to minutes. Ctrl-C ends it."""
    opened_scene, info, asked = opened(scene), TuningInfo(), []
    function, names = ON_ASKED(lambda _: len(asked)), ",".join(outputs).encode() or None
    share, longest, place = in_si(accuracy, "accuracy", "1"), in_si(budget, "budget", "s"), encoded(folder, (str, os.PathLike)) or None

    def work():
        # tuned and info come before the message, which made() adds
        return Scene._made(lambda tuned, said: c.tune(opened_scene._handle, share, names, longest, place, function, None, tuned, byref(info),
                                                      said))

    tuned = interruptible(work, lambda: asked.append(True))
    return Tuning(tuned, info.choice.decode(), info.error, info.kept != 0)
