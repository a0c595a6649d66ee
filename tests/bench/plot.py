#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Draws the charts of eti-bench. Usage: plot.py FOLDER, where its tables lie; writes SVG beside them.

Needs Debian's python3-matplotlib.
"""

import csv
import math
import sys
from collections import defaultdict
from pathlib import Path

COLOURS = {"shape matching, PBD": "#c44e52", "shape matching, XPBD": "#4c72b0", "tetrahedra, XPBD": "#55a868",
           "tetrahedra, implicit": "#ccb974",
           "clusters, calibrated by traction": "#64b5cd", "clusters, calibrated by indentation": "#dd8452",
           "clusters, calibrated on the tongue": "#8c613c",
           "mass-spring, explicit": "#937860", "rod": "#8172b2", "fluid": "#4c72b0"}
MARKERS = ["o", "s", "^", "D", "v", "P"]
# What the scenarios ship: spacing [mm], substeps and passes, on the spacing nearest to the scene's 2 mm; for the
# fluid, what saliva takes.
SHIPPED = {"tetrahedra, XPBD": (2.5, 8, 1), "clusters, calibrated on the tongue": (2.5, 8, 1), "rod": (10.0, 8, 1),
           "fluid": (1.0, 4, 5)}
# The same where the case is the scene itself, or its tongue alone: one solve per step, in the scene beside eight substeps
# of the clusters that lie about it.
SHIPPED_TONGUE = "tetrahedra, implicit"
SHIPPED_SCENE = {"lift": (2.0, 8, 8), "tongue": (2.0, 1, 8)}
# What is not a block of tissue, and does not enter the chart of all blocks.
APART = ("rod", "fluid")
TONGUE = ("tongue-force", "tongue-shape", "lift-force", "lift-material", "lift-shape", "lift-view",
          "lift-still")
# Of these, the ones that decide what is shipped: a view may come out right for the wrong reasons.
DECIDING = ("tongue-force", "tongue-shape", "lift-force", "lift-shape")
# What is not told in parts of something: what stands in the column of errors instead.
MEASURES = {"lift-still": "rms speed of the tongue [mm/s]"}
TITLES = {"cantilever": "bar under its weight: displacements", "traction": "bar under traction: displacements",
          "stretch": "bar drawn out: displacements", "twist": "bar turned by 90°: displacements",
          "sphere": "sphere of 5 mm, 0.5 to 2 mm deep: force", "blade": "blade of 5 mm, 0.5 to 2 mm deep: force",
          "hertz": "large sphere, lightly pressed: force (Hertz)", "tongue-force": "the patient's tongue under the blade: force",
          "tongue-shape": "the patient's tongue under the blade: displacements", "lift-force": "the scene at the best view: the tongue's force on the blade",
          "lift-material": "the scene at the best view: what the material bears under the blade",
          "lift-shape": "the scene at the best view: the tongue's displacements",
          "lift-view": "the scene at the best view: share of the glottis seen",
          "lift-still": "the scene at the best view: what trembles under a still blade", "tube": "tube held by its connector: tip",
          "tube-bending": "tube over two supports: force", "fluid-pressure": "column of water: pressure",
          "fluid-volume": "column of water: volume", "dam-break": "dam break: front (Martin & Moyce 1952)"}


def read(file):
    with file.open(newline="") as table:
        return [{**row, "cost": float(row["ms_per_frame"]), "error": float(row["relative_error"]),
                 "spacing": float(row["spacing_mm"]), "substeps": int(row["substeps"]),
                 "iterations": int(row["iterations"])} for row in csv.DictReader(table)]


def setting(row):
    return row["spacing"], row["substeps"], row["iterations"]


def is_star(row):
    """Whether a row is of what the scenarios ship."""
    if row.get("case") in TONGUE:
        return row["method"] == SHIPPED_TONGUE and setting(row) == SHIPPED_SCENE[row["case"].split("-")[0]]
    return SHIPPED.get(row["method"]) == setting(row)


def pareto(points):
    """Those of (cost, error) that nothing beats in both."""
    front, best = [], math.inf
    for cost, error in sorted(points):
        if error < best:
            front.append((cost, error))
            best = error
    return front


def pyplot():
    """Loaded only for drawing: the tests read the tables without it."""
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"svg.hashsalt": "neoeti", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3})
    return plt


def lines_of(rows):
    """Settings that differ in substeps only; for PBD, whose passes are of one substep, in passes only."""
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
    for axis, factor in ((axes.xaxis, 1), (axes.yaxis, 1 if measure else 100)):       # numbers on it even where it spans no decade
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _, factor=factor: f"{factor * value:.3g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.01, 1.0))     # beside the lines, not over them
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def overall(rows):
    """Geometric means over the cases of blocks, setting by setting; none where the body flew apart in one."""
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
    with file.open(newline="") as table:
        rows = [row for row in csv.DictReader(table)
                if int(row["substeps"]) * int(row["iterations"]) == 8]
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
                # A body that flew apart has no force worth drawing.
                points = [p for p in sorted(set(curve)) if math.isfinite(p[1])]
                if points:
                    axes.plot(*zip(*points), marker="o", ms=3, lw=1 if method else 4, zorder=2 if method else 1,
                              color=COLOURS.get(method, "lightgrey"), label=method or "reference")
            axes.set(title=f"{case}, spacing {spacing:g} mm", xlabel="depth [mm]", ylabel="force [mN]")
            axes.set_ylim(0.0, 1.5 * max(force for _, force in curves[""]))
    # Of the panel with most methods: not every case has all.
    handles, labels = max((axes.get_legend_handles_labels() for line in panels for axes in line),
                          key=lambda legend: len(legend[1]))
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=8)
    figure.tight_layout(rect=(0, 0.08, 1, 1))
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


def draw_calibration(file, to):
    """Modulus measured over the modulus put in, one panel per kind of load."""
    with file.open(newline="") as table:
        rows = list(csv.DictReader(table))
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
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


FATES = {"fails": (0, "F", "#d9786c"), "recovers": (1, "R", "#e5c469"), "survives": (2, "", "#7fbf8f")}
# What lies across, and what of it the scenarios ship: the tongue is solved once in a step, but cut into more solves where
# the blade is fast.
ACROSS = {"walls": "speed of the hand"}
SHIPPED_SOLVES = {"blade into tissue on bone": "as cut"}
SHIPPED_STEP = f"1/{180 * SHIPPED['tetrahedra, XPBD'][1]} s"
SALIVA_STEP = f"1/{180 * SHIPPED['fluid'][1]} s"


def read_maps(file):
    with file.open(newline="") as table:
        return list(csv.DictReader(table))


def is_shipped(row):
    """Whether a cell of the maps is computed as the scenarios are."""
    if row["figure"] == "walls":
        return row["method"] == SHIPPED_STEP
    if row["method"].startswith("saliva"):
        return row["method"] == "saliva" and row["column"] == SALIVA_STEP
    if row["method"] == SHIPPED_TONGUE:
        return row["column"] == SHIPPED_SOLVES.get(row["map"], "1")
    return row["column"] == SHIPPED_STEP and row["method"] not in \
        ("shape matching, PBD", "tetrahedra, XPBD", "mass-spring, explicit")


def draw_map(axes, cells, figure):
    """One panel. A letter says the fate too, so that nobody has to tell colours apart."""
    from matplotlib.colors import ListedColormap
    columns = list(dict.fromkeys(row["column"] for row in cells))
    names = list(dict.fromkeys(row["row"] for row in cells))
    fate = {(row["row"], row["column"]): FATES[row["fate"]] for row in cells}
    axes.imshow([[fate[r, c][0] for c in columns] for r in names], vmin=0, vmax=2, aspect="auto",
                cmap=ListedColormap([colour for _, _, colour in FATES.values()]))
    for y, r in enumerate(names):
        for x, c in enumerate(columns):
            axes.text(x, y, fate[r, c][1], ha="center", va="center", fontsize=7)
    shipped = [columns.index(row["column"]) for row in cells if is_shipped(row)]
    if shipped:
        axes.add_patch(plt_rectangle((min(shipped) - 0.5, -0.5), max(shipped) - min(shipped) + 1, len(names)))
    axes.set_xticks(range(len(columns)), columns, rotation=45, fontsize=7)
    axes.set_yticks(range(len(names)), names, fontsize=7)
    axes.set_xlabel("solves per 1/180 s" if cells[0]["method"] == SHIPPED_TONGUE else ACROSS.get(figure, "substep"),
                    fontsize=8)
    axes.grid(False)


def plt_rectangle(corner, width, height):
    from matplotlib.patches import Rectangle
    return Rectangle(corner, width, height, fill=False, lw=2.5, ec="black", clip_on=False)


def draw_maps(rows, figure, file):
    """One line of panels per map, one panel per method."""
    plt = pyplot()
    from matplotlib.patches import Patch
    maps = {}
    for row in rows:
        maps.setdefault(row["map"], {}).setdefault(row["method"], []).append(row)
    heights = [len({row["row"] for cells in methods.values() for row in cells}) for methods in maps.values()]
    wide = max(len(methods) for methods in maps.values())
    sheet, panels = plt.subplots(len(maps), wide, squeeze=False, gridspec_kw={"height_ratios": heights},
                                 figsize=(3.7 * wide + 1.0, 0.19 * sum(heights) + 1.05 * len(maps) + 0.8))
    for line, (name, methods) in zip(panels, maps.items()):
        for axes in line[len(methods):]:
            axes.set_visible(False)
        for axes, (method, cells) in zip(line, methods.items()):
            draw_map(axes, cells, figure)
            axes.set_title(f"{name}\n{method}", fontsize=8)
    handles = [Patch(color=colour, label=f"{letter or 'no letter'}: {fate}")
               for fate, (_, letter, colour) in reversed(FATES.items())]
    handles.append(plt_rectangle((0, 0), 1, 1))
    handles[-1].set_label("frame: as shipped")
    sheet.tight_layout(rect=(0, 0.5 / sheet.get_figheight(), 1, 1))
    sheet.legend(handles=handles, loc="lower center", ncol=4, fontsize=8)
    sheet.savefig(file, metadata={"Date": None})
    plt.close(sheet)


def rows_of(file):
    with file.open(newline="") as table:
        return list(csv.DictReader(table))


def stable_over_the_bus(rows):
    """Of the cells pressed over the bus, by controller, loss and delay: the largest stiffness that was stable (or
    None), and the smallest that was not (or None where the search ended). Cells that were not measured say nothing."""
    found = {}
    for row in rows:
        if row["stable"]:
            stable, unstable = found.setdefault((row["passivity"], row["loss_percent"], float(row["delay_ms"])), ([], []))
            (stable if row["stable"] == "1" else unstable).append(float(row["stiffness_n_per_m"]))
    return {key: (max(stable, default=None), min(unstable, default=None)) for key, (stable, unstable) in found.items()}


def draw_over_the_bus(axes, found, losses):
    """Filled: the largest stiffness that held still over the bus; cross above it: the next, which did not."""
    for (passivity, loss, delay), (stable, unstable) in found.items():
        number = losses.index(loss)
        # Apart by loss and controller, so that they can be told from each other.
        x = delay + 0.55 * (number - 1.5) + (0.25 if passivity == "1" else -0.25)
        colour = dict(color=f"C{number}", mec="black", mew=0.6, ms=6, ls="none", zorder=5)
        if stable:
            axes.plot(x, stable, marker="^" if passivity == "1" else "s", **colour)
        if unstable:
            axes.plot(x, unstable, marker="x", ms=6, mew=1.4, color=f"C{number}", ls="none", zorder=5)
        if stable and unstable:
            axes.plot([x, x], [stable, unstable], color=f"C{number}", lw=0.7, alpha=0.6)


def draw_haptics_stability(file, to):
    """Largest stable stiffness over delay, one panel per surface and grip, against the bounds; where there is a table
    of the real loop and server over the bus, its cells too."""
    plt = pyplot()
    rows = rows_of(file)
    grid = file.with_name("haptics-grid.csv")
    over_the_bus = stable_over_the_bus(rows_of(grid)) if grid.exists() else {}
    surfaces = list(dict.fromkeys(row["surface"] for row in rows))
    grips = list(dict.fromkeys(row["grip"] for row in rows))
    losses = sorted({row["loss_percent"] for row in rows}, key=float)
    shipped = {"wall": 800.0}
    figure, panels = plt.subplots(len(grips), len(surfaces), sharex=True, sharey=True, squeeze=False,
                                  figsize=(4.2 * len(surfaces), 3.4 * len(grips) + 0.8))
    for line, grip in zip(panels, grips):
        for axes, surface in zip(line, surfaces):
            cells = [row for row in rows if row["surface"] == surface and row["grip"] == grip]
            for passivity, style in (("0", "--"), ("1", "-")):
                for number, loss in enumerate(losses):
                    points = sorted((float(row["delay_ms"]), max(float(row["stable_n_per_m"]), 40.0)) for row in cells
                                    if row["passivity"] == passivity and row["loss_percent"] == loss)
                    axes.plot(*zip(*points), color=f"C{number}", ls=style, lw=1.2, ms=3.5, marker=MARKERS[number],
                              label=f"{loss} % lost, controller {'on' if passivity == '1' else 'off'}")
            bounds = sorted({(float(row["delay_ms"]), float(row["delayed_bound_n_per_m"])) for row in cells})
            axes.plot(*zip(*bounds), color="black", lw=2, alpha=0.5,
                      label="bound where the force is late (Gil et al. 2009)")
            axes.axhline(float(cells[0]["passive_bound_n_per_m"]), color="black", ls=":", lw=1.5,
                         label="passive without delay (Colgate & Schenkel 1997)")
            axes.axhline(shipped.get(surface, 160.0), color="gold", lw=4, zorder=0, label="as shipped")
            if (surface, grip) == ("wall", "light grip"):
                draw_over_the_bus(axes, over_the_bus, losses)
            axes.set_title(f"{surface}, {grip}", fontsize=9)
            axes.set(yscale="log", ylim=(60, 60000))
    for axes in panels[-1]:
        axes.set_xlabel("round-trip delay [ms], a tenth of it jitter")
    for line in panels:
        line[0].set_ylabel("largest stable stiffness [N/m]")
    handles, labels = panels[0][0].get_legend_handles_labels()
    if over_the_bus:
        for marker, text in (("^", "real server over DDS, still: controller on"), ("s", "the same, controller off"),
                             ("x", "real server over DDS, not still")):
            handles += panels[0][0].plot([], [], marker=marker, color="grey", mec="black" if marker != "x" else "grey",
                                         ls="none")
            labels.append(text)
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=8)
    figure.tight_layout(rect=(0, 0.85 / figure.get_figheight(), 1, 1))
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


# How long forces are held [ms] where they are let go of at once, and where they are held on.
LET_GO, HELD_ON = 17.0, 10000.0
GRIPS = ("firm grip", "light grip")
PATTERNS = ("regular", "random", "bursts")


def held_in(rows):
    """What of the gaps' table is as shipped: held for [ms], gone by [ms]."""
    (held, gone), = {(float(row["held_ms"]), float(row["gone_ms"])) for row in rows} - \
        {(LET_GO, 20.0), (HELD_ON, 11000.0)}
    return held, gone


