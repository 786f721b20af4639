"""Prints, writes and draws what a command of cvtflow-lab has computed: `python3 -I -B -X utf8 _laboratory.py COMMAND`, the results as one
JSON object on stdin.

A function per command, named like it, receives the results and the folder for files. Numbers are in SI units unless their names say
otherwise; null is a number that is not known, "inf" an infinite one. The program starts this file from the folder of the Python package,
whose pictures and rules for files it uses. Exit status 0; 1: a message says why, or the results contain complaints.
"""

import importlib.util
import json
import math
import os
import signal
import statistics
import sys

_here = os.path.dirname(os.path.abspath(__file__))
_spec = importlib.util.spec_from_file_location("cvtflow", os.path.join(_here, "__init__.py"), submodule_search_locations=[_here])
sys.modules["cvtflow"] = importlib.util.module_from_spec(_spec)  # the package of this folder, without the library

from cvtflow import _output  # noqa: E402
from cvtflow.commands import _columns, _front  # noqa: E402
from cvtflow.commands._columns import time_text  # noqa: E402
from cvtflow.commands._front import visible  # noqa: E402


# Texts

def number(value):
    """A number of the results; null: not a number."""
    return math.nan if value is None else float(value)


def count_text(count):
    """"1 234 567"."""
    return f"{count:,}".replace(",", " ")


def plural(count, noun):
    """"12 steps", "1 step"."""
    return f"{count_text(count)} {noun}{'' if count == 1 else 's'}"


def field(label, value):
    """Prints "  label               value", as in the summary of a run."""
    print(f"  {label:<19} {visible(value)}")


def table(headings, rows, indent=2):
    """Prints rows of cells below headings, each column as wide as its longest cell. Columns are right-aligned; "<heading": left-aligned."""
    lines = [[visible(str(cell)).replace("\n", " ") for cell in row] for row in rows]
    left = [heading.startswith("<") for heading in headings]
    print(_columns.table([heading.removeprefix("<") for heading in headings], lines, left, indent), end="")


def cell_text(value, spec=".9g", quoted=False):
    """A cell of CSV: "" for what is unknown or not finite; texts in quotes where they must be, none that spreadsheets take for a formula."""
    if isinstance(value, str) and value != "inf":
        return _columns.csv_cell(visible(value), True, quoted)
    if isinstance(value, int):
        return str(int(value))
    return format(number(value), spec) if math.isfinite(number(value)) else ""


def csv(rows, spec=".9g", quoted=(), **specs):
    """Rows as CSV, a column for each key. spec, specs: of real numbers, of all columns and of some; quoted: columns of texts in quotes."""
    lines = [map(cell_text, rows[0]), *([cell_text(value, specs.get(key, spec), key in quoted) for key, value in row.items()] for row in rows)]
    return "".join(",".join(line) + "\n" for line in lines)


# Files and pictures

class Files:
    """Files of the requested kinds in the folder of -o."""

    def __init__(self, output):
        self._kinds, self._written = [kind for kind in ("csv", "json", "svg") if output[kind]], []
        self._folder, self._named = output["folder"] or "results", bool(output["folder"])
        self._wanted = self._kinds or (["csv", "json", "svg"] if output["folder"] else [])

    def _write(self, name, data):
        path = os.path.join(self._folder, name)
        os.makedirs(self._folder, exist_ok=True)
        try:
            _output.Output(path, named=self._named).write(data)
        except _output.OutputError as error:
            raise _output.OutputError(str(error).replace("--force replaces it", "remove it, or name another folder")) from None
        self._written.append(path)

    def write(self, name, text):
        """Writes a table or results."""
        if name.rpartition(".")[2] in self._wanted:
            self._write(name, text.encode(errors="surrogateescape"))

    def json(self, name, results):
        """Writes results as indented JSON, numbers that are not finite as null."""
        self.write(name, json.dumps(results, indent=2, ensure_ascii=False).replace(': "inf"', ": null") + "\n")

    def draw(self, name, panels, heading=""):
        """Draws panels below one another. heading: their conditions."""
        if "svg" not in self._wanted:
            return
        if "cvtflow._figures" not in sys.modules:
            _front.require("a picture", "matplotlib", "numpy")
            _front.matplotlib()
        import numpy as np
        from cvtflow import _figures

        _figures.in_notebooks = False
        made = []
        for title, x, y, curves, scales, more in panels:
            made.append(_figures.Panel(title, x, y, scales=scales, height=5.4, **more))
            for label, points, mark, line, colour, width in curves:
                look = {"linestyle": line, "linewidth": width, "marker": MARKS[mark]}
                look |= ({"markerfacecolor": "none"} if mark == "ring" else {}) | ({"color": colour} if colour else {})
                across, up = (np.array([number(point[axis]) for point in points], dtype=float) for axis in (0, 1))
                made[-1].lines.append(_figures.Line(label, across, up, look))
            made[-1].regions = [(*look, np.array(across), np.array(up), np.array([[each == "1" for each in row] for row in inside]))
                                for *look, across, up, inside in made[-1].regions]
        self._write(name, _figures.picture(_figures.draw(made, heading), "svg"))

    def report(self, before=""):
        """Prints which files are written, and which requested kinds the command does not have."""
        print(before if self._written or self._kinds else "", end="")
        if self._written:
            field("written", ", ".join(self._written))
        for kind in self._kinds:
            if not any(name.endswith("." + kind) for name in self._written):
                field("not written", f"--{kind}: this command has no such file")


