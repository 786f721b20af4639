"""The library: the functions of cvtflow.h by ctypes, and what the library knows, as it describes it."""

from __future__ import annotations

import collections
import ctypes
import functools
import inspect
import json
import os
import sys
import threading
import weakref
from collections.abc import Callable
from ctypes import byref, c_double, c_int32, c_int64, c_size_t, c_uint32, c_uint64, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

from . import _errors

NAME = "cvtflow.dll" if os.name == "nt" else "libcvtflow.so.0.4"

# Name without cvtflow_, result and arguments. v nothing; s text; p address of a handle, an array or a result; i int32; d double; n size_t;
# u uint64; f a function. Those of the first table take microseconds and keep Python's lock: an ended one would wait for it as long as another
# thread computes. Those of the second step, copy or touch files, and release it.
BRIEF = """version s; code_name s i; describe i s p p p; quantity i s s p p; scene_name s p; scene_value i p s p p p; scene_release v p;
method s p; time d p; step_length d p; cancel v p; state_get i p p p p; hash u p; input_set i p i d p; input_get i p i p p; size n p;
unknowns p p; channel_count n p; channel_describe i p n p p; channel_find i p s p p; channel_values i p n p p p; counters_get i p p;
notices i p f p p; energy_get i p p; transitions i p p p p; on_log i p f p p; on_output i p d f p p; on_transition i p f p p;
input_describe i i p p"""
LONG = """shutdown i; scene_read i s p p; scene_parse i s s p p; scene_ready i s p p; scene_with i p p n p p; scene_with_detail i p s p p;
scene_text i p p p p; create i p p p p; copy i p p p; destroy v p; advance_to i p d p; step i p p; largest_stable_step i p p p;
state_set i p p n p; state_check i p n p; rhs i p d p p n p; record_begin i p s i p; record_finish i p i p; sweep_run i s s i i f p p;
record_check i s p"""
TYPES = {"v": None, "s": ctypes.c_char_p, "p": c_void_p, "f": c_void_p, "i": c_int32, "d": c_double, "n": c_size_t, "u": c_uint64}


class Versioned(ctypes.Structure):
    """A struct that begins with its size."""

    def __init__(self, **given: Any) -> None:
        super().__init__(size=ctypes.sizeof(self), **given)

    def __repr__(self) -> str:
        names = [name for name, _ in self._fields_ if name not in ("size", "reserved")]
        return f"<cvtflow.{type(self).__name__} {', '.join(f'{name}={getattr(self, name)!r}' for name in names)}>"


class Message(Versioned):
    """What went wrong; longer than in cvtflow.h, since a scene with many problems has a line for each."""

    _fields_ = [("size", c_uint32), ("code", c_int32), ("text", ctypes.c_char * 65528)]


class Options(Versioned):
    """Who does the work."""

    _fields_ = [("size", c_uint32), ("way", c_int32), ("threads", c_int32), ("segments", c_int32)]


class Counters(Versioned):
    """Counters since the start; after settling, since t = 0: accepted steps, those that a transition cut among them; evaluations of the
    right-hand side; transitions of tips; truncated steps; transitions suppressed, since the tip had just changed."""

    _fields_ = [("size", c_uint32), ("reserved", c_uint32), ("steps", c_int64), ("evaluations", c_int64), ("transitions", c_int64),
                ("truncated", c_int64), ("suppressed", c_int64)]


class Energy(Versioned):
    """Energy balance: residual, the change of the stored energy less the work of the inputs plus losses [J]; dissipated energy [J];
    error_ratio, the residual over its tolerance [1]; reliable, whether that is at most 1: else results are wrong."""

    _fields_ = [("size", c_uint32), ("_reliable", c_int32), ("residual", c_double), ("dissipated", c_double), ("error_ratio", c_double)]

    @property
    def reliable(self) -> bool:
        """`error_ratio` <= 1"""
        return self._reliable != 0

    def __repr__(self) -> str:
        return super().__repr__().replace(f"_reliable={self._reliable}", f"reliable={self.reliable}")


class Info(Versioned):
    """A channel or an input."""

    _fields_ = [("size", c_uint32), ("reserved", c_uint32), ("name", ctypes.c_char_p), ("unit", ctypes.c_char_p),
                ("description", ctypes.c_char_p), ("width", c_size_t)]


