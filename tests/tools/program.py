"""Runs a program like a user: as a child process, each test in an empty folder. It is cvtflow-lab where a command line begins so."""

import atexit
import csv
import glob
import importlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("CVTFLOW_BUILD", SOURCE / "build"))
PROGRAM, LAB = BUILD / "cvtflow", BUILD / "cvtflow-lab"
DEEP = os.environ.get("CVTFLOW_TEST_DEPTH") == "deep"
SETTLING = "--set 'start.settling_time=20 us' --set 'start.ramp_time=10 us'"
BRIEFLY = f"tiny --until '20 us' --step '50 ns' {SETTLING}"  # settles and runs for 20 us: a fraction of a second
# A run of 4,000 steps after settling, long enough to be ended at any moment.
TO_BE_ENDED = ("run tiny -q --until '0.2 ms' --step '50 ns' --set start.settling_time=100us --set start.ramp_time=50us "
               "--set run.schedule=serial")


FAULTS = BUILD / "tests/libcvtflow_faults.so"
with_faults = unittest.skipUnless(FAULTS.exists(), "not under sanitizers, whose runtime has to be loaded before any other library")


def preload(library=FAULTS):
    """Name of a library for LD_PRELOAD, without blanks, at which the loader splits."""
    link = Path(tempfile.gettempdir(), f"cvtflow_{os.getpid()}_{library.name}")
    if not link.is_symlink():
        link.symlink_to(library)
        atexit.register(link.unlink)
    return str(link)


def depth(quick, deep):
    return deep if DEEP else quick


def words_of(line):
    """Words of a command line, with the program that it begins with, or cvtflow."""
    words = shlex.split(line) if isinstance(line, str) else list(line)
    return [str(LAB), *words[1:]] if words[:1] == ["cvtflow-lab"] else [str(PROGRAM), *words]


def eventually(condition):
    """Waits until the condition holds. Returns whether it did within 20 s."""
    end = time.monotonic() + 20
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.002)
    return True


def read(name):
    return Path(name).read_text(encoding="utf-8", errors="surrogateescape")


def write(name, text):
    Path(name).parent.mkdir(parents=True, exist_ok=True)
    Path(name).write_text(text, encoding="utf-8")


def channel(record, name):
    """Rows of a channel, of another dataset of a record ("/states/y"), or of a record that is being written."""
    with h5py.File(record, "r", locking=False) as file:
        rows = file[name if name.startswith("/") else "channels/" + name][:]
        return rows.astype(float) if rows.dtype == "float32" else rows


def contents(record):
    """Everything that a record holds but when and how long it ran, as bytes: some channels have no number where no energy flows."""
    with h5py.File(record, "r") as file:
        found = {"status": file.attrs["status"], "state_hash": file.attrs["state_hash"]}
        file.visititems(lambda name, each: found.update({name: each[:].tobytes()}) if isinstance(each, h5py.Dataset) else None)
        return found


def attribute(file, name):
    with h5py.File(file, "r", locking=False) as opened:
        value = opened.attrs[name]
        return value.decode() if isinstance(value, bytes) else value


class Warm:
    """A child that runs a command of Python as a fork of this process, which has read Matplotlib once: a third of the time of a process of
    its own. With the part of Popen's interface that tests use."""

    package = None

    @classmethod
    def takes(cls, words):
        """Whether a command line is of Python, at depth quick: at depth deep every command is a process, as users start it."""
        if cls.package is None:
            cls.package = importlib.import_module("runpy").run_path(str(BUILD / "python/cvtflow/__main__.py"), run_name="warm")
        return not DEEP and words[0] == str(PROGRAM) and words[1:2] and words[1] in cls.package["COMMANDS"]

    def __init__(self, words):
        if "cvtflow" not in sys.modules:
            self.package["_load_package"]()
            front = importlib.import_module("cvtflow.commands._front")
            front.matplotlib()
            for name in ("matplotlib.figure", "matplotlib.backends.backend_svg", "matplotlib.backends.backend_agg", "jinja2"):
                importlib.import_module(name)
        self.args, self.returncode, self.files = words, None, [tempfile.TemporaryFile() for _ in range(2)]
        self.pid = os.fork()
        if self.pid == 0:
            atexit._clear()  # what the tests' own process tidies up
            for number, descriptor in enumerate((os.open(os.devnull, os.O_RDONLY), *(file.fileno() for file in self.files))):
                os.dup2(descriptor, number)
            for name, number in (("stdout", 1), ("stderr", 2)):
                setattr(sys, name, open(number, "w", buffering=1, encoding="utf-8", closefd=False))
            status = 1
            try:
                status = sys.modules["cvtflow.commands._front"].main(self.package["COMMANDS"], words[1:])
            finally:
                atexit._run_exitfuncs()
                os._exit(status)

    def communicate(self, timeout=None):
        self.__exit__()
        texts = []
        for file in self.files:
            file.seek(0)
            texts.append(file.read().decode("utf-8", "surrogateescape"))
            file.close()
        return texts

    def kill(self):
        if self.returncode is None:
            os.kill(self.pid, signal.SIGKILL)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.returncode is None:
            self.returncode = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


