"""Words that the glossary lists as "not": they do not occur in pages, and in sources no more often than the table beside this file states.

    CVTFLOW_WRITE_WORDS=1 words_test.py      writes that table again, where counts only shrank or files moved
"""

import collections
import os
import re
import unittest

from page import TOP, Page, avoided_words, page, pages

TABLE = TOP / "tests/docs/source_words.csv"
# Rejected in sources, allowed in pages.
FURTHER_WORDS = ["look", "looked", "looking", "impatient", "at hand", "so many", "by how much"]
OPENINGS = ["Of ", "What ", "That many ", "Those ", "The same "]
# First words of docstrings that begin with neither a noun nor a verb, and are no sentence.
FRAGMENTS = ("of ", "what ", "that ", "from ", "by ", "with ", "without ", "in ", "at ", "on ", "as ", "its ", "since ", "so ", "behind ",
             "between ",
             "before ", "after ", "also ", "likewise", "the latter ")


def positions_of(text, word):
    """Positions of a word or its plural. A name in a file (`energy_suspicion`) is one word."""
    return [found.start() for found in re.finditer(rf"(?<!\w){re.escape(word)}s?(?!\w)", text, re.ASCII)]


def prose(each):
    """Text of a page in lower case on one line, without blocks, indented code, code between backticks, targets of links, and the glossary's
    table."""
    lines, glossary = [], False
    for _, line in each.text_lines():
        glossary = line.startswith("|") and (glossary or line == "| word | means | not |")
        if not glossary and not line.startswith("    "):
            lines.append(line.lstrip(" ") + " ")
    return re.sub(r"`[^`]*(`|$)|\]\([^)]*(\)|$)", "", "".join(lines)).lower()


TOKEN = re.compile(r'(?P<comment>//[^\n]*)|/\*.*?\*/|^[ '
                   r'\t]*#[^\n]*|R"(?P<mark>[^(]*)\((?P<raw>.*?)\)(?P=mark)"|"(?P<literal>(?:\\.|[^"\\])*)"'
                   r"|'(?:\\.|[^'\\])*'|\d[\w']*|(?P<name>[A-Za-z_]\w*)|\S", re.DOTALL | re.MULTILINE)


def texts_of(source):
    """(place, line, text, whether it is a docstring) of all comments, without code between backticks, and literals of C++ or C in their
    order, then of its distinct names as words. Neighbours that only space separates are one text."""
    texts, names, joins, line, at = [], {}, None, 1, 0
    for token in TOKEN.finditer(source):
        line, at = line + source.count("\n", at, token.start()), token.start()
        kind = "literal" if token["raw"] is not None or token["literal"] is not None else "comment" if token["comment"] else ""
        if token["name"]:
            names.setdefault(token["name"], line)
        if not kind:
            joins = None
            continue
        docstring, key = token[0].startswith("///"), (kind, token[0].startswith("///<"))
        text = re.sub(r"`[^`]*(`|$)", "", token[0].lstrip("/<")).strip(" ") if kind == "comment" else re.sub(
            r"\\.", " ", token["literal"]) if token["raw"] is None else token["raw"]
        if joins == key:
            _, begin, before, was = texts[-1]
            texts[-1] = kind, begin, before + (" " if kind == "comment" else "") + text, was or docstring
        else:
            texts.append((kind, line, text, docstring))
        joins = key
    for name, begin in sorted(names.items()):
        texts.append(("name", begin, re.sub("(?<=[^A-Z_])(?=[A-Z])|_+", " ", name).lower().strip(), False))
    return texts


def unit_tails_of(text):
    """Positions where a docstring appends units to a finished sentence, "…; time [s]", or a second docstring in brackets, "[what save()
    wrote]"."""
    return [found.end() - 2 for found in re.finditer(r"(?<=; )\w+ \[| \[(?=what )", text)]


WORDS = avoided_words(page("CONTRIBUTING.md")) + FURTHER_WORDS


def matches(path, source):
    """Matches of all rules in a source, "tasks/step/a.cpp:12: …", by folder, place and rule, "tasks/step,comment,wanted"."""
    found, folder = collections.defaultdict(list), "/".join(path.split("/")[:2] if path.count("/") > 1 else path.split("/")[:1])
    for place, line, text, docstring in texts_of(source):
        lower = text.lower()
        rules = {word: positions_of(lower, word) for word in WORDS if word in lower}
        if place == "comment":
            for begin in OPENINGS:  # of sentences
                rules[begin + "…"] = [each.start() for each in re.finditer(rf"(?:^|(?<=[.?!] )){begin}", text)]
            rules["; unit […]"] = unit_tails_of(text)
            rules["fragment …"] = [0] * (docstring and lower.startswith(FRAGMENTS))
        for rule, positions in rules.items():
            for at in positions:
                found[f"{folder},{place},{rule}"].append(f"{path}:{line}: {text[at:at + 60]}")
    return found


def all_matches():
    found = collections.defaultdict(list)
    for folder in ("model", "engine", "tasks", "api", "tools", "bench", "tests"):
        for path in sorted(path for path in (TOP / folder).rglob("*.*") if path.suffix in (".cpp", ".hpp", ".c", ".h")):
            for row, places in matches(path.relative_to(TOP).as_posix(), path.read_text(encoding="utf-8")).items():
                found[row] += places
    return found


