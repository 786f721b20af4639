"""What `cvtflow reduce` writes of a map and its shift law: tables, picture, FMUs, and the errors that it measures."""

import io
import math
import sys
import time

import numpy as np

from ._fmu import identifier
from ._reduce import SAFETY, Bench, Law, Machine, Map, is_good, axes_of, steady
from ._small import Small

# Scenes beside which the reduced model runs: name, settings, and a piece of the time that they take.
COURSES = {"shift": {"run.until": "40 ms"}, "manoeuvre": {"run.until": "60 ms"}, "ece15": {"cycle.begin": "11 s", "run.until": "17 s"}}
_MACHINE = ("chain", "half", "plate", "joint", "tip", "oil", "pulley", "imperfection", "guide")
_CHANNELS = ["ratio", "slip", "shaft_1/clamping", "shaft_2/clamping", "shaft_1/speed", "shaft_2/chain_torque", "dissipated/total",
             "work/drive"]


def efficiency(machine, model, ratio, torque, clamping, speed):
    """Efficiency of the map at a load of shaft 2, and what is outside."""
    made, outside = model.values_at(ratio, torque / machine.limit(ratio, clamping), clamping, speed)
    power = torque * speed / ratio
    return power / (power + made["loss"] * clamping * speed), outside


class Errors:
    """Differences of the reduced model from the simulation, as rows of a table: name, unit, median, nine of ten, largest."""

    def __init__(self):
        self.rows, self.notes, self.missing = [], [], []

    def add(self, against, name, unit, differences):
        size = differences[np.isfinite(differences)]
        size = np.abs(size) if len(size) > 1 else size
        if len(size):
            self.rows.append((against, name, unit, len(size), np.median(size), np.quantile(size, 0.9), size.max()))

    def text(self):
        lines = [f"{'against':22} {'quantity':14} {'of':>4} {'median':>9} {'90 %':>9} {'largest':>9}"]
        lines += [f"{against:22} {name:14} {count:4} {low:9.3g} {high:9.3g} {most:9.3g} {unit}"
                  for against, name, unit, count, low, high, most in self.rows]
        return "\n".join(lines + self.notes + self.missing)


def points(axes, limit, count):
    """Points (ratio, share, clamping, speed) in the range of a map, none of them of it; seeded."""
    draw, found = np.random.default_rng(1), []
    while len(found) < count:
        place = [draw.uniform(0.02, 0.98) for _ in range(4)]
        logs = [np.interp(part, (0, 1), np.log(axes[name][[0, -1]])) for part, name in zip(place, ("ratio", "clamping"))]
        ratio, clamping = (math.exp(each) for each in logs)
        share, speed = (float(np.interp(part, (0, 1), axes[name][[0, -1]])) for part, name in zip(place[2:], ("load", "speed")))
        if share <= limit(ratio, share, clamping, speed):
            found.append((ratio, share, clamping, speed))
    return found


