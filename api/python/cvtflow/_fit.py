"""Keys of a scene by measured values."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._known import rows_of, suggestion
from ._library import in_si
from ._measured import Measured
from ._rows import column_name
from ._scene import Scene, all_keys, opened, resolve
from ._sweep import Sweep


class Fit:
    """Result of fit(): values by key in SI, confidence intervals by key, residuals (simulated less measured) by scalar, and the scene.
    `free` is the number of measured values beyond that of keys: intervals are wide up to about three, and infinite at 0."""

    def __init__(self, scene: Scene, values: dict[str, float], confidence: dict[str, tuple[float, float]], residuals: dict[str, Any],
                 level: float, free: int) -> None:
        self.scene, self.values, self.confidence, self.residuals, self.level, self.free = scene, values, confidence, residuals, level, free

    def __repr__(self):
        lines = [f"{key} = {value:.5g} ({self.confidence[key][0]:.5g} to {self.confidence[key][1]:.5g} at {100 * self.level:g} %)"
                 for key, value in self.values.items()]
        rest = [f"{name}: {math.sqrt(np.mean(each ** 2)):.3g} rms" for name, each in self.residuals.items()]
        return f"<cvtflow.Fit {', '.join(lines)}; residuals {', '.join(rest)}>"


def fit(scene: Scene | str, parameters: Mapping[str, tuple[Any, Any]], measured: Mapping[str, Any] | str, *,
        deviations: Mapping[str, Any] | None = None, level: float = 0.95, settings: Mapping[str, Any] | None = None, threads: int = 0,
        step: float = 0.02) -> Fit:
    """Adjusts keys of a scene to measured values by least squares (scipy.optimize.least_squares). Returns a Fit.

    fit("baseline", {"tip.friction_coefficient": (0.05, 0.14)}, {"load.torque": [60, 120, 180], "slip mean": [0.0015, 0.0028, 0.0046]})

    parameters  least and largest value by key, in SI or with units; the search begins at the value of the scene
    measured    arrays of equal length by name, a pandas.DataFrame, or a CSV or MAT file: keys of the scene are operating points, other names
                are scalars of a sweep ("slip mean", "efficiency mean", "thrust_ratio mean") with their measured values; in SI, or in the unit
                of the name: "slip mean [%]"
    deviations  standard deviation of a measured value by scalar; None: 1 % of its largest magnitude
    level       of the confidence intervals, from the Jacobian and the residuals; infinite without more values than parameters
    settings    further values of keys by name, such as run.until
    step        relative change of a key for its derivative
    Raises ImportError where SciPy is not installed, ValueError for malformed arguments, RuntimeError for a case without a result.
    """
    from scipy.optimize import least_squares
    from scipy.stats import t as student

    scene = opened(scene).with_(settings or {})
    points, targets = _columns(Measured(measured))
    columns = {**points, **targets}
    if not points or not targets or len({len(each) for each in columns.values()}) != 1:
        raise ValueError("measured: one key of the scene or more, and one scalar or more, of equal lengths")
    if not all(np.isfinite(each).all() for each in columns.values()):
        raise ValueError("measured: a value is not finite")
    if not (0.0 < level < 1.0 and 0.0 < step < 1.0):
        raise ValueError("level and step: numbers between 0 and 1")
    if not all(name in targets and np.all(np.asarray(value) > 0.0) for name, value in (deviations or {}).items()):
        raise ValueError("deviations: positive numbers by the names of measured scalars")
    if not hasattr(parameters, "values") or not all(isinstance(ends, (tuple, list)) and len(ends) == 2 for ends in parameters.values()):
        raise TypeError('parameters: least and largest value by key, such as {"tip.friction_coefficient": (0.05, 0.14)}')
    keys = [resolve(scene, name) for name in parameters]
    low, high = np.array([[in_si(value, key, all_keys()[key].unit) for value in ends] for key, ends in zip(keys, parameters.values())], dtype=float).T
    if not np.all(low < high):
        raise ValueError("parameters: the least value of a key is not below its largest")
    scale = {name: (deviations or {}).get(name, 0.01 * np.max(np.abs(each))) for name, each in targets.items()}

    def residuals_at(values):
        rows = list(zip(*points.values()))
        axes = {tuple(points): rows} if len(points) > 1 else {key: list(each) for key, each in points.items()}
        sweep = Sweep(scene.with_({key: float(value) for key, value in zip(keys, values)}), axes, list(targets))
        with tempfile.TemporaryDirectory() as folder:
            results = sweep.run(folder, threads, progress=False)
        for number, status in enumerate(results["status"]):
            if status != "ok":
                raise RuntimeError(f"case {number} of {dict(zip(keys, values))} ended with the status {status}")
        return {name: np.asarray(results[results.column(name)]) - each for name, each in targets.items()}

    def weighted(values):
        return np.concatenate([each / scale[name] for name, each in residuals_at(values).items()])

    first = np.clip([float(scene[key]) for key in keys], low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    found = least_squares(weighted, first, bounds=(low, high), x_scale=high - low, diff_step=step, xtol=1e-4, ftol=1e-8)
    free = len(found.fun) - len(keys)
    covariance = np.linalg.pinv(found.jac.T @ found.jac)
    spread = np.sqrt(np.diag(covariance) * (2.0 * found.cost / free)) if free > 0 else np.full(len(keys), np.inf)
    reach = spread * (student.ppf(0.5 + 0.5 * level, free) if free > 0 else 1.0)
    values = {key: float(value) for key, value in zip(keys, found.x)}
    intervals = {key: (float(value - each), float(value + each)) for key, value, each in zip(keys, found.x, reach)}
    return Fit(scene.with_(values), values, intervals, residuals_at(found.x), level, free)


def _columns(measured):
    """Measured values in SI: of keys by key, of scalars by "slip mean". Raises Misuse."""
    keys = {column_name(name): name for name in all_keys()}
    points, targets = {}, {}
    for name in measured:
        if key := keys.get(column_name(name)):
            points[key] = measured.column(name, all_keys()[key].unit)
            continue
        channel, _, statistic = name.replace(" ", "_").rpartition("_")
        channels = rows_of("channels")
        if channel not in channels:
            raise ValueError(f"measured: '{name}' is no key, and no scalar such as \"slip mean\"" + suggestion(channel, channels))
        targets[f"{channel} {statistic}"] = measured.column(name, channels[channel]["unit"])
    return points, targets
