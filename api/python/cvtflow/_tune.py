"""The cheapest detail, method and step for an accuracy, found by measuring: a sweep over operating points for each choice.

Choices (levels of detail x methods x shares of the automatic step) run at every operating point in the order of their cost, and their outputs
are compared with those of the finest level at a quarter of its automatic step or less. The first whose errors, times a margin, are within the
target everywhere is taken; what ends early or does not close its energy balance never is.
"""

from __future__ import annotations

import itertools
import json
import math
import os
import random
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from . import _rows
from ._errors import ArgumentError, Error, SceneError, StartStateError, StateError
from ._known import suggestion
from ._library import described, in_si, plain
from ._scene import Scene, all_keys, opened
from ._simulation import Simulation, Threads
from ._sweep_file import SweepFile, file_text

MARGIN = 2.0  # errors at an untried point may be larger by this factor
_POINTS = 3  # the start and two near it: within 5 % of a settled point the machine shifts, with errors 0.9 to 5.7 times those at the point
_SPACING = 10e-6  # of samples: slip jumps as a pin enters, and one of 16 samples per pin period is 0.5 % of its mean at a small radius [s]
CONVERGED = 0.25  # largest difference of a reference to one with twice its step, as a share of the target
_SHARES, _REFERENCE_SHARES = (1.0, 0.5, 0.25), (0.5, 0.25, 0.125, 0.0625)  # of the automatic step
_GAINED = 4.0  # largest ratio of the errors of two steps, one of which is half the other
FIGURES = {  # name: scalar, and what an error is divided by; None: its expected value
    "slip": ("slip mean", lambda slip: max(abs(slip), 1e-4)),
    "efficiency": ("efficiency mean", lambda _: 1.0),  # in percentage points
    "losses": ("efficiency mean", lambda efficiency: abs(1.0 - efficiency)),
    "tight_tension": ("tight_tension mean", None), "slack_tension": ("slack_tension mean", None),
    "tips": ("pins/end_force mean", None), "ratio": ("ratio mean", None), "thrust_ratio": ("thrust_ratio mean", None)}
USUAL = ("slip", "efficiency", "tight_tension", "tips")
_AUTO = {"run.method": "auto", "run.step": "auto", "run.step_control": "fixed"}


class AccuracyError(StateError):
    """No choice meets the target."""


class Choice(NamedTuple):
    """A level of detail with settings "key=value" after it (empty: the scene's), a method, its step (0: automatic) [s], and what share of the
    automatic one that is (1: all of it, or a given step)."""

    detail: str
    method: str
    step: float = 0.0
    share: float = 1.0

    def text(self) -> str:
        """"fine, leapfrog-sweep, 1/2 of the automatic step\""""
        step = f"step {self.step:g} s" if self.step else "automatic step"
        return f"{self.detail or 'own detail'}, {self.method}, {f'1/{1.0 / self.share:g} of the automatic step' if self.share < 1.0 else step}"

    def scene(self, scene: Scene, state: str | None = None) -> Scene:
        """A scene with this choice. state: of its start, None: as the scene has it"""
        level, *changes = self.detail.split() or [""]
        scene = scene.with_(_AUTO)
        scene = scene.with_detail(level) if level else scene
        start = {} if state is None else {"start.state": state}
        return scene.with_(*changes, {"run.method": self.method, "run.step": self.step or "auto"} | start)


