"""Links between pages lead to files and headings that exist; decisions and their numbers agree; every block runs, is written, or says why
not; quoted steps are those of the source."""

import os
import re
import unittest

from page import TOP, Page, page, pages


def target_of(path, link):
    """Path from the top level to which a link of a page leads."""
    return os.path.normpath(os.path.join(os.path.dirname(path), link))


class Links(unittest.TestCase):
    def test_lead_to_files_and_headings(self):
        followed, wrong = 0, []
        for each in pages():
            for link in each.links():
                if "://" in link or link.startswith("mailto:"):
                    continue
                followed += 1
                file, _, heading = link.partition("#")
                target = target_of(each.path, file) if file else each.path
                if not (TOP / target).exists() or (heading and heading not in page(target).anchors()):
                    wrong.append(f"{each.path}: {link}")
        self.assertEqual(wrong, [])
        self.assertGreater(followed, 50)

    def test_headings_are_reached_as_on_the_web(self):
        sample = Page("sample.md", "# Was it `auto`? Yes, 5 %\n```sh\n# no heading\n```\n## 59. What detail decides\n")
        self.assertEqual(sample.anchors(), ["was-it-auto-yes-5-", "59-what-detail-decides"])


class Pages(unittest.TestCase):
    def test_the_readme_has_a_hundred_lines_at_most(self):
        self.assertLessEqual(page("README.md").text.count("\n"), 100)

    def test_lines_end_at_140_columns(self):
        self.assertEqual([f"{each.path}:{number}" for each in pages() for number, line in each.text_lines() if len(line) > 140], [])

    def test_every_page_is_reached_from_the_index(self):
        reached = {target_of(path, link) for path in ("docs/index.md", "docs/decisions/README.md") for link in page(path).links()}
        self.assertEqual([each.path for each in pages() if each.path.startswith("docs/")
                          and each.path not in reached | {"docs/index.md"}], [])

    def test_have_one_order_in_the_index_and_the_site(self):
        index = [target_of("docs/index.md", link) for link in page("docs/index.md").links()]
        index = ["/" + path.rpartition(".")[0] for path in index if re.match("docs/(?!decisions/)", path)]
        contents = (TOP / "docs/site/contents.rst").read_text(encoding="utf-8").splitlines()
        site = [line.lstrip(" ") for line in contents if re.match(" */docs/(?!decisions/|.*_reference$)", line) and line.strip() != "/docs/index"]
        self.assertGreaterEqual(len(index), 10)
        self.assertEqual(index, site)

    def test_architecture_shows_steps_as_they_stand_in_the_source(self):
        for name, function in (("sweep", "SweepLeapfrog"), ("rigid", "RigidLeapfrog")):
            source = (TOP / f"tasks/method/friction/{name}_leapfrog.cpp").read_text(encoding="utf-8")
            begin = source.index(f"CycleSequence {function}::step() {{")
            block = source[begin:source.index("\n}\n", begin) + 2].replace("\n", "\n    ")
            self.assertIn(f"    {block}\n", page("ARCHITECTURE.md").text)


class Decisions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = [(int(number), os.path.basename(each.path)) for each in pages() if each.path.startswith("docs/decisions/")
                     for _, line in each.text_lines() for number in re.findall(r"^## ([0-9]+)\. ", line)]

    def test_stand_once_and_in_the_index(self):
        index = dict(re.findall(r"\]\((\w+\.md)\): ([0-9,\s]+)\.", page("docs/decisions/README.md").text))
        listed = [(int(number), file) for file, numbers in index.items() for number in numbers.split(",")]
        self.assertEqual(sorted(self.found), sorted(listed))
        self.assertGreater(len(dict(listed)), 50)
        self.assertEqual(len(dict(listed)), len(listed))

    def test_that_code_and_pages_name_exist(self):
        files = [path for folder in ("api", "bench", "docs", "engine", "model", "tasks", "tools") for path in (TOP / folder).rglob("*.*")
                 if path.suffix in (".hpp", ".cpp", ".md")]
        named = [(path, int(number)) for path in files for number in re.findall("(?i:decisions?) ([0-9]+)", path.read_text(encoding="utf-8"))]
        self.assertGreater(len(named), 3)
        self.assertEqual([place for place in named if place[1] not in dict(self.found)], [])


class Blocks(unittest.TestCase):
    def test_are_fenced_and_run_written_or_say_why_not(self):
        shown = ("text", "json", "math")  # output and formulas, never run
        self.assertEqual([f"{each.path}:{block.line}: {block.language}" for each in pages() for block in each.blocks()
                          if not (block.runs() or {"not run", "file"} & set(block.comment) or block.language in shown)], [])
        indented = []
        for each in pages():
            before = ""
            for number, line in each.text_lines() if each.path != "ARCHITECTURE.md" else []:  # which shows sources
                indented += [f"{each.path}:{number}"] if line.startswith("    ") and not before else []
                before = line
        self.assertEqual(indented, [])

    def test_are_found_with_what_their_comments_say(self):
        toml, quick, slow = Page("sample.md", "text\n<!-- file: a.toml -->\n```toml\nx = 1\n```\n\n```sh\nls\n```\n"
                                              "<!-- nightly: hours -->\n```sh\nwait\n```\n").blocks()
        self.assertEqual((toml.comment, toml.text, toml.runs()), ({"file": "a.toml"}, "x = 1\n", False))
        self.assertEqual((quick.runs(), quick.comment), (True, {}))
        self.assertEqual((slow.comment, slow.line), ({"nightly": "hours"}, 11))


if __name__ == "__main__":
    unittest.main()
