"""`cvtflow table`: results of a sweep as text or CSV; cycles of a recorded load."""

import math
import sys

from .. import _rows
from ._columns import column_of, csv_cell, exact, heading_of, short, table
from ._front import SI, UsageError, between, file_or_result, require, visible

DESCRIPTION = "Show the results of a sweep as text or CSV, or count the cycles of a recorded load"
FOOTER = """In Python: pandas.read_csv("DIR/results.csv") is the table of a finished sweep, cvtflow.Sweep.results("DIR") that of any."""
QUIET = ("start", "start_state", "program", "steps", "evaluations", "transitions", "truncated", "settling_evaluations", "hash")


def declare(parser):
    add = parser.add_argument
    add("dir", type=file_or_result(), help="Folder of a sweep, also of a running one, or a CSV of it. With --rainflow: the record of a run")
    add("--csv", action="store_true", help="Print all columns as CSV, in SI units, numbers with all digits")
    add("--units", action="store_true", help='CSV: headings with units, "load_torque [N*m]"')
    add("--si", action="store_true", help=SI)
    add("--column", action="append", default=[], metavar="NAME",
        help='Show this column, also by its key or scalar (load.torque, "slip mean"); may be repeated')
    add("--status", metavar="STATUS", help="Show only cases with this status")
    add("--rainflow", action="append", default=[], metavar="CHANNEL",
        help="Count the load cycles (ASTM E1049) of a channel, or of its elements NAME[3], NAME[*]; DIR is the record of a run; may be "
             "repeated")
    add("--classes", type=between(int, 1, 10000), default=16, metavar="COUNT", help="Number of classes of ranges [16]")
    add("--exponent", type=between(float, 1.0, 50.0), default=5.0, metavar="NUMBER", help="Exponent of the Woehler line, for the damage-equivalent range [5]")
    add("--from", dest="begin", metavar="TIME", help="Start of counting")
    add("--until", metavar="TIME", help="End of counting")
    add("--json", action="store_true", help="Cycles and classes as JSON, with provenance")


def act(arguments):
    if arguments.rainflow:
        return _rainflow(arguments)
    if arguments.json or arguments.begin or arguments.until:
        raise UsageError("--json, --from and --until require --rainflow")
    if arguments.units and not arguments.csv:
        raise UsageError("--units requires --csv")
    rows = _rows.read(arguments.dir)
    kept = range(rows.size)
    if arguments.status:
        known = next((column.description.split(", ") for column in rows.columns if column.name == "status" and column.description), None)
        if known and arguments.status not in known:
            raise UsageError(f"--status {arguments.status}: not one of {', '.join(known)}")
        kept = [row for row in kept if rows.cells["status"][row] == arguments.status]
    sys.stdout.write(_csv(rows, kept, arguments.units) if arguments.csv else _text(rows, kept, arguments.column, arguments.si))
    return None


def _csv(rows, kept, units):
    columns = rows.columns
    lines = [[f"{column.name} [{column.unit}]" if units and column.unit else column.name for column in columns]]
    lines += [[exact(rows.cells[column.name][row]) for column in columns] for row in kept]
    return "".join(",".join(map(csv_cell, line)) + "\n" for line in lines)


def _text(rows, kept, names, si):
    columns = [column_of(rows, name, f"--column {name}") for name in names] or [each for each in rows.columns if each.name not in QUIET]
    shown = [heading_of(column, si) for column in columns]
    lines = [[visible(short(rows.cells[column.name][row], factor)) for column, (_, factor) in zip(columns, shown)] for row in kept]
    left = [column.name in _rows.TEXTS or not isinstance(next(iter(rows.cells[column.name]), 0.0), float) for column in columns]
    text = table([heading for heading, _ in shown], lines, left) + "\n"
    if any(rows.cells.get("notes", ())):
        text += "notes: cvtflow list notes states their meanings\n"
    facts = rows.facts
    if facts:
        status = f"results hash {facts['results_hash']}" if facts["status"] == "finished" else "not finished"
        text += f"{visible(rows.name)}: {len(kept)} of {facts['cases']} cases, {facts['status']}, {status}\n"
    else:
        text += f"{visible(rows.name)}: {len(kept)} cases\n"
    for name, words in (("accuracy_choice", "accuracy {accuracy_target}: {accuracy_choice} (largest error at the corners "
                                            "{accuracy_at_corners})"),
                        ("continuation_error", "continuation error per output: {continuation_error}"),
                        ("steady_check", "changes in three times as long: {steady_check}")):
        if facts.get(name):
            text += visible(words.format_map(facts)) + "\n"
    return text


def _rainflow(arguments):
    if arguments.column or arguments.status:
        raise UsageError("--column and --status apply to sweeps, --rainflow to a record")
    if arguments.csv and arguments.json:
        raise UsageError("--csv or --json, not both")
    require("table --rainflow", "numpy", "h5py")
    from .. import _loads
    from .._series import Record

    begin, until = _time("--from", arguments.begin, 0.0), _time("--until", arguments.until, math.inf)
    kind = "json" if arguments.json else "csv" if arguments.csv else "text"
    sys.stdout.write(_loads.printed(Record(arguments.dir), arguments.rainflow, begin, until, arguments.classes, arguments.exponent,
                                    kind, arguments.si))


def _time(option, text, otherwise):
    from .. import quantity

    try:
        number = otherwise if text is None else _rows.number_of(text)
        return quantity(text, "s") if number is None else number
    except ValueError:
        raise UsageError(f"{option} {text}: not a time") from None
