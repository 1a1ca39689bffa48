# SPDX-License-Identifier: GPL-3.0-or-later
"""The accuracy command's arithmetic, on made-up bakes whose errors are known."""
import json
import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from blender_addon.accuracy import advice, bakes, knobs, measure, page, pictures, shortcuts, still, storage

COUNT = 20000


def made_up(bias, noise, reference_noise=0.0, seed=1):
    """Error of two bakes with a relative bias and noise at points of very different light."""
    random = np.random.default_rng(seed)
    light = np.exp(random.normal(0.0, 1.5, COUNT))
    own = reference_noise * light
    truth = measure.Truth(light + own * random.normal(size=COUNT), own)
    scale = light + measure.FLOOR * light.mean()
    signs = random.choice([-1.0, 1.0], COUNT)
    first, second = (light + scale * (bias * signs + noise * random.normal(size=COUNT)) for _ in range(2))
    return measure.error(truth, first, second)


@pytest.mark.parametrize("bias,noise", [(0.0, 0.05), (0.04, 0.0), (0.03, 0.06)])
def test_bias_and_noise_are_told_apart(bias, noise):
    error = made_up(bias, noise)
    assert error.bias.value == pytest.approx(bias, abs=0.003)
    assert error.noise.value == pytest.approx(noise, abs=0.002)
    assert error.total.value == pytest.approx(np.hypot(bias, noise), abs=0.002)
    assert error.total.low <= error.total.value <= error.total.high


def test_the_reference_s_own_noise_is_taken_off():
    error = made_up(0.03, 0.04, reference_noise=0.05)
    assert error.total.value == pytest.approx(0.05, abs=0.003)
    assert error.bias.value == pytest.approx(0.03, abs=0.004)


def test_one_wrong_point_counts_for_100_percent():
    light = np.ones(100)
    truth = measure.Truth(light, 0 * light)
    wrong = light.copy()
    wrong[0] = 500.0
    assert measure.error(truth, wrong, wrong).total.value == pytest.approx(0.1)


def test_differences_by_chance_are_not_differences():
    one, other, better = made_up(0.0, 0.05, seed=1), made_up(0.0, 0.05, seed=2), made_up(0.0, 0.04, seed=3)
    assert not measure.differs(one, other)
    assert measure.differs(one, better)


def test_spherical_harmonics_give_the_irradiance_of_a_plain_sky():
    sh = np.zeros((1, 9))
    sh[0, 0] = 2.0 * np.sqrt(np.pi)  # radiance 1 from everywhere
    for n in storage.NORMALS:
        assert storage.sh_irradiance(sh, n, 2)[0] == pytest.approx(np.pi)


@pytest.mark.parametrize("value", [1.0, 0.37, 250.0, 1e-5])
def test_small_floats(value):
    exponent = int(np.floor(np.log2(value)))
    stored = max(exponent, -14)
    fraction = round((value / 2.0**stored - (1.0 if exponent >= -14 else 0.0)) * 64)
    bits = np.array([((stored + 15) << 6 if exponent >= -14 else 0) + fraction], np.uint32)
    assert storage.small_float(bits, 6)[0] == pytest.approx(value, rel=0.01, abs=1e-6)


def test_lookup_is_bilinear():
    layer = np.add.outer(10.0 * np.arange(4), np.arange(8)).astype(float)  # rows, columns
    uv = np.array([[0.5 / 8, 0.5 / 4], [2.0 / 8, 1.0 / 4], [0.0, 0.0], [1.0, 1.0]])
    assert bakes.lookup([layer], np.zeros(4, int), uv) == pytest.approx([0.0, 1.5 + 5.0, 0.0, 37.0])


def trial(knob, value, seconds, bias, noise, seed=0):
    t = knobs.Trial(knob, value, {})
    error = made_up(bias, noise, seed=seed + 10)
    t.results = {"seconds": seconds, "wall": seconds, "texels": 1, "rays": 1, "error": error}
    t.results.update(estimated=noise, true=noise, report_rms=noise, report_rms_other_seed=noise)
    return t


