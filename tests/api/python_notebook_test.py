"""The notebook is run without Jupyter: its cells of code one after another, as a reader would."""

import importlib.util
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

from python_fixture import SOURCE, main

if any(importlib.util.find_spec(name) is None for name in ("matplotlib", "pandas")):
    print("skipped: this interpreter has no Matplotlib or no pandas")
    sys.exit(77)

import matplotlib

matplotlib.use("Agg")
NOTEBOOK = Path(SOURCE, "examples/python/first_simulation.ipynb")


def text(cell):
    return "".join(cell["source"])


class Notebook(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def test_its_cells_run_and_show_what_an_engineer_believes(self):
        notebook, names = json.loads(NOTEBOOK.read_text(encoding="utf-8")), {}
        for number, cell in enumerate(notebook["cells"]):
            if cell["cell_type"] == "code":
                exec(compile(text(cell), f"cell {number}", "exec"), names)
        pyplot = sys.modules["matplotlib.pyplot"]
        self.assertEqual(len(pyplot.get_fignums()), 4)
        for number in pyplot.get_fignums():
            self.assertTrue(all(axes.lines for axes in pyplot.figure(number).axes))
        # Figures of the scene: tension difference times running radius is the load of 150 N m (54.4 mm), efficiency 90 to 99 %.
        mean = names["steady"].frame().mean()
        self.assertAlmostEqual((mean["tight_tension"] - mean["slack_tension"]) * 0.0544, 150.0, delta=0.02 * 150.0)
        self.assertTrue(0.90 < mean["efficiency"] < 0.99)
        self.assertTrue(names["simulation"].energy().reliable)
        self.assertEqual(list(names["results"]["status"]), ["ok"] * 3)
        self.assertEqual(sorted(names["results"]["slip_mean"]), list(names["results"]["slip_mean"]))

    def test_it_holds_no_output(self):
        """Outputs would be stale, and make every change of the notebook a change of pictures."""
        for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))


main() if __name__ == "__main__" else None
