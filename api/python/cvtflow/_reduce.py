"""`cvtflow reduce`: a machine's steady map and shift law as tables, and as an FMU with measured errors."""

import math
import os
import re
import sys
import time
import tomllib
from pathlib import Path

import numpy as np

from . import Record, Recording, Scene, Simulation, Sweep, Threads, _known
from ._numbers import belt_radii
from ._output import Output
from ._sweep import Line

SHARES = (0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.85, 0.95)  # of the torque limit
SAFETY = 1.3  # of tables over torque, where the scene has none
_AXES = {"ratio": ("1", 0.05, 20.0), "load": ("1", 0.0, 2.0), "clamping": ("N", 1.0, 1e7), "speed": ("rad/s", 0.1, 1e4)}  # unit, range
KINDS = {"tips": ("tip_friction", "tip_damping"), "joints": ("joint_friction", "joint_damping"),
         "plates": ("plate_friction", "plate_damping", "inner"), "supports": ("supports",)}
SCALARS = ["ratio mean", "slip mean", "friction_slip mean", "shaft_1/clamping mean", "tight_tension mean", "slack_tension mean",
           "loss/total mean", *(f"loss/{part} mean" for parts in KINDS.values() for part in parts)]
_PLAIN = {"drive.mode": "speed", "load.mode": "torque", "load.linear": 0, "load.quadratic": 0, "vehicle.mass": 0, "cycle.speed": 0,
          "hydraulics.mode": "none", "heat.enabled": False, "clamping.safety": 0, "control.driven": "none", "control.quantity": "ratio",
          "start.state": "", "start.layout": "belt", "start.settling_time": "60 ms", "start.ramp_time": "5 ms",
          "run.output_interval": "200 us"}
_STEADY = {"control.enabled": True, "control.gains": "found", "control.when_steady": "hold", "run.until": "steady"}


class Machine:
    """What the map needs of a scene: radii by ratio, torque limit, ranges of the axes."""

    def __init__(self, scene):
        self.scene = scene
        self.friction = scene["tip.friction_coefficient"] * scene.get("tip.friction_scale", 1.0)
        self.limits = scene["pulley.innermost"], scene["pulley.outermost"]
        self._length = scene["chain.pins"] * np.mean(scene["chain.pitch"])
        self._distance = scene["pulley.centre_distance"]

    def radii(self, ratio):
        """Running radii of both pulleys [m] that a chain without strain has at a ratio."""
        return belt_radii(self._length, self._distance, ratio)

    def limit(self, ratio, clamping):
        """Torque of shaft 2 at which the chain slips in theory [N m]: 2 mu S_2 r_2/cos(beta)."""
        return 2 * self.friction * clamping * self.radii(ratio)[1] / math.cos(self.scene["tip.angle"])

    def _range(self, key):
        given = self.scene[key]
        values = [row[1] for row in given] if isinstance(given, list) else [given]
        return min(values), max(values)

    def _clamping(self):
        """Least and largest clamping force: around the scene's table; with clamping.safety from it to what the load asks for."""
        least, most = self._range("clamping.driven")
        asked = self.scene["clamping.safety"] * max(map(abs, self._range("load.torque"))) / self.limit(self.scene["start.ratio"], 1.0)
        if asked <= most or self.scene["cycle.speed"]:
            return 0.4 * max(most, 1e3), 2.0 * max(most, 1e3)
        return max(least, 0.1 * asked), 1.1 * asked

    def axes(self, loads=SHARES):
        """Default axes: what the grooves have room for, the scene's ratios, and its speeds with what lies around them."""
        ends = [ratio for ratio in np.geomspace(1.0, 6.0, 200)
                if self.radii(ratio)[0] >= 1.3 * self.limits[0] and self.radii(ratio)[1] <= 0.95 * self.limits[1]] or [1.2]
        given = [self.scene["start.ratio"], *(self._range("control.ratio") if self.scene["control.enabled"] else ())]
        end = max(ends[-1], *given, *(1 / each for each in given))
        if self.scene["cycle.speed"]:
            slow, fast = self.scene["cycle.idle_speed"], 1.2 * self._range("cycle.engine_speed")[1]
        else:
            slow, fast = self._range("drive.speed")
        speeds = np.linspace(slow, fast, 4) if fast > 1.5 * slow > 0 else np.array([0.4, 0.8, 1.3, 2.0]) * fast
        return {"ratio": np.geomspace(1 / end, end, 7), "load": np.array(loads), "clamping": np.geomspace(*self._clamping(), 4),
                "speed": speeds, "points": 40, "fine": 10, "courses": True}


