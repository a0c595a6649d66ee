# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Cells of the stability maps in which the shipped setting has to pass."""

import plot_stability
from plotting import SHIPPED_TONGUE

# (map, column) where the shipped setting is known to fail, see docs/solver/what-fails.md. Everything else must
# pass.
BEYOND = {("tube on wall of particles", "1 m/s")} | {
    (f"tube on {wall}", speed) for speed in ("3 m/s", "10 m/s")
    for wall in ("flap", "cords", "wall of particles", "wall of the shell")}

# (map, method): rows that do not occur in scenes. Starts from upside down or random positions end in knots, which
# are equilibria of the material, too; a scene turns head and jaw at 10 deg/s, which other rows cover. See
# docs/solver/what-fails.md.
ABSENT = {("disturbance", SHIPPED_TONGUE): ("turned 180 deg", "upset 180 deg", "random"),
          ("head in one step", "coarse patient"): ("jaw 0 to 35 deg",),
          ("head in one step", "shipped patient"): ("jaw 0 to 35 deg",)}


def shipped_cells(rows):
    return [row for row in rows if plot_stability.is_shipped(row) and (row["map"], row["column"]) not in BEYOND and
            row["row"] not in ABSENT.get((row["map"], row["method"]), ())]
