# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Common to all charts: tables, the drawing library, and the scenarios' shipped settings."""

import csv

MARKERS = ["o", "s", "^", "D", "v", "P"]
# The scenarios' settings: spacing [mm], substeps and passes (of the tongue, conjugate gradients), on the spacing nearest
# to the scene's 2 mm; for the fluid, those of saliva.
SHIPPED_TONGUE = "hexahedra, implicit"
CLUSTERS = "clusters, calibrated on the tongue"
SHIPPED = {SHIPPED_TONGUE: (2.5, 1, 8), CLUSTERS: (2.5, 8, 1), "rod": (10.0, 8, 1), "fluid": (1.0, 4, 5)}


def rows_of(file):
    with file.open(newline="") as table:
        return list(csv.DictReader(table))


def pyplot():
    """Imported only for drawing: the tests read the tables without it."""
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"svg.hashsalt": "neoeti", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3})
    return plt


def save(figure, file):
    """Writes an SVG without a date, so that the same table gives the same bytes."""
    figure.savefig(file, metadata={"Date": None})
    pyplot().close(figure)
