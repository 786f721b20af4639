"""`cvtflow tune`: the cheapest detail, method and step for an accuracy."""

import json
import math
import os

from .._output import Output, beside, inputs_of
from ._columns import table
from ._front import FORCE, UsageError, interruptible, say, visible
from ._scenes import declare_scene, load

DESCRIPTION = "Find the cheapest detail, method and step for a target accuracy, by measuring"
FOOTER = """
Tries levels of detail (cvtflow list detail) at the automatic step, a half and a quarter of it, cheapest first. Operating points: the scene's
start, and the lowest and highest value of every table over time, and two points between. Reference: the finest level at a quarter of its
step or less. Chooses the first variant whose errors times 2 meet the accuracy at every point; unreliable variants are never chosen.
front: no other variant is both cheaper and more accurate. Exit status 7: no variant meets the accuracy, or more than one in twenty points of
--verify misses it.
"""
_SHOWN_UNTRIED, _LONGEST = 3, 320


def declare_tuning(parser):
    """Options of tune and run."""
    add = parser.add_argument
    add("--accuracy", metavar="SHARE", required=True, help='Target: largest error of the outputs, e.g. "1 %%"'.replace("%%", "%"))
    add("--outputs", metavar="LIST", default="",
        help='Outputs whose error counts, separated by commas: slip, efficiency, losses, tight_tension, slack_tension, tips, ratio, '
             'thrust_ratio, or as in a sweep, "slip median" (default: slip, efficiency, tight_tension, tips)')
    add("--methods", metavar="LIST", default="",
        help="Methods to choose from, separated by commas: METHOD or METHOD@STEP, such as rk4@45ns (default: auto)")
    add("--settling", metavar="TIME", help="Simulated time before the averages begin (default: 20 ms)")
    add("--average", metavar="TIME", help="Simulated time that the averages cover (default: 16 ms)")


def declare(parser):
    declare_scene(parser)
    declare_tuning(parser)
    add = parser.add_argument
    add("--verify", metavar="N", type=int, default=0, help="Measure the choice at N further operating points that tuning did not use")
    add("--levels", metavar="LIST", default="",
        help='Levels of detail to choose from, separated by commas: LEVEL, or LEVEL KEY=VALUE such as "full detail.plates=lumped" (default: all, '
             "and the scene's)")
    add("--all", action="store_true", help="Measure every choice at every point: the whole table of cost and error")
    add("--write", metavar="FILE", help="Scene to write, with a state beside it if the detail requires one (default: SCENE.tuned.toml)")
    add("--force", action="store_true", help=FORCE)
    add("--json", action="store_true", help="Print all results as JSON, with provenance, in place of the table")
    add("-q", "--quiet", action="store_true", help="Print no progress")


def settings_of(given):
    """The Settings that a command line states. Raises UsageError."""
    from .. import _tune, quantity

    def number(option, unit, usual, expected, most=math.inf):
        text = getattr(given, option)
        try:
            value = usual if text is None else quantity(text, unit)
        except ValueError:
            value = math.nan
        if not (text is None or 0.0 < value <= most):
            raise UsageError(f"--{option} {text}: expected {expected}")
        return value

    def names(text):
        return tuple(filter(None, (name.strip() for name in text.split(","))))

    usual, of_time = _tune.Settings(), 'a time such as "30 s" or "10 min"'
    return usual._replace(accuracy=number("accuracy", "1", None, 'a share above 0 and up to 50 %, such as "1 %"', 0.5),
                          outputs=names(given.outputs), methods=names(given.methods), levels=names(getattr(given, "levels", "")),
                          settling=number("settling", "s", usual.settling, of_time), average=number("average", "s", usual.average, of_time),
                          all=getattr(given, "all", False))


def _field(name, text):
    return f"  {name:<20}{text}\n"