def gap_line(rows, column, **wanted):
    """Points of one line over the length of the gap [ms]; what is wanted of the other columns."""
    return sorted((float(row["gap_ms"]), float(row[column])) for row in rows
                  if all(row[key] == str(value) if isinstance(value, str) else float(row[key]) == value
                         for key, value in wanted.items()))


def holding_pays_until(rows, surface, grip, speed):
    """The longest gap [ms] up to which, in the end, letting go at once moves the hand more than holding on does, where
    the patient moves off at `speed` [mm/s]; None where it does so to the end of the table."""
    held, gone = (dict(gap_line(rows, "excursion_mm", surface=surface, grip=grip, pattern="once", held_ms=hold,
                                patient_mm_per_s=speed)) for hold in (HELD_ON, LET_GO))
    pays = [gap for gap in held if held[gap] <= gone[gap]]
    return max(pays) if max(pays) < max(held) else None


def draw_haptics_gaps(file, to):
    """One gap while the patient moves off: where holding on does more harm than letting go. Then gaps again and again:
    how far the device is from where it would be, and how much of the time it has all of the force."""
    plt = pyplot()
    rows = rows_of(file)
    held, gone = held_in(rows)
    surfaces = list(dict.fromkeys(row["surface"] for row in rows))
    figure, panels = plt.subplots(len(surfaces), 4, figsize=(15, 3.1 * len(surfaces) + 0.9), squeeze=False)
    styles = dict(zip(PATTERNS, ("-", "--", ":")))
    for line, surface in zip(panels, surfaces):
        for number, grip in enumerate(GRIPS):
            colour = f"C{number}"
            of = dict(surface=surface, grip=grip)
            for hold, style, text in ((HELD_ON, "-", "held on"), (LET_GO, "--", "let go of at once")):
                line[0].plot(*zip(*gap_line(rows, "excursion_mm", pattern="once", held_ms=hold, patient_mm_per_s=20.0, **of)),
                             color=colour, ls=style, label=f"{grip}, {text}")
            for axes, speed in ((line[1], 0.0), (line[2], 20.0)):
                for pattern in PATTERNS:
                    axes.plot(*zip(*gap_line(rows, "excursion_mm", pattern=pattern, held_ms=held, patient_mm_per_s=speed,
                                             **of)), color=colour, ls=styles[pattern], label=f"{grip}, {pattern}")
                axes.plot(*zip(*gap_line(rows, "excursion_mm", pattern="regular", held_ms=LET_GO, patient_mm_per_s=speed,
                                         **of)), color=colour, lw=4, alpha=0.25, label=f"{grip}, let go of at once")
            for speed, marker in ((0.0, "o"), (20.0, "^")):
                for pattern in PATTERNS:
                    line[3].plot(*zip(*gap_line(rows, "whole_percent", pattern=pattern, held_ms=held,
                                                patient_mm_per_s=speed, **of)), color=colour, ls=styles[pattern],
                                 marker=marker, ms=3.5, lw=1)
                line[3].plot(*zip(*gap_line(rows, "whole_percent", pattern="regular", held_ms=LET_GO,
                                            patient_mm_per_s=speed, **of)), color=colour, lw=4, alpha=0.25)
        for axes in line:
            axes.axvline(held, color="gold", lw=3, zorder=0)
        line[0].set_title(f"{surface}: one gap, patient moves off at 20 mm/s", fontsize=9)
        line[1].set_title(f"{surface}: gaps, patient rests", fontsize=9)
        line[2].set_title(f"{surface}: gaps, patient moves at 20 mm/s", fontsize=9)
        line[3].set_title(f"{surface}: time with whole forces", fontsize=9)
        for axes in line[:3]:
            axes.set_ylabel("farthest from where it would be [mm]", fontsize=8)
            axes.set_ylim(bottom=0)
        line[3].set_ylabel("share of the time [%]", fontsize=8)
    for axes in panels[-1]:
        axes.set_xlabel("from one message to the next [ms]")
    handles, labels = panels[0][1].get_legend_handles_labels()
    for extra in panels[0][0].get_legend_handles_labels()[0]:
        handles.append(extra)
        labels.append(f"one gap: {extra.get_label()}")
    for marker, text in (("o", "patient rests"), ("^", "patient moves at 20 mm/s")):
        handles += panels[0][3].plot([], [], marker=marker, color="grey", ls="none")
        labels.append(text)
    handles += panels[0][3].plot([], [], color="gold", lw=3)
    labels.append(f"as shipped: held for {held:g} ms, gone by {gone:g} ms")
    figure.legend(handles, labels, loc="lower center", ncol=5, fontsize=8)
    figure.tight_layout(rect=(0, 0.95 / figure.get_figheight(), 1, 1))
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


