"""What happens by accident: a system call fails, a bit of a file flips, a command line is garbled. A command ends by itself with a status
that it has and a message, or with the result that it would have had; what was there stays."""

import os
import random
import re
import shutil
from pathlib import Path

from program import BRIEFLY, SETTLING, Program, depth, main, preload, with_faults, write, write_sweep

SHORT = f"--until '20 us' --step '50 ns' {SETTLING} --set run.schedule=serial"
CALLS = ("open", "read", "write", "fsync", "rename", "fork")
# Commands that read and write every kind of file of ours; those behind "resume" only in depth.
LINES = ("run scene.toml -o new.h5 --checkpoint-every '1 ms'", "batch sweep.toml -o new --threads 1", "check scene.toml",
         "resume old.checkpoint.h5 -q --set run.max_steps=0", "table old --csv", "info record.h5", "settle scene.toml -q -o new.h5",
         "export record.h5 --csv new.csv", "export-fmu scene.toml -q -o new.fmu")
READERS = (("record.h5", "info {}"), ("record.h5", "plot {} slip -o p.csv --force"), ("state.h5", "check tiny --set start.state={}"),
           ("old.checkpoint.h5", "resume {} -q -o none"), ("old/results.csv", "table {}"))


def results(line, out):
    """What a command prints but times and names: hashes, or every line of those that compute nothing."""
    if line.split()[0] in ("check", "table", "info"):
        return [each for each in out.split("\n") if not each.startswith("  time ")]
    return re.findall(r"\b[0-9a-f]{16}\b", out)


class Accidents(Program):
    def make(self):
        write("scene.toml", '[chain]\npins = 24\npitch = "16.6 mm"\n[plate]\ncount = 4\n[pulley]\ncentre_distance = "100 mm"\n[detail]\n'
                            'level = "fine"\nplates = "lumped"\n' + "#" * 20000 + '\n[start]\nsettling_time = "20 us"\n'
                            'ramp_time = "10 us"\n[run]\nuntil = "20 us"\nstep = "50 ns"\nmethod = "rk4"\n')
        self.cvtflow(f"run tiny -q -o record.h5 {SHORT}")
        self.cvtflow(f"run tiny -q -o old.h5 --checkpoint-every '1 h' --set run.max_steps=50 {SHORT}", 4)
        self.cvtflow("settle tiny -q -o state.h5 --time 20us --set start.ramp_time=10us")
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
