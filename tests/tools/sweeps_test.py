"""Sweeps: what is tried before one, where cases start, how they fail; processes that share one; what a folder is refused for."""

import fcntl
import json
import os
import re
import shutil
import signal
from pathlib import Path

import numpy as np

from program import SETTLING, Program, cases_of, eventually, fact, hash_in, main, read, write, write_sweep

OTHER = "0.1.0 (deadbeef)"  # another version of the program


def has(*files):
    return all(os.path.exists(file) for file in files)


def put_fact(folder, name, text):
    path = Path(folder, "sweep.json")
    path.write_text(json.dumps(json.loads(path.read_text(encoding="utf-8")) | {name: text}), encoding="utf-8")


class Batch(Program):
    def test_gives_one_hash_for_every_number_of_threads_and_every_cut_and_the_run_of_each_scene(self):
        write_sweep()
        one = self.batch("--threads 1").out
        self.has(one, "12 ok")
        for threads in (2, 3):
            self.assertEqual(hash_in(self.batch(f"--threads {threads}", folder=f"t{threads}").out), hash_in(one))
        self.assertEqual(read("out/sweep.toml"), read("sweep.toml"))
        self.assertFalse(has("out/claims"))
        single = self.out(f"run tiny -o none --settle --until '40 us' --step '50 ns' {SETTLING} --set load.torque=12 --set "
                          f"'clamping.driven=5 kN'")
        self.assertEqual(hash_in(single, "state hash"), self.column("hash")[4])
        unsteady = [note for note in self.column("notes").values() if "unsteady" in note]
        self.assertTrue(unsteady, "20 us of a settling machine")
        self.has(one, f"unsteady {len(unsteady)} of 12")
        self.lacks(one, "  failed  ")

    def test_records_cases_if_asked(self):
        write_sweep("6", outputs="records = true\n")
        self.batch()
        self.assertEqual(len(os.listdir("out/records")), 4)
        self.has(self.out("info out/records/case-000002.h5"), "\n  status              finished\n")

    def test_failing_cases_are_rows_with_a_status(self):
        write_sweep("6, 12", "5 ms", '[budget]\nsteps = 600\n[[axes]]\nkey = "start.ratio"\nvalues = [1.0, 0.3]\n[[axes]]\nkey = '
                                     '"run.step"\nvalues = ["50 ns", "10 us"]\n')
        self.batch("", 5)
        status = self.column("status")
        self.assertEqual((len(status), status[0], status[1], status[2]), (32, "budget", "diverged", "bad_parameters"))
        self.assertTrue(self.column("error")[0].startswith("the budget of 600 steps (run.max_steps) is used up"))
        self.assertTrue(np.isnan(self.column("slip_mean")[1]))
        self.has(shown := self.out("table out --status diverged"), "  diverged  ")
        self.lacks(shown, "  budget  ")
        self.has(self.batch("--retry budget", None).out, "; 24 before")
        self.assertEqual(len(self.column("status")), 32)

    def test_of_another_sweep_is_refused_with_the_difference(self):
        write_sweep("6")
        self.batch()
        before = self.column("hash")
        write_sweep("6, 7", "50 us")
        self.assertEqual(self.err("resume out"), "cvtflow: out: results of another sweep; use another folder (-o):\n"
                                                 "  axes.load.torque = 6 there, 6, 7 in the sweep\n"
                                                 "  run.until = 4e-5 there, 5e-5 in the sweep\n")
        self.assertEqual(self.column("hash"), before)

    def test_of_another_version_with_other_keys_is_refused_with_both_versions_and_a_few_of_the_keys(self):
        write_sweep("6")
        self.batch()
        keys = "".join(f"old.key_{number} = 1\n" for number in range(9))
        put_fact("out", "definition", keys + fact("out", "definition"))
        put_fact("out", "program", OTHER)
        lines = self.err("resume out").splitlines()
        self.assertEqual((lines[1], len(lines), lines[-1]), ("  old.key_0 = 1 there, nothing in the sweep", 8, "  and 4 more"))

    def test_on_a_full_disk_keeps_what_it_has_and_continues_later(self):
        write_sweep(", ".join(str(torque) for torque in range(1, 21)), "20 us")
        full = self.shell('ulimit -f 16; "$CVTFLOW" batch sweep.toml -o out -q --threads 1', 1)
        self.assertRegex(full.stderr, r"\Acvtflow: out/rows-\S+\.csv: cannot write: File too large; [0-9]+ cases are saved\n\Z")
        saved = len(cases_of("out"))
        self.assertTrue(0 < saved < 80, saved)
        self.has(self.out("resume out"), f"; {saved} before")
        self.assertEqual(len(self.column("hash")), 80)

    def test_that_cannot_write_its_states_stops_and_blames_no_case(self):
        write_sweep("6", "2 ms", mode="shared")
        write("out/states", "a file in the way")
        self.assertTrue(self.batch("-q", 1).err.startswith("cvtflow: out/states"))
        self.lacks(self.out("table out --status bad_parameters --csv"), "bad_parameters")

    def test_shares_a_settled_state_and_continues_from_neighbours(self):
        write_sweep("6, 12", more='continuation = "clamping.driven"\n')
        self.batch("--threads 1")
        start, slip = self.column("start"), self.column("slip_mean")
        self.assertEqual((start[0], start[1], start[4]), ("settled", "continued", "settled"))
        text = self.out("table out")
        self.assertEqual(hash_in(self.batch("--threads 2", folder="two").out), hash_in(text))
        self.has(text, " slip_mean [%] ", f" {100 * slip[0]:.6g} ", " efficiency [%] ", "clamping_driven [kN]")
        self.units_of_its_csv()
        write_sweep("6, 12", mode="shared")
        self.batch(folder="shared")
        self.assertEqual((len(os.listdir("shared/states")), self.column("start", "shared")[3]), (1, "shared"))
        write_sweep("6, 12")
        self.batch(folder="own")
        separate = self.column("slip_mean", "own")[7]
        self.assertNotEqual(separate, slip[7])
        gap = abs(slip[7] - separate)  # the differences in the table are those to a sweep without continuation
        self.assertTrue(fact("out", "continuation_error").startswith(
            f"1 case, at most: slip mean {gap:.2g} ({100 * gap / abs(separate):.2g} %), tight_tension max "))

    def units_of_its_csv(self):
        """Names of columns are those that scripts read, unless units are requested; a picture of either CSV is the same."""
        plain, named = self.out("table out --csv"), self.out("table out --csv --units")
        self.has(plain, ",load_torque,")
        self.has(named, ",load_torque [N*m],", ",slip_mean [1],")
        self.assertEqual(plain.partition("\n")[2], named.partition("\n")[2])
        self.has(self.out("table out --si"), " clamping_driven [N] ", " slip_mean ")
        self.err("table out --units", 2)
        self.assertEqual(*(self.out(f"table out --column {names}") for names in (
            "clamping.driven --column 'slip mean'", "clamping_driven --column slip_mean")))
        self.has(self.err("table out --column load.torqe", (1, 2)), 'has no such column (did you mean "load_torque"?)')
        write("named.csv", named)
        self.cvtflow("plot named.csv --x load.torque --y slip_mean -o p.svg")
        self.has(read("p.svg"), ">mean slip [%]<", ">load torque [N·m]<")

    def test_a_dry_run_prints_cases_and_an_estimate(self):
        write_sweep()
        text = self.batch("--dry-run").out
        self.assertTrue(text.startswith("sweep: 12 cases\n"))
        self.has(text, "load.torque [N*m]")
        self.matches(text, "  estimate            [a-z0-9. ]+ s on one thread, ", "  disk                [0-9.]+ kB of results")
        self.assertFalse(has("out"))

    def test_a_dry_run_measures_no_step_beyond_a_cases_end(self):
        """12 um are reached 1.6 us after the settling: a case of 0.2 us knows nothing of that."""
        write_sweep("12", "0.2 us", set='tip.deepest = "12 um"\nrun.output_interval = "50 ns"\nrun.state_interval = "100 ns"\n')
        write("sweep.toml", read("sweep.toml").replace("ratio at 20 us", "ratio at 0.2 us"))
        self.has(self.batch("--dry-run", None).out, "(measured on 3 cases, ")
        self.batch()

    def test_a_dry_run_reports_why_no_case_could_be_tried(self):
        write_sweep("12", set='run.method = "leapfrog-sweep"\ndetail.pins = "rigid"\n')
        self.has(self.batch("--dry-run", 5).out, "estimate            none: every case has inconsistent parameters")

    def test_cases_for_which_the_scenes_state_does_not_fit_settle_as_runs_do(self):
        """Of baseline, whose settled state is of level fine."""
        for name, settling, more, head, status in (
                ("level", "20 us", "", 'detail = "rigid"\n', 0), ("pulleys", "20 us", 'detail.pulleys = "rigid"\n', "", 0),
                ("hurry", "0 s", "", 'detail = "rigid"\n', 5)):
            write("sweep.toml", f'[sweep]\nscene = "baseline"\n{head}[set]\nrun.until = "20 us"\nrun.step = "1 us"\n'
                                f'start.ramp_time = "20 us"\nstart.settling_time = "{settling}"\n{more}[[axes]]\nkey = "load.torque"\n'
                                f'values = [10, 20, 30]\n[outputs]\nscalars = ["ratio mean"]\n')
            self.batch("", status, name)
            if status == 0:
                self.assertEqual({(self.column("status", name)[k], self.column("start", name)[k]) for k in range(3)}, {("ok", "geometric")})
        for error in self.column("error", "hurry").values():
            self.has(error, "start.settling_time = 0 leaves no time to settle")
        single = self.out("run baseline -o none --detail rigid --until '20 us' --step '1 us' --set start.settling_time=20us --set "
                          "start.ramp_time=20us --set load.torque=20")
        self.assertEqual(hash_in(single, "state hash"), self.column("hash", "level")[1])


