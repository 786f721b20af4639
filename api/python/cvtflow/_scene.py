"""Scenes: immutable descriptions, their keys, values to and from TOML."""

from __future__ import annotations

import ctypes
import dataclasses
import json
import os
from collections.abc import Iterator, Mapping
from functools import lru_cache
from html import escape
from typing import Any

from ._errors import SceneError
from ._known import suggestion
from ._library import Owned, c, described, encoded, made, plain, text_of


@dataclasses.dataclass(frozen=True, repr=False)
class KeyInfo:
    """A key of scenes."""

    name: str  #: e.g. load.torque
    unit: str  #: SI unit; 1 for a plain number, empty if the value is not a number
    range: tuple[float, float] | None  #: smallest and largest allowed value, in the unit; None if the value is not a number
    default: Any  #: default value
    source: str  #: source of the default
    choices: list[str]  #: allowed names; empty if the value is not a name
    table: bool  #: whether the value may be a table over time
    help: str  #: meaning

    def __repr__(self) -> str:
        allowed = "one of " + _range(self) if self.choices and not self.range else _range(self)
        return f"<cvtflow.KeyInfo {self.name}: default {default_text(self)}{allowed and ', ' + allowed}; {self.help}>"


@lru_cache(maxsize=None)
def all_keys() -> dict[str, KeyInfo]:
    """KeyInfo of every key, by name."""
    return {row["name"]: KeyInfo(row["name"], row["unit"], row["range"] and tuple(row["range"]), row["default"], row["source"], row["choices"],
                                 row["table"], row["text"]) for row in described("keys")}


def scene_keys() -> list[KeyInfo]:
    """All keys of scenes, section by section."""
    return list(all_keys().values())


def ready_scenes() -> dict[str, str]:
    """The scenes that Scene.ready() finds, as a dict: their descriptions by name. They come with cvtflow, or are in ./scenes or in the
    folders of the environment variable CVTFLOW_SCENES. Scenes that cannot be read are left out."""
    rows = json.loads(text_of(c.describe, b"scenes"))
    return {row["name"]: row["text"] for row in rows if row["text"] is not None}