class Points:
    """Operating points: the cases of a sweep without a level of detail, whose scalars are the outputs.

    scene    base of the cases
    sweep    contents of the sweep's file, but for the scene
    outputs  (name, scalar of the sweep, what errors are divided by) of each
    say      called with what is measured
    only     cases that are points, as sweep.only of a sweep file
    """

    def __init__(self, scene: Scene, sweep: dict[str, Any], outputs: list[tuple[str, str, Any]],
                 say: Callable[[str], Any] = lambda text: None, threads: int = 0, only: Any = None) -> None:
        self.scene = scene.with_({"run.schedule": "serial", "run.threads": 1, "run.max_steps": 0, "run.max_wall": 0})
        self.outputs, self.names, self.say, self._sweep, self._threads = outputs, [], say, sweep, threads
        self._head = {"only": only} if only else {}
        self._settles = sweep.get("start", {}).get("mode") == "settle"
        self._folder = tempfile.TemporaryDirectory(prefix="cvtflow-tune-")
        self._states, self._probed = {}, {}

    def __enter__(self) -> Points:
        return self

    def __exit__(self, *_: Any) -> None:
        self._folder.cleanup()

    def _swept(self, scene, sweep, **head):
        """The folder of a sweep that has run."""
        folder = Path(tempfile.mkdtemp(dir=self._folder.name))
        (folder / "scene.toml").write_text(scene.text, encoding="utf-8")
        (folder / "sweep.toml").write_text(file_text(sweep, scene="scene.toml", **head), encoding="utf-8")
        SweepFile.read(folder / "sweep.toml").run(folder, self._threads)
        return folder

    def state(self, choice: Choice) -> str:
        """File of the state with which a choice begins: the scene's, or one settled at its level; empty: cases settle by themselves."""
        if choice.detail not in self._states:
            scene = choice._replace(step=0.0).scene(self.scene)
            try:
                Simulation(scene, Threads.caller())
                found = scene["start.state"]
            except StartStateError:
                found, scene = "", scene.with_("start.state=")
            if not found and not self._settles and scene["start.layout"] == "belt" and scene["start.settling_time"] > 0.0:
                sweep = {"axes": [{"key": "run.until", "values": [1e-5]}], "outputs": {"scalars": ["tight_tension mean"]}}
                found = str(next(self._swept(scene, sweep | {"start": {"mode": "shared"}}).rglob("*.state"), ""))
            self._states[choice.detail] = "" if self._settles else found
        return self._states[choice.detail]

    def scene_of(self, choice: Choice, scene: Scene, keep: Callable[[bytes], str]) -> Scene:
        """A scene with a choice. keep: writes a state of its own, with which that begins, and returns its path"""
        state = self.state(choice)
        return choice.scene(scene, keep(Path(state).read_bytes()) if state and state != scene["start.state"] else state)

    def probe(self, choice: Choice) -> tuple[str, float, float, float]:
        """(method, automatic step [s], evaluations times unknowns per simulated second, processor time per simulated second) of some steps."""
        key = choice.detail, choice.method, choice.step
        if key not in self._probed:
            simulation = Simulation(choice.scene(self.scene, self.state(choice)), Threads.caller())
            for step in range(400):
                if step == 100:  # in the beginning many tips first touch
                    before, begin, start = simulation.counters().evaluations, time.process_time(), simulation.time
                simulation.step()
            evaluations, passed = simulation.counters().evaluations - before, simulation.time - start
            self._probed[key] = (simulation.method, simulation.step_length, evaluations * simulation.size() / passed,
                                 (time.process_time() - begin) / passed)
        return self._probed[key]

    def run(self, choice: Choice, only: Sequence[int] = ()) -> list[tuple[list[float], str, str]]:
        """(outputs, objection, notes) of every point, or of some; an objection states why the outputs are invalid."""
        head = {"only": list(only)} if only else self._head
        rows = _rows.read(self._swept(choice.scene(self.scene, self.state(choice)), self._sweep, **head))
        cells = rows.cells
        keys = [column for column in rows.columns if column.key]
        self.names = self.names or [", ".join(_named(key.key, cells[key.name][row]) for key in keys) for row in range(rows.size)]
        made = []
        for row in range(rows.size):
            status, error = cells["status"][row], cells["error"][row]
            objection = "" if status == "ok" else error or f"{status}: its energy balance does not close" * (status == "unreliable") or status
            made.append(([cells[_rows.column_name(scalar)][row] for _, scalar, _ in self.outputs], objection, cells["notes"][row]))
        return made

    def errors(self, row: Any, expected: Any) -> list[float]:
        """Relative error of every output, with that of the expected (outputs, their errors); infinite where the run has none."""
        errors = []
        for (_, _, scale), value, right, known in zip(self.outputs, row[0], *expected):
            error = math.inf if row[1] else known + abs(value - right) / max(scale(right) if scale else abs(right), 1e-300)
            errors.append(math.inf if math.isnan(error) else error)
        return errors

    def references(self, agreement: float) -> list[tuple[Any, str]]:
        """((outputs, their errors), text) by point: the finest level at a quarter of its automatic step or less, such that twice that step has
        errors of at most `agreement`, which count as its own; None has no reference, and the text states why."""
        finest, found, rows = Choice(described("levels")["rows"][-1]["name"], "auto"), {}, {}
        for share in _REFERENCE_SHARES:
            self.say(f"reference, 1/{1.0 / share:g} of its automatic step")
            method, step, *_ = self.probe(finest)
            unknown = [point for point, (row, _) in found.items() if not row and not self._head]  # `only` numbers cases anew
            before, rows = rows, dict(zip(unknown or itertools.count(), self.run(finest._replace(step=share * step), unknown)))
            for point, row in rows.items():
                if found.get(point, (None,))[0]:
                    continue
                errors = self.errors(before[point], (row[0], [0.0] * len(row[0]))) if before and not row[1] else [math.inf]
                text = f"at {share:g} of its automatic step; twice that step has errors of {100 * max(errors):.2g} %"
                if max(errors) <= agreement:
                    unsteady = "; unsteady: its means still change (--settling, --average)" * ("unsteady" in row[2])
                    found[point] = (row[0], errors), f"{finest.detail}, {method} {text}{unsteady}"
                else:
                    found[point] = None, row[1] or f"{finest.detail} has not converged {text}, above {100 * agreement:.2g} %"
            if all(row for row, _ in found.values()):
                break
        return [found[point] for point in sorted(found)]