def axes_of(machine, text, loads=SHARES):
    """Axes of a file over the default ones, checked. Raises Misuse."""
    axes = machine.axes(loads)
    try:
        given = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise _known.Misuse(f"--axes: {error}") from None
    for name, value in given.items():
        if name not in axes:
            raise _known.Misuse(f"--axes: no axis {name}{_known.suggestion(name, axes)}; there are {', '.join(axes)}")
        axes[name] = _axis(name, value) if name in _AXES else value
    if type(axes["courses"]) is not bool:
        raise _known.Misuse("--axes: courses: true or false")
    for name in ("points", "fine"):
        if type(axes[name]) is not int or not 0 <= axes[name] <= 10_000:
            raise _known.Misuse(f"--axes: {name}: a whole number from 0 to 10000")
    if axes["load"][0] != 0:
        raise _known.Misuse("--axes: load: the first share of the torque limit is 0")
    for ratio in axes["ratio"]:
        if not machine.limits[0] <= min(machine.radii(ratio)) <= max(machine.radii(ratio)) <= machine.limits[1]:
            raise _known.Misuse(f"--axes: ratio: at {ratio:g} the chain leaves its sheaves")
    if (count := math.prod(len(axes[name]) for name in _AXES)) > 100_000:
        raise _known.Misuse(f"--axes: {count} points, more than 100000")
    return axes


def _axis(name, value):
    """Values of an axis in SI."""
    unit, least, most = _AXES[name]
    try:
        found = np.array([_known.quantity(each, unit) if isinstance(each, str) else float(each if type(each) in (int, float) else [])
                          for each in (value if isinstance(value, list) else [[]])])
    except (OverflowError, TypeError, ValueError):
        raise _known.Misuse(f"--axes: {name}: a list of numbers in SI, or of texts with a unit") from None
    if not 2 <= len(found) <= 100 or not ((found >= least) & (found <= most)).all() or (np.diff(found) < max(1e-3 * found[-1], 1e-6)).any():
        raise _known.Misuse(f"--axes: {name}: 2 to 100 values from {least:g} to {most:g} (SI), rising by a thousandth of the last or more")
    return found


