"""Runs: what `cvtflow run` and `settle` record, report and leave, on every detail; streams that are closed; help, lists and completions;
tuning."""

import csv
import json
import os
import pty
import re
import runpy
import subprocess
from pathlib import Path

from messages_test import commands_of
from program import (BRIEFLY, BUILD, LAB, PROGRAM, SETTLING, SOURCE, Program, attribute, channel, fact, hash_in, main, read,
                     rows_of, words_of, write, write_sweep)


class Run(Program):
    def test_records_in_results_and_sums_up_and_reports_a_record_that_it_replaces(self):
        first = self.cvtflow(f"run {BRIEFLY}")
        self.assertTrue(first.out.startswith("tiny: finished at t = 2e-05 s\n"))
        self.has(first.out, "\n  method ", "\n  state hash ", "\n  machine ", "\n  program ", "\n  record              results/tiny.h5 (")
        self.lacks(first.out, "temperature", "hydraulics", "coupling of shaft", "clamping_limit")  # of what the scene has not
        self.assertEqual((attribute("results/tiny.h5", "status"), rows_of("results/tiny.h5")), ("finished", 3))  # 0, 10, 20 us
        self.lacks(first.err, "replaced")
        self.assertTrue(self.err(f"run {BRIEFLY}", 0).startswith("cvtflow: results/tiny.h5: the existing file is replaced\n"))

    def test_without_output_records_nothing_and_quiet_prints_nothing_but_errors(self):
        self.has((done := self.cvtflow(f"run {BRIEFLY} -o none")).out, "\n  record              none\n")
        self.assertEqual((done.err, os.listdir()), ("", []), "a line of progress every 10 s")
        done = self.cvtflow(f"run {BRIEFLY} -q")
        self.assertEqual((done.out, done.err, os.path.exists("results/tiny.h5")), ("", "", True))
        bad = self.cvtflow(f"run {BRIEFLY} -q --set run.max_steps=10", 4)
        self.assertEqual(bad.out, "")
        self.assertTrue(bad.err.startswith("cvtflow: the budget of 10 steps (run.max_steps) is used up at t = "), bad.err)

    def test_sums_up_what_its_scene_has(self):
        for settings, part in (("'wear.clamping_limit=[[0, 1], [0.1, 0.5]]'", "clamping exceeds wear.clamping_limit at its slip speed in "
                                                                              "100 % of the"),
                               ("heat.enabled=true", "\n  temperature         pulleys 353.15"), ("heat.enabled=true", " to ambient\n")):
            self.has(self.out(f"run {BRIEFLY} -o none --set {settings}"), part)
        self.lacks(self.out(f"run {BRIEFLY} -o none --set 'wear.clamping_limit=[[0, 1e6], [0.1, 1e6]]'"), "clamping_limit")
        text = self.out(f"""run {BRIEFLY} -o coupled.h5 --set load.mode=coupling --set 'load.speed=209 rad/s' --set
                        'record.channels=["shaft_2/twist", "shaft_2/coupling_energy", "shaft_2/coupling_work"]'""")
        twist, energy, work = (channel("coupled.h5", f"shaft_2/{name}")[-1] for name in ("twist", "coupling_energy", "coupling_work"))
        self.has(text, f"\n  coupling of shaft 2 twist {twist:.4g} rad, {energy:.4g} J stored at the end; far end: took {-work:.4g} J;")
        self.lacks(text, "coupling of shaft 1")
        text = self.out(f"run {BRIEFLY} -o oil.h5 --set hydraulics.mode=force")
        power, lost = (channel("oil.h5", f"hydraulics/{name}")[-1] / 20e-6 for name in ("pump", "mechanical"))
        self.assertGreater(power, 0)
        self.has(text, f"\n  hydraulics          pump {power:.1f} W: mechanical {lost:.1f}  ")
        self.assertAlmostEqual(channel("oil.h5", "pump/power")[-1], power, delta=0.1 * power)  # at the end of 20 us and over them
        self.has(self.out("run tiny --detail rigid -o none --until '0.2 ms' --set start.settling_time=2ms --set start.ramp_time=1ms --set "
                          "hydraulics.mode=force"), " % of the variator; ")

    def test_reports_transitions_of_settling_beside_those_of_the_run(self):
        """Clamped while it settles, for 50 us: tips come to the sheaves then."""
        self.matches(self.out("run tiny -o none --until 5us --set start.settling_time=50us --set start.ramp_time=10us --set "
                              "run.output_interval=5us"),
                     r"\n  transitions +[0-9]+ detected, [0-9]+ steps truncated, [0-9]+ suppressed; settling [1-9][0-9]* detected, "
                     r"[1-9][0-9]* steps truncated, [0-9]+ suppressed\n")

    def test_draws_a_bar_on_a_terminal_that_fits_and_goes_away(self):
        import fcntl
        import struct
        import termios

        for columns in (40, 70, 120):
            ours, theirs = pty.openpty()
            fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
            with subprocess.Popen(words_of(f"run tiny -o none --until '1 ms' {SETTLING}"), stdout=theirs, stderr=theirs, stdin=theirs,
                                  env=os.environ | {"TERM": "xterm"}):
                os.close(theirs)
                text = b""
                try:
                    while part := os.read(ours, 65536):
                        text += part
                except OSError:  # the terminal has gone
                    os.close(ours)
            drawn = text.decode().partition("tiny: finished")[0]
            self.matches(drawn, "\\A\rsettling [^\n]*\r\x1b\\[K\\Z")
            for picture in drawn.split("\r"):
                self.assertLess(len(picture), columns + 3, "the code to clear the rest of the line takes 3")
            self.assertTrue(columns < 70 or " [>" in drawn, drawn)

    def test_that_fails_has_its_status_and_leaves_what_it_has(self):
        for more, status, said in (("--set run.max_steps=10", 4, "the budget of 10 steps"), ("--step '10 us' --until '5 ms'", 3, "")):
            done = self.cvtflow(f"run {BRIEFLY} {more} -o r{status}.h5", status)
            self.assertTrue(done.out.startswith(f"tiny: stopped: {said}"), done.out)
            self.assertTrue(attribute(f"r{status}.h5", "status").startswith(said))
            self.assertNotEqual(attribute(f"r{status}.h5", "status"), "finished")
        self.cvtflow("settle tiny -q --set run.max_steps=10", 4)
        self.assertFalse(os.path.exists("tiny.state"))

    def test_begins_with_the_state_file_of_its_scene_where_that_fits(self):
        self.cvtflow("settle tiny -q -o a.state --time 20us --set start.ramp_time=10us")
        text = read(f"{SOURCE}/scenes/tiny.toml").replace('settling_time = "10 ms"', 'settling_time = "20 us"')
        text = text.replace('ramp_time = "5 ms"', 'ramp_time = "10 us"\nstate = "a.state"').replace('until = "1 ms"', 'until = "20 us"')
        write("settled.toml", text)
        self.lacks(self.err("run settled.toml", 0), "settling")
        self.has(self.out("check settled.toml"), f"state file {os.getcwd()}/a.state")
        other = self.cvtflow("run settled.toml --detail rigid --force")
        self.assertTrue(other.err.startswith(f'cvtflow: detail.pins = "rigid" (was "halves"): the state in {os.getcwd()}/a.state no '
                                             f'longer fits; '
                                             "the run settles again\n"), other.err)
        self.has(other.out, "\n  settled ")
        os.remove("a.state")
        self.cvtflow("run settled.toml", 1)
        self.has(self.out("run settled.toml --settle --force"), "\n  settled ")

    def test_finds_scenes_by_the_environment(self):
        write("mine/special.toml", read(f"{SOURCE}/scenes/tiny.toml"))
        self.cvtflow("check special", 1)
        self.has(self.cvtflow("check special", CVTFLOW_SCENES="nowhere:mine").out, "\n  file                mine/special.toml\n")

    def test_with_csv_inputs_continues_bit_for_bit_without_the_file_and_whatever_the_threads(self):
        write("load.csv", "t [us],M [N*m]\n0,12\n30,12\n50,15\n")
        line = f"""run tiny -q --until '60 us' {SETTLING} --set 'load.torque={{csv = "load.csv"}}' --set load.quadratic=1e-4
               --set clamping.safety=1.1 --set control.enabled=true --set control.quantity=slip --set 'record.channels=tips/*'"""
        self.cvtflow(f"{line} -o whole.h5 --threads 1")
        self.cvtflow(f"{line} -o parallel.h5 --threads 2 --set run.schedule=flow")
        self.cvtflow(f"{line} -o cut.h5 --checkpoint-every '1 h' --set run.max_steps=40", 4)
        os.remove("load.csv")
        self.cvtflow("resume cut.checkpoint -q --set run.max_steps=0")
        self.assertEqual(len({attribute(f"{name}.h5", "state_hash") for name in ("whole", "parallel", "cut")}), 1)
        self.has(self.out("info cut.h5"), "tips/radial_force")

    def test_has_the_same_bits_for_every_variant_of_the_c_library(self):
        """glibc chooses sin, pow and others by the processor; here one without fused operations is played."""
        variants = ["--method rk4", "--method leapfrog-sweep", "--set detail.friction=smoothed", "--method dumka3",
                    "--method rk4 --set joint.law=palmgren",
                    "--method dopri54 --tolerance 1", "--set 'clamping.driven=5.7 N^0.5*kN^0.5'"]
        lines = [f"run tiny {more}" for more in variants] + [f"cvtflow-lab run tiny {more}" for more in (
            "--method rkc", "--method fitted-l100-w1",
            "--method trapezoidal-analytic --set joint.law=palmgren")] * LAB.exists()
        for line in lines:
            line += f" -o none --until '20 us' {SETTLING} --set run.schedule=serial"
            one, other = (self.cvtflow(line, **plain).out for plain in (
                {}, {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable,-FMA_Usable"}))
            self.assertEqual(hash_in(other, "state hash"), hash_in(one, "state hash"), line)
            self.assertNotEqual(hash_in(one, "state hash"), "none")


class Streams(Program):
    def test_closed_ones_are_not_the_records_and_end_no_run(self):
        self.cvtflow(f"run {BRIEFLY} -q -o whole.h5")
        for closed, status in (("2>&-", 0), ("0<&- 2>&-", 0), ("2>/dev/full", 0), (">&-", 1), ("0<&- >&- 2>&-", 1)):
            done = self.shell(f'"$CVTFLOW" run {BRIEFLY} --force -o r.h5 {closed}', status)  # 1: the summary went nowhere
            self.assertTrue(status or "state hash" in done.stdout, closed)
            self.assertEqual(attribute("r.h5", "state_hash"), attribute("whole.h5", "state_hash"), closed)
        self.assertEqual(self.shell('"$CVTFLOW" list scenes >&-', 1).stderr, "cvtflow: standard output: cannot write: it is closed\n")

    def test_output_that_cannot_be_written_is_an_error(self):
        write_sweep("6", "20 us")
        self.batch()
        for command in ("table out", "table out --csv", "list methods", "schema", "check tiny"):
            self.has(self.shell(f'"$CVTFLOW" {command} > /dev/full', 1).stderr, "No space left on device")
        self.shell('"$CVTFLOW" --help > /dev/full', 1)

    def test_scenes_are_read_from_standard_input(self):
        for begin, end in (("", f" < '{SOURCE}/scenes/tiny.toml'"), (f"cat '{SOURCE}/scenes/tiny.toml' | ", "")):
            self.shell(f'{begin}"$CVTFLOW" check /dev/stdin{end}')

    def test_outputs_are_appended_where_the_shell_appends(self):
        self.cvtflow(f"run {BRIEFLY} -q -o own.h5")
        self.shell('for k in 1 2; do "$CVTFLOW" export own.h5 slip --csv /dev/stdout >> all.csv; done')
        self.cvtflow("export own.h5 slip --csv once.csv")
        self.assertTrue(read("all.csv").startswith(read("once.csv")) and read("once.csv") in read("all.csv")[1:], read("all.csv"))


class RigidPins(Program):
    """Every command on a scene of rigid pins."""

    LEVEL = "--detail rigid --set run.method=leapfrog-rigid --set 'run.step=2 us'"
    BRIEF = "--until '2 ms' --set start.settling_time=1ms --set start.ramp_time=1ms"

    def test_run_settle_and_are_reported_plotted_and_exported(self):
        text = self.out(f"run tiny -o rigid.h5 {self.LEVEL} {self.BRIEF}")
        self.has(text, "leapfrog-rigid", "energy balance")
        self.lacks(text, "unreliable")
        self.assertEqual(attribute("rigid.h5", "status"), "finished")
        for line in ("report rigid.h5", "plot rigid.h5 -o rigid.svg", "export rigid.h5 --vtk solids.pvd"):
            self.cvtflow(line)
        self.cvtflow(f"settle tiny -q -o a.state --time '1 ms' --set start.ramp_time=1ms {self.LEVEL}")
        self.cvtflow(f"run tiny -q -o again.h5 --set start.state=a.state {self.LEVEL} {self.BRIEF}")
        self.matches(self.out(f"run tiny --detail rigid --method auto --until '1 ms' -o none {self.BRIEF.partition('--set')[1]} "
                              "start.settling_time=1ms --set start.ramp_time=0.5ms"),
                     "  transitions         [1-9][0-9]* detected, 0 steps truncated, 0 suppressed")
        for line in ("info rigid.h5", "list detail", "explain detail.pins", "schema"):
            self.has(self.out(line), "rigid")
        self.cvtflow("run drive -q -o drive.h5 --until '2 ms'")
        self.assertAlmostEqual(channel("drive.h5", "ratio")[-1], 2.2,
                               delta=0.01)  # the file's target; control settles within half a per cent

    def test_are_reliable_at_the_automatic_steps_of_a_small_machine(self):
        """A start that settles begins with a jolt which steps of 5 us do not resolve, and which is no reason to call the run unreliable;
        friction counts in the steps of tables, which a start changes faster than 20 ms: estimates as for other pins."""
        for method, step in (("auto", "step 7.143e-06 s (auto"), ("rk4", "(auto")):
            self.has(text := self.out(f"run tiny --detail rigid --method {method} -o none"), step)
            self.lacks(text, "unreliable")

    def test_sweep_into_a_table(self):
        write_sweep("6, 12", "1 ms", set='detail.pins = "rigid"\nrun.method = "leapfrog-rigid"\n')
        write("sweep.toml", read("sweep.toml").replace('"50 ns"', '"2 us"').replace('"20 us"', '"1 ms"').replace('"10 us"',
                                                                                                                 '"1 ms"').replace(
            ', "ratio at 20 us"', ""))
        self.batch()
        self.has(self.out("table out"), "finished")

    def test_take_other_methods_as_a_check(self):
        """Any table integrates the same forces; both are within the step's error of each other."""
        for name, more in (("sweep", "--set 'run.step=0.5 us'"), ("rk4", "--set run.method=rk4 --set 'run.step=0.1 us'")):
            self.cvtflow(f"run tiny -q -o {name}.h5 {self.LEVEL} {self.BRIEF} {more} --until '1 ms'")
        sweep, rk4 = (channel(f"{name}.h5", "tight_tension")[-1] for name in ("sweep", "rk4"))
        self.assertAlmostEqual(sweep, rk4, delta=0.01 * rk4)


class Commands(Program):
    def test_are_all_in_the_help_and_report_program_build_and_machine(self):
        self.assertEqual(len(commands_of(PROGRAM)), 19)
        for name in commands_of(PROGRAM):
            self.has(self.out(f"{name} --help"), f"Usage: cvtflow {name}")
        version = self.out("--version")
        self.assertTrue(version.startswith("cvtflow "))
        self.has(version, "\nbuilt with ", "\nrunning on ")
        self.assertIn("chain", json.loads(self.out("schema"))["properties"])

    def test_of_python_say_in_their_help_what_the_list_of_commands_says(self):
        """And their help, which completion is made of, needs no package."""
        listed, package = self.out("--help"), BUILD / "python/cvtflow/__main__.py"
        for name in runpy.run_path(str(package))["COMMANDS"]:
            shown = subprocess.run(["/usr/bin/python3", "-I", "-S", "-B", "-X", "importtime", package, name, "--help"],
                                   capture_output=True, text=True)
            self.matches(listed, f"\n  {name} +{re.escape(shown.stdout.splitlines()[0])}\n")
            self.lacks(shown.stderr, "numpy", "ctypes")
            self.lacks(shown.stdout, "\n  REQUIRED")  # without a name

    def test_take_an_instruction_set_before_or_after_their_name(self):
        for line in ("--isa baseline run tiny", "run tiny --isa baseline"):
            self.has(self.out(f"{line} --until '1 us' -o none {SETTLING}"), "kernels             baseline")

    def test_explain_keys_sections_terms_channels_notes_and_values(self):
        """Section joint and term joint: keys come first. Of other words it lists what has them in its meaning."""
        for words, begin, *parts in (
                ("tip.radius", "tip.radius\n"), ("tip", "", "tip.radius\n", "tip.angle\n"), ("joint", "", "joint.friction_coefficient\n"),
                ("creep", "", "creep\n  Sliding of tips that a chain which holds"), ("'thrust ratio'", "", "S_1/S_2"),
                ("friction_slip", "", "\n  channel of records; unit: 1\n"), ("target_missed", "", "\n  note of runs and cases\n"),
                ("underdrive", "underdrive\n  in the meaning of: ratio\n"),
                ("Cylinder", "Cylinder\n  in the meaning of: ", "pulley.cylinder_damping"),
                ("palmgren", "joint.law\n"), ("safety", "safety factor\n"),
                *((word, f"{word}\n  ") for word in ("settle", "steady", "not_steady", "archard", "rainflow")),
                ("chain.pins --scene tiny", "", "here:     24 in tiny"),
                ("run.step --scene baseline --set run.method=leapfrog-sweep", "",
                 "stable:   baseline with leapfrog-sweep up to 5 us", "auto:     "),
                ("run.step --scene baseline --set run.step=6us", "", "run.step exceeds this limit")):
            text = self.out(f"explain {words}")
            self.assertTrue(text.startswith(begin), text)
            self.has(text, *parts)
        self.assertEqual(self.out("explain pin_period"), self.out("explain 'pin period'"))
        some = self.cvtflow("explain creep chain.pich tip.radius hogshead", 1)
        self.assertEqual(some.out, self.out("explain creep") + "\n" + self.out("explain tip.radius"))
        self.has(some.err, 'chain.pich: unknown key (did you mean "chain.pitch"?)\n', "hogshead: unknown key")


class Manual(Program):
    """The manual page and the completions, made by the build (tools/documents/manual) of the program's help."""

    def files(self, program="cvtflow"):
        files = (f"man/{program}.1", f"bash/{program}", f"zsh/_{program}", f"fish/{program}.fish")
        return [read(BUILD / "manual" / file) for file in files]

    def test_every_kind_knows_every_command_and_its_options(self):
        for program in (PROGRAM, LAB)[:1 + LAB.exists()]:
            names = commands_of(program)
            self.assertGreaterEqual(len(names), 10)
            page, bash, zsh, fish = self.files(program.name)
            for name in names:
                self.has(page, re.sub("-", r"\\-", f"Usage: {program.name} {name}"))
                self.has(bash, f"        {name}) words='")
                self.has(zsh, f"\n    {name}) _arguments")
                self.has(fish, f"-a '{name}' -d ")
        _, bash, _, fish = self.files()
        self.matches(bash, r"        run\) words='[^']*--checkpoint-every [^']*--until ")
        self.has(fish, "__fish_seen_subcommand_from run' -l 'until' ", "__fish_seen_subcommand_from batch' -l 'dry-run' ")

    def test_bash_completes_commands_options_and_names_of_the_catalogues(self):
        for program, words, found in (("cvtflow", "che", "check\n"), ("cvtflow", "run --unt", "--until\n"), ("cvtflow", "run bas",
                                                                                                             "baseline"),
                                      ("cvtflow", "run tiny --method leapfrog-sw", "leapfrog-sweep"),
                                      ("cvtflow", "explain tip.rad", "tip.radius\n"), ("cvtflow-lab", "granu", "granularity\n")):
            if (BUILD / program).exists():
                done = self.shell(f"PATH='{BUILD}':$PATH; . '{BUILD}/manual/bash/{program}'; COMP_WORDS=({program} {words}); "
                                  f'COMP_CWORD={len(words.split())}; _{program.replace("-", "_")}; echo "${{COMPREPLY[@]}}"')
                self.assertTrue(done.stdout == found if found.endswith("\n") else found in done.stdout, done.stdout)
        self.shell(f"'{SOURCE}/tools/documents/manual' html x", 2)


class Tune(Program):
    """cvtflow tune, run --accuracy and sweeps with an accuracy, on tiny, settled for a moment."""

    TINY = "tiny --set start.settling_time=1ms --set start.ramp_time=0.5ms --set run.until=1ms"
    # Tensions: a slip over 1 ms differs by 6 % from step to step, however short they are.
    BRIEF = "--accuracy '20 %' --outputs 'tight_tension, slack_tension' --settling '1 ms' --average '1 ms'"

    def test_writes_a_scene_that_runs_with_what_it_chose(self):
        text = self.out(f"tune {self.TINY} {self.BRIEF} -q")
        self.has(text, "tiny: accuracy 20 %, at 3 operating points\n", "\n  written             tiny.tuned.toml")
        self.matches(text, "\n  chosen  .* errors times 2 within")
        self.has(read("tiny.tuned.toml"), "# tiny: accuracy 20 %, at 3 operating points\n", "#   against             start: full, leapfrog-sweep at ")
        found = json.loads(self.out(f"tune {self.TINY} {self.BRIEF} --verify 1 -q --json --force"))
        chosen = found["choices"][found["chosen"]]
        self.assertEqual((chosen["standing"], len(found["unseen"])), ("chosen", 1))
        self.has(ran := self.out("run tiny.tuned.toml -o none"), chosen["method"])
        self.lacks(ran, "settled")  # it begins with a state of the chosen detail

    def test_ends_with_a_status_where_nothing_is_accurate_enough(self):
        coarse = "--accuracy '0.5 %' --outputs tight_tension --settling '1 ms' --average '1 ms' --methods leapfrog-rigid -q"
        for command in ("tune", "run -o none"):
            end = self.cvtflow(f"{command} {self.TINY} {coarse}", 7)
            self.has(end.out + end.err, "no tried choice is within 0.5 % (with a margin of 2); nearest: ")
        self.assertFalse(os.path.exists("tiny.tuned.toml"))

    def test_run_runs_what_it_finds(self):
        ran = self.cvtflow(f"run {self.TINY} {self.BRIEF} -o none")
        self.matches(ran.err, r"cvtflow: tiny: .*, leapfrog-.* for 20 % \(largest error measured: .* %\)\n")
        self.has(ran.out, "finished at t = 0.001 s", re.search("leapfrog-[a-z]+", ran.err)[0])

    def test_sweeps_with_an_accuracy_carry_their_errors_and_say_where_they_miss_it(self):
        write("sweep.toml", '[sweep]\nscene = "tiny"\n[set]\nrun.until = "1 ms"\nrun.method = "leapfrog-sweep"\nstart.settling_time = '
                            '"2 ms"\nstart.ramp_time = "1 ms"\n[[axes]]\nkey = "load.torque"\nvalues = [6, 9, 12]\n[outputs]\n'
                            'from = "0.4 ms"\nscalars = ["tight_tension mean"]\n[start]\nmode = "settle"\n[accuracy]\ntarget = "3 %"\n'
                            'verify = 2\n')
        done = self.batch()
        self.matches(done.err, "cvtflow: sweep: 2 cases verified, 0 beyond 3 %; at most: tight_tension mean ")
        self.assertEqual(hash_in(done.out), fact("out", "results_hash"))
        known = json.loads(read("out/accuracy.json"))
        self.has(self.out("table out"), f"\naccuracy 0.03: {known['choice']} (largest error at the corners ")
        rows = list(csv.DictReader(self.out("table out --csv").splitlines()))
        self.assertEqual(sorted(row["error_of_tight_tension_mean"] == "nan" for row in rows), [False, False, True])
        again = self.cvtflow("resume out")
        self.has(again.err, "2 cases verified, 0 beyond 3 %")  # the same ones
        self.assertEqual(hash_in(again.out), hash_in(done.out))
        self.lacks(self.batch().err, "reference")  # nor tuned anew
        text = read("out/tuned.scene.toml")  # as if the corners had misled it
        write("out/tuned.scene.toml", re.sub(r"^driven = [\d.e]+", "driven = 7e3", text, flags=re.M))
        write("out/accuracy.json", json.dumps(known | {"errors": {}}))
        for file in ("out/sweep.json", "out/results.csv", "out/sweep.toml", *Path("out").glob("rows-*.csv")):
            os.remove(file)
        self.has(self.batch("-q", 7).err, "cvtflow: sweep: misses its target: 2 cases verified, 2 beyond 3 %; at most: ")


if __name__ == "__main__":
    main()
