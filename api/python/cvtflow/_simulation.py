"""Simulations: one class over the handles of the library."""

from __future__ import annotations

import ctypes
import enum
import os
import re
import threading
import time as clock
from collections.abc import Callable
from ctypes import byref, c_double, c_size_t, c_void_p
from html import escape
from typing import Any

from ._channels import Channels, of_simulation
from ._errors import ArgumentError, BusyError, SceneError, StartStateError, StateError
from ._known import suggestion
from ._library import (ON_LINE, Column, Counters, Energy, Info, Options, Owned, Transition, _local, _WrongType, c, check, described, encoded,
                       in_si, made, message, plain)
from ._notebook import shown, with_unit
from ._scene import Scene, opened

_BUSY = "the simulation is in use by another thread, or this is its own callback"
BETWEEN_CHECKS = 0.05  # wall time between two moments at which Python handles signals [s]


class Threads:
    """Threads of a simulation; they do not affect results. way: 0 caller, 1 current_arena, 2 private_arena; count of threads."""

    way: int
    count: int

    def __init__(self, *_: Any) -> None:
        raise TypeError("Threads has no constructor: Threads.caller(), Threads.private_arena(n) or Threads.current_arena(slots)")

    @staticmethod
    def _made(way, count):
        threads = Threads.__new__(Threads)
        threads.way, threads.count = way, count
        return threads

    @staticmethod
    def caller() -> Threads:
        """The calling thread only."""
        return Threads._made(0, 1)

    @staticmethod
    @plain("Threads.current_arena")
    def current_arena(slots: int) -> Threads:
        """The oneTBB arena in which the call is made."""
        return Threads._made(1, _integer(slots))

    @staticmethod
    @plain("Threads.private_arena")
    def private_arena(threads: int = 0) -> Threads:
        """Threads of this simulation, the caller included; 0: all."""
        return Threads._made(2, _integer(threads))

    def __repr__(self) -> str:
        return ("Threads.caller()", f"Threads.current_arena({self.count})", f"Threads.private_arena({self.count})")[self.way]


def _integer(value):
    if not hasattr(value, "__index__"):
        raise _WrongType(repr(value))
    return value.__index__()


Input = enum.Enum("Input", {row["name"]: number for number, row in enumerate(described("inputs"))}, module=__name__)
Input.__doc__ = ("Inputs that a host may set between steps; a set value replaces the scene's table from then on.\n\nMembers:\n\n"
                 + "\n\n".join(f"{row['name']} : {row['text']} [{row['unit']}]" for row in described("inputs")))


class State:
    """The full integration state, including inputs that were set; set_state(state()) continues bitwise."""

    def __init__(self, made_of: bytes) -> None:
        self._bytes = made_of

    @staticmethod
    @plain("State.from_bytes")
    def from_bytes(bytes: bytes) -> State:
        """Raises StateError for damaged bytes, or those of another version."""
        if not isinstance(bytes, _BYTES):
            raise _WrongType(repr(bytes))
        check(c.state_check(bytes, len(bytes), message()))
        return State(bytes)

    def bytes(self) -> bytes:
        """The state as bytes."""
        return self._bytes

    def __eq__(self, other: object) -> bool:
        return isinstance(other, State) and self._bytes == other._bytes

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<cvtflow.State: {len(self._bytes)} bytes>"


_BYTES = bytes


class _Memory:
    """Numbers of a simulation for NumPy, which cannot be written to."""

    def __init__(self, owner, address, width):
        self.owner = owner
        self.__array_interface__ = {"version": 3, "typestr": "<f8", "shape": (width,), "data": (address, True)}


