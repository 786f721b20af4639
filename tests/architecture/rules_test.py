"""Rules of includes, and of the places that may name threads and third parties; symbols of the kernels; one version everywhere.

    model  → std                                              bench, tests → everything; tools → all but bench and tests
    engine → std, POSIX, fmt (.cpp), HDF5 in engine/record (.cpp), oneTBB and OpenMP in engine/executor and engine/thread (.cpp)
    tasks  → model, engine, std, any third party (.cpp)
    api    → model, engine, tasks, std; its public headers (api/include) → std and one another
    only threads, locks and atomics: engine/executor and engine/thread only

A header that includes a third party, itself or through another one, is private: only files of the same room (engine/record with all its
folders, say) and tests include it. Rooms of a part stand on floors: includes point downwards, and never in a circle.
"""

import functools
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parents[2]
FOLDERS = ("model", "engine", "tasks", "api", "tools", "bench", "examples", "tests")
# Parts of this project that a part may include.
FRIENDS = {"model": {"model"}, "engine": {"engine"}, "tasks": {"model", "engine", "tasks"}, "api": {"model", "engine", "tasks", "api"}}
THREAD_HEADERS = {"atomic", "barrier", "condition_variable", "future", "latch", "mutex", "semaphore", "shared_mutex", "stop_token",
                  "thread", "pthread.h"}
SYSTEM_HEADERS = {"dlfcn.h", "fcntl.h", "poll.h", "pthread.h", "sched.h", "unistd.h", "windows.h", "immintrin.h"}  # ship with the compiler
# Floors of a part's rooms, the ground floor first; what stands on one floor does not know its neighbours.
FLOORS = {
    "model": ["basis", "parameters", "law", "machine", "force", "chain", "contact", "kernels", "rigid", "variator", "start", "observe"],
    "engine": ["base", "graph event thread", "method executor record", "alone"],
    "tasks": ["step", "method", "channel", "scene", "schedule sizing", "run", "batch"],
}


class _SourceFile(NamedTuple):
    path: str  # relative to the top level, with slashes
    text: str

    @property
    def header(self):
        return self.path.endswith(".hpp")

    @property
    def part(self):
        """Folder of the top level: "model", "engine" …"""
        return self.path.partition("/")[0]


class _Include(NamedTuple):
    line: int
    name: str
    quoted: bool


@functools.cache
def source_files():
    """All .cpp and .hpp files below the source folders, ascending by path."""
    paths = [path for folder in FOLDERS for path in (TOP / folder).rglob("*.[ch]pp")]
    return sorted(_SourceFile(path.relative_to(TOP).as_posix(), path.read_text(encoding="utf-8")) for path in paths)


def includes_of(text):
    found = re.compile(r"\s*#\s*include\s*([<\"])([^>\"]+)[>\"]")
    matches = ((number, found.match(line)) for number, line in enumerate(text.split("\n"), 1))
    return [_Include(number, match[2], match[1] == '"') for number, match in matches if match]


def third_party(name):
    """Third party behind a header in angle brackets; empty for the standard library, POSIX and our public headers."""
    if name in SYSTEM_HEADERS or name.startswith(("sys/", "cvtflow/")):
        return ""
    for party, beginnings in (("OpenMP", "omp.h"), ("HDF5", ("hdf5", "H5")), ("oneTBB", ("tbb/", "oneapi/")), ("Eigen", "Eigen")):
        if name.startswith(beginnings):
            return party
    return name.partition("/")[0] if "." in name or "/" in name else ""


def permitted(file):
    """Third parties that a file may include; "*" for any."""
    if file.path.startswith("engine/record/"):
        return {"fmt", "HDF5", "zlib.h"}
    if file.path.startswith(("engine/executor/", "engine/thread/")):
        return {"fmt", "oneTBB"}
    if file.path == "api/c/describe.cpp":
        return {"nlohmann"}
    return {"tasks": {"*"}, "engine": {"fmt"}}.get(file.part, set())


