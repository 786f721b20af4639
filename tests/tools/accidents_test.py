"""What happens by accident to files, as one table of a command and an accident: kill -9, a power cut, a full disk, a call that fails, a
flipped bit, two commands at one name, a frozen worker, a clock that is set back. Each command ends with a message, or with the result of
one that nothing disturbed, or goes on to it; what was there stays. Files of others at a name: tests/tools/files_test.py."""

import itertools
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from program import (BRIEFLY, BUILD, PROGRAM, SETTLING, TO_BE_ENDED, Program, cases_of, contents, depth, eventually, hash_in, main, preload,
                     read, with_faults, write, write_sweep)

RIGID = "run tiny -q --until '60 ms' --detail rigid --set run.method=leapfrog-rigid --set 'run.step=2 us' --set run.schedule=serial"
ON = 'if [ -e r.checkpoint ]; then "$CVTFLOW" resume r.checkpoint -q; elif [ ! -e r.h5 ]; then "$CVTFLOW" {} --force; fi'
BATCH = "batch ../sweep.toml -o out --threads 1"
# Command: its processes, their line, what goes on after an accident.
RUNS = {"run": f"{TO_BE_ENDED} -o r.h5 --checkpoint-every '5 ms'", "run of rigid pins": f"{RIGID} -o r.h5 --checkpoint-every '20 ms'"}
WORKS = {**{name: (1, line, ON.format(line)) for name, line in RUNS.items()},
         "batch": (1, BATCH, f'"$CVTFLOW" {BATCH}'), "three workers": (3, BATCH, f'"$CVTFLOW" {BATCH}')}
TOP = f"{tempfile.gettempdir()}/cvtflow_test_{os.getpid()}"  # of Program
FULL_DISK = """mount -t tmpfs -o size=$SIZE tmpfs work && cp -r work_before/. work && cd work || exit 77
bash -c "$LINE" >../log 2>&1 || { [ $? -eq 1 ] && grep -q "No space left" ../log; } || { cat ../log >&2; exit 1; }
mount -o remount,size=1g tmpfs . && bash -c "$ON" >../log 2>&1 || { cat ../log >&2; exit 2; }
cp -r . ../after"""
POWER = BUILD / "tests/libcvtflow_power.so"
# Files of a user in the folder of a sweep.
MINE = ("notes.txt", "claims/mine", "continuation/notes.md", "rows.csv", "results.txt", "records/mine.h5", "records/case-7.h5",
        "states/readme")


