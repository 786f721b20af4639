"""Checks the JSON schema of scenes with an independent validator.

Every ready scene, and the default of every key, must conform; broken scenes of the kinds that a schema can see must not.
Arguments: schema file, source folder. Exit status 77: jsonschema or tomllib is missing.
"""

import json
import pathlib
import sys

try:
    import jsonschema
    import tomllib
except ImportError:
    sys.exit(77)

# How the names of such scenes begin. Only the parser can see the grammar, dimensions of texts, what values must satisfy together, and 84.0
# for 84 (in JSON there is no difference).
SEEN_BY_SCHEMA = (
    "unknown_", "key_", "section_", "nested_", "boolean_", "choice_", "number_is_boolean", "number_is_list",
    "number_is_table", "integer_is_text", "integer_is_list", "text_is_number", "pitch_in_millimetres",
    "pitch_list_empty", "pitch_list_two_wrong", "angle_in_degrees", "speed_in_rpm", "mass_in_grams",
    "step_in_nanoseconds", "plates_negative", "pins_too_few", "order_too_high", "friction_negative",
    "saturation_speed_zero", "smoothing_too_wide", "seed_too_large", "table_empty", "table_of_numbers",
    "table_point_of_three", "table_time_negative", "unit_without_number", "unit_text_empty",
)


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
    for name, scene in (part.split("\n", 1) for part in ("\n" + broken).split("\n=== ")[1:]):
        if name.startswith(SEEN_BY_SCHEMA) and validator.is_valid(tomllib.loads(scene)):
            failures.append(f"{name} is accepted")
    print("\n".join(failures))
    return 1 if failures else 0


sys.exit(main(*sys.argv[1:]))