def trials():
    base = trial("preset", "preview", 10.0, 0.02, 0.06)
    base.results["knob_values"] = {"bounces": 6, "noise target": 0.05}
    return [
        base,
        trial("noise target", 0.025, 40.0, 0.02, 0.03),
        trial("noise target", 0.0125, 160.0, 0.02, 0.015),
        trial("bounces", 1, 9.0, 0.2, 0.06),
        trial("combinations", "none", 3.0, 0.02, 0.06, seed=4),
    ]


def test_frontier_leaves_out_what_is_beaten():
    names = [t.name for t in advice.frontier(trials())]
    assert names[0] == "combinations none" and names[-2:] == ["noise target 0.025", "noise target 0.0125"]
    assert "bounces 1" not in names


def test_the_price_of_a_halving_lies_between_the_settings_around_it():
    front = advice.frontier(trials())
    assert 40.0 < advice.seconds_for(front, 0.03) < 160.0
    assert advice.seconds_for(front, 0.001) is None


def test_advice_names_the_knob_that_pays_and_what_is_wasted():
    all_trials = trials()
    text = " ".join(advice.recommend(all_trials, all_trials[0], measure.differs, 0.0))
    assert "Most per second buys noise target 0.025" in text
    assert "bounces 1" not in text
    assert "combinations none is no worse" in text
    assert "the next halving costs" in text


def test_advice_tells_when_the_bake_does_not_know_its_noise():
    all_trials = trials()
    words = lambda: " ".join(advice.recommend(all_trials, all_trials[0], measure.differs, 0.0))  # noqa: E731
    assert "states" not in words()
    all_trials[0].results["estimated"] = 0.04
    assert "states less noise than it has: 4% instead of 6%" in words()


def test_the_worst_points_are_told_apart():
    light = np.ones(1000)
    wrong = light.copy()
    wrong[:10] += 0.5
    error = measure.error(measure.Truth(light, 0 * light), wrong, wrong)
    assert error.worst == pytest.approx(1.0) and error.median == 0.0


def test_numbers_in_words():
    assert [advice.percent(x) for x in (0.0312, 0.5, 0.004)] == ["3.1%", "50%", "0.4%"]
    assert [advice.duration(x) for x in (4.0, 42.0, 660.0, 7200.0)] == ["4 s", "42 s", "11.0 min", "2.0 h"]


def test_page_is_whole_and_needs_nothing_else(tmp_path):
    about = {"scene": "a<b", "points": 10, "floor": 0.1, "reference_bounces": 32, "batches": 4, "threads": 2}
    about.update(reference_seconds=3.0, reference_noise=0.01, state="x", skipped=["y"])
    all_trials = trials()
    bands = {"flat": measure.Band(0.2, 0.1, 0.3)}
    sides = [
        shortcuts.Side(how, [], made_up(bias, 0.05), seconds)
        for how, bias, seconds in (("cheap & quick", 0.2, 3.0), ("dear", 0.0, 9.0))
    ]
    cuts = [shortcuts.Shortcut("doors", *sides, measure.Band(0.19, 0.1, 0.3), "without")]
    picture = ("page", pictures.data_uri(np.zeros((4, 5, 3), np.uint8)))
    extras = page.Extras(bands, cuts, [picture])
    page.write_page(tmp_path / "p.html", about, all_trials, ["words & numbers"], extras)
    text = (tmp_path / "p.html").read_text(encoding="utf-8")
    assert "cheap &amp; quick" in text and "19%" in text and 'src="data:image/png' in text
    assert "a&lt;b" in text and "words &amp; numbers" in text
    assert "http" not in text and "<script" not in text and "nan%" not in text
    drawings = text.split("<svg")[1:]
    assert len(drawings) >= 4
    for drawing in drawings:
        ElementTree.fromstring("<svg" + drawing.split("</svg>")[0] + "</svg>")


@pytest.mark.parametrize("quick", [True, False])
def test_plan_tries_every_knob_in_the_engine_s_ranges(quick):
    from blender_addon import model
    from blender_addon.fields import ENGINE_FIELDS

    for preset, base in bakes.presets().items():
        base = {**model.engine_settings(preset.upper()), **base}
        plan = knobs.plan(preset, base, 8.0, True, quick)
        assert plan[0].knob == knobs.PRESET and plan[0].value == preset
        assert len({(t.knob, t.value) for t in plan}) == len(plan)
        for t in plan:
            model.check_settings(t.settings, ENGINE_FIELDS)
            for name in ("samples", "bounce_samples"):
                value = t.settings.get(name, 1)
                assert value & (value - 1) == 0, t.name


