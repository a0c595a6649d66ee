#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Draws the charts of eti-bench: reads its tables in a folder, writes SVG beside them.

Needs Debian's python3-matplotlib. The same tables give the same bytes: varying parts (date, names of clips) are omitted
or fixed. deploy/figures.sh calls this.
"""

import argparse
import sys
from functools import partial
from pathlib import Path

from plot_accuracy import accuracy_figures, calibration_figures
from plot_bus import bus_figures
from plot_haptics import haptics_figures
from plot_soak import soak_figures
from plot_stability import stability_figures
from plotting import pyplot, rows_of, save


def draw_sleep(file, to):
    """Over an attempt: force on the blade with and without sleep, their difference, share awake, cost of a step."""
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
    save(figure, to)


def sleep_figures(folder):
    if (folder / "sleep-course.csv").exists():
        yield folder / "sleep.svg", partial(draw_sleep, folder / "sleep-course.csv")


# By measurement of eti-bench: from a folder with tables, (file to draw, function that draws into a file).
PARTS = {"accuracy": accuracy_figures, "calibration": calibration_figures, "stability": stability_figures,
         "sleep": sleep_figures, "haptics": haptics_figures, "bus": bus_figures, "soak": soak_figures}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="where the tables lie")
    parser.add_argument("--only", choices=PARTS, help="the figures of one command")
    parser.add_argument("--list", action="store_true", help="name the figures and draw none")
    wanted = parser.parse_args()
    figures = [figure for part in ([wanted.only] if wanted.only else PARTS) for figure in PARTS[part](wanted.folder)]
    for number, (file, draw_into) in enumerate(figures, 1):
        if wanted.list:
            print(file)
        else:
            print(f"{number}/{len(figures)} {file.name}", file=sys.stderr, flush=True)
            draw_into(file)


if __name__ == "__main__":
    main()
