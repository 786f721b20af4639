"""The rule for files (engine/record/run/part_file.hpp): what commands write where files of the user lie, of every command that writes
against every kind of file that may be there; places that let nothing be written."""

import hashlib
import os
import re
import shutil
from pathlib import Path
from typing import NamedTuple

from program import BUILD, FAULTS, PROGRAM, SETTLING, SOURCE, Program, depth, main, preload, read, with_faults, write, write_sweep

# Options of a run and of settling that take a moment.
RUN = f"-q --until '40 us' --step '50 ns' {SETTLING}"
SETTLE = "settle tiny -q --time 20us --set start.ramp_time=10us"
TUNE = "tune tiny -q --accuracy '5 %' --outputs slip --write t.toml"
RESUME = "resume k.checkpoint -q --set run.max_steps=0"
# Kinds of files, and the original of which each is a copy; None: it is made.
KINDS = {"CSV": "numbers.csv", "FIFO": None, "checkpoint": "k.checkpoint", "folder": None, "foreign .part": "foreign.h5",
         "foreign record": "foreign.h5", "link": None, "link .part": None, "own .part": "own.h5", "own record": "own.h5",
         "page": "page.html",
         "picture": "picture.svg", "read-only": "notes.txt", "scene": "scene.toml", "state": "a.state", "table": "first/results.csv",
         "text": "notes.txt"}


COMPLETE = tuple(kind for kind, of in KINDS.items() if of and kind != "read-only" and not kind.endswith(".part"))


class _Writer(NamedTuple):
    """A command, the file that it would write, and kinds that it replaces: complete files under its default name in results/."""

    name: str
    line: str
    target: str
    replaces: tuple = ()


WRITERS = (
    _Writer("run -o", f"run tiny -o t.h5 {RUN}", "t.h5"),
    _Writer("run", f"run tiny {RUN}", "results/tiny.h5", COMPLETE),
    _Writer("run, checkpoint", f"run tiny -o t.h5 --checkpoint-every '1 us' {RUN}", "t.checkpoint"),
    _Writer("settle -o", f"{SETTLE} -o t.h5", "t.h5"),
    _Writer("settle", SETTLE, "tiny.state"),
    _Writer("resume -o", "resume k.checkpoint -q -o t.h5", "t.h5"),
    _Writer("report -o", "report own.h5 -o t.html", "t.html"),
    _Writer("report", "report own.h5", "own.html"),
    _Writer("report of a sweep", "report first", "first/report.html"),
    _Writer("plot -o", "plot own.h5 slip -o t.svg", "t.svg"),
    _Writer("plot", "plot own.h5 slip", "own.svg"),
    _Writer("plot of CSV", "plot own.h5 slip -o t.csv", "t.csv"),
    _Writer("export --csv", "export own.h5 --csv t.csv", "t.csv"),
    _Writer("export --vtk", "export own.h5 --vtk t.pvd", "t.pvd"),
    _Writer("export --vtk, states", "export own.h5 --vtk t.pvd", "t/t_000000.vtu"),
    _Writer("export-fmu -o", "export-fmu tiny -q -o t.fmu", "t.fmu"),
    _Writer("export-fmu", "export-fmu tiny -q", "tiny.fmu"),
    _Writer("batch", "batch sweep.toml -q -o out", "out/results.csv"),
    _Writer("batch, facts", "batch sweep.toml -q -o out", "out/sweep.json"),
    _Writer("batch, sweep", "batch sweep.toml -q -o out", "out/sweep.toml"),
    _Writer("batch, records", "batch recorded.toml -q -o out --threads 1", "out/records/case-000000.h5"),
    _Writer("tune --write", TUNE, "t.toml"),
    _Writer("tune --write, state", TUNE, "t.state"),
)


def files(folder="."):
    """Everything below a folder: its type and a hash of its contents, by name."""
    found = {}
    for path in Path(folder).rglob("*"):
        status = path.lstat()
        what = os.readlink(path) if path.is_symlink() else hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
        found[str(path)] = (status.st_mode >> 12, what)
    return found


