# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""What all charts share: tables, the drawing library, and what the scenarios ship."""

import csv

MARKERS = ["o", "s", "^", "D", "v", "P"]
# What the scenarios ship: spacing [mm], substeps and passes, on the spacing nearest to the scene's 2 mm; for the
# fluid, what saliva takes.
SHIPPED = {"tetrahedra, XPBD": (2.5, 8, 1), "clusters, calibrated on the tongue": (2.5, 8, 1), "rod": (10.0, 8, 1),
           "fluid": (1.0, 4, 5)}
# The same where the case is the scene itself, or its tongue alone: one solve per step, in the scene beside eight substeps
# of the clusters that lie about it.
SHIPPED_TONGUE = "tetrahedra, implicit"
SHIPPED_SCENE = {"lift": (2.0, 8, 8), "tongue": (2.0, 1, 8)}


def rows_of(file):
    with file.open(newline="") as table:
        return list(csv.DictReader(table))


def pyplot():
    """Loaded only for drawing: the tests read the tables without it."""
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"svg.hashsalt": "neoeti", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3})
    return plt


def save(figure, file):
    """Writes an SVG: without a date, so that the same table gives the same bytes."""
    figure.savefig(file, metadata={"Date": None})
    pyplot().close(figure)
