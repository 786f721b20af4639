"""Wear of sheaves and tips over a record by Archard's law, as `cvtflow plot --wear` states it."""

import math

import numpy as np

from ._known import Misuse
from ._numbers import integral

SHEAVES = ("1- (fixed)", "1+ (movable)", "2- (movable)", "2+ (fixed)")
_THOUSAND_HOURS = 3.6e6  # [s]
_POISSON = 0.3


def whole_rounds(record):
    """The first row from which whole rounds of the chain remain, and their number; a record shorter than one counts as a whole."""
    time, scene = record["time"], record.scene
    per_round = scene["chain.pins"] / record.pin_frequency if record.pin_frequency else 0.0  # [s]
    if not per_round:
        return 0, 0.0
    rounds = (time[-1] - time[0]) / per_round
    if rounds < 1.0:
        return 0, rounds
    begin = time[-1] - math.floor(rounds * (1.0 + 1e-9)) * per_round
    first = min(int(np.argmin(np.abs(time - begin))), len(time) - 2)
    return first, (time[-1] - time[first]) / per_round


def worn_depth(volume, spot, crown, face):
    """Depth [m] of a pin's crowned end that has lost a volume: its contact spot grows with the flat, up to the whole face. spot, face: areas"""
    flat = (np.sqrt(spot**2 + 4.0 * np.pi * crown * volume) - spot) / (2.0 * np.pi * crown)
    whole = np.maximum(face - spot, 0.0) / (2.0 * np.pi * crown)  # from this depth on
    return np.where(flat < whole, flat, whole + (volume - spot * whole - np.pi * crown * whole**2) / face)


def wear(record):
    """As Record.wear()."""
    time, scene = record["time"], record.scene
    if scene is None:
        raise Misuse(f"{record.path}: its scene cannot be read by this program")
    if len(time) < 2 or not time[-1] > time[0]:
        raise Misuse(f"{record.path}: wear requires 2 rows at least")
    first, rounds = whole_rounds(record)
    time = time[first:]

    def rows(name):
        if f"wear/{name}" not in record.info:
            raise Misuse(f"{record.path}: the record has no channel wear/{name}; record it with --set record.channels=wear/*")
        return record[f"wear/{name}"][first:]

    def largest(name):
        return np.fmax.reduce(rows(name), axis=0, initial=0.0)

    energy, force_way, load = (each.reshape(len(SHEAVES), -1)
                               for each in (integral(time, rows("friction_power")), integral(time, rows("force_speed")), largest("pressure_speed")))
    width = (scene["pulley.outermost"] - scene["pulley.innermost"]) / energy.shape[1]
    radius = scene["pulley.innermost"] + (np.arange(energy.shape[1]) + 0.5) * width
    worn = scene["wear.coefficient"] * _THOUSAND_HOURS / (time[-1] - time[0])  # volume in 1,000 hours per integral of force and speed
    modulus = 0.5 * scene["chain.young_modulus"] / (1.0 - _POISSON**2)
    contact = 0.5 * np.pi * (0.75 * scene["tip.hertz"] / modulus)**2 * largest("tip_pressure") / modulus  # a = π R p/(2 E*)
    spot = np.pi * np.where(contact > 0.0, contact, np.nan)**2
    volume = worn * integral(time, rows("tip_force_speed"))
    return {"rounds": rounds, "first": first, "radius": radius, "energy": energy / width, "pressure_speed": load,
            "sheave_depth": worn * force_way * np.cos(scene["tip.angle"]) / (2.0 * np.pi * radius * width),
            "tip_volume": volume, "tip_spot": spot, "tip_depth": worn_depth(volume, spot, scene["tip.radius"], scene["half.area"])}


def rounds_text(found):
    """Over how much of the chain's way sums are."""
    rounds = f"{found['rounds']:{'.3g' if found['rounds'] < 999.5 else '.0f'}}"
    return f"sums over {rounds} round{'' if rounds == '1' else 's'} of the chain" if found["rounds"] else "sums over the record"


def sampled(record, found, width):
    """How well the outputs sample the wear: their sum beside the energy that the run has accounted for in every step. width: of a ring [m]"""
    if "dissipated/tip_friction" not in record.info:
        return ""
    accounted = record["dissipated/tip_friction"][found["first"]:]
    return (f"; {len(accounted)} outputs sum to {found['energy'].sum() * width:.4g} J of the {accounted[-1] - accounted[0]:.4g} J "
            "that friction of tips dissipated")