class _Files(Program):
    """Has own.h5 and foreign.h5 (records of tiny and of another scene), own's page.html and picture.svg, a.state, k.h5 with its
    checkpoint, first/ (a finished sweep), sweep.toml (another) and recorded.toml (with records), scene.toml, numbers.csv, notes.txt."""

    def make(self):
        write("scene.toml", '[chain]\npins = 24\npitch = "16.6 mm"\n[plate]\ncount = 4\n[pulley]\ncentre_distance = "100 mm"\n[detail]\n'
                            'plates = "lumped"\njoint_points = 1\npulleys = "rigid"\n[start]\nsettling_time = "20 us"\nramp_time = "10 '
                            'us"\n[run]\nuntil = "20 us"\n')
        write("numbers.csv", "time [s],load [N*m]\n0,1\n1,2\n")
        write("notes.txt", "mine\n")
        write_sweep("6", "20 us")
        for line in (f"run tiny -o own.h5 {RUN}", f"run tiny -o foreign.h5 --set scene.name=other {RUN}", "report own.h5 -o page.html",
                     "plot own.h5 slip -o picture.svg", f"{SETTLE} -o a.state", "batch sweep.toml -q -o first"):
            self.cvtflow(line)
        self.cvtflow(f"run tiny -o k.h5 --checkpoint-every '1 h' --set run.max_steps=500 {RUN}", 4)
        write_sweep("7", "20 us")
        write_sweep("7", "20 us", name="recorded.toml", outputs="records = true\n")

    def kept(self, before, what):
        """No file is missing or changed."""
        after = files()
        self.assertEqual({name: after.get(name) for name in before}, before, what)

    def forget_new(self, before):
        for path in sorted(Path(".").rglob("*"), reverse=True):
            if str(path) not in before:
                (os.rmdir if path.is_dir() and not path.is_symlink() else os.remove)(path)


def put(kind, target):
    """Puts a file of a kind at the target, or at its .part."""
    path = Path(target + ".part" * kind.endswith(".part"))
    path.parent.mkdir(parents=True, exist_ok=True)
    if KINDS[kind]:
        shutil.copyfile(KINDS[kind], path)
        os.chmod(path, 0o400 if kind == "read-only" else 0o644)
    elif kind == "FIFO":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to(os.path.abspath("notes.txt" if kind == "link" else "nowhere"))


class EveryWriter(_Files):
    def try_over(self, kind, writer):
        put(kind, writer.target)
        before, what = files(), f"{writer.name} over {kind}"
        done = self.cvtflow(writer.line, None)  # ends within the time of wait(), also where it could wait for the FIFO's reader
        if kind in writer.replaces:
            self.assertEqual(done.status, 0, f"{what}: {done.err}")
            del before[writer.target]
        else:
            self.assertEqual(done.status, 1, f"{what}: {done.err}")
            self.has(done.err, writer.target)
            continues = writer.name == "export --vtk, states"  # and so refuses what is not its own first
            link = kind == "link .part" or (kind == "link" and not continues)
            self.has(done.err, ": a symbolic link; name its target" if link else ": ")
        self.kept(before, what)
        self.assertFalse(os.path.exists("nowhere"), what)

    def test_loses_no_file_that_is_not_of_the_same_kind_and_run(self):
        """Every command over every kind of file; quick: every command over two kinds, every kind under some."""
        nothing, tried, each = files(), [], depth(9, 1)
        for row, writer in enumerate(WRITERS):
            for column, kind in enumerate(KINDS):
                if (row + column) % each == 0:
                    self.try_over(kind, writer)
                    self.forget_new(nothing)
                    tried.append(kind)
        print(f"{len(tried)} pairs of a command and a file that was there; none was lost")
        self.assertEqual(set(tried), set(KINDS))

    @with_faults
    def test_loses_no_file_that_appears_meanwhile(self):
        """A foreign file that takes the name while a command works; not a default name, nor those that continue, nor slow tuning."""
        nothing = files()
        for writer in WRITERS:
            if writer.name in ("run", "resume -o") or writer.name.startswith("batch") or writer.line == TUNE:
                continue
            done = self.cvtflow(writer.line, 1, LD_PRELOAD=preload(), CVTFLOW_APPEARS=os.path.abspath(writer.target))
            self.has(done.err, writer.target + ": a")
            for part in re.findall("meanwhile and it stays; the file of this one is (.*)", done.err):
                self.assertTrue(os.path.exists(part), part)
            self.assertEqual(read(writer.target), "mine\n", writer.name)
            self.kept(nothing, writer.name)
            self.forget_new(nothing)

    def test_replaces_another_file_by_force(self):
        nothing = files()
        for writer in WRITERS:
            if writer.name in ("run -o", "settle -o", "report -o", "plot -o", "export --csv", "export --vtk"):
                put("text", writer.target)
                self.cvtflow(writer.line + " --force")
                self.assertNotEqual(Path(writer.target).read_bytes(), b"mine\n", writer.name)
                self.forget_new(nothing)


