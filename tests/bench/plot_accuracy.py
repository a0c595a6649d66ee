# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Charts of accuracy over cost, and of the modulus of clusters."""

import math
from collections import defaultdict
from functools import partial

from plotting import MARKERS, SHIPPED, SHIPPED_SCENE, SHIPPED_TONGUE, pyplot, rows_of, save

COLOURS = {"shape matching, PBD": "#c44e52", "shape matching, XPBD": "#4c72b0", "tetrahedra, XPBD": "#55a868",
           "tetrahedra, implicit": "#ccb974",
           "clusters, calibrated by traction": "#64b5cd", "clusters, calibrated by indentation": "#dd8452",
           "clusters, calibrated on the tongue": "#8c613c",
           "mass-spring, explicit": "#937860", "rod": "#8172b2", "fluid": "#4c72b0"}
# Cases other than blocks of tissue, which are left out of the chart of all blocks.
APART = ("rod", "fluid")
TONGUE = ("tongue-force", "tongue-shape")


def read(file):
    return [{**row, "cost": float(row["ms_per_frame"]), "error": float(row["relative_error"]),
             "spacing": float(row["spacing_mm"]), "substeps": int(row["substeps"]),
             "iterations": int(row["iterations"])} for row in rows_of(file)]


def setting(row):
    return row["spacing"], row["substeps"], row["iterations"]


def is_star(row):
    """Whether a row has the shipped settings of the scenarios."""
    if row.get("case") in TONGUE:
        return row["method"] == SHIPPED_TONGUE and setting(row) == SHIPPED_SCENE
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
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(9.4, 5.0))
    shown = overall(rows)
    spacings = sorted({row["spacing"] for row in shown})
    for (method, spacing), line in lines_of(shown):
        line.sort(key=lambda row: row["substeps"] * row["iterations"])
        axes.plot([row["cost"] for row in line], [max(row["error"], 1e-5) for row in line], color=COLOURS[method],
                  lw=1, ls="-", marker=MARKERS[spacings.index(spacing)], ms=4, label=f"{method}, {spacing:.3g} mm")
    front = pareto((row["cost"], max(row["error"], 1e-5)) for row in shown)
    axes.plot(*zip(*front), color="black", lw=3, alpha=0.25, zorder=0, label="Pareto front")
    label = "shipped"
    for row in shown:
        if is_star(row):
            axes.plot(row["cost"], max(row["error"], 1e-5), marker="*", ms=15, color="gold", mec="black", ls="none",
                      label=label)
            label = None
    axes.set(xscale="log", yscale="log", title="all blocks, geometric mean",
             xlabel="wall time per simulated 1/90 s [ms], one thread", ylabel="relative error [%]")
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    for axis, factor in ((axes.xaxis, 1), (axes.yaxis, 100)):       # labels within one decade, too
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _, factor=factor: f"{factor * value:.3g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.01, 1.0))     # beside the lines, not over them
    figure.tight_layout()
    save(figure, file)


def overall(rows):
    """Geometric means over the cases of blocks, by setting; none if the body diverged in one."""
    settings = defaultdict(list)
    for row in rows:
        if row["method"] not in APART and row["case"] not in TONGUE:
            settings[row["method"], setting(row)].append(row)
    cases = max(len(line) for line in settings.values())

    def mean(line, key):
        return math.exp(sum(math.log(max(row[key], 1e-4)) for row in line) / len(line))

    return [{"method": method, "spacing": spacing, "substeps": substeps, "iterations": iterations,
             "cost": mean(line, "cost"), "error": mean(line, "error")}
            for (method, (spacing, substeps, iterations)), line in settings.items()
            if len(line) == cases and all(math.isfinite(row["error"]) for row in line)]


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
        yield folder / "accuracy-all.svg", partial(draw_blocks, read(folder / "accuracy.csv"))


def calibration_figures(folder):
    if (folder / "calibration.csv").exists():
        yield folder / "calibration.svg", partial(draw_calibration, folder / "calibration.csv")