class BatchFailures(Program):
    """24 cases, of which none can begin: the chain does not fit the sheaves at that ratio."""

    def make(self):
        write_sweep("1, 2, 3, 4, 5, 6", more='[[axes]]\nkey = "start.ratio"\nvalues = [0.3]\n')

    def test_that_are_alike_in_the_first_dozen_cases_stop_the_sweep_with_their_message(self):
        done = self.batch("--threads 1", 5)
        self.has(done.err, "sweep: the first 12 cases all failed alike: bad_parameters: chain.pins: ", "; --keep-going runs the others\n")
        self.has(done.out, "sweep: stopped after 12 of 24 cases; to continue: cvtflow resume out --keep-going\n",
                 "failed              12 of 12 cases (100 %)\n", "12 bad_parameters: chain.pins: ", "(first: case 0)")
        self.assertEqual(len(self.column("status")), 12)
        self.has(self.out("resume out --keep-going", 5), "sweep: finished\n", "failed              24 of 24 cases (100 %)\n")
        self.has(self.out("info out"), "failed              24 of 24 cases (100 %)\n")

    def test_that_are_alike_do_not_stop_a_sweep_in_which_a_case_has_ended_well(self):
        write_sweep("1, 2, 3, 4, 5, 6", more='[[axes]]\nkey = "start.ratio"\nvalues = [1.0, 0.3, 0.3, 0.3]\n')
        self.has(self.batch("--threads 1", 5).out, "sweep: finished\n", "failed              72 of 96 cases (75 %)\n",
                 "72 bad_parameters: chain.pins: ", "(first: case 1)")