class Replacement(_Files):
    def test_loses_no_input_by_force(self):
        """--force replaces other files, and no input under whatever name, nor what a run needs for itself."""
        for name in ("drive.csv", "drive.toml"):
            shutil.copy(f"{SOURCE}/scenes/{name}", name)
        for old, new in (("scene.toml", "same.toml"), ("a.state", "d.h5.part"), ("notes.txt", "b.h5.part")):
            os.link(old, new)
        by_state, scene = "--set start.state=a.state", "run scene.toml -q"
        replaced = ": cannot create: it would replace the input "
        before = files()
        for line, message in (
                (f"{scene} -o scene.toml", f"scene.toml{replaced}scene.toml"),
                (f"{scene} -o ./same.toml", f"./same.toml{replaced}scene.toml"),
                ("settle scene.toml -q -o scene.toml", f"scene.toml{replaced}scene.toml"),
                ("run tiny -q -o k.h5 --checkpoint-every '1 h' --set start.state=k.checkpoint", f"k.checkpoint{replaced}"),
                (f"{scene} -o b.h5", "b.h5.part: cannot create: File exists"),
                (f"{scene} {by_state} -o d.h5", "d.h5: cannot create: its .part would replace the input "),
                (f"run drive.toml -o drive.csv {RUN}", f"drive.csv{replaced}"),
                (f"run tiny -o a.state {RUN} {by_state}", f"a.state{replaced}"),
                (f"settle tiny -o a.state -q {by_state}", f"a.state{replaced}"),
                ("resume k.checkpoint -q -o k.checkpoint", f"k.checkpoint{replaced}k.checkpoint"),
                (f"export-fmu tiny -o a.state -q {by_state}", f"a.state{replaced}"),
                (f"tune tiny -q --accuracy '5 %' --write a.toml {by_state}", f"a.state{replaced}"),
                ("report own.h5 -o own.h5", f"own.h5{replaced}"),
                ("report first -o first/results.csv", f"first/results.csv{replaced}"),
                ("export own.h5 --csv own.h5", f"own.h5{replaced}"),
                *[("cvtflow-lab profile scene.toml --trace scene.toml",
                   f"scene.toml{replaced}scene.toml")] * (BUILD / "cvtflow-lab").exists()):
            self.has(self.err(line if "profile" in line else line + " --force"), message)  # which has no such option
            self.assertEqual(files(), before, line)

    def test_a_failed_series_leaves_the_former_one(self):
        self.cvtflow("export own.h5 --vtk t.pvd")
        before = files()
        for fault in ("fsync:1", "rename:1") if FAULTS.exists() else ():
            self.cvtflow("export own.h5 --vtk t.pvd --force", 1, LD_PRELOAD=preload(), CVTFLOW_FAULT=fault)
            self.assertEqual(files(), before, fault)

    def test_of_a_series_removes_only_files_of_its_name(self):
        for name, text in (("mine", "mine"), ("t_notes", "mine"), ("t_000099", "of a former series")):
            write(f"t/{name}.vtu", text)
        self.cvtflow("export own.h5 --vtk t.pvd", 1)
        self.cvtflow("export own.h5 --vtk t.pvd --force")
        self.assertEqual(read("t/mine.vtu") + read("t/t_notes.vtu"), "minemine")
        self.assertEqual((os.path.exists("t/t_000099.vtu"), os.path.exists("t/t_000000.vtu")), (False, True))

    def test_leaves_the_rows_of_a_killed_run_to_who_asks_for_them(self):
        """They are the only copy."""
        os.mkdir("results")
        shutil.copy("own.h5", "results/tiny.h5.part")
        before = files()
        self.assertEqual(self.err(f"run tiny {RUN}"), "cvtflow: results/tiny.h5.part: already exists, left by a command that was "
                                                      "killed (cvtflow info shows the rows of a run); --force replaces it\n")
        self.assertEqual(files(), before)
        shutil.copy("k.checkpoint", "results/tiny.checkpoint")
        self.has(self.err(f"run tiny {RUN}"), ": the checkpoint of an unfinished run; cvtflow resume results/tiny.checkpoint continues "
                                              "it, --force starts again\n")
        self.cvtflow(f"run tiny --force {RUN}")
        self.assertEqual(os.listdir("results"), ["tiny.h5"])
        self.cvtflow(f"run tiny {RUN}")

    def test_resume_replaces_no_record_of_another_run_and_a_checkpoint_only_by_its_end(self):
        """An archive with a checkpoint and a .part beside a record of that name. The state of a checkpoint is in no finished record."""
        os.rename("k.h5", "k.h5.part")
        for there in ("foreign.h5", "own.h5", "notes.txt"):
            shutil.copy(there, "k.h5")
            before = files()
            self.matches(self.err(RESUME), r"\Acvtflow: k.h5: ")
            self.assertEqual(files(), before, there)
            os.remove("k.h5")
        before = files()
        self.has(self.err(f"{RESUME} --until '1 us'"), "is before the checkpoint")
        self.cvtflow(f"{RESUME} -o none")
        self.kept(before, "the checkpoint")
        self.cvtflow(RESUME)
        self.assertFalse(os.path.exists("k.checkpoint"))

    def test_gives_names_with_dots_side_files_of_their_name(self):
        for name in ("run_0.1", "run_0.2"):
            self.cvtflow(f"run tiny -o {name} --checkpoint-every '1 h' --set run.max_steps=500 {RUN}", 4)
            self.cvtflow(f"report {name}")
            self.cvtflow(f"plot {name} slip")
            self.assertTrue(all(os.path.exists(name + ending) for ending in (".checkpoint", ".html", ".svg")), name)
        self.cvtflow("resume run_0.1.checkpoint -q --set run.max_steps=0")
        self.assertTrue(os.path.exists("run_0.2.checkpoint"))

    def test_waits_for_no_pipe(self):
        os.makedirs("a/b/c")
        shutil.copy(PROGRAM, "a/b/c/cvtflow")
        os.mkfifo("a/cvtflow-scenes.path")
        self.shell("timeout 20 a/b/c/cvtflow list scenes")
        os.remove("a/cvtflow-scenes.path")
        write("a/cvtflow-scenes.path", str(SOURCE / "scenes"))
        self.has(self.shell("a/b/c/cvtflow list scenes").stdout, "baseline")
        if os.geteuid() == 0:
            os.chown("a/cvtflow-scenes.path", 65534, 65534)  # a stranger's
            self.lacks(self.shell("a/b/c/cvtflow list scenes").stdout, "baseline")

    def test_keeps_the_mode_of_what_it_replaces_and_what_is_write_protected(self):
        self.cvtflow(f"run tiny {RUN}")
        os.chmod("results/tiny.h5", 0o600)
        self.cvtflow(f"run tiny {RUN}")
        self.assertEqual(os.stat("results/tiny.h5").st_mode & 0o777, 0o600)
        os.chmod("results/tiny.h5", 0o400)
        self.assertEqual(self.err(f"run tiny {RUN}"), "cvtflow: results/tiny.h5: already exists; --force replaces it\n")
        self.cvtflow(f"run tiny --force {RUN}")

    def test_of_earlier_commands_needs_no_folder_in_the_next_one(self):
        self.cvtflow(f"run tiny {RUN}")
        for line in ("info tiny.h5", "plot tiny.h5 slip", "report tiny.h5"):
            self.has(self.err(line, 0), "tiny.h5: reading results/tiny.h5")
        os.mkdir("results/slip")  # a channel is no folder
        self.cvtflow("plot tiny.h5 slip -o slip.svg")
        write("tiny.h5", "")
        self.lacks(self.err("info tiny.h5"), "results/")
        self.has(self.err("info absent.h5"), "absent.h5: No such file or directory")

    def test_reports_a_limit_of_file_sizes_as_an_error(self):
        self.cvtflow("report own.h5")
        before = files()
        self.has(self.shell('ulimit -f 8; "$CVTFLOW" report own.h5 --force', 1).stderr, "own.html: cannot write: File too large")
        self.assertEqual(files(), before)
        self.has(self.shell(f'ulimit -f 8; "$CVTFLOW" run tiny -o big.h5 {RUN}', 1).stderr, "File too large")

    def test_no_name_of_a_scene_or_a_sweep_is_a_path(self):
        for name in ("../../x", "/tmp/x", "a\\\\b", "..", ".x", "a\\u001b[2J", "a\\u0001", "a\\uFFFE", "x" * 201):
            write("named.toml", f'[scene]\nname = "{name}"\n')
            for command in ("check", "export-fmu"):
                self.has(text := self.err(f"{command} named.toml"), "named.toml:2:", "scene.name: ")
                self.lacks(text, "\x1b")
            write("named_sweep.toml", read("sweep.toml").replace("scene =", f'name = "{name}"\nscene =', 1))
            self.has(self.err("batch named_sweep.toml --dry-run"), "sweep.name: ")
        write("named.toml", '[scene]\ndescription = "a\\u0001b"\n')
        self.has(self.err("check named.toml"), "scene.description: contains a control character")
        self.cvtflow("export-fmu tiny -q --author 'a\x01' -o t.fmu", 2)
        shutil.copy(f"{SOURCE}/scenes/tiny.toml", "a\x1b[2J.toml")  # a file's name may contain anything
        shown = self.cvtflow(["check", "a\x1b[2J.toml"], None)
        self.lacks(shown.out + shown.err, "\x1b")


if __name__ == "__main__":
    main()