MARKS = {"none": "", "dot": "o", "small_dot": ".", "ring": "o", "square": "s", "diamond": "D", "triangle": "^", "cross": "x"}


def series(name, points, mark="dot", line="none", colour="", width=1.6):
    """A curve or points of a picture. colour: empty: the next one."""
    return name, points, mark, line, colour, width


def panel(title, x, y, curves, scales=("linear", "linear"), **more):
    """A frame of a picture. scales: "linear", "log", ("symlog", linear up to); more: x_ends, y_ends, regions as those of cvtflow's Panel."""
    return title, x, y, curves, scales, more


def line_of(curve):
    """Colours repeat after eight."""
    return "solid" if curve < 8 else "dashed"


# Methods

def _limit_text(limit):
    """"50.95 ns predicted (…), 50.97 ns measured (+0.04 %)"."""
    real, imaginary = limit["limiting"]
    limiting = f"{real:.3g} {'-' if imaginary < 0.0 else '+'} {abs(imaginary):.4g}i" if imaginary else f"{real:.4g}"
    text = f"{time_text(limit['predicted'])} predicted (by {limiting} 1/s), "
    stable, unstable, between = limit["measured_stable"], limit["measured_unstable"], limit["measured"]
    if unstable == 0.0 or stable == 0.0:
        return text + (f"more than {time_text(stable)} measured" if unstable == 0.0 else f"less than {time_text(unstable)} measured")
    return text + f"{time_text(between)} measured ({100.0 * (between / limit['predicted'] - 1.0):+.2f} %)"


def _growth_text(growth, bound):
    if not growth:
        return "not checked: extreme eigenvalues only"
    if growth["growing"]:
        return (f"GROWTH: {plural(growth['growing'], 'eigenvalue')} above {bound:g} 1/s, largest {growth['largest']:.4g} 1/s: the state is "
                "not settled or unstable")
    return f"none above {bound:g} 1/s (largest {growth['largest']:.3g} 1/s, the resolution of the differences)"


def _spectrum_text(results, main):
    file, kinds, values = results["file"], results["kinds"], results["file"]["eigenvalues"]
    extent, unknowns, stable, step = file["extent"], count_text(file["unknowns"]), file["stable_step"], file["step"]
    print(f"{file['scene']}: eigenvalues of the Jacobian at t = {time_text(file['time'])}, {file['friction']} friction, "
          f"{plural(file['touching'], 'tip')} touching")
    field("eigenvalues", f"all {unknowns}" if file["complete"] else f"{count_text(len(values))} extreme ones of {unknowns}, from a Krylov "
          f"space of {results['dimension']} (relative residuals up to {results['residual']:.0e})")
    field("strands", f"{file['tight_tension']:.0f} N tight, {file['slack_tension']:.0f} N slack")
    field("fastest decay", f"max -Re = {extent['max_decay']:.4e} 1/s")
    field("fastest oscillation", f"max |Im| = {extent['max_oscillation']:.4e} 1/s")
    field("below -1e6, -1e7", f"{extent['below_1e6']}, {extent['below_1e7']}")
    field("growth", _growth_text(file.get("growth"), results["growth_tolerance"]))
    field("step x |largest|", f"{step * max(math.hypot(*value) for value in values):.3f} with {time_text(step)} of {file['method']}")
    field("largest stable step", _limit_text(stable) if "predicted" in stable else results["stated"])
    if results["polynomial"]:
        field("polynomial for it", f"cvtflow-lab method {results['polynomial']}")
    if not main:
        return
    print("\nEigenvalues below -1e6 1/s by the contact that causes them (share: -d ln λ / d ln v0)")
    rows = []
    for kind, name in enumerate(kinds):
        of_kind = [(value[0], share[kind]) for value, share, of in zip(values, file["shares"], main) if of == kind]
        rows.append([name, len(of_kind), sum(decay < -1e7 for decay, _ in of_kind), *(
            [f"{of_kind[0][0]:.3g}", f"{of_kind[-1][0]:.3g}", f"{sum(share for _, share in of_kind) / len(of_kind):.2f}"] if of_kind else
            ["", "", ""])])
    table(["<caused by", "eigenvalues", "below -1e7", "fastest", "slowest", "mean share"], rows)
    print("\nSaturation speeds v0 ten times as high")
    slowed, fastest = file["slowed_tenfold"], file["slowed_tenfold"][0]["max_decay"]
    table(["<v0 x 10", "max -Re", "factor", "max |Im|", "below -1e6", "below -1e7"],
          [[row["contacts"] or "none", f"{row['max_decay']:.3e}", f"{fastest / row['max_decay']:.2f}", f"{row['max_oscillation']:.3e}",
            row["below_1e6"], row["below_1e7"]] for row in slowed])


