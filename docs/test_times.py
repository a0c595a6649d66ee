#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Prints a table of the time spent in deploy/test.sh, from the results that its run left in the build folder."""

import argparse
import collections
import json
import subprocess
import sys
import xml.etree.ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, default=ROOT / "build/release", help="the build folder")
    parser.add_argument("--groups", type=int, default=20, help="how many of the slowest are listed")
    options = parser.parse_args()
    results = options.build / "test-results.xml"
    if not results.is_file():
        print(f"{results}: no such file; expected the results of a test run. Remedy: deploy/test.sh", file=sys.stderr)
        return 1
    listed = json.loads(subprocess.run(["ctest", "--show-only=json-v1"], cwd=options.build, check=True,
                                       capture_output=True).stdout)["tests"]
    alone = {test["name"] for test in listed
             if any(p["name"] == "RUN_SERIAL" and p["value"] for p in test.get("properties", ()))}
    seconds, count = collections.Counter(), collections.Counter()
    for case in xml.etree.ElementTree.parse(results).getroot().iter("testcase"):
        group = (case.get("name").split(".")[0], case.get("name") in alone)
        seconds[group] += float(case.get("time"))
        count[group] += 1
    print("| tests | number | seconds | one at a time |\n|---|---|---|---|")
    for group, time in seconds.most_common(options.groups):
        name, is_alone = group
        print(f"| `{name}` | {count[group]} | {time:.0f} | {'yes' if is_alone else ''} |")
    for words, is_alone in (("all that run alone", True), ("all that run in parallel", False)):
        groups = [group for group in seconds if group[1] == is_alone]
        print(f"| {words} | {sum(count[g] for g in groups)} | {sum(seconds[g] for g in groups):.0f} "
              f"| {'yes' if is_alone else ''} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