def room_of(path):
    """engine/record of engine/record/hdf5/handle.hpp; engine/. of a file in engine itself."""
    names = path.split("/")
    return "/".join(names[:2]) if len(names) > 2 else names[0] + "/."


def included(files):
    """Every include of these files: the file, the include, and where it is."""
    return [(file, include, f"{file.path}:{include.line}: {include.name}") for file in files for include in includes_of(file.text)]


LIBRARY = [file for file in source_files() if file.part in FRIENDS]


def private_headers():
    """Headers of the library that include a third party, directly or through another such header."""
    hidden, before = set(), None
    while before != len(hidden):
        before = len(hidden)
        hidden |= {file.path for file, include, _ in included(file for file in LIBRARY if file.header)
                   if (include.name in hidden if include.quoted else third_party(include.name))}
    return hidden


class Rules(unittest.TestCase):
    """Tests that name every place where a rule is broken, up to a screen of them."""

    def none(self, places):
        self.assertEqual(list(places)[:40], [])


class IncludeRule(Rules):
    def test_parts_include_only_their_friends(self):
        self.none(where for file, include, where in included(LIBRARY)
                  if include.quoted and include.name.partition("/")[0] not in FRIENDS[file.part])

    def test_only_tests_and_itself_include_the_laboratory(self):
        """The product is built, and changed, without the code that measures it."""
        self.none(where for file, include, where in included(source_files())
                  if file.part not in ("bench", "tests") and include.name.startswith("bench/"))

    def test_third_parties_are_included_where_they_belong(self):
        parties = [(file, third_party(include.name), where) for file, include, where in included(LIBRARY) if not include.quoted]
        self.none(f"{where} is {party}" for file, party, where in parties if party and not permitted(file) & {party, "*"})
        self.assertGreater(len([party for _, party, _ in parties if party]), 20)

    def test_headers_that_include_third_parties_are_private(self):
        hidden = private_headers()
        self.assertGreater(len(hidden), 3)

        def may(file, include):  # further executors run in the same arenas
            further = file.path.startswith("bench/executor/") and include.name.startswith("engine/executor/")
            return further or file.part == "tests" or room_of(include.name) == room_of(file.path)

        self.none(where for file, include, where in included(source_files())
                  if include.quoted and include.name in hidden and not may(file, include))

    def test_rooms_stand_on_floors(self):
        floor = {f"{part}/{room}": number for part, floors in FLOORS.items()
                 for number, rooms in enumerate(floors) for room in rooms.split()}
        files = [file for file in LIBRARY if file.part in FLOORS]
        self.none(file.path for file in files if room_of(file.path) not in floor)
        self.none(f"{where} points upwards" for file, include, where in included(files)
                  if include.quoted and include.name.partition("/")[0] == file.part and room_of(include.name) != room_of(file.path)
                  and floor[room_of(file.path)] <= floor.get(room_of(include.name), -1))

    def test_public_headers_include_the_standard_library_and_one_another(self):
        self.none(where for file, include, where in included(file for file in LIBRARY if file.path.startswith("api/include/"))
                  if include.quoted or third_party(include.name)
                  or (include.name.endswith(".h") and not include.name.startswith("cvtflow/")))

    def test_threads_live_in_two_rooms(self):
        """Public headers are of hosts, whose threads read snapshots."""
        others = [file for file in LIBRARY if not file.path.startswith(("engine/executor/", "engine/thread/", "api/include/"))]
        self.none(where for _, include, where in included(others) if include.name in THREAD_HEADERS)
        self.none(file.path for file in others if re.search(r"^[^/\"\n]*\bthread_local\b|#pragma omp", file.text, re.MULTILINE))

    def test_headers_guard_themselves(self):
        self.none(file.path for file in source_files() if file.header and not file.text.startswith("#pragma once\n"))