def measure_points(bench, machine, model, chosen, detail, errors):
    """Errors at points, against steady cases of a level of detail that start by themselves."""
    if not chosen:
        return
    there = [model.values_at(*point)[0] for point in chosen]
    thrust = np.array([each["thrust"] for each in there])
    found = steady(bench, machine, f"points_{detail}", chosen, thrust, detail=detail)
    good = is_good(found)
    again = found["status"] == "unreliable"
    if again.any() and detail == bench.level:
        more = steady(bench, machine, f"points_{detail}_again", np.array(chosen)[again], thrust[again], bench.shorter_step())
        for name, each in found.items():
            if name in more and each.dtype.kind != "U":
                each[again] = more[name]
        good[again] = is_good(more)
    driven, speed = np.array(chosen)[:, 2:].T
    torque, drive = np.array([share * machine.limit(ratio, clamping) for ratio, share, clamping, _ in chosen]), []
    for (ratio, _, clamping, omega), load in zip(chosen, torque):
        model.begin(drive_mode=0.0, shift_mode=1.0, speed_1=omega, torque_2=load, clamping_2=clamping, ratio_start=ratio,
                    ratio_target=ratio)
        drive.append(model.get("shaft_1.torque"))
    power, small = torque * speed / found["ratio_mean"], {name: np.array([each[name] for each in there]) for name in there[0]}
    lost, model_lost = found["loss_total_mean"], small["loss"] * driven * speed
    against = f"{detail}, {good.sum()} points"
    for name, unit, values in (
            ("thrust ratio", "%", 100 * (small["thrust"] * driven / found["shaft_1_clamping_mean"] - 1)),
            ("slip", "points of %", 100 * (small["slip"] - found["slip_mean"])),
            ("efficiency", "points of %", 100 * (power / (power + model_lost) - power / (power + lost))),
            ("losses", "%", 100 * (model_lost / lost - 1)),
            ("shaft_1.torque", "%", 100 * (drive * speed / (power + lost) - 1)),
            ("tight strand", "%", 100 * (small["tight"] * driven / found["tight_tension_mean"] - 1)),
            ("slack strand", "%", 100 * (small["slack"] * driven / found["slack_tension_mean"] - 1))):
        errors.add(against, name, unit, np.where(good, values, np.nan))
    if not good.all():
        errors.notes.append(f"{against}: {np.sum(~good)} of {len(good)} slide, or are not steady or reliable, and are not in this table")


