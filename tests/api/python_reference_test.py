"""The reference page is what the package documents today, and every public name is on it."""

import importlib.util
import unittest
from importlib.machinery import SourceFileLoader
from pathlib import Path

from python_fixture import SOURCE, main

import cvtflow

SCRIPT = SOURCE + "/tools/documents/python_reference"
LOADER = SourceFileLoader("python_reference", SCRIPT)


class Reference(unittest.TestCase):
    def setUp(self):
        self.script = importlib.util.module_from_spec(importlib.util.spec_from_loader("python_reference", LOADER))
        LOADER.exec_module(self.script)

    def test_the_page_is_that_of_this_package(self):
        written = Path(SOURCE, "docs/python_reference.md").read_text(encoding="utf-8")
        self.assertEqual(self.script.page().splitlines(), written.splitlines(), f"write it again: {SCRIPT} --write")

    def test_every_public_name_has_a_text(self):
        page = self.script.page()
        for name, each in self.script.public().items():
            self.assertIn(name, page)
            self.assertTrue((each.__doc__ or "").strip(), name)
        self.assertGreater(len(self.script.public()), 20)

    def test_public_methods_of_main_classes_have_a_text(self):
        for made in (cvtflow.Simulation, cvtflow.Scene, cvtflow.Sweep, cvtflow.Results, cvtflow.Record):
            for key, member in vars(made).items():
                if not key.startswith("_") and (callable(member) or isinstance(member, property)):
                    self.assertTrue(self.script.documented(member)[1] or isinstance(member, property) and made.__doc__, f"{made}.{key}")


main()