def read_table():
    rows = (line.rpartition(",") for line in TABLE.read_text(encoding="utf-8").splitlines()[1:])
    return {row: int(count) for row, _, count in rows}


def differences(places, table):
    """Differences from the table, a message per row; empty: none."""
    text = ""
    for row in sorted({*places, *table}):
        found, allowed = places.get(row, []), table.get(row, 0)
        if len(found) != allowed:
            text += f"{row}: {len(found)} instead of {allowed}\n" + "".join(f"  {place}\n" for place in found if len(found) > allowed)
    return text


def totals(counts):
    """Matches per place and rule, in all folders together."""
    sums = collections.Counter()
    for row, count in counts.items():
        sums[row.partition(",")[2]] += count
    return sums


class Glossary(unittest.TestCase):
    maxDiff = None

    def test_words_listed_as_not_do_not_occur_in_pages(self):
        words = avoided_words(page("CONTRIBUTING.md"))
        self.assertGreaterEqual(len(words), 20)
        texts = {each.path: prose(each) for each in pages() if each.path != "CHANGELOG.md" and not each.path.startswith("docs/decisions/")}
        self.assertEqual([f"{path}: {word}: {text[at:at + 60]}" for path, text in texts.items() for word in words
                          for at in positions_of(text, word)], [])

    def test_words_are_found_in_prose_alone(self):
        sample = Page("sample.md", "| word | means | not |\n|---|---|---|\n| target | an aim | *wanted*, *goes on*, log |\n\nThe run\n  "
                                   "Goes\non; a `wanted` [x](wanted.md).\n\n    wanted\n\n```sh\nwanted\n```\nunwanted\n")
        self.assertEqual(avoided_words(sample), ["wanted", "goes on"])
        self.assertEqual((len(positions_of(prose(sample), "goes on")), positions_of(prose(sample), "wanted")), (1, []))

    def test_sources_match_the_table_of_rejected_words_which_only_shrinks(self):
        places, table = all_matches(), read_table()
        if "CVTFLOW_WRITE_WORDS" not in os.environ:
            self.assertEqual(differences(places, table), "", "Where a count grew, use the word of CONTRIBUTING's glossary, and begin the "
                                                             "sentence "
                             f"with its noun. Where counts only shrank, or a file moved: CVTFLOW_WRITE_WORDS=1 python3 {__file__}")
            return
        now = {row: len(each) for row, each in places.items()}
        before = totals(table)
        self.assertEqual({rule: count for rule, count in totals(now).items() if count > before[rule]}, {})
        TABLE.write_text("folder,place,rule,count\n" + "".join(f"{row},{now[row]}\n" for row in sorted(now)), encoding="utf-8")

    def test_words_are_found_in_comments_literals_and_names(self):
        found = matches("tasks/step/a.hpp",
                        '#include "wanted.hpp"\n/// The wanted step, `wanted`.\nint a = 1;  ///< unwanted; it goes\n            ///< on\n'
                        'const char* b = "energy_wanted", *c = "is " "\\nwanted", *d = R"(wanted)", e = \'"\';\n'
                        "double wanted_steps = 1'000, Rungs; /* wanted */ int steps_wanted_, lookWantedUp;\n")
        self.assertEqual(found, {f"tasks/step,{row}": [f"tasks/step/a.hpp:{place}" for place in places] for row, places in {
            "comment,wanted": ["2: wanted step, ."], "comment,goes on": ["3: goes on"], "literal,wanted": ["5: wanted", "5: wanted"],
            "name,wanted": ["6: wanted up", "6: wanted", "6: wanted steps"], "name,rung": ["6: rungs"],
            "name,look": ["6: look wanted up"]}.items()})

    def test_sentences_are_found_by_their_beginning_and_units_by_their_tail(self):
        found = matches("model/a/b.cpp",
                        "// What is it? Of steps.\n// Those of old. The same\n// again. Not What, nor Of.\nint a;\n/// That many steps; "
                        "time [s], tail [unknowns].\nvoid load();  ///< memory [what save() wrote]\n/// @param time [s]\n"
                        "int b;  ///< [size()] of steps\n/// Of c.\nint c;  ///< old; [m] of it; 0: [m]\nint d;  ///< by the steps\n"
                        "int e;  // by them\nint f;  ///< bytes\n")
        self.assertEqual({row: len(places) for row, places in found.items()}, {f"model/a,comment,{rule}": count for rule, count in {
            "; unit […]": 2, "Of …": 2, "That many …": 1, "The same …": 1, "Those …": 1, "What …": 1, "fragment …": 3}.items()})

    def test_counts_that_grew_and_counts_that_shrank_are_reported(self):
        row, places = "model/a,name,rung", {"model/a,name,rung": ["model/a/b.cpp:1: rung", "model/a/b.cpp:2: rung"]}
        self.assertEqual(differences(places, {row: 2}), "")
        self.assertEqual(differences(places, {row: 1}), f"{row}: 2 instead of 1\n  model/a/b.cpp:1: rung\n  model/a/b.cpp:2: rung\n")
        self.assertEqual(differences(places, {row: 3}), f"{row}: 2 instead of 3\n")
        self.assertEqual(differences({}, {row: 3}), f"{row}: 0 instead of 3\n")
        self.assertIn("2 instead of 0", differences(places, {}))


if __name__ == "__main__":
    unittest.main()