class Transition(Versioned):
    """A change of a tip's phase: 0 free, 1 touching, 2 sticking, 3 slipping. time [s]; pin, counted from 0; tip, 4 link + 2 (front half) +
    (side +z); phase_from and phase_to."""

    _fields_ = [("size", c_uint32), ("pin", c_int32), ("tip", c_int32), ("phase_from", c_int32), ("phase_to", c_int32),
                ("reserved", c_uint32), ("time", c_double)]


class SweepProgress(Versioned):
    """Progress of a sweep: all cases; cases done before, in earlier sessions, and done now; failed ones of these; wall time [s]."""

    _fields_ = [("size", c_uint32), ("reserved", c_uint32), ("cases", c_int64), ("before", c_int64), ("done", c_int64),
                ("failed", c_int64), ("wall", c_double)]


class Column(NamedTuple):
    """A channel over time: name, unit ("1" for a plain number), description, width (numbers per row)."""

    name: str
    unit: str
    description: str
    width: int = 1

    def __repr__(self) -> str:
        return f"<cvtflow.Column name={self.name!r}, unit={self.unit!r}, description={self.description!r}, width={self.width}>"


ON_LINE = ctypes.CFUNCTYPE(None, ctypes.c_char_p, c_void_p)
ON_PROGRESS = ctypes.CFUNCTYPE(c_int32, ctypes.POINTER(SweepProgress), c_void_p)


def _places():
    """Where the library may be: CVTFLOW_LIBRARY; inside the package, as in a wheel; below the prefix of the package; where the loader finds
    it."""
    if named := os.environ.get("CVTFLOW_LIBRARY"):
        yield named
    here = Path(__file__).resolve().parent
    prefixes = [each.parent for each in here.parents if each.name in ("lib", "lib64")]
    folders = [here / "lib"] + [prefix / lib for prefix in prefixes
                                for lib in ("lib", f"lib/{getattr(sys.implementation, '_multiarch', '')}", "lib64")]
    yield from (str(folder / NAME) for folder in folders if (folder / NAME).exists())
    yield NAME


class Library:
    """The functions of the library, as attributes. alone: whether it is a core library, which has no files and so not all of them."""

    def __init__(self, path: str) -> None:
        for loader, table in ((ctypes.PyDLL, BRIEF), (ctypes.CDLL, LONG)):
            loaded = loader(path)
            for entry in table.split(";"):
                name, result, *arguments = entry.split()
                function = getattr(loaded, "cvtflow_" + name, None)
                if function is not None:
                    function.restype, function.argtypes = TYPES[result], [TYPES[each] for each in arguments]
                    setattr(self, name, function)
        self.alone = "record_check" not in vars(self)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise _errors.StateError(f"{name}: this library has no files and no threads of its own; install cvtflow with its program")


def _load():
    try:
        return Library(next(_places()))
    except OSError as error:
        raise ImportError(f"the library cannot be loaded: {error}; install cvtflow completely") from None


c: Any = _load()


class _Local(threading.local):
    """Room for a message, one per thread."""

    def __init__(self):
        self.message = Message()
        self.address = ctypes.addressof(self.message)


_local = _Local()


def message() -> int:
    """Address of this thread's message, the last argument of functions that can fail."""
    return _local.address


def check(code: int) -> None:
    """Raises the exception of a code other than 0, with this thread's message."""
    if code:
        raise _errors.BY_CODE.get(c.code_name(code).decode(), _errors.Error)(_local.message.text.decode("utf-8", "replace"))


def made(function: Any, *arguments: Any) -> int:
    """The handle that a function makes."""
    handle = c_void_p()
    check(function(*arguments, byref(handle), _local.address))
    return handle.value or 0


class _Ending(weakref.ref):
    """Calls a function of the library with a handle when its object ends."""

    __slots__ = ("_as_parameter_",)


_endings: collections.deque[_Ending] = collections.deque()  # also some whose object has ended
_ending = threading.RLock()  # a signal's handler may make another one


class Owned:
    """A handle of the library, which `release` ends with the last Python object that refers to this. ctypes calls it: in a __del__ Python
    would handle signals, and drop what Ctrl-C raises there."""

    def __init__(self, handle: int, release: Any) -> None:
        self.handle = handle
        ending = _Ending(self, release)
        ending._as_parameter_ = c_void_p(handle)
        with _ending:
            _endings.append(ending)
            for _ in range(2):
                if _endings[0]() is None:
                    _endings.popleft()
                else:
                    _endings.rotate(-1)


