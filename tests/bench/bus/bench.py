#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Cost of the bus, and its behaviour over poor links: tables of latency, joins, scenes, observers and endurance."""

import argparse
import math
import sys
from pathlib import Path

import joins
import latency
import observers
import runs
import scenes
import soak

# Each returns the rows of a table, from the options.
TABLES = {
    "latency": lambda o: latency.measure(o.bin, 2, (20,), (0, 5)) if o.quick else latency.measure(o.bin, 10),
    "joins": lambda o: (joins.measure(o.bin, 3, joins.LINKS[1:2], ("UDP, loopback",)) if o.quick
                        else joins.measure(o.bin, o.tries)),
    "scenes": lambda o: scenes.measure(o.bin, 6, (20,), (5,)) if o.quick else scenes.measure(o.bin, 12),
    "observers": lambda o: observers.measure(o.bin, 3, (0, 2)) if o.quick else observers.measure(o.bin, 15),
    "soak": lambda o: soak.measure(o.bin, o.soak, o.out / "bus-soak.log"),
}


def count(text):
    """A whole number from 1 to a million."""
    if not text.isdecimal() or not 1 <= int(text) <= 1_000_000:
        raise argparse.ArgumentTypeError(f"'{text[:40]}' is not a count; expected a whole number from 1 to 1000000")
    return int(text)


def minutes(text):
    """A time above 0, a week at most. NaN is neither."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value <= 10_080.0:
        raise argparse.ArgumentTypeError(f"'{text[:40]}' is not a time; expected a number above 0, at most 10080 minutes")
    return value


def main():
    parser = argparse.ArgumentParser(prog="eti-bench bus", description=__doc__)
    parser.add_argument("--bin", type=Path, default=runs.ROOT / "build/release/bin", help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, default=Path("out/bench"),
                        help="folder for the tables (default: %(default)s)")
    parser.add_argument("--only", choices=TABLES, action="append", help="this table; may be repeated")
    parser.add_argument("--tries", type=count, default=50, metavar="N", help="joins of each kind (default: %(default)s)")
    parser.add_argument("--soak", type=minutes, metavar="MINUTES", help="how long programs come and go (default: 2; with "
                        "--quick 0.3; an hour shows what creeps)")
    parser.add_argument("--quick", action="store_true", help="few repetitions and a corner of the tables")
    options = parser.parse_args()
    options.soak = options.soak or (0.3 if options.quick else 2.0)
    why_not = runs.hosts.why_impossible(options.bin)
    if why_not:
        sys.exit(f"eti-bench bus: {why_not}")
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.only or TABLES:
        rows = TABLES[name](options)
        file = options.out / f"bus-{name}.csv"
        runs.write_table(file, rows)
        print(file)


if __name__ == "__main__":
    main()
