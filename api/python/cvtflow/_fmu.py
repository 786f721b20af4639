"""FMUs for co-simulation, FMI 2.0 and 3.0: the description, and the file with everything in it, the same bytes for the same parts."""

import dataclasses
import io
import re
import zipfile
from html import escape
from xml.etree import ElementTree

_READABLE = 65535  # a first part up to this size is not compressed, so that its text can be found
_STORED = zipfile.ZIP_STORED, None
_DEFLATED = zipfile.ZIP_DEFLATED, 5  # a library in a third of the time of the best level, 1.4 % larger
SYSTEMS = {"Linux": ({2: "linux64", 3: "x86_64-linux"}, ".so"), "Windows": ({2: "win64", 3: "x86_64-windows"}, ".dll")}


@dataclasses.dataclass
class Variable:
    """A variable. kind: time, input, output, parameter, or flag, a Boolean output. start, least, most, nominal: in `unit`; None: not stated.
    shown: a unit in which people read it. source, element: what it is inside."""

    kind: str
    name: str
    unit: str
    description: str
    width: int = 1
    start: float | None = None
    source: str = ""
    element: int = 0
    least: float | None = None
    most: float | None = None
    nominal: float | None = None
    shown: str = ""

    @property
    def is_output(self):
        return self.kind in ("output", "flag")


@dataclasses.dataclass
class Model:
    """An FMU. units: by name their exponents {"kg": 1, …} (None: not stated) and shown units {"kN": factor}; capabilities: names without
    "canHandle…", which are true; step: communication step of the default experiment [s]."""

    name: str
    identifier: str
    token: str
    description: str
    variables: list[Variable]
    units: dict[str, tuple]
    tool: str
    until: float
    step: float
    author: str = ""
    date: str = ""
    capabilities: tuple = ()
    log_categories: tuple = ()
    sources: tuple = ()


def identifier(name):
    """A name reduced to letters, digits and underscores: the name of the FMU's library."""
    plain = re.sub(r"[^A-Za-z0-9]", "_", name)
    return plain if plain and not plain[0].isdigit() else f"fmu_{plain}"


def _number(value):
    """The shortest text that reads back as the same number."""
    return repr(float(value)).removesuffix(".0")


def _add(parent, tag, attributes):
    """A child with those attributes that are neither None nor empty."""
    return ElementTree.SubElement(parent, tag, {name: value if isinstance(value, str) else str(value) for name, value in attributes.items()
                                                if value not in (None, "")})


def _units(parent, units):
    rows = ElementTree.SubElement(parent, "UnitDefinitions")
    for name, (exponents, shown) in sorted(units.items()):
        row = _add(rows, "Unit", {"name": name})
        if exponents is not None:
            _add(row, "BaseUnit", {base: power for base, power in exponents.items() if power} if exponents else {})
        for other, factor in shown.items():
            _add(row, "DisplayUnit", {"name": other, "factor": _number(factor)})


def _variable(parent, row, reference, fmi):
    """An element of ModelVariables."""
    causality = {"time": "independent", "flag": "output"}.get(row.kind, row.kind)
    common = {"name": row.name, "valueReference": reference, "causality": causality,
              "variability": {"parameter": "fixed", "flag": "discrete"}.get(row.kind, "continuous"), "description": row.description}
    values = {"start": _number(row.start) if row.kind in ("input", "parameter") else None, "unit": row.unit if row.unit != "1" else None,
              "displayUnit": row.shown, "min": None if row.least is None else _number(row.least),
              "max": None if row.most is None else _number(row.most), "nominal": _number(row.nominal) if row.nominal else None}
    if fmi == 3:
        made = _add(parent, "Boolean" if row.kind == "flag" else "Float64", common | values)
        if row.width > 1:
            _add(made, "Dimension", {"start": row.width})
    else:
        _add(_add(parent, "ScalarVariable", common), "Boolean" if row.kind == "flag" else "Real", values)


def _structure(parent, variables, fmi):
    """Outputs, and those that are unknown at the start: all of them."""
    made = ElementTree.SubElement(parent, "ModelStructure")
    numbers = [number for number, row in enumerate(variables) if row.is_output]
    for group, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        place = made if fmi == 3 else ElementTree.SubElement(made, group)
        for number in numbers:
            _add(place, tag if fmi == 3 else "Unknown", {"valueReference": number} if fmi == 3 else {"index": number + 1})


