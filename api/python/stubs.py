"""Writes the type stub of the extension module from the signatures that it tells itself.

    stubs.py FOLDER    FOLDER/cvtflow/_cvtflow.*.so is there; writes FOLDER/cvtflow/_cvtflow.pyi
"""

import importlib.util
import inspect
import re
import sys
from pathlib import Path

INDENT = "    "
SPECIAL = ("__init__", "__getitem__", "__iter__", "__enter__", "__exit__")  # what syntax needs; type checkers know the others


def signature(doc):
    """What follows the name in pybind11's first line, with names of this module alone, and the text below it."""
    first, _, rest = (doc or "").partition("\n")
    found = re.match(r"\w+(\(.*\)) -> (.*)$", first)
    if not found:
        return "(*args: Any, **kwargs: Any) -> Any", doc or ""
    arguments, result = (re.sub(r"\b(cvtflow\.)?_cvtflow\.|pybind11_builtins\.\w+", "", part) for part in found.groups())
    arguments = re.sub(r"numpy\.ndarray\[[^]]*\]", "numpy.ndarray", arguments)
    arguments = re.sub(r" = <[^>]*>", " = ...", arguments).replace("os.PathLike", "Union[str, os.PathLike[str]]")
    result = "Any" if result == "object" else re.sub(r"numpy.ndarray.*", "numpy.ndarray", result)
    return strict(f"{arguments} -> {result}"), rest.strip()


def strict(text):
    """A signature with the parameters of generic types that strict checking requires."""
    text = re.sub(r"\bnumpy\.ndarray\b", "numpy.ndarray[Any, Any]", text)
    text = re.sub(r"(\*\*kwargs|\*args)(?=[,)])", r"\1: Any", re.sub(r"\bIterator\b(?!\[)", "Iterator[Any]", text))
    return re.sub(r"\bdict\b(?!\[)", "Dict[str, Any]", re.sub(r"\blist\b(?!\[)", "List[Any]", text))


def function(name, member, depth, static=False):
    text, doc = signature(member.__doc__)
    text = re.sub(r"-> .*", "-> None", text) if name == "__init__" else text
    lines = [INDENT * depth + "@staticmethod"] if static else []
    lines += [INDENT * depth + f"def {name}{text}:"]
    lines += [INDENT * (depth + 1) + f'"""{doc}"""'] if doc else []
    return lines + [INDENT * (depth + 1) + "..."]


def value(name, member):
    found = re.search(r"-> (.*)", (member.fget.__doc__ if member.fget else "") or "")
    kind = re.sub(r"\b(cvtflow\.)?_cvtflow\.", "", found.group(1)) if found and found.group(1) != "object" else "Any"
    lines = [INDENT + "@property", INDENT + f"def {name}(self) -> {kind}:"]
    lines[-1] = strict(lines[-1])
    return lines + ([INDENT * 2 + f'"""{member.__doc__.strip()}"""'] if member.__doc__ else []) + [INDENT * 2 + "..."]


def type_lines(name, made):
    bases = ", ".join(base.__name__ for base in made.__bases__ if base.__name__ not in ("object", "pybind11_object"))
    lines = [f"class {name}({bases}):" if bases else f"class {name}:"]
    if made.__doc__ and not made.__doc__.startswith("Members:"):
        lines.append(INDENT + f'"""{made.__doc__.strip()}"""')
    for key, member in vars(made).items():
        if key == "__doc__":
            continue
        if isinstance(member, property):
            lines += value(key, member)
        elif isinstance(member, made):
            lines.append(INDENT + f"{key}: {name}")
        elif isinstance(member, staticmethod) and not key.startswith("_"):
            lines += function(key, member.__func__, 1, static=True)
        elif callable(member) and (not key.startswith("_") or key in SPECIAL):
            lines += function(key, member, 1)
    return lines + [INDENT + "..."]


def main(folder):
    file = next(Path(folder, "cvtflow").glob("_cvtflow.*.so"))
    spec = importlib.util.spec_from_file_location("cvtflow._cvtflow", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    lines = ['"""The C++ interface of cvtflow; made from the module itself."""', ""]
    lines += ["import os", "from typing import *", "import numpy", ""]
    for name, member in vars(module).items():
        if name.startswith("_"):
            continue
        lines += type_lines(name, member) if inspect.isclass(member) else function(name, member, 0)
        lines.append("")
    Path(folder, "cvtflow", "_cvtflow.pyi").write_text("\n".join(lines), encoding="utf-8")


main(sys.argv[1])
