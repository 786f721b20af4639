"""Arithmetic on courses over time: means over pin periods, spectra, load cycles, thinning."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]
else:
    Array = np.ndarray  # importing numpy.typing takes a tenth of a short command's time

_CYCLE = [(name, float) for name in ("range", "mean", "count", "from_time", "to_time")]


def mean(values):
    """Of the finite values; NaN where there are none."""
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else math.nan


def spectrum(times, values):
    """Frequencies [Hz] and amplitudes in a Hann window over all values, as of `cvtflow plot --orders`."""
    distance = times[1] - times[0]
    if abs(times[-1] - times[-2] - distance) > 1e-3 * distance:  # the last output of a run
        values = values[:-1]
    values = np.where(np.isfinite(values), values, mean(values))
    place = np.arange(len(values)) - 0.5 * len(values)
    window = 0.5 + 0.5 * np.cos(2.0 * np.pi * place / len(values))
    slope = window @ (values * place) / (window @ place ** 2)  # a drift leaks into low orders
    values = values - window @ values / window.sum() - slope * place
    padded = 2 << (len(values) - 1).bit_length()
    return np.fft.rfftfreq(padded, distance), 2.0 * np.abs(np.fft.rfft(window * values, padded)) / window.sum()


def _reversals(history):
    """Indices of the first value, every peak and valley (of equal neighbours the first), the last value."""
    kept = np.flatnonzero(np.append(True, history[1:] != history[:-1])[:len(history)])
    if len(kept) < 2:
        return kept
    rises = np.diff(history[kept]) > 0.0
    return kept[np.concatenate(([True], rises[1:] != rises[:-1], [True]))]


def cycles(time, history):
    """Cycles of a load by rainflow counting, ASTM E1049-85 (2017), section 5.4.4, in the order in which they are counted; halves that
    remain come last: an array as of Series.rainflow().

    time, history  [rows], [s] and any unit, finite
    """
    load, counted, waiting = history.tolist(), [], []  # waiting: reversals that belong to no cycle yet

    def count(a, b, number):
        counted.append((abs(load[b] - load[a]), 0.5 * (load[a] + load[b]), number, time[a], time[b]))

    for turn in _reversals(history):
        waiting.append(turn)
        while len(waiting) >= 3:
            before, middle, last = waiting[-3:]
            if abs(load[last] - load[middle]) < abs(load[middle] - load[before]):
                break
            has_start = len(waiting) == 3  # half a cycle, whose first point is the start of the history
            count(before, middle, 0.5 if has_start else 1.0)
            del waiting[-3:-2 if has_start else -1]
    for a, b in zip(waiting, waiting[1:]):
        count(a, b, 0.5)
    return np.array(counted, dtype=_CYCLE)


def period_means(times, values, period):
    """Middles [s] of whole periods from the first time on, and the means of the finite values in them; NaN in one without."""
    number = np.floor((times - times[0]) / period * (1.0 + 1e-12)).astype(int)
    whole = number < number[-1]  # the last one is cut
    number, values = number[whole], values[whole]
    finite = np.isfinite(values)
    there = np.unique(number)
    count = np.bincount(number[finite], minlength=there[-1] + 1 if len(there) else 0)
    total = np.bincount(number[finite], weights=values[finite], minlength=len(count))
    with np.errstate(invalid="ignore"):
        return times[0] + (there + 0.5) * period, (total / count)[there]


def thinned(x, y, columns):
    """The points of a curve, of more than twice as many as columns the first and last extremes of each."""
    if len(x) <= 2 * columns:
        return x, y
    edges = np.arange(columns + 1) * len(x) // columns
    kept = []
    for begin, end in zip(edges, edges[1:]):
        part = y[begin:end]
        if np.isfinite(part).any():
            kept += sorted({begin + int(np.nanargmin(part)), begin + int(np.nanargmax(part))})
        else:
            kept.append(begin)
    return x[kept], y[kept]


def pattern_length(pitch, links):
    """Links after which the pitches repeat; all where no shorter pattern divides the chain."""
    all_pitches = np.resize(pitch, links)
    return next(length for length in range(1, links + 1) if links % length == 0 and np.array_equal(all_pitches, np.roll(all_pitches, length)))


def integral(times, values):
    """By the trapezoidal rule over the first axis."""
    return 0.5 * np.diff(times) @ (values[1:] + values[:-1])


def belt_radii(length, distance, ratio):
    """Running radii of both pulleys [m] at a ratio, of a chain of that length at that distance of the shafts [m] without strain."""
    def excess(first):
        second = ratio * first
        lean = math.asin(max(-1.0, min(1.0, (second - first) / distance)))
        return math.pi * (first + second) + 2 * lean * (second - first) + 2 * distance * math.cos(lean) - length

    low, high = 0.0, distance / (1.0 + ratio)
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if excess(middle) > 0 else (middle, high)
    return low, ratio * low
