# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a .blend with Ajar and with Cycles on the same lightmap UVs and compare.

    python3 tests/blender/bake_agreement.py LEVEL.blend --out DIR [--density 2] [--bounces 4]
            [--preset reference] [--ajar-samples 4096] [--samples 8192] [--fraction 0.1]
            [--keep-materials] [--keep-roles] [--reuse-reference] [further options of compare_bake.py]

Works on a copy with plain diffuse materials and static lamps unless told to keep them; lamps that
stay primary are compared by their bounced light alone. Logs and results are left in DIR.
"""
import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from support import run  # noqa: E402


def parse():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('blend')
    parser.add_argument('--out', required=True)
    parser.add_argument('--density', default=2)
    parser.add_argument('--bounces', default=4)
    parser.add_argument('--preset', default='reference')
    parser.add_argument('--ajar-samples', default=4096)
    parser.add_argument('--samples', default=8192)
    parser.add_argument('--repeats', default=8)
    parser.add_argument('--fraction', default=0.1)
    parser.add_argument('--keep-materials', action='store_true')
    parser.add_argument('--keep-roles', action='store_true')
    parser.add_argument(
        '--reuse-reference', action='store_true', help="only if the lightmap UVs are the same"
    )
    return parser.parse_known_args()


def prepare(args, folder, log):
    """Copy of the input made for the comparison."""
    path = os.path.join(folder, os.path.basename(args.blend))
    flags = [
        flag for flag in ('--keep-materials', '--keep-roles') if getattr(args, flag[2:].replace('-', '_'))
    ]
    run.script("prepare_strict.py", os.path.abspath(args.blend), ['--out', path, *flags], log)
    return path


def bake_reference(args, blend, package, reference, log):
    """Bake with Cycles."""
    roles = ['--without-direct', 'PRIMARY'] if args.keep_roles else []
    run.script(
        "cycles_bake.py",
        blend,
        [
            '--package',
            package,
            '--out',
            reference,
            '--samples',
            args.samples,
            '--repeats',
            args.repeats,
            '--bounces',
            args.bounces,
            '--fraction',
            args.fraction,
            *roles,
        ],
        log,
    )


def main():
    args, more = parse()
    folder = os.path.abspath(args.out)
    os.makedirs(os.path.join(folder, "ajar"), exist_ok=True)
    log, reference = os.path.join(folder, "log.txt"), os.path.join(folder, "reference.npz")
    blend, package = run.bake(
        prepare(args, folder, log),
        os.path.join(folder, "ajar"),
        ['--density', args.density, '--bounces', args.bounces, '--samples', args.ajar_samples],
        log,
        args.preset,
    )
    if not (args.reuse_reference and os.path.exists(reference)):
        bake_reference(args, blend, package, reference, log)
    return subprocess.run(
        [
            sys.executable,
            os.path.join(HERE, "compare_bake.py"),
            '--package',
            package,
            '--reference',
            reference,
            '--out',
            folder,
            '--report',
            os.path.join(folder, "ajar", "report.json"),
            *more,
        ],
        check=False,
    ).returncode


if __name__ == "__main__":
    sys.exit(main())
