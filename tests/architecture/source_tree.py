"""The source tree for the architecture tests, and a scanner of braces: enough C++ to measure functions and classes, no more."""

import functools
import os
import re
import subprocess
import unittest
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parents[2]
FOLDERS = ("model", "engine", "tasks", "api", "tools", "bench", "examples", "tests")
GIT = f"git -c safe.directory='*' -C '{TOP}' "  # also where another user owns the sources


class SourceFile(NamedTuple):
    path: str  # relative to the top level, with slashes
    text: str

    @property
    def header(self):
        return self.path.endswith(".hpp")

    @property
    def part(self):
        """Folder of the top level: "model", "engine" …"""
        return self.path.partition("/")[0]

    @property
    def folder(self):
        return self.path.rpartition("/")[0]


class Include(NamedTuple):
    line: int
    name: str
    quoted: bool


class Function(NamedTuple):
    """A block that opens outside all functions: the body of a function or lambda at namespace or class scope."""

    head: str
    line: int
    lines: int  # from head to closing brace
    body: str  # without comments and literals


class Class(NamedTuple):
    """A class, struct or union; methods without constructors, destructor, operators, and what is deleted or defaulted."""

    name: str
    line: int
    bases: list  # without namespaces and template arguments
    methods: list


@functools.cache
def source_files():
    """All .cpp and .hpp files below the source folders, ascending by path."""
    paths = [path for folder in FOLDERS for path in (TOP / folder).rglob("*.[ch]pp")]
    files = [SourceFile(path.relative_to(TOP).as_posix(), path.read_text(encoding="utf-8")) for path in paths]
    return sorted(files, key=lambda file: file.path)


