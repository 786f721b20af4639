"""Pages of records and of sweeps, as `cvtflow report` makes them: one file of HTML that needs no network."""

import os
from typing import Any

from . import _known, _page

_LONGEST = 160  # characters of a value that is shown completely


class Facts:
    """What is known of scenes beside the records. keys: default and meaning by key; notes: their meanings."""

    def __init__(self):
        self.keys = {name: (row["shown"], row["text"]) for name, row in _known.rows_of("keys").items()}
        self.notes = {name: row["text"] for name, row in _known.rows_of("notes").items()}

    def not_default(self, scene):
        """Keys of a scene whose values are not the defaults: (key, value, default, meaning). A level sets its dials."""
        return self.differing({key: _known.value_text(scene, key) for key in sorted(self.keys)})

    def differing(self, texts):
        """Likewise of values by key."""
        found = [(key, brief(value), self.keys[key][0], self.keys[key][1]) for key, value in texts.items()
                 if key in self.keys and not key.startswith("scene.") and value != self.keys[key][0].replace('"', "")]
        level = texts.get("detail.level", "")
        named = level and level != self.keys["detail.level"][0].replace('"', "")
        return [row for row in found if not named or not row[0].startswith("detail.") or row[0] in ("detail.level", "detail.pulleys")]

    @staticmethod
    def differences(rows, shared_by):
        """Blocks of such keys, folded. shared_by: "records" or "cases" that have them in common; empty: one scene"""
        if not rows:
            return [_page.text(f"Every key {f'that the {shared_by} share' if shared_by else 'of the scene'} has its default.")]
        summary = f"{len(rows)} difference{'s' if len(rows) > 1 else ''} from defaults{f', common to all {shared_by}' if shared_by else ''}"
        made = _page.table(["key", "here", "default", "meaning"], [list(row) for row in rows], "keys", row="default", styles={0: "code"})
        return [_page.folded(summary, [made])]


def brief(value):
    """Of a long table its beginning, how many points it has, and its unit."""
    end = value.rfind("], [", 0, _LONGEST)
    if len(value) <= _LONGEST or end < 0:
        return value
    return f"{value[:end]}], … ({value.count('[') - 1} points){value[value.rfind(']') + 1:]}"


def _written(parts):
    return _page.written("page.html", parts.pop("scripts"), parts.pop("data"), **parts).encode()


def report(of: Any, output: Any = None, with_: Any = None, si: bool = False) -> Any:
    """Writes a page: status and notes, key figures, scene, curves, running chain, losses, spectra and provenance of records; maps and
    cases of sweeps. Several are shown beside each other.

    of      a cvtflow.Record or the path of one, Results of a sweep, or several of either
    output  path of the page; None: nothing is written
    with_   measured data beside the results: the path of a CSV, or a mapping from headings such as "slip [%]" to numbers
    si      shows SI units instead of bar, l/min, rpm, kN, mm and %

    Returns the page as text.
    """
    from . import _run_page, _sweep_page
    from ._measured import Measured
    from ._series import Record
    from ._tables import Results

    single = isinstance(of, (str, os.PathLike, Record, Results))
    things = [Record(each) if isinstance(each, (str, os.PathLike)) else each for each in ([of] if single else of)]
    if not things or len({isinstance(each, Results) for each in things}) > 1:
        raise ValueError("report() takes one record or sweep, or several of one kind")
    measured = with_ if with_ is None or isinstance(with_, Measured) else Measured(with_)
    if isinstance(things[0], Results):
        page = _written(_sweep_page.parts(things, Facts(), measured, si))
    else:
        page = _written(_run_page.parts(things, Facts(), measured, si))
    if output is not None:
        with open(output, "wb") as file:
            file.write(page)
    return page.decode()