def _text(found):
    from .. import _tune

    shown, untried = [], 0
    for row in found["choices"]:
        untried += not row["tried"]
        if row["tried"] or untried <= _SHOWN_UNTRIED:
            errors = [f"{100 * error:.2g}" if math.isfinite(error) else "-" for error in row["errors"]] or [""] * len(found["outputs"])
            shown.append([row["detail"] or "own", row["method"], f"{1e6 * row['step']:.4g} us" if row["step"] else "auto",
                          f"{row['seconds_per_second']:.3g}", *errors, "*" * row["front"], row["standing"]])
    points, count = len(found["points"]), len(found["outputs"])
    headings = ["detail", "method", "step", "s/s", *(f"{name} %" for name in found["outputs"]), "front", "standing"]
    text = f"{found['scene']}: accuracy {100 * found['accuracy']:g} %, at {points} operating point{'s' * (points != 1)}\n"
    text += table(headings, shown, [True, True, False, False, *[False] * count, True, True], 2)
    if untried > _SHOWN_UNTRIED:
        text += f"  … and {untried - _SHOWN_UNTRIED} untried ones (--json)\n"
    for heading, lines in (("against", map(": ".join, zip(found["points"], found["references"]))), ("left out", found["left_out"])):
        for number, line in enumerate(lines):
            text += _field(heading * (number == 0), line.split("\n")[0][:_LONGEST])
    row = found["choices"][found["chosen"]] if found["chosen"] is not None else None
    text += _field("chosen", f"{_tune.choice_of(row).text()}: {row['seconds_per_second']:.3g} s/s, errors times {found['margin']:g} within the "
                             "target" if row else "none: " + _tune.why_none(found))
    return text + _field("took", f"{found['wall']:.1f} s")


def _unseen(points, settings, found):
    """Errors of the chosen one at points that were not used. Fills found["unseen"]; returns the text."""
    from .. import _tune

    row, text = found["choices"][found["chosen"]], ""
    references = points.references(_tune.CONVERGED * settings.accuracy)
    for name, reference, is_ in zip(points.names, references, points.run(_tune.choice_of(row))):
        errors = points.errors(is_, reference[0]) if reference[0] else []
        found["unseen"].append({"point": name, "errors": errors, "remark": is_[1] if errors else reference[1]})
        worst = f"largest error {100 * max(errors):.2g} %" if errors else "no reference"
        text += _field("unseen", f"{name}: {worst}" + f" ({found['unseen'][-1]['remark']})" * bool(found["unseen"][-1]["remark"]))
    return text


def _outputs(given, scene):
    """Permissions for FILE and a state beside it."""
    from .. import _scene

    file = given.write or f"{os.path.basename(given.scene).removesuffix('.toml')}.tuned.toml"
    if not file.endswith(".toml"):
        raise UsageError(f"--write {file}: expected FILE.toml")
    inputs = [*inputs_of([given.scene if _scene.is_path(given.scene) else ""]), scene["start.state"]]
    made, state = (Output(each, inputs, given.force) for each in (file, beside(file, ".state")))
    if made.notice and not given.quiet:
        say(made.notice)
    return made, state


def act(given):
    from .. import _tune

    tell = (lambda text: None) if given.quiet else say
    show = (lambda text: None) if given.json else (lambda text: print(text, end="", flush=True))
    with interruptible():
        settings, scene = settings_of(given), load(given, quiet=given.quiet)
        files = _outputs(given, scene)
        with _tune.points_of(scene, settings, say=tell) as points:
            found = _tune.search(points, settings)
            show(text := _text(found))
            row = found["choices"][found["chosen"]] if found["chosen"] is not None else None
            if row and given.verify:
                with _tune.points_of(scene, settings, given.verify, tell) as unseen:
                    show(more := _unseen(unseen, settings, found))
                text += more
            if row:
                show(_write(files, points, found, scene, row, text))
        if given.json:
            print(json.dumps(json.loads(json.dumps(found), parse_constant=lambda _: None), indent=1))
    if not row:
        return 7
    judged = [max(each["errors"]) for each in found["unseen"] if each["errors"]]
    return 7 if 20 * sum(not error <= settings.accuracy for error in judged) > len(judged) else 0


def _write(files, points, found, scene, row, text):
    """Writes the tuned scene with every key, below what was measured as comments, and beside it a state where it begins with one of its own.
    Returns a line with their names."""
    from .. import _tune

    (scene_file, state_file), build, written = files, found["provenance"], [files[0].path]

    def keep(state):
        state_file.write(state)
        written.append(state_file.path)
        return os.path.abspath(state_file.path)

    lines = [*text.splitlines(), f"Made by cvtflow {build['version']} ({build['commit']})."]
    made = points.scene_of(_tune.choice_of(row), scene, keep).text
    scene_file.write(("".join(f"# {line}\n" for line in lines) + "\n" + made).encode())
    return _field("written", visible(", ".join(written)))