class Bench:
    """Runs sweeps and scenes of one machine in a folder in which a second start continues."""

    def __init__(self, request, names=()):
        """names: of the files that write() may write."""
        self.folder, self.scene, self.level, self._threads = (request[name] for name in ("folder", "scene", "detail", "threads"))
        self.runs = os.path.join(self.folder, "runs")
        if os.path.islink(self.runs):
            raise FileExistsError(f"{self.runs}: is a link; results are written into real folders")
        if os.path.isdir(self.folder) and os.listdir(self.folder) and not os.path.isfile(os.path.join(self.runs, "scene.toml")):
            raise FileExistsError(f"{request['place']}: contains files of others; name another folder")
        os.makedirs(self.runs, exist_ok=True)
        self._outputs = {name: Output(os.path.join(request["place"], name), force=request["force"], named=request["named"]) for name in names}
        self._text = re.sub(r"(?m)^state = .*\n", "", request["text"])  # start.state has no effect, and its path is that of the installation
        head, place = f"# {self.level}\n{self._text}", os.path.join(self.runs, "scene.toml")
        if not os.path.lexists(place) or os.path.getsize(place) == 0:  # a power cut has emptied it
            Output(place, force=True).write(head.encode())
        elif os.path.islink(place) or not os.path.isfile(place) or Path(place).read_bytes() != head.encode():
            raise FileExistsError(f"{place}: differs, so results beside it are of another machine or level of detail; name another "
                                  "folder, or remove this one")

    def write(self, name, content):
        """Writes a file of the folder. Raises OutputError."""
        self._outputs[name].write(content if isinstance(content, bytes) else content.encode())

    @staticmethod
    def report(line):
        """Prints a line of progress."""
        print(f"  {line}", file=sys.stderr, flush=True)

    def shorter_step(self):
        """Three fifths of the automatic step at the start, as text."""
        scene = Scene.parse(self._text).with_detail(self.level).with_('run.step="auto"')
        return f"{0.6e6 * Simulation(scene, Threads.caller()).step_length:.4g} us"

    def compared(self, axes):
        """Levels of detail at which points are compared, each with their number: the map's, and fine where that is another."""
        return [(self.level, axes["points"])] + [("fine", axes["fine"])] * (self.level != "fine")

    def record(self, name, settings):
        """The Record of a ready scene with settings, NAME.h5, which gets its name when the run has ended. Raises Error."""
        path, begin = os.path.join(self.runs, f"{name}.h5"), time.monotonic()
        if not os.path.exists(path):
            simulation = Simulation(Scene.ready(name).with_detail(self.level).with_(settings), Threads.private_arena(self._threads))
            simulation.advance_to(0.0)
            recording = Recording(simulation, path, replace=True)  # rows of a program that was stopped
            simulation.advance_to(simulation.scene["run.until"])
            recording.finish()
            self.report(f"{name:12} in {time.monotonic() - begin:.0f} s")
        return Record(path)

    def sweep(self, name, settings, rows, scalars, continued=False, detail=None):
        """Results of a sweep over rows (key: values) as arrays by column; runs what is missing."""
        settings = {**_PLAIN, "detail.pulleys": self.scene["detail.pulleys"], **settings}  # which a level of detail would set
        start = {"mode": "settle", **({"continuation": "load.torque"} if continued else {})}
        sweep = Sweep(Scene.parse(self._text), {tuple(rows): list(zip(*rows.values()))}, scalars, settings=settings,
                      detail=detail or self.level, start=start, name=name)
        begin, folder = time.monotonic(), os.path.join(self.runs, name)
        if not os.path.exists(folder):
            self.report(f"{name:12} {len(next(iter(rows.values())))} cases")
        results = sweep.run(folder, self._threads, Line(every=10.0), keep_going=True)  # the first dozen may be at the edge of a map
        found = {column: np.array(values) for column, values in results.items()}
        self.report(f"{name:12} {len(found['case'])} cases in {time.monotonic() - begin:.0f} s, {np.sum(found['status'] == 'ok')} ok")
        return found


def steady(bench, machine, name, points, thrust=None, step=None, detail=None, settings=None):
    """Steady cases at points (ratio, share, clamping, speed): columns of the sweep. thrust: of each point, from which control begins; None:
    the points are lines of rising loads, each of which starts from the end of the one before."""
    ratio, share, clamping, speed = np.array(points).T
    torque = share * [machine.limit(*each) for each in zip(ratio, clamping)]
    begin = clamping * (ratio ** -0.29 if thrust is None else thrust)
    rows = {"start.ratio": ratio, "control.ratio": ratio, "clamping.driven": clamping, "clamping.driving": begin, "load.torque": torque,
            "drive.speed": speed}
    chosen = {**_STEADY, "control.authority": 2.0 * float(clamping.max()), **({"run.step": step} if step else {}), **(settings or {})}
    return bench.sweep(name, chosen, rows, SCALARS, continued=thrust is None, detail=detail)


def is_good(found):
    """Steady cases without gross slip, and those whose means are known to 2.5 % when the limit of a steady case is reached."""
    slides = np.array(["gross_slip" in notes for notes in found["notes"]])
    known = np.maximum(*(found[f"error_of_{name}_mean"].astype(float) for name in ("loss_total", "shaft_1_clamping"))) <= 0.025
    return ((found["status"] == "ok") | (found["status"] == "not_steady") & known) & ~slides & np.isfinite(found["loss_total_mean"])


