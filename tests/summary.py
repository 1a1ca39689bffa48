# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds up JUnit files and prints the last line of `./dev test`: N passed, N failed.

    python3 tests/summary.py PARTS_FAILED FOLDER

Exit code 1 if a test failed, a part of the run failed as a whole, or nothing ran.
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def outcome(case):
    """'passed', 'failed' or 'skipped' for one <testcase>."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    status = case.get("status", "run")  # ctest: run, fail, notrun, disabled
    if status == "fail":
        return "failed"
    if case.find("skipped") is not None or status in ("notrun", "disabled"):
        return "skipped"
    return "passed"


def count(folder):
    """Totals by outcome, and the names of what failed."""
    totals, failed = {"passed": 0, "failed": 0, "skipped": 0}, []
    for path in sorted(Path(folder).glob("*.xml")):
        for case in ElementTree.parse(path).iter("testcase"):
            result = outcome(case)
            totals[result] += 1
            if result == "failed":
                failed.append(f"{path.stem}: {case.get('classname', '')} {case.get('name')}")
    return totals, failed


def main(parts_failed, folder):
    totals, failed = count(folder)
    print()
    for name in failed:
        print(f"FAILED {name}")
    if parts_failed and not failed:
        print("FAILED a part of the run ended with an error before its tests, see above")
    total_failed = totals["failed"] or int(parts_failed)
    skipped = f", {totals['skipped']} skipped" if totals["skipped"] else ""
    print(f"{totals['passed']} passed, {total_failed} failed{skipped}")
    return 0 if totals["passed"] and not total_failed else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2]))
