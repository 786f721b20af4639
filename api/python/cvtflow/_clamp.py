"""`cvtflow clamp`: clamping forces of best efficiency at a margin of slip, over ratio and torque."""

import itertools
import math
import time

import numpy as np

from ._known import Misuse
from ._reduce import SAFETY, Bench, Machine, Map, is_good, axes_of, steady
from ._reduction import csv_text, efficiency, over_torque
from ._small import Small

SHARES = (0.0, 0.4, 0.6, 0.75, 0.85, 0.92, 0.97)
_WORTH = 5e-4  # gain of efficiency from which another force than that of the safety factor is recommended: maps miss gains by so much
_CHECKED = 5  # points at most at which both clamping forces run, at each level of detail


class Rule:
    """Clamping forces of best efficiency: by a map, above what the margin of slip asks for, within the range of clamping forces."""

    def __init__(self, machine, model, axes, margin, safety):
        self._machine, self._model, self._margin, self._safety = machine, model, margin, safety
        self._range = axes["clamping"][0], axes["clamping"][-1]

    def today(self, ratio, torque):
        """Clamping force of the safety factor."""
        return float(np.clip(self._safety * torque / self._machine.limit(ratio, 1.0), *self._range))

    def best(self, ratio, torque, speed):
        """Clamping force, and what decides: efficiency, slip, range, or safety where no other force is better by _WORTH. None: no force of
        the range keeps the margin."""
        today = self.today(ratio, torque)
        forces = np.sort([*np.geomspace(*self._range, 60), today])
        places = [self._model.values_at(ratio, torque / self._machine.limit(ratio, each), each, speed)[0] for each in forces]
        shares = np.array([torque / self._machine.limit(ratio, each) for each in forces])
        allowed = np.flatnonzero((1.0 + self._margin) * shares <= [each["limit"] for each in places])
        if not len(allowed):
            return None
        values = {k: efficiency(self._machine, self._model, ratio, torque, forces[k], speed)[0] for k in allowed}
        chosen, usual = max(values, key=values.get), np.searchsorted(forces, today)
        if usual in values and usual != chosen and values[chosen] - values[usual] < _WORTH:
            return today, "safety"
        return float(forces[chosen]), "range" if chosen == 0 else "slip" if chosen == allowed[0] else "efficiency"


def _rows(rule, machine, model, axes, speed):
    """Rows of the table: ratio, torque, forces, efficiencies, what decides."""
    torques = np.linspace(0.0, machine.limit(1.0, axes["clamping"][-1]), 13)[1:]
    for ratio in axes["ratio"]:
        for torque in torques:
            found = rule.best(ratio, torque, speed)
            if found is not None:
                today = rule.today(ratio, torque)
                both = [efficiency(machine, model, ratio, torque, each, speed)[0] for each in (found[0], today)]
                thrust = model.values_at(ratio, torque / machine.limit(ratio, found[0]), found[0], speed)[0]["thrust"]
                yield ratio, torque, found[0], found[0] * thrust, today, *both, found[1]


def _spread(rows, count):
    """Rows of the table, at equal distances: of those whose forces differ by a hundredth, else of all; each once, so there can be fewer."""
    some = [row for row in rows if abs(row[2] - row[4]) > 0.01 * row[4]] or rows
    return [some[k] for k in np.unique(np.linspace(0, len(some) - 1, count + 2).astype(int)[1:-1])]


def _gains(bench, machine, model, rows, speed, level):
    """Texts of what both forces of rows differ by in efficiency, by steady cases at a level of detail."""
    forces = [(ratio, torque, force) for ratio, torque, best, _, today, *_rest in rows for force in (best, today)]
    points = [(ratio, torque / machine.limit(ratio, force), force, speed) for ratio, torque, force in forces]
    thrust = np.array([model.values_at(*each)[0]["thrust"] for each in points])
    found = steady(bench, machine, f"confirm_{level}", points, thrust, bench.shorter_step() if level == bench.level else None, level)
    power = np.array([torque for _, torque, _ in forces]) * speed / found["ratio_mean"]
    runs, good = power / (power + found["loss_total_mean"]), is_good(found)
    return [f"{100 * (runs[k] - runs[k + 1]):+.3f} at {level}" if good[k:k + 2].all() else f"not steady at {level}"
            for k in range(0, len(forces), 2)]