ELEMENTS = [
    {"name": "left", "kind": "light_set", "weight": 1.0},
    {"name": "right", "kind": "light_set", "weight": 1.0},
    {"name": "gate", "kind": "door", "weight": 0.0},
    {"name": "crate", "kind": "toggle", "weight": 1.0},
]


def light_in(share, terms):
    return sum(share(elements) * light for elements, light in terms.items())


def test_few_states_are_right_where_all_sets_are_on_and_wrong_where_some_are_not():
    terms = {(): 1.0, (0,): 2.0, (1,): 3.0, (2,): 0.5, (0, 2): 4.0, (1, 2): 0.25, (1, 3): -0.5}
    for weights in ([1, 1, 1, 1], [1, 0, 0, 1], [0, 1, 0, 0], [0.3, 0.7, 0, 1]):
        few, full = shortcuts.few_states(ELEMENTS, weights), bakes.product_of(weights)
        assert light_in(few, terms) == pytest.approx(light_in(full, terms)), weights
    few, full = shortcuts.few_states(ELEMENTS, [0, 1, 1, 1]), bakes.product_of([0, 1, 1, 1])
    assert light_in(few, terms) - light_in(full, terms) == pytest.approx(4.0), "what comes from the other set"


def test_random_states_leave_toggles_and_open_all_doors_once():
    states = shortcuts.random_states(ELEMENTS, 8)
    assert states[0][2] == 1.0 and {s[2] for s in states} == {0.0, 1.0}
    assert {s[3] for s in states} == {1.0} and {s[0] for s in states} == {0.0, 1.0}


def test_apart_leaves_noise_out():
    random = np.random.default_rng(3)
    light = np.ones(COUNT)
    noisy = lambda level: light * level + 0.1 * random.normal(size=COUNT)  # noqa: E731
    band = measure.apart(light, (noisy(1.05), noisy(1.05)), (noisy(1.0), noisy(1.0)))
    assert band.value == pytest.approx(0.05, abs=0.01)


def test_a_scene_as_it_stands_has_only_what_is_there(tmp_path):
    folder = tmp_path / "snapshot"
    folder.mkdir()
    (folder / "snapshot.bin").write_bytes(b"arrays")
    leaf = lambda name, **more: {"name": name, "visibility": ["gather"], **more}  # noqa: E731
    data = {
        "elements": ELEMENTS,
        "lights": [{"name": "lamp", "light_set": 1}],
        "instances": [
            leaf("wall"),
            leaf("leaf", element=2),
            leaf("leaf open", element=2, open_pose=True),
            leaf("crate", element=3),
        ],
    }
    (folder / "snapshot.json").write_text(json.dumps(data), encoding="utf-8")
    told = json.loads((Path(still.without_elements(folder)) / "snapshot.json").read_text(encoding="utf-8"))
    seen = {i["name"] for i in told["instances"] if i["visibility"]}
    assert (
        seen == {"wall", "leaf", "crate"} and "elements" not in told and "light_set" not in told["lights"][0]
    )
    bare = Path(still.without_open_poses(folder))
    assert (bare / "snapshot.bin").read_bytes() == b"arrays"
    told = json.loads((bare / "snapshot.json").read_text(encoding="utf-8"))
    assert [i["name"] for i in told["instances"] if not i["visibility"]] == ["leaf open"]


def test_pictures_are_readable_pngs():
    ramp = pictures.colours(np.array([[0.001, 0.01, 0.1, 1.0, 5.0]]))
    assert (ramp[0, 0] == ramp[0, 1]).all() and (ramp[0, 3] == ramp[0, 4]).all()
    file = pictures.png(ramp)
    assert file.startswith(b"\x89PNG") and zlib.crc32(file[12:29]) == int.from_bytes(file[29:33], "big")
