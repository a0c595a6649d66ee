# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Charts of accuracy over cost, of forces over depth, and of the modulus of clusters."""

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
TONGUE = ("tongue-force", "tongue-shape", "lift-force", "lift-material", "lift-shape", "lift-view",
          "lift-still")
# The decisive ones among them: a view may be right for the wrong reasons.
DECIDING = ("tongue-force", "tongue-shape", "lift-force", "lift-shape")
# Cases with an absolute measure as error.
MEASURES = {"lift-still": "rms speed of the tongue [mm/s]"}
TITLES = {"cantilever": "bar under its weight: displacements", "traction": "bar under traction: displacements",
          "stretch": "bar drawn out: displacements", "twist": "bar turned by 90°: displacements",
          "sphere": "sphere of 5 mm, 0.5 to 2 mm deep: force", "blade": "blade of 5 mm, 0.5 to 2 mm deep: force",
          "hertz": "large sphere, lightly pressed: force (Hertz)", "tongue-force": "the patient's tongue under the blade: force",
          "tongue-shape": "the patient's tongue under the blade: displacements", "lift-force": "the scene at the best view: the tongue's force on the blade",
          "lift-material": "the scene at the best view: what the material supports under the blade",
          "lift-shape": "the scene at the best view: the tongue's displacements",
          "lift-view": "the scene at the best view: share of the glottis seen",
          "lift-still": "the scene at the best view: what trembles under a still blade", "tube": "tube held by its connector: tip",
          "tube-bending": "tube over two supports: force", "fluid-pressure": "column of water: pressure",
          "fluid-volume": "column of water: volume", "dam-break": "dam break: front (Martin & Moyce 1952)"}


def read(file):
    return [{**row, "cost": float(row["ms_per_frame"]), "error": float(row["relative_error"]),
             "spacing": float(row["spacing_mm"]), "substeps": int(row["substeps"]),
             "iterations": int(row["iterations"])} for row in rows_of(file)]


def setting(row):
    return row["spacing"], row["substeps"], row["iterations"]


def is_star(row):
    """Whether a row has the shipped settings of the scenarios."""
    if row.get("case") in TONGUE:
        return row["method"] == SHIPPED_TONGUE and setting(row) == SHIPPED_SCENE[row["case"].split("-")[0]]
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
        passes = row["iterations"] if row["method"] == "fluid" else 0
        lines[row["method"], row["spacing"], passes].append(row)
    return sorted(lines.items())


def draw(rows, title, file, measure=None):
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(9.4, 5.0))
    shown = [row for row in rows if math.isfinite(row["error"])]
    spacings = sorted({row["spacing"] for row in rows})
    styles = {0: "-", **dict(zip(sorted({row["iterations"] for row in rows}), ("-", "--", ":", "-.", "-")))}
    for (method, spacing, passes), line in lines_of(shown):
        line.sort(key=lambda row: row["substeps"] * row["iterations"])
        label = f"{method}, {spacing:.3g} mm" + (f", {passes} passes" if passes else "")
        axes.plot([row["cost"] for row in line], [max(row["error"], 1e-5) for row in line], color=COLOURS[method],
                  lw=1, ls=styles[passes] if passes else "-", marker=MARKERS[spacings.index(spacing)], ms=4,
                  label=label)
    front = pareto((row["cost"], max(row["error"], 1e-5)) for row in shown)
    axes.plot(*zip(*front), color="black", lw=3, alpha=0.25, zorder=0, label="nothing is cheaper and better")
    label = "shipped"
    for row in shown:
        if is_star(row):
            axes.plot(row["cost"], max(row["error"], 1e-5), marker="*", ms=15, color="gold", mec="black", ls="none",
                      label=label)
            label = None
    axes.set(xscale="log", yscale="log", title=title, xlabel="wall time per simulated 1/90 s [ms], one thread",
             ylabel=measure or "relative error [%]")
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    for axis, factor in ((axes.xaxis, 1), (axes.yaxis, 1 if measure else 100)):       # labels within one decade, too
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


def draw_forces(file, to):
    """Force over depth at eight substeps, one panel per case and spacing, against the reference."""
    rows = [row for row in rows_of(file) if int(row["substeps"]) * int(row["iterations"]) == 8]
    plt = pyplot()
    cases = list(dict.fromkeys(row["case"] for row in rows))
    spacings = sorted({float(row["spacing_mm"]) for row in rows if float(row["spacing_mm"]) < 4}, reverse=True)
    figure, panels = plt.subplots(len(spacings), len(cases), figsize=(3.6 * len(cases), 3.2 * len(spacings)),
                                  squeeze=False)
    for column, case in enumerate(cases):
        for line, spacing in enumerate(spacings):
            axes = panels[line][column]
            curves = defaultdict(list)
            for row in rows:
                if row["case"] == case and float(row["spacing_mm"]) == spacing:
                    curves[row["method"]].append((float(row["depth_mm"]), 1e3 * float(row["force_n"])))
                    curves[""].append((float(row["depth_mm"]), 1e3 * float(row["reference_n"])))
            if not curves:
                axes.set_visible(False)
                continue
            for method, curve in curves.items():
                # A diverged body has no meaningful force.
                points = [p for p in sorted(set(curve)) if math.isfinite(p[1])]
                if points:
                    axes.plot(*zip(*points), marker="o", ms=3, lw=1 if method else 4, zorder=2 if method else 1,
                              color=COLOURS.get(method, "lightgrey"), label=method or "reference")
            axes.set(title=f"{case}, spacing {spacing:g} mm", xlabel="depth [mm]", ylabel="force [mN]")
            axes.set_ylim(0.0, 1.5 * max(force for _, force in curves[""]))
    # From the panel with most methods: not every case has all.
    handles, labels = max((axes.get_legend_handles_labels() for line in panels for axes in line),
                          key=lambda legend: len(legend[1]))
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=8)
    figure.tight_layout(rect=(0, 0.08, 1, 1))
    save(figure, to)


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
                 xlabel="modulus put in · substep² / (density · spacing²)", ylabel="modulus measured / put in")
        axes.legend(fontsize=7, loc="lower left")
    figure.tight_layout()
    save(figure, to)


def accuracy_figures(folder):
    if (folder / "accuracy.csv").exists():
        rows = read(folder / "accuracy.csv")
        for case in dict.fromkeys(row["case"] for row in rows):
            own = [row for row in rows if row["case"] == case]
            yield folder / f"accuracy-{case}.svg", partial(draw, own, TITLES[case], measure=MEASURES.get(case))
        yield folder / "accuracy-all.svg", partial(draw, overall(rows), "all blocks, geometric mean")
    if (folder / "accuracy-forces.csv").exists():
        yield folder / "accuracy-forces.svg", partial(draw_forces, folder / "accuracy-forces.csv")


def calibration_figures(folder):
    if (folder / "calibration.csv").exists():
        yield folder / "calibration.svg", partial(draw_calibration, folder / "calibration.csv")