def spectrum(results, files):
    """Eigenvalues of a scene's Jacobian: in the complex plane where all are known, else, being nearly all real, their number over decay."""
    def faster(name, curves, heading):
        lines = [series(label, list(zip(decays, range(len(decays)))), "none", "solid", colour) for label, decays, colour in curves]
        files.draw(f"spectrum-{name}.svg", [panel(f"Eigenvalues of {file['scene']} that decay faster", "-Re λ [1/s]",
                                                  "eigenvalues with a faster decay", lines, ("log", "linear"), y_ends=(0.0, None))], heading)

    file, kinds, border = results["file"], results["kinds"], results["border"]
    values, shares = file["eigenvalues"], file.get("shares", [])
    main = [share.index(max(share)) for share in shares]  # the contact that causes an eigenvalue
    rows = [{"real": value[0], "imaginary": value[1]} | {f"share_{kind}": each for kind, each in zip(kinds, share)}
            for value, share in zip(values, shares + [[None] * len(kinds)] * len(values))]
    files.write("spectrum.csv", csv(rows, ".6g", real=".17g", imaginary=".17g"))
    files.json("spectrum.json", file)
    conditions = (f"t = {time_text(file['time'])}, {file['friction']} friction, {plural(file['touching'], 'tip')} touching; "
                  f"{'all' if file['complete'] else 'the extreme'} {count_text(len(values))} eigenvalues")
    causes = list(enumerate(kinds)) if main else []
    if file["complete"]:
        lines = [series(f"caused by {name}", [value for value, of in zip(values, main) if of == kind], "small_dot") for kind, name in causes]
        lines.append(series("others" if main else "eigenvalues", values[len(main):], "small_dot", colour="#444444" if main else ""))
        for name, scale in (("linear", "linear"), ("symlog", ("symlog", 1e3))):
            files.draw(f"spectrum-{name}.svg",
                       [panel(f"Eigenvalues of {file['scene']}", "Re λ [1/s]", "Im λ [1/s]", lines, (scale, scale))], conditions)
    else:
        far = [(-value[0], of) for value, of in zip(values, main + [None] * len(values)) if value[0] < border]
        curves = [(f"caused by {name}", [decay for decay, of in far if of == kind], "") for kind, name in causes]
        faster("edge", [("all", [decay for decay, _ in far], "#444444"), *curves],
               f"{conditions}; fastest oscillation {file['extent']['max_oscillation']:.3g} 1/s")
    if main:
        faster("slowed", [(f"v0 x 10: {row['contacts']}" if row["contacts"] else "v0 of the scene",
                           [-value[0] for value in row["eigenvalues"] if value[0] < border], "") for row in file["slowed_tenfold"]],
               "by saturation speeds ten times as high")
    _spectrum_text(results, main)
    files.report()


def stability(results, files):
    """Reach of methods along the axes and rays, their largest step on a scene, and where |R(z)| ≤ 1, with the eigenvalues times a step."""
    def short(value):
        return f"{value:.4g}" if value < 1e4 else f"{value:.2e}"

    rows = []
    for method in results["methods"]:
        row, drawn = method["row"], method.get("map")
        rows.append([row["method"], row["stages"], *(short(row[name]) for name in ("real", "imaginary", "ray_1", "ray_5"))])
        if "limit" in method:
            rows[-1] += [short(row["stage_growth"]), short(row["gain"]), f"{row['stages'] / row['predicted']:.3g}", _limit_text(method["limit"])]
        if drawn:
            lines = [series(name, points, mark, colour=colour) for name, points, mark, colour in (
                ("hλ", drawn["values"], "small_dot", "#0072b2"), ("hλ, growing", drawn["growing"], "cross", "#d55e00")) if points]
            ends = {f"{axis}_ends": (drawn[axis][0], drawn[axis][-1]) for axis in "xy"}
            files.draw(f"stability-{row['method']}.svg", [panel(
                f"Stability of {row['method']}", "Re hλ", "Im hλ", lines, (("symlog", 1.0) if drawn["symlog"] else "linear", "linear"),
                regions=[("|R(hλ)| ≤ 1", "#dbe7f3", drawn["x"], drawn["y"], drawn["inside"])], **ends)],
                f"eigenvalues of {results['scene']} times h = {time_text(drawn['step'])}" if results["scene"] else "")
    files.write("stability.csv", csv([method["row"] for method in results["methods"]]))
    table(["<method", "stages", "real", "imag", "ray 1 %", "ray 5 %"] +
          (["growth", "gain", "eval./s", "<largest stable step"] if results["scene"] else []), rows)
    files.report()


def belt(results, files):
    """Thrust ratio, tensions, slip and shift by the theory of a belt, or why it has none; forces and sliding along both arcs."""
    rows = []
    for row in results["points"]:
        solved = row["status"] == "ok"
        known = [f"{row['thrust_ratio']:.4f}", f"{row['tight_N']:.1f}", f"{row['slack_N']:.1f}", f"{100.0 * row['slip']:.4f}",
                 f"{row['shift_per_s']:+.4f}"] if solved else [""] * 5
        rows.append([f"{row['ratio']:g}", f"{row['load']:.6g}", f"{row['torque_Nm']:.2f}", f"{1e3 * row['growth_m_per_s']:.3f}", *known,
                     "" if solved else row["status"]])
    table(["ratio", "load", "torque [N m]", "growth [mm/s]", "S1/S2", "tight [N]", "slack [N]", "slip [%]", "shift [1/s]", "<"], rows)
    files.write("belt.csv", csv(results["points"]))
    if results["arcs"]:
        files.write("arcs.csv", csv(results["arcs"]))
    files.report()


