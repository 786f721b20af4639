"""Pages agree with what they describe: exit statuses with the program, steps with the source, nights with their script, speeds with their
committed table."""

import collections
import os
import re
import subprocess
import unittest

from page import TOP, Page, page, pages


def text_of(path):
    return (TOP / path).read_text(encoding="utf-8")


class DescribedPages(unittest.TestCase):
    def test_exit_statuses_have_a_row_for_every_one_of_the_help(self):
        help_text = subprocess.run([os.environ["CVTFLOW_PROGRAM"], "--help"], capture_output=True, text=True, check=True).stdout
        statuses = re.findall("^  ([0-9]+) ", help_text, re.MULTILINE)
        self.assertGreaterEqual(len(statuses), 8)
        for status in statuses:
            self.assertIn(f"\n| {status} | ", page("docs/exit_status.md").text)

    def test_architecture_shows_steps_as_they_stand_in_the_source(self):
        for name, function in (("sweep", "SweepLeapfrog"), ("rigid", "RigidLeapfrog")):
            source = text_of(f"tasks/method/friction/{name}_leapfrog.cpp")
            begin = source.index(f"CycleSequence {function}::step() {{")
            block = source[begin:source.index("\n}\n", begin) + 2].replace("\n", "\n    ")
            self.assertIn(f"    {block}\n", page("ARCHITECTURE.md").text)

    def test_measured_figures_have_the_nights_of_the_table(self):
        for line in text_of("bench/results/nightly.csv").splitlines():
            self.assertIn(f"\n| {line.replace(',', ' | ')} |\n", page("docs/laboratory/measured.md").text)


class Nights(unittest.TestCase):
    def test_have_every_suite_once(self):
        listed = collections.Counter(name for names in re.findall(r"^[a-z]+\+?='\|?(\w+(?:\|\w+)*)'", text_of(".ci/run"), re.MULTILINE)
                                     for name in names.split("|"))
        written = collections.Counter()
        for path in [path for ending in ("cpp", "py") for path in (TOP / "tests").rglob(f"*_test.{ending}")]:
            written.update(set(re.findall(r"^(?:TEST(?:_[FP])?\(|class )Nightly(\w+)[,(]", path.read_text(encoding="utf-8"), re.MULTILINE)))
        self.assertEqual(listed, written)


FACTOR = r"\d+ (?:times (?:as fast|faster)|s/s)|\d+(?:\.\d+)? (?:s|seconds)(?: of processor time)? per simulated second"
COLUMN = r"\|[^|]*(?:seconds per simulated second|faster than RK4)[^|]*\|"
SHARE = "(?:twentieth|thirtieth|nineteenth|eightieth) of (?:the cost|RK4|its time)"


def speeds(each):
    """Lines that state how fast the default is, or how long a simulated second takes."""
    return [f"{each.path}:{number}: {line}" for number, line in each.text_lines()
            for form in (FACTOR, COLUMN, SHARE) if re.search(form, line)]


class PagesOfSpeed(unittest.TestCase):
    """One page contains speeds (docs/speeds.md), drawn from a committed table; other pages link to it."""

    def test_are_drawn_from_the_committed_table(self):
        self.assertEqual(subprocess.run([TOP / "tools/documents/speeds", "--check"]).returncode, 0)

    def test_are_not_repeated_elsewhere(self):
        """Pages of reasons and of research compare methods of the laboratory and published figures with each other."""
        may = ("docs/decisions/", "docs/laboratory/", "docs/paper.md", "CHANGELOG.md", "docs/speeds.md", "README.md")
        self.assertEqual([line for each in pages() if not each.path.startswith(may) for line in speeds(each)], [])
        self.assertEqual([len(speeds(page(path))) for path in ("README.md", "docs/speeds.md")], [1, 2])

    def test_the_readme_has_the_ratio_of_the_table(self):
        stated = re.search(r"\| default method and RK4 \(longest right step\) \| (\d+) times faster", page("README.md").text)
        default, rk4 = (float(re.search(rf"\nmethod,{row},([0-9.]+),", text_of("bench/results/speeds.csv"))[1])
                        for row in ('"default [^"]*"', "`rk4` at 45 ns"))
        self.assertEqual(int(stated[1]), round(rk4 / default))

    def test_are_recognised(self):
        sample = Page("sample.md", "It is 71 times faster.\nIt takes 1.4 s of processor time per simulated second.\n| `rk4` | 713 s/s |\n"
                                   "| scene | seconds per simulated second |\na nineteenth of the cost\nThe summary contains seconds per "
                                   "simulated second.\n\n```text\n71 times faster\n```\n")
        self.assertEqual(len(speeds(sample)), 5)


if __name__ == "__main__":
    unittest.main()
