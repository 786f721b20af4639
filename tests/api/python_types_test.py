"""Types as mypy sees them in its strict mode (half a minute): of the examples, and of what users call."""

import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from python_fixture import DEEP, SOURCE, main

import cvtflow

CALLS = '''
from typing_extensions import reveal_type
import cvtflow
record = cvtflow.Record("r.h5")
results = cvtflow.Sweep("tiny", {"load.torque": [1]}, ["slip mean"]).run("folder")
reveal_type(cvtflow.run(cvtflow.Scene.ready("tiny"), "20 us", channels=["ratio"]))
reveal_type(record["slip"])
reveal_type(record.means())
reveal_type(results)
reveal_type(results.where(load__torque=1))
reveal_type(cvtflow.fit("tiny", {"load.torque": (1, 2)}, {"slip mean": [1]}))
reveal_type(cvtflow.Simulation(cvtflow.Scene.ready("tiny")).channel("slip"))
cvtflow.run("tiny", until=[1])
'''


@unittest.skipUnless(DEEP and importlib.util.find_spec("mypy"), "not at full depth, or mypy is not installed")
class Types(unittest.TestCase):
    def test_examples_are_correct_and_wrong_calls_are_found(self):
        examples = [f"{SOURCE}/examples/python/{name}.py" for name in ("eight_simulations", "tune_controller")]
        with tempfile.TemporaryDirectory() as folder:
            calls = Path(folder, "calls.py")
            calls.write_text(CALLS)
            words = ["--strict", "--follow-imports=silent", "--ignore-missing-imports", f"--cache-dir={folder}", str(calls), *examples]
            done = subprocess.run([sys.executable, "-m", "mypy", *words], capture_output=True, text=True,
                                  env={**os.environ, "MYPYPATH": str(Path(cvtflow.__file__).parent.parent), "PYTHONPATH": ""})
        lines = done.stdout.splitlines()
        shown = [line.partition('Revealed type is "')[2].rstrip('"').replace("numpy.", "") for line in lines if "Revealed" in line]
        self.assertEqual([each.partition("[")[0] for each in shown],
                         ["cvtflow._results.Rows", "ndarray", "builtins.dict", "cvtflow._tables.Results", "cvtflow._tables.Results",
                          "cvtflow._fit.Fit", "ndarray"])
        self.assertEqual(len([line for line in lines if ": error: " in line]), 1, lines)
        self.assertIn('Argument "until" to "run" has incompatible type "List[int]"', done.stdout)


main() if __name__ == "__main__" else None