class Scene:
    """What is simulated: an immutable description, read and checked as a whole."""

    @plain("Scene")
    def __init__(self, values: Mapping[str, Any] | str | os.PathLike[str] | None = None, /, **more: Any) -> None:
        """A scene of its own: Scene({"chain": {"pins": 24}, "load.torque": "8 N*m"}, run__until="1 ms"), as for with_(). All other keys have
        their defaults. A path ("my.toml") or the name of a ready scene reads that one."""
        own = values is None or isinstance(values, Mapping)
        scene = Scene.parse("") if own else opened(values)
        self._own((scene.with_(values or {}, **more) if own else scene.with_(**more))._held)

    def _own(self, held):
        self._held, self._handle = held, held.handle

    @staticmethod
    def _made(function, *arguments):
        scene = Scene.__new__(Scene)
        scene._own(Owned(made(function, *arguments), c.scene_release))
        return scene

    @staticmethod
    @plain("Scene.read")
    def read(path: str | os.PathLike[str]) -> Scene:
        """Reads a scene file. Raises SceneError with every problem in it."""
        place = encoded(path, (str, os.PathLike))
        if c.alone and os.path.isfile(path):
            with open(path, encoding="utf-8") as file:
                return Scene._made(c.scene_parse, encoded(file.read()), place)
        return Scene._made(c.scene_read, place)

    @staticmethod
    @plain("Scene.parse")
    def parse(text: str, name: str = "scene.toml") -> Scene:
        """A scene given as TOML; name replaces the file name in messages, start.state is relative to its folder."""
        return Scene._made(c.scene_parse, encoded(text), encoded(name))

    @staticmethod
    @plain("Scene.ready")
    def ready(name: str) -> Scene:
        """A scene that comes with cvtflow, e.g. "baseline"."""
        return Scene._made(c.scene_ready, encoded(name))

    def with_(self, *settings: Mapping[str, Any] | str, **values: Any) -> Scene:
        """This scene with other values: with_({"load": {"torque": "8 N*m"}}), with_({"load.torque": 8}), with_(load__torque=8),
        with_(until="1 ms") if the last part is unique, or with_("load.torque=8 N*m") as --set of the program. Numbers are in SI, texts carry
        their units; a table over time is an array [points, (time, value)]."""
        texts = [encoded(each) for each in settings_of(self, settings, values)]
        return Scene._made(c.scene_with, self._handle, (ctypes.c_char_p * len(texts))(*texts), len(texts))

    @plain("Scene.with_detail")
    def with_detail(self, preset: str) -> Scene:
        """This scene at a level of detail: rigid, fine, full."""
        return Scene._made(c.scene_with_detail, self._handle, encoded(preset))

    @staticmethod
    @plain("Scene.keys")
    def keys(part: str = "") -> Keys:
        """KeyInfo of all keys by name, or of those whose name contains `part`."""
        encoded(part)
        return Keys(part)

    @plain("Scene.__getitem__")
    def __getitem__(self, key: str) -> Any:
        """Value of a key: a number in SI, a text, a truth value, a list, or an array [points, (time, value)]."""
        encoded(key)
        return item(self, key)

    def __iter__(self) -> Iterator[str]:
        return iter(all_keys())

    @plain("Scene.value")
    def value(self, key: str) -> str:
        """Value of a key, as TOML."""
        return text_of(c.scene_value, self._handle, encoded(key))

    @property
    def name(self) -> str:
        """Name of the scene."""
        return c.scene_name(self._handle).decode()

    @property
    def description(self) -> str:
        """Description, one line."""
        return value_of(self.value("scene.description"))

    @property
    def text(self) -> str:
        """The scene as TOML with every key."""
        return text_of(c.scene_text, self._handle)

    def _values(self):
        """The text, with a floor that the scene does not give (a comment there) as if it did: scenes are equal if all keys have equal values."""
        return self.text.replace("\n# ", "\n")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def __reduce__(self):
        return Scene.parse, (self.text,)

    def _repr_html_(self) -> str:
        return f"<details><summary>{escape(self.name)}: {escape(self.description)}</summary><pre>{escape(self.text)}</pre></details>"

    def __repr__(self) -> str:
        return (f"<cvtflow.Scene {self.name}: {self['chain.pins']} pins, ratio {self['start.ratio']:g}, "
                f"until {self['run.until']:g} s>")


def is_path(scene: Any) -> bool:
    """Whether a scene is given by its file and not by the name of a ready one."""
    return isinstance(scene, os.PathLike) or "/" in scene or scene.endswith(".toml")


def opened(scene: Any) -> Scene:
    """A Scene: of its own, by the name of a ready one, or from a file. Raises the TypeError of plain()."""
    if isinstance(scene, Scene):
        return scene
    encoded(scene, (str, os.PathLike))
    return Scene.read(scene) if is_path(scene) else Scene.ready(scene)


def toml(value, table=False):
    """A value as TOML. table: of a key that may be a table over time, a pandas.Series or two arrays (time, value) are accepted."""
    if table and hasattr(value, "index") and hasattr(value, "to_numpy"):
        value = list(zip(map(float, value.index), value.to_numpy().tolist()))
    if table and isinstance(value, tuple) and len(value) == 2 and all(hasattr(each, "tolist") for each in value):
        value = list(zip(*(each.tolist() for each in value)))
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
        raise SceneError(f"{name}: {' or '.join(acting)}? (in keywords write __ for the dot)")
    raise SceneError(f"{name}: unknown key" + suggestion(key, {each.split(".")[1] for each in all_keys()} | set(all_keys())))


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
    if not (all_keys()[key].table and isinstance(value, list)):
        return value
    import numpy as np

    return np.array(value)


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
