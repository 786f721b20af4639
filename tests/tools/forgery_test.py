"""Files forged by an attacker: sound for HDF5, with a right seal and right hashes, and false contents. Every command that reads them
survives every change of every object and attribute of a record, a state, a checkpoint and a table, drawn or all.

    forgery_test.py NightlyForgery [K/N]      a K-th of N parts; CVTFLOW_TEST_SEED=all: of all changes instead of a sample
"""

import os
import random
import resource
import shutil
import sys

import h5py
import numpy as np

from program import BRIEFLY, TO_BE_ENDED, Program, depth, forge, main, read, write, write_sweep

SEED = os.environ.get("CVTFLOW_TEST_SEED", "same")
PART = next((word for word in sys.argv[1:] if "/" in word), "1/1")
ONCE = "--set run.max_steps=20 -q"
# One of our files, and the commands that read it.
TARGETS = {
    "good.h5": ["info good.h5", "table good.h5 --rainflow ratio", "table good.h5 --rainflow links/tension[*] --csv", "plot good.h5",
                "plot good.h5 --orders -o p.csv", "plot good.h5 --losses", "plot good.h5 --round", "report good.h5",
                "report good.h5 cut.h5",
                "export good.h5 --csv wide.csv", "export good.h5 --vtk v.pvd"],
    "state.h5": ["info state.h5", "check tiny --set start.state=state.h5", f"run tiny -o none --set start.state=state.h5 {ONCE}",
                 "settle tiny -q -o again.h5 --time 10us --set start.state=state.h5"],
    "cut.checkpoint.h5": ["info cut.checkpoint.h5", f"resume cut.checkpoint.h5 -o none {ONCE}", f"resume cut.checkpoint.h5 {ONCE}"],
    "out/cases.h5": ["table out", "table out --csv", "report out", "plot out", "resume out -q", "merge out", "batch sweep.toml -o out -q"],
    "cut.h5": ["resume cut.checkpoint.h5 -q"],
    "shards/workers/0001/cases.h5": ["merge shards", "merge shards --partial"],
}
MARKUP, ESCAPES = b'A<img src=x onerror="window.ran=1">', b"\x1b]0;title\x07 =1+1"
ODD = (np.nan, np.inf, -np.inf, 1.7e308, -1.7e308, 5e-324, -0.0, 9.3e18, -1.0, 1e15)
BOMB = 1 << 24  # rows of zeros, deflated to some kilobytes


def link_again(file, path, *names):
    for name in names:
        file[path.encode().rpartition(b"/")[0] + b"/" + name] = file[path]


def replace(file, path, data):
    """Another object in the place of one."""
    del file[path]
    file[path] = data


def shaped(change):
    """A dataset of the same type, of zeros, in another shape."""
    def made(file, path):
        shape, kind = change(list(file[path].shape)), file[path].dtype
        del file[path]
        file.create_dataset(path, shape, kind)
    return made


def typed(kind):
    def made(file, path):
        shape = file[path].shape
        del file[path]
        file.create_dataset(path, shape, kind)
    return made


def filled(change):
    """Other numbers, where it has numbers."""
    def made(file, path):
        if file[path].dtype.kind in "fiu" and file[path].size:
            values = file[path][()]
            file[path][()] = change(np.atleast_1d(values).astype(float)).reshape(np.shape(values))
    return made


def swollen(file, path):
    del file[path]
    file.create_dataset(path, (BOMB, 1), "f8", chunks=(1 << 20, 1), compression=9)
    file[path][...] = np.zeros((BOMB, 1))


def ended(value):
    return filled(lambda v: np.append(v[:-1], value))


def resized(k, by):
    """A side of the shape, where there is one."""
    return shaped(lambda shape: [by(side) if place == k % len(shape) else side for place, side in enumerate(shape)] if shape else shape)