def output_of(command):
    """Output of a shell command, empty if it fails."""
    done = subprocess.run(command, shell=True, executable="/bin/bash", capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else ""


@functools.cache
def tracked_top_level():
    """Names on the top level that git tracks."""
    names = {path.partition("/")[0] for path in output_of(GIT + "ls-files 2>/dev/null").splitlines()}
    if not names:
        raise unittest.SkipTest("no git to ask")
    return names


def includes_of(text):
    found = re.compile(r"\s*#\s*include\s*([<\"])([^>\"]+)[>\"]")
    matches = ((number, found.match(line)) for number, line in enumerate(text.split("\n"), 1))
    return [Include(number, match[2], match[1] == '"') for number, match in matches if match]


NOISE = re.compile(r'(?<=R)"([^(]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"?|/\*.*?\*/|//(?:[^\n]*\\\n)*[^\n]*'
                   r"|(?<!\w)'(?:\\.|[^'\\\n])*'?|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.DOTALL | re.MULTILINE)


@functools.cache
def code_only(text):
    """The text with comments, literals and preprocessor lines blanked out; lines stay where they are."""
    return NOISE.sub(lambda noise: re.sub(r"[^\n]", " ", noise[0]), text)


SCOPE = re.compile(r"(?:template\s*<.*>\s*)?(?:requires\s*\([^()]*\)\s*)?(?:(?:inline|export|typedef|extern)\s*)*"
                   r"(?:namespace|class|struct|union|enum)\b(?:\s+alignas\s*\([^()]*\))?[^()=]*|extern\s*")


def one_line(text):
    return " ".join(text.split())


def plain_head(head):
    """A head without attributes and the access specifier in front of a member."""
    return one_line(re.sub(r"\[\[.*?\]\] ?|\b(public|private|protected) ?: ?", "", one_line(head)))


def line_of(code, position):
    return 1 + code.count("\n", 0, position)


def blocks(code):
    """(text between the last ; { or } and this one, that character, its position, position where its block ends) outside functions, in
    their order. The block of a scope ends at once: what is in it follows."""
    marks = [(mark.start(), mark[0]) for mark in re.finditer("[;{}]", code)]
    begin = k = 0
    while k < len(marks):
        at, kind = marks[k]
        head = code[begin:at]
        if kind == "{" and not SCOPE.fullmatch(plain_head(head)):
            depth = 1
            while depth and k + 1 < len(marks):
                k += 1
                depth += {"{": 1, "}": -1, ";": 0}[marks[k][1]]
        yield head, kind, at, marks[k][0]
        begin = marks[k][0] + 1
        k += 1


def functions_of(text):
    code, found = code_only(text), []
    for raw, kind, at, end in blocks(code):
        head = one_line(raw)
        if kind != "{" or end == at or (head and (head.endswith("=") or "(" not in head)):
            continue  # a statement, a scope, a table
        line = line_of(code, at - len(raw.lstrip()))
        found.append(Function(head, line, line_of(code, end) - line + 1, code[at:end]))
    return found


def statements(text):
    """(head, scopes around it, position, whether it is defined) of everything that namespaces and classes declare."""
    code, scopes = code_only(text), []
    for raw, kind, at, end in blocks(code):
        head = plain_head(raw)
        if kind == "}":
            scopes[-1:] = []
        elif kind == "{" and end == at:
            scopes.append(head)
            yield head, tuple(scopes), at, None
        elif head:
            yield head, tuple(scopes), at, kind == "{"


def class_of(scope):
    """Class whose head that is; empty: a namespace."""
    found = re.search(r"(?:^|> |\) )(?:class|struct) (?:alignas ?\([^)]*\) |[A-Z_]+ )?(\w+)", scope)
    return found[1] if found else ""


def function_name(head):
    """Name of the function that a head begins, with its class where it is given; empty if it is none for others."""
    if "operator" in head or re.search(r"^(template|using|friend|static|static_assert|typedef|return|extern|enum|catch|inline)\b"
                                       r"|\)[^()]*= ?(0|default|delete)$", head):
        return ""
    found = re.search(r"^[^(=<]*?(?:<[^()]*>[^(=<]*?)?((?:\w+::)?~?\b\w+) ?\((?!\*)", head)
    return found[1] if found and found[1] not in ("void", "bool", "int", "double", "alignas", "noexcept", "decltype", "operator") else ""


def named_functions(text):
    """(name or Class::name, whether it is defined) of functions that other files may call, without templates, operators, and those that are
    static, pure, defaulted, deleted or in an unnamed namespace."""
    found = []
    for head, scopes, _, defined in statements(text):
        if defined is None or "namespace" in scopes or not (name := function_name(head)):
            continue
        around = class_of(scopes[-1]) if scopes else ""
        found.append((f"{around}::{name}" if around else name, defined))
    return found


def bases_of(head):
    before = None
    while before != head:
        before, head = head, re.sub(r"<[^<>]*>", "", head)
    return re.findall(r"(?: : |, )(?:(?:public|private|protected|virtual) )*(?:\w+::)*(\w+)", head)


def method_name(head, inside):
    """Name of the method of class `inside` that a head declares; empty if it declares none."""
    plain = re.sub(r"^(?:template ?<.*?> (?=\w)|requires ?\([^()]*\) |(?:static|inline|constexpr|virtual|explicit) )+", "", head)
    if re.search(r"^(?:using|friend|typedef|static_assert|enum|struct|class)\b|\boperator\b|~|\) ?= ?(?:default|delete)$", plain):
        return ""
    found = re.search(r"^[^(=]*?\b(\w+) ?\(", plain)
    return found[1] if found and found[1] != inside else ""


def classes_of(text):
    found, open_classes, code = [], {}, code_only(text)
    for head, scopes, at, defined in statements(text):
        if defined is None:
            name = class_of(head)
            open_classes[scopes] = Class(name, line_of(code, at), bases_of(head), []) if name else None
            found += [open_classes[scopes]] if name else []
        elif inside := open_classes.get(scopes):
            found_method = method_name(head, inside.name)
            inside.methods.extend([found_method] if found_method else [])
    return found


class Rules(unittest.TestCase):
    """Tests that name every place where a rule is broken, up to a screen of them."""

    maxDiff = None

    def none(self, places, why=""):
        self.assertEqual(list(places)[:40], [], why)

    def only(self, found, exempt):
        """A rule is broken in the files that are exempt, each with a reason, and in no other. @param found: what breaks it, by file"""
        self.none(f"{path}: '{what}'" for path, what in found.items() if path not in exempt)
        self.none(f"{path} is exempt and need not be: {exempt[path]}" for path in exempt if path not in found)


def main():
    unittest.main(verbosity=2 if os.environ.get("VERBOSE") else 1)
