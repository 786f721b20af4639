"""Scenes as command lines state them: SCENE, --set, --detail, and options that abbreviate settings."""

from ._front import UsageError, say


def declare_scene(parser, shortcuts=(), settle=False):
    """Declares SCENE, --set and --detail. shortcuts: (option, key, type, meaning) of options that abbreviate settings; settle: --settle as
    well"""
    parser.add_argument("scene", metavar="SCENE", help="Scene file, or name of a ready scene (cvtflow list scenes)")
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], dest="settings",
                        help="Change a key of the scene; may be repeated (cvtflow list keys)")
    parser.add_argument("--detail", metavar="PRESET", help="Level of detail (cvtflow list detail)")
    for option, key, kind, meaning in shortcuts:
        parser.add_argument(option, metavar=kind, help=f"{meaning} ({key})")
    if settle:
        parser.add_argument("--settle", action="store_true",
                            help="Start from the geometric start and settle it, even if the scene names a state file")


def load(given, shortcuts=(), quiet=False):
    """The Scene that a command line states. Where its changes alter the unknowns, the scene's start state no longer fits and is dropped, with a
    line on stderr unless `quiet`. Raises UsageError for a setting that cannot be."""
    from .. import Simulation, StartStateError, Threads
    from .._scene import opened

    scene = stated = opened(given.scene)
    try:
        if given.detail:
            scene = scene.with_detail(given.detail)
    except ValueError as error:
        raise UsageError(f"--{error}") from None
    words = {each: f"--set {each}" for each in given.settings}
    for option, key, *_ in shortcuts:
        if (value := getattr(given, option.strip("-"))) is not None:
            words[f"{key}={value}"] = f"{option} {value}"
    if getattr(given, "settle", False):
        words["start.state="] = "--settle"
    try:
        scene = scene.with_(*words)
    except ValueError as error:
        text = str(error)
        for setting, word in words.items():
            key = setting.partition("=")[0]
            text = text.replace(f"--set {setting}: ", f"{word}: ").replace(f"{word}: {key}: ", f"{word}: " if "--set" not in word else
                                                                          f"{word}: {key}: ")
        raise UsageError(text) from None
    if not scene["start.state"] or scene["start.state"] != stated["start.state"]:
        return scene
    try:
        Simulation(scene, Threads.caller())
    except StartStateError:
        state, scene = scene["start.state"], scene.with_("start.state=")
        if not quiet:
            changed = [f"{key} = {scene.value(key)} (was {stated.value(key)})" for key in scene
                       if key != "start.state" and not key.startswith("run.") and scene.value(key) != stated.value(key)]
            say(f"{', '.join(changed)}: the state in {state} no longer fits; the run settles again")
    return scene
