"""What objects show in a notebook: key figures and one picture."""

import math
from html import escape


def with_unit(value, unit):
    """0.0036, "31.42 rad/s" """
    return f"{value:.5g}" + ("" if unit in ("", "1") else f" {unit}")


def shown(caption, rows, values, title):
    """HTML of rows of a name and a text, and of values side by side as a line in SVG. title: of the line"""
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in rows)
    values, width, height = [each for each in values if math.isfinite(each)], 360, 90
    low, high = min(values, default=0.0), max(values, default=0.0)
    across, up = (width - 10) / max(1, len(values) - 1), (height - 10) / ((high - low) or 1.0)
    points = " ".join(f"{5 + k * across:.1f},{height - 5 - (value - low) * up:.1f}" for k, value in enumerate(values))
    return (f"<table><caption>{escape(caption)}</caption>{cells}</table><svg width=\"{width}\" height=\"{height}\" role=\"img\">"
            f"<title>{escape(title)}</title><polyline fill=\"none\" stroke=\"currentColor\" points=\"{points}\"/></svg>")
