"""Results of sweeps as they lie in files: lines of text with checksums. Needs nothing but Python."""

import collections
import csv
import json
import os
import re
import zlib

Column = collections.namedtuple("Column", "name unit description key shown")  # shown: (unit for people, factor to it from SI)

TEXTS = ("status", "notes", "start", "start_state", "program", "hash", "error")
UNHASHED = ("case", "wall", "program", "start_state")  # differ from run to run, or name what a row comes from


class DamagedRows(ValueError):
    """A line whose checksum differs, or a file that is no table of results."""


class Rows:
    """Results of a sweep in the order of cases. path: as named; name: of the sweep; facts: sweep.json, {} of a CSV; columns: a list of Column;
    cells: by name of column, numbers where all are (nan: none), else texts."""

    def __init__(self, path, name, facts, columns, lines):
        self.path, self.name, self.facts, self.columns = path, name, facts, columns
        self.size = len(lines)
        self.cells = {column.name: _values(column, [line[place] for line in lines]) for place, column in enumerate(columns)}


def _values(column, texts):
    """Numbers where all cells are, and some are not empty."""
    if column.name in TEXTS:
        return texts
    try:
        values = [float(text) if text else float("nan") for text in texts]
    except ValueError:
        return texts
    return values if any(texts) else texts


def read(path):
    """The Rows of a sweep's folder, finished or not, of its results.csv, or of any CSV with a column `status`. Raises OSError,
    DamagedRows."""
    path = os.fspath(path)
    folder = path if os.path.isdir(path) else os.path.dirname(path) if os.path.basename(path) == "results.csv" else None
    facts = _facts(folder) if folder is not None else None
    if facts is None and folder == path:
        raise DamagedRows(f"{path}: {_what_else(path)}")
    if facts is None:
        return _of_csv(path)
    names = ["results.csv"] if facts["status"] == "finished" else sorted(
        name for name in os.listdir(folder) if name.startswith("rows-") and name.endswith(".csv"))
    found = {}
    for name in names:
        for cells in _lines(os.path.join(folder, name))[1:]:
            found.setdefault(int(cells[0]), cells)
    columns = [Column(each["name"], each["unit"], each["description"], each.get("key", ""), tuple(each.get("shown", (each["unit"], 1.0))))
               for each in facts["columns"]]
    rows = Rows(path, facts["sweep"], facts, columns, [found[number] for number in sorted(found)])
    _add_errors(rows, folder)
    return rows


def accuracy_of(folder):
    """The choice and the errors of a sweep with [accuracy]; {}: it has none, or they are damaged."""
    try:
        with open(os.path.join(folder, "accuracy.json"), encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return {}


def _add_errors(rows, folder):
    """Adds the choice of a sweep with [accuracy], and the errors of its verified cases as columns behind the scalars."""
    if not (known := accuracy_of(folder)):
        return
    rows.facts.update({f"accuracy_{name}": known[name] for name in ("target", "choice", "at_corners")})
    place = [column.name for column in rows.columns].index("efficiency")
    for number, column in enumerate(rows.columns[place - len(known["scalars"]):place]):
        name = "error_of_" + column.name
        rows.columns.insert(place + number, Column(name, "1", "relative error against the reference run; nan: not verified", "", ("1", 1.0)))
        rows.cells[name] = [known["errors"].get(f"{case:.0f}", [float("nan")] * (number + 1))[number] for case in rows.cells["case"]]


def _facts(folder):
    """sweep.json of a folder; None: there is none."""
    try:
        with open(os.path.join(folder, "sweep.json"), encoding="utf-8") as file:
            return json.load(file)
    except FileNotFoundError:
        return None
    except ValueError:
        raise DamagedRows(f"{os.path.join(folder, 'sweep.json')}: damaged") from None


def _what_else(folder):
    """What a folder without results has."""
    names = sorted(os.listdir(folder))
    if "cases.h5" in names or "workers" in names:
        return ("results of cvtflow 0.4 or before, which this version does not read; `cvtflow table DIR --csv` of that version writes a CSV, "
                "which this one reads")
    records = [os.path.join(folder, name) for name in names if name.endswith(".h5")]
    some = ", ".join(records[:3]) + (", …" if len(records) > 3 else "")
    return "a folder without results of a sweep (sweep.json)" + (f"; it contains {some}: name one of these files" if records else "")


def _lines(path):
    """Cells of the lines of a file with checksums, the heading first, without the checksum. A torn last line is none."""
    with open(path, "rb") as file:
        lines = file.read().split(b"\n")[:-1]
    for number, line in enumerate(lines[1:], 2):
        cells, _, checksum = line.rpartition(b",")
        if b"%08x" % zlib.crc32(cells) != checksum:
            raise DamagedRows(f"{path}:{number}: its checksum differs")
    return [cells[:-1] for cells in csv.reader(line.decode("utf-8", "replace") for line in lines)]


def csv_rows(path):
    """Rows of cells of a CSV with a heading, whose numbers may have decimal commas where cells are separated by semicolons or tabs. Raises
    ValueError for a row with more or fewer cells than there are headings."""
    with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
        text = file.read()
    separator = max(";\t,", key=text.partition("\n")[0].count)
    rows = [(line, row) for line, row in enumerate(csv.reader(text.splitlines(), delimiter=separator), 1) if any(row)]
    for line, row in rows:
        if len(row) != len(rows[0][1]):
            raise ValueError(f"{path}:{line}: {len(row)} cells, not {len(rows[0][1])}")
    return [[cell.replace(",", ".") if separator != "," and number_of(cell.replace(",", ".")) is not None else cell for cell in row]
            for _, row in rows]


def column_name(text):
    """The column of a scalar or key: letters, digits and _ of "slip mean" and "load.torque"."""
    return re.sub("[^A-Za-z0-9]+", "_", text).strip("_")


def number_of(cell):
    """The number that a cell of a CSV is; None: a text."""
    try:
        return float(cell)
    except ValueError:
        return None


def heading_of(cell):
    """Name and unit of a heading: "slip [%]"."""
    name, _, unit = cell.partition("[")
    return name.strip(), unit.rstrip("] ")


def _of_csv(path):
    """A CSV such as `cvtflow table --csv` prints, or a copy of results.csv."""
    with open(path, "rb") as file:
        sealed = file.readline().rstrip().endswith(b",crc32")
    lines = _lines(path) if sealed else csv_rows(path)
    columns = [Column(name, unit, "", "", (unit, 1.0)) for name, unit in map(heading_of, lines[0])] if lines else []
    if len(lines) < 2 or "status" not in [column.name for column in columns]:
        raise DamagedRows(f"{path}: not a sweep's table as cvtflow table --csv prints it")
    return Rows(path, os.path.splitext(os.path.basename(path))[0], {}, columns, lines[1:])