def local_error(results, files):
    """The error of a single step against its length: a table per method and friction law, pictures per law."""
    def slope(row, above, part):
        known = above and number(row[part]) > 0.0 and number(above[part]) > 0.0
        return f"{math.log(above[part] / row[part]) / math.log(above['step'] / row['step']):.2f}" if known else ""

    def text(error):
        return "cut" if error is None else f"{number(error):.3e}" if error != 0.0 else "0"

    scene, rows, parts = results["scene"], [], ("positions", "velocities", "axial_force", "tension")
    for place, curve in enumerate(results["curves"]):
        if place == 0 or curve["method"] != results["curves"][place - 1]["method"]:
            held, touching = ("phases held, ", "") if curve["held"] else ("", " at its start")
            print("\n" * (place > 0) + f"{scene}: error of one step of {curve['method']} (order {curve['order']}: slope {curve['order'] + 1} "
                  f"where the solution is smooth), {held}{plural(results['touching'], 'tip')} touching{touching}")
        print(f"\n{curve['friction']} friction")
        table(["step", *(each for part in parts for each in (part.replace("_", " "), "slope"))],
              [[time_text(row["step"]), *(each for part in parts for each in (text(row[part]), slope(row, above, part)))]
               for row, above in zip(curve["errors"], [None, *curve["errors"]])])
        rows += [{"method": curve["method"], "friction": curve["friction"]} | row for row in curve["errors"]]
    files.write("local-error.csv", csv(rows, step=".17g"))
    marks = ("dot", "ring", "square", "diamond", "triangle", "cross")
    for law in dict.fromkeys(curve["friction"] for curve in results["curves"]):
        curves = [curve for curve in results["curves"] if curve["friction"] == law]
        for part, name in (("axial_force", "axial force of all tips"), ("velocities", "velocities of all links")):
            lines = [series(curve["method"], [(row["step"], row[part] if number(row[part]) < 1e6 else None) for row in curve["errors"]],
                            marks[place % len(marks)], "solid") for place, curve in enumerate(curves)]
            files.draw(f"local-error-{part.replace('_', '-')}-{law}.svg", [
                panel(f"Error of one step: {name}", "step [s]", "relative error", lines, ("log", "log"))],
                f"{scene}, {law} friction, relative to tight rk4")
    files.report("\n")


# Schedules

def _origin(machine, *libraries):
    """Last columns of tables: the origin of their numbers."""
    return {key: machine[key] for key in ("commit", "compiler", "flags", *libraries, "cpu", "cores", "date")}


def _machine(machine, more=""):
    """Prints machine, program and libraries."""
    field("machine", f"{machine['cpu']}, {plural(machine['cores'], 'core')}{more}")
    field("program", f"cvtflow {machine['version']} ({machine['commit']}), {machine['compiler']}")


def granularity(results, files):
    """METG(50 %): the shortest tasks with half of the efficiency, of every executor by number of tasks; "<": all tasks were long enough."""
    def cell(row):
        return f"{'<' if row['is_bound'] else ''}{1e6 * row['length']:.3g}" if row["length"] != "inf" else "-"

    machine, points, requested = results["machine"], results["points"], results["requested"]
    executors, counts = (list(dict.fromkeys(point[key] for point in points)) for key in ("executor", "tasks"))
    shortest = {(row["executor"], row["tasks"]): row for row in results["shortest"]}
    print(f"METG(50 %) [us]: shortest task length with an efficiency of 50 %; medians of {plural(results['rounds'], 'round')}")
    _machine(machine)
    field("libraries", machine["runtimes"])
    got, crowded = f"calibration got {results['calibrated']:.2f} of ", results["crowded"]
    field("crowded" if crowded else "quiet", f"{got}{plural(requested, 'processor')}"
          f"{': other processes are busy and affect these figures' if crowded else ''}")
    print()
    table(["<executor", *(f"M = {count}" for count in counts)],
          [[executor, *(cell(shortest[executor, count]) for count in counts)] for executor in executors])
    rows = [point | {"calibrated": results["calibrated"], "processors": requested} | _origin(machine, "runtimes") for point in points]
    files.write("granularity.csv", csv(rows, ".5g", ("compiler", "flags", "runtimes", "cpu"), length_us=".4g", calibrated=".3f", **{
        f"efficiency{end}": ".5f" for end in ("", "_lower_quartile", "_upper_quartile")}))
    conditions = (f"{requested} threads on {machine['cpu']}; {got}{requested} processors"
                  f"{', other processes are busy' if crowded else ''}; commit {machine['commit']}")
    curves, bounds = [], []
    for place, executor in enumerate(executors):
        for is_bound, lines, mark, line, name in ((False, curves, "dot", line_of(place), executor), (True, bounds, "triangle", "none", "")):
            found = [(count, 1e6 * number(shortest[executor, count]["length"])) for count in counts
                     if shortest[executor, count]["is_bound"] == is_bound]
            lines += [series(name, found, mark, line, f"C{place}")] if found or not is_bound else []
    files.draw("granularity.svg", [panel("Shortest tasks with half of the efficiency: METG(50 %)", "tasks per level", "METG(50 %) [us]",
                                         curves + bounds, ("log", "log"))], conditions + "; triangles: upper bounds")
    files.draw("efficiency.svg", [
        panel(f"Efficiency against the length of a task, {plural(count, 'task')} per level", "length of a task [us]", "efficiency",
              [series(executor, [(point["length_us"], point["efficiency"]) for point in points
                                 if (point["executor"], point["tasks"]) == (executor, count)], "small_dot", line_of(place))
               for place, executor in enumerate(executors)], ("log", "linear"), y_ends=(0.0, 1.1)) for count in counts], conditions)
    files.report()


