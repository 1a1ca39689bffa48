# SPDX-License-Identifier: GPL-3.0-or-later
"""Exit code 0 if a JSON file obeys a schema: validate.py SCHEMA FILE."""
import json
import sys

import jsonschema

with open(sys.argv[1], encoding="utf-8") as schema, open(sys.argv[2], encoding="utf-8") as file:
    jsonschema.Draft202012Validator(json.load(schema)).validate(json.load(file))