class Simulation:
    """One simulation of one scene. Used by one thread at a time; a process may have any number of them."""

    @plain("Simulation")
    def __init__(self, scene: Scene | str | os.PathLike[str], threads: Threads = Threads.caller(), segments: int = 0) -> None:
        """Prepares the start state of a scene: a Scene, the name of a ready one, or a file. Starts no thread."""
        scene = opened(scene)
        if not isinstance(threads, Threads):
            raise _WrongType(repr(threads))
        options = Options(way=threads.way, threads=threads.count, segments=_integer(segments))
        self._begin(scene, threads, segments, made(c.create, scene._handle, byref(options)))

    def _begin(self, scene, threads, segments, handle):
        self._scene, self._threads, self._segments, self._owner, self._handle = scene, threads, segments, Owned(handle, c.destroy), handle
        self._lock, self._views, self._columns, self._room = threading.Lock(), {}, None, 1 << 16
        self._interval = self._slice = scene["run.output_interval"]  # [s]; simulated in BETWEEN_CHECKS, at least an interval [s]
        self._on_output, self._every, self._outputs, self._on_transition = None, 1.0, 0.0, None
        self._value, self._address = c_double(), c_void_p()
        self._at_value, self._at_address = ctypes.addressof(self._value), ctypes.addressof(self._address)

    def copy(self) -> Simulation:
        """A second simulation in the same state, without the callbacks."""
        other = Simulation.__new__(Simulation)
        other._begin(self._scene, self._threads, self._segments, made(c.copy, self._handle))
        return other

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self._scene

    @property
    def threads(self) -> Threads:
        """As given."""
        return self._threads

    @property
    def segments(self) -> int:
        """As given."""
        return self._segments

    @property
    def time(self) -> float:
        """Time [s]; negative while a start settles."""
        return c.time(self._handle)

    @property
    def method(self) -> str:
        """The method of its steps, never "auto": what run.method = "auto" is with this scene."""
        return c.method(self._handle).decode()

    @property
    def step_length(self) -> float:
        """Length of a step without transitions [s]."""
        return c.step_length(self._handle)

    @plain("advance_to")
    def advance_to(self, time: float | str) -> None:
        """Takes whole steps until self.time >= time ("1 ms"; numbers are in s), without the interpreter's lock. Ctrl-C ends it between two
        steps, and the simulation can be continued. Raises a Fault, CancelledError, BusyError; ArgumentError for a time more than a step back."""
        until = time if type(time) is float else in_si(time, "time", "s")
        if not self._lock.acquire(False):
            raise BusyError(_BUSY)
        try:
            if self._on_output is None and self._on_transition is None and until - c.time(self._handle) <= self._slice:
                code = c.advance_to(self._handle, until, _local.address)
                if code:
                    check(code)
            else:
                self._advance(until)
        finally:
            self._lock.release()

    def step(self) -> None:
        """One step, which a transition may shorten."""
        self._alone(self._step)

    def cancel(self) -> None:
        """Ends advance_to() of another thread after at most one step."""
        c.cancel(self._handle)

    def largest_stable_step(self) -> float:
        """Longest step with which the method is linearly stable here [s]."""
        check(c.largest_stable_step(self._handle, self._at_value, message()))
        return self._value.value

    def _alone(self, action, *arguments):
        """A second call, of another thread or of a callback, is refused, as in the library; here this holds for all slices of a call."""
        if not self._lock.acquire(False):
            raise BusyError(_BUSY)
        try:
            return action(*arguments)
        finally:
            self._lock.release()

    def _advance(self, until):
        """In slices, after which Python handles signals and callbacks: they end at outputs of the callback, and take a twentieth of a second
        or less. A slice that ended between two outputs of the scene would begin the means of channels anew."""
        handle, at, interval = self._handle, message(), self._interval
        begin, near = c.time(handle), until - 1e-9 * interval
        while True:
            end = min(until, ((begin / interval + 1e-9) // 1 + self._slice // interval) * interval)
            if self._on_output is not None:
                end = min(end, self._outputs * self._every)
            if self._on_transition is not None:
                end = min(end, begin + interval)
            started = clock.perf_counter()
            check(c.advance_to(handle, end, at))
            now = c.time(handle)
            if now > begin:
                self._slice = max(interval, (now - begin) / max(clock.perf_counter() - started, 1e-9) * BETWEEN_CHECKS)
            if self._on_output is not None or self._on_transition is not None:
                self._report(now)
            if not now < near:
                return None
            begin = now

    def _step(self):
        check(c.step(self._handle, message()))
        self._report(c.time(self._handle))

    def _report(self, now):
        """Calls back what has come due. No function of the library is under way, so callbacks may raise."""
        if self._on_transition is not None:
            count = c_size_t(0)
            check(c.transitions(self._handle, None, byref(count), message()))
            rows = (Transition * max(1, count.value))(Transition())
            check(c.transitions(self._handle, rows, byref(count), message()))
            for row in rows[:count.value]:
                if self._on_transition is not None:
                    self._on_transition(self, row)
        now += 1e-9 * self._interval
        if self._on_output is not None and now >= self._outputs * self._every:
            self._outputs = now // self._every + 1.0
            self._on_output(self)

    def _next_output(self):
        self._outputs = (c.time(self._handle) / self._every + 1e-9) // 1 + 1.0

    @plain("on_output")
    def on_output(self, interval: float | str, callback: Callable[[Simulation], Any] | None) -> None:
        """callback(simulation) after the first step at or after every multiple of interval ("10 us"; numbers are in s); None removes it. A
        callback that refers to its simulation keeps both alive until it is removed."""
        every = in_si(interval, "interval", "s")
        if callback is not None and not 0.0 < every < float("inf"):
            raise ArgumentError("on_output: the interval must be positive")
        self._on_output, self._every = _callback(callback), every
        if callback is not None:
            self._next_output()

    @plain("on_transition")
    def on_transition(self, callback: Callable[[Simulation, Transition], Any] | None) -> None:
        """callback(simulation, transition); None removes it."""
        self._on_transition = _callback(callback)
        count = c_size_t(0)
        check(c.transitions(self._handle, None, None if callback is None else byref(count), message()))

    def state(self) -> State:
        """The full integration state."""
        while True:
            size, room = c_size_t(self._room), ctypes.create_string_buffer(self._room)
            code = c.state_get(self._handle, room, byref(size), message())
            if size.value <= self._room:
                check(code)
                return State(room.raw[:size.value])
            self._room = size.value

    @plain("set_state")
    def set_state(self, state: State) -> None:
        """Raises StateError for the state of another scene."""
        if not isinstance(state, State):
            raise _WrongType(repr(state))
        self._alone(lambda: check(c.state_set(self._handle, state._bytes, len(state._bytes), message())))
        self._next_output()

    def hash(self) -> int:
        """Hash of unknowns and phases, to compare states bitwise."""
        return c.hash(self._handle)

    @plain("set_input")
    def set_input(self, input: Input | str, value: float | str) -> None:
        """Sets an input, given as Input or by name, to a number in SI or a text with a unit."""
        number = _INPUTS.get(input)
        if number is None:
            number = _input_of(input)
        if type(value) is not float:
            row = described("inputs")[number]
            value = in_si(value, row["name"], row["unit"])
        check(c.input_set(self._handle, number, value, message()))

    @plain("input")
    def input(self, input: Input | str) -> float:
        """Present value, as set or from the scene's table, in its SI unit."""
        number = _INPUTS.get(input)
        if number is None:
            number = _input_of(input)
        check(c.input_get(self._handle, number, self._at_value, message()))
        return self._value.value

    def inputs(self) -> dict[str, float]:
        """All inputs that the scene has, by name."""
        return {each.name: self._value.value for each in Input
                if c.input_get(self._handle, each.value, self._at_value, message()) == 0}

    def size(self) -> int:
        """Number of unknowns."""
        return c.size(self._handle)

    def unknowns(self) -> Any:
        """The unknowns now [size]; a copy, since steps move them in memory."""
        import numpy

        return numpy.array(_Memory(self._owner, c.unknowns(self._handle), self.size()))

    @plain("rhs")
    def rhs(self, time: float, x: Any) -> Any:
        """dx/dt at (time, x) [size]; depends on these and on the inputs only."""
        import numpy

        given = numpy.asarray(x)
        if given.ndim != 1 or not numpy.can_cast(given.dtype, numpy.float64):
            raise _WrongType("rhs: x is one row of numbers")
        given = numpy.ascontiguousarray(given, dtype=numpy.float64)
        out = numpy.empty_like(given)
        check(c.rhs(self._handle, time, given.ctypes.data, out.ctypes.data, len(given), message()))
        return out

    @property
    def channels(self) -> Channels:
        """Present values of the channels, by name: channels["slip"] is a number, channels["links/tension"] an array, channels.info their
        units."""
        if self._columns is None:  # they never change
            info, found = Info(), []
            for number in range(c.channel_count(self._handle)):
                check(c.channel_describe(self._handle, number, byref(info), message()))
                found.append(Column(info.name.decode(), info.unit.decode(), info.description.decode(), info.width))
            self._columns = found, {}
        return of_simulation(self, *self._columns)

    def channel(self, name: str) -> Any:
        """Values of a channel now [width]: a view without a copy, which changes with the next read of this channel after a step."""
        index, view = self._views.get(name) or self._view(name)
        check(c.channel_values(self._handle, index, self._at_address, None, message()))
        return view

    def _view(self, name):
        import numpy

        index, width = c_size_t(), c_size_t()
        check(c.channel_find(self._handle, encoded(name), byref(index), message()))
        check(c.channel_values(self._handle, index, self._at_address, byref(width), message()))
        view = numpy.asarray(_Memory(self._owner, self._address.value, width.value))
        self._views[name] = index.value, view
        return self._views[name]

    def counters(self) -> Counters:
        """Counters since the start."""
        counters = Counters()
        check(c.counters_get(self._handle, byref(counters)))
        return counters

    def energy(self) -> Energy:
        """Energy balance, and whether results are reliable."""
        energy = Energy()
        check(c.energy_get(self._handle, byref(energy)))
        return energy

    def notices(self) -> list[str]:
        """Warnings, one line each."""
        lines: list[str] = []
        check(c.notices(self._handle, ON_LINE(lambda line, _: lines.append(line.decode())), None, message()))
        return lines

    def __reduce__(self):
        return _restored, (self._scene.text, self.state().bytes(), self._threads, self._segments)

    def __repr__(self) -> str:
        return f"<cvtflow.Simulation of {self._scene.name} at {self.time:.6g} s, {self.size()} unknowns>"

    def _repr_html_(self) -> str:
        try:
            return shown(self._scene.name, self._key_figures(), list(self.channel("links/tension")), "tension of the links [N]")
        except RuntimeError as error:  # being stepped by another thread
            return f"<p>{escape(repr(self))}: {escape(str(error))}</p>"

    def _key_figures(self):
        rows = [("time", f"{self.time:.5g} s"), ("unknowns", str(self.size())), ("steps", str(self.counters().steps)),
                ("balance", "closes" if self.energy().reliable else "does not close")]
        return rows + [(name, with_unit(self.channels[name], info.unit))
                       for name, info in self.channels.info.items() if info.width == 1 and "/" not in name]


_INPUTS = {each.name: each.value for each in Input} | {each: each.value for each in Input}


def _input_of(which):
    """The number of an input whose name is spelt as the scene's key: "load.torque", "load__torque". Raises ArgumentError, TypeError."""
    if not isinstance(which, str):
        raise TypeError(f'an input has a name, such as "load_torque", or is an Input, not {which!r}')
    name = which.replace("__", "_").replace(".", "_")
    if name not in _INPUTS:
        raise ArgumentError(f"input: there is no '{which}'" + suggestion(which, Input.__members__))
    return _INPUTS[name]


def _callback(function):
    if function is not None and not callable(function):
        raise _WrongType(repr(function))
    return function


def _restored(text, state, threads, segments):
    """A simulation that was pickled, without callbacks. The scene's state file may no longer exist; the saved state replaces it."""
    try:
        simulation = Simulation(Scene.parse(text), threads, segments)
    except (SceneError, StartStateError):
        simulation = Simulation(Scene.parse(re.sub(r"(?m)^state = .*$", "", text)), threads, segments)
    simulation.set_state(State(state))
    return simulation


class Recording:
    """The record of a simulation while it is advanced."""

    @plain("Recording")
    def __init__(self, simulation: Simulation, path: str | os.PathLike[str], replace: bool = False) -> None:
        """Channels, states and transitions at the scene's run.output_interval from now on, as `cvtflow run` records them; no settling. Ends
        where a with-statement does, or with finish(). An existing file, or rows of a killed run in its .part, stay without replace."""
        if not isinstance(simulation, Simulation):
            raise _WrongType(repr(simulation))
        check(c.record_begin(simulation._handle, encoded(path, (str, os.PathLike)), bool(replace), message()))
        self._simulation, self._path, self._open = simulation, os.fspath(path), True

    def finish(self, complete: bool = True) -> Any:
        """Completes the file and returns its Record. Raises RecordError."""
        from ._series import Record

        self._finish(complete)
        return Record(self._path)

    def _finish(self, complete):
        if not self._open:
            raise StateError("the recording has ended")
        self._open = False
        check(c.record_finish(self._simulation._handle, complete, message()))

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, kind: Any, *_: Any) -> None:
        self._finish(kind is None)
