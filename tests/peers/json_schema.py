"""Validates documents of `profidrive --json` against docs/schema, with the independent package jsonschema.

Reads JSON Lines from standard input and prints one line for each document that is not valid. A field that no schema
describes is a mistake too: at each place where a field can be, the schemas are made strict first.
"""

import json
import pathlib
import sys

from jsonschema import Draft202012Validator
from referencing import Registry, Resource


def strict(schema):
    """Forbids fields that are not described, in every object that is the value of a field or an element."""
    if isinstance(schema, list):
        for one in schema:
            strict(one)
    elif isinstance(schema, dict):
        for field in schema.get("properties", {}).values():
            close(field)
        if isinstance(schema.get("items"), dict):
            close(schema["items"])
        for value in schema.values():
            strict(value)


def close(schema):
    if isinstance(schema, dict) and "additionalProperties" not in schema:
        if any(key in schema for key in ("$ref", "anyOf", "oneOf", "properties")):
            schema["unevaluatedProperties"] = False


def main(folder):
    schemas = {path.name: json.loads(path.read_text()) for path in pathlib.Path(folder).glob("*.json")}
    for name, schema in schemas.items():
        Draft202012Validator.check_schema(schema)
        strict(schema)
        if name != "definitions.json":
            schema["unevaluatedProperties"] = False
    resources = [(name, Resource.from_contents(schema)) for name, schema in schemas.items()]
    registry = Registry().with_resources(resources)
    for line in sys.stdin:
        document = json.loads(line)
        command = document.get("command", "")
        schema = schemas.get(command.replace(" ", "-") + ".json")
        if schema is None:
            print(f"{command!r} has no schema: {line[:200]}")
            continue
        validator = Draft202012Validator(schema, registry=registry)
        for error in validator.iter_errors(document):
            found = list(reasons(error))
            print(f"{command}: {'; '.join(found)}: {line.strip()[:600]}")


def reasons(error):
    """The innermost causes: that of a choice is in its alternatives."""
    yield f"{error.json_path}: {error.message[:300]}"
    for inner in error.context or ():
        yield from reasons(inner)


main(sys.argv[1])