class Disk:
    """What a power cut leaves of files, by the log of tests/faults/power.c. Of what was not synced nothing is left, names only with their
    folder; journalled, as file systems do: a sync brings all names before it to disk, later ones follow in order, of bytes some pages."""

    def __init__(self, folder, journalled):
        self.journalled, self.waiting = journalled, []
        self.files, self.folders, self.names, self.durable = {}, {os.stat(folder).st_ino: folder}, {}, {}

    @staticmethod
    def changes(log, folder):
        """Changes below a folder: what, inode, and place and bytes, or names."""
        data, at, found = Path(log).read_bytes(), 0, []
        while at < len(data):
            end = data.index(b"\n", at)
            what, inode, rest = data[at:end].decode().split(" ", 2)
            at = end + 1
            if what in ("write", "size", "sync", "syncfs"):
                place, count = map(int, rest.split())
                size = count if what == "write" else 0
                found.append((what, int(inode), place, data[at:at + size]))
                at += size
            elif rest.startswith(folder + "/"):
                found.append((what, int(inode), *map(os.path.normpath, rest.split("\t"))))
        return found

    @staticmethod
    def carry_out(data, what, at, new):
        if what == "size":
            data[at:] = bytes(max(0, at - len(data)))
        else:
            data.extend(bytes(max(0, at + len(new) - len(data))))
            data[at:at + len(new)] = new

    @staticmethod
    def name(names, what, file, path, to=None):
        if what == "remove":
            names.pop(path, None)
        elif what != "rename":
            names[path] = file
        elif path in names:
            names[to] = names.pop(path)

    def add(self, what, inode, *rest):
        if what in ("create", "mkdir"):
            self.files[inode] = {"now": bytearray(), "kept": b"", "since": [], "folder": what == "mkdir"}
            if what == "mkdir":
                self.folders[inode] = rest[0]
        file = self.files.get(inode)
        if what in ("sync", "syncfs"):
            for each in [inode] if what == "sync" else list(self.files):
                self.sync(each)
            self.durable = dict(self.names) if what == "syncfs" else self.durable
        elif what not in ("write", "size"):
            self.waiting.append((what, file, *rest))
            self.name(self.names, *self.waiting[-1])
        elif file:
            self.carry_out(file["now"], what, *rest)
            file["since"].append((what, *rest))

    def sync(self, inode):
        if file := self.files.get(inode):
            file["kept"], file["since"] = bytes(file["now"]), []
        if self.journalled:
            for each in self.waiting:
                self.name(self.durable, *each)
            self.waiting = []
        elif folder := self.folders.get(inode):
            def inside(item):
                return os.path.dirname(item[0]) == folder

            self.durable = dict([*itertools.filterfalse(inside, self.durable.items()), *filter(inside, self.names.items())])

    def write(self, chance):
        for each in self.waiting[:chance.randrange(len(self.waiting) + 1)] if self.journalled else ():
            self.name(self.durable, *each)
        for path, file in sorted(self.durable.items()):  # folders come before what is in them
            if file["folder"]:
                os.makedirs(path, exist_ok=True)
            elif os.path.isdir(os.path.dirname(path)):
                data = bytearray(file["kept"])
                for what, at, new in file["since"] if self.journalled else ():
                    for page in range(0, max(1, len(new)), 4096):
                        if chance.randrange(2):
                            self.carry_out(data, what, at + page, new[page:page + 4096])
                Path(path).write_bytes(data)


