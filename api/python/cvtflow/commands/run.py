"""`cvtflow run --accuracy`: tunes, or takes a kept choice, and becomes the program's `run` with it. Other options are the program's."""

from ._front import UsageError, become_program, interruptible, say
from ._scenes import declare_scene, load
from .tune import declare_tuning, settings_of

DESCRIPTION = "Simulate a scene and record it"
_PASSED = ("--output", "--checkpoint-every", "--until", "--threads", "--segments", "--seed")


def declare(parser):
    declare_scene(parser, settle=True)
    declare_tuning(parser)
    add = parser.add_argument
    add("--cache", metavar="DIR", help="Folder that caches the choices of --accuracy (default: $XDG_CACHE_HOME/cvtflow or ~/.cache/cvtflow)")
    add("-o", *_PASSED[:1], metavar="FILE", help="As of cvtflow run")
    for option in _PASSED[1:]:
        add(option, metavar="VALUE", help="As of cvtflow run")
    for option in ("--method", "--step", "--tolerance"):
        add(option, metavar="VALUE", help="Not with --accuracy, which chooses it")
    add("--force", action="store_true", help="As of cvtflow run")
    add("-q", "--quiet", action="store_true", help="Print errors only")


def act(given):
    from .. import _scene, _tuning

    for option in ("method", "step", "tolerance", "detail"):
        if getattr(given, option) is not None:
            raise UsageError(f"--accuracy excludes --{option}, which it chooses")
    with interruptible():
        settings, scene = settings_of(given), load(given, quiet=given.quiet)
        found, wall = _tuning.tuned(scene, settings, given.cache or _tuning.usual_folder(), (lambda text: None) if given.quiet else say)
    if not given.quiet:
        say(f"{scene.name}: {found.choice} for {given.accuracy} (largest error measured: {100 * found.error:.2g} %), "
            + ("from the cache" if found.kept else f"found in {wall:.1f} s"))
    words, stated = ["run", given.scene], _scene.opened(given.scene)
    for key in found.scene:
        if (value := found.scene.value(key)) != stated.value(key):
            words += ["--set", f"{key}={value}"]
    for option in _PASSED:
        if (value := getattr(given, option.strip("-").replace("-", "_"))) is not None:
            words += [option, value]
    become_program(words + ["--force"] * given.force + ["-q"] * given.quiet)
