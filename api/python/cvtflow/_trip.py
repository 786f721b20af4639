"""What a vehicle did in its cycle, from a record with the channels vehicle/*."""

import numpy as np

from ._courses import time_text
from ._figures import Line, Panel, draw
from ._numbers import thinned
from ._page import number, pairs, picture, table

_KWH = 3.6e6  # [J]
_KINDS = ("kinetic", "climb", "air", "rolling", "brakes", "clutch", "final_drive")  # what the work of shaft 2 becomes
_COLUMNS = 1500


def _course(table_or_number, time):
    """Values at times of a key that is a number or a table over time."""
    points = np.atleast_2d(np.asarray(table_or_number, dtype=float))
    return np.full(len(time), points.item()) if points.size == 1 else np.interp(time, points[:, 0], points[:, 1])


def needed_speed(record):
    """Speed of shaft 2 that the cycle needs, at the outputs [rad/s]: drive.speed over control.ratio."""
    scene, time = record.scene, record["time"]
    return _course(scene["drive.speed"], time) / _course(scene["control.ratio"], time)


def _gained(record, name):
    values = record[name] if name in record.info else np.zeros(1)
    return float(values[-1] - values[0])


def vehicle(record, name):
    """Blocks of the section; none of a record without a vehicle that drives."""
    if record.scene is None or not _gained(record, "vehicle/distance") > 0.0 or "shaft_2/speed" not in record.info:
        return []
    way = _gained(record, "vehicle/distance")
    lever = record.scene["vehicle.wheel_radius"] / record.scene["vehicle.final_drive"]
    time, needed, actual = record["time"], needed_speed(record), record["shaft_2/speed"]
    worst = int(np.nanargmax(abs(actual - needed)))
    given, pump = _gained(record, "work/drive"), _gained(record, "hydraulics/pump")
    delivered, wanted = -_gained(record, "work/load"), _gained(record, "vehicle/shaft_2")
    per_100_km = 1e5 / way / _KWH
    rows = [("distance", f"{way:.4g} m in {time_text(time[-1] - time[0])}"),
            ("consumption", f"{per_100_km * (given + pump):.4g} kWh/100 km: work of shaft 1{' and the pump' if pump else ''} over the "
                            "distance"),
            ("shaft 2", f"{1e-3 * delivered:.4g} kJ delivered of {1e-3 * wanted:.4g} kJ that the cycle needs"
                        + (f" ({100.0 * (delivered / wanted - 1.0):+.3g} %)" if wanted else "")),
            ("speed of shaft 2", f"off the cycle's by {100.0 * np.mean(abs(actual - needed)) / np.mean(abs(needed)):.3g} % on average"),
            ("largest miss", f"{3.6 * lever * (actual[worst] - needed[worst]):+.3g} km/h at {time_text(time[worst])}"
                             + (f": speed of shaft 2 {100.0 * (actual[worst] / needed[worst] - 1.0):+.3g} %" if needed[worst] else ""))]
    kinds = [(kind, f"vehicle/{kind}") for kind in _KINDS]
    found = [(kind.replace("_", " "), _gained(record, each), record.info[each].description) for kind, each in kinds if each in record.info]
    found += [("shaft 2 needs", wanted, "sum of these"), ("shaft 2 delivers", delivered, "work that the load took"),
              ("shaft 1 takes", given, "work of the drive")]
    if "dissipated/total" in record.info:
        found.append(("lost in the variator", _gained(record, "dissipated/total"), "dissipated by all kinds"))
    energies = [[words, number(1e-3 * each, "{:.4g}"), number(per_100_km * each, "{:.4g}"), what] for words, each, what in found]
    return [pairs(rows), table(["energy", "kJ", "kWh/100 km", "meaning"], energies, "sortable", "Energies by kind over the record",
                               styles={3: "meaning"}),
            picture(_speeds(record, time, 3.6 * lever * needed, 3.6 * lever * actual, worst), name)]


def _speeds(record, time, needed, actual, worst):
    """Speed against the cycle, and by how much it is off."""
    seconds = time[-1] >= 1.0
    scale, label = (1.0, "time [s]") if seconds else (1e3, "time [ms]")
    cycle = 3.6 * record["vehicle/speed"]
    driven = np.where(needed > 1.001 * cycle + 1e-3, np.nan, actual)  # the starting clutch slips: shaft 2 turns faster than the wheels need
    speeds = Panel("Speed against the cycle", label, "speed [km/h]", height=3.2)
    speeds.lines.append(Line("vehicle, by shaft 2 where the clutch is closed", *thinned(scale * time, driven, _COLUMNS),
                             {"linewidth": 2.0}))
    speeds.lines.append(Line("cycle", *thinned(scale * time, cycle, _COLUMNS), {"color": "#222222", "linestyle": "dashed"}))
    miss = Panel("Speed of shaft 2 less what the cycle needs", label, "speed [km/h]", height=2.2)
    miss.lines.append(Line("", *thinned(scale * time, actual - needed, _COLUMNS), {}))
    miss.lines.append(Line("largest miss", scale * time[[worst]], (actual - needed)[[worst]],
                           {"marker": "o", "markerfacecolor": "none", "markersize": 9, "color": "#D00000", "linestyle": "none"}))
    return draw([speeds, miss])