def draw_haptics_response(file, to):
    """Rendered against set stiffness, and how long a new contact takes to be felt."""
    plt = pyplot()
    rows = [row for row in rows_of(file) if row["passivity"] == "1"]
    surfaces = list(dict.fromkeys(row["surface"] for row in rows))
    delays = sorted({row["delay_ms"] for row in rows}, key=float)
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.4))
    for k, surface in enumerate(surfaces):
        for number, delay in enumerate(delays):
            points = sorted((float(row["set_n_per_m"]), float(row["rendered_n_per_m"]) / float(row["set_n_per_m"]))
                            for row in rows if row["surface"] == surface and row["delay_ms"] == delay)
            left.plot(*zip(*points), color=f"C{k}", marker=MARKERS[number], ms=4, lw=0.8,
                      label=f"{surface}, {delay} ms")
        points = sorted({(float(row["delay_ms"]), float(row["onset_ms"])) for row in rows
                         if row["surface"] == surface and row["set_n_per_m"] == "800"})
        right.plot(*zip(*points), color=f"C{k}", marker=MARKERS[k], label=surface)
    left.axhline(1.0, color="black", lw=1)
    left.set(xlabel="stiffness set [N/m]", ylabel="stiffness rendered / set", ylim=(0.8, 1.2))
    right.plot([0, 50], [0, 50], color="black", lw=1, ls="--", label="the delay itself")
    right.set(xlabel="round-trip delay [ms]", ylabel="from touch to 0.05 N [ms], at 50 mm/s")
    right.legend(fontsize=8)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=7)
    figure.tight_layout(rect=(0, 0.16, 1, 1))
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


