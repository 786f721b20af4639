"""Interfaces that stay (docs/stability.md) are those of interfaces.txt: what is gone breaks programs, what is new belongs into the list.

    python_interfaces_test.py --write    writes the list
"""

import contextlib
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile
from collections import defaultdict
from itertools import product
from pathlib import Path

from python_fixture import PROGRAM, SOURCE, program

import h5py

import cvtflow
from cvtflow._library import described

LIST = Path(SOURCE, "tests/api/interfaces.txt")
BRIEF = {"start.settling_time": "20 us", "start.ramp_time": "10 us", "run.until": "20 us"}
SET = [word for key, value in BRIEF.items() for word in ("--set", f"{key}={value}")]
SWEEP = """[sweep]
scene = "tiny"
[[axes]]
key = "load.torque"
values = ["6 N*m"]
[outputs]
scalars = ["slip mean"]
[set]
""" + "".join(f'{key} = "{value}"\n' for key, value in BRIEF.items())
SHOWN = {"channels/time", "channels/slip", "channels/links/tension"}  # channels in a record; the library describes their names


def header():
    """Enumerators with their numbers, structs with their members, functions with their arguments."""
    text = re.sub(r"/\*.*?\*/", "", Path(SOURCE, "api/include/cvtflow/cvtflow.h").read_text(), flags=re.DOTALL)
    for body in re.findall(r"typedef enum \w+ \{(.*?)\}", text, re.DOTALL):
        yield from re.findall(r"\w+ = \d+", body)
    for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", text, re.DOTALL):
        yield f"struct {name}: {' '.join(body.split())}"
    for declaration in re.findall(r"^(?:CVTFLOW_API|typedef [\w ]+ \(\*) ?.*?;", text, re.DOTALL | re.MULTILINE):
        yield " ".join(declaration.removeprefix("CVTFLOW_API ").split())


def library():
    """What the library describes: names with units, which have the same meaning for ever."""
    for row in described("keys"):
        yield "key", f"{row['name']} [{row['unit']}] {row['kind']} {', '.join(row['choices'])}".rstrip()
    for kind in ("channel", "input"):
        yield from ((kind, f"{row['name']} [{row['unit']}] {row.get('per', '')}".rstrip()) for row in described(kind + "s"))
    yield from (("note", row["name"]) for row in described("notes"))
    yield from (("status", f"{row['status']} {row['text']}") for row in described("exit_statuses"))
    yield from (("code", f"{row['code']} {row['name']}") for row in described("codes"))


def record():
    """Groups, data sets and attributes of a record."""
    program("run", "tiny", *SET, "-o", "r.h5")
    with h5py.File("r.h5") as file:
        yield from (f"attribute {name}" for name in file.attrs)
        found = []
        file.visititems(lambda name, item: found.append((name, item)))
        for name, item in found:
            if isinstance(item, h5py.Dataset) and (not name.startswith("channels/") or name in SHOWN):
                yield f"{name} {sorted(item.dtype.fields or [str(item.dtype)])} {item.ndim} {sorted(item.attrs)}"


def rows():
    """Columns of a sweep's table."""
    Path("s.toml").write_text(SWEEP)
    program("batch", "s.toml", "-o", "s", "-q")
    return Path("s/results.csv").read_text().split("\n")[0].split(",")


def fmu():
    """Variables of an FMU by their names, causality and unit; numbers of elements left out."""
    program("export-fmu", "tiny", *SET, "-o", "t.fmu")
    with zipfile.ZipFile("t.fmu") as file:
        variables = ElementTree.fromstring(file.read("modelDescription.xml")).find("ModelVariables")
    return {f"{each.get('name')} {each.get('causality')} [{each.get('unit', '')}]" for each in variables}


def fields(data):
    """Names and types of the fields of a state, in their order; fields of a field in braces, equal ones in a row once."""
    at, found = 0, []
    while at < len(data):
        begin = at + 10 + data[at]
        name, kind = data[at + 1:begin - 9].decode(), chr(data[begin - 9])
        at = begin + struct.unpack_from("<Q", data, begin - 8)[0] * struct.calcsize(kind)
        inside = {"energy", "recorder"} & {name} or name == "method" and "means d" in found  # the first one is the method's name
        found.append(f"{name} {{{fields(data[begin:at])}}}" if inside else f"{name} {kind}")
    return ", ".join(name for name, before in zip(found, [""] + found) if name != before)


def host_state(level, method, step):
    """Fields of a state of a host, and among them those of the method."""
    scene = cvtflow.Scene.ready("tiny").with_detail(level).with_("start.state=", BRIEF, f"run.method={method}", f"run.step={step}")
    simulation = cvtflow.Simulation(scene)
    simulation.advance_to(simulation.time + 1e-7)
    state, _, own = fields(simulation.state().bytes()[16:-8]).rpartition(", method {")
    return state, own[:-1]


def states():
    """Fields of settled states, checkpoints, and states of hosts at every level, method and kind of step."""
    users = defaultdict(set)
    for level, method in product(("fine", "full", "rigid"), (row["name"] for row in described("methods"))):
        with contextlib.suppress(cvtflow.SceneError):  # not at this level
            state, own = host_state(level, method, "10 ns")
            yield f"of hosts: {state}, method {{...}}"
            users[f"method: {own}"].add(method)
            users[f"automatic step: {host_state(level, method, 'auto')[1].removesuffix(own).rstrip(', ')}"].add(method)
    yield from (f"of {', '.join(sorted(names))}, {part}" for part, names in users.items())
    program("settle", "tiny", *SET, "-o", "t.state")
    subprocess.run([PROGRAM, "run", "tiny", *SET, "--set=run.max_steps=2", "--checkpoint-every=1h", "-o", "c.h5"], capture_output=True)
    for name, file in (("settled", "t.state"), ("checkpoint", "c.checkpoint")):
        yield f"{name}: {fields(Path(file).read_bytes()[16:-8])}"


def interfaces():
    """Lines of the list: "key load.torque [N*m] …"."""
    found = {f"c {line}" for line in header()} | {f"{kind} {line}" for kind, line in library()}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, lines in (("record", record()), ("row", rows()), ("fmu", fmu()), ("state", states())):
            found |= {f"{name} {line}" for line in lines}
        os.chdir("/")
    return found


class Interfaces(unittest.TestCase):
    def test_are_those_of_the_list(self):
        promised, found = set(LIST.read_text(encoding="utf-8").split("\n")[:-1]), interfaces()
        self.assertEqual(sorted(promised - found), [], "gone or changed: programs rely on it (docs/stability.md)")
        self.assertEqual(sorted(found - promised), [], "new: python_interfaces_test.py --write adds it")


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        LIST.write_text("".join(line + "\n" for line in sorted(interfaces())), encoding="utf-8")
    else:
        unittest.main()
