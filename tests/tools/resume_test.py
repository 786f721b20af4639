"""Runs and sweeps that are told to end, by a signal or a budget, and continue bit for bit. Kills: accidents_test.py."""

import glob
import os
import re
import shutil
import signal
from pathlib import Path

from program import (SETTLING, TO_BE_ENDED, Program, attribute, cases_of, channel, contents, eventually, hash_in, main, read, rows_of,
                     write, write_sweep)

KILLED, STOPPED = 128 + signal.SIGKILL, 130
BUDGET = "--checkpoint-every '1 h' --set run.max_steps=500"


def has(*files):
    return all(os.path.exists(file) for file in files)


class Resume(Program):
    def same(self, left, right):
        left, right = contents(left), contents(right)
        self.assertEqual([name for name in {*left, *right} if left.get(name) != right.get(name)], [])
        self.assertEqual(right["status"], b"finished")

    def test_a_run_that_is_told_to_end_leaves_a_whole_record_and_continues_bit_for_bit(self):
        self.cvtflow(f"{TO_BE_ENDED} --until '0.6 ms' -o whole.h5")
        for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU", "SIGPIPE"):
            child = self.start(f"{TO_BE_ENDED.replace('-q', '')} --until '0.6 ms' -o cut.h5 --checkpoint-every '5 ms'")
            self.assertTrue(eventually(lambda: rows_of("cut.h5.part") > 0))
            for _ in range(1 + (name in ("SIGXCPU", "SIGPIPE"))):  # they come again, which is no insisting
                child.send_signal(getattr(signal, name))
            self.assertTrue(self.wait(child, STOPPED).out.startswith("tiny: stopped: cancelled at t = "), name)
            self.assertEqual((has("cut.checkpoint"), has("cut.h5.part")), (True, False), name)
            self.assertTrue(attribute("cut.h5", "status").startswith("cancelled at t = "), name)
            self.cvtflow("info cut.h5")
            self.cvtflow("resume cut.checkpoint tiny -q --set start.settling_time=100us", 1)
            self.cvtflow("resume cut.checkpoint -q")
            self.same("whole.h5", "cut.h5")
            os.remove("cut.h5")

    def test_a_limit_of_processor_time_leaves_a_checkpoint(self):
        self.shell('ulimit -S -t 1; "$CVTFLOW" run tiny -o r.h5 -q --until 1s --set run.schedule=serial --checkpoint-every 1h', STOPPED)
        self.assertTrue(has("r.checkpoint"))

    def test_a_hangup_that_is_ignored_stays_ignored(self):
        before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # inherited by the child
        child = self.start(f"run tiny -o r.h5 -q --until '1 ms' {SETTLING}")
        signal.signal(signal.SIGHUP, before)
        self.assertTrue(eventually(lambda: has("r.h5.part")))  # by then handlers are set
        ignored = int(re.search("SigIgn:\t(.*)", read(f"/proc/{child.pid}/status"))[1], 16)
        self.assertTrue(ignored & 1 << signal.SIGHUP - 1)
        child.send_signal(signal.SIGHUP)
        self.wait(child)
        self.assertEqual(attribute("r.h5", "status"), "finished")

    def test_a_killed_run_leaves_a_readable_part(self):
        child = self.start(f"{TO_BE_ENDED} -o r.h5 --until '1 s' --checkpoint-every '5 ms'")
        self.ended_when(child, lambda: rows_of("r.h5.part") > 0, signal.SIGKILL, KILLED)
        self.assertFalse(has("r.h5"))
        self.has(self.out("info r.h5.part"), "running (still being written, or left by a killed run)")

    def test_in_a_mean_between_outputs_or_around_a_sheave_that_is_held_continues_bit_for_bit(self):
        means = ("tiny -q --set run.method=auto --until '2 ms' --set 'run.output_interval=0.5 ms' --set 'run.state_interval=1 ms' --set "
                 "record.means=true")
        steady = ("control -q --set detail.level=rigid --set start.state= --set 'start.settling_time=10 ms' --set 'drive.speed=4000 rpm' "
                  "--set 'run.steady=20 %' --set control.when_steady=hold --until steady")
        between = "baseline -q --set detail.level=rigid --set 'start.settling_time=6 ms' --until 8ms --set 'run.output_interval=10 us'"
        for scene, cuts in ((means, (1000,)), (between, (870, 950, 1033)), (steady, (2000, 3800, 8500))):
            self.cvtflow(f"run {scene} -o whole.h5 --force")
            for steps in cuts:
                self.cvtflow(f"run {scene} -o cut.h5 --force --checkpoint-every '1 h' --set run.max_steps={steps}", 4)
                self.cvtflow("resume cut.checkpoint -q --set run.max_steps=0")
                self.same("whole.h5", "cut.h5")

    def test_refuses_another_scene_and_names_the_difference(self):
        self.cvtflow(f"{TO_BE_ENDED} -o whole.h5")
        self.cvtflow(f"{TO_BE_ENDED} -o cut.h5 --until '20 us'")
        self.cvtflow(f"{TO_BE_ENDED} -o cut.h5 --force {BUDGET}", 4)  # is to replace another
        before = Path("cut.checkpoint").read_bytes()
        self.has(self.err("resume cut.checkpoint --set 'tip.radius=2 m' --set run.method=dumka3-p4"),
                 "cut.checkpoint: not a checkpoint of this scene:\n  tip.radius = 2, the checkpoint has ",
                 '\n  run.method = "dumka3-p4", the checkpoint has "rk4"\n')
        self.assertEqual(Path("cut.checkpoint").read_bytes(), before)
        self.cvtflow("resume cut.checkpoint -q --set run.max_steps=0")
        self.same("whole.h5", "cut.h5")

    def test_refuses_a_record_whose_rows_have_changed(self):
        child = self.start(f"{TO_BE_ENDED} -o cut.h5 --until '1 ms' --checkpoint-every '5 ms'")
        self.ended_when(child, lambda: has("cut.checkpoint") and rows_of("cut.h5.part") > 5, signal.SIGINT, STOPPED)
        changed = bytearray(Path("cut.h5").read_bytes()[:-32])  # without its seal, as if it had been killed
        changed[changed.rindex(channel("cut.h5", "time")[-1].tobytes())] ^= 1  # before it, what the chunk was when it grew
        Path("cut.h5").write_bytes(changed)
        self.matches(self.err("resume cut.checkpoint -q"),
                     "cut.h5: cannot read '/(channels|states)/time': data error detected by Fletcher32 checksum")
        self.assertEqual((Path("cut.h5").read_bytes(), has("cut.h5.part.part")), (changed, False), "nothing is lost")

    def test_leaves_no_half_written_checkpoint_behind(self):
        self.cvtflow("settle tiny -q -o a.state --time 20us --set start.ramp_time=10us")
        for more in ("--checkpoint-every '1 h'", "--force"):
            Path("cut.checkpoint.part").write_bytes(Path("a.state").read_bytes()[:4000])  # what a kill left
            self.cvtflow(f"{TO_BE_ENDED} -o cut.h5 {more}")
            self.assertFalse(has("cut.checkpoint.part"), more)


