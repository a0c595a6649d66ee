#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Writes the tables of keys and parameters into the documents, from the server's own output, and those of measurements
that docs/charts holds.

A table stands between "<!-- table: NAME -->" and "<!-- end -->". --check changes nothing and exits 1 if a document
holds another table.
"""

import argparse
import csv
import json
import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
BLOCK = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.S)
PAGES = ("scenarios.md", "commands.md", "metrics.md", "metrics-numbers.md", "solver/hexahedra.md", "solver/skeleton.md")


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


def lifts():
    """Rows of the replayed lift by scenario and variant."""
    with (DOCS / "charts" / "matter.csv").open(encoding="utf-8") as file:
        return {(row["scenario"], row["variant"]): row for row in csv.DictReader(file)}


def value(key, unit="", digits=3):
    return lambda row: " ".join(filter(None, [f"{float(row[key]):.{digits}g}", unit]))


def percent(key):
    return lambda row: f"{100 * float(row[key]):.3g} %"


# What a replayed lift shows: name, goal, cell.
MATTER = [
    ("volume of the tongue's cells", "at least 97 %", percent("tongue_volume_share")),
    ("of what the tongue occupies, covered twice", "at most 1 %", percent("tongue_doubly_covered_share")),
    ("inverted tetrahedra, five or six to a cell", "0", lambda row: row["inverted_cells"]),
    ("speed of held tissue", "at most 0.5 mm/s", value("tremble_mm_per_s", "mm/s", 2)),
    ("greatest force on the epiglottis", "5 to 11 N", value("epiglottis_force_n", "N", 2)),
    ("greatest force on the gum", "3 to 5.5 N", value("gum_force_n", "N", 2)),
    ("the same, held blade pitched by 45°", "below 45 N", value("gum_force_lever_n", "N")),
    ("force of a blade held for 4 s, after a quick lift", "65 to 75 %", percent("hold_relaxation_share")),
    ("distance from rest three seconds after", "at most 0.01 mm", value("from_rest_mm", "mm", 2)),
]
BONES = [
    ("force on the blade", value("blade_force_held_n", "N", 2)),
    ("greatest force on the epiglottis", value("epiglottis_force_n", "N", 2)),
    ("gum, blade pitched by 45°", value("gum_force_lever_n", "N")),
    ("volume of the tongue's cells", percent("tongue_volume_share")),
    ("of what it occupies, covered twice", percent("tongue_doubly_covered_share")),
    ("inverted tetrahedra", lambda row: row["inverted_cells"]),
    ("glottis seen", lambda row: f"{float(row['view_percent']):.0f} %"),
    ("speed of held tissue", value("tremble_mm_per_s", "mm/s", 2)),
    ("jaw's slide, head's lift", lambda row: f"{float(row['jaw_slide_mm']):.1f}, {float(row['head_lift_mm']):.1f} mm"),
    ("head's extension", lambda row: f"{float(row['head_extension_deg']):.1f}°"),
    ("hyoid's shift", value("hyoid_shift_mm", "mm", 2)),
    ("force after 4 s", percent("hold_relaxation_share")),
]
# Resolutions between which a result should not differ, and how it is judged.
RESOLUTIONS = ("2.5 mm", "shipped", "1.5 mm", "4 substeps", "16 substeps")
SPREAD = [("blade_force_held_n", "force on the blade", "5 %"), ("gum_force_n", "gum", "10 %"),
          ("epiglottis_force_n", "epiglottis", "10 %"), ("view_percent", "glottis seen", "5 points")]


def matter(_):
    rows = lifts()
    return table(["what", "goal", "term", "premature"],
                 [[name, goal] + [cell(rows[scenario, "shipped"]) for scenario in ("term", "premature")]
                  for name, goal, cell in MATTER])


def spread(_):
    rows = lifts()
    lines = []
    for scenario in ("term", "premature"):
        for key, name, goal in SPREAD:
            values = [float(rows[scenario, variant][key]) for variant in RESOLUTIONS]
            apart = max(values) - min(values)
            over = f"{apart:.0f} points" if goal.endswith("points") else f"{100 * apart / values[1]:.0f} %"
            lines.append([f"{scenario}, {name}", *(f"{v:.3g}" for v in values), over, goal])
    return table(["what", *RESOLUTIONS, "spread", "goal"], lines)


def bones(_):
    rows = lifts()
    columns = [(scenario, variant) for scenario in ("term", "premature") for variant in ("fixed bones", "elastic", "shipped")]
    return table(["blade held at the best view", *(f"{scenario}, {variant}" for scenario, variant in columns)],
                 [[name] + [cell(rows[column]) for column in columns] for name, cell in BONES])


def blocks(_):
    with (DOCS / "charts" / "matter-blocks.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["element"] == "hexahedra"]
    cases = {}
    for row in rows:
        cell, depth = float(row["cell_mm"]), float(row["depth_mm"])
        pressed = f", {depth:g} mm deep" if depth else ""
        cases.setdefault(f"{row['case']}{pressed}, cells of {cell:g} mm", {})[row["nu"]] = f"{100 * float(row['error']):+.1f} %"
    ratios = sorted({row["nu"] for row in rows})
    return table(["case", *(f"ratio {nu}" for nu in ratios)],
                 [[name, *(errors.get(nu, "") for nu in ratios)] for name, errors in cases.items()])


MAKERS = {"matter": matter, "spread": spread, "bones": bones, "blocks": blocks, "thresholds": thresholds, "scenario": scenario,
          "scenario_other": scenario_other, "live": live, "parameters": parameters}


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
