"""Errors of users, and the one line of the message; answers to a command that is nearly right, and warnings."""

import os
import re
import subprocess
import unittest
from pathlib import Path

import h5py

from program import BRIEFLY, LAB, PROGRAM, SETTLING, Program, main, write

TIME = 'expected a time such as "30 s" or "10 min"'
ESTIMATE = "run.step_control: 'rk4' has no error estimate; only \"fixed\" steps are possible (cvtflow list methods --all)"
RK5 = "no method 'rk5' (did you mean 'rk4'?)"
BROKEN = ('broken.toml:2:1: chain.pich: unknown key (did you mean "chain.pitch"?)\n'
          'cvtflow: broken.toml:3:8: chain.pins: "x" is not an integer')
STEP = '--step 1: 1 s is outside [1e-12, 1e-2] s (did you mean "1 us"?)'
SETTLED = "add --settle, or a state file with --set start.state=FILE (cvtflow settle)"
LONG = "x" * 252  # 255 bytes at most, .part included

ON_THE_COMMAND_LINE = (
    ("", 2, "A subcommand is required (cvtflow --help)"),
    ("rum", 2, "no command 'rum', did you mean 'run'? (cvtflow --help, or cvtflow-lab rum)"),
    ("gearbox", 2, "no command 'gearbox' (cvtflow --help, or cvtflow-lab gearbox)"),
    ("run", 2, "SCENE is required (cvtflow run --help)"),
    ("run tiny extra", 2, "The following argument was not expected: extra (cvtflow run --help)"),
    ("run tiny --til 1ms", 2, "The following arguments were not expected: 1ms --til, did you mean '--until'? (cvtflow run --help)"),
    ("run tiny --frobnicate", 2, "The following argument was not expected: --frobnicate (cvtflow run --help)"),
    ("run tiny --dry-run", 2, "The following argument was not expected: --dry-run, did you mean 'cvtflow check'? (cvtflow run --help)"),
    ("check tiny --dry-run", 2, "The following argument was not expected: --dry-run (cvtflow check --help)"),
    ("info", 2, "FILE is required (cvtflow info --help)"),
    ("explain", 2, "KEY is required (cvtflow explain --help)"),
    ("list method", 2, "no list 'method', did you mean 'methods'?"),
    ("run tiny --checkpoint-every ''", 2, f"--checkpoint-every : {TIME}"),
    ("run tiny --checkpoint-every 7", 2, f"--checkpoint-every 7: {TIME}"),
    ("batch sweep.toml --worker", 2, "The following argument was not expected: --worker (cvtflow batch --help)"),
    ("merge out", 2, "no command 'merge' (cvtflow --help, or cvtflow-lab merge)"),
    ("batch sweep.toml --grace soon", 2, f"--grace soon: {TIME}"),
    *((f"batch sweep.toml --threads {n}", 2, f"--threads: Value {n} not in range 1 to 1024 (cvtflow batch --help)") for n in (-1, 0)),
)
IN_SCENES = (
    ("run basline", 1, "no scene 'basline' (did you mean 'baseline'?)"),
    ("run zzzzzzz", 1, "no scene 'zzzzzzz' (cvtflow list scenes)"),
    ("run brokn.toml", 1, "no scene 'brokn.toml' (did you mean 'broken.toml'?)"),
    ("run missing.toml", 1, "missing.toml: cannot be read: No such file or directory"),
    ("run ./folder", 1, "./folder: cannot be read: a folder, not a file"),
    ("run broken.toml", 1, BROKEN),
    ("check broken.toml", 1, BROKEN),
    ("check method.toml", 1, "method.toml:2:10: run.method: no method 'rk45' (did you mean 'rk4'?)\n"
                             'cvtflow: method.toml:3:1: run.stepp: unknown key (did you mean "run.step"?)'),
    ("run no_method.toml", 1, f"no_method.toml:2:10: run.method: {RK5}"),
    ("check no_member.toml", 1, "no_member.toml:2:10: run.method: rkc-s1 belongs to the laboratory: cvtflow-lab run SCENE --method rkc-s1"),
    ("check no_executor.toml", 1,
     "no_executor.toml:3:12: run.schedule: unknown executor 'flwo' (did you mean \"flow\"?) (cvtflow list executors; or auto)"),
    ("check no_estimate.toml", 1, f'no_estimate.toml:3:16: {ESTIMATE}\ncvtflow: no_estimate.toml:5:8: chain.pins: "x" is not an integer'),
    ("check text_state.toml", 1, "text_state.toml:2:9: start.state: FOLDER/text.h5: not a state"),
    ("run no_state.toml", 1, 'no_state.toml:2:9: start.state: no file "gone.h5"'),
    ("settle free_ring", 1, 'free_ring: nothing to settle: start.layout is "ring" or start.settling_time is 0'),
    ("run tiny --until stedy", 2, '--until stedy: "stedy" is neither a quantity nor "steady" (did you mean "steady"?)'),
    ("explain chain.pich", 1, 'chain.pich: unknown key (did you mean "chain.pitch"?)'),
    ("check nul.toml", 1, 'nul.toml:1:7: chain.pi\\x00ns: unknown key (did you mean "chain.pins"?)'),  # not cut off at the NUL
    ("batch scene.toml", 1, "scene.toml:4:2: chain: this is a scene, not a sweep; to run it: cvtflow run scene.toml"),
    ("run sweep.toml", 1, "sweep.toml:1:2: sweep: this is a sweep, not a scene; to run it: cvtflow batch sweep.toml"),
    ("batch tiny", 1, "no sweep 'tiny'; ready sweeps: operating_map, slip_efficiency, steady_map; to run the scene of that name: cvtflow "
                      "run tiny"),
    ("batch baseline", 1,
     "no sweep 'baseline'; ready sweeps: operating_map, slip_efficiency, steady_map; to run the scene of that name: cvtflow run baseline"),
    ("batch sweep.tml", 1, "no sweep 'sweep.tml' (did you mean \"sweep.toml\"?); ready sweeps: operating_map, slip_efficiency, steady_map"),
    ("run slip_efficiency", 1, "'slip_efficiency' is a ready sweep, not a scene; to run it: cvtflow batch slip_efficiency"),
)
IN_SETTINGS = (
    ("run tiny --method rk5", 2, f"--method rk5: {RK5}"),
    ("run tiny --method zzzzzz", 2, "--method zzzzzz: no method 'zzzzzz' (cvtflow list methods)"),
    ("run tiny --detail medium", 2, '--detail medium: not one of rigid, fine, full (use "fine", or "rigid" at lower cost)'),
    ("run tiny --detail fein", 2, '--detail fein: not one of rigid, fine, full (did you mean "fine"?)'),
    ("run tiny --set chain.pich=3", 2, '--set chain.pich=3: chain.pich: unknown key (did you mean "chain.pitch"?)'),
    ("run tiny --set chain.pins=abc", 2, '--set chain.pins=abc: chain.pins: "abc" is not an integer'),
    ("run tiny --set nonsense", 2, "--set nonsense: not of the form key=value"),
    ("run tiny --until '5 mm'", 2, "--until 5 mm: 5 mm is a length, expected a time (s)"),
    ("run tiny --until=-1", 2, "--until -1: -1 s is outside [1e-9, 1e4] s"),
    ("run tiny --until ''", 2, '--until : "" does not begin with a number'),
    ("run tiny --step 1", 2, STEP),
    ("run tiny --threads=-1", 2, "--threads -1: -1 is outside [0, 1024]"),
    ("run tiny --segments 30", 2, "--segments 30: 30 segments for chain.pins = 24"),
    ("run tiny --set run.assembly=staged", 2,
     '--set run.assembly=staged: run.assembly: "staged" belongs to the laboratory: cvtflow-lab run'),
    ("run tiny --tolerance 1", 2, f"--tolerance 1: {ESTIMATE}"),  # blames no setting that was not given
    ("settle tiny --method rk5", 2, f"--method rk5: {RK5}"),
    ("settle tiny --step 1", 2, STEP),
    ("settle tiny --threads=-1", 2, "--threads -1: -1 is outside [0, 1024]"),
    ("settle tiny --time 3ms", 2, "--time 3ms: start.ramp_time: 5e-3 s is longer than start.settling_time = 3e-3 s"),
    ("tune tiny --accuracy '80 %'", 2, '--accuracy 80 %: expected a share above 0 and up to 50 %, such as "1 %"'),
)
OF_THE_LABORATORY = (
    ("local-error tiny", 1, f"tiny: the start is not settled, so its errors are meaningless: {SETTLED}"),
    ("spectrum tiny -q", 1, f"tiny: the start is not settled, so its eigenvalues are meaningless: {SETTLED}"),
    ("stability rk4 --scene basline -q", 1, "no scene 'basline' (did you mean 'baseline'?)"),
    ("stability", 2, "METHOD is required (cvtflow-lab stability --help)"),
    ("local-error tiny --friction x", 2, "--friction: x not in {piecewise,smoothed,both} (cvtflow-lab local-error --help)"),
    ("run tiny --method rkc-s1", 2,
     "--method rkc-s1: no method 'rkc-s1': rkc-s<stages>[-e<damping>] takes 2 to 400 stages, damping 0 to 100 (2/13 if absent)"),
    ("spectrum tiny --state gone.h5", 2, '--state gone.h5: no file "gone.h5"'),
    ("spectrum tiny --method rk5", 2, f"--method rk5: {RK5}"),
    ("dot tiny --cycle x", 2, "--cycle x: a step of rk4 has evaluate, detect, locate, truncate"),
    ("dot tiny --method leapfrog-sweep --cycle x", 2,
     "--cycle x: a step of leapfrog-sweep has evaluate, detect, locate, truncate, record, friction"),
    ("stability dumka3", 2, "dumka3 is no table of stages: cvtflow check states its limit on a scene"),
    ("stability rk5", 2, RK5),
    ("local-error tiny --settle --methods rk4,heum", 2, "no method 'heum' (did you mean 'heun'?)"),
    ("compare tiny rk4", 2, "rk4: write METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE for steps by error"),
    ("compare tiny rk4@50mm", 2, "rk4@50mm: '50mm' is not a time above 0, such as 40ns"),
    ("compare tiny rk5@50ns", 2, RK5),
    ("compare tiny rk4@50ns --duration 0s", 2, "--duration: '0s' is not a time above 0, such as 40ns"),
    ("compare tiny rk4@50ns --pin 24", 2, '--pin 24: the chain has pins 0 to 23; or "first"'),
    ("local-error tiny --settle --steps 3mm", 2, "--steps 3mm: '3mm' is not a time above 0, such as 40ns"),
)
IN_FILES = (
    ("info missing.h5", 1, "missing.h5: No such file or directory"),
    ("info folder", 1, "folder: a folder without results of a sweep (sweep.json)"),
    ("info text.h5", 1, "text.h5: not an HDF5 file"),
    ("info scene.toml", 1, "scene.toml: a scene or a sweep, not a result"),
    *((f"{command} pipe", 1, "pipe: not a regular file") for command in ("info", "resume")),
    ("info /dev/zero", 1, "/dev/zero: not a regular file"),
    ("check ./pipe", 1, "./pipe: cannot be read: not a regular file"),
    ("check /dev/zero", 1, "/dev/zero: cannot be read: not a regular file"),
    ("batch /dev/zero -o sweep", 1, "/dev/zero: cannot be read: not a regular file"),
    ("check large.toml", 1, "large.toml: cannot be read: 70000000 bytes, more than the 4194304 that such a file may have"),
    ("info other.h5", 1, "other.h5: an HDF5 file, but not a record of a run"),
    ("info cut_record.h5", 1, "cut_record.h5: truncated HDF5 file: 2000 bytes of {record}"),
    ("info cut.state", 1, "cut.state: a damaged state: its checksum differs"),
    ("table text.h5", 1, "text.h5: not a sweep's table as cvtflow table --csv prints it"),
    ("resume nothing.h5", 1, "nothing.h5: No such file or directory"),
    ("resume a.state", 1, "a.state: a state, but not a checkpoint: it has no valid field 'started'"),
    ("resume folder", 1, "folder: contains no sweep"),
    *((f"{command} {'a' * 300}", 1, "a" * 300 + ": File name too long") for command in ("table", "resume")),
    ("run tiny --set start.state=gone.h5", 2, '--set start.state=gone.h5: start.state: no file "gone.h5"'),
    ("run tiny --set start.state=text.h5", 1, "--set start.state=text.h5: start.state: FOLDER/text.h5: not a state"),
    ("run tiny --set start.state=cut.state", 1,
     "--set start.state=cut.state: start.state: FOLDER/cut.state: a damaged state: its checksum differs"),
    ("resume record.h5", 1, "record.h5: an HDF5 file, not a state; if it is one of version 0.4, settle or run again"),
    *((f"{command} tiny --set start.state=a.state --set detail.pulleys=rigid", 1,
       "--set start.state=a.state: start.state: FOLDER/a.state contains 1032 unknowns, this scene has 968\n"
       '  detail.pulleys = "rigid", settled with "elastic"') for command in ("run", "check")),
)
OF_PLACES = (  # before the work
    *((f"{command} tiny -o {place}", 1, f"{place}: cannot create: {why}") for command in ("run", "settle")
      for place, why in (("missing/x.h5", "the folder 'missing' does not exist"), ("folder", "a folder, not a file"))),
    (f"run tiny -o {LONG}", 1, f"{LONG}.part: cannot create: File name too long"),
    ("batch sweep.toml -o text.h5", 1, "text.h5: cannot create: File exists"),
    ("batch sweep.toml -o no/such", 1, "no/such: cannot create: the folder 'no' does not exist"),
    ("batch sweep.toml -o /proc/here", 1, "/proc/here: cannot create: No such file or directory"),
)