def _named(key, value):
    """A key with its value: load.torque = 230 N*m"""
    return f"{key} = {value:.4g} {all_keys()[key].unit}".removesuffix(" 1") if isinstance(value, (int, float)) else f"{key} = {value}"


def outputs_of(names: Sequence[str], pulleys: bool) -> list[tuple[str, str, Any]]:
    """(name, scalar, what errors are divided by) of figures and scalars by name; none: the usual ones. Raises SceneError."""
    for name in names:
        if name in FIGURES and not pulleys and not name.endswith("_tension"):
            raise SceneError(f"outputs: {name} requires pulleys, but this scene has none")
        if name not in FIGURES and " " not in name:
            raise SceneError(f'outputs: {name} is not one of {", ".join(FIGURES)}, nor a scalar such as "slip median"'
                             + suggestion(name, FIGURES))
    names = names or [name for name in USUAL if pulleys or name.endswith("_tension")]
    return [(name, *FIGURES.get(name, (name, None))) for name in names]


def _inputs(scene):
    """(key, lowest, highest, at t = 0) of the tables over time that act, and of a ring's speed. Raises SceneError where inputs cannot be held."""
    refused = ((scene["vehicle.mass"] > 0.0, "a [vehicle] cannot be tuned: the load follows from its speed; tune a scene without it at a speed "
                                             "and torque of its own, and use the result here"),
               (scene["hydraulics.mode"] != "none", f'hydraulics.mode "{scene["hydraulics.mode"]}" cannot be tuned: oil carries on what it '
                                                    'held; tune with "none", and use the result here'),
               (scene["drive.mode"] == "coupling" or scene["load.mode"] != "torque",
                'drive.mode "coupling" and load.mode "speed" and "coupling" cannot be tuned; tune with load.mode = "torque" and the torque '
                "that acts, and use the result here"))
    for found, text in refused:
        if found:
            raise SceneError(f"{scene.name}: {text}")
    for key in all_keys().values():
        if key.table and key.name.split(".")[0] not in ("vehicle", "cycle"):
            value = json.loads(scene.value(key.name))
            if not isinstance(value, list):
                yield key.name, value, value, value
            elif value and all(isinstance(row, list) and len(row) == 2 for row in value):
                numbers = [row[1] for row in value]
                yield key.name, min(numbers), max(numbers), numbers[0]  # no table begins before t = 0
    if scene["detail.pulleys"] == "absent":
        yield ("start.ring_speed", *3 * [scene["start.ring_speed"]])