def draw_haptics_laws(file, to):
    """Force of the device's two laws on the blade that presses the patient's tongue, against finite elements."""
    plt = pyplot()
    rows = rows_of(file)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.4, 4.0))
    reference = sorted({(float(row["depth_mm"]), 1e3 * float(row["reference_n"])) for row in rows})
    left.plot(*zip(*reference), color="lightgrey", lw=5, label="finite elements")
    names = {"constraint": "constraint forces (shipped)", "displacement": "displacements (Xiao et al. 2020)"}
    for number, (law, name) in enumerate(names.items()):
        points = sorted((float(row["depth_mm"]), 1e3 * float(row["force_n"]), 100 * (float(row["force_n"]) /
                         float(row["reference_n"]) - 1)) for row in rows if row["law"] == law)
        left.plot([p[0] for p in points], [p[1] for p in points], marker=MARKERS[number], color=f"C{number}", label=name)
        right.plot([p[0] for p in points], [p[2] for p in points], marker=MARKERS[number], color=f"C{number}", label=name)
    right.axhline(0.0, color="grey", lw=3)
    left.set(xlabel="depth of the blade [mm]", ylabel="force on the blade [mN]", title="the patient's tongue under the blade")
    right.set(xlabel="depth of the blade [mm]", ylabel="error against finite elements [%]")
    from matplotlib.ticker import FixedLocator, FuncFormatter
    right.set_yscale("symlog", linthresh=20)
    right.set_ylim(-30, 700)
    right.yaxis.set_major_locator(FixedLocator([-20, -10, 0, 10, 20, 50, 100, 200, 500]))
    right.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:+g}" if value else "0"))
    right.yaxis.set_minor_locator(FixedLocator([]))
    left.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