class Errors(Program):
    def make(self):
        """Files to stumble over."""
        for name, text in {
                "text.h5": "no HDF5 at all\n", "broken.toml": '[chain]\npich = 3\npins = "x"\n', "syntax.toml": "[chain\n",
                "large.toml": "",
                "method.toml": '[run]\nmethod = "rk45"\nstepp = "50 ns"\n', "no_method.toml": '[run]\nmethod = "rk5"\n',
                "no_estimate.toml": '[run]\nmethod = "rk4"\nstep_control = "error"\n[chain]\npins = "x"\n',
                "text_state.toml": '[start]\nstate = "text.h5"\n', "no_member.toml": '[run]\nmethod = "rkc-s1"\n',
                "no_executor.toml": '[run]\n\nschedule = "flwo"\n', "no_state.toml": '[start]\nstate = "gone.h5"\n',
                "nul.toml": 'chain."pi\\u0000ns" = 3\n', "scene.toml": '[scene]\nname = "t"\n\n[chain]\npins = 24\n\n[tips]\nx = 1\n',
                "sweep.toml": '[sweep]\nscene = "tiny"\n[[axes]]\nkey = "load.torque"\nvalues = [1, 2]\n[outputs]\n'
                              'scalars = ["slip mean"]\n'
                }.items():
            write(name, text)
        os.truncate("large.toml", 70_000_000)
        os.mkdir("folder")
        h5py.File("other.h5", "w").close()
        self.cvtflow(f"run {BRIEFLY} -q -o record.h5")
        self.cvtflow("settle tiny -q -o a.state --time 20us --set start.ramp_time=10us")
        for name, cut in (("record.h5", "cut_record.h5"), ("a.state", "cut.state")):
            Path(cut).write_bytes(Path(name).read_bytes()[:2000])

    def expect(self, mistakes, program="cvtflow"):
        """All of stderr, without the last line break; FOLDER represents the working directory."""
        if not os.path.exists("pipe"):
            os.mkfifo("pipe")  # which cannot be copied
        sizes = {"record": os.path.getsize("record.h5") - 32}  # without the seal
        for line, status, message in mistakes:
            with self.subTest(line):
                message = re.sub(r"\{(record|state)\}", lambda found: str(sizes[found[1]]), message).replace("FOLDER", os.getcwd())
                done = self.cvtflow(line if program == "cvtflow" else f"{program} {line}", status)
                self.assertEqual((done.err, done.out), (f"{program}: {message}\n", ""))

    def test_on_the_command_line_and_in_values_of_options(self):
        self.expect(ON_THE_COMMAND_LINE)
        for value in ("nonsense", ""):
            self.assertTrue(self.err(f"batch sweep.toml --retry '{value}'", 2).startswith(
                f"cvtflow: --retry {value}: not one of ok, unreliable, diverged, budget, "))
        self.assertFalse(os.path.exists("results/sweep"))

    def test_in_scenes_say_where_and_what(self):
        self.expect(IN_SCENES)
        self.assertTrue(self.err("check syntax.toml").startswith("cvtflow: syntax.toml:1:"))

    def test_in_settings_name_the_option_that_was_given(self):
        self.expect(IN_SETTINGS)

    @unittest.skipUnless(LAB.exists(), "no laboratory")
    def test_of_the_laboratory_name_the_option(self):
        self.expect(OF_THE_LABORATORY, "cvtflow-lab")

    def test_in_files_say_what_the_file_is(self):
        self.expect(IN_FILES)

    def test_of_places_come_before_the_work(self):
        self.expect(OF_PLACES)

    def test_in_the_program_name_the_other_one(self):
        if LAB.exists():
            for command in commands_of(LAB) - commands_of(PROGRAM):
                self.has(self.err(command, 2), f"(cvtflow --help, or cvtflow-lab {command})\n")
            self.assertEqual(self.err("cvtflow-lab report", 2),
                             "cvtflow-lab: no command 'report' (cvtflow-lab --help, or cvtflow report)\n")


