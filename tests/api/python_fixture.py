"""What the tests of the Python package share: a small scene, the program, and a reason to skip."""

import os
import signal
import subprocess
import sys
import threading
import time
import unittest

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: this interpreter has no NumPy")
    sys.exit(77)

import cvtflow

SOURCE = os.environ["CVTFLOW_SOURCE_DIR"]
PROGRAM = os.environ["CVTFLOW_PROGRAM"]
DEEP = os.environ.get("CVTFLOW_TEST_DEPTH") == "deep"
BRIEF = ["start.settling_time=0.3 ms", "start.ramp_time=0.3 ms", "run.step=100 ns"]


def tiny(*more):
    """24 pins; settles for 0.3 ms only."""
    return cvtflow.Scene.read(SOURCE + "/scenes/tiny.toml").with_(*BRIEF, *more)


def program(*arguments):
    """Standard output of the program, which must succeed or call its results unreliable."""
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
    assert done.returncode in (0, 6), done.stderr
    return done.stdout


def press_after(condition):
    """Ctrl-C from another thread as soon as the condition holds. Returns a list, to which it adds the processor time of then."""
    pressed = []

    def press():
        while not condition():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)
        pressed.append(time.process_time())

    threading.Thread(target=press, daemon=True).start()
    return pressed


def main():
    unittest.main(verbosity=2)
