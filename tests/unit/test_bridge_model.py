# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings table: its presets and ranges, and that it covers the C structs."""
import pytest

from blender_addon import fields, model
from blender_addon.bridge import abi


def test_tables_cover_the_structs():
    not_settings = ("struct_size", "trial")  # a trial is another job, not another bake
    for table, struct in ((fields.ENGINE_FIELDS, abi.Settings), (fields.LAYOUT_FIELDS, abi.LayoutSettings)):
        assert [f.name for f in table] == [n for n, _ in struct._fields_ if n not in not_settings]


def test_defaults_are_in_range():
    tables = (
        fields.ENGINE_FIELDS,
        fields.LAYOUT_FIELDS,
        fields.SCENE_FIELDS,
        fields.OBJECT_FIELDS,
        fields.COLLECTION_FIELDS,
        fields.WORLD_FIELDS,
    )
    for field in sum(tables, ()):
        assert model.check_value(field, field.default) == field.default
        assert field.description and field.label, field.name


@pytest.mark.parametrize(
    "preset, noise", [("DRAFT", 0.4), ("PREVIEW", 0.12), ("PRODUCTION", 0.04), ("REFERENCE", 0.012)]
)
def test_presets(preset, noise):
    settings = model.engine_settings(preset, bounces=3, seed=None)
    assert settings["noise_target"] == noise and settings["bounces"] == 3 and settings["seed"] == 0
    assert settings["samples"] & (settings["samples"] - 1) == 0


def test_samples_alone_turn_the_target_off():
    settings = model.engine_settings("PREVIEW", samples=100)
    assert settings["samples"] == 128 and settings["noise_target"] == 0.0
    assert settings["direct_samples"] == 32
    with_target = model.engine_settings("PREVIEW", samples=100, noise_target=0.1)
    assert with_target["noise_target"] == 0.1 and with_target["direct_samples"] == 2048
    assert model.engine_settings("PREVIEW", samples=100, direct_samples=7)["direct_samples"] == 7


@pytest.mark.parametrize(
    "change",
    [
        {"bounces": -1},
        {"noise_target": 2.0},
        {"typo": 1},
        {"time_limit": float("nan")},
        {"combinations": "SOME"},
        {"term_threshold": -0.1},
    ],
)
def test_bad_settings(change):
    with pytest.raises(model.SettingsError, match=next(iter(change))):
        model.engine_settings("PREVIEW", **change)


def test_warnings_merge():
    warnings = model.Warnings()
    warnings.add("Cube", "x")
    warnings.add("Cube", "x")
    assert warnings.as_json() == [{"culprit": "Cube", "text": "x"}]