def commands_of(program):
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    return {name for part in re.findall(r"^Commands .*\n((?:  .*\n)+)", text, re.MULTILINE)
            for name in re.findall("^  ([^ ]+)", part, re.MULTILINE)}


class Messages(Program):
    """Parts of a message: (command line, exit status, parts of stderr)."""

    def expect(self, *rows):
        for line, status, *parts in rows:
            with self.subTest(line):
                self.has(self.err(line, status), *parts)

    def test_know_the_words_of_the_field_and_how_a_setting_is_written(self):
        write("sweep.toml", '[sweep]\nscene = "tiny"\n[[axes]]\nkey = "load.torque"\nfrom = 1\nto = 2\nstep = 1\n[outputs]\n'
                            'scalars = ["slip mean"]\n')
        self.expect(
            *((f"check tiny --set {key}=1", 2, f'unknown key (did you mean "{meant}"?)') for key, meant in (
                ("pulley.sheave_angle", "tip.angle"), ("tip.mu", "tip.friction_coefficient"), ("run.duration", "run.until"),
                ("pulley.center_distance", "pulley.centre_distance"), ("load.output_torque", "load.torque"))),
            ("batch sweep.toml --dry-run", 1, 'axes.step: unknown key (did you mean "count"?)'),
            ("run tiny --set load.torque '120 Nm'", 2, "did you mean '--set load.torque=\"120 Nm\"'?"),
            ("baseline", 2, "no command 'baseline', did you mean 'cvtflow run baseline'?"),
            ("operating_map", 2, "did you mean 'cvtflow batch operating_map'?"),
            ("""check tiny --set 'record.channels=["tips/*", "tips/normal_froce"]'""", 2,
             "unknown channel 'tips/normal_froce' (did you mean \"tips/normal_force\"?)"),
            ("run tiny --isa sse9", 2, 'instruction set "sse9" is unknown'),
            ("tune tiny", 2, "--accuracy is required"),
            ("tune tiny --accuracy '1 %' --outputs slipp -q", 1, "outputs: slipp is not one of slip, "),
            ("run tiny --accuracy '1 %' --method rk4", 2),  # the method is what is found
            ("run tiny --budget '1 s'", 2))  # of what?
        blamed = self.err("run baseline --set chain.pins=20", 2)
        self.assertTrue(blamed.startswith("cvtflow: chain.pins = 20 (was 84): chain.pins: 20 pins make a chain of "), blamed)
        self.lacks(blamed, "start.state")  # which was not given

    def test_of_csv_inputs_have_the_place_in_scene_and_file(self):
        write("load.csv", "t,M\n0,12\n1,1e9\n")
        self.expect(("""check tiny --set 'load.torque={csv = "load.csv"}'""", 2,
                     "load.torque: 1e9 N*m is outside [-1e5, 1e5] N*m (load.csv:3:2)"))

    def test_of_an_export_leave_no_file(self):
        self.expect(("export-fmu tny", 1, "did you mean 'tiny'"), ("export-fmu tiny --fmi 4", 2, "--fmi"),
                    ("export-fmu tiny --outputs rato", 2, 'did you mean "ratio"'),
                    ("export-fmu tiny --inputs drive_torque", 2, "the scene has no 'drive_torque'"),
                    ("export-fmu tiny --parameters tip.frction_coefficient", 2, 'did you mean "tip.friction_coefficient"'),
                    ("export-fmu tiny -o /nowhere/tiny.fmu", 1, "/nowhere"))
        self.assertEqual(os.listdir(), [])

    def test_of_rigid_pins_say_what_they_do_not_have(self):
        self.expect(*((f"run tiny --detail rigid --set run.method=leapfrog-rigid --set run.step=2us --set {setting}", 2, text)
                      for setting, text in (("run.method=leapfrog-sweep", "method 'leapfrog-sweep' requires detail.pins = \"halves\""),
                                            ("detail.plates=each", 'has "lumped" plates'), ("run.schedule=flow", "runs on one thread"),
                                            ("detail.stick_slip=true", "no phases stick and slip"), ("run.segments=2", "is one segment"),
                                            ("joint.law=palmgren", 'joints of law "linear"'))))

    def test_name_the_ready_sweeps(self):
        self.has(self.out("list sweeps"), "\noperating_map", "\nslip_efficiency")

    def test_name_the_records_in_a_folder_without_a_sweep(self):
        os.mkdir("results")
        self.cvtflow(f"run {BRIEFLY} -q -o results/a.h5")
        self.expect(*((f"{command} results", 1, "results: a folder without results of a sweep (sweep.json); it contains results/a.h5: "
                                                "name one of these files") for command in ("report", "plot --x case --y wall", "table", "info")))

    def test_state_what_a_bare_number_of_a_long_run_means(self):
        for until, text in (("10", '--until 10: a number without a unit is in seconds; "10 ms" are'), ("'10 s'", ""), ("0.001", "")):
            said = self.err(f"check tiny {SETTLING} --until {until}", 0)
            self.assertTrue(text in said and bool(text) == bool(said), said)

    def test_of_help_are_brief(self):
        self.has(self.out("--help"), "  7    target accuracy missed", *(f"\n  {status} " for status in (0, 1, 2, 3, 4, 130)))
        for command in ("run", "batch", "resume", "tune"):
            self.has(text := self.out(f"{command} --help"), "cvtflow --help")
            self.lacks(text, "target accuracy missed")


