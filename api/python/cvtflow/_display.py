"""Display of objects in notebooks and in the interpreter."""

from html import escape

from . import _cvtflow
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


def install():
    """Adds the display methods to the classes."""
    _cvtflow.Scene._repr_html_ = _scene_html
    _cvtflow.Scene.__repr__ = _scene_repr
    _cvtflow.Simulation._repr_html_ = _simulation_html
    _cvtflow.Simulation.__repr__ = _simulation_repr
    _cvtflow.KeyInfo.__repr__ = key_repr
    _cvtflow.State.__repr__ = lambda self: f"<cvtflow.State: {len(self.bytes())} bytes>"
    for name in ("Column", "Counters", "Energy", "SweepProgress", "Threads", "Transition", "Tuning"):
        getattr(_cvtflow, name).__repr__ = _fields
