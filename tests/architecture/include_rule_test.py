"""Rules of includes, and of the places that may name threads and third parties.

    model  → std                                              bench, tests → everything; tools → all but bench and tests
    engine → std, POSIX, fmt (.cpp), HDF5 in engine/record (.cpp), oneTBB and OpenMP in engine/executor and engine/thread (.cpp)
    tasks  → model, engine, std, any third party (.cpp)
    api    → model, engine, tasks, std; its public headers (api/include) → std and one another
    only threads, locks and atomics: engine/executor and engine/thread only

A header that includes a third party, itself or through another one, is private: only files of the same room (engine/record with all its
folders, say) and tests include it. Rooms of a part stand on floors: includes point downwards, and never in a circle.
"""

from source_tree import Rules, code_only, includes_of, main, source_files

# Parts of this project that a part may include.
FRIENDS = {"model": {"model"}, "engine": {"engine"}, "tasks": {"model", "engine", "tasks"}, "api": {"model", "engine", "tasks", "api"}}
THREAD_HEADERS = {"atomic", "barrier", "condition_variable", "future", "latch", "mutex", "semaphore", "shared_mutex", "stop_token",
                  "thread",
                  "pthread.h"}
SYSTEM_HEADERS = {"dlfcn.h", "fcntl.h", "poll.h", "pthread.h", "sched.h", "unistd.h", "windows.h", "immintrin.h"}  # ship with the compiler
# Floors of a part's rooms, the ground floor first; what stands on one floor does not know its neighbours.
FLOORS = {
    "model": ["basis", "parameters", "law", "machine", "force", "chain", "contact", "kernels", "rigid", "variator", "start", "observe"],
    "engine": ["base", "graph event thread", "method executor record", "alone"],
    "tasks": ["step", "method", "channel", "scene", "schedule sizing", "run", "batch", "tuning"],
}


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
    if file.path.startswith("api/python/"):
        return {"pybind11"}
    if file.path.startswith("engine/record/"):
        return {"fmt", "HDF5"}
    if file.path.startswith(("engine/executor/", "engine/thread/")):
        return {"fmt", "oneTBB"}
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
        others = [file for file in LIBRARY if not file.path.startswith(("engine/executor/", "engine/thread/"))]
        self.none(where for _, include, where in included(others) if include.name in THREAD_HEADERS)
        self.none(file.path for file in others if "thread_local" in code_only(file.text) or "#pragma omp" in file.text)

    def test_headers_guard_themselves(self):
        self.none(file.path for file in source_files() if file.header and not file.text.startswith("#pragma once\n"))

    def test_third_parties_are_recognised(self):
        for name, party in (("vector", ""), ("unistd.h", ""), ("sys/stat.h", ""), ("Eigen/Dense", "Eigen"), ("hdf5_hl.h", "HDF5"),
                            ("oneapi/tbb/flow_graph.h", "oneTBB"), ("omp.h", "OpenMP"), ("fmt/format.h", "fmt")):
            self.assertEqual(third_party(name), party, name)


if __name__ == "__main__":
    main()