def _document(root):
    ElementTree.indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root) + b"\n"


def model_description(model, fmi):
    """modelDescription.xml as bytes."""
    root = ElementTree.Element("fmiModelDescription", {
        "fmiVersion": f"{fmi}.0", "modelName": model.name, "instantiationToken" if fmi == 3 else "guid": model.token,
        "description": model.description, "generationTool": model.tool, **({"author": model.author} if model.author else {}),
        **({"generationDateAndTime": model.date} if model.date else {}), "variableNamingConvention": "structured"})
    spelt = [name if fmi == 3 else name.replace("FMUState", "FMUstate") for name in model.capabilities]
    kind = _add(root, "CoSimulation", {"modelIdentifier": model.identifier, **{name: "true" for name in spelt}})
    if fmi == 2 and model.sources:
        files = ElementTree.SubElement(kind, "SourceFiles")
        for name in model.sources:
            _add(files, "File", {"name": name})
    _units(root, model.units)
    if model.log_categories:
        categories = ElementTree.SubElement(root, "LogCategories")
        for name in model.log_categories:
            _add(categories, "Category", {"name": name})
    _add(root, "DefaultExperiment", {"startTime": "0", "stopTime": _number(model.until), "stepSize": _number(model.step)})
    rows = ElementTree.SubElement(root, "ModelVariables")
    for reference, row in enumerate(model.variables):
        _variable(rows, row, reference, fmi)
    _structure(root, model.variables, fmi)
    return _document(root)


def build_description(model):
    """sources/buildDescription.xml of FMI 3 as bytes, of sources in C99."""
    root = ElementTree.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    files = _add(_add(root, "BuildConfiguration", {"modelIdentifier": model.identifier}), "SourceFileSet", {"language": "C99"})
    for name in model.sources:
        _add(files, "SourceFile", {"name": name})
    return _document(root)


def terminals(groups):
    """terminalsAndIcons.xml of FMI 3 as bytes: the icon, and a bus for each group. groups: description and {member: variable} by name"""
    root = ElementTree.Element("fmiTerminalsAndIcons", {"fmiVersion": "3.0"})
    picture, square = ElementTree.SubElement(root, "GraphicalRepresentation"), {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    _add(picture, "CoordinateSystem", square | {"suggestedScalingFactorTo_mm": "0.1"})
    _add(picture, "Icon", square)
    if groups := {name: group for name, group in groups.items() if group[1]}:
        rows = ElementTree.SubElement(root, "Terminals")
        for name, (description, members) in groups.items():
            bus = _add(rows, "Terminal", {"name": name, "matchingRule": "bus", "description": description})
            for member, variable in members.items():
                _add(bus, "TerminalMemberVariable", {"variableName": variable, "memberName": member, "variableKind": "signal"})
    return _document(root)


def page(title, paragraphs, variables):
    """documentation/index.html as bytes: paragraphs of HTML, and a table of the variables."""
    rows = "\n".join(f"<tr><td>{escape(row.name)}</td><td>{'output, Boolean' if row.kind == 'flag' else row.kind}</td>"
                     f"<td>{'' if row.unit == '1' else escape(row.unit)}</td><td>{escape(row.description, quote=False)}</td></tr>" for row in variables)
    words = "\n".join(f"<p>{each}</p>" for each in paragraphs)
    return (f'<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8"><title>{escape(title)}</title></head>\n<body>\n'
            f"<h1>{escape(title)}</h1>\n{words}\n<table><caption>Variables</caption><thead><tr><th>name</th><th>causality</th><th>unit</th>"
            f"<th>meaning</th></tr></thead><tbody>\n{rows}\n</tbody></table>\n</body>\n</html>\n").encode()


def packed(parts):
    """The bytes of a ZIP file. parts: bytes or text by name, the description first"""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as file:
        for number, (name, data) in enumerate(parts.items()):
            data = data.encode() if isinstance(data, str) else data
            row = zipfile.ZipInfo(name)  # of 1980: a file is the same whenever it is made
            row.external_attr, row.create_system = 0o100644 << 16, 3
            kind, level = _STORED if number == 0 and len(data) <= _READABLE else _DEFLATED
            file.writestr(row, data, kind, level)
    return content.getvalue()


def library_place(system, identifier, fmi):
    """The name in an FMU of its library for a system."""
    folders, ending = SYSTEMS[system]
    return f"binaries/{folders[fmi]}/{identifier}{ending}"
