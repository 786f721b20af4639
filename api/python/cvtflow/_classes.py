"""What classes of the extension module get from Python: display in notebooks and in the interpreter, pickling, type errors in words."""

import ast
import functools
import inspect
import re
from html import escape

from . import _cvtflow
from ._cvtflow import Scene, SceneError, Simulation, StartStateError, State, Threads
from ._scene import key_repr


def _number(value, unit):
    return f"{value:.5g}" + ("" if unit == "1" else f" {unit}")


def _rows(simulation):
    rows = [("time", _number(simulation.time, "s")), ("unknowns", str(simulation.size())),
            ("steps", str(simulation.counters().steps)), ("balance", "closes" if simulation.energy().reliable else "does not close")]
    for name, info in simulation.channels.info.items():
        if info.width == 1 and "/" not in name:
            rows.append((name, _number(simulation.channels[name], info.unit)))
    return rows


def _picture(values, title):
    """Values side by side as a line, in SVG."""
    width, height = 360, 90
    low, high = min(values), max(values)
    scale = (high - low) or 1.0
    across = (width - 10) / max(1, len(values) - 1)
    points = " ".join(f"{5 + k * across:.1f},{height - 5 - (v - low) / scale * (height - 10):.1f}" for k, v in enumerate(values))
    return (f'<svg width="{width}" height="{height}" role="img"><title>{escape(title)}</title>'
            f'<polyline fill="none" stroke="currentColor" points="{points}"/></svg>')


def _simulation_html(self):
    try:
        cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in _rows(self))
        tension = self.channel("links/tension")
    except RuntimeError as error:  # being stepped by another thread
        return f"<p>{escape(repr(self))}: {escape(str(error))}</p>"
    return (f"<table><caption>{escape(self.scene.name)}</caption>{cells}</table>"
            + _picture(list(tension), "tension of the links [N]"))


def _simulation_repr(self):
    return f"<cvtflow.Simulation of {self.scene.name} at {self.time:.6g} s, {self.size()} unknowns>"


def _scene_html(self):
    return f"<details><summary>{escape(self.name)}: {escape(self.description)}</summary><pre>{escape(self.text)}</pre></details>"


def _scene_repr(self):
    return (f"<cvtflow.Scene {self.name}: {self['chain.pins']} pins, ratio {self['start.ratio']:g}, "
            f"until {self['run.until']:g} s>")


def _fields(self):
    """Every property by name: <cvtflow.Energy residual=..., dissipated=...>."""
    names = [name for name, member in vars(type(self)).items() if isinstance(member, property)]
    values = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
    return f"<cvtflow.{type(self).__name__} {values}>"


def _restore(text, state, way, count, segments):
    """The scene's state file may no longer exist; the saved state replaces it."""
    threads = (lambda _: Threads.caller(), Threads.current_arena, Threads.private_arena)[way](count)
    try:
        simulation = Simulation(Scene.parse(text), threads, segments)
    except (SceneError, StartStateError):
        simulation = Simulation(Scene.parse(re.sub(r"(?m)^state = .*$", "", text)), threads, segments)
    simulation.set_state(State.from_bytes(state))
    return simulation


def _reduce(self):
    """A simulation as bytes, without callbacks: the scene and the state."""
    threads = self.threads
    return _restore, (self.scene.text, self.state().bytes(), threads.way, threads.count, self.segments)


class _Text:
    """A default value as the documentation shows it."""

    def __init__(self, text):
        self._text = text

    def __repr__(self):
        return self._text


def signature(function):
    """The inspect.Signature in the first line of a documentation text that pybind11 wrote."""
    first = re.sub(r"\b(cvtflow\.)?_cvtflow\.", "", (function.__doc__ or "").partition("\n")[0])
    arguments = ast.parse(re.sub(r"^\w+", "def f", first.partition(" -> ")[0]) + ": ...").body[0].args
    defaults = [inspect.Parameter.empty] * (len(arguments.args) - len(arguments.defaults))
    defaults += [_Text(ast.unparse(each)) for each in arguments.defaults]
    return inspect.Signature([
        inspect.Parameter(argument.arg, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default,
                          annotation=_Text(ast.unparse(argument.annotation)) if argument.annotation else inspect.Parameter.empty)
        for argument, default in zip(arguments.args, defaults)
    ])


def plain(function, name):
    """The function, whose TypeError states what it takes and what it was given."""
    shown = signature(function)

    @functools.wraps(function)
    def call(*given, **named):
        try:
            return function(*given, **named)
        except TypeError as error:
            if "incompatible" not in str(error):
                raise
        own = list(shown.parameters)[:1] == ["self"]
        takes = shown.replace(parameters=list(shown.parameters.values())[own:])
        words = [*map(repr, given[own:]), *(f"{key}={value!r}" for key, value in named.items())]
        raise TypeError(f"{name}{takes} was called with ({', '.join(words)})")

    call.__signature__ = shown
    return call


def _named(function):
    """The function, which takes the name of an input also as the scene's key spells it: "load.torque", "load__torque"."""

    def spelt(name):
        if not isinstance(name, (str, _cvtflow.Input)):
            raise TypeError(f'an input has a name, such as "load_torque", or is an Input, not {name!r}')
        name_of_input = name.replace("__", "_").replace(".", "_") if isinstance(name, str) else name
        return name_of_input if name_of_input in _cvtflow.Input.__members__ else name

    @functools.wraps(function)
    def call(self, *given, **named):
        named = {key: spelt(each) if key == "input" else each for key, each in named.items()}
        return function(self, *map(spelt, given[:1]), *given[1:], **named)

    return call


# What users call with values of their own, and seldom enough that a call of Python's more does not count.
_with_plain_errors = {
    Simulation: "__init__ advance_to input set_input set_state rhs on_output on_transition",
    Scene: "read parse ready with_detail keys value __getitem__",
    State: "from_bytes",
    Threads: "current_arena private_arena",
    _cvtflow.RecordFile: "__init__",
    _cvtflow.Recording: "__init__",
    _cvtflow: "quantity display_unit tune",
}


def _no_threads(*_, **__):
    raise TypeError("Threads has no constructor: Threads.caller(), Threads.private_arena(n) or Threads.current_arena(slots)")


def install():
    """Adds the methods to the classes."""
    Simulation.__reduce__ = _reduce
    for owner, names in _with_plain_errors.items():
        for name in names.split():
            bound = inspect.getattr_static(owner, name)
            shown = name if owner in (_cvtflow, Simulation) else f"{owner.__name__}.{name}"
            function = plain(getattr(owner, name), owner.__name__ if name == "__init__" else shown)
            setattr(owner, name, staticmethod(function) if isinstance(bound, staticmethod) else function)
    Threads.__init__ = _no_threads
    Simulation.input, Simulation.set_input = _named(Simulation.input), _named(Simulation.set_input)
    Scene._repr_html_, Scene.__repr__ = _scene_html, _scene_repr
    Simulation._repr_html_, Simulation.__repr__ = _simulation_html, _simulation_repr
    _cvtflow.KeyInfo.__repr__ = key_repr
    _cvtflow.State.__repr__ = lambda self: f"<cvtflow.State: {len(self.bytes())} bytes>"
    for name in ("Column", "Counters", "Energy", "SweepProgress", "Threads", "Transition", "Tuning"):
        getattr(_cvtflow, name).__repr__ = _fields