class ForeignCheckpoint(Program):
    def make(self):
        os.mkdir("theirs")
        self.cvtflow(f"{TO_BE_ENDED} -o theirs/sent.h5 {BUDGET}", 4)
        os.rename("theirs/sent.checkpoint", "mine.checkpoint")

    def test_replaces_the_finished_record_of_another_run_only_with_force(self):
        self.cvtflow(f"{TO_BE_ENDED} -o other.h5")
        other, line = Path("other.h5").read_bytes(), "resume mine.checkpoint -q -o other.h5 --set run.max_steps=0"
        self.assertEqual(self.err(line), "cvtflow: other.h5: already exists; --force replaces it\n")
        self.assertEqual(Path("other.h5").read_bytes(), other)
        self.cvtflow(f"{line} --force")
        self.assertNotEqual(Path("other.h5").read_bytes(), other)


CONTINUED = 'continuation = "clamping.driven"\ncheck = 0\n'
SHORT = "--grace '1 us'"
TWENTY = "6, 9, 12, 15, 18"
STEADY = """[sweep]
scene = "control"
detail = "rigid"
[set]
start.state = ""
start.settling_time = "10 ms"
run.until = "steady"
run.steady = "5 %"
control.gains = "found"
control.when_steady = "hold"
run.output_interval = "200 us"
[[axes]]
key = "drive.speed"
values = ["4000 rpm", "4200 rpm"]
[[axes]]
key = "clamping.driven"
values = ["19 kN", "20 kN"]
[[axes]]
key = "load.torque"
values = ["60 N*m", "70 N*m", "80 N*m"]
[outputs]
scalars = ["slip mean", "ratio mean"]
[start]
mode = "settle"
continuation = "load.torque"
across = "clamping.driven"
check = 0
[steady]
confirm = 0
"""