def work(results, files):
    """Counted instructions: of a step by stage, and what threads would gain if nothing else took time."""
    rows, stages = results["rows"], results["stages"]
    scene, method, kernels = (rows[0][key] for key in ("scene", "method", "kernels"))
    print(f"{scene}: work of a step of {method}, {time_text(stages[0]['step_s'])} long, kernels {kernels}")
    table(["<stage", "instructions", "share"],
          [[stage["stage"], f"{stage['instructions']:.0f}", f"{100.0 * stage['share']:.1f} %"] for stage in stages])
    print()
    table(["M", "links", "N/N_max", "segments", "instructions", "fixed", "claimed", "of segments", "step fixed", "step claimed"],
          [[row["threads"], row["links"], f"{row['even']:.2f}", row["segments"], f"{row['instructions']:.0f}", f"{row['fixed']:.2f}",
            f"{row['claimed']:.2f}", row["claimed_segments"], f"{row['step_fixed']:.2f}", f"{row['step_claimed']:.2f}"]
           for row in rows if row["threads"] == row["segments"]])  # the others are as fast as the row above
    files.write("work.csv", csv(rows, ".4f", instructions=".0f"))
    files.write("stages.csv", csv(stages, step_s=".6g", instructions=".0f", share=".5f"))
    curves = [series(name, [(row["threads"], row[key]) for row in rows], mark, line, colour) for key, name, mark, line, colour in (
        ("even", "whole links: N / N_max(M)", "none", "dashed", "#999999"),
        ("fixed", "parallel tasks, a segment per thread", "small_dot", "solid", ""),
        ("claimed", "parallel tasks, claimed", "small_dot", "solid", ""), ("step_claimed", "all tasks, claimed", "none", "solid", ""))]
    files.draw("work.svg", [panel(f"Speed-up of {scene} by counted instructions", "threads", "speed-up", curves, x_ends=(0.0, None),
                                  y_ends=(0.0, None))], f"{method}, kernels {kernels}; nothing but the work of tasks takes time")
    files.report()


def _factor(value):
    return f"{value:.2f}" if value >= 0.1 else f"{value:.2g}"


def _timing_text(results):
    """Step and evaluation times, speed-ups, synchronisation: a row per schedule."""
    rows = []
    for schedule in results["schedules"]:
        row = schedule["rows"][0]
        known = row["active_threads"] is not None
        rows.append([*schedule["cells"], f"{row['step_us']:.2f}", f"{row['step_lower_quartile_us']:.2f} .. {row['step_upper_quartile_us']:.2f}",
                     f"{row['evaluation_us']:.2f}", _factor(row["speed_up"]), f"{row['cpu_per_wall']:.2f}", cell_text(row["active_threads"]),
                     cell_text(row["synchronisation_us"], ".2f"), cell_text(row["cycle_cost_us"], ".2f") or "absent", f"{row['bare_barrier_us']:.2f}",
                     cell_text(row["least_task_us"], ".2f"), cell_text(row["imbalance"], ".2f"),
                     f"{100.0 * row['recording_cost']:+.0f} %" if known else "", row["dropped"]])
    table(["<schedule", "threads", "segments", "step [us]", "quartiles", "evaluation", "speed-up", "cpu/wall", "active", "sync", "alone",
           "bare", "min task", "imbalance", "recording", "<"], rows, 0)
    print("bare barrier, time per cycle:" + "".join(f" {1e6 * cost:.2f} us ({plural(threads, 'thread')})" for threads, cost in results["bare"]))


def _gains_text(results):
    """Gains over serial's turns, near and far rounds apart, and those of independent runs."""
    rows = [schedule["cells"] + schedule["gains"] for schedule in results["schedules"] if schedule["cells"][1] > 1]
    rows += [["independent runs", copies["threads"], ""] + copies["gains"] for copies in results["copies"]]
    print("\nSpeed-up against serial's turn of the same round, near: threads had just met within "
          f"{1e6 * results['meeting']:.2f} us, far: not; independent runs: as\nmany serial ones at once, which share nothing")
    table(["<schedule", "threads", "segments", "near", "quartiles", "rounds", "far", "quartiles", "rounds"],
          [[*row[:3], *(cell for low, middle, high, rounds in row[3:] for cell in (
              [_factor(middle), f"{_factor(low)} .. {_factor(high)}", rounds] if rounds else ["", "", 0]))] for row in rows], 0)


