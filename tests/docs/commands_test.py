"""Every block of commands and of Python on every page runs: page by page, in order, in an empty folder with the program on the path. Blocks
that need the laboratory run at depth deep, and nightly those that take longer than seconds:

    commands_test.py PageCommands | NightlyPageCommands | DeepReadme [PAGE…]
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from page import TOP, Page, page, pages

BUILD = Path(os.environ.get("CVTFLOW_BUILD", TOP / "build"))
PYTHON = re.search("Python3_EXECUTABLE:FILEPATH=(.*)", (BUILD / "CMakeCache.txt").read_text() + "\nPython3_EXECUTABLE:FILEPATH=python3")[1]
DEEP = os.environ.get("CVTFLOW_TEST_DEPTH") == "deep"
CHOSEN = [word for word in sys.argv[1:] if word.endswith(".md")]


def written_pages():
    """The reference of the Python package: fails where a public name has no text."""
    command = [PYTHON, TOP / "tools/documents/python_reference"]
    environment = {**os.environ, "PYTHONPATH": str(BUILD / "python")}
    return [Page("docs/python_reference.md", subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout)
            ] if (BUILD / "python").exists() else []


class PageCommands(unittest.TestCase):
    nightly = False

    def test_run(self):
        for each in [*pages(), *written_pages()]:
            if not CHOSEN or each.path in CHOSEN:
                with self.subTest(each.path), tempfile.TemporaryDirectory(prefix="cvtflow_docs_") as folder:
                    for part in ("api", "bench", "docs", "examples", "scenes", "tools", "tests"):  # named as on the page
                        os.symlink(TOP / part, f"{folder}/{part}")
                    os.symlink(BUILD, f"{folder}/build")
                    self.run_page(each, folder)

    def runs(self, block):
        """Whether this build provides everything that the block needs, at this depth."""
        if missing := [each for each in block.comment.get("needs", "").split() if not shutil.which(each)]:
            print(f"skipped line {block.line}: no {', '.join(missing)}", file=sys.stderr)
        now = self.nightly or ("nightly" not in block.comment and (DEEP or not block.is_deep()))
        return block.runs() and now and not missing and (block.language != "python" or (BUILD / "python").exists())

    def run_page(self, each, folder):
        """Blocks of Python that no command separates are one program, whose lines have the page's numbers."""
        program = ""
        for block in each.blocks():
            if "file" in block.comment:
                Path(folder, block.comment["file"]).write_text(block.text, encoding="utf-8")
            if not self.runs(block):
                continue
            if block.language == "python":
                program += "\n" * (block.line - program.count("\n")) + block.text
                continue
            self.script(folder, each.path, [PYTHON], program)
            program = ""
            # "command; test $? = 3" states a failure that is right.
            text = re.sub("(.*; test [$][?] .*)", r"(set +e; \1\n)", block.text)
            self.script(folder, f"{each.path}:{block.line}", ["bash"], "set -eo pipefail\n" + text)
        self.script(folder, each.path, [PYTHON], program)

    def script(self, folder, place, interpreter, text):
        """Runs a script that ends at the first command that fails."""
        if text:
            Path(folder, ".block").write_text(text, encoding="utf-8")
            done = subprocess.run([*interpreter, ".block"], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  env={**os.environ, "PATH": f"{BUILD}:/usr/bin:{os.environ['PATH']}", "PYTHONPATH": "build/python",
                                       "MPLBACKEND": "Agg"})
            self.assertEqual(done.returncode, 0, f"{place}\n{text.lstrip()}{done.stdout}")


class NightlyPageCommands(PageCommands):
    nightly = True


class DeepReadme(unittest.TestCase):
    """The first page, from its installation to a program of the reader, in an empty folder with nothing but the installation on the
    path."""

    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory(prefix="cvtflow_readme_"))
        self.prefix = f"{self.folder}/prefix"
        os.mkdir(f"{self.folder}/empty")
        subprocess.run(["cmake", "--install", BUILD, "--prefix", self.prefix], check=True, stdout=subprocess.DEVNULL)

    def shell(self, text):
        """Output of lines run as a script, which must succeed."""
        left_out = ("CVTFLOW_SCENES", "LD_LIBRARY_PATH", "PYTHONPATH")
        environment = {name: value for name, value in os.environ.items() if name not in left_out}
        packages = next(Path(self.prefix).rglob("cvtflow.pc")).parent
        done = subprocess.run(["bash", "-eo", "pipefail", "-c", text], cwd=self.folder + "/empty", text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT,
                              env={**environment, "PATH": f"{self.prefix}/bin:/usr/bin:/bin", "PKG_CONFIG_PATH": str(packages)})
        self.assertEqual(done.returncode, 0, text + done.stdout)
        return done.stdout

    def test_is_followed_from_an_installation_and_shows_numbers_that_an_engineer_believes(self):
        """The first results of a newcomer must be plausible for a transmission: settled, an efficiency of 90 to 99 %, tensions that follow
        the torque."""
        shown = []  # a simulation, variant, sweep, program
        for block in page("README.md").blocks():
            if "file" in block.comment:
                Path(self.folder, "empty", block.comment["file"]).write_text(block.text)
            elif block.runs() or "hold.cpp" in block.text:
                shown.append(self.shell(block.text))
        self.assertGreaterEqual(len(shown), 4)
        notes = re.findall(r"^ +note +(.*)", shown[0], re.MULTILINE)  # seven pin periods know slip to some per cent only, which is stated
        self.assertTrue(all(note.startswith("means are not known to 1 %") for note in notes) and len(notes) < 2, shown[0])
        self.assertIn("efficiency 98.", shown[0])
        table = self.shell("cvtflow table first --column efficiency --column notes --column slip_mean")
        rows = table.split("\n")[2:4]
        for efficiency, slip in (map(float, row.split()) for row in rows):  # in per cent; notes are empty
            self.assertTrue(90 < efficiency < 99.5 and 0.05 < slip < 1, rows)
        self.assertEqual(len(rows), 2)
        if (BUILD / "cvtflow_fmu.so").exists():
            self.shell("cvtflow export-fmu tiny --set start.settling_time='20 us' --set start.ramp_time='10 us'")


if __name__ == "__main__":
    unittest.main(argv=[word for word in sys.argv if word not in CHOSEN])
