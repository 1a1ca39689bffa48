# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes a .blend without a user interface:

    blender -b FILE.blend --python-exit-code 1 -P blender_addon/batch.py -- --preset preview --out DIR

Leaves DIR/<name>.blend (the input with its lightmap UVs and the preview), DIR/package and
DIR/report.json. The input file is not changed. Exit codes: 0 done, 1 error, 2 cancelled.
"""
import argparse
import importlib.util
import os
import signal
import sys
import time

import bpy

NAME = "ajar"
FOLDER = os.path.dirname(os.path.abspath(__file__))
DONE, FAILED, CANCELLED = 0, 1, 2
PRESETS = ("draft", "preview", "production", "reference")
COMBINATIONS = ("none", "auto", "all")
LIGHT_PATCHES = ("none", "mono", "rgb")


class BatchError(Exception):
    """A batch that cannot run; the text says what to do."""


class _Parser(argparse.ArgumentParser):
    """argparse would exit with 2, which means cancelled here."""

    def error(self, message):
        raise BatchError(f"{message}. {self.format_usage().strip()}")


def parse(arguments):
    """The command line after '--' as a namespace; BatchError if it is wrong."""
    parser = _Parser(prog="batch.py --", description="Bake the lightmaps of a .blend")
    parser.add_argument("--preset", choices=PRESETS, type=str.lower, help="quality; default: the scene's")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder of the results")
    parser.add_argument("--density", type=_positive, metavar="N", help="texels per metre")
    parser.add_argument("--samples", type=_count, metavar="N", help="exactly N final gather rays per texel")
    parser.add_argument(
        "--noise", type=_positive, metavar="X", help="relative standard error that 95%% of the texels keep"
    )
    parser.add_argument("--bounces", type=_count_or_none, metavar="N", help="diffuse bounces")
    parser.add_argument("--time-limit", type=_positive, metavar="S", help="seconds for the whole bake")
    parser.add_argument("--threads", type=_count_or_none, metavar="N", help="worker threads, 0 for all")
    parser.add_argument("--seed", type=_count_or_none, metavar="N", help="seed of the random numbers")
    parser.add_argument(
        "--combinations", choices=COMBINATIONS, type=str.lower, help="products of elements to bake"
    )
    parser.add_argument(
        "--light-patches",
        choices=LIGHT_PATCHES,
        type=str.lower,
        help="plain textures to blend, beside terms.bin",
    )
    parser.add_argument(
        "--keep-uvs", action="store_true", help="keep the charts of existing AjarLightmap layers"
    )
    parser.add_argument("--no-preview", action="store_true", help="save the .blend without the preview")
    parser.add_argument(
        "--overlap-pictures", action="store_true", help="also store pictures of terms and bytes per texel"
    )
    parser.add_argument("--predict", action="store_true", help="only say how long each preset would take")
    parser.add_argument("--layout-only", action="store_true", help="only unwrap and pack, do not bake")
    return parser.parse_args(arguments)


def _positive(text):
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def _count(text):
    if int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} is not at least 1")
    return int(text)


def _count_or_none(text):
    if int(text) < 0:
        raise argparse.ArgumentTypeError(f"{text} is negative")
    return int(text)


def load_addon():
    """The add-on in this folder, registered. An installed copy steps aside for this process."""
    import addon_utils

    enabled = [name for name, module in sys.modules.items() if getattr(module, "__addon_enabled__", False)]
    for name in enabled:
        if name.split(".")[-1] == NAME:
            addon_utils.disable(name)
            for part in [part for part in sys.modules if part == name or part.startswith(name + ".")]:
                del sys.modules[part]
    place = os.path.join(FOLDER, "__init__.py")
    spec = importlib.util.spec_from_file_location(NAME, place, submodule_search_locations=[FOLDER])
    module = importlib.util.module_from_spec(spec)
    sys.modules[NAME] = module
    spec.loader.exec_module(module)
    module.register()


def overrides(options):
    """Settings that the command line changes, by engine name."""
    values = {
        "preset": options.preset.upper() if options.preset else None,
        "samples": options.samples,
        "noise_target": options.noise,
        "bounces": options.bounces,
        "time_limit": options.time_limit,
        "threads": options.threads,
        "seed": options.seed,
        "texels_per_meter": options.density,
        "combinations": options.combinations.upper() if options.combinations else None,
        "light_patches": options.light_patches.upper() if options.light_patches else None,
        "overlap_pictures": options.overlap_pictures or None,
    }
    return {name: value for name, value in values.items() if value is not None}


class Printer:
    """Prints a line when the stage changes, and every other second while the percentage moves."""

    def __init__(self):
        self._line, self._time, self._warned = None, 0.0, 0

    def show(self, status):
        """Prints progress and new warnings."""
        for culprit, text in status.warnings[self._warned :]:
            print(f"ajar: warning: {culprit}: {text}" if culprit else f"ajar: warning: {text}", flush=True)
        self._warned = len(status.warnings)
        line = (status.stage, int(100 * status.fraction))
        now = time.monotonic()
        if line == self._line or (now - self._time < 2.0 and line[0] == (self._line or [None])[0]):
            return
        self._line, self._time = line, now
        remaining = f", {status.remaining:.0f} s left" if status.remaining >= 0.0 else ""
        print(f"ajar: {status.stage}: {line[1]}%{remaining}", flush=True)


def prepare_output(folder, name):
    """Makes the output folder; returns the path of the .blend in it."""
    try:
        os.makedirs(folder, exist_ok=True)
        probe = os.path.join(folder, f".ajar-{os.getpid()}")
        with open(probe, "w", encoding="ascii"):
            pass
        os.remove(probe)
    except OSError as error:
        raise BatchError(f"cannot write to {folder} ({error.strerror}): choose another --out") from error
    target = os.path.join(folder, name)
    if os.path.exists(target) and os.path.samefile(target, bpy.data.filepath):
        raise BatchError(f"the result would replace the input {target}: choose another --out")
    return target


def save(target, record, package, report):
    """Saves a copy whose relative paths hold from its own place. The input is not touched."""
    scene = bpy.context.scene
    known = record.read_record(scene)
    if known:
        known["package"], known["report"] = f"//{package}", f"//{report}"
        record.write_record(scene, known)
    paths = bpy.context.preferences.filepaths
    versions, paths.save_version = paths.save_version, 0
    try:
        bpy.ops.wm.save_as_mainfile(filepath=target, check_existing=False, relative_remap=True, copy=True)
    finally:
        paths.save_version = versions


def run(options):
    """Bakes the open file; returns the exit code."""
    from ajar import checks, job, predict_job, settings

    if not bpy.data.is_saved:
        raise BatchError("no .blend is open: blender -b FILE.blend -P batch.py -- --out DIR")
    folder = os.path.abspath(options.out)
    target = prepare_output(folder, os.path.basename(bpy.data.filepath))
    context = bpy.context
    findings = checks.check_scene(context, output=False) + checks.check_folder(folder, context.scene)
    problems = checks.errors(findings)
    if problems:
        raise BatchError("\n".join(map(str, problems)))
    for finding in findings:
        print(f"ajar: warning: {finding}", flush=True)
    keep = options.keep_uvs or context.scene.ajar.keep_uvs
    if options.predict:
        task = job.Job("Prediction", context, predict_job.predict_steps, overrides=overrides(options))
    elif options.layout_only:
        task = job.Job(
            "Lightmap UVs", context, job.layout_steps, keep_existing=keep, overrides=overrides(options)
        )
    else:
        task = job.Job(
            "Bake",
            context,
            job.bake_steps,
            package=os.path.join(folder, settings.PACKAGE),
            report=os.path.join(folder, settings.REPORT),
            keep_existing=keep,
            overrides=overrides(options),
            show=not options.no_preview,
        )
    signal.signal(signal.SIGTERM, lambda *_: job.manager.cancel())
    signal.signal(signal.SIGINT, lambda *_: job.manager.cancel())
    return finish(task, None if options.predict else target)


def finish(task, target):
    """Runs the job to its end and saves the result, or says it if there is no target; returns the exit code."""
    from ajar import settings
    from ajar.apply import record
    from ajar.job import manager

    printer = Printer()
    manager.start(task)
    while manager.step():
        printer.show(task.status)
        time.sleep(0.05)
    printer.show(task.status)
    if task.status.result == "cancelled":
        print("ajar: cancelled", flush=True)
        return CANCELLED
    if task.status.result != "done":
        raise BatchError(task.status.message)
    if target is None:
        print(f"ajar: {task.status.message}", flush=True)
        print_plan(manager.predicted)
        return DONE
    save(target, record, settings.PACKAGE, settings.REPORT)
    print(f"ajar: done: {target}", flush=True)
    return DONE


def print_plan(found):
    """What the bake would do, after a prediction."""
    if found is None:
        return
    for preset, plan in ((name, found.plan(name)) for name in found.seconds):
        print(f"ajar: {preset.capitalize()} would simulate", flush=True)
        for line in plan:
            print(f"ajar:   {line}", flush=True)


def main():
    """Entry point of the script."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    try:
        options = parse(arguments)
        load_addon()
        code = run(options)
    except BatchError as error:
        print(f"ajar: error: {error}", file=sys.stderr, flush=True)
        code = FAILED
    except Exception:  # Blender would print it and go on
        import traceback

        traceback.print_exc()
        code = FAILED
    sys.stdout.flush()
    sys.exit(code)


if __name__ == "__main__":
    main()
