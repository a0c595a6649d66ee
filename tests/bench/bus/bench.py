#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""What the bus costs, and what it does over poor links: tables of latency, joins, loss, observers and endurance."""

import argparse
import sys
from pathlib import Path

import joins
import runs

LOADS = {
    "joins": lambda options: joins.measure(options.bin, 3 if options.quick else 50, joins.LINKS[1:2] if options.quick
                                           else joins.LINKS),
}


def main():
    parser = argparse.ArgumentParser(prog="eti-bench bus", description=__doc__)
    parser.add_argument("--bin", type=Path, default=runs.ROOT / "build/release/bin", help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, default=Path("out/bench"), help="folder for the tables")
    parser.add_argument("--only", choices=LOADS, action="append", help="this table; may be given several times")
    parser.add_argument("--quick", action="store_true", help="few repetitions and a corner of the tables")
    options = parser.parse_args()
    why_not = runs.hosts.why_impossible(options.bin)
    if why_not:
        sys.exit(f"eti-bench bus: {why_not}")
    for name in options.only or LOADS:
        rows = LOADS[name](options)
        file = options.out / f"bus_{name}.csv"
        runs.write_table(file, rows)
        print(file)


if __name__ == "__main__":
    main()
