# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs tests/blender/bl_*.py, each in a Blender of its own with the packaged add-on enabled.

    python3 tests/blender/run.py --addon ZIP --work DIR [--junit FILE] [--timeout S] [NAME...]

Blender starts with factory settings, no user files but the unzipped add-on (module `ajar`), and
its Python exits with 1 on any exception: a script passes if it ends with exit code 0. A script
finds in its environment
    AJAR_ADDON_MODULE   name to import, `ajar`
    AJAR_TEST_DIR       an empty folder of its own
    AJAR_ROOT           the repository
A script that names `# timeout: SECONDS` in its first 20 lines gets that much time; one that names
`# window: WIDTHxHEIGHT` gets a Blender with its window, on a screen in memory of that size, and is
skipped where Xvfb or xdotool is missing. Exit code 77 skips. The output of each script is kept in
DIR/NAME.log.
"""
import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

from support import display

FOLDER = Path(__file__).resolve().parent
MODULE = "ajar"
SKIPPED = 77
TAIL_LINES = 60


def install(archive, work):
    """Unzips the add-on as a user add-on; returns the folder for BLENDER_USER_SCRIPTS."""
    scripts = work / "user" / "scripts"
    shutil.rmtree(work / "user", ignore_errors=True)
    (scripts / "addons").mkdir(parents=True)
    with zipfile.ZipFile(archive) as content:
        content.extractall(scripts / "addons")
    return scripts


def environment(work, scripts, own_folder):
    variables = {key: value for key, value in os.environ.items() if key != "AJAR_LIBRARY"}
    variables.update(
        BLENDER_USER_SCRIPTS=str(scripts),
        BLENDER_USER_CONFIG=str(work / "user" / "config"),
        AJAR_ADDON_MODULE=MODULE,
        AJAR_TEST_DIR=str(own_folder),
        AJAR_ROOT=str(FOLDER.parent.parent),
    )
    return variables


def named_in_head(script, pattern):
    """Match of a line in the first lines of a script, or None."""
    head = "\n".join(script.read_text(encoding="utf-8").splitlines()[:20])
    return re.search(pattern, head, re.MULTILINE)


def time_allowed(script, default):
    named = named_in_head(script, r"^# timeout: (\d+)")
    return int(named[1]) if named else default


def run_script(script, work, scripts, default_timeout):
    """(exit code or None if time ran out, output) of one script."""
    own_folder = work / script.stem
    shutil.rmtree(own_folder, ignore_errors=True)
    own_folder.mkdir(parents=True)
    log = work / f"{script.stem}.log"
    variables = environment(work, scripts, own_folder)
    allowed = time_allowed(script, default_timeout)
    size = named_in_head(script, r"^# window: (\d+)x(\d+)")
    if size is None:
        code = run_blender(["-b"], script, variables, log, allowed)
    elif display.missing():
        return SKIPPED, display.missing()
    else:
        with display.display(own_folder, size.groups()) as screen:
            arguments = display.blender_arguments(size.groups())
            code = run_blender(arguments, script, {**variables, **screen}, log, allowed)
    return code, log.read_text(encoding="utf-8", errors="replace")


def run_blender(arguments, script, variables, log, allowed):
    """Exit code of Blender with a script, None if it took more than the seconds allowed."""
    command = ["blender", *arguments, "--factory-startup", "-noaudio", "--addons", MODULE]
    command += ["--python-exit-code", "1", "-P", str(script)]
    with open(log, "wb") as output:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env=variables,
            cwd=variables["AJAR_TEST_DIR"],
        )
        try:
            return process.wait(allowed)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return None


def failure_of(code, output):
    """Why a script failed, or ''."""
    if code is None:
        return "ran out of time"
    if code < 0:
        return f"ended by signal {-code}"
    if code not in (0, SKIPPED):
        return f"exit code {code}"
    if f"No module named '{MODULE}'" in output or f'Add-on not loaded: "{MODULE}"' in output:
        return "the packaged add-on could not be enabled"
    return ""


def record(suite, name, seconds, code, reason, output):
    case = ElementTree.SubElement(suite, "testcase", classname="blender", name=name, time=f"{seconds:.2f}")
    if reason:
        printable = "".join(c for c in output if c.isprintable() or c == "\n")
        ElementTree.SubElement(case, "failure", message=reason).text = printable[-4000:]
    elif code == SKIPPED:
        ElementTree.SubElement(case, "skipped", message=last_line(output))


def last_line(output):
    """What a script said last: why it skips."""
    return output.strip().rpartition("\n")[2]


def main():
    parser = argparse.ArgumentParser(description="Run the Blender tests")
    parser.add_argument("names", nargs="*", metavar="NAME", help="e.g. bl_bake; default: all")
    parser.add_argument("--addon", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--junit", type=Path)
    parser.add_argument("--timeout", type=int, default=300)
    options = parser.parse_args()
    work = options.work.resolve()
    scripts = install(options.addon, work)
    suite = ElementTree.Element("testsuite", name="blender")
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for script in sorted(FOLDER.glob("bl_*.py")):
        if options.names and script.stem not in options.names:
            continue
        start = time.monotonic()
        code, output = run_script(script, work, scripts, options.timeout)
        seconds = time.monotonic() - start
        reason = failure_of(code, output)
        result = "failed" if reason else "skipped" if code == SKIPPED else "passed"
        counts[result] += 1
        record(suite, script.stem, seconds, code, reason, output)
        why = last_line(output) if code == SKIPPED else reason
        print(f"{result:8}{script.stem} ({seconds:.1f} s){': ' + why if why else ''}", flush=True)
        if reason:
            print("\n".join("    " + line for line in output.splitlines()[-TAIL_LINES:]), flush=True)
    if options.junit:
        ElementTree.ElementTree(suite).write(options.junit, encoding="utf-8", xml_declaration=True)
    print(", ".join(f"{number} {result}" for result, number in counts.items()))
    return 1 if counts["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