def measure_course(bench, model, name, errors):
    """Errors over a ready scene with this machine: the model takes its clamping forces, its speed and the chain's torque, every ms."""
    scene = bench.scene
    settings = {**{key: value for key, value in scene.items() if key.split(".")[0] in _MACHINE or key == "detail.pulleys"},
                **COURSES[name], "start.state": "", "run.output_interval": "1 ms", "run.state_interval": "1 s",
                "record.channels": _CHANNELS}
    try:
        record = bench.record(name, settings)
        rows = {channel: record[channel] for channel in ("time", *_CHANNELS)}
    except (RuntimeError, OSError, KeyError) as error:
        errors.missing.append(f"{name}: not measured: {error}")
        return
    inputs = {"speed_1": rows["shaft_1/speed"], "clamping_1": rows["shaft_1/clamping"], "clamping_2": rows["shaft_2/clamping"],
              "torque_2": -rows["shaft_2/chain_torque"]}
    if np.mean(rows["shaft_2/chain_torque"]) > 0:
        inputs["torque_2"] = -inputs["torque_2"]
    start = {key: each[0] for key, each in inputs.items()}
    model.begin(inertia_2=0.0, drive_mode=0.0, shift_mode=0.0, ratio_start=rows["ratio"][:5].mean(), **start)
    made = {key: [model.get(key)] for key in ("ratio", "slip", "loss", "outside")}
    for k, length in enumerate(np.diff(rows["time"])):
        model.set(**{key: each[k + 1] if key == "torque_2" else 0.5 * (each[k] + each[k + 1]) for key, each in inputs.items()})
        model.advance(length)
        for key in made:
            made[key].append(model.get(key))
    made = {key: np.array(each) for key, each in made.items()}
    inside = made["outside"] == 0
    width = min(20, max(1, len(inside) // 3))
    smooth = lambda each: np.convolve(each, np.ones(width) / width, "valid")  # noqa: E731
    errors.add(name, "ratio", "%", 100 * (made["ratio"] / rows["ratio"] - 1))
    errors.add(name, "slip", "points of %", 100 * (smooth(made["slip"]) - smooth(rows["slip"])))
    energy, work = np.ptp(rows["dissipated/total"]), rows["work/drive"][-1] - rows["work/drive"][0]
    lost = float(np.sum(made["loss"][1:] * np.diff(rows["time"])))
    errors.add(name, "losses, all", "%", np.array([100 * (lost / energy - 1)]))
    errors.add(name, "efficiency, all", "points of %", np.array([100 * (lost - energy) / max(work, 1e-9)]))
    if not inside.all():
        errors.notes.append(f"{name}: {100 * np.mean(~inside):.0f} % of the time are outside the map (output `outside`)")


def csv_text(columns):
    """CSV of columns by heading."""
    return "\n".join([",".join(columns), *(",".join(f"{value:.7g}" for value in row) for row in zip(*columns.values())), ""])


def by_torque(machine, model, axes, safety):
    """Tables over ratio and torque at each speed, clamped by a safety factor: torques, and {name: [speed, ratio, torque]}."""
    least = axes["clamping"][0]
    torques = np.linspace(0.0, machine.limit(1.0, axes["clamping"][-1]) / safety, 12)[1:]
    tables = {name: np.full((len(axes["speed"]), len(axes["ratio"]), len(torques)), np.nan)
              for name in ("efficiency", "slip", "thrust_ratio", "loss", "clamping_2")}
    for (l, r, t), _ in np.ndenumerate(tables["slip"]):
        speed, ratio, torque = axes["speed"][l], axes["ratio"][r], torques[t]
        clamping = max(least, least * safety * torque / machine.limit(ratio, least))
        values = model.values_at(ratio, torque / machine.limit(ratio, clamping), clamping, speed)[0]
        tables["efficiency"][l, r, t] = efficiency(machine, model, ratio, torque, clamping, speed)[0]
        for name, value in (("slip", values["slip"]), ("thrust_ratio", values["thrust"]), ("loss", values["loss"] * clamping * speed),
                            ("clamping_2", clamping)):
            tables[name][l, r, t] = value
    return torques, tables


def modelica_text(axes, torques, tables, safety):
    """Text of tables for CombiTable2Ds: a table for each quantity and speed, ratio down, torque of shaft 2 across."""
    lines = ["#1", f"# rows: ratio [1]; columns: torque of shaft 2 [N.m], clamped by safety factor {safety:g}; loss [W], clamping_2 [N]"]
    for name, table in tables.items():
        for number, speed in enumerate(axes["speed"], 1):
            lines += [f"# speed of shaft 1: {speed:.6g} rad/s", f"double {name}_{number}({len(axes['ratio']) + 1},{len(torques) + 1})"]
            lines += [" ".join(f"{value:.7g}" for value in row) for row in
                      [(0.0, *torques), *((ratio, *row) for ratio, row in zip(axes["ratio"], table[number - 1]))]]
    return "\n".join(lines) + "\n"


def matlab_text(axes, torques, tables, safety):
    """Script of MATLAB with the names of ADVISOR's CVT files: efficiency by speed, torque and ratio."""
    row = lambda values: " ".join(f"{value:.7g}" for value in values)  # noqa: E731
    lines = [f"% Efficiency of the variator over speed of shaft 1 [rad/s], torque of shaft 2 [N*m] and ratio; safety factor {safety:g}",
             f"cvt_ratio = [{row(axes['ratio'])}];", f"cvt_map_spd = [{row(axes['speed'])}];", f"cvt_map_trq = [{row(torques)}];"]
    for number in range(len(axes["ratio"])):
        lines.append(f"cvt_eff_map(:,:,{number + 1}) = [{'; '.join(row(each) for each in tables['efficiency'][:, number])}];")
    return "\n".join(lines) + "\n"


def picture(steady_map, name):
    """The map at the speed and clamping force in the middle, as SVG."""
    axes, point = steady_map.axes, steady_map.points
    speed, clamping = (axes[each][len(axes[each]) // 2] for each in ("speed", "clamping"))
    some = (point[:, 2] == clamping) & (point[:, 3] == speed) & (point[:, 1] > 0)
    bad = np.flatnonzero(~steady_map.good[some])
    columns = steady_map.columns()
    values = {label: np.where(steady_map.good, columns[heading], np.nan)[some] * (100 if "%" in label else 1) for label, heading in (
        ("efficiency [%]", "efficiency [1]"), ("slip [%]", "slip [1]"), ("thrust ratio", "thrust_ratio [1]"))}
    heading = f"{name}: {clamping / 1e3:.3g} kN on shaft 2, {speed * 30 / math.pi:.0f} rpm on shaft 1"
    return over_torque(heading, steady_map.torque[some], point[some, 0], values, [("not steady", bad, "//")] if len(bad) else [])


def over_torque(heading, torque, ratio, values, marked=()):
    """Values by label as colours over torque and ratio, as SVG."""
    from . import _figures

    panels = []
    for label, each in values.items():
        panels.append(_figures.Panel(f"{label.partition(' [')[0]} over torque and ratio", "torque of shaft 2 [N·m]", "ratio",
                                     scales=("linear", "log")))
        panels[-1].fields.append(_figures.Field(label, torque, ratio, each, list(marked)))
    return _figures.picture(_figures.draw(panels, heading), "svg")


def _speed_factor(model, small):
    model.begin(shift_mode=0.0, **dict(zip(("speed_1", "torque_2", "clamping_1", "clamping_2"), (small.start[0], *small.start[2:5]))))
    begin = time.process_time()
    model.advance(1000.0)
    return 1000.0 / (time.process_time() - begin)


def reduce(request):
    """Reduces the machine that a command line requests. Returns its exit status and lines to print."""
    begin, files = time.monotonic(), [f"{request['name']}_fmi{fmi}.fmu" for fmi in (2, 3)]
    bench = Bench(request, ["map.csv", "map.mat", "combi_table.txt", "advisor.m", "map.svg", "errors.txt", *files])
    machine = Machine(bench.scene)
    axes = axes_of(machine, request["axes"])
    courses = COURSES if axes["courses"] else ()
    compared = [f"{count} points at {level}" for level, count in bench.compared(axes) if count]
    bench.report(", ".join(["measured are the map", "transients of the shift law", *compared, *courses]))
    steady_map = Map(bench, machine, axes)
    law = Law(bench, steady_map)
    small = Small(machine, axes, {**steady_map.values, "shift": law.on(axes), "limit": steady_map.limit}, bench.scene)
    model = small.load()
    errors = Errors()
    some = points(axes, lambda *point: model.values_at(*point)[0]["limit"], max(axes["points"], axes["fine"]))
    for level, count in bench.compared(axes):
        measure_points(bench, machine, model, some[:count], level, errors)
    for name in courses:
        measure_course(bench, model, name, errors)
    safety = bench.scene["clamping.safety"] or SAFETY
    torques, tables = by_torque(machine, model, axes, safety)
    columns = steady_map.columns()
    bench.write("map.csv", csv_text(columns))
    bench.write("combi_table.txt", modelica_text(axes, torques, tables, safety))
    bench.write("advisor.m", matlab_text(axes, torques, tables, safety))
    bench.write("map.svg", picture(steady_map, request["name"]))
    written = ["map.csv", "combi_table.txt", "advisor.m", "map.svg", "errors.txt"]
    try:
        from scipy.io import savemat

        file = io.BytesIO()
        savemat(file, {**{name.partition(" [")[0]: values for name, values in columns.items()},
                       **{f"axis_{name}": axes[name] for name in ("speed", "clamping", "ratio", "load")}})
        bench.write("map.mat", file.getvalue())
        written.insert(1, "map.mat")
    except ImportError:
        errors.notes.append("map.mat: not written, SciPy is not installed (Debian: python3-scipy)")
    lines = [f"{request['name']}: {len(steady_map.points)} points, {steady_map.holes} of them without a steady case (edge of the map)",
             f"shift law: C {law.range[0]:.3g} to {law.range[1]:.3g}, by {law.count} transients; it misses {100 * law.residual:.1f} % of "
             "their rates (rms)",
             errors.text(), f"1 ms steps: {_speed_factor(model, small):,.0f} times as fast as the clock"]
    for fmi, file in zip((2, 3), files):
        content, systems = small.fmu(identifier(request["name"]), fmi, "\n".join(lines[:3]))
        bench.write(file, content)
        lines.append(f"{file}: FMI {fmi}.0, {', '.join(systems)}, {len(content) / 1e3:.0f} kB")
    bench.write("errors.txt", "\n".join(lines) + "\n")
    lines.append(f"written to {request['place']}: {', '.join(written)} and the FMUs, in {time.monotonic() - begin:.0f} s")
    for missing in errors.missing:
        print(missing, file=sys.stderr)
    return 5 if errors.missing else 0, lines