LINKS = {
    "missing": lambda file, path: file.pop(path),
    "linked to itself": lambda file, path: replace(file, path, h5py.SoftLink("/" + path)),
    "linked to the root": lambda file, path: replace(file, path, file["/"]),
    "linked to another file": lambda file, path: replace(file, path, h5py.ExternalLink("../victim.txt", "/y")),
    "with a name of markup": lambda file, path: (link_again(file, path, MARKUP), file.pop(path)),
    "with a name of escapes": lambda file, path: link_again(file, path, ESCAPES),
    "with a name of 60,000 bytes": lambda file, path: link_again(file, path, b"n" * 60_000),
    "under 3,000 names": lambda file, path: link_again(file, path, *(b"many%d" % k for k in range(3000))),
    "a group": lambda file, path: (file.pop(path), file.create_group(path)),
    "a number": lambda file, path: replace(file, path, 0.0),
}
DATASETS = {
    "of no rows": resized(0, lambda _: 0),
    "of one row": resized(0, lambda _: 1),
    "of twice the rows": resized(0, lambda side: 2 * side),
    "of wider rows": resized(-1, lambda side: side + 7),
    "of another rank": shaped(lambda shape: [*shape, 3]),
    "of rank 0": shaped(lambda _: ()),
    "of bytes": typed("u1"),
    "of long integers": typed(">i8"),
    "of short texts": typed("S3"),
    "of long texts": typed("S50000"),
    "of texts of any length": typed(h5py.string_dtype()),
    "swollen": swollen,
    "never written": lambda file, path: (file.pop(path), file.create_dataset(path, (1 << 24, 90), "f8", chunks=(65536, 90), compression=9)),
    "not a number": filled(lambda v: np.full_like(v, np.nan)),
    "huge": filled(lambda v: np.full_like(v, np.finfo(float).max)),
    "negative": filled(lambda v: np.full_like(v, -7)),
    "backwards": filled(lambda v: v[::-1]),
    **{f"ends with {value}": ended(value) for value in ODD},
}
ATTRIBUTES = {
    "missing": None, "of markup": b"</script><script>window.ran=1</script>", "of escapes": b"\x1b]0;title\x07\x1b[31mred",
    "a formula": b"=cmd|' /C calc'!A1", "of formats": b"%s%n%s%n", "of lines": b"line\nbreak\ttab", "of 60,000 bytes": b"x" * 60_000,
    "empty": b"",
    "a path": b"../victim.txt", "not UTF-8": b"\xff\xfe\xc0\x80 not UTF-8", "NaN": b"nan", "a huge number": b"1e300", "-1": b"-1",
    "text of a number": b"0.5", "a number": 0.0, "not a number": np.nan, "infinite": np.inf, "an array of 2,000": np.zeros(2000),
    "of no extent": h5py.Empty("f8"), "of any length": "",
}


TEXTS = [text for text in ATTRIBUTES.values() if isinstance(text, bytes)]
CELLS = {"f": ODD, "i": (-1, 0, 2**31, 2**62), "S": TEXTS}


def cells_of(name, kind):
    """(what, change) of every column of a table, each with every value that its cells can have."""
    for column in kind.names[:-1]:  # the last one is the check of its row
        for value in CELLS[kind[column].kind]:
            def make(file, column=column, value=value):
                rows = file[name][:]
                rows[column] = value
                file[name][:] = rows
            yield f"{name}, column {column}: {value!r}", make


def forgeries_of(path):
    """(what, change) of every object and every attribute of a file, each with every change that can be made to it."""
    found = []

    def attributes(file, name):
        for key in file[name].attrs:
            for change, value in ATTRIBUTES.items():
                def make(opened, name=name, key=key, value=value):
                    attrs = opened[name].attrs
                    del attrs[key]
                    if value is not None:
                        attrs[key] = np.bytes_(value) if isinstance(value, bytes) and value else value
                found.append((f"{name}, attribute {key}: {change}", make))

    with h5py.File(path, "r", locking=False) as file:
        attributes(file, "/")
        names = []
        file.visit(names.append)
        for name in names:
            changes = LINKS | DATASETS if isinstance(file[name], h5py.Dataset) else LINKS
            if changes != LINKS and file[name].dtype.names and "check" in file[name].dtype.names:
                found += cells_of(name, file[name].dtype)
            found += [(f"{name}: {change}", lambda opened, name=name, make=make: make(opened, name)) for change, make in changes.items()]
            attributes(file, name)
    return found