def _neighbours_text(results):
    """Medians beside busy neighbours and factors against serial under the same load."""
    print("\nBeside busy neighbours: time per step, speed-up against serial under the same load (*: dropped after that round), processor time "
          "per step beyond serial's [us]")
    table(["<schedule", "threads", "segments", *(heading for row in results["schedules"][0]["rows"] for heading in (
        f"{row['neighbours']} busy [us]", "factor", "burnt"))],
          [[*schedule["cells"], *(cell for row in schedule["rows"] for cell in (
              [f"{row['step_us']:.2f}", _factor(row["speed_up"]) + "*" * bool(row["dropped"]), f"{row['burnt_us']:.2f}"] if row["rounds"] else
              ["dropped", "", ""]))] for schedule in results["schedules"]], 0)


def _bar(seconds, letters, width=60):
    """"CCCCHHHH..": shares of a thread's time as letters, the largest remainders filled up to the width."""
    if sum(seconds) <= 0.0:
        return " " * width
    exact = [width * each / sum(seconds) for each in seconds]
    cells = [math.floor(each) for each in exact]
    for place in sorted(range(len(cells)), key=lambda place: cells[place] - exact[place])[:width - sum(cells)]:
        cells[place] += 1
    return "".join(letter * cell for letter, cell in zip(letters, cells))


def _stages_text(results):
    """A bar per thread and schedule, divided by stages; and where sequential time goes, of the serial staged run or else of the fused one."""
    names, letters = zip(*results["stages"])
    print("\nStages by thread:" + ",".join(f" {letter} {name}" for name, letter in results["stages"]))
    for schedule in results["schedules"]:
        for thread, seconds in enumerate(schedule["seconds"] if schedule["rows"][0]["active_threads"] else []):
            name = f"{schedule['cells'][0]} M={schedule['cells'][2]}" if thread == 0 else ""
            shares = [each / sum(seconds) if sum(seconds) > 0.0 else 0.0 for each in seconds]
            print(f"  {name:<26} {thread:>2} |{_bar(seconds, letters)}|" + "".join(
                f" {letter} {100.0 * share:.0f}%" for letter, share in zip(letters, shares) if share >= 0.005))
    serial = next((each for each in results["schedules"] if each["cells"][0] == "serial:staged"), results["schedules"][0])
    print(f"\nWhere sequential time goes ({serial['cells'][0]}):")
    sums = [sum(column) for column in zip(*serial["seconds"])]
    for name, seconds in zip(names, sums):
        share = seconds / sum(sums) if sum(sums) > 0.0 else 0.0
        if share > 0.0:
            print(f"  {name:<20} {100.0 * share:>5.1f} % {1e6 * seconds / serial['steps']:>9.2f} us per step  {'#' * round(50.0 * share)}")
    share = results["serial_share"]
    field("serial share", f"{100.0 * share:.2f} % of serial:fused; Amdahl's law allows {1.0 / (share + (1.0 - share) / 16.0):.3g} with 16 "
          "threads")


