"""`cvtflow run --accuracy`: tunes, and becomes the program's `run` with the choice. Other options are the program's."""

from ._front import UsageError, become_program, interruptible, say
from ._scenes import declare_scene, load
from .tune import declare_tuning, settings_of

DESCRIPTION = "Simulate a scene and record it"
_PASSED = ("--output", "--checkpoint-every", "--until", "--threads", "--segments", "--seed")


def declare(parser):
    declare_scene(parser, settle=True)
    declare_tuning(parser)
    add = parser.add_argument
    add("-o", *_PASSED[:1], metavar="FILE", help="As of cvtflow run")
    for option in _PASSED[1:]:
        add(option, metavar="VALUE", help="As of cvtflow run")
    for option in ("--method", "--step", "--tolerance"):
        add(option, metavar="VALUE", help="Not with --accuracy, which chooses it")
    add("--force", action="store_true", help="As of cvtflow run")
    add("-q", "--quiet", action="store_true", help="Print errors only")


def act(given):
    from .. import _scene, _tune

    for option in ("method", "step", "tolerance", "detail"):
        if getattr(given, option) is not None:
            raise UsageError(f"--accuracy excludes --{option}, which it chooses")
    with interruptible():
        settings, scene = settings_of(given), load(given, quiet=given.quiet)
        with _tune.points_of(scene, settings, say=(lambda text: None) if given.quiet else say) as points:
            found = _tune.tuned(points, settings, scene)
    if not given.quiet:
        say(f"{scene.name}: {found.choice} for {given.accuracy} (largest error measured: {100 * found.error:.2g} %)")
    words, stated = ["run", given.scene], _scene.opened(given.scene)
    for key in found.scene:
        if (value := found.scene.value(key)) != stated.value(key):
            words += ["--set", f"{key}={value}"]
    for option in _PASSED:
        if (value := getattr(given, option.strip("-").replace("-", "_"))) is not None:
            words += [option, value]
    become_program(words + ["--force"] * given.force + ["-q"] * given.quiet)