class BatchOrigin(Program):
    """Rows of a folder come from one program and one start."""

    def settle(self, file, load):
        """A state of tiny, settled for a moment with that load."""
        self.cvtflow(f"settle tiny -q --force -o {file} --time 20us --set start.ramp_time=10us --set load.torque={load}")

    def write_from(self, state, outputs=""):
        """Two cases from that state."""
        write("sweep.toml", '[sweep]\nscene = "tiny"\n[set]\nrun.until = "20 us"\nrun.step = "50 ns"\nstart.settling_time = "20 us"\n'
                            f'start.ramp_time = "10 us"\nstart.state = "{state}"\n[[axes]]\nkey = "load.torque"\nvalues = [6, 12]\n'
                            f'[outputs]\nscalars = ["slip mean"]\n{outputs}')

    def make(self):
        self.settle("a.h5", 6)
        self.settle("b.h5", 12)
        self.write_from("a.h5")
        self.batch()

    def refused(self, line, *parts, kept="out/results.csv"):
        before = Path(kept).read_bytes()
        self.has(self.err(line), *parts)
        self.assertEqual(Path(kept).read_bytes(), before)

    def version(self):
        return fact("out", "program")

    def test_is_in_every_row(self):
        self.assertEqual(set(self.column("program").values()), {self.version()})
        self.has(self.out("--version"), f"cvtflow {self.version()}")
        self.write_from("b.h5")
        self.batch(folder="b")
        (a, again), (b, _) = (self.column("start_state", folder).values() for folder in ("out", "b"))
        self.assertTrue(a == again != b and len(a) == 16, (a, again, b))

    def test_another_content_of_the_start_state_is_refused_and_another_path_is_not(self):
        os.rename("a.h5", "c.h5")
        self.write_from("c.h5")
        self.batch()
        self.settle("c.h5", 12)
        self.refused("batch sweep.toml -o out", "  content of start.state ")
        self.lacks(self.batch("", 1).err, "program ")
        self.refused("resume out")

    def test_of_another_version_of_the_program_or_with_records_is_refused(self):
        self.write_from("a.h5", "records = true\n")
        self.refused("batch sweep.toml -o out", "  outputs.records false there, true here\n")
        self.assertFalse(has("out/records"))
        self.write_from("a.h5")
        here = self.version()
        put_fact("out", "program", OTHER)
        for line in ("batch sweep.toml -o out", "resume out"):
            self.refused(line, f"  program {OTHER} there, {here} here\n")

    def test_of_version_04_is_refused_with_what_to_do(self):
        os.mkdir("old")
        write("old/cases.h5", "")
        for line in ("batch sweep.toml -o old", "resume old", "table old", "info old", "plot old --x a --y b", "diff old out"):
            self.has(self.err(line), "old: results of cvtflow 0.4 or before, ", "`cvtflow table DIR --csv` of that version")
        self.assertEqual(os.listdir("old"), ["cases.h5"])

    def test_of_shared_states_is_compared(self):
        write_sweep("6", "20 us", mode="shared")
        self.batch(folder="shared")
        state, = os.listdir("shared/states")
        os.makedirs("other/states")
        shutil.copy(f"shared/states/{state}", "other/states")
        old = Path("other/states", state)
        old.write_bytes(old.read_bytes()[:-1] + b"?")
        self.has(self.batch("", 1, "other").err, "a damaged state: its checksum differs")
        os.makedirs("third/states")
        shutil.copy("b.h5", f"third/states/{state}")
        self.has(self.batch("", 1, "third").err, "a shared start state of another scene than its name promises")


