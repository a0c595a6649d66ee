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

# (map, method): rows that do not occur in scenes. Starts from half a turn end in knots, which are equilibria of the
# material, too; a scene turns head and jaw at 10 deg/s, which other rows cover.
ABSENT = {("disturbance", SHIPPED_TONGUE): ("turned 180 deg", "upset 180 deg"),
          ("head in one step", "coarse patient"): ("head 30 to 0 deg", "head and jaw, back")}

# Maps in which a method is known to fail in every row, as the tongue lags behind the bones.
LAGGING = {("head in one step", "shipped patient")}


def shipped_cells(rows):
    return [row for row in rows if plot_stability.is_shipped(row) and (row["map"], row["column"]) not in BEYOND and
            (row["map"], row["method"]) not in LAGGING and
            row["row"] not in ABSENT.get((row["map"], row["method"]), ())]