class Map:
    """Steady values over speed, clamping, ratio and load: dimensionless arrays by name. Holes are filled, and above `limit`."""

    def __init__(self, bench, machine, axes, theory=True):
        self.machine, self.axes = machine, axes
        names = ("speed", "clamping", "ratio", "load")
        grid = np.stack(np.meshgrid(*(axes[each] for each in names), indexing="ij"), axis=-1)
        self.shape, loads = grid.shape[:-1], len(axes["load"])
        points = grid.reshape(-1, 4)[:, [2, 3, 1, 0]]
        found = steady(bench, machine, "map", points)
        missing = (found["status"] == "unreliable").reshape(-1, loads).any(axis=1)
        if missing.any():  # their energy balances do not close with the automatic step
            again = steady(bench, machine, "map_again", points[np.repeat(missing, loads)], step=bench.shorter_step())
            for column in found:
                if column in again:
                    found[column] = found[column].astype(object) if found[column].dtype.kind == "U" else found[column]
                    found[column][np.repeat(missing, loads)] = again[column]
        self.points, self.found, self.good = points, found, is_good(found)
        driving, driven, speed = found["shaft_1_clamping_mean"], points[:, 2], points[:, 3]
        losses = {kind: sum(found[f"loss_{part}_mean"] for part in parts) for kind, parts in KINDS.items()}
        raw = {"thrust": driving / driven, "slip": found["slip_mean"], "loss": found["loss_total_mean"] / (speed * driven),
               "tips": losses["tips"] / (speed * driven), "tight": found["tight_tension_mean"] / driven,
               "slack": found["slack_tension_mean"] / driven}
        self.losses, self.torque = losses, points[:, 1] * [machine.limit(*each) for each in points[:, [0, 2]]]
        self.values = {name: self._filled(each) for name, each in raw.items()}
        self.limit = np.repeat(self._limits(theory), loads, axis=-1)
        self.holes = int((~self.good).sum())

    def _limits(self, theory):
        """Of each line the largest load with a steady case without gross slip; between such cases there is no limit. theory: where the
        last load is steady, the map does not contain the limit, and that of the theory is taken, of share 1."""
        good = self.good.reshape(self.shape)
        last = self.shape[-1] - 1 - np.argmax(good[..., ::-1], axis=-1)
        limit = np.where(theory & (last == len(self.axes["load"]) - 1), np.maximum(1.0, self.axes["load"][last]), self.axes["load"][last])
        return np.where(good.any(axis=-1), limit, -1e-9)[..., None]

    def _filled(self, values):
        """A grid without holes: linear along the load, level beyond; a line without cases is that of the next clamping force or speed."""
        made, good, load = values.reshape(self.shape).copy(), self.good.reshape(self.shape), self.axes["load"]
        lines = {}
        for place in np.ndindex(self.shape[:-1]):
            has = good[place]
            if has.sum() >= 2:
                made[place] = np.interp(load, load[has], made[place][has])
                lines[place] = made[place]
        if not lines:
            raise RuntimeError("no load of the map has a steady case: see the column status of map/results.csv")
        for place in np.ndindex(self.shape[:-1]):
            if place not in lines:
                made[place] = lines[min(lines, key=lambda other: sum(abs(a - b) for a, b in zip(place, other)))]
        return made

    def columns(self):
        """Columns of map.csv: (heading, values)."""
        found, point, torque = self.found, self.points, self.torque
        power = torque * point[:, 3] / found["ratio_mean"]
        with np.errstate(invalid="ignore", divide="ignore"):
            efficiency = np.where(power > 0, power / (power + found["loss_total_mean"]), np.nan)
        made = {"ratio [1]": point[:, 0], "load_share [1]": point[:, 1], "torque_2 [N*m]": torque, "clamping_2 [N]": point[:, 2],
                "speed_1 [rad/s]": point[:, 3], "efficiency [1]": efficiency, "slip [1]": found["slip_mean"],
                "friction_slip [1]": found["friction_slip_mean"], "thrust_ratio [1]": found["shaft_1_clamping_mean"] / point[:, 2],
                "clamping_1 [N]": found["shaft_1_clamping_mean"], "tight_tension [N]": found["tight_tension_mean"],
                "slack_tension [N]": found["slack_tension_mean"],
                "torque_limit_2 [N*m]": self.limit.reshape(-1) * [self.machine.limit(*each) for each in point[:, [0, 2]]],
                "loss [W]": found["loss_total_mean"], **{f"loss_{kind} [W]": each for kind, each in self.losses.items()},
                "steady [1]": self.good.astype(float)}
        for name in ("loss [W]", "efficiency [1]"):
            made[name] = np.where(self.good, made[name], np.nan)
        return made


