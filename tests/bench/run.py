# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure speed; `./dev bench` runs this after a build.

    ./dev bench [--level FILE.blend [--density 8] | --package DIR] [--filter REGEX] [--repeats 5] [--threads N]

Prints a table and writes build/bench/bench.json. A ratio compares two things measured in turn in one run, so
it holds on a busy machine; the rest are medians over the repeats. Parts are measured on one thread, whole bakes
on --threads. With --level the scene is the level instead of the built-in room. With --package, what changes of
weights cost a game that loaded it, on one thread.
"""
import argparse
import datetime
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = ROOT / "tests" / "bench"
OUT = ROOT / "build" / "bench"
BUILD = ROOT / "build" / "release"
TARGET = 0.6  # of Embree's own speed, for the gather


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="./dev bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--level', type=Path, help="measure on this .blend")
    parser.add_argument('--package', type=Path, help="measure the run time on this package")
    parser.add_argument('--density', type=float, default=8, help="texels per metre of the level")
    parser.add_argument('--filter', default='.', help="only benchmarks whose suite/case/size matches")
    parser.add_argument('--repeats', type=int, default=5)
    parser.add_argument('--threads', type=int, default=0, help="of whole bakes; 0: all")
    return parser.parse_args(arguments)


def save_snapshot(level, density):
    """Export a level; returns the snapshot's folder."""
    folder = OUT / level.stem
    folder.mkdir(parents=True, exist_ok=True)
    command = [
        "blender",
        "-b",
        str(level),
        "-noaudio",
        "--python-exit-code",
        "1",
        "-P",
        str(HERE / "save_snapshot.py"),
        "--",
        "--out",
        str(folder),
        "--density",
        str(density),
    ]
    with open(folder / "export.log", 'w', encoding='utf-8') as log:
        if subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode != 0:
            sys.exit(f"bench: {level} could not be exported, see {folder / 'export.log'}")
    return folder / "snapshot"


def measure(command, flags):
    """Run a benchmark program; returns (its JSON, peak memory in bytes)."""
    result = OUT / "google_benchmark.json"
    result.unlink(missing_ok=True)
    process = subprocess.Popen(
        [*map(str, command), *flags, f"--benchmark_out={result}", "--benchmark_out_format=json"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    errors = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0 or not result.is_file():
        sys.exit(f"bench: {command[0]} failed\n{errors}")
    return json.loads(result.read_text(encoding='utf-8')), usage.ru_maxrss * 1024


def medians(report):
    """One entry per benchmark; a failed one ends the program."""
    entries = []
    for row in report["benchmarks"]:
        if row.get("error_occurred"):
            sys.exit(f"bench: {row['name']}: {row['error_message']}")
        if row.get("aggregate_name") == "median":
            entries.append(entry(row))
    return entries


def entry(row):
    """A row of Google Benchmark as we store it, in plain units."""
    name = "/".join(part for part in row["run_name"].split("/")[:3])
    scale = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[row["time_unit"]]
    result = {"name": name, "seconds": row["real_time"] * scale}
    for key in (
        "rays_per_second",
        "embree_rays_per_second",
        "ratio",
        "further_rays",
        "digest",
        "error",
        "items_per_second",
        "texels",
    ):
        if key in row:
            result[key] = row[key]
    if "items_per_second" in row:
        result["ns_per_item"] = 1e9 / row["items_per_second"]
    return result


def describe(entries):
    """Lines of the table."""
    for e in entries:
        if "ratio" in e:
            yield (
                f"{e['name']:36} {e['rays_per_second'] / 1e6:8.2f} Mrays/s   {e['ratio']:.2f} of Embree's "
                f"{e['embree_rays_per_second'] / 1e6:.2f} (aim {TARGET})"
            )
        elif "rays_per_second" in e:
            yield f"{e['name']:36} {e['rays_per_second'] / 1e6:8.2f} Mrays/s   {e['seconds']:.2f} s, {e['texels']:.0f} texels"
        elif "error" in e:
            yield f"{e['name']:36} {e['seconds'] * 1e3:8.1f} ms   relative error {e['error']:.3f}"
        elif e['name'].startswith("runtime/"):
            yield f"{e['name']:36} {e['seconds'] * 1e3:8.3f} ms   {e['ns_per_item']:.2f} ns each"
        else:
            yield f"{e['name']:36} {e['ns_per_item']:8.1f} ns each"


def compare_doors(entries):
    """What aiming at doors gains at equal time: error falls with the square root of time."""
    both = {e['name'].split("/")[-1]: e for e in entries if e['name'].startswith("doors/")}
    if len(both) == 2:
        plain, aimed = (both[name]['error'] * both[name]['seconds'] ** 0.5 for name in ("unguided", "guided"))
        yield f"{'doors: error at equal time':36} {plain / aimed:8.1f} times lower with guiding (aim 5)"


def git_state():
    """(commit, whether files differ from it)."""
    run = lambda *arguments: subprocess.run(
        ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True
    )  # noqa: E731
    return run("rev-parse", "HEAD").stdout.strip() or None, bool(run("status", "--porcelain").stdout.strip())


def cpu_name():
    for line in Path("/proc/cpuinfo").read_text(encoding='utf-8').splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return None


def context(threads):
    """What the numbers depend on."""
    commit, changed = git_state()
    cores = len(os.sched_getaffinity(0))
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "git": commit,
        "changed": changed,
        "cpu": cpu_name(),
        "cores": cores,
        "threads": threads or cores,
        "load": os.getloadavg()[0],
    }


def main(arguments):
    args = parse(arguments)
    OUT.mkdir(parents=True, exist_ok=True)
    program = [BUILD / "bin" / "ajar_bench"]
    if args.level:
        program = [
            sys.executable,
            HERE / "bench_level.py",
            BUILD / "lib" / "libajar_bench.so",
            save_snapshot(args.level, args.density),
            args.level.stem,
        ]
    if args.package:
        package = args.package.resolve()
        program = [BUILD / "bin" / "ajar_runtime_bench", package, package.parent.name]
    about = context(args.threads)
    report, peak = measure(
        program,
        [
            *([] if args.package else [f"--threads={args.threads}"]),
            f"--benchmark_filter={args.filter}",
            f"--benchmark_repetitions={max(args.repeats, 2)}",
            "--benchmark_min_time=0.2",
        ],
    )
    entries = medians(report)
    for line in (*describe(entries), *compare_doors(entries)):
        print(line)
    print(f"{'peak memory':36} {peak / 1e6:8.0f} MB")
    file = OUT / "bench.json"
    file.write_text(
        json.dumps({**about, "peak_memory_bytes": peak, "results": entries}, indent=1) + "\n",
        encoding='utf-8',
    )
    print(f"written to {file}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