class Check(Program):
    def test_states_why_the_first_steps_fail(self):
        failed = self.cvtflow("check baseline --set chain.pins=100", 1)
        self.matches(failed.err, "baseline: the run fails in its first steps: pin .* runs on a radius of .*, off the sheave")
        self.has(failed.out, "not measured: it fails in its first steps: pin ")

    def test_warns_of_a_load_beyond_the_torque_limit(self):
        """2 mu S_2 r_2/cos(beta) = 2 0.09 20 kN 54.4 mm/cos(11 deg) = 199.7 N m."""
        light, heavy = self.out("check baseline"), self.out("check baseline --set load.torque=900")
        self.has(light, "682.08 mm, 84 pins", "54.44 mm driving, 54.44 mm driven; arcs 180 deg, 180 deg", "pins pass           1404 Hz",
                 "199.7 N*m on the driven pulley", "load 150 N*m: safety factor 1.33\n")
        self.lacks(light, "exceeds the limit: the chain slips")
        self.has(heavy, "safety factor 0.222\n", "the load exceeds the limit: the chain slips")
        self.has(self.out("check baseline --set drag.driven_seals=250"), "load and drag 400 N*m: safety factor 0.499\n")
        self.lacks(self.out("check free_ring"), "torque limit")  # it has no pulleys

    def test_sizes_pressures_and_control(self):
        self.has(self.out("check vl300 --json"), '"decided_by": "clamping.safety"', '"driven_pressure": "Pa"')
        torque = self.out("check vl300 --for-torque '330 Nm' --safety 1.3")
        self.has(torque, "bar on shaft 2 are above hydraulics.relief_pressure, 60 bar")
        self.lacks(torque, "evaluations", "torque limit        ")  # of the scene's load
        self.has(self.out("check baseline --for-torque '60 Nm' --set drive.speed='5000 rpm'"), "S_2 is at least 18.75 kN: rotating oil")
        self.has(self.out("check urban_cycle"), "fastest shift: S_1 is at least 0.6826 kN: the ratio shifts more slowly than its target")
        self.matches(self.out("""check control --set 'control.ratio=[[0, 1], ["0.5 s", 1.6]]' --until '0.5 s'"""),
                     "control has to add -.* kN to clamping.driving, its authority is 10 kN: change one of both")
        self.has(self.out("check manoeuvre"), "not sized           a controller of slip makes S_2 in the run")
        for line, text in (("tiny --for-torque '3 kN'", "--for-torque 3 kN: expected a torque"),
                           ("tiny --for-torque '1e308 Nm'", "--for-torque 1e308 Nm: expected a torque"),
                           ("free_ring --for-torque '3 Nm'", "--for-torque: free_ring: it has no pulleys"), ("tiny --safety 2",
                                                                                                             "--for-torque")):
            self.has(self.err(f"check {line}", (1, 2)), text)

    def test_reports_what_a_scene_is(self):
        text = self.out("check tiny --step '50 ns'")
        # Order 1: 4 (1 + 1) + 4 coordinates per link. Steps: (1 + 10) ms of 50 ns.
        self.has(text, "516 coordinates (24 links x 20 + pulleys 36), 1 032 unknowns\n", "geometric at ratio 1, settles for 10 ms\n",
                 "20 000 + 200 000 for settling\n", "880 000, plus transitions\n", "\n  schedule            auto, segments chosen "
                                                                                   "automatically\n")
        self.matches(text, r"states? every [^\n]*, up to [0-9.]+ [kM]?B\n", r"\n  time                about [0-9:.]+( s)? on one thread")
        self.has(self.out("check tiny --set run.segments=3"), "\n  schedule            auto, 3 segments\n")
        self.lacks(text, "stable to")  # there is no state yet
        self.has(self.out("check baseline --detail rigid --set run.method=leapfrog-rigid --set run.step=2us"),
                 "rigid (lumped plates, rigid pins, elastic pulleys)")

    def test_reports_up_to_where_a_settled_scene_is_stable(self):
        self.matches(self.out("check control --step '6 us'"),
                     r"\n  stable to +5 us \(as long as friction is accurate\); run.step exceeds this limit\n")
        for step in ("4.5 us", "auto"):
            self.lacks(self.out(f"check control --step '{step}'"), " exceeds this limit")
        if LAB.exists():
            self.matches(self.out("cvtflow-lab check control --method trapezoidal-once"), "\n  stable to +linear stability sets no limit\n")

    def test_a_run_reports_where_the_automatic_step_does_not_hold(self):
        """Friction that saturates at a thousandth of the usual speed, from a state that has settled with that."""
        self.has(self.err("run baseline --set tip.saturation_speed=1e-5 --until '0.05 ms' -q -o none", 6),
                 'run.step = "auto" is too long here; use ')


if __name__ == "__main__":
    main()
