"""Pages of the documents for tests: Markdown with fenced blocks, and comments above blocks that state how a block is used."""

import functools
import re
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parents[2]


class Block(NamedTuple):
    """A fenced block of a page, and what the comment above it states: `file` to which it is written, `nightly` its time if longer than
    seconds, `deep` the suite that has its promise in quick runs, `needs` the optional programs without which it is skipped, `not run` the
    reason why it cannot run."""

    line: int  # of the opening fence
    language: str
    text: str
    comment: dict

    def runs(self):
        """Whether it is run, as commands or as Python."""
        return (self.language == "sh" or (self.language == "python" and "file" not in self.comment)) and "not run" not in self.comment

    def is_deep(self):
        """Whether it needs full depth: by its comment, or for the laboratory."""
        return "deep" in self.comment or "cvtflow-lab" in self.text or "bench/" in self.text


class Page(NamedTuple):
    path: str  # relative to the top level, with slashes
    text: str

    def walk(self):
        """(number, line, whether it is in a block, fences included)"""
        inside = False
        for number, line in enumerate(self.text.removesuffix("\n").split("\n"), 1):
            fence = line.startswith("```")
            yield number, line, inside or fence
            inside ^= fence

    def blocks(self):
        found, comment, lines = [], {}, None
        for number, line, inside in self.walk():
            if not inside:
                if match := re.fullmatch("<!-- (file|nightly|deep|needs|not run): (.*) -->", line):
                    comment[match[1]] = match[2]
            elif not line.startswith("```"):
                lines.append(line + "\n")
            elif lines is None:
                begin, language, lines = number, line[3:], []
            else:
                found.append(Block(begin, language, "".join(lines), comment))
                comment, lines = {}, None
        return found

    def text_lines(self):
        return [(number, line) for number, line, inside in self.walk() if not inside]

    def links(self):
        """Targets of links and pictures, as written, without blocks and code."""
        return [target for _, line in self.text_lines() for target in re.findall(r"\]\(([^)\s]+)\)", re.sub("`[^`]*`", "", line))]

    def anchors(self):
        """Names under which headings can be reached: lower case, punctuation left out, spaces as hyphens."""
        heads = [line.partition(" ")[2] for _, line in self.text_lines() if line.startswith("#")]
        return ["".join(c for c in head.replace(" ", "-") if c.isascii() <= (c.isalnum() or c in "-_")).lower() for head in heads]


@functools.cache
def pages():
    """Every page that documents the project: *.md at the top level, in docs, model, tools and api; ascending by path."""
    paths = [*TOP.glob("*.md"), *(path for folder in ("docs", "model", "tools", "api") for path in (TOP / folder).rglob("*.md"))]
    return sorted(Page(path.relative_to(TOP).as_posix(), path.read_text(encoding="utf-8")) for path in paths)


def page(path):
    return next(each for each in pages() if each.path == path)
