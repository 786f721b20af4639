"""Sweeps: what is tried before one, where cases start, how they fail; where the rows of its folder come from and what is done about
damage."""

import os
import shutil
import signal
from pathlib import Path

import numpy as np

from program import (SETTLING, SOURCE, Program, attribute, channel, eventually, forge, hash_in, main, read, rows_of, unsealed, write,
                     write_sweep)

STOPPED = 130
OTHER = "0.1.0 (deadbeef)"  # another version of the program


def has(*files):
    return all(os.path.exists(file) for file in files)


def put_attribute(file, name, text):
    forge(file, lambda opened: opened.attrs.__setitem__(name, np.bytes_(text)))


class Batch(Program):
    def test_gives_one_hash_for_every_number_of_threads_and_every_cut_and_the_run_of_each_scene(self):
        write_sweep()
        one = self.batch("--threads 1").out
        self.has(one, "12 ok")
        for threads in (2, 3):
            self.assertEqual(hash_in(self.batch(f"--threads {threads}", folder=f"t{threads}").out), hash_in(one))
        for shard in ("1/3", "2/3", "3/3"):
            self.batch(f"--shard {shard}", folder="cut")
        self.assertEqual(hash_in(self.out("merge cut")), hash_in(one))
        self.assertEqual(self.column("hash", "cut"), self.column("hash"))
        single = self.out(f"run tiny -o none --settle --until '40 us' --step '50 ns' {SETTLING} --set load.torque=12 --set "
                          f"'clamping.driven=5 kN'")
        self.assertEqual(hash_in(single, "state hash"), self.column("hash")[4])
        unsteady = [note for note in self.column("notes").values() if "unsteady" in note]
        self.assertTrue(unsteady, "20 us of a settling machine")
        self.has(one, f"unsteady {len(unsteady)} of 12")
        self.lacks(one, "  failed  ")

    def test_leaves_nothing_behind_of_a_checkpoint_that_a_kill_cut_short_and_records_cases_if_asked(self):
        write_sweep("6", outputs="records = true\n")
        state = Path(SOURCE, "scenes/states/baseline.h5").read_bytes()
        os.makedirs("out/checkpoints")
        Path("out/checkpoints/case-000000.h5.part").write_bytes(state[:len(state) // 2])
        self.batch()
        self.assertFalse(has("out/checkpoints"))
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

    def test_of_another_sweep_is_refused_with_the_difference(self):
        write_sweep("6")
        self.batch()
        before = self.column("hash")
        write_sweep("6, 7", "50 us")
        self.assertEqual(self.err("resume out"), "cvtflow: out/cases.h5: results of another sweep:\n"
                                                 "  axes.load.torque = 6 in the table, 6, 7 in the sweep\n"
                                                 "  run.until = 4e-5 in the table, 5e-5 in the sweep\n")
        self.assertEqual(self.column("hash"), before)

    def test_of_another_version_with_other_keys_is_refused_with_both_versions_and_a_few_of_the_keys(self):
        write_sweep("6")
        self.batch()
        keys = "".join(f"old.key_{number} = 1\n" for number in range(9))
        put_attribute("out/cases.h5", "definition", keys + attribute("out/cases.h5", "definition"))
        put_attribute("out/cases.h5", "program", OTHER)
        lines = self.err("resume out").splitlines()
        self.assertRegex(lines[0], r"out/cases.h5: results of another sweep, by cvtflow 0\.1\.0 \(deadbeef\), where this is .*; use another "
                                   r"folder \(-o\):\Z")
        self.assertEqual((lines[1], len(lines), lines[-1]), ("  old.key_0 = 1 in the table, nothing in the sweep", 8, "  and 3 more"))

    def test_into_a_folder_that_another_writes_is_refused(self):
        write_sweep("6", "20 ms")
        self.start("batch sweep.toml -o out -q")
        self.assertTrue(eventually(lambda: has("out/cases.h5")))
        self.assertEqual(self.batch("", 1).err, "cvtflow: out: another sweep is writing into it\n")
        self.assertEqual(self.batch("--worker", 1).err,
                         "cvtflow: out: this sweep was begun without workers; continue it without --worker\n")

    def test_on_a_full_disk_keeps_what_it_has_and_continues_later(self):
        write_sweep(", ".join(str(torque) for torque in range(1, 21)), "20 us")
        full = self.shell('ulimit -f 120; "$CVTFLOW" batch sweep.toml -o out -q --threads 1', 1)
        self.assertRegex(full.stderr, r"\Acvtflow: out/cases.h5: cannot write: File too large; [0-9]+ cases are saved\n\Z")
        saved = rows_of("out/cases.h5")
        self.assertTrue(0 < saved < 80, saved)
        self.has(self.out("resume out"), f"; {saved} before")
        self.assertEqual(len(self.column("hash")), 80)

    def test_that_cannot_write_its_checkpoints_stops_and_blames_no_case(self):
        write_sweep("6", "2 ms")
        write("out/checkpoints", "a file in the way")
        self.assertTrue(self.batch("--checkpoint-every '1 ms' -q", 1).err.startswith("cvtflow: out/checkpoints"))
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
        self.assertTrue(attribute("out/cases.h5", "continuation_error").startswith(
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
        self.has(self.batch("--worker", 5, "shared").err, "the first 12 cases all failed alike")
        self.assertFalse(has("shared/cases.h5"))

    def test_that_are_alike_do_not_stop_a_sweep_in_which_a_case_has_ended_well(self):
        write_sweep("1, 2, 3, 4, 5, 6", more='[[axes]]\nkey = "start.ratio"\nvalues = [1.0, 0.3, 0.3, 0.3]\n')
        self.has(self.batch("--threads 1", 5).out, "sweep: finished\n", "failed              72 of 96 cases (75 %)\n",
                 "72 bad_parameters: chain.pins: ", "(first: case 1)")

    def test_fail_what_joins_them(self):
        for shard in ("1/2", "2/2"):
            self.batch(f"--keep-going --shard {shard}", 5, "cut")
        for line, status in (("merge cut", 5), ("info cut", 0)):
            self.has(self.out(line, status), "failed              24 of 24 cases (100 %)\n")


class BatchOrigin(Program):
    """Rows of a folder come from one program and one start, or from several knowingly."""

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

    def refused(self, line, *parts, kept="out/cases.h5"):
        before = Path(kept).read_bytes()
        self.has(self.err(line), *parts)
        self.assertEqual(Path(kept).read_bytes(), before)

    def version(self):
        return attribute("out/cases.h5", "program")

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
        self.refused("batch sweep.toml -o out", "out/cases.h5: content of start.state ", "--mixed")
        self.lacks(self.batch("", 1).err, "program ")
        self.refused("resume out")
        self.batch("--mixed")

    def test_of_shards_must_agree(self):
        self.batch("--shard 1/2", folder="cut")
        self.settle("a.h5", 12)
        self.batch("--shard 2/2", folder="cut")
        self.has(self.err("merge cut"), "cut/workers/0002/cases.h5: content of start.state ")
        self.assertFalse(has("cut/cases.h5"))
        put_attribute("cut/workers/0001/cases.h5", "program", OTHER)
        self.has(self.err("merge cut"), f"program {OTHER} there, ")
        self.cvtflow("merge cut --mixed")
        self.assertEqual(attribute("cut/cases.h5", "program"), f"{OTHER}; {self.version()}")

    def test_of_another_version_of_the_program_or_with_records_is_continued_only_knowingly(self):
        self.write_from("a.h5", "records = true\n")
        self.refused("batch sweep.toml -o out", "out/cases.h5: outputs.records false there, true here; ")
        self.assertFalse(has("out/records"))
        self.write_from("a.h5")
        here = self.version()
        put_attribute("out/cases.h5", "program", OTHER)
        for line in ("batch sweep.toml -o out", "resume out"):
            self.refused(line, f"out/cases.h5: program {OTHER} there, {here} here; ")
        self.cvtflow("resume out --mixed")
        self.assertEqual(self.version(), f"{OTHER}; {here}")
        self.batch("", 1)  # it stays mixed

    def test_of_shared_states_is_compared(self):
        write_sweep("6", "20 us", mode="shared")
        self.batch(folder="shared")
        state, = os.listdir("shared/states")
        os.makedirs("other/states")
        shutil.copy(f"shared/states/{state}", "other/states")
        put_attribute(f"other/states/{state}", "program", f"cvtflow {OTHER}, GNU")
        self.has(self.batch("", 1, "other").err, "a shared start state settled by cvtflow ", "deadbeef", "--mixed")
        self.batch("--mixed", folder="other")
        os.makedirs("third/states")
        shutil.copy("b.h5", f"third/states/{state}")
        self.has(self.batch("--mixed", 1, "third").err, "a shared start state of another scene than its name promises")

    def test_of_a_checkpoint_is_compared(self):
        self.cvtflow("run tiny -o r.h5 --until '1 ms' --settle --checkpoint-every '1 s' --set run.max_steps=400 --set "
                     "start.settling_time=10us --set start.ramp_time=5us", 4)
        put_attribute("r.checkpoint.h5", "program", f"cvtflow {OTHER}, GNU")
        self.has(self.err("resume r.checkpoint.h5 --set run.max_steps=0 --until '40 us'"),
                 "r.checkpoint.h5: written by cvtflow 0.1.0 (deadbeef), GNU, this is cvtflow ", "--mixed")
        self.assertNotEqual(self.cvtflow("resume r.checkpoint.h5 --mixed --set run.max_steps=0", None).status, 1)


CASE = "out/{}/case-000000.h5"
ANEW = "case 0 restarts: its checkpoint cannot be used: "


def change_a_byte(name):
    data = bytearray(Path(name).read_bytes())
    data[len(data) // 2] ^= 4
    Path(name).write_bytes(data)


class StoppedSweep(Program):
    """Two of four cases, side by side, were stopped by a hangup with checkpoints and records in out; the whole sweep is in whole."""

    def make(self):
        write_sweep("6", "0.6 ms", outputs="records = true\n")
        self.batch(folder="whole")
        child = self.start("batch sweep.toml -o out --threads 2 --grace '1 us' --checkpoint-every '10 ms'")
        parts = [f"out/records/case-00000{k}.h5.part" for k in (0, 1)]  # beyond settling, whose checkpoint needs no record
        stopped = self.ended_when(child, lambda: all(rows_of(part) > 0 for part in parts), signal.SIGHUP, STOPPED)
        self.has(stopped.out, "to continue: cvtflow resume out\n")
        self.assertTrue(has(CASE.format("checkpoints"), "out/checkpoints/case-000001.h5"))

    def test_continues_bit_for_bit_and_begins_a_case_anew_whose_checkpoint_or_record_is_damaged_or_that_of_another(self):
        kept = shutil.copytree("out", "kept")
        for damage, said in (
                (lambda: None, None),
                (lambda: change_a_byte(CASE.format("checkpoints")), f"cvtflow: {ANEW}out/checkpoints/case-000000.h5: damaged"),
                (lambda: shutil.copy("out/checkpoints/case-000001.h5", CASE.format("checkpoints")),
                 f"{ANEW}out/checkpoints/case-000000.h5: not a checkpoint of this scene:\n  clamping.driven = "),
                (lambda: [file.unlink() for file in Path("out/records").glob("case-000000*")],
                 f"{ANEW}out/records/case-000000.h5: the checkpoint's record does not exist")):
            with self.subTest(said):
                shutil.rmtree("out")
                shutil.copytree(kept, "out")
                damage()
                rest = self.cvtflow("resume out")
                self.has(rest.err, said or "")
                self.lacks(rest.err, "case 1 restarts", *([] if said else ["restarts"]))
                self.assertEqual(hash_in(rest.out), attribute("whole/cases.h5", "results_hash"))
                self.assertFalse(has("out/checkpoints"))
                self.assertEqual({path.suffix for path in Path("out/records").iterdir()}, {".h5"}, "left behind")
                record, whole = CASE.format("records"), "whole/records/case-000000.h5"
                self.assertEqual(channel(record, "time").tolist(), channel(whole, "time").tolist())
                self.assertEqual(attribute(record, "state_hash"), attribute(whole, "state_hash"))


def keep_rows(table, rows):
    """A table of some of its rows; each has a check."""
    def change(file):
        cases = file["cases"][:][rows]
        file["cases"].resize(len(rows), 0)
        file["cases"][:] = cases

    forge(table, change)


class LostRows(Program):
    def test_of_cases_which_others_started_from_run_them_all_again(self):
        """Cases start from each other's ends, which are kept, while rows may be lost with the power: behind the last row a strand
        continues, but one with a gap, or without an end, begins anew."""
        write_sweep("6", "0.4 ms", 'continuation = "clamping.driven"\ncheck = 0\n')
        whole = self.batch(folder="whole")
        child = self.start("batch sweep.toml -o stopped --grace '1 us' --checkpoint-every '10 ms' -q")
        self.ended_when(child, lambda: has("stopped/checkpoints/case-000003.h5"), signal.SIGTERM, STOPPED)
        self.assertEqual(rows_of("stopped/cases.h5"), 3)
        for left, end, now in (([0], "", "3 now"), ([0, 2], "", "4 now"), ([0, 1, 2], "", "1 now"), ([0], "end-000000.h5", "4 now")):
            shutil.rmtree("out", ignore_errors=True)
            shutil.copytree("stopped", "out")
            if end:
                os.remove(f"out/continuation/{end}")
            keep_rows("out/cases.h5", left)
            rest = self.cvtflow("resume out")
            self.assertEqual(hash_in(rest.out), hash_in(whole.out))
            self.assertEqual(self.column("start"), self.column("start", "whole"))
            self.has(rest.out, now)


class TornSweep(Program):
    """A table of twelve rows as a power cut may leave it while it grows: row 5 is damaged, and for the last tests its head."""

    def make(self):
        write_sweep()
        self.batch(folder="whole")
        shutil.copytree("whole", "out")
        self.table = Path("out/cases.h5")
        damaged = bytearray(self.table.read_bytes())
        at = damaged.index(self.column("hash")[5].encode())
        damaged[at] = ord("0" if damaged[at] == ord("f") else "f")
        self.table.write_bytes(damaged)
        for command in ("resume", "table"):
            self.assertEqual(self.err(f"{command} out"),
                             "cvtflow: out/cases.h5: damaged HDF5 file (changed after it was finished: its checksum differs)\n")
        self.table.write_bytes(unsealed(self.table))  # as a kill leaves it: each row has a check

    def setUp(self):
        super().setUp()
        self.table, self.whole = Path("out/cases.h5"), attribute("whole/cases.h5", "results_hash")
        self.torn = bytes(48) + self.table.read_bytes()[48:]  # nor does HDF5 find the others

    def test_is_read_by_no_other_command(self):
        before = self.table.read_bytes()
        self.assertEqual(self.err("table out"), "cvtflow: out/cases.h5: row 5 is damaged: its checksum differs\n")
        self.assertEqual(self.table.read_bytes(), before)
        self.table.write_bytes(before[:len(before) // 2])
        self.assertTrue(self.err("resume out").startswith("cvtflow: out/cases.h5: truncated HDF5 file: "))

    def test_continues_with_the_rows_that_are_whole_also_where_hdf5_finds_none(self):
        kept = self.table.read_bytes()
        for damaged, line, why in ((kept, "resume out", "row 5 is damaged: its checksum differs"),
                                   (self.torn, "batch sweep.toml -o out", "not an HDF5 file")):
            self.table.write_bytes(damaged)
            if damaged != kept:
                self.assertEqual(self.err("resume out"), "cvtflow: out/cases.h5: not an HDF5 file\n  to continue with the intact rows: "
                                                         "cvtflow batch SWEEP -o out\n")
                self.assertEqual(self.table.read_bytes(), self.torn)
            done = self.cvtflow(line)
            self.has(done.err, f"cvtflow: out/cases.h5: {why}; intact rows are kept: 11; the other cases run again\n")
            self.has(done.out, "1 now")
            self.assertEqual(hash_in(done.out), self.whole)

    def test_is_refused_by_another_sweep_or_another_shard(self):
        self.table.write_bytes(self.torn)
        write_sweep("6, 12, 18", "50 us")
        self.assertEqual(self.batch("", 1).err, "cvtflow: out/cases.h5: not an HDF5 file\n")
        write_sweep()
        os.makedirs("out/workers/0001")
        shutil.copy(self.table, "out/workers/0001")
        self.assertEqual(self.batch("--shard 1/2", 1).err, "cvtflow: out/workers/0001/cases.h5: not an HDF5 file\n")
        for table in (self.table, Path("out/workers/0001/cases.h5")):
            self.assertEqual(table.read_bytes(), self.torn)


if __name__ == "__main__":
    main()
