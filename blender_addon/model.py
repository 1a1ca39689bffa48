# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain data of the add-on: settings made from the field table and presets, warnings (no bpy)."""

from dataclasses import dataclass, field
from math import isfinite

from .fields import ENGINE_FIELDS, LAYOUT_FIELDS

LIGHTMAP_UV = "AjarLightmap"


def _preset(noise, samples, bounce, direct, positions):
    return {
        "noise_target": noise,
        "samples": samples,
        "bounce_samples": bounce,
        "direct_samples": direct,
        "positions_per_texel": positions,
    }


# Noise targets are relative standard errors that 95 % of the texels keep; the rest are engine fields. Sample
# counts are the most that a texel gets: the target decides. Light that is reflected has noise of its own, which rays
# of the final gather do not lower, only bounce samples: an office with 130 lamps in sets aimed at 3.5% came to 9.3%
# with 128 of them, to 4.4% with 1024.
PRESETS = {
    "DRAFT": _preset(0.4, 512, 32, 512, 4),
    "PREVIEW": _preset(0.12, 2048, 64, 2048, 4),
    "PRODUCTION": _preset(0.04, 32768, 1024, 32768, 8),
    "REFERENCE": _preset(0.012, 262144, 4096, 65536, 16),
}


class SettingsError(ValueError):
    """A setting with an unknown name or a value outside its range."""


def check_value(setting, value):
    """Returns value in the field's own type; raises SettingsError naming the field."""
    if setting.kind == "bool":
        return bool(value)
    if setting.kind in {"int", "float"}:
        value = int(value) if setting.kind == "int" else float(value)
        low, high = setting.minimum, setting.maximum
        if not isfinite(value) or (low is not None and value < low) or (high is not None and value > high):
            raise SettingsError(f"{setting.name} must be in [{low}, {high}], not {value}")
        return value
    if setting.kind == "enum" and value not in {item[0] for item in setting.items}:
        raise SettingsError(f"{setting.name} has no choice {value!r}")
    return str(value)


def check_settings(values, fields):
    """A complete dict of fields: values given are checked, the rest take their defaults."""
    by_name = {f.name: f for f in fields}
    unknown = sorted(set(values) - set(by_name))
    if unknown:
        raise SettingsError("unknown setting " + ", ".join(unknown))
    return {name: check_value(f, values.get(name, f.default)) for name, f in by_name.items()}


def engine_settings(preset="PREVIEW", **overrides):
    """Settings of a bake (names of ajar_settings) from a preset; overrides that are None are left out.

    samples given without a noise target means exactly that many rays: the target becomes 0, and a quarter as
    many emitter samples are taken.
    """
    if preset not in PRESETS:
        raise SettingsError(f"unknown preset {preset!r}")
    given = {k: v for k, v in overrides.items() if v is not None}
    if "samples" in given and "noise_target" not in given:
        given["noise_target"] = 0.0
    for name in ("samples", "bounce_samples"):
        if name in given:
            given[name] = _power_of_two(given[name])
    values = {**PRESETS[preset], **given}
    # Without a target to stop them the cap of emitter samples would be their count.
    if values["noise_target"] == 0.0 and "direct_samples" not in given:
        values["direct_samples"] = max(16, values["samples"] // 4)
    return check_settings(values, ENGINE_FIELDS)


def layout_settings(**overrides):
    """Settings of a layout (names of ajar_layout_settings); overrides that are None are left out."""
    return check_settings({k: v for k, v in overrides.items() if v is not None}, LAYOUT_FIELDS)


def _power_of_two(count):
    """The next power of two: what the engine's sample sequence needs."""
    return 1 << max(0, int(count) - 1).bit_length()


@dataclass
class Warnings:
    """Named warnings in the order found, repeats merged."""

    items: list = field(default_factory=list)

    def add(self, culprit, text):
        """Notes that culprit (object, material, image... name) has the problem text tells."""
        if (culprit, text) not in self.items:
            self.items.append((culprit, text))

    def as_json(self):
        return [{"culprit": culprit, "text": text} for culprit, text in self.items]