class SharedSweep(Program):
    """Several processes run one sweep in one folder."""

    def start_worker(self, more=""):
        return self.start(f"batch sweep.toml -o out --threads 1 {more}")

    def test_shows_its_progress_to_people_and_programs_and_one_hash_in_the_end(self):
        write_sweep("6, 9, 12, 15, 18", "80 us")
        whole = hash_in(self.batch(folder="whole").out)
        workers = [self.start_worker() for _ in range(2)]
        self.assertTrue(eventually(lambda: len(cases_of("out")) >= 3))
        shown = json.loads(self.out("info out --json"))
        self.assertEqual((shown["cases"], shown["status"]), (20, "running"))
        self.assertTrue(3 <= shown["done"] < 20 and shown["running"] in (1, 2), shown)
        self.has(self.out("info out"), "\n  status              running\n", "rows-")
        done = [self.wait(worker) for worker in workers]
        self.assertEqual([hash_in(each.out) for each in done], [whole, whole])
        self.assertEqual(sum(int(re.search(r"(\d+) now", each.out)[1]) for each in done), 20, "no case ran twice")
        self.assertEqual(read("out/results.csv").count("\n"), 21)
        self.out("diff out whole")

    def test_ends_with_a_line_of_json(self):
        write_sweep()
        last = json.loads(self.batch("--json").out.splitlines()[-1])
        expected = {"event": "finished", "statuses": {"ok": 12}, "done": 12, "exit_status": 0, "table": "out/results.csv",
                    "results_hash": fact("out", "results_hash")}
        self.assertEqual({name: last[name] for name in expected}, expected)

    def test_continues_strands_and_checks_them_as_one_process_does(self):
        write_sweep("6, 9, 12", more='continuation = "clamping.driven"\ncheck = 2\n')
        whole = hash_in(self.batch(folder="whole").out)
        workers = [self.start_worker() for _ in range(2)]
        self.assertEqual([hash_in(self.wait(worker).out) for worker in workers], [whole, whole])
        self.assertEqual(*(fact(folder, "continuation_error") for folder in ("out", "whole")))

    def test_settles_by_itself_where_another_writes_the_same_shared_start(self):
        """Equal machines settle the same state in the same time."""
        write_sweep(mode="shared")
        whole = hash_in(self.batch(folder="whole").out)
        os.makedirs("out/states")
        written = [open(f"out/states/{state}.part", "w+b") for state in os.listdir("whole/states")]
        self.assertTrue(written)
        for file in written:
            self.addCleanup(file.close)
            fcntl.flock(file, fcntl.LOCK_EX)
            fcntl.lockf(file, fcntl.LOCK_EX)
        self.assertEqual(hash_in(self.batch().out), whole)

