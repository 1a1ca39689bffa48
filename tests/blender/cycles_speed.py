# SPDX-License-Identifier: GPL-3.0-or-later
"""How much faster than Cycles does Ajar bake the same texels to the same error?

    python3 tests/blender/cycles_speed.py LEVEL.blend --out DIR [--density 4] [--error 0.1] [--bounces 4]
            [--samples 64] [--first-cap 256]

Both bake every lightmap texel of a copy with plain diffuse materials and static lamps. The error is the
root mean square over valid texels of the difference of two seeds, over sqrt(2) and over the texel's own
light plus a hundredth of the mean. Ajar's cap of rays is doubled until that is at most --error. Cycles is
timed at two sample counts, which parts the fixed cost of a bake from that of its samples. Both times are
scaled to --error by the law that the error falls with the square root of the rays. Times are those of the
bakes alone, without Blender's start and the reading of the scene. Writes DIR/speed.json.
"""
import argparse
import json
import math
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import exr, run  # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
NOISE = 0.12  # target of 95 % of the texels, of the preview preset


def parse():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('blend')
    parser.add_argument('--out', required=True)
    parser.add_argument('--density', type=float, default=4)
    parser.add_argument('--error', type=float, default=0.1)
    parser.add_argument('--bounces', type=int, default=4)
    parser.add_argument('--samples', type=int, default=64)
    parser.add_argument('--first-cap', type=int, default=256, help="rays per texel")
    return parser.parse_args()


def relative_error(first, second, valid):
    """Root mean square relative error of one bake, from two bakes (lists of pages, RGB)."""
    a = np.concatenate([(p @ LUMINANCE)[v] for p, v in zip(first, valid)])
    b = np.concatenate([(p @ LUMINANCE)[v] for p, v in zip(second, valid)])
    level = 0.5 * (a + b) + 0.01 * np.mean(0.5 * (a + b))
    return float(np.sqrt(np.mean(np.square((a - b) / level)) / 2))


def read_pages(package):
    """(irradiance, valid) of each page."""
    with open(os.path.join(package, "manifest.json"), encoding='utf-8') as file:
        pages = json.load(file)['pages']
    light = [exr.read_rgb(os.path.join(package, p['irradiance'])).astype(np.float64) for p in pages]
    return light, [exr.read_exr(os.path.join(package, p['quality']))['validity'] > 0.99 for p in pages]


def bake_ajar(args, blend, cap, seed, log):
    """(result .blend, package, seconds)"""
    out = os.path.join(os.path.abspath(args.out), f"ajar{seed}")
    flags = [
        '--density', args.density, '--bounces', args.bounces, '--noise', NOISE, '--seed', seed,
        '--samples', cap,
    ]  # fmt: skip
    result, package = run.bake(blend, out, flags, log, 'preview')
    with open(os.path.join(out, "report.json"), encoding='utf-8') as file:
        return result, package, json.load(file)['seconds']['total']


def measure_ajar(args, blend, log):
    """Raises the cap until the error is reached."""
    cap = args.first_cap
    while True:
        runs = [bake_ajar(args, blend, cap, seed, log) for seed in (1, 2)]
        (first, valid), (second, _) = (read_pages(package) for _, package, _ in runs)
        error = relative_error(first, second, valid)
        seconds = 0.5 * (runs[0][2] + runs[1][2])
        print(f"ajar: at most {cap} rays, error {error:.4f}, {seconds:.1f} s", flush=True)
        if error <= args.error:
            needed = seconds * (error / args.error) ** 2
            found = {'cap': cap, 'error': error, 'seconds': seconds, 'seconds_needed': needed}
            return found, runs[0][0], runs[0][1], valid
        cap *= 2


def bake_cycles(args, blend, package, samples, seed, log):
    """(pages, seconds) of one bake; two equal halves are what cycles_bake.py needs."""
    path = os.path.join(os.path.abspath(args.out), f"cycles{seed}.npz")
    flags = [
        '--package', package, '--out', path, '--samples', samples, '--repeats', 2,
        '--bounces', args.bounces, '--seed', seed,
    ]  # fmt: skip
    run.script("cycles_bake.py", blend, flags, log)
    with np.load(path) as data:
        meta = json.loads(str(data['meta']))
        pages = range(meta['pages'])
        return [data[f'{i}_mean'] for i in pages], [data[f'{i}_valid'] for i in pages], meta['seconds']


def measure_cycles(args, blend, package, valid, log):
    """Seconds that Cycles takes for the error."""
    few = max(2, args.samples // 8)
    _, _, short = bake_cycles(args, blend, package, few, 3, log)
    first, baked, long = bake_cycles(args, blend, package, args.samples, 1, log)
    second, _, _ = bake_cycles(args, blend, package, args.samples, 2, log)
    error = relative_error(first, second, [v & b for v, b in zip(valid, baked)])
    each = (long - short) / (args.samples - few)
    needed = args.samples * (error / args.error) ** 2
    fixed = max(0.0, long - each * args.samples) / 2  # of one bake, not two halves
    print(f"cycles: {args.samples} samples, error {error:.4f}, {long:.1f} s", flush=True)
    return {
        'samples': args.samples,
        'error': error,
        'seconds': long,
        'samples_needed': math.ceil(needed),
        'seconds_needed': fixed + each * needed,
    }


def main():
    args = parse()
    os.makedirs(args.out, exist_ok=True)
    log = os.path.join(os.path.abspath(args.out), "log.txt")
    copy = os.path.join(os.path.abspath(args.out), os.path.basename(args.blend))
    run.script("prepare_strict.py", os.path.abspath(args.blend), ['--out', copy], log)
    ajar, result, package, valid = measure_ajar(args, copy, log)
    cycles = measure_cycles(args, result, package, valid, log)
    speedup = cycles['seconds_needed'] / ajar['seconds_needed']
    with open(os.path.join(args.out, "speed.json"), 'w', encoding='utf-8') as file:
        json.dump({'error': args.error, 'ajar': ajar, 'cycles': cycles, 'speedup': speedup}, file, indent=1)
    print(
        f"cycles needs {cycles['seconds_needed']:.0f} s for an error of {args.error}: {speedup:.1f} times Ajar's time"
    )


if __name__ == "__main__":
    main()