def points_of(scene: Scene, settings: Settings, unseen: int = 0, say: Callable[[str], Any] = lambda text: None) -> Points:
    """The scene with its inputs as they are at t = 0, then each table over time at its lowest and highest value, the others as at t = 0; then two
    points between: tables somewhere between their ends; load and clamping, where they are constant, and the speed of a ring within 5 % of what
    they are. unseen: instead that number of further points between. Equal seeds (run.seed) give equal points."""
    inputs = list(_inputs(scene))
    start = [at for *_, at in inputs]
    rows = [start] + [[*start[:k], end, *start[k + 1:]] for k, (_, low, high, _) in enumerate(inputs) for end in (low, high) if end != start[k]]
    names = ["start"] + [_named(key, end) for key, low, high, at in inputs for end in (low, high) if end != at]
    inputs = [(key, low, high) if low < high or key.split(".")[0] not in ("load", "clamping", "start") else (key, *sorted((0.95 * at, 1.05 * at)))
              for key, low, high, at in inputs]
    drawn = random.Random(scene["run.seed"])
    between = [[drawn.uniform(low, high) for _, low, high in inputs] for _ in range(_POINTS + unseen)]
    between = between[_POINTS:] if unseen else between[1:_POINTS]
    rows = between if unseen else rows + between
    named = [", ".join(_named(key, value) for (key, low, high), value in zip(inputs, row) if low < high) for row in between]
    names = named if unseen else names + named
    outputs = outputs_of(settings.outputs, scene["detail.pulleys"] != "absent")
    columns = {"run.until": [settings.settling + settings.average] * len(rows)}
    columns |= {key: list(values) for (key, low, high), values in zip(inputs, zip(*rows)) if low < high}
    sweep = {"axes": [{"zip": [{"key": key, "values": values} for key, values in columns.items()]}],
             "outputs": {"scalars": list({scalar: None for _, scalar, _ in outputs}), "from": f"{settings.settling} s"}}
    points = Points(scene.with_({"run.output_interval": _SPACING}), sweep, outputs, say)
    points.names = names
    return points


class Settings(NamedTuple):
    """accuracy: largest error of every output; outputs: figures or scalars, none: the usual; levels: as Choice.detail, none: all, and the
    scene's; methods: METHOD or METHOD@STEP, none: auto; settling: before the averages [s]; average [s]; all: measure every choice"""

    accuracy: float = 0.01
    outputs: Sequence[str] = ()
    levels: Sequence[str] = ()
    methods: Sequence[str] = ()
    settling: float = 20e-3
    average: float = 16e-3
    all: bool = False


def _bases(points, settings, left_out):
    """A choice with what probe() measured of every level with every method that it takes."""
    known = [row["name"] for row in described("levels")["rows"]]
    scene = points.scene.with_(_AUTO)
    own = [] if any(scene == scene.with_detail(level) for level in known) else [""]  # the scene's detail has no name
    bases = {}
    for level in settings.levels or known + own:
        for given in settings.methods or ["auto"]:
            method, _, step = given.partition("@")
            points.say("costs of levels of detail")
            try:
                probed = points.probe(base := Choice(level, method, in_si(step, "methods", "s") if step else 0.0))
                bases.setdefault(base._replace(method=probed[0]), probed)
            except Error as error:
                left_out.append(f"{given} at {level or 'the detail of the scene'}: {error}")
    if not bases:
        raise StateError(f"{points.scene.name}: no choice can be tried:\n  " + "\n  ".join(left_out))
    return bases


def search(points: Points, settings: Settings) -> dict[str, Any]:
    """What `cvtflow tune --json` prints: every choice in the order of its cost with its errors, and the number of the chosen one (None: none)."""
    begin = time.monotonic()
    found = {"scene": points.scene.name, "provenance": described("build"), "accuracy": settings.accuracy, "margin": MARGIN,
             "outputs": [name for name, *_ in points.outputs], "points": [], "references": [], "left_out": [], "chosen": None,
             "choices": [], "unseen": [], "wall": 0.0}
    for choice, (_, step, work, seconds) in _bases(points, settings, found["left_out"]).items():
        for share in (1.0,) if choice.step else _SHARES:
            found["choices"].append(Choice(*choice[:2], choice.step or (share < 1.0) * share * step, share)._asdict() | {
                "seconds_per_second": seconds / share, "work_per_second": work / share, "tried": False, "errors": [], "worst": "",
                "front": False, "standing": ""})
    found["choices"].sort(key=lambda row: row["work_per_second"])  # not by time: every run and machine chooses the same
    references = points.references(CONVERGED * settings.accuracy)
    for name, (row, text) in zip(points.names, references):
        (found["references"] if row else found["left_out"]).append(text if row else f"{name}: {text}")
        found["points"] += [name] if row else []
    if not found["points"]:
        raise StateError(f"{points.scene.name}: no operating point has a reference run for an accuracy of {100 * settings.accuracy:g} %:\n"
                         "  " + "\n  ".join(found["left_out"]))
    for number, row in enumerate(found["choices"]):
        _judge(points, settings, found, references, row)
        if row["standing"] == "chosen":
            found["chosen"] = number
    least = math.inf
    for error, row in [(max(row["errors"]), row) for row in found["choices"] if row["tried"]]:  # by rising cost
        row["front"], least = error < least, min(error, least)
    found["wall"] = time.monotonic() - begin
    return found