class _Forgeries(Program):
    def make(self):
        for line in (f"run {BRIEFLY} --settle -q -o good.h5 --until '40 us' --set run.state_interval=10us",
                     "settle tiny -q -o state.h5 --time 20us --set start.ramp_time=10us"):
            self.cvtflow(line)
        self.cvtflow(f"{TO_BE_ENDED} -o cut.h5 --checkpoint-every '1 h' --set run.max_steps=3000", 4)
        write_sweep("6")
        self.batch()
        for shard in ("1/2", "2/2"):
            self.batch(f"--shard {shard}", folder="shards")

    def survive(self, target, what, change):
        """Runs the commands on a forged copy of a file, in a separate folder. @return whether HDF5 makes the change"""
        shutil.copy(target, "forged")
        try:
            forge("forged", change)
        except (OSError, ValueError, TypeError, RuntimeError, KeyError):
            return False
        for line in TARGETS[target]:
            shutil.rmtree("lair", ignore_errors=True)
            os.mkdir("lair")
            write("victim.txt", "mine")
            for beside in ("good.h5", "cut.h5.part", "cut.h5", "cut.checkpoint.h5", "state.h5", "sweep.toml", "out", "shards"):
                if os.path.isdir(beside):
                    shutil.copytree(beside, f"lair/{beside}")
                elif os.path.exists(beside):
                    shutil.copy(beside, "lair")
            shutil.copy("forged", f"lair/{target}")
            os.chdir("lair")
            try:
                done = self.cvtflow(line, tuple(range(9)))
            finally:
                os.chdir("..")
            where = f"{line} on {target}, {what}: {done.err[:2000]}"
            self.assertNotIn("an error in this program", done.err, where)
            for text in (done.out, done.err):
                controls = [c for c in text if (ord(c) < 32 and c not in "\n\t") or 127 <= ord(c) < 160]
                self.assertEqual(controls, [], "control characters: " + where)
            self.assertEqual(read("victim.txt"), "mine", where)
            self.assertLessEqual(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 512 * 1024, where)
        return True

    def survive_drawn(self, count):
        every = [(target, *forgery) for target in TARGETS for forgery in forgeries_of(target)]
        draw = random.Random(f"{SEED}forgeries")
        drawn = every if SEED == "all" else draw.sample(every, count)
        number, parts = (int(word) for word in PART.split("/"))
        made = [self.survive(*forgery) for forgery in drawn[number - 1::parts]]
        print(f"{len(drawn)} of {len(every)} changes of objects and attributes, {made.count(False)} of these {len(made)} not possible")
        self.assertGreater(made.count(True), 0.5 * len(made))


class Forgery(_Forgeries):
    def test_neither_crashes_nor_swells_a_command(self):
        self.survive_drawn(depth(8, 40))


class NightlyForgery(_Forgeries):
    def test_neither_crashes_nor_swells_a_command(self):
        self.survive_drawn(5000)


class ForgedRecord(Program):
    """One change each, as it was found; the program must say what is wrong."""

    def make(self):
        self.cvtflow(f"run {BRIEFLY} -q -o good.h5 --set run.state_interval=10us")

    def refused(self, change, *rows):
        """Rows: command line on bad.h5, and its message; it takes no memory."""
        shutil.copy("good.h5", "bad.h5")
        forge("bad.h5", change)
        for line, why in rows:
            self.has(self.err(line), why)
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 512 * 1024)

    def test_of_states_that_are_not_finite_is_reported_without_them(self):
        self.refused(lambda file: DATASETS["not a number"](file, "states/y"),
                     ("export bad.h5 --vtk v.pvd", "bad.h5: state 0 is not finite"))
        self.cvtflow("report bad.h5")
        self.has(read("bad.html"), "has no states that this program can show")

    def test_without_phases_with_too_few_with_times_that_run_backwards_or_names_with_escapes_is_refused(self):
        none = "bad.h5: state 0 does not match its machine"
        self.refused(lambda file: file.pop("states/phases"), ("report bad.h5", none), ("export bad.h5 --vtk v.pvd", none))
        self.refused(lambda file: (file.pop("states/phases"), file.create_dataset("states/phases", (100, 3), "u1")), ("report bad.h5",
                                                                                                                      none))
        self.refused(lambda file: DATASETS["not a number"](file, "channels/time"), ("report bad.h5", "bad.h5: damaged: times do not "
                                                                                                     "increase"))
        self.refused(lambda file: file["channels/ratio"].attrs.__setitem__("units", np.bytes_(ESCAPES)), ("info bad.h5",
                                                                                                          "control characters"))

    def test_that_promises_more_than_it_has_takes_no_memory(self):
        more = "its data would need far more memory than the size of the file"
        self.refused(lambda file: swollen(file, "channels/ratio"),
                     ("info bad.h5", more), ("report bad.h5", more), ("table bad.h5 --rainflow ratio", more))
        self.refused(lambda file: file["channels/ratio"].attrs.__setitem__("units", np.bytes_(b"x" * 60_000)),
                     ("info bad.h5", "a name or description of 60000 bytes"))


if __name__ == "__main__":
    sys.argv = [word for word in sys.argv if word != PART]
    main()