class _Works(Program):
    """Commands that work in a folder of their own, beside the results of undisturbed ones."""

    def make(self):
        write_sweep("6, 9, 12", "80 us", outputs="records = true\n")
        for name in WORKS:
            if name != "three workers":
                self.begin(name)
                begin = time.monotonic()
                self.cvtflow(WORKS[name][1])
                seconds = time.monotonic() - begin
                write("../seconds " + name, f"{seconds}")
                os.chdir(TOP)
                os.rename("work", f"whole {name}")

    def begin(self, name):
        """An empty folder to work in, with a user's files in a sweep's."""
        os.chdir(TOP)
        shutil.rmtree("work", ignore_errors=True)
        os.mkdir("work")
        os.chdir("work")
        for each in MINE if "out" in WORKS[name][1] else ():
            write(f"out/{each}", f"mine: {each}")

    def whole(self, name):
        return f"{TOP}/whole {name.replace('three workers', 'batch')}"

    def right(self, name):
        """The result is that of an undisturbed command, and the user's files are there."""
        if "out" in WORKS[name][1]:
            self.assertEqual(hash_in(self.out("info out")), hash_in(self.out(f"info '{self.whole(name)}/out'")))
            self.assertEqual([read(f"out/{each}") for each in MINE], [f"mine: {each}" for each in MINE])
            self.assertTrue(all(os.path.exists(f"out/records/case-{number:06}.h5") for number in range(12)))
        else:
            expected, found = contents(f"{self.whole(name)}/r.h5"), contents("r.h5")
            self.assertEqual([each for each in {*expected, *found} if expected.get(each) != found.get(each)], [])
            self.assertEqual(os.listdir(), ["r.h5"])

    def goes_on(self, name):
        self.shell(WORKS[name][2])
        self.right(name)

    def killed(self, name, kills, chance):
        """One of the processes is killed at a moment that is drawn; the others end, and what is left goes on."""
        count, line, _ = WORKS[name]
        for _ in range(kills):
            self.begin(name)
            children = [self.start(line) for _ in range(count)]
            time.sleep(chance.random() * float(read(self.whole(name).replace("whole", "seconds"))))
            dies = children.pop(chance.randrange(count))
            dies.send_signal(signal.SIGKILL)
            self.wait(dies, (128 + signal.SIGKILL, 0))
            for each in children:
                self.wait(each)
                self.right(name)
            self.goes_on(name)

    def power_cut(self, name, cuts, chance):
        """The power fails after a number of changes that is drawn, one in each of as many equal parts."""
        _, line, on = WORKS[name]
        self.begin(name)
        log = f"{TOP}/changes"
        Path(log).unlink(missing_ok=True)
        self.cvtflow(line, LD_PRELOAD=preload(POWER), CVTFLOW_POWER_LOG=log)
        changes, refused = Disk.changes(log, os.getcwd()), 0
        for cut in range(cuts):
            self.begin(name)
            disk = Disk(os.getcwd(), cut % 2 == 1)
            for change in changes[:int((cut + chance.random()) * len(changes) / cuts)]:
                disk.add(*change)
            disk.write(chance)
            done = subprocess.run(["bash", "-c", on], capture_output=True, text=True, env=os.environ | {"CVTFLOW": str(PROGRAM)})
            if done.returncode == 0:
                self.right(name)
                continue
            refused += 1  # what HDF5 cannot read of a record whose pages were written in part
            self.assertTrue(disk.journalled and done.returncode == 1 and "out" not in line, f"cut {cut}: {done.stderr}")
            self.matches(done.stderr, r"\Acvtflow: r\.\S*h5\S*: ")
        self.assertLessEqual(refused, cuts // 3)

    def full_disk(self, name, disks, chance):
        """The disk has room for a part of what is written, and later for all."""
        _, line, on = WORKS[name]
        largest = sum(path.stat().st_size for path in Path(self.whole(name)).rglob("*") if path.is_file()) // 1024
        for _ in range(disks):
            self.begin(name)
            size = f"{chance.randrange(64, max(128, largest))}k"
            os.chdir(TOP)
            shutil.rmtree("work_before", ignore_errors=True)
            shutil.copytree("work", "work_before")
            alone = "-m" if os.geteuid() == 0 else "-rm"
            done = subprocess.run(["unshare", alone, "bash", "-c", FULL_DISK], capture_output=True, text=True,
                                  env=os.environ | {"CVTFLOW": str(PROGRAM), "LINE": f'"$CVTFLOW" {line}', "ON": on, "SIZE": size})
            if done.returncode == 77:
                self.skipTest("no file system may be mounted here")
            self.assertEqual(done.returncode, 0, f"{name} on {size}: {done.stderr}")
            shutil.rmtree("work")
            os.rename("after", "work")
            os.chdir("work")
            self.right(name)


class Accidents(_Works):
    def test_a_killed_command_goes_on_to_the_same_result(self):
        for name in WORKS:
            self.killed(name, depth(1, 5), random.Random(1))

    @with_faults
    def test_a_power_cut_leaves_what_leads_to_the_same_result(self):
        for name in ("run", "batch"):
            self.power_cut(name, depth(3, 20), random.Random(2))

    def test_a_full_disk_is_a_message_and_later_the_same_result(self):
        for name in ("run", "batch"):
            self.full_disk(name, depth(1, 5), random.Random(3))

    def test_of_two_commands_at_one_name_the_second_is_refused_with_the_process_of_the_first(self):
        self.begin("run")
        first = self.start(f"{TO_BE_ENDED} -o r.h5")
        self.assertTrue(eventually(lambda: os.path.exists("r.h5.part")))
        for more in ("", " --force"):
            self.has(self.err(f"{TO_BE_ENDED} -o r.h5{more}"), f"r.h5.part: cannot create: process {first.pid} is writing it\n")
        self.wait(first)
        self.right("run")

    def test_beside_a_frozen_process_another_waits_for_it_and_both_have_the_same_result(self):
        self.begin("batch")
        frozen = self.start(BATCH)

        def send(what):
            for child in read(f"/proc/{frozen.pid}/task/{frozen.pid}/children").split():
                os.kill(int(child), what)

        def freezes_in_a_case():  # between two cases there is nothing to wait for
            send(signal.SIGSTOP)
            time.sleep(0.01)
            if cases_of("out") and {int(each.name) for each in Path("out/claims").glob("[0-9]*")} - cases_of("out").keys():
                return True
            send(signal.SIGCONT)

        self.assertTrue(eventually(freezes_in_a_case))
        other = self.start(BATCH)
        self.assertTrue(eventually(lambda: len(cases_of("out")) >= 11))
        time.sleep(0.3)
        self.assertIsNone(other.poll(), "it waits for the last case")
        send(signal.SIGCONT)
        self.assertEqual(*(hash_in(self.wait(each).out) for each in (frozen, other)))
        self.right("batch")

    def test_of_more_processes_than_cases_that_begin_together_each_has_the_same_result(self):
        write_sweep("6", "20 us")
        children = [self.start("batch sweep.toml -o out --threads 1") for _ in range(6)]
        self.assertEqual(len({hash_in(self.wait(each).out) for each in children}), 1)
        self.assertEqual([each for each in os.listdir("out") if each.endswith(".part")], [])

    @with_faults
    def test_a_clock_that_is_set_back_changes_no_result(self):
        for name, (count, line, _) in WORKS.items():
            self.begin(name)
            for child in [self.start(line, LD_PRELOAD=preload(), CVTFLOW_CLOCK="5") for _ in range(count)]:
                self.wait(child)
            self.right(name)


class NightlyAccidents(_Works):
    """tools/check/accidents"""

    counts = [int(count) for count in os.environ.get("CVTFLOW_ACCIDENTS", "200 40 20").split()]

    def shared(self, what, count, accident, names):
        begin = time.monotonic()
        for number, name in enumerate(names):
            accident(name, count // len(names) + (number < count % len(names)), random.Random(number))
        print(f"{count} {what}: the same results, in {time.monotonic() - begin:.0f} s")

    def test_kills(self):
        self.shared("kills", self.counts[0], self.killed, list(WORKS))

    @with_faults
    def test_power_cuts(self):
        self.shared("power cuts", self.counts[1], self.power_cut, ("run", "batch"))

    def test_full_disks(self):
        self.shared("full disks", self.counts[2], self.full_disk, ("run", "batch"))


SHORT = f"--until '20 us' --step '50 ns' {SETTLING} --set run.schedule=serial"
CALLS = ("open", "read", "write", "fsync", "rename", "fork")
# Commands that read and write every kind of file of ours; those behind "resume" only in depth.
LINES = ("run scene.toml -o new.h5 --checkpoint-every '1 ms'", "batch sweep.toml -o new --threads 1", "check scene.toml",
         "resume old.checkpoint -q --set run.max_steps=0", "table old --csv", "info record.h5", "settle scene.toml -q -o new.h5",
         "export record.h5 --csv new.csv", "export-fmu scene.toml -q -o new.fmu")
READERS = (("record.h5", "info {}"), ("record.h5", "plot {} slip -o p.csv --force"), ("a.state", "check tiny --set start.state={}"),
           ("old.checkpoint", "resume {} -q -o none"), ("old/results.csv", "table {}"))


def results(line, out):
    """What a command prints but times and names: hashes, or every line of those that compute nothing."""
    if line.split()[0] in ("check", "table", "info"):
        return [each for each in out.split("\n") if not each.startswith("  time ")]
    return re.findall(r"\b[0-9a-f]{16}\b", out)


class FailingCalls(Program):
    def make(self):
        write("scene.toml", '[chain]\npins = 24\npitch = "16.6 mm"\n[plate]\ncount = 4\n[pulley]\ncentre_distance = "100 mm"\n[detail]\n'
                            'level = "fine"\nplates = "lumped"\n' + "#" * 20000 + '\n[start]\nsettling_time = "20 us"\n'
                            'ramp_time = "10 us"\n[run]\nuntil = "20 us"\nstep = "50 ns"\nmethod = "rk4"\n')
        self.cvtflow(f"run tiny -q -o record.h5 {SHORT}")
        self.cvtflow(f"run tiny -q -o old.h5 --checkpoint-every '1 h' --set run.max_steps=50 {SHORT}", 4)
        self.cvtflow("settle tiny -q -o a.state --time 20us --set start.ramp_time=10us")
        write_sweep("6", "20 us")
        self.batch("-q", folder="old")

    def again(self):
        """The folder as make() left it, and its files that no command may change."""
        for path in Path(".").iterdir():
            (shutil.rmtree if path.is_dir() else os.remove)(path)
        shutil.copytree(type(self).made.name, ".", dirs_exist_ok=True)
        return {path: path.read_bytes() for path in Path(".").rglob("*") if path.is_file() and not path.name.startswith("old.")
                and path.name != "lock"}

    def outcome(self, line, fault=""):
        """Output and errors of a command in which a call fails, its kept files checked."""
        before = self.again()
        done = self.cvtflow(line, None, LD_PRELOAD=preload(), OMP_WAIT_POLICY="passive", CVTFLOW_FAULT=fault)
        where = f"{line}, {fault}: {done.status}\n{done.err}"
        self.assertIn(done.status, (0, 1, 2, 4, 5), where)
        self.assertEqual([str(path) for path in before if not path.is_file() or path.read_bytes() != before[path]], [], where)
        self.assertTrue(done.status == 0 or done.err, where)
        return done

    @with_faults
    def test_a_call_that_fails_is_reported_or_changes_nothing(self):
        reported = dict.fromkeys(CALLS, 0)
        for line in LINES[:depth(4, len(LINES))]:
            expected = results(line, self.outcome(line).out)
            for call in CALLS:
                for n in depth((1, 2, 5, 20), range(1, 40)):
                    done = self.outcome(line, f"{call}:{n}")
                    reported[call] += done.status != 0
                    if done.status == 0:
                        self.assertEqual(results(line, done.out), expected, f"{line}, {call}:{n}")
                    if os.path.exists("new.h5"):
                        self.cvtflow("info new.h5")
                    if os.path.exists("new/results.csv"):
                        self.cvtflow("table new")
        self.assertTrue(all(reported.values()), reported)

    def test_a_flipped_bit_of_a_file_is_a_message(self):
        chance = random.Random(1)
        for name, line in READERS:
            good, count = Path(name).read_bytes(), depth(5, 40)
            end = len(good) - 33  # behind it is the checksum
            first = good.find(b"\n") + 1 if name.endswith(".csv") else 0  # each line has a checksum, but the heading
            self.cvtflow(line.format(name.removesuffix("/results.csv")), (0, 4))
            for k in range(count):  # from the first byte to the last
                bad = bytearray(good)
                bad[first + k * (end - first) // (count - 1)] ^= 1 << chance.randrange(8)
                Path(name).write_bytes(bad)
                self.has(self.err(line.format(name.removesuffix("/results.csv"))), f"{name}:")
            Path(name).write_bytes(good)

    def test_a_garbled_command_line_is_refused_or_runs(self):
        chance = random.Random(2)
        lines = [line.split() for line in (f"run {BRIEFLY} -o new.h5 --force", "check tiny --json", "list methods --all", "table old --csv",
                                           "info record.h5", "explain run.step", "plot record.h5 slip -o p.svg --force")]
        for _ in range(depth(40, 1000)):
            line = list(chance.choice(lines))
            for _ in range(1 + chance.randrange(3)):
                at, other = chance.randrange(len(line)), chance.choice(chance.choice(lines))
                odd = (other, "", "\xff", "--", "-", "=", line[at] * 3, line[at][:-1], "nan us")
                line[at:at + chance.randrange(2)] = [chance.choice(odd)]
            self.again()
            done = self.cvtflow([word.strip("'") for word in line], None)
            self.assertIn(done.status, (0, 1, 2, 3, 4), line)
            self.assertTrue(done.status == 0 or "cvtflow" in done.err, f"{line}: {done.err}")


if __name__ == "__main__":
    main()