def choice_of(row: dict[str, Any]) -> Choice:
    """The Choice of a row of search()."""
    return Choice(*map(row.get, Choice._fields))


def _judge(points, settings, found, references, row):
    """Measures a choice at all points, unless it costs more than the chosen one, or its level is what is wrong."""
    allowed = settings.accuracy / found["margin"]
    if found["chosen"] is not None and not settings.all:
        row["standing"] = "more expensive than the chosen one"
        return
    similar = (other for other in found["choices"] if other["detail"] == row["detail"] and 2.0 * row["share"] >= other["share"] > row["share"])
    if not settings.all and any(other["tried"] and _GAINED * allowed < max(other["errors"]) < math.inf for other in similar):
        row["standing"] = "insufficient detail"
        return
    choice = choice_of(row)
    points.say(choice.text())
    try:
        rows = points.run(choice)
    except Error as error:
        rows = [([], str(error), "")] * len(references)
    judged = [(points.errors(is_, reference[0]), name, is_[1]) for is_, reference, name in zip(rows, references, points.names) if reference[0]]
    errors, row["worst"], objection = max(judged, key=lambda each: max(each[0]))
    row["errors"], row["tried"] = [max(each) for each in zip(*(errors for errors, *_ in judged))], True
    worst = max(range(len(errors)), key=errors.__getitem__)
    row["standing"] = "within the target" if found["chosen"] is not None else "chosen"
    if not errors[worst] <= allowed:
        row["standing"] = (f"{objection} at {row['worst']}" if objection
                           else f"{found['outputs'][worst]} has an error of {100 * errors[worst]:.2g} % at {row['worst']}")


def why_none(found: dict[str, Any]) -> str:
    """Reason why search() has chosen nothing, with the nearest choice."""
    nearest = min((row for row in found["choices"] if row["tried"]), key=lambda row: max(row["errors"]))
    return (f"no tried choice is within {100 * found['accuracy']:g} % (with a margin of {found['margin']:g}); "
            f"nearest: {choice_of(nearest).text()}: {nearest['standing']}")


class Tuning(NamedTuple):
    """A scene with the settings for a target accuracy; the choice as text; the largest measured error."""

    scene: Scene
    choice: str
    error: float


def tuned(points: Points, settings: Settings, scene: Scene, keep: Callable[[bytes], str] = lambda state: "") -> Tuning:
    """What a search finds for a scene. keep: writes a state with which the choice begins, and returns its path; else the scene settles by itself.
    Raises AccuracyError."""
    found = search(points, settings)
    if found["chosen"] is None:
        raise AccuracyError(f"{found['scene']}: {why_none(found)}")
    choice = choice_of(row := found["choices"][found["chosen"]])
    return Tuning(points.scene_of(choice, scene, keep), choice.text(), max(row["errors"]))


@plain("tune")
def tune(scene: Scene | str | os.PathLike[str], accuracy: float | str = 0.01, outputs: Sequence[str] = ()) -> Tuning:
    """The cheapest detail, method and step with which outputs (slip, efficiency, tight_tension, tips) are as accurate ("1 %"), measured in
    seconds to minutes. Ctrl-C ends it."""
    scene, target = opened(scene), in_si(accuracy, "accuracy", "1")
    if not 0.0 < target <= 0.5:
        raise ArgumentError(f"accuracy: {target:g} is outside (0, 0.5]")
    settings = Settings(target, tuple(outputs))
    with points_of(scene, settings) as points:
        return tuned(points, settings, scene)
