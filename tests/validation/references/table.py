#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Prints the table of docs/solver/references.md from the records beside this script."""
import json
import math
from pathlib import Path

from cases import CASES
from run import uncertainty_key

HERE = Path(__file__).resolve().parent
# Case, its quantity, the key of its load with the loads that are shown, and words for a row.
ROWS = [
    ("bar", "sag_mm", None, [None], "sag of the tip [mm]"),
    ("sphere", "force_n", "depth_mm", [1.0, 3.0, 5.0], "force at {} mm [N]"),
    ("blade", "force_n", "depth_mm", [0.5, 1.0, 2.0, 3.0, 4.0, 5.0], "force at {} mm [N]"),
    ("slabs", "force_n", "approach_mm", [1.0, 2.0, 4.0, 6.0], "force at an approach of {} mm [N]"),
    ("squeeze", "force_n", "squeezed_share", [0.1, 0.2, 0.3, 0.4, 0.5], "force, squeezed by {} of the height [N]"),
    ("plate", "bending_over_beam", None, [None], "bending stiffness over 3 E I / L³"),
    ("plate", "twist_over_saint_venant", None, [None], "torsional stiffness over G J / L"),
    ("tongue_press", "force_n", "depth_mm", [2.0, 4.0, 6.0], "force at {} mm [N]"),
    ("tongue_lift", "force_n", "share", [0.5, 1.0], "force at {} of the path [N]"),
]


def cell(value, uncertainty):
    """A value with as many digits as its uncertainty, which has two: 0.56760 ± 0.00091."""
    if uncertainty is None:
        return f"{value:.3g} (one mesh)"
    digits = max(0, 1 - math.floor(math.log10(uncertainty))) if uncertainty > 0 else 4
    return f"{value:.{digits}f} ± {uncertainty:.{digits}f}"


def lines():
    yield "| case | quantity | ν 0.45 | ν 0.48 | ν 0.49 |"
    yield "|---|---|---|---|---|"
    for name, quantity, key, loads, words in ROWS:
        record = json.loads((HERE / f"{name}.json").read_text())
        own = uncertainty_key(quantity, quantity == CASES[name].quantities[0])
        for load in loads:
            rows = {r["nu"]: r for r in record["results"] if key is None or r[key] == load}
            cells = [cell(rows[nu][quantity], rows[nu][own]) if nu in rows else "not reached" for nu in (0.45, 0.48, 0.49)]
            yield f"| {name} | {words.format(f'{load:g}' if load else '')} | {' | '.join(cells)} |"


if __name__ == "__main__":
    print("\n".join(lines()))
