"""What notebooks and the interpreter show."""

from html import escape


def _number(value, unit):
    return f"{value:.5g}" + ("" if unit == "1" else f" {unit}")


def _rows(simulation):
    rows = [("time", _number(simulation.time, "s")), ("unknowns", str(simulation.size())),
            ("steps", str(simulation.counters().steps)), ("balance", "closes" if simulation.energy().reliable else "does not close")]
    for index in range(simulation.channels()):
        info = simulation.channel_info(index)
        if info.width == 1 and "/" not in info.name:
            rows.append((info.name, _number(simulation.channel(index)[0], info.unit)))
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


def install(scene, simulation):
    """Gives the classes their faces."""
    scene._repr_html_ = _scene_html
    simulation._repr_html_ = _simulation_html
    simulation.__repr__ = _simulation_repr
