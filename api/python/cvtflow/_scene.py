"""Scenes in Python: resolution of key names, values to and from TOML, the list of keys."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from functools import lru_cache
from html import escape

import numpy as np

from ._cvtflow import Scene, SceneError, scene_keys
from ._known import suggestion


@lru_cache(maxsize=None)
def all_keys():
    """KeyInfo of every key, by name."""
    return {key.name: key for key in scene_keys()}


def ready_scenes() -> dict[str, str]:
    """The scenes that Scene.ready() finds, as a dict: their descriptions by name. They come with cvtflow, or are in ./scenes or in the
    folders of the environment variable CVTFLOW_SCENES. Scenes that cannot be read are left out."""
    found = {}
    for name in Scene.ready_names():
        try:
            found[name] = Scene.ready(name).description
        except SceneError:
            pass
    return found


def toml(value, table=False):
    """A value as TOML. table: of a key that may be a table over time, a pandas.Series or two arrays (time, value) are accepted."""
    if table and hasattr(value, "index") and hasattr(value, "to_numpy"):
        value = np.column_stack([np.asarray(value.index, dtype=float), value.to_numpy()])
    if table and isinstance(value, tuple) and len(value) == 2 and all(isinstance(each, np.ndarray) for each in value):
        value = np.column_stack(value)
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name} = {toml(each)}" for name, each in value.items()) + "}"
    if isinstance(value, (int, float)):
        return repr(value)
    try:
        return "[" + ", ".join(toml(each) for each in value) + "]"
    except TypeError:
        raise TypeError(f"{value!r} is no value of a key: numbers, texts, lists and dicts are") from None


def value_of(text):
    """A value from its TOML as the library writes it, which is JSON as well."""
    return json.loads(text)


def _wrong(message):
    error = SceneError(message)
    error.code = "scene"
    return error


def _acts(scene, key):
    """Whether a key has an effect: drive.torque does in drive.mode "torque" alone."""
    section, name = key.split(".")
    mode = all_keys().get(section + ".mode")
    return mode is None or name not in mode.choices or value_of(scene.value(mode.name)) == name


def resolve(scene, name):
    """The key of a name, of a name with __ for the dot, or of a last part that no other effective key has."""
    key = name.replace("__", ".")
    if key in all_keys() or "." in key:
        return key
    meant = [each for each in all_keys() if each.endswith("." + key)]
    acting = [each for each in meant if _acts(scene, each)] or meant
    if len(acting) == 1:
        return acting[0]
    if acting:
        raise _wrong(f"{name}: {' or '.join(acting)}? (in keywords write __ for the dot)")
    raise _wrong(f"{name}: unknown key" + suggestion(key, {each.split(".")[1] for each in all_keys()} | set(all_keys())))


def flat(scene, values):
    """Key and value of nested or dotted names."""
    for name, value in values.items():
        if isinstance(value, Mapping) and name.replace("__", ".") not in all_keys() and "." not in name:
            yield from flat(scene, {f"{name}.{inner}": each for inner, each in value.items()})
        else:
            yield resolve(scene, name), value


def settings_of(scene, given, keywords):
    """Settings "key=value" from what with_() was given: such texts, dicts, keywords."""
    settings = []
    for each in [*given, keywords]:
        if isinstance(each, str):
            settings.append(each)
        elif isinstance(each, Mapping):
            pairs = list(flat(scene, each))
            settings += [f"{key}={toml(value, key in all_keys() and all_keys()[key].table)}" for key, value in pairs]
        else:
            raise TypeError(f"with_() takes dicts, keywords and texts \"key=value\", not {type(each).__name__}")
    return settings


def item(scene, name):
    """scene[name]."""
    try:
        key = resolve(scene, name)
        value = value_of(scene.value(key))
    except ValueError as error:  # also ArgumentError
        raise KeyError(str(error)) from None
    return np.array(value) if all_keys()[key].table and isinstance(value, list) else value


class Keys(Mapping):
    """The keys of scenes: a mapping from names to KeyInfo, displayed as a table."""

    def __init__(self, part=""):
        self._keys = {name: key for name, key in all_keys().items() if part in name}

    def __getitem__(self, name):
        if name not in self._keys:
            raise KeyError(name + suggestion(name, self._keys))
        return self._keys[name]

    def __iter__(self):
        return iter(self._keys)

    def __len__(self):
        return len(self._keys)

    def _ipython_key_completions_(self):
        return list(self._keys)

    def _rows(self):
        return [(key.name, default_text(key), _range(key), key.help) for key in self._keys.values()]

    def __repr__(self):
        rows = [("key", "default", "range", "help"), *self._rows()]
        widths = [max((len(row[k]) for row in rows), default=0) for k in range(3)]
        return "\n".join("  ".join([*(row[k].ljust(widths[k]) for k in range(3)), row[3]]).rstrip() for row in rows)

    def _repr_html_(self):
        head = "".join(f"<th>{name}</th>" for name in ("key", "default", "range", "help"))
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in self._rows())
        return f"<table><tr>{head}</tr>{body}</table>"


def _unit(key):
    return "" if key.unit in ("", "1") else " " + key.unit


def default_text(key):
    """The default of a KeyInfo, as it is entered."""
    value = key.default
    return value if isinstance(value, str) else (f"{value:.6g}" if isinstance(value, float) else toml(value)) + _unit(key)


def _range(key):
    numbers = f"{key.range[0]:g} to {key.range[1]:g}{_unit(key)}" if key.range else ""
    return " or ".join(each for each in (numbers, ", ".join(key.choices)) if each)


def key_repr(key):
    """Display of a KeyInfo."""
    range_text = "one of " + _range(key) if key.choices and not key.range else _range(key)
    return f"<cvtflow.KeyInfo {key.name}: default {default_text(key)}{range_text and ', ' + range_text}; {key.help}>"