def _profile_pictures(results, files):
    """Time per step of each stage, summed over threads, waiting included, by the number of a schedule; and beside busy neighbours."""
    schedules, machine = results["schedules"], results["machine"]
    measured_on = f"{machine['cpu']}, {machine['usable']} usable processors, commit {machine['commit']}"
    numbered = [f"{place} {name}, {plural(threads, 'thread')}, {plural(segments, 'segment')}"
                for place, (name, threads, segments) in enumerate((schedule["cells"] for schedule in schedules), 1)]
    marks, curves = ("dot", "square", "diamond", "triangle", "ring", "cross"), []
    for row, (name, _) in enumerate(results["stages"]):
        sums = [sum(seconds[row] for seconds in schedule["seconds"] if seconds) for schedule in schedules]
        points = [(place, 1e6 * seconds / schedules[place - 1]["steps"]) for place, seconds in enumerate(sums, 1) if seconds > 0.0]
        curves += [series(name, points, marks[row // 8 % 6])] if points else []
    curves += [series(name, [], "none", colour="#444444") for name in numbered]
    files.draw("stages.svg", [panel(f"Stages of a step of {results['scene']}", "schedule, by its number",
                                    "time per step, all threads together [us]", curves, ("linear", "log"),
                                    x_ends=(0.0, len(schedules) + 1.0))], measured_on)
    curves = [series(name, [(row["neighbours"], row["step_us"]) for row in schedule["rows"] if row["rounds"]], "dot", line_of(place))
              for place, (name, schedule) in enumerate(zip(numbered, schedules))]
    files.draw("loads.svg", [panel(f"Time per step of {results['scene']} beside busy neighbours", "busy neighbours", "time per step [us]",
                                   curves, ("linear", "log"), x_ends=(0.0, None))], measured_on)


def _profile_rows(profiles, files):
    """Writes profile.csv: a row for each profile, schedule and load. Returns its rows."""
    rows = [row | _origin(each["machine"], "tbb", "openmp") for each in profiles for schedule in each["schedules"] for row in schedule["rows"]]
    texts = ("scene", "dropped", "omp_wait_policy", "gomp_spincount", "kmp_blocktime", "commit", "compiler", "flags", "tbb", "openmp", "cpu", "date")
    files.write("profile.csv", csv(rows, ".4f", texts, cpu_per_wall=".3f", calibrated=".3f"))
    return rows


def runtimes(results, files):
    """OpenMP's runtimes by wait policy beside the executors that need none, which run in every process: medians over the processes."""
    def median(rows, key, rounds=""):
        values = [row[key] for row in rows if not rounds or row[rounds]]
        return f"{statistics.median(values):.2f}" if values else ""

    profiles, machine = results["profiles"], results["profiles"][0]["machine"]
    groups = {}
    for row in _profile_rows(profiles, files):
        by = (row["openmp"].rpartition(" ")[2], row["omp_wait_policy"] or "default") if row["executor"].startswith("omp") else ("", "")
        groups.setdefault((row["schedule"], row["threads"], *by), []).append(row)
    print(f"{profiles[0]['scene']}: OpenMP's runtimes, {len(profiles)} processes by turns, {machine['date']}")
    _machine(machine, f", {plural(machine['usable'], 'thread')} usable")
    crowded = sum(each["crowded"] for each in profiles)
    field("crowded" if crowded else "quiet", f"{crowded} of the {len(profiles)} processes did not get the processors that they requested")
    print("\nTime per step; speed-up against serial's turn of the same round, near and far apart; processor time per step beyond serial's")
    table(["<schedule", "threads", "<runtime", "<waiting", "step [us]", "near", "rounds", "far", "rounds", "burnt [us]"],
          [[*key, median(rows, "step_us"), median(rows, "gain_near", "rounds_near"), sum(row["rounds_near"] for row in rows),
            median(rows, "gain_far", "rounds_far"), sum(row["rounds_far"] for row in rows), median(rows, "burnt_us")]
           for key, rows in sorted(groups.items(), key=lambda item: item[0][2:] + item[0][:2])], 0)
    files.report()


def profile(results, files):
    """Schedules against each other."""
    scene, schedules, machine, crowded = results["scene"], results["schedules"], results["machine"], results["crowded"]
    print(f"{scene}: {plural(len(schedules), 'schedule')}, alternating, medians of {plural(results['rounds'], 'round')}")
    _machine(machine, f", {plural(machine['usable'], 'thread')} usable")
    field("flags", machine["flags"])
    field("libraries", machine["runtimes"])
    field("load average", f"{results['load_before']:.2f} before, {results['load_after']:.2f} after")
    calibration = "" if results["calibrated"] < 0.0 else (
        f"calibration got {results['calibrated']:.2f} of {results['requested']} processors, the schedules {results['got']:.2f}; "
        f"{results['needed']:.2f} are required")
    field("crowded" if crowded else "quiet", calibration + (": other processes are busy, so comparisons are unreliable" if crowded else ""))
    print()
    _timing_text(results)
    if results["requested"] > 1:
        _gains_text(results)
    if len(schedules[0]["rows"]) > 1:
        _neighbours_text(results)
    _stages_text(results)
    _profile_rows([results], files)
    files.write("stages.csv", csv([
        dict(zip(("scene", "schedule", "threads", "segments", "thread", "stage", "seconds", "share", "per_step_us"),
                 (scene, *schedule["cells"], thread, name, each, each / (sum(seconds) or 1.0), 1e6 * each / schedule["steps"])))
        for schedule in schedules for thread, seconds in enumerate(schedule["seconds"]) for (name, _), each in zip(results["stages"], seconds)],
        ".4f", ("scene", "stage"), seconds=".9f", share=".5f"))
    _profile_pictures(results, files)
    files.report()


# Accuracy

def _pin_force(results, files):
    """The axial force of a pin by method, and its distance from the reference."""
    file, force = results["file"], results["force"]
    times, expected = force["times"], force["reference"]
    names, courses = zip(("reference", expected), *force["choices"])
    files.write("pin-force.csv", csv([dict(zip(("time", *names), row)) for row in zip(times, *courses)]))
    conditions = f"{file['scene']}, on the sheave at -z" + (
        f"; the pin enters the driving sheaves at {time_text(file['entry'])}" if file["entry"] > 0.0 else "")
    milliseconds = [1e3 * time for time in times]
    curves = [series(name, list(zip(milliseconds, course)), "none", line_of(place), f"C{place}") for place, (name, course) in
              enumerate(force["choices"])]
    below = series("reference", list(zip(milliseconds, expected)), "none", "solid", "#bbbbbb", 5.0)  # the others mostly hide one another
    files.draw("pin-force.svg", [panel(f"Axial force of pin {file['pin']}", "time [ms]", "Axial force [N]", [below, *curves])], conditions)
    curves = [series(name, [(time, abs(is_ - should)) for time, is_, should in zip(milliseconds, course, expected)], "none", line_of(place))
              for place, (name, course) in enumerate(force["choices"])]
    files.draw("pin-force-error.svg", [panel(f"Error of the axial force of pin {file['pin']}", "time [ms]", "|force - reference| [N]",
                                             curves, ("linear", "log"))], conditions)


def compare(results, files):
    """Methods and steps on a scene against a reference: cost, errors, Newton's method, the axial force of a pin."""
    file, rows, watch = results["file"], results["file"]["choices"], results["file"]["reference_watch"]
    print(f"{file['scene']}: errors against {file['reference']} over {file['duration']} from the settled start, {results['transitions']} "
          f"transitions; {results['schedule']}; medians of {plural(file['rounds'], 'round')}, alternating")
    if results["asked_pin"] == "first" and "pin" in file:
        field("pin", f"{file['pin']}, enters the driving sheaves at {time_text(file['entry'])}")
    elif results["asked_pin"] and "pin" not in file:
        field("pin", "none enters the driving sheaves in this time")

    def error(value):
        return "-" if value is None else "lost" if value == "inf" else f"{value:.1e}"

    columns = {"method": ("<method", str), "mean_step": ("mean step", time_text), "evaluations": ("evaluations", count_text),
               "evaluations_per_second": ("per second", "{:.3g}"), "wall_seconds_per_second": ("wall s/s", "{:.4g}"),
               "fewer_by": ("fewer", "{:.2f}"), "faster_by": ("faster", "{:.2f}")}
    columns |= {f"error_{each}": (each.replace("_", " "), error) for each in ("axial_force", "tension", "slip", "losses", "pin")}
    columns |= {key: (key.removeprefix("newton_").replace("_", " ").replace("jacobians", "Jacobians"), lambda value: cell_text(value, ".3g"))
                for key in rows[0] if key.startswith("newton_")}
    columns |= {"residual": ("residual", error), "status": ("<status", str)}
    columns = {key: column for key, column in columns.items() if key in rows[0]}
    table([heading for heading, _ in columns.values()],
          [[how.format(number(row[key])) if isinstance(how, str) else how(row[key]) for key, (_, how) in columns.items()] for row in rows])
    if not watch["long_enough"]:
        enough = results["enough_pin_periods"]
        field("too short", f"{time_text(results['compared_time'])} are {watch['pin_periods']:.2g} pin periods: means of slip and efficiency "
              f"require {enough:g} (about {time_text(results['enough_time'])} here)")
    files.write(f"compare_{file['scene']}.csv", csv(rows))
    files.json(f"compare_{file['scene']}.json", file)
    if results["force"]:
        _pin_force(results, files)
    files.report()


def peers(results, files):
    """Solvers of others beside our methods: seconds per simulated second against error."""
    rows, first = results["rows"], results["rows"][0]
    scene, begin = f"{first['scene']}, {first['duration_us']:g} us", f"SUNDIALS {first['sundials']}; calibration got {first['calibrated']:.2f}"
    print(f"{scene.replace(', ', ': ')} before the first transition, {results['size']} unknowns, one thread; {begin} of 1 processor")
    for name, description in results["peers"]:
        print(f"  {name:<18} {description}")
    table(["<solver", "<step, tol.", "steps", "evaluations", "Jacobians", "s/simulated s", "err axial", "err tension", "<remark"],
          [[row["solver"], row["choice"], row["steps"], row["evaluations"], row["jacobians"], f"{row['seconds_per_simulated_second']:.4g}",
            f"{number(row['error_axial']):.2e}", f"{number(row['error_tension']):.2e}", row["fault"]] for row in rows], 0)
    files.write(f"peers_{first['scene']}.csv", csv([row | _origin(results["machine"], "runtimes") for row in rows], ".4e", (
        "fault", "compiler", "flags", "runtimes", "cpu"), duration_us="g", seconds_per_simulated_second=".6g", calibrated=".3f"))
    solvers = dict.fromkeys(row["solver"] for row in rows if not row["fault"])
    curves = [series(solver, [(row["error_axial"], row["seconds_per_simulated_second"]) for row in rows if row["solver"] == solver and
                              not row["fault"]], "dot", "solid") for solver in solvers]
    files.draw(f"peers_{first['scene']}.svg", [
        panel(f"Cost against error: {scene} without a transition", "error of the tips' axial forces", "seconds per simulated second", curves,
              ("log", "log"))], f"one thread; {begin} of 1 processor; commit {results['machine']['commit']}")
    files.report()


if __name__ == "__main__":
    for number_ in (signal.SIGINT, signal.SIGPIPE):
        signal.signal(number_, signal.SIG_DFL)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="surrogateescape")
    received = json.load(sys.stdin.buffer)
    complaints = received.get("complaints", [])
    try:
        globals()[sys.argv[1]](received, Files(received["output"]))
        sys.stdout.flush()
    except (ImportError, OSError, ValueError) as error:
        complaints = [str(error)]
    for complaint in complaints:
        sys.stderr.write(f"{received['program']}: {visible(complaint)}\n")
    sys.exit(1 if complaints else 0)
