"""Sweeps of several processes: workers that claim cases, and fixed shares of several machines that are merged."""

import fcntl
import json
import os
import shutil
from pathlib import Path

from program import Program, attribute, eventually, hash_in, main, rows_of, write_sweep


class Worker(Program):
    def worker(self, more="", status=0):
        return self.batch(f"--worker --threads 1 {more}", status)

    def whole_hash(self):
        return hash_in(self.batch(folder="whole").out)

    def test_folder_shows_its_progress_to_people_and_programs(self):
        write_sweep("6, 9, 12, 15, 18", "80 us")
        child = self.start("batch sweep.toml -o out --worker --threads 1")
        self.assertTrue(eventually(lambda: rows_of("out/workers/0001/cases.h5") >= 2))
        shown = json.loads(self.out("info out --json"))
        part = shown["parts"][0]
        self.assertEqual((shown["running"], shown["cases"], part["folder"], part["process"]), (1, 20, "out/workers/0001", "running"))
        self.assertTrue(2 <= shown["done"] < 20 and part["claimed"] >= part["done"], shown)
        self.wait(child)

    def test_ends_with_a_line_of_json(self):
        write_sweep()
        last = json.loads(self.worker("--json").out.splitlines()[-1])
        expected = {"event": "finished", "statuses": {"ok": 12}, "done": 12, "exit_status": 0, "results_hash": self.whole_hash()}
        self.assertEqual({name: last[name] for name in expected}, expected)

    def test_continues_strands_and_checks_them_as_one_process_does(self):
        write_sweep("6, 9, 12", more='continuation = "clamping.driven"\ncheck = 2\n')
        whole = self.whole_hash()
        workers = [self.start("batch sweep.toml -o out --worker --threads 1") for _ in range(2)]
        self.assertIn(whole, [hash_in(self.wait(worker).out) for worker in workers])
        self.assertEqual(*(attribute(f"{folder}/cases.h5", "continuation_error") for folder in ("out", "whole")))

    def test_refuses_a_folder_of_another_kind_or_sweep(self):
        write_sweep()
        self.batch("--shard 1/3", folder="cut")
        self.assertEqual(self.batch("--worker", 1, "cut").err,
                         "cvtflow: cut/workers/0001: this sweep was begun with --shard 1/3; continue it so\n")
        self.batch(folder="plain")
        self.batch("--worker", folder="plain")  # all cases are done
        self.worker()
        self.assertEqual(self.batch("--shard 1/3", 1).err, "cvtflow: out: this sweep was begun with --worker; continue it so\n")
        os.remove("out/cases.h5")
        write_sweep("7")
        self.has(self.worker("", 1).err, "out/workers/0001/cases.h5: results of another sweep:\n")
        for option in ("--shard=1/2", "--retry=budget", "--dry-run"):
            self.worker(option, 2)

    def test_settles_by_itself_where_another_writes_the_same_shared_start(self):
        """Equal machines settle the same state in the same time."""
        write_sweep(mode="shared")
        whole = self.whole_hash()
        os.makedirs("out/states")
        written = [open(f"out/states/{state}.part", "w+b") for state in os.listdir("whole/states")]
        self.assertTrue(written)
        for file in written:
            self.addCleanup(file.close)
            fcntl.flock(file, fcntl.LOCK_EX)
            fcntl.lockf(file, fcntl.LOCK_EX)
        self.assertEqual(hash_in(self.worker().out), whole)

    def test_with_damaged_claims_reports_the_file(self):
        write_sweep()
        self.worker()
        claims, whole = Path("out/workers/claims"), self.whole_hash()
        whole_claims = claims.read_bytes()
        self.assertEqual(len(whole_claims), 12 * 35)
        for damaged in (whole_claims[:40],  # one and a piece: what a kill leaves
                        b"       1            5            1\n" + whole_claims[35:]):  # what a power cut leaves of pages
            Path("out/cases.h5").unlink(missing_ok=True)
            claims.write_bytes(damaged)
            self.assertEqual(hash_in(self.worker().out), whole)
        for forged in (b"99999999            0           12\n", b"       1            0 999999999999\n"):
            Path("out/cases.h5").unlink(missing_ok=True)
            claims.write_bytes(forged)
            self.assertEqual(hash_in(self.worker().out), whole)
            self.assertLess(len(os.listdir("out/workers")), 20)
        Path("out/cases.h5").unlink(missing_ok=True)
        claims.write_bytes(b"mine\n")
        self.assertEqual(self.worker("", 1).err, "cvtflow: out/workers/claims: not the claims of a sweep's workers; move it away\n")
        self.assertEqual(claims.read_bytes(), b"mine\n")

    def test_shares_that_are_missing_are_named_the_first_five_and_counted(self):
        write_sweep()
        for shard in ("1/3", "3/3"):
            self.batch(f"--shard {shard}", folder="cut")
        self.assertEqual(self.err("merge cut", 5),
                         "cvtflow: cut/workers/0002: this worker has no results\ncvtflow: 4 of 12 cases are missing: 1, 4, 7, 10\ncvtflow: "
                         "nothing was written; run the missing shares, or use --partial to join the available ones\n")
        self.assertFalse(os.path.exists("cut/cases.h5"))
        self.cvtflow("merge cut --partial", 5)
        self.assertEqual((len(self.column("hash", "cut")), attribute("cut/cases.h5", "missing_cases")), (8, "1 4 7 10"))
        self.batch("--shard 4/12", folder="many")
        text = self.err("merge many", 5)
        self.assertEqual(text.count("\n"), 5 + 1 + 1 + 1, text)  # five shards, how many more, cases, what to do
        self.has(text, "many/workers/0006: this worker has no results\ncvtflow: … and 6 more; 11 workers have no results\n")

    def test_folders_that_were_copied_together_and_those_of_version_03_are_joined_but_not_other_divisions(self):
        write_sweep()
        whole = self.whole_hash()
        for shard in "12":
            self.cvtflow(["batch", "sweep.toml", "-o", f"machine {shard}", "--shard", f"{shard}/2"])
            for table in Path(f"machine {shard}").rglob("*"):
                target = Path("cut", table.relative_to(f"machine {shard}"))
                if table.is_file() and not target.exists():
                    target.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(table, target)
        self.assertEqual(hash_in(self.out("merge cut")), whole)
        os.mkdir("old")
        for number in "12":
            os.rename(f"cut/workers/000{number}", f"old/shard-000{number}-of-0002")
        self.assertEqual(hash_in(self.out("merge old")), whole)
        self.batch("--shard 3/3", folder="old")
        self.assertEqual(self.err("merge old"), "cvtflow: old/workers/0003/cases.h5: rows of 3/3, beside those of 1/2: remove the wrong "
                                                "ones\n")


if __name__ == "__main__":
    main()
