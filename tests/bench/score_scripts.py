#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Runs the shipped scripts, and prints the grades that the shipped score gives them (CSV).

Usage: ETI_BIN=FOLDER score_scripts.py
"""

import csv
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "system"))
import operator_run  # noqa: E402
import support  # noqa: E402


def run(name):
    return subprocess.run([sys.executable, "-B", operator_run.__file__, name], stdout=subprocess.DEVNULL, check=True)


def main():
    names = list(operator_run.RUNS)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(run, names))
    done = subprocess.run([support.BIN / "eti-review", "score", "apply", *map(operator_run.recording, names), "--json"],
                          stdout=subprocess.PIPE, check=True)
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(("script", "intubated", "grade"))
    for name, score in zip(names, json.loads(done.stdout)):
        table.writerow((name, int(score["success"]), f"{score['grade']:.2f}"))


if __name__ == "__main__":
    main()