class Release(Rules):
    """One version everywhere: tools/release compares, and writes, here into copies of its files."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for part in ("CMakeLists.txt", "CITATION.cff", "debian", "api/include", "api/python/cvtflow/_library.py", "docs/embedding.md",
                     "api/install/cvtflow-config.cmake.in", "docs/site/api.rst", "docs/windows.md", "examples/CMakeLists.txt",
                     "tests/api/consumer", "tools/release"):
            (self.folder / part).parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if (TOP / part).is_dir() else shutil.copy)(TOP / part, self.folder / part)

    def release(self, *arguments):
        done = subprocess.run([self.folder / "tools/release", *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def test_every_place_states_the_version_of_the_project_and_one_with_another_is_named(self):
        self.assertEqual(self.release()[0], 0)
        for stated, named in (("version: 0.0.9", "0.0.9"), ("no version", "nothing")):
            (self.folder / "CITATION.cff").write_text(stated + "\n")
            status, text = self.release()
            self.assertEqual((status, text.startswith(f"CITATION.cff: {named}, not ")), (1, True), text)

    def test_a_new_version_is_written_into_all_of_them(self):
        self.assertEqual(self.release("12.34.56"), (0, "12.34.56\n"))
        self.assertEqual(self.release()[0], 0)
        for file, words in (("CMakeLists.txt", r"project\(cvtflow VERSION 12.34.56 "), ("debian/changelog", r"\Acvtflow \(12.34.56\) unstable"),
                            ("api/include/cvtflow/version.hpp", r"VERSION_MINOR 34\n(.*\n)*inline namespace v12 "),
                            ("api/python/cvtflow/_library.py", r'"libcvtflow\.so\.12"\n')):
            self.assertRegex((self.folder / file).read_text(), words)
        self.assertEqual(self.release("12.34")[0], 2, "three numbers")


@unittest.skipUnless("CVTFLOW_NM" in os.environ, "sanitizers add symbols")
class DeepKernelSymbols(Rules):
    """The kernels are compiled once per instruction set. A function that two of these copies define under one name is shared by the linker,
    which may then put AVX-512 code where the baseline's is meant: on an older processor that is an illegal instruction, on none a test
    fails."""

    def entries(self, objects):
        """Functions that the kernels below a folder of objects show; none is a symbol that the linker merges."""
        files = [str(file) for folder in Path(objects).glob("cvtflow_kernels_*") for file in folder.rglob("*.o")]
        shown = subprocess.run([os.environ["CVTFLOW_NM"], "-A", "-C", "--defined-only", *files], capture_output=True, text=True).stdout
        symbols = re.findall(r"^(.*\.o):[0-9a-f]+ (\w) (.*)$", shown, re.MULTILINE)
        # DW.ref: the address of a run-time function, the same in every copy.
        self.none(f"{file}: {name}" for file, kind, name in symbols if kind in "WVu" and not name.startswith("DW.ref."))
        return len([kind for _, kind, _ in symbols if kind == "T"])

    def test_none_is_shared_between_instruction_sets(self):
        objects = Path(os.environ["CVTFLOW_BUILD"])
        self.assertGreaterEqual(self.entries(objects / "CMakeFiles"), 5)  # chain, friction, single and rigid kernels of one set at least
        self.assertGreaterEqual(self.entries(objects / "bench/staged/CMakeFiles"), 1)  # staged_kernels of the laboratory

    def test_no_multiply_add_is_fused_in_the_library(self):
        """One here and not there would make bits depend on instruction sets and on how sources are grouped; GCC 12 makes some in spite of
        -ffp-contract=off."""
        words = [os.environ["CVTFLOW_OBJDUMP"], "-d", "--no-show-raw-insn", os.environ["CVTFLOW_LIBRARY"]]
        code = subprocess.run(words, capture_output=True, text=True).stdout
        self.none(re.findall(r".*\t(?:vfm|vfnm).*", code))
        self.assertGreater(code.count("\n"), 100000)


if __name__ == "__main__":
    unittest.main()