class LostRows(Program):
    def test_of_cases_which_others_started_from_run_them_all_again(self):
        """Cases start from each other's ends, which are kept, while rows may be lost with the power: behind the last row a strand
        continues, but one with a gap, or without an end, begins anew."""
        write_sweep("6", "0.4 ms", 'continuation = "clamping.driven"\ncheck = 0\n')
        whole = self.batch(folder="whole")
        child = self.start("batch sweep.toml -o stopped --grace '1 us' -q")
        self.ended_when(child, lambda: len(cases_of("stopped")) == 3, signal.SIGKILL, 128 + signal.SIGKILL)
        rows, = Path("stopped").glob("rows-*.csv")
        lines = rows.read_text(encoding="utf-8").splitlines(keepends=True)
        self.assertEqual(len(lines), 4)
        for left, end in (([0], ""), ([0, 2], ""), ([0, 1, 2], ""), ([0], "end-000000.state")):
            shutil.rmtree("out", ignore_errors=True)
            shutil.copytree("stopped", "out")
            if end:
                os.remove(f"out/continuation/{end}")
            Path("out", rows.name).write_text("".join([lines[0], *(lines[1 + k] for k in left)]), encoding="utf-8")
            rest = self.cvtflow("resume out")
            self.assertEqual(hash_in(rest.out), hash_in(whole.out))
            self.assertEqual(self.column("start"), self.column("start", "whole"))

    def test_that_are_damaged_are_named_and_run_again(self):
        write_sweep()
        whole = hash_in(self.batch(folder="whole").out)
        shutil.copytree("whole", "out")
        results, rows = Path("out/results.csv"), next(Path("out").glob("rows-*.csv"))
        text = results.read_text(encoding="utf-8")
        results.write_text(text.replace(",ok,", ",ko,", 1), encoding="utf-8")
        for line in ("table out", "diff out whole", "info out", "resume out"):
            self.has(self.err(line), "out/results.csv:2: its checksum differs")
        os.remove(results)
        put_fact("out", "status", "running")
        rows.write_text(text.replace(",ok,", ",ko,", 1)[:-20], encoding="utf-8")  # and a torn last line
        done = self.cvtflow("resume out")
        self.has(done.err, ":2: its checksum differs; its case runs again\n")
        self.has(done.out, "2 now")
        self.assertEqual(hash_in(done.out), whole)


if __name__ == "__main__":
    main()
