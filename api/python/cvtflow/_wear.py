"""Wear of sheaves and tips over a record by Archard's law, as `cvtflow plot --wear` states it."""

import numpy as np

_SHEAVES = ("1- (fixed)", "1+ (movable)", "2- (movable)", "2+ (fixed)")
_THOUSAND_HOURS = 3.6e6  # [s]
_POISSON = 0.3
_STEPS = 24  # of the histogram
_MICRO = 1e6


def wear(record, scene):
    """As Record.wear(). scene: of the record."""
    time = record["time"]
    if len(time) < 2 or not time[-1] > time[0]:
        raise ValueError(f"{record.path}: wear requires 2 rows at least")

    def rows(name):
        if f"wear/{name}" not in record.info:
            raise ValueError(f"{record.path}: the record has no channel wear/{name}; record it with record.channels=wear/*")
        return record[f"wear/{name}"]

    def integral(name):
        values = rows(name)
        return 0.5 * np.diff(time) @ (values[1:] + values[:-1])

    def largest(name):
        return np.fmax.reduce(rows(name), axis=0, initial=0.0)

    energy, force_way, load = (each.reshape(len(_SHEAVES), -1)
                               for each in (integral("friction_power"), integral("force_speed"), largest("pressure_speed")))
    width = (scene["pulley.outermost"] - scene["pulley.innermost"]) / energy.shape[1]
    radius = scene["pulley.innermost"] + (np.arange(energy.shape[1]) + 0.5) * width
    worn = scene["wear.coefficient"] * _THOUSAND_HOURS / (time[-1] - time[0])  # volume in 1,000 hours per integral of force and speed
    modulus = 0.5 * scene["chain.young_modulus"] / (1.0 - _POISSON**2)
    contact = 0.5 * np.pi * (0.75 * scene["tip.hertz"] / modulus)**2 * largest("tip_pressure") / modulus  # a = π R p/(2 E*)
    area = np.pi * np.where(contact > 0.0, contact, np.nan)**2
    return {"radius": radius, "energy": energy / width, "pressure_speed": load,
            "sheave_depth": worn * force_way * np.cos(scene["tip.angle"]) / (2.0 * np.pi * radius * width),
            "tip_depth": worn * integral("tip_force_speed") / area}


def _sampled(record, energy):
    """How well the outputs sample the wear: their sum beside the energy that the run has accounted for in every step."""
    if "dissipated/tip_friction" not in record.info:
        return ""
    accounted = record["dissipated/tip_friction"]
    return f"\n{record.rows} outputs sum to {energy:.4g} J of the {accounted[-1] - accounted[0]:.4g} J that friction of tips dissipated"


def _histogram(axes, depths):
    """Number of depths by their size, in equal steps from the smallest to the largest."""
    least, most = depths.min(), depths.max()
    width = max(most - least, 1e-6 * abs(most)) / _STEPS
    step = np.minimum((depths - least) / width, _STEPS - 1).astype(int)
    axes.stairs(np.bincount(step, minlength=_STEPS), least + width * np.arange(_STEPS + 1))


def draw(record, scene, ax):
    """As Record.plot_wear()."""
    import matplotlib.pyplot as pyplot

    found = wear(record, scene)
    axes = pyplot.subplots(2, 2, figsize=(12.0, 7.2), layout="constrained")[1] if ax is None else ax
    panels, radius = np.ravel(axes), found["radius"]
    width = radius[1] - radius[0]
    sampled = _sampled(record, found["energy"].sum() * width)
    for axis, name, factor, label, title in (
            (panels[0], "energy", 1e-3, "energy per radius [J/mm]", "Friction energy of the tips by radius" + sampled),
            (panels[1], "pressure_speed", 1e-6, "p v [MPa·m/s]", "Largest pressure times sliding speed"),
            (panels[2], "sheave_depth", _MICRO, "depth [µm]",
             f"Worn depth of the sheaves in 1,000 hours, Archard's coefficient {scene['wear.coefficient']:.3g} 1/Pa")):
        for sheave, values in zip(_SHEAVES, found[name]):
            axis.plot(1e3 * radius, factor * np.where(values > 0.0, values, np.nan), ".-", label=f"sheave {sheave}")
        used = radius[(found[name] > 0.0).any(axis=0)]  # few rings at one ratio
        if used.size:
            axis.set_xlim(1e3 * (used[0] - 1.5 * width), 1e3 * (used[-1] + 1.5 * width))
        axis.set(xlabel="radius [mm]", ylabel=label)
        axis.set_title(title, fontsize="medium")
        axis.legend()
    depths = _MICRO * found["tip_depth"][np.isfinite(found["tip_depth"])]
    if depths.size and depths.max() > 0.0:
        _histogram(panels[3], depths)
    panels[3].set(xlabel="depth [µm]", ylabel="number of tips")
    panels[3].set_title("Worn depth of the tips in 1,000 hours", fontsize="medium")
    return axes