def text_of(function: Any, *arguments: Any) -> str:
    """The text that a function gives."""
    room = 1 << 16  # what most texts need
    while True:
        text, size = ctypes.create_string_buffer(room), c_size_t(room)
        code = function(*arguments, text, byref(size), _local.address)
        if size.value <= room:
            check(code)
            return text.value.decode("utf-8", "replace")
        room = size.value


def interruptible(work: Callable[[], Any], end: Callable[[], Any], waiting: Callable[[str], Any] = lambda text: None) -> Any:
    """The result of a function that runs on a thread of its own, so that Ctrl-C raises its exception here: `end` then has it end. waiting:
    called at intervals, and with a line break in the end."""
    over, results, thrown = threading.Event(), [], []  # not Thread.join: interrupted by a signal, Python 3.11 takes the thread for ended

    def run():
        try:
            results.append(work())
        except BaseException as error:
            thrown.append(error)
        finally:
            over.set()

    threading.Thread(target=run).start()
    try:
        while not over.wait(0.1):
            waiting("")
    except BaseException:
        end()
        over.wait()
        raise
    finally:
        waiting("\n")
    if thrown:
        raise thrown[0]
    return results[0]


def library_version() -> str:
    """Version of the loaded library."""
    return c.version().decode()


def shutdown() -> bool:
    """Ends the worker threads of all simulations of this process. False if other users keep them alive."""
    return c.shutdown() == 0


@functools.lru_cache(maxsize=None)
def described(what: str) -> Any:
    """What the library knows of "keys", "channels", "inputs", "units", "notes", "levels", "methods", "codes", "exit_statuses" and ready
    "scenes", as lists of dicts (cvtflow_describe). Scenes are those of the first call."""
    return json.loads(text_of(c.describe, what.encode()))


@functools.lru_cache(maxsize=None)
def display_unit(name: str, unit: str) -> tuple[str, float]:
    """The unit in which pictures and tables show a channel, a column or a key, and the factor from its SI unit:
    display_unit("shaft_1/speed", "rad/s") is ("rpm", 9.549…)."""
    plain = name.replace("/", "_").replace(".", "_")
    for row in described("units")["shown"]:
        if row["unit"] == (unit or "1") and row["part"] in plain:
            return row["shown"], row["factor"]
    return unit, 1.0


class _WrongType(TypeError):
    """An argument of a type that plain() puts into words."""


class _Text:
    """An annotation or a default value as the documentation shows it."""

    def __init__(self, text):
        self._text = text

    def __repr__(self):
        return self._text


def _shown(function):
    """The signature of a function without self, its annotations as they are written."""
    signature = inspect.signature(function)
    parameters = [each.replace(annotation=_Text(each.annotation) if isinstance(each.annotation, str) else each.annotation)
                  for name, each in signature.parameters.items() if name != "self"]
    return signature.replace(parameters=parameters, return_annotation=signature.empty)


def plain(name: str) -> Callable[[Any], Any]:
    """Decorates a function whose TypeError states what it takes and what it was given."""

    def wrapped(function):
        own = next(iter(inspect.signature(function).parameters), "") == "self"

        @functools.wraps(function)
        def call(*given, **named):
            try:
                return function(*given, **named)
            except TypeError as error:
                inside = error.__traceback__.tb_next  # None: the arguments do not fit the parameters
                if inside is not None and not isinstance(error, _WrongType):
                    raise
            words = [*map(repr, given[own:]), *(f"{key}={value!r}" for key, value in named.items())]
            raise TypeError(f"{name}{_shown(function)} was called with ({', '.join(words)})")

        return call

    return wrapped


def encoded(value: Any, kinds: Any = str) -> bytes:
    """A text, or a path, for the library. Raises the TypeError that plain() puts into words."""
    if not isinstance(value, kinds):
        raise _WrongType(repr(value))
    return os.fsencode(value) if isinstance(value, os.PathLike) else str(value).encode("utf-8", "surrogateescape")


def in_si(value: Any, name: str, unit: str) -> float:
    """A number in SI, or a text with its unit. name: of the argument, for messages. Raises ArgumentError; the TypeError of plain()."""
    if isinstance(value, str):
        try:
            return quantity(value, unit)
        except _errors.Error as error:
            raise type(error)(f"{name}: {error}") from None
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _WrongType(repr(value)) from None


@plain("quantity")
def quantity(text: str, unit: str) -> float:
    """A quantity with its unit, in SI: quantity("0.1 ms", "s") is 1e-4. unit: SI unit that is expected, "1" for a plain number."""
    value = c_double()
    check(c.quantity(encoded(text), encoded(unit), byref(value), _local.address))
    return value.value
