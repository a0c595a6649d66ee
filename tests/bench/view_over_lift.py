#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Visible share of the glottis over the lift of the blade. Writes a table, and prints the steepness of its slope.

The expert's laryngoscope goes beneath the epiglottis, stops there, and lifts slowly over the expert's whole lift; no
tube is used. Needs python3-h5py and python3-yaml.
"""

import argparse
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy
import yaml

ROOT = Path(__file__).resolve().parents[2]
LIFTS = ({"lift_mm": 9, "pitch_deg": 12, "pivot": "upper_gum"}, {"lift_mm": 8})  # the expert's two lifts, at full length
SCENARIOS = "term", "premature"
GRID = 0.5  # [mm], of the table
COLUMNS = ("scenario", "speed_mm_per_s", "blade_mm", "view_percent", "tissue_n", "shell_n")


def slow_lift(speed):
    """The expert's script until the blade rests beneath the epiglottis, and then the lift at `speed` [mm/s]."""
    script = yaml.safe_load((ROOT / "deploy/data/operators/expert.yaml").read_text(encoding="utf-8"))
    stages = script["laryngoscope"]
    before = next(i for i, stage in enumerate(stages) if stage["stage"] == "lift")
    script["laryngoscope"] = [*stages[:before], {"stage": "stand", "keep": True, "hold_s": 1.5},
                              *({"stage": "lift", "keep": True, "speed_mm_per_s": speed, **lift} for lift in LIFTS)]
    script["tube"] = [{key: script["tube"][0][key] for key in ("stage", "tip", "axis")}]
    return yaml.safe_dump(script, sort_keys=False)


def turned(quaternion, vector):
    w, axis = quaternion[:, :1], quaternion[:, 1:]
    across = 2.0 * numpy.cross(axis, vector)
    return vector + w * across + numpy.cross(axis, across)


class Lift:
    """A recorded lift, relative to the blade's initial position."""

    def __init__(self, path):
        with h5py.File(path) as file:
            view = file["metrics/glottic_opening_now"][:].astype(float)
            pose = file["tools/proxy_pose"][:].astype(float)
            length = file["scene/laryngoscope"].attrs["blade_length_m"]
            forces = [numpy.linalg.norm(file[f"tools/{name}_force"][:], axis=1) for name in ("tissue", "shell")]
            names = list(file["scene/landmarks/name"].asstr())
            marks = file["tissue/landmarks"][:].astype(float)
            eye = file["metrics/eye_used"][:].astype(float)
        tip = 1e3 * (pose[:, :3] + turned(pose[:, 3:], numpy.array([[0.0, 0.0, length]])))
        # The start is where it moves least within a second, before anything is visible.
        seen = int(numpy.argmax(view > 0.0))
        stood = int(numpy.argmin(numpy.linalg.norm(tip[180:seen] - tip[:seen - 180], axis=1))) + 180
        ends = int(numpy.argmax(numpy.linalg.norm(tip[stood:] - tip[stood], axis=1))) + stood + 1
        self.rows = slice(stood, ends)
        self.lifted = numpy.linalg.norm(tip[self.rows] - tip[stood], axis=1)
        self.columns = [values[self.rows] for values in (view, *forces)]
        opening = marks[:, names.index("glottis_anterior")] - marks[:, names.index("glottis_posterior")]
        sight = eye - marks[:, names.index("glottis")]
        sight /= numpy.linalg.norm(sight, axis=1, keepdims=True)
        foreshortened = opening - (opening * sight).sum(axis=1, keepdims=True) * sight
        half = stood + int(numpy.argmax(self.columns[0] >= 50.0))
        self.opening, self.foreshortened = (1e3 * numpy.linalg.norm(v[half]) for v in (opening, foreshortened))

    def first(self, percent):
        """The lift at which that much is first visible [mm]."""
        return self.lifted[numpy.argmax(self.columns[0] >= percent)]

    def table(self):
        for at in numpy.arange(0.0, self.lifted.max(), GRID):
            near = numpy.abs(self.lifted - at) < GRID / 4
            if near.any():
                yield [round(at, 1), *(round(float(values[near].mean()), 2) for values in self.columns)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", default=ROOT / "build/release/bin/eti-server", type=Path)
    parser.add_argument("--out", required=True, type=Path, help="the table, as CSV")
    parser.add_argument("--speed", action="append", type=float, help="of the lift [mm/s]; may be repeated; 2")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, options.out.open("w", newline="", encoding="utf-8") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(COLUMNS)
        for speed in options.speed or [2.0]:
            script = Path(folder) / "lift.yaml"
            script.write_text(slow_lift(speed), encoding="utf-8")
            for scenario in SCENARIOS:
                record = Path(folder) / f"{scenario}-{speed:g}.eti.h5"
                subprocess.run([options.server, "--scenario", scenario, "--operator", script, "--fast", "--no-dds",
                                "--record", record], check=True, stdout=subprocess.DEVNULL)
                lift = Lift(record)
                table.writerows([scenario, f"{speed:g}", *row] for row in lift.table())
                print(f"{scenario}, {speed:g} mm/s: 10 % at {lift.first(10):.1f} mm, 50 % at {lift.first(50):.1f} mm, "
                      f"90 % at {lift.first(90):.1f} mm of {lift.lifted.max():.1f} mm; the opening is "
                      f"{lift.opening:.1f} mm long, {lift.foreshortened:.1f} mm of it across the line of sight")
    return 0


if __name__ == "__main__":
    sys.exit(main())
