# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Charts of accuracy over cost, and of the modulus of clusters."""

import math
from collections import defaultdict
from functools import partial

from plotting import MARKERS, SHIPPED, pyplot, rows_of, save

COLOURS = {"shape matching, PBD": "#c44e52", "shape matching, XPBD": "#4c72b0",
           "hexahedra, implicit": "#55a868", "tetrahedra, implicit": "#ccb974",
           "clusters, calibrated by traction": "#64b5cd", "clusters, calibrated by indentation": "#dd8452",
           "clusters, calibrated on the tongue": "#8c613c",
           "mass-spring, explicit": "#937860", "rod": "#8172b2", "fluid": "#4c72b0"}
# Cases of blocks of tissue, and what each panel of their chart shows.
BLOCKS = {"bar": "bar under its weight: sag", "sphere": "sphere pressed in: force", "blade": "blade pressed in: force",
          "blade-shape": "blade pressed in: shape"}


def read(file):
    return [{**row, "cost": float(row["ms_per_frame"]), "error": float(row["relative_error"]),
             "spacing": float(row["spacing_mm"]), "substeps": int(row["substeps"]),
             "iterations": int(row["iterations"])} for row in rows_of(file)]


def setting(row):
    return row["spacing"], row["substeps"], row["iterations"]


def is_star(row):
    """Whether a row has the shipped settings of the scenarios."""
    return SHIPPED.get(row["method"]) == setting(row)


def pareto(points):
    """The (cost, error) pairs that no other beats in both."""
    front, best = [], math.inf
    for cost, error in sorted(points):
        if error < best:
            front.append((cost, error))
            best = error
    return front


def lines_of(rows):
    """Settings that differ in substeps only; for PBD, whose passes belong to one substep, in passes only."""
    lines = defaultdict(list)
    for row in rows:
        lines[row["method"], row["spacing"]].append(row)
    return sorted(lines.items())


def draw_blocks(rows, file):
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    plt = pyplot()
    figure, panels = plt.subplots(2, 2, figsize=(11.6, 8.0))
    spacings = sorted({row["spacing"] for row in rows if row["case"] in BLOCKS})
    shown = {}
    for axes, (case, title) in zip(panels.flat, BLOCKS.items()):
        own = [row for row in rows if row["case"] == case and math.isfinite(row["error"])]
        for (method, spacing), line in lines_of(own):
            line.sort(key=lambda row: row["substeps"] * row["iterations"])
            shown[method, spacing], = axes.plot([row["cost"] for row in line], [row["error"] for row in line],
                                                color=COLOURS[method], lw=1, marker=MARKERS[spacings.index(spacing)], ms=4)
        front, = axes.plot(*zip(*pareto((row["cost"], row["error"]) for row in own)), color="black", lw=3, alpha=0.25,
                           zorder=0)
        for row in filter(is_star, own):
            star, = axes.plot(row["cost"], row["error"], marker="*", ms=15, color="gold", mec="black", ls="none")
        axes.set(xscale="log", yscale="log", title=title, xlabel="wall time per simulated 1/90 s [ms], one thread",
                 ylabel="relative error [%]")
        for axis, factor in ((axes.xaxis, 1), (axes.yaxis, 100)):       # labels within one decade, too
            low, high = axis.get_view_interval()
            axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 1000 * low else (1,)))
            axis.set_major_formatter(FuncFormatter(lambda value, _, factor=factor: f"{factor * value:.3g}"))
            axis.set_minor_formatter(NullFormatter())
    figure.legend([*shown.values(), front, star], [f"{method}, {spacing:.3g} mm" for method, spacing in shown] +
                  ["Pareto front", "shipped"], fontsize=7, loc="center right")     # beside the lines, not over them
    figure.tight_layout(rect=(0, 0, 0.75, 1))
    save(figure, file)


def draw_calibration(file, to):
    """Measured over input modulus, one panel per kind of load."""
    rows = rows_of(file)
    plt = pyplot()
    loads = {"traction": ["traction"], "indentation": ["sphere", "blade", "narrow blade", "hertz"]}
    styles = {"1.25": ":", "2.5": "-", "5": "--"}
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.6), sharex=True, sharey=True)
    for axes, (title, names) in zip(panels, loads.items()):
        for number, name in enumerate(names):
            for radius in sorted({row["radius_spacings"] for row in rows}):
                for spacing in sorted({row["spacing_mm"] for row in rows}, key=float):
                    points = sorted((float(row["group"]), float(row["ratio"])) for row in rows
                                    if (row["load"], row["radius_spacings"], row["spacing_mm"]) ==
                                    (name, radius, spacing))
                    if points:
                        axes.plot(*zip(*points), color=f"C{number}", lw=0.8, ls=styles[spacing], ms=3,
                                  marker=MARKERS[["1.8", "2.01", "2.5"].index(radius)],
                                  label=f"{name}, reach {radius}, {spacing} mm")
        axes.set(xscale="log", yscale="log", title=title,
                 xlabel="input modulus · substep² / (density · spacing²)", ylabel="measured / input modulus")
        axes.legend(fontsize=7, loc="lower left")
    figure.tight_layout()
    save(figure, to)


def accuracy_figures(folder):
    if (folder / "accuracy.csv").exists():
        yield folder / "accuracy-blocks.svg", partial(draw_blocks, read(folder / "accuracy.csv"))


def calibration_figures(folder):
    if (folder / "calibration.csv").exists():
        yield folder / "calibration.svg", partial(draw_calibration, folder / "calibration.csv")