def ran(words):
    """A command line run to its end: a CompletedProcess with its texts."""
    if not Warm.takes(words):
        return subprocess.run(words, capture_output=True, text=True)
    child = Warm(words)
    out, err = child.communicate()
    return subprocess.CompletedProcess(words, child.returncode, out, err)


def rows_of(file):
    """Number of rows of a record, also while it is being written, which HDF5 alone refuses to read; 0 before it can be read."""
    shown = subprocess.run([PROGRAM, "info", file], capture_output=True, text=True) if os.path.exists(file) else None
    found = shown and re.search(r"\n  rows +(\d+)", shown.stdout)
    return int(found[1]) if found else 0


TEXTS = ("status", "notes", "start", "start_state", "program", "hash", "error")


def cases_of(folder):
    """Rows of a sweep by case, finished or not: dicts by column, numbers where they are."""
    found = {}
    for name in [f"{folder}/results.csv"] if os.path.exists(f"{folder}/results.csv") else glob.glob(f"{folder}/rows-*.csv"):
        with open(name, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row["crc32"] is not None and len(row["crc32"]) == 8:  # not torn
                    row = {heading.partition(" [")[0]: cell for heading, cell in row.items()}
                    found[int(row["case"])] = {key: cell if key in TEXTS else float(cell) for key, cell in row.items() if key != "crc32"}
    return found


def fact(folder, name):
    """What the sweep.json of a folder says."""
    return json.loads(read(f"{folder}/sweep.json")).get(name)


def hash_in(text, name="results hash"):
    """Hash after that name in the output of a command."""
    return text.partition(name)[2].split()[0] if name in text else "none"


def hash_of(data):
    """engine::Hash of bytes: 64-bit FNV-1a."""
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return value


def chained(chain, word):
    mixed = chain ^ word
    mixed = (mixed ^ mixed >> 32) * 0x9e3779b97f4a7c15 % 2**64
    return (mixed << 29 | mixed >> 35) % 2**64


def checksum(data):
    """engine::Checksum of bytes: four chains of words, the last block filled up with zeros."""
    chains = [1, 2, 3, 4]
    for k, word in enumerate(np.frombuffer(data + bytes(32 - len(data) % 32), "<u8").tolist()):
        chains[k % 4] = chained(chains[k % 4], word)
    total = len(data)
    for chain in chains:
        total = chained(total, chain)
    return total ^ total >> 32


def unsealed(path):
    """Bytes of a file of ours without its seal."""
    data = Path(path).read_bytes()
    return data[:-32] if data[-32:-24] == b"CVTFSEAL" else data


def forge(path, change):
    """Changes a file through HDF5 and seals it again."""
    Path(path).write_bytes(unsealed(path))
    with h5py.File(path, "r+", libver=("v108", "v110"), locking=False) as file:
        change(file)
    data = Path(path).read_bytes()
    mark = b"CVTFSEAL" + len(data).to_bytes(8, "little") + checksum(data).to_bytes(8, "little")
    Path(path).write_bytes(data + mark + checksum(mark).to_bytes(8, "little"))


def csv_of(file):
    """Points of a CSV of pictures by plot and series."""
    points = {}
    with open(file, newline="", encoding="utf-8") as opened:
        for row in csv.DictReader(opened):
            points.setdefault((row["plot"], row["series"]), []).append((float(row["x"]), float(row["y"])))
    return {key: np.array(value) for key, value in points.items()}


SWEEP = """[sweep]
scene = "tiny"
[set]
run.until = "{until}"
run.step = "50 ns"
start.settling_time = "20 us"
start.ramp_time = "10 us"
{set}[[axes]]
key = "load.torque"
values = [{torques}]
[[axes]]
key = "clamping.driven"
from = "5 kN"
to = "6 kN"
count = 4
[outputs]
scalars = ["slip mean", "tight_tension max", "ratio at 20 us"]
{outputs}[start]
mode = "{mode}"
{more}"""


def write_sweep(torques="6, 12, 18", until="40 us", more="", name="sweep.toml", **others):
    """A sweep that takes a second: `torques` x 4 cases of tiny."""
    write(name, SWEEP.format(torques=torques, until=until, more=more, **{"set": "", "outputs": "", "mode": "settle"} | others))


class Program(unittest.TestCase):
    """Each test is in an empty folder, or in one with the files that make() leaves, which the tests of a class share as copies."""

    maxDiff = None

    def make(self):
        pass

    @classmethod
    def setUpClass(cls):
        cls.made = None

    def setUp(self):
        folder = Path(tempfile.gettempdir(), f"cvtflow_test_{os.getpid()}")  # the same for all: checkpoints contain it
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder)
        if type(self).made is None:
            self.make()
            kept = tempfile.TemporaryDirectory(prefix="cvtflow_files_")
            type(self).made = kept
            self.addClassCleanup(kept.cleanup)
            shutil.copytree(folder, kept.name, symlinks=True, dirs_exist_ok=True)
        else:
            shutil.copytree(type(self).made.name, folder, symlinks=True, dirs_exist_ok=True)

    def start(self, line, **environment):
        """A child that is killed with the test."""
        words = words_of(line)
        child = Warm(words) if not environment and Warm.takes(words) else subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, encoding="utf-8", errors="surrogateescape",
            env=os.environ | environment)
        self.enterContext(child)
        self.addCleanup(child.kill)
        return child

    def wait(self, child, status=0):
        """Its output once it has ended with that status, 128 + signal if one ended it; None: any."""
        child.out, child.err = child.communicate(timeout=300)
        child.status = child.returncode if child.returncode >= 0 else 128 - child.returncode
        if status is not None:
            self.assertIn(child.status, status if isinstance(status, tuple) else (status,), f"{child.args}: {child.err}{child.out}")
        return child

    def cvtflow(self, line, status=0, **environment):
        """Runs a command line to its end."""
        return self.wait(self.start(line, **environment), status)

    def out(self, line, status=0):
        return self.cvtflow(line, status).out

    def err(self, line, status=1):
        return self.cvtflow(line, status).err

    def ended_when(self, child, condition, signal, status):
        """Sends a signal once the condition holds, or lets the child end before."""
        self.assertTrue(eventually(lambda: child.poll() is not None or condition()), child.args)
        child.send_signal(signal)
        return self.wait(child, status)

    def shell(self, line, status=0):
        """Runs a line of bash; $CVTFLOW is the program."""
        done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, env=os.environ | {"CVTFLOW": str(PROGRAM)})
        self.assertEqual(done.returncode, status, line + done.stderr)
        return done

    def has(self, text, *parts):
        for part in parts:
            self.assertTrue(part in text, f"missing: {part}\nin: {text[:3000]}")

    def lacks(self, text, *parts):
        for part in parts:
            self.assertFalse(part in text, f"contained: {part}\nin: {text[:3000]}")

    def matches(self, text, *expressions):
        for each in expressions:
            self.assertRegex(text, each)

    def batch(self, more="", status=0, folder="out"):
        return self.cvtflow(f"batch sweep.toml -o {folder} {more}", status)

    def column(self, name, folder="out"):
        """Values of a column of a sweep by case."""
        return {number: row[name] for number, row in sorted(cases_of(folder).items())}


def main():
    unittest.main()
