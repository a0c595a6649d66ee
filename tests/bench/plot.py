#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Draws the charts of eti-bench: reads its tables in a folder, writes SVG beside them.

Needs Debian's python3-matplotlib. The same tables give the same bytes: varying parts (date, names of clips) are omitted
or fixed. deploy/figures.sh calls this.
"""

import argparse
import sys
from pathlib import Path

from plot_accuracy import accuracy_figures, calibration_figures
from plot_haptics import haptics_figures
from plot_stability import stability_figures


# By measurement of eti-bench: from a folder with tables, (file to draw, function that draws into a file).
PARTS = {"accuracy": accuracy_figures, "calibration": calibration_figures, "stability": stability_figures,
         "haptics": haptics_figures}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of the tables")
    parser.add_argument("--only", choices=PARTS, help="the figures of one command")
    parser.add_argument("--list", action="store_true", help="list the figures without drawing them")
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