HAPTICS = {"stability": draw_haptics_stability, "gaps": draw_haptics_gaps, "rendered": draw_haptics_response, "laws": draw_haptics_laws}


def draw_sleep(file, to):
    """Over an attempt: what the blade feels with and without sleep, their difference, share awake, cost of a step."""
    plt = pyplot()
    rows = rows_of(file)
    models = list(dict.fromkeys((row["scenario"], row["model"]) for row in rows))
    figure, panels = plt.subplots(4, len(models), figsize=(5.2 * len(models), 9.6), squeeze=False, sharex=True)
    for (scenario, model), column in zip(models, panels.T):
        own = [row for row in rows if (row["scenario"], row["model"]) == (scenario, model)]
        time = [float(row["time_s"]) for row in own]

        def line(axes, name, **how):
            axes.plot(time, [float(row[name]) for row in own], **how)

        column[0].set_title(f"{scenario}, {model}", fontsize=9)
        line(column[0], "blade_n", color="lightgrey", lw=4, label="all awake")
        line(column[0], "blade_n_sleep", color="C0", lw=1, label="what rests sleeps")
        column[0].set_ylabel("force on the blade [N]")
        for name, colour, text in (("shape_sleep_rms_mm", "C0", "what rests sleeps"),
                                   ("shape_beside_rms_mm", "C1", "all awake, blade 1 µm beside")):
            line(column[1], name, color=colour, lw=1, label=f"{text}, rms")
        column[1].set_ylabel("tissue off by [mm]")
        column[1].set_yscale("log")
        line(column[2], "awake_percent", color="C0", lw=1)
        column[2].set_ylabel("awake [%]")
        column[2].set_ylim(0, 105)
        line(column[3], "step_ms", color="lightgrey", lw=4, label="all awake")
        line(column[3], "step_sleep_ms", color="C0", lw=1, label="what rests sleeps")
        column[3].set_ylabel("step [ms]")
        column[3].set_ylim(bottom=0)
        column[3].set_xlabel("time of the attempt [s]")
        for axes in (column[0], column[1], column[3]):
            axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(to, metadata={"Date": None})
    plt.close(figure)


def main(folder):
    if (folder / "sleep-course.csv").exists():
        draw_sleep(folder / "sleep-course.csv", folder / "sleep.svg")
    for name, draw_haptics in HAPTICS.items():
        table = folder / f"haptics-{name}.csv"
        if table.exists():
            draw_haptics(table, table.with_suffix(".svg"))
    if (folder / "stability.csv").exists():
        cells = read_maps(folder / "stability.csv")
        for figure in dict.fromkeys(row["figure"] for row in cells):
            draw_maps([row for row in cells if row["figure"] == figure], figure, folder / f"stability-{figure}.svg")
    if (folder / "calibration.csv").exists():
        draw_calibration(folder / "calibration.csv", folder / "calibration.svg")
    if not (folder / "accuracy.csv").exists():
        return
    rows = read(folder / "accuracy.csv")
    for case in dict.fromkeys(row["case"] for row in rows):
        draw([row for row in rows if row["case"] == case], TITLES[case], folder / f"accuracy-{case}.svg",
             MEASURES.get(case))
    draw(overall(rows), "all blocks, geometric mean", folder / "accuracy-all.svg")
    if (folder / "accuracy-forces.csv").exists():
        draw_forces(folder / "accuracy-forces.csv", folder / "accuracy-forces.svg")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