def done():
    return len(cases_of("out"))


def short():
    write_sweep("6", "1 ms", CONTINUED)


def twenty():
    write_sweep(TWENTY, "80 us")


def steady():
    write("sweep.toml", STEADY)


# (what, sweep, further words of the line, number of cases after which the signal comes)
ENDED = (
    ("while a case continues from its neighbour", short, SHORT, 1),
    ("while it extrapolates steady states", steady, f"--threads 1 {SHORT}", 4),
    ("between cases", twenty, f"--threads 1 {SHORT}", 2),
)


class ContinuedSweep(Program):
    def equal_whole(self, done, *columns):
        """A sweep has the results of one that nothing disturbed."""
        self.assertEqual(hash_in(done.out), self.whole)
        for name in columns:
            self.assertEqual(self.column(name), self.column(name, "whole"))

    def undisturbed(self):
        self.whole = hash_in(self.batch(folder="whole").out)

    def test_that_is_ended_has_the_results_of_an_undisturbed_one(self):
        for what, prepare, more, cases in ENDED:
            with self.subTest(what):
                shutil.rmtree("out", ignore_errors=True)
                shutil.rmtree("whole", ignore_errors=True)
                prepare()
                self.undisturbed()
                ended = self.ended_when(self.start(f"batch sweep.toml -o out {more}"),
                                        lambda: has("out/claims") and done() >= cases, signal.SIGTERM, STOPPED)
                self.has(ended.out, "to continue: cvtflow resume out\n")
                self.assertFalse(has("out/results.csv"))
                self.has(self.out("info out"), "\n  status              not finished, or running elsewhere\n")
                self.has(self.out("table out"), "not finished\n")
                self.equal_whole(self.cvtflow("resume out"), "start", "status")

    def test_of_steady_lines_has_one_hash_for_any_number_of_threads(self):
        write("sweep.toml", STEADY)
        self.undisturbed()
        starts = self.column("start", "whole")
        self.assertEqual({starts[number] for number in (2, 4, 5, 8, 10, 11)}, {"extrapolated"})
        self.assertFalse(has("whole/continuation"))
        self.equal_whole(self.batch("--threads 1", folder="one"))

    def test_is_a_row_of_its_table_where_a_case_takes_its_process_down_and_the_others_have_their_results(self):
        """The process of the sweep dies by SIGSEGV in a case, and again when that runs alone. A case has a record while it runs."""
        write_sweep("6, 12", "0.4 ms", outputs="records = true\n")
        self.undisturbed()
        child = self.start("batch sweep.toml -o out --threads 1")

        def worker():
            """The process that runs the cases; 0: none."""
            return int(read(f"/proc/{child.pid}/task/{child.pid}/children").split(" ")[0] or 0)

        def running():
            return min((int(path[-11:-8]) for path in glob.glob("out/records/*.part")), default=-1)

        self.assertTrue(eventually(lambda: running() >= 3))
        first = worker()
        os.kill(first, signal.SIGSTOP)
        crashed = running()
        self.assertGreaterEqual(crashed, 3, "stopped between two cases")
        os.remove(f"out/records/case-{crashed:06}.h5.part")  # the next attempt makes it again
        os.kill(first, signal.SIGSEGV)
        os.kill(first, signal.SIGCONT)
        self.assertTrue(eventually(lambda: worker() not in (0, first) and running() == crashed))
        os.kill(worker(), signal.SIGSEGV)
        done = self.wait(child, 5)
        self.has(done.err, f"cvtflow: a process of the sweep was ended by SIGSEGV (Segmentation fault); its cases run again one by one: "
                           f"case {crashed}\ncvtflow: case {crashed} crashed: SIGSEGV (Segmentation fault)\n")
        self.has(done.out, "1 crashed, 7 ok")
        self.assertEqual(self.column("error")[crashed], "its process was ended by SIGSEGV (Segmentation fault), even when it ran alone")
        self.assertNotEqual(self.column("slip_mean")[crashed], self.column("slip_mean")[crashed], "not a number")
        hashes, expected = self.column("hash"), self.column("hash", "whole")
        self.assertEqual(hashes | {crashed: ""}, expected | {crashed: ""})
        self.equal_whole(self.batch("--retry crashed"))
        self.assertEqual(len(self.column("status")), 8)


if __name__ == "__main__":
    main()
