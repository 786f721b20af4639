"""Simulations from Python: threads, the interpreter's lock, pickling, exceptions, Ctrl-C, memory, cost of a call."""

import gc
import inspect
import os
import signal
import tempfile
import threading
import time
import unittest
import unittest.mock
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

from python_fixture import BRIEF, SOURCE, main, press_after, program, tiny

import numpy as np

import cvtflow


def hash_at(time_requested):
    simulation = cvtflow.Simulation(tiny())
    simulation.advance_to(time_requested)
    return simulation.hash()


def go_on(simulation, end):
    simulation.advance_to(end)
    return simulation.hash()


def resident():
    """Pages of this process in memory [B]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Calls(unittest.TestCase):
    def test_take_the_name_of_a_scene_for_a_scene(self):
        ready = cvtflow.Simulation("tiny").scene
        self.assertEqual(ready, cvtflow.Scene.ready("tiny"))
        file = SOURCE + "/scenes/tiny.toml"
        for given in (file, Path(file)):
            self.assertEqual(cvtflow.Simulation(given).scene, ready)
        with self.assertRaisesRegex(cvtflow.SceneError, "did you mean 'tiny'"):
            cvtflow.Simulation("tini")
        self.assertEqual(len(cvtflow.run("free_ring", "20 us", channels=["chain_speed"])["time"]), 3)

    def test_have_signatures(self):
        self.assertEqual(list(inspect.signature(cvtflow.Simulation).parameters), ["scene", "threads", "segments"])
        self.assertEqual(list(inspect.signature(cvtflow.Simulation.set_input).parameters), ["self", "input", "value"])
        self.assertEqual(list(inspect.signature(cvtflow.tune).parameters), ["scene", "accuracy", "outputs"])


class Results(unittest.TestCase):
    def test_bits_equal_those_of_the_program_for_either_chain(self):
        for more in ([], ["detail.pins=rigid", "run.method=leapfrog-rigid", "run.step=1 us"]):
            settings = [*BRIEF, "start.state=", *more]
            with self.subTest(more), tempfile.TemporaryDirectory() as folder:
                file, names = folder + "/record.h5", ["time", "ratio", "links/tension", "shaft_1/angle", "friction_slip"]
                program("run", SOURCE + "/scenes/tiny.toml", *(word for each in settings for word in ("--set", each)), "--until", "0.1 ms", "-q",
                        "-o", file)
                record, rows = cvtflow.Record(file), cvtflow.run(tiny("start.state=", *more), until=1e-4, channels=names[1:])
                for name in names:  # of the links: floats in the record
                    np.testing.assert_array_equal(rows[name].astype(np.float32 if rows[name].ndim > 1 else float), record[name], name)

    def test_bits_do_not_depend_on_calls_threads_or_processes(self):
        whole = hash_at(-2.5e-4)
        parts = cvtflow.Simulation(tiny(), cvtflow.Threads.private_arena(2))
        for number in range(1, 51):
            parts.advance_to(-3e-4 + number * 1e-6)
        self.assertEqual(parts.hash(), whole)
        half = cvtflow.Simulation(tiny())
        half.advance_to(-2.8e-4)
        half.set_input("load_torque", 11.0)
        with ProcessPoolExecutor(1) as pool:  # the simulation is pickled
            self.assertEqual(pool.submit(go_on, half, -2.5e-4).result(), go_on(half, -2.5e-4))
        self.assertNotEqual(half.hash(), whole)

    def test_arrays_are_views_where_nothing_moves_them(self):
        simulation = cvtflow.Simulation(tiny())
        tension = simulation.channel("links/tension")
        self.assertEqual(tension.shape, (24,))
        self.assertIs(tension, simulation.channel("links/tension"))
        with self.assertRaises(ValueError):
            tension[0] = 1.0
        simulation.step()
        seen = simulation.channel("links/tension").copy()
        np.testing.assert_array_equal(tension, seen)
        copy = simulation.copy().channel("links/tension")  # outlives its simulation
        gc.collect()
        np.testing.assert_array_equal(copy, seen)
        x = simulation.unknowns()
        self.assertEqual(x.shape, (simulation.size(),))
        slope = simulation.rhs(simulation.time, x)
        np.testing.assert_array_equal(slope, simulation.rhs(simulation.time, list(x)))
        self.assertTrue(np.isfinite(slope).all())
        for wrong in (x.reshape(2, -1), np.zeros(len(x), dtype="datetime64[s]"), "x"):
            with self.assertRaises(TypeError):
                simulation.rhs(simulation.time, wrong)


class Running(unittest.TestCase):
    def test_eight_simulations_step_side_by_side_on_threads(self):
        with ThreadPoolExecutor(8) as pool:
            self.assertEqual(set(pool.map(hash_at, [-2.8e-4] * 8)), {hash_at(-2.8e-4)})

    def test_the_lock_is_free_while_stepping(self):
        simulation = cvtflow.Simulation(tiny())
        running = threading.Thread(target=lambda: self.assertRaises(cvtflow.CancelledError, simulation.advance_to, 1.0))
        inside = threading.Event()
        simulation.on_output("1 us", lambda *_: inside.set())
        running.start()
        self.assertTrue(inside.wait(60.0))
        for _ in range(100):  # Python goes on here while the other thread is inside one call
            time.sleep(0.001)
        self.assertTrue(running.is_alive())
        self.assertRaises(cvtflow.BusyError, simulation.step)
        while running.is_alive():
            simulation.cancel()
            running.join(0.01)

    def test_ctrl_c_ends_a_call_and_the_simulation_goes_on(self):
        simulation = cvtflow.Simulation(tiny())
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            simulation.advance_to(10.0)
        stopped = simulation.time
        self.assertLess(stopped, 10.0)
        simulation.advance_to(stopped + 1e-6)
        self.assertEqual(simulation.hash(), hash_at(stopped + 1e-6))

    def test_ctrl_c_is_not_lost_where_a_simulation_ends(self):
        first, dropped = cvtflow.Simulation(tiny()), []
        with unittest.mock.patch("sys.unraisablehook", dropped.append):
            for _ in range(10):
                copies = []
                press_after(lambda: len(copies) > 5)
                with self.assertRaises(KeyboardInterrupt):
                    while len(copies) < 3000:
                        copies.append(first.copy().time)
        self.assertEqual(dropped, [])

    def test_callbacks_may_throw_and_set_inputs(self):
        simulation, seen = cvtflow.Simulation(tiny()), []

        def on_output(self_of_callback):
            seen.append((self_of_callback is simulation, threading.get_ident()))
            if len(seen) == 3:
                raise KeyError("enough")

        simulation.on_output(1e-6, on_output)
        self.assertRaises(KeyError, simulation.advance_to, 0.0)
        self.assertEqual(seen, [(True, threading.get_ident())] * 3)
        simulation.on_output(1.0, None)
        changes, before = [], simulation.counters().transitions
        simulation.on_transition(lambda _, change: changes.append(change.phase_to))
        simulation.advance_to(-2.5e-4)
        self.assertEqual(len(changes), simulation.counters().transitions - before)
        self.assertTrue(changes)


class Failing(unittest.TestCase):
    def test_every_code_has_its_exception(self):
        for action, kind, also in [
            (lambda: cvtflow.Scene.ready("tny"), cvtflow.SceneError, ValueError),
            (lambda: cvtflow.Simulation(tiny()).channel("rato"), cvtflow.ArgumentError, ValueError),
            (lambda: cvtflow.State.from_bytes(b"CVTSTATE, damaged"), cvtflow.StateError, RuntimeError),
            (lambda: cvtflow.Record("/nowhere.h5"), cvtflow.RecordError, RuntimeError),
            (lambda: cvtflow.Simulation(tiny("run.max_steps=5")).advance_to(0.0), cvtflow.MaxStepsError, cvtflow.Fault),
            (lambda: cvtflow.Simulation(tiny()).set_input("load_torqe", 1.0), cvtflow.ArgumentError, ValueError),
            (lambda: cvtflow.Simulation(tiny()).advance_to(-1.0), cvtflow.ArgumentError, ValueError),
        ]:
            with self.assertRaises(kind) as caught:
                action()
            self.assertIsInstance(caught.exception, also)
            self.assertIsInstance(caught.exception, cvtflow.Error)
            self.assertIn(caught.exception.code.split("_")[0], kind.__name__.lower())
            self.assertTrue(str(caught.exception))

    def test_objects_without_init_are_refused_by_all_that_they_have(self):
        refused = 0
        for kind in (cvtflow.Scene, cvtflow.Simulation, cvtflow.Recording, cvtflow.State):
            made = kind.__new__(kind)
            for name, member in vars(kind).items():
                if name.startswith("_") or isinstance(member, staticmethod):
                    continue
                with self.subTest(kind=kind.__name__, name=name), self.assertRaises((AttributeError, TypeError)):
                    value = getattr(made, name)
                    if not isinstance(member, property):
                        value()
                refused += 1
        self.assertGreater(refused, 30)


class Cost(unittest.TestCase):
    def test_hundreds_of_simulations_leave_nothing_behind(self):
        scene = tiny()
        for _ in range(100):  # what allocators keep
            cvtflow.Simulation(scene).step()
        gc.collect()
        before = resident()
        for _ in range(200):
            cvtflow.Simulation(scene).step()
        gc.collect()
        # One simulation holds some 2 MiB: a leak of one in twenty would show.
        self.assertLess(resident() - before, 16 * 2**20)


main() if __name__ == "__main__" else None
