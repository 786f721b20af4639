"""Load cycles by rainflow counting, ASTM E1049-85 (2017), section 5.4.4, as `cvtflow table RECORD --rainflow` counts them."""

import numpy as np

_FIELDS = [(name, float) for name in ("range", "mean", "count", "from_time", "to_time")]


def _reversals(history):
    """Indices of the first value, every peak and valley (of equal neighbours the first), the last value."""
    kept = np.flatnonzero(np.append(True, history[1:] != history[:-1])[:len(history)])
    if len(kept) < 2:
        return kept
    rises = np.diff(history[kept]) > 0.0
    return kept[np.concatenate(([True], rises[1:] != rises[:-1], [True]))]


def cycles(time, history):
    """Cycles of a load, in the order in which they are counted; halves that remain come last: an array as of Series.rainflow().

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
    return np.array(counted, dtype=_FIELDS)
