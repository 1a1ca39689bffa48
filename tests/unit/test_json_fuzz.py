# SPDX-License-Identifier: GPL-3.0-or-later
"""Broken snapshot.json files, made by a fixed seed: the reader and the engine refuse them or build what they say, and
nothing else happens."""
import copy
import json
import random

import pytest

from blender_addon.bridge import scene_builder
from blender_addon.bridge.library import BakeError, load_library
from blender_addon.bridge.snapshot_io import Reader, SnapshotError
from test_bridge_worker import with_elements

MUTATIONS = 4000
ODD = [
    None,
    True,
    -1,
    0,
    1,
    7,
    2**31,
    2**32 - 1,
    2**64,
    -0.5,
    1e39,
    float("nan"),
    float("inf"),
    "",
    "x",
    [],
    [0],
    {},
]


def places(value, path=()):
    """Paths of everything inside a JSON value."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield path + (key,)
        yield from places(inner, path + (key,))


def mutate(data, dice):
    """The data with one to three places changed, left out or doubled."""
    data = copy.deepcopy(data)
    for _ in range(dice.randint(1, 3)):
        path = dice.choice(list(places(data)))
        parent = data
        for key in path[:-1]:
            parent = parent[key]
        how = dice.random()
        if how < 0.15:
            del parent[path[-1]]
        elif how < 0.25 and isinstance(parent, list):
            parent.append(copy.deepcopy(parent[path[-1]]))
        else:
            parent[path[-1]] = copy.deepcopy(dice.choice(ODD))
    return data


def build(engine, folder):
    """Whether the engine takes the snapshot; other exceptions than its errors come through."""
    try:
        with Reader(folder) as reader:
            builder = scene_builder.SceneBuilder(engine, reader)
            try:
                builder.build()
                scene_builder.fill_settings(engine, reader.data.get("settings") or {})
                return True
            finally:
                builder.release()
    except (SnapshotError, BakeError):
        return False


@pytest.fixture(scope="module")
def engine(library):
    return load_library(library)


def test_changed_places_are_refused_or_built(tmp_path, engine):
    folder = with_elements(tmp_path / "shot")
    file = folder / "snapshot.json"
    good, dice, built = json.loads(file.read_text()), random.Random(1), 0
    assert build(engine, folder)
    for number in range(MUTATIONS):
        text = json.dumps(mutate(good, dice))
        file.write_text(text)
        try:
            built += build(engine, folder)
        except Exception as error:
            raise AssertionError(f"mutation {number}: {type(error).__name__}: {error} for {text}") from error
    assert 0.02 * MUTATIONS < built < 0.9 * MUTATIONS, "mutations are too mild or too wild to tell anything"


def test_text_cut_anywhere_is_refused(tmp_path, engine):
    folder = with_elements(tmp_path / "shot")
    file = folder / "snapshot.json"
    text = file.read_bytes()
    for length in range(0, len(text), 7):
        file.write_bytes(text[:length])
        assert not build(engine, folder), length


def test_flipped_bits_of_text_are_refused_or_built(tmp_path, engine):
    folder = with_elements(tmp_path / "shot")
    file = folder / "snapshot.json"
    good, dice = file.read_bytes(), random.Random(2)
    for _ in range(500):
        text = bytearray(good)
        for _ in range(dice.randint(1, 4)):
            text[dice.randrange(len(text))] ^= 1 << dice.randrange(8)
        file.write_bytes(text)
        build(engine, folder)
