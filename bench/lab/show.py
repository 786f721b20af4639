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
import sys

_here = os.path.dirname(os.path.abspath(__file__))
_spec = importlib.util.spec_from_file_location("cvtflow", os.path.join(_here, "__init__.py"), submodule_search_locations=[_here])
sys.modules["cvtflow"] = importlib.util.module_from_spec(_spec)  # the package of this folder, without the library

from cvtflow.commands import _front, _output  # noqa: E402
from cvtflow.commands._front import visible  # noqa: E402


# Texts

def number(value):
    """A number of the results; null: not a number."""
    return math.nan if value is None else float(value)


def form(value, spec):
    """A number as text; null: ""."""
    return "" if value is None else format(value, spec)


def time_text(seconds):
    """"2.25 ms", "-10 us", "0 s": four digits."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if abs(seconds) >= 0.99995 * size:
            return f"{seconds / size:.4g} {unit}"
    return f"{seconds:.4g} s"


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
    left = [heading.startswith("<") for heading in headings]
    headings = [heading.removeprefix("<") for heading in headings]
    rows = [[visible(str(cell)).replace("\n", " ") for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(headings, *rows)]
    for cells in [headings, ["-" * width for width in widths], *rows]:
        padded = (cell.ljust(width) if is_left else cell.rjust(width) for cell, width, is_left in zip(cells, widths, left))
        print((" " * indent + "  ".join(padded)).rstrip())


def cell_text(value, spec=".9g", quoted=False):
    """A cell of CSV: "" for what is unknown or not finite; texts in quotes where they must be, none that spreadsheets take for a formula."""
    if isinstance(value, str) and value != "inf":
        text = visible(("'" if value.startswith(("=", "+", "-", "@", "\t")) else "") + value)
        return '"' + text.replace('"', '""') + '"' if quoted or set(text) & set(',;"\n') else text
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
        self._folder = output["folder"] or "results"
        self._wanted = self._kinds or (["csv", "json", "svg"] if output["folder"] else [])

    def _write(self, name, data, mark, what):
        path = os.path.join(self._folder, name)
        os.makedirs(self._folder, exist_ok=True)
        try:
            _output.Output(path, what, _output.with_marks(mark), devices=True).write(data)
        except _output.OutputError as error:
            raise _output.OutputError(str(error).replace("--force replaces it", "remove it, or name another folder")) from None
        self._written.append(path)

    def write(self, name, text):
        """Writes a table or results, over a file with the same heading."""
        if name.rpartition(".")[2] in self._wanted:
            heading = text[:text.index("\n", 2 if text.startswith("{\n") else 0)]
            self._write(name, text.encode(errors="surrogateescape"), heading[:1024], "file with the same heading")

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
        mark = _output.mark_of("picture", name)
        self._write(name, _figures.picture(_figures.draw(made, heading), "svg", mark), mark, f"picture that cvtflow made of '{name}'")

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

def _complex_text(value):
    real, imaginary = value
    return f"{real:.3g} {'-' if imaginary < 0.0 else '+'} {abs(imaginary):.4g}i" if imaginary else f"{real:.4g}"


def _limit_text(limit):
    """"50.95 ns predicted (…), 50.97 ns measured (+0.04 %)"."""
    text = f"{time_text(limit['predicted'])} predicted (by {_complex_text(limit['limiting'])} 1/s), "
    stable, unstable, between = limit["measured_stable"], limit["measured_unstable"], limit["measured"]
    if unstable == 0.0 or stable == 0.0:
        return text + (f"more than {time_text(stable)} measured" if unstable == 0.0 else f"less than {time_text(unstable)} measured")
    return text + f"{time_text(between)} measured ({100.0 * (between / limit['predicted'] - 1.0):+.2f} %)"


def _growth_text(growth, bound):
    if not growth:
        return "not checked: extreme eigenvalues only"
    if growth["growing"] == 0:
        return f"none above {bound:g} 1/s (largest {growth['largest']:.3g} 1/s, the resolution of the differences)"
    return (f"GROWTH: {plural(growth['growing'], 'eigenvalue')} above {bound:g} 1/s, largest {growth['largest']:.4g} 1/s: the state is not "
            "settled or unstable")


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
    table(["<v0 x 10", "max -Re", "factor", "max |Im|", "below -1e6", "below -1e7"],
          [[row["contacts"] or "none", f"{row['max_decay']:.3e}", f"{extent_of / row['max_decay']:.2f}", f"{row['max_oscillation']:.3e}",
            row["below_1e6"], row["below_1e7"]] for row in file["slowed_tenfold"]
           for extent_of in [file["slowed_tenfold"][0]["max_decay"]]])


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


if __name__ == "__main__":
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
        sys.stderr.write(f"cvtflow-lab: {visible(complaint)}\n")
    sys.exit(1 if complaints else 0)
