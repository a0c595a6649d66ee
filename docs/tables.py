#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Writes the tables of keys and parameters into the documents, from the server's own output.

A table stands between "<!-- table: NAME -->" and "<!-- end -->". --check changes nothing and exits 1 if a document
holds another table.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
BLOCK = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.S)
PAGES = ("scenarios.md", "commands.md", "metrics.md", "metrics-numbers.md")


def number(value):
    return f"{value:g}"


def range_of(row):
    return "`on`, `off`" if row["on_off"] else f"{number(row['low'])} to {number(row['high'])}"


def default_of(row):
    return ("`on`" if row["default"] else "`off`") if row["on_off"] else number(row["default"])


def rate_of(row):
    if row["rate"] == 0:
        return "at once"
    if row["relative"]:
        return f"by a factor of e per {number(1 / row['rate'])} s"
    per_second = float(f"{row['rate']:.2g}")
    return " ".join(filter(None, [number(per_second), row["unit"], "a second"]))


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "".join(line + "\n" for line in lines + ["| " + " | ".join(row) + " |" for row in rows])


def scenario(tables):
    return table(["key", "unit", "range", "default", "effect"],
                 [[f"`{r['key']}`", r["unit"], range_of({"on_off": False, **r}), default_of({"on_off": False, **r}),
                   r["help"]] for r in tables["scenario"]])


def scenario_other(tables):
    return table(["key", "values", "default", "effect"],
                 [[f"`{r['key']}`", r["values"], r["default"] or "none", r["help"]] for r in tables["scenario_other"]])


def live(tables):
    return table(["key of `--set`", "range", "rate of change", "effect"],
                 [[f"`{r['key']}`", f"{number(r['low'])} to {number(r['high'])}", rate_of(r), r["help"]]
                  for r in tables["live"]])


def parameters(tables):
    return table(["name", "unit", "over a run", "definition", "aim"],
                 [[f"`{r['key']}`" + ("" if r["in_paper"] else " *"), r["unit"], r["run"], r["definition"], r["norm"]]
                  for r in tables["parameters"]])


def thresholds(tables):
    return table(["name", "value", "meaning"],
                 [[f"`{r['name']}`", f"{number(r['value'])} {r['unit']}".removesuffix(" 1"), r["meaning"]]
                  for r in tables["thresholds"]])


MAKERS = {"thresholds": thresholds, "scenario": scenario, "scenario_other": scenario_other, "live": live, "parameters": parameters}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", default=DOCS.parent / "build/release/bin/eti-server", help="the server to query")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 where a table is not up to date")
    options = parser.parse_args()
    tables = json.loads(subprocess.run([options.server, "--describe"], check=True, capture_output=True).stdout)
    stale = []
    for page in PAGES:
        old = (DOCS / page).read_text(encoding="utf-8")
        new = BLOCK.sub(lambda m: m[1] + MAKERS[m[2]](tables) + m[3], old)
        if new != old:
            stale.append(page)
            if not options.check:
                (DOCS / page).write_text(new, encoding="utf-8")
    if options.check and stale:
        print(f"docs/{', docs/'.join(stale)}: a table differs from what {options.server} says. Remedy: docs/tables.py",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