class Law:
    """The shift law d ln i/dt = -C omega_1 (S_1 - S_1*)/S_2, by transients of 40 ms with 10 and 20 % more and less clamping."""

    TIMES = range(4, 41, 2)  # [ms]

    def __init__(self, bench, steady_map):
        axes, shape = steady_map.axes, steady_map.shape
        some = [sorted({0, n // 2, n - 1}) if n < 5 else range(0, n, 2) for n in shape[1:3]]
        loads = [k for k in range(shape[3]) if k % 2 == 0]
        kept = [(l, c, r, k) for l in sorted({shape[0] // 3, shape[0] - 1}) for c in some[0] for r in some[1] for k in loads
                if axes["load"][k] <= 0.9 * steady_map.limit[l, c, r, k]]
        rows = []
        for l, c, r, k in kept:
            thrust = steady_map.values["thrust"][l, c, r, k]
            ratio, clamping, load = axes["ratio"][r], axes["clamping"][c], axes["load"][k]
            rows += [(ratio, clamping, clamping * thrust * part, load * steady_map.machine.limit(ratio, clamping), axes["speed"][l])
                     for part in (0.8, 0.9, 1.1, 1.2)]
        columns = dict(zip(("start.ratio", "clamping.driven", "clamping.driving", "load.torque", "drive.speed"), np.array(rows).T))
        free = {"control.enabled": False, "control.gains": "given", "control.when_steady": "control", "run.until": "40 ms"}
        found = bench.sweep("shift", free, columns, [f"ratio at {each} ms" for each in self.TIMES])
        time = 1e-3 * np.array(self.TIMES)
        logs = np.log(np.stack([found[f"ratio_at_{each}_ms"] for each in self.TIMES], axis=1))
        with np.errstate(invalid="ignore"):
            rate = ((time - time.mean()) * (logs - logs.mean(axis=1)[:, None])).sum(axis=1) / ((time - time.mean()) ** 2).sum()
        node = np.repeat(np.array(kept), 4, axis=0)
        centre = np.array([np.interp(middle, np.log(axes["ratio"]), steady_map.values["thrust"][l, c, :, k])
                           for middle, (l, c, r, k) in zip(logs.mean(axis=1), node)])
        strength = columns["drive.speed"] * (centre - columns["clamping.driving"] / columns["clamping.driven"])
        good = np.isfinite(rate) & (found["status"] == "ok") & (np.abs(rate) < 5)
        if not good.any():
            raise RuntimeError(f"no transient of the shift law has a result: {found['error'][0]}")
        x = [np.log(columns["start.ratio"]), axes["load"][node[:, 3]], columns["clamping.driven"], columns["drive.speed"]]
        group = np.repeat(np.arange(len(kept)), 4)
        slope = np.bincount(group, np.where(good, rate * strength, 0)) / np.bincount(group, np.where(good, strength ** 2, 1e-99))
        has = (slope > 0) & (np.bincount(group, good) >= 2)
        terms = self._terms(*(each[::4][has] for each in x)) * (slope / (x[2] / x[3])[::4])[has][:, None]
        self.coefficients = np.linalg.lstsq(terms, np.ones(len(terms)), rcond=None)[0]
        missed = self._strength(*x) * strength - rate
        self.residual = float(np.sqrt(np.mean(missed[good] ** 2) / np.mean(rate[good] ** 2)))
        self.count, self.range = int(good.sum()), (slope[has].min(), slope[has].max())

    @staticmethod
    def _terms(ratio, load, clamping, speed):
        """Terms of (S_1 - S_1*) over d ln i/dt [N s], whose parts are the creep of elastic sheaves, 1/omega_1, and the dampers of the
        cylinders; arguments: ln i, share of the torque limit, S_2, omega_1."""
        force = np.log(clamping / 2e4)
        creep = [np.ones_like(ratio), ratio, ratio ** 2, load, load ** 2, ratio * load, force, load * force]
        return np.stack([each / speed for each in creep] + [np.ones_like(ratio), ratio, ratio ** 2], axis=-1)

    def _strength(self, ratio, load, clamping, speed):
        """C: at least a tenth of the middle one, at most ten times."""
        given = self._terms(ratio, load, clamping, speed) @ self.coefficients
        middle = np.median(given)
        return clamping / (speed * np.clip(given, 0.1 * middle, 10 * middle))

    def on(self, axes):
        """C at the points of a map."""
        grid = np.meshgrid(axes["speed"], axes["clamping"], np.log(axes["ratio"]), axes["load"], indexing="ij")
        return self._strength(grid[2], grid[3], grid[1], grid[0])
