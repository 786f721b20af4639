"""`cvtflow diff`: results of two sweeps, case by case."""

import json
import math
import sys

from .. import _rows
from ._columns import column_of, exact, heading_of, table
from ._front import UsageError, between, file_or_result, visible

DESCRIPTION = "Compare the results of two sweeps case by case"
FOOTER = """Cases are the same if their keys have the same values. Wall times, versions and starts are not compared.

Exit status: 0 equal, 1 different, or an error (message on stderr)."""


def declare(parser):
    add = parser.add_argument
    add("a", type=file_or_result(), help="Folder of a sweep, or a CSV of it")
    add("b", type=file_or_result(), help="The same of another sweep")
    add("--tolerance", type=between(float, 0.0, 1.0), default=0.0, metavar="NUMBER",
        help="Relative difference up to which numbers count as equal, e.g. 1e-3 [0]")
    add("--column", action="append", default=[], metavar="NAME", help="Compare this column only; may be repeated")
    add("--json", action="store_true", help="Differences as JSON, with provenance")


def act(arguments):
    a, b = _rows.read(arguments.a), _rows.read(arguments.b)
    keys = _common_keys(a, b)
    in_a, in_b = _rows_by_keys(a, keys), _rows_by_keys(b, keys)
    pairs = [(name, row, in_b[name]) for name, row in sorted(in_a.items()) if name in in_b]
    if not pairs:
        raise UsageError(f"{a.path} and {b.path}: no case has the same {', '.join(keys)}")
    compared = [column_of(a, name) for name in arguments.column] or [
        column for column in a.columns if column.name not in keys and column.name not in _rows.UNHASHED and not column.key and
        not (arguments.tolerance > 0.0 and column.name == "hash")]
    lacking = [column.name for column in compared if column.name not in b.cells]
    if arguments.column:
        for name in arguments.column:
            column_of(b, name)
    different = list(filter(None, (_difference(a, b, column, pairs, arguments.tolerance) for column in compared if column.name in b.cells)))
    equal = not different and not lacking and len(pairs) == len(in_a) == len(in_b)
    if arguments.json:
        _print_json(a, b, (in_a, in_b), pairs, arguments.tolerance, equal, different)
    else:
        more = f" by more than {arguments.tolerance:g} of the value" if arguments.tolerance > 0.0 else ""
        text = (f"{len(in_a)} cases in {a.path}, {len(in_b)} in {b.path}, {len(pairs)} in both; "
                f"{len(compared) - len(lacking)} columns compared, {len(different)} differ{more}\n")
        text += f"only in {a.path}: {', '.join(lacking)}\n" if lacking else ""
        sys.stdout.write(visible(text + (_table(different) if different else "")))
    return 0 if equal else 1


def _common_keys(a, b):
    """Columns of keys that both have; of a CSV those that the other one knows as such."""
    known = {column.name for rows in (a, b) for column in rows.columns if column.key}
    if not known:  # two CSVs: all columns between the status and the first that is a result
        known = _leading_keys(a) & _leading_keys(b)
    return [column.name for column in a.columns if column.name in known and column.name in b.cells]


def _leading_keys(rows):
    """Columns of a CSV that are keys of scenes, by the library, which knows them all."""
    from .. import scene_keys

    names = {key.name.replace(".", "_") for key in scene_keys()}
    return {column.name for column in rows.columns if column.name in names and column.name != "start_state"}


def _rows_by_keys(rows, keys):
    """Row by the values of keys. Raises UsageError if these do not tell the cases apart."""
    found = {}
    for row in range(rows.size):
        name = ", ".join(f"{key} = {exact(rows.cells[key][row])}" for key in keys)
        if found.setdefault(name, row) != row:
            raise UsageError(f"{rows.path}: several cases have {name or 'no key'}; both tables need the keys in which they differ")
    return found


def _difference(a, b, column, pairs, tolerance):
    """Cases whose cells differ by more than the tolerance: {"column", "cases", "largest", …}; None: there are none."""
    heading, factor = heading_of(column, False)
    found = {"column": column.name, "heading": heading, "factor": factor, "cases": 0, "largest": 0.0, "relative": 0.0}
    for name, row_a, row_b in pairs:
        x, y = a.cells[column.name][row_a], b.cells[column.name][row_b]
        if x == y or x != x and y != y:
            continue
        gap = abs(x - y) if isinstance(x, float) and isinstance(y, float) else math.nan
        size = max(abs(x), abs(y)) if gap == gap else 1.0
        relative = gap / (size or 1.0)  # nan: one is a text, or undefined
        if relative <= tolerance:
            continue
        found["cases"] += 1
        if found["cases"] == 1 or not relative <= found["relative"]:
            found["relative"] = relative
            found["example"], found["shown"] = (f"{name}: {_cell(x, by)} -> {_cell(y, by)}" for by in (1.0, factor))
        found["largest"] = gap if gap != gap or gap > found["largest"] else found["largest"]
    return found if found["cases"] else None


def _cell(value, factor):
    return f"{factor * value:.8g}" if isinstance(value, float) and math.isfinite(value) else exact(value) or "nothing"


def _table(different):
    def number(value):
        return "-" if value != value else f"{value:.3g}"

    lines = [[each["heading"], str(each["cases"]), number(each["factor"] * each["largest"]), number(each["relative"]), each["shown"]]
             for each in different]
    return table(["column", "cases", "largest difference", "relative", "where"], lines, [True, False, False, False, True], 2)


def _print_json(a, b, cases, pairs, tolerance, equal, different):
    def known(value):
        return value if value == value else None

    page = {"a": a.path, "b": b.path, "cases": [len(each) for each in cases], "in_both": len(pairs), "tolerance": tolerance, "equal": equal,
            "columns": [{name: known(each[name]) for name in ("column", "cases", "largest", "relative", "example")} for each in different],
            "provenance": {name: facts.get("program") for name, facts in (("a", a.facts), ("b", b.facts))}}
    sys.stdout.write(json.dumps(page, indent=2, ensure_ascii=False) + "\n")
