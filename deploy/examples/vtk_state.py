# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Reads the files of surface_reader: legacy VTK, ASCII, one point set with its attributes."""

import re

import numpy

NUMBERS_OF = {"POINTS": 3, "POLYGONS": 4, "VERTICES": 2, "SCALARS": 1}


class State:
    """`points` [m], `triangles` (three points each), and attributes of points or triangles by name."""

    def __init__(self, path):
        lines = path.read_text().splitlines()
        self.time_ns = int(re.search(r"simulation time (\d+) ns", lines[1]).group(1))
        self.points = self.triangles = None
        self.values, self.objects = {}, None
        rows, line = 0, 3
        while line + 1 < len(lines):
            line += 1
            word, *rest = lines[line].split()
            if word in ("CELL_DATA", "POINT_DATA"):
                rows = int(rest[0])
            elif word == "FIELD":
                self.objects = numpy.array(lines[line + 2:line + 2 + rows])
                line += 1 + rows
            elif word in NUMBERS_OF:
                count = rows if word == "SCALARS" else int(rest[0])
                line += word == "SCALARS"
                block = " ".join(lines[line + 1:line + 1 + count])
                table = numpy.fromstring(block, sep=" ").reshape(count, NUMBERS_OF[word])
                line += count
                if word == "POINTS":
                    self.points = table
                elif word == "POLYGONS":
                    self.triangles = table[:, 1:].astype(int)
                elif word == "SCALARS":
                    self.values[rest[0]] = table[:, 0]
            else:
                raise ValueError(f"{path}:{line + 1}: {word}; expected a file of surface_reader")
