"""Sweeps with [accuracy]: tuned at the corners of their axes before they run; then some cases run again at reference quality.

DIR/tuned.toml and tuned.scene.toml are the sweep at the chosen level; DIR/accuracy.json has the choice and the errors of the verified cases.
"""

import json
import os
import random

from . import _rows, _tune
from ._errors import StateError
from ._library import described, in_si
from ._output import Output
from ._scene import Scene, flat, opened
from ._sweep_file import file_text


def _absolute(value, folder):
    """A value of a sweep file, whose paths of CSV files are relative to its folder."""
    if isinstance(value, dict):
        return {name: os.path.join(folder, each) if name == "csv" else _absolute(each, folder) for name, each in value.items()}
    return [_absolute(each, folder) for each in value] if isinstance(value, list) else value


def read(path):
    """(the Scene of a sweep file with its [set], the file's other sections)"""
    import tomllib

    folder = os.path.dirname(os.path.abspath(path))
    with open(path, "rb") as file:
        sweep = _absolute(tomllib.load(file), folder)
    head = sweep.pop("sweep")
    beside = os.path.join(folder, head["scene"])
    scene = opened(beside if os.path.isfile(beside) else head["scene"])
    if "detail" in head:
        scene = scene.with_detail(head["detail"])
    values = dict(flat(scene, sweep.pop("set", {})))
    if values.get("start.state"):
        values["start.state"] = os.path.join(folder, values["start.state"])
    return scene.with_(values), sweep, head.get("name") or os.path.splitext(os.path.basename(path))[0]


def _points(scene, sweep, only, say, threads):
    """Points of some cases of a sweep."""
    outputs = sweep["outputs"] | {"records": False}
    scalars = [(text, text, None) for text in outputs["scalars"]]
    own = {section: values for section, values in sweep.items() if section not in ("accuracy", "budget")}
    return _tune.Points(scene, own | {"outputs": outputs}, scalars, say=say, threads=threads, only=only)


def tune(path, folder, threads=0, say=lambda text: None):
    """Writes DIR/tuned.toml for a sweep file. Raises AccuracyError."""
    scene, sweep, name = read(path)
    target = sweep["accuracy"]["target"]
    settings = _tune.Settings(accuracy=in_si(target, "target", "1"))
    given = {"scene": scene.text, "sweep": sweep, "build": described("build")}
    known = _rows.accuracy_of(folder)
    if {key: known.get(key) for key in given} != given:
        if os.path.exists(os.path.join(folder, "sweep.json")):
            raise StateError(f"{folder}: results of another sweep; use another folder (-o)")
        with _points(scene, sweep, "corners", say, threads) as points:
            os.makedirs(folder, exist_ok=True)
            found = _tune.tuned(points, settings, scene, lambda state: _write(folder, "tuned.state", state))
        known = given | {"name": name, "target": settings.accuracy, "choice": found.choice, "at_corners": found.error,
                         "scalars": sweep["outputs"]["scalars"], "errors": {}}
        text = file_text({section: values for section, values in sweep.items() if section != "accuracy"}, scene="tuned.scene.toml", name=name)
        for file, data in (("tuned.scene.toml", found.scene.text), ("tuned.toml", text), ("accuracy.json", json.dumps(known))):
            _write(folder, file, data.encode())
    say(f"{name}: {known['choice']} for {100 * settings.accuracy:g} % (largest error at the corners: {100 * known['at_corners']:.2g} %)")


def _write(folder, name, data):
    """Writes a file of a sweep's folder. Returns its path."""
    file = Output(os.path.abspath(os.path.join(folder, name)), force=True)
    file.write(data)
    return file.path


def verify(folder, threads=0, say=lambda text: None):
    """Runs cases of a finished sweep again at reference quality, and adds their errors to DIR/accuracy.json. Returns a text and whether at most
    one in twenty misses the target."""
    known, rows = _rows.accuracy_of(folder), _rows.read(folder)
    scene, sweep = Scene.parse(known["scene"]), known["sweep"]
    accuracy = {"verify": 10, "seed": 0} | sweep["accuracy"]
    cases = sorted(random.Random(accuracy["seed"]).sample(range(rows.size), min(rows.size, accuracy["verify"])))
    cases = [case for case in cases if rows.cells["status"][case] == "ok" and str(case) not in known["errors"]]
    if cases:
        cells = [rows.cells[_rows.column_name(scalar)] for scalar in known["scalars"]]
        with _points(scene, sweep, cases, say, threads) as points:
            references = points.references(_tune.CONVERGED * known["target"])
        for case, (reference, text) in zip(cases, references):
            if reference:
                known["errors"][str(case)] = points.errors(([values[case] for values in cells], ""), reference)
            else:
                say(f"not verified: case {case}: {text}")
        _write(folder, "accuracy.json", json.dumps(known).encode())
    errors = list(known["errors"].values())
    missed = sum(not max(each) <= known["target"] for each in errors)
    worst = ", ".join(f"{name} {100 * max(each):.2g} %" for name, each in zip(known["scalars"], zip(*errors)))
    held = 20 * missed <= len(errors) and bool(errors or not accuracy["verify"])
    return (f"{known['name']}: {'' if held else 'misses its target: '}{len(errors)} case{'s' * (len(errors) != 1)} verified, {missed} beyond "
            f"{100 * known['target']:g} %" + f"; at most: {worst}" * bool(errors)), held
