"""What the program's `batch` executes for a sweep with [accuracy]: `accuracy tune SWEEP DIR THREADS QUIET WORDS…` chooses the level and becomes
the program with WORDS and --tuned; `accuracy verify DIR STATUS QUIET` ends with the exit status of the sweep, or 7."""

from ._front import become_program, interruptible, say

DESCRIPTION = "Choose the level of a sweep, or verify it"


def act(what, *words):
    return _tune(*words) if what == "tune" else _verify(*words)


def _tune(sweep, folder, threads, quiet, *words):
    from .. import _verified_sweep

    with interruptible():
        _verified_sweep.tune(sweep, folder, int(threads), (lambda text: None) if quiet else say)
    become_program([*words, "--tuned"])


def _verify(folder, status, quiet):
    from .. import _rows, _verified_sweep

    if _rows.read(folder).facts["status"] != "finished":
        return int(status)
    with interruptible():
        text, held = _verified_sweep.verify(folder, say=(lambda text: None) if quiet else say)
    if not (quiet and held):
        say(text)
    return int(status) if held else 7
