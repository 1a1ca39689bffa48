# SPDX-License-Identifier: GPL-3.0-or-later
"""Does base plus terms equal the bake of a state? For random states of a scene.

    blender -b SCENE.blend -P tests/bench/save_snapshot.py -- --out DIR --density 4
    python3 tests/property/random_states.py LIBRARY DIR/snapshot [--states 50] [--combinations ALL]
            [--samples 1024] [--seed 1] [--out FILE.json]

Bakes the scene once with its light sets, doors and toggles, then each state as a plain scene: lamps and
emission scaled by the weights of their sets, doors open or closed, toggles there or gone. Prints for each
state the ratio of the mean irradiance over all texels that are valid in both, the root mean square of the
difference over the mean, and what noise alone would give.
"""
import argparse
import copy
import ctypes
import json
import os
import random
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from blender_addon.accuracy import engine  # noqa: E402
from blender_addon.bridge import abi  # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
LAYER_STDERR = 1
COMBINATIONS = {"NONE": 0, "AUTO": 1, "ALL": 2}


def parse():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('library')
    parser.add_argument('snapshot', type=Path)
    parser.add_argument('--states', type=int, default=50)
    parser.add_argument('--combinations', choices=COMBINATIONS, default="ALL")
    parser.add_argument('--samples', type=int, default=1024)
    parser.add_argument('--seed', type=int, default=1, help="of the states")
    parser.add_argument('--out', type=Path, help="also write the figures as JSON")
    return parser.parse_args()


def random_state(elements, dice):
    """Weight of each element: sets 0..2, some of them off; doors and toggles 0 or 1."""
    draw = (
        lambda e: dice.choice((0.0, dice.uniform(0.1, 2.0)))
        if e["kind"] == "light_set"
        else float(dice.random() < 0.5)
    )  # noqa: E731
    return [draw(e) for e in elements]


def is_there(instance, elements, state):
    """Whether an instance belongs to the scene in a state: the closed pose of a door while it is closed."""
    element = instance.get("element")
    if element is None:
        return True
    if elements[element]["kind"] == "door":
        return bool(instance.get("open_pose")) == (state[element] > 0.5)
    return state[element] > 0.5


def dim(material, weight):
    """A copy of a material with its emission scaled."""
    result = copy.deepcopy(material)
    for closure in result["closures"]:
        if closure["type"] == "emission":
            closure["strength"]["value"] = [weight * v for v in closure["strength"]["value"]]
    return result


def freeze(scene, state):
    """The snapshot of a state, without elements."""
    plain = copy.deepcopy(scene)
    elements, plain["elements"] = scene["elements"], []
    plain["instances"] = [i for i in plain["instances"] if is_there(i, elements, state)]
    for instance in plain["instances"]:
        for key in ("element", "open_pose"):
            instance.pop(key, None)
        light_set = instance.pop("light_set", None)
        if light_set is not None:
            for slot, material in enumerate(instance["materials"]):
                plain["materials"].append(dim(scene["materials"][material], state[light_set]))
                instance["materials"][slot] = len(plain["materials"]) - 1
    for light in plain["lights"]:
        light_set = light.pop("light_set", None)
        if light_set is not None:
            light["energy"] *= state[light_set]
    return plain


def pages(bake, layer):
    """A layer of all pages as rows of texels."""
    return np.concatenate(
        [(lambda v: v.reshape(-1, v.shape[-1]))(bake.layer(p, layer)) for p in range(len(bake.pages))]
    )


def read_terms(library, bake):
    """[(element ids, luminance of all texels)]"""
    count = ctypes.c_uint32()
    engine.check(library, library.ajar_job_term_count(bake._job, ctypes.byref(count)))
    terms = []
    for number in range(count.value):
        info = abi.TermInfo()
        library.ajar_term_info_init(ctypes.byref(info))
        engine.check(library, library.ajar_job_term(bake._job, number, ctypes.byref(info)))
        light = []
        for index, page in enumerate(bake.pages):
            values = np.empty((page["height"] * page["width"], 3), np.float32)
            pointer = values.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
            engine.check(library, library.ajar_job_read_term(bake._job, number, index, pointer, values.size))
            light.append(values @ LUMINANCE)
        terms.append((list(info.elements[: info.element_count]), np.concatenate(light)))
    return terms


def bake_state(library, folder, scene, state, settings):
    """(luminance, standard error, valid) of a state's own bake."""
    with tempfile.TemporaryDirectory() as path:
        shutil.copy(folder / "snapshot.bin", path)
        (Path(path) / "snapshot.json").write_text(json.dumps(freeze(scene, state)), encoding='utf-8')
        with engine.Bake(library, path, **settings) as bake:
            valid = pages(bake, engine.LAYER_VALIDITY)[:, 0] == 1.0
            return pages(bake, engine.LAYER_IRRADIANCE) @ LUMINANCE, pages(bake, LAYER_STDERR)[:, 0], valid


def compare(light, truth, error, valid):
    """Figures of one state."""
    mean = truth[valid].mean()
    difference = (light - truth)[valid]
    return {
        'ratio': float(light[valid].mean() / mean),
        'rms': float(np.sqrt(np.mean(difference**2)) / mean),
        'noise': float(np.sqrt(2.0 * np.mean(error[valid] ** 2)) / mean),
    }


def main():
    args = parse()
    library = engine.load_library(args.library)
    scene = json.loads((args.snapshot / "snapshot.json").read_text(encoding='utf-8'))
    settings = {
        'noise_target': 0.0, 'samples': args.samples, 'direct_samples': args.samples // 4, 'stitch_seams': False,
        'bounce_samples': 256, 'combinations': COMBINATIONS[args.combinations], 'time_limit': 0.0,
    }  # fmt: skip
    with engine.Bake(library, args.snapshot, **settings) as bake:
        terms, valid = read_terms(library, bake), pages(bake, engine.LAYER_VALIDITY)[:, 0] == 1.0
        print(f"{len(terms)} terms in {bake.seconds:.1f} s", flush=True)
    dice, results = random.Random(args.seed), []
    for number in range(args.states):
        state = random_state(scene["elements"], dice)
        light = sum(values * np.prod([state[e] for e in ids]) for ids, values in terms)
        truth, error, there = bake_state(
            library, args.snapshot, scene, state, {**settings, 'seed': 1000 + number}
        )
        results.append({'state': state, **compare(light, truth, error, valid & there)})
        print(
            "state {}: ratio {ratio:.4f}, rms {rms:.4f}, noise {noise:.4f}".format(number, **results[-1]),
            flush=True,
        )
    ratios = np.array([r['ratio'] for r in results])
    print(f"mean error {abs(ratios.mean() - 1):.4%}, worst state {abs(ratios - 1).max():.4%}")
    if args.out:
        args.out.write_text(json.dumps(results, indent=1) + "\n", encoding='utf-8')


if __name__ == "__main__":
    main()
