"""Checks the JSON schema of scenes with an independent validator.

Every ready scene, and the default of every key, must conform; broken scenes must not, whose message has the mark "=+=". Only the parser
can see the grammar, dimensions of texts, what values must satisfy together, and 84.0 for 84 (in JSON there is no difference).
Arguments: schema file, source folder. Exit status 77: jsonschema or tomllib is missing.
"""

import json
import pathlib
import re
import sys

try:
    import jsonschema
    import tomllib
except ImportError:
    sys.exit(77)


def main(schema_file, source):
    schema = json.loads(pathlib.Path(schema_file).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    failures = []
    for section, rows in schema["properties"].items():
        for name, value in rows["properties"].items():
            if not validator.is_valid({section: {name: value["default"]}}):
                failures.append(f"default of {section}.{name} is refused")
    for scene in sorted((pathlib.Path(source) / "scenes").glob("*.toml")):
        for error in validator.iter_errors(tomllib.loads(scene.read_text(encoding="utf-8"))):
            failures.append(f"{scene.name}: {error.json_path}: {error.message}")
    broken = (pathlib.Path(source) / "tests/tasks/scene/broken_scenes.txt").read_text(encoding="utf-8")
    scenes = [(text.group(1), text.group(2)) for text in re.finditer(r"^=(.)= .*\n(?!=)((?:(?!=.=).*\n)+)", broken, re.MULTILINE)]
    failures += [f"{scene} is accepted" for mark, scene in scenes if mark == "+" and validator.is_valid(tomllib.loads(scene))]
    if sum(mark == "+" for mark, _ in scenes) < 40:
        failures.append("hardly any broken scene has the mark of the schema")
    print("\n".join(failures))
    return 1 if failures else 0


sys.exit(main(*sys.argv[1:]))
