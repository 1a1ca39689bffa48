# SPDX-License-Identifier: GPL-3.0-or-later
"""The schemas themselves: valid, closed, and every field described."""
import json
from pathlib import Path

import jsonschema
import pytest

SCHEMAS = Path(__file__).resolve().parents[2] / "schemas"
NAMES = ("layout", "manifest", "patches", "report", "snapshot")


def load(name):
    return json.loads((SCHEMAS / f"{name}.schema.json").read_text(encoding="utf-8"))


def objects(schema, path=""):
    """Every object schema with properties, and where it is."""
    if isinstance(schema, dict):
        if isinstance(schema.get("properties"), dict):
            yield path or "/", schema
        for key, value in schema.items():
            yield from objects(value, f"{path}/{key}")


@pytest.mark.parametrize("name", NAMES)
def test_schema_is_valid_draft_2020_12(name):
    schema = load(name)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["$schema"].endswith("2020-12/schema")
    assert "Apache-2.0" in schema["$comment"]
    assert "extras" in schema["properties"]


@pytest.mark.parametrize("name", NAMES)
def test_objects_are_closed_and_fields_described(name):
    for path, schema in objects(load(name)):
        assert schema.get("additionalProperties") is False, path
        assert schema.get("title") and schema.get("description"), path
        for field, value in schema["properties"].items():
            assert "description" in value or "description" in str(value), f"{path}/{field}"
        assert set(schema.get("required", ())) <= set(schema["properties"]), path


def test_an_unknown_field_is_refused():
    validator = jsonschema.Draft202012Validator(load("layout"))
    good = {"version": 1, "settings": {"texels_per_meter": 8, "atlas_size": 1024}, "meshes": []}
    assert validator.is_valid(good)
    assert not validator.is_valid({**good, "settings": {"texel_per_meter": 8}})
