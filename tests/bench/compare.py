#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Compares the cost of two builds of the server in one run: the time of a step while the blade lifts.

Usage: compare.py BEFORE_BIN AFTER_BIN [--scenario NAME]... [--from STEP] [--to STEP] [--rounds N]

Each build runs its own scenarios and its own expert, as fast as it can, to both steps, alternating. A step's cost is
the difference of both runs over the number of steps in between. It is processor time on one thread, wall time on two.
Prints a table of milliseconds and ratios, each the median of the rounds: a machine that slows down for a minute changes
both costs of a round, but hardly their ratio. For an older revision:

    git worktree add ../before REVISION && cd ../before && cmake --preset release && cmake --build --preset release
"""

import argparse
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path


def run(binary, scenario, threads, steps):
    """Seconds for a run of that many steps: processor time and wall time."""
    begun = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run([binary, "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds", "--json",
                           "--threads", str(threads), "--steps", str(steps)], stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{binary} failed:\n{done.stderr}")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, time.monotonic() - begun


def compare(binaries, scenario, threads, first, last, rounds):
    """Milliseconds per step before and after, and their ratio."""
    clock = 0 if threads == 1 else 1
    costs = []
    for _ in range(rounds):
        short, long = ([run(binary, scenario, threads, steps)[clock] for binary in binaries] for steps in (first, last))
        costs.append([1e3 * (end - begin) / (last - first) for begin, end in zip(short, long)])
    before, after = (statistics.median(cost) for cost in zip(*costs))
    return before, after, statistics.median(cost[1] / cost[0] for cost in costs)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path, help="folder with the older eti-server")
    parser.add_argument("after", type=Path, help="folder with the newer one")
    parser.add_argument("--scenario", action="append", help="default: term and premature")
    parser.add_argument("--from", dest="first", type=int, default=1000, help="first measured step [1000]")
    parser.add_argument("--to", dest="last", type=int, default=1800, help="last measured step [1800]")
    parser.add_argument("--rounds", type=int, default=5, help="rounds, of which the median is reported [5]")
    wanted = parser.parse_args()
    if not 0 < wanted.first < wanted.last or wanted.rounds < 1:
        parser.error("--from has to be at least 1 and below --to, and --rounds at least 1")
    binaries = [folder / "eti-server" for folder in (wanted.before, wanted.after)]
    for binary in binaries:
        if not binary.is_file():
            parser.error(f"there is no {binary}: give the folder that a build put eti-server into")
    print("| scenario | threads | before [ms a step] | after [ms a step] | ratio |\n|---|---|---|---|---|", flush=True)
    for scenario in wanted.scenario or ["term", "premature"]:
        for threads in (1, 2):
            before, after, ratio = compare(binaries, scenario, threads, wanted.first, wanted.last, wanted.rounds)
            print(f"| {scenario} | {threads} | {before:.2f} | {after:.2f} | {ratio:.2f} |", flush=True)


if __name__ == "__main__":
    main()