def _confirmed(bench, machine, model, rows, speed, axes):
    """Lines that state both efficiencies at points of the table, by the map and by runs at two levels of detail."""
    counts = [(level, min(_CHECKED, count)) for level, count in bench.compared(axes) if count > 0]
    if not counts:
        return
    chosen = _spread(rows, max(count for _, count in counts))
    gains = [_gains(bench, machine, model, chosen[:count], speed, level) for level, count in counts]
    for (ratio, torque, best, _, today, after, before, decides), *runs in itertools.zip_longest(chosen, *gains):
        yield (f"  ratio {ratio:.2f}, {torque:5.0f} N*m: {best / 1e3:5.2f} kN instead of {today / 1e3:5.2f} kN ({decides}), efficiency "
               f"{100 * after:.2f} instead of {100 * before:.2f} %: gain "
               + ", ".join([f"{100 * (after - before):+.3f} points by the map", *filter(None, runs)]))


def clamp(request):
    """Computes the table that a command line requests. Returns its exit status and lines to print."""
    begin = time.monotonic()
    bench = Bench(request, ("clamping.csv", "clamping.svg"))
    machine, margin = Machine(bench.scene), request["margin"]
    axes = axes_of(machine, request["axes"], SHARES)
    axes["load"] = np.append(axes["load"], [share for share in SHARES if share > axes["load"][-1] + 0.01])  # to the limit of slip
    speed, safety = float(np.median(axes["speed"])), bench.scene["clamping.safety"] or SAFETY
    axes["speed"] = np.array([speed])
    steady_map = Map(bench, machine, axes, theory=False)
    values = {**steady_map.values, "shift": 0 * steady_map.limit, "limit": steady_map.limit}
    axes["speed"] = np.array([0.9, 1.1]) * speed  # the map is the same at all speeds
    model = Small(machine, axes, {name: np.repeat(each, 2, axis=0) for name, each in values.items()}, bench.scene).load()
    rows = list(_rows(Rule(machine, model, axes, margin, safety), machine, model, axes, speed))
    if not rows:
        raise Misuse(f"no clamping force of {axes['clamping'][0]:g} to {axes['clamping'][-1]:g} N keeps the margin of {margin:g}")
    names = ("ratio [1]", "torque_2 [N*m]", "clamping_2 [N]", "clamping_1 [N]", "clamping_2_by_safety [N]", "efficiency [1]",
             "efficiency_by_safety [1]")
    bench.write("clamping.csv", csv_text({name: [row[k] for row in rows] for k, name in enumerate(names)}))
    ratio, torque, best, _, _, after, before = np.array([row[:7] for row in rows], dtype=float).T
    bench.write("clamping.svg", over_torque(
        f"{request['name']}: clamping of best efficiency, {speed * 30 / math.pi:.0f} rpm on shaft 1", torque, ratio,
        {"clamping force [kN]": best / 1e3, "gain [points of %]": 100 * (after - before)}))
    gains, decides = after - before, [row[7] for row in rows]
    lines = [f"{request['name']}: {len(rows)} points at {speed * 30 / math.pi:.0f} rpm, margin of slip {100 * margin:.0f} % of the load "
             f"beside the safety factor {safety:g}",
             "  decided by " + ", ".join(f"{name} {decides.count(name)}" for name in ("efficiency", "slip", "range", "safety")),
             f"  gain {100 * np.median(gains):+.3f} points of efficiency in the median, {100 * gains.min():+.3f} to "
             f"{100 * gains.max():+.3f}",
             *_confirmed(bench, machine, model, rows, speed, axes),
             f"written to {request['place']}: clamping.csv, clamping.svg, in {time.monotonic() - begin:.0f} s"]
    return 0, lines
