#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Draws the output of surface_reader: the head's surfaces from the side, its particles by tissue, and a section.

Needs Debian's python3-matplotlib. Usage: draw_state.py FOLDER PICTURE.png
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy  # noqa: E402
from matplotlib import pyplot  # noqa: E402

from vtk_state import State  # noqa: E402

# Numbered as in common/model/tissue.hpp.
TISSUES = {0: ("soft tissue", "#d9a38f"), 1: ("tongue", "#c0392b"), 2: ("epiglottis", "#f1c40f"),
           3: ("larynx", "#2980b9"), 6: ("upper gum", "#8e44ad"), 7: ("lower gum", "#27ae60"), 8: ("palate", "#e67e22")}
LIGHT = numpy.array([0.75, -0.35, 0.55])  # to the light; x to the patient's left, y to the back, z to the crown
HALF_SLICE = 1.5e-3  # [m]
PIXELS_PER_METRE = 5000


def draw_surface(axes, points, triangles):
    """View from the patient's left, shaded; the nearest triangle wins in each pixel."""
    low, high = points[:, 1:].min(axis=0), points[:, 1:].max(axis=0)
    across, up = numpy.ceil((high - low) * PIXELS_PER_METRE).astype(int) + 1
    depth, shade = numpy.full((up, across), -numpy.inf), numpy.full((up, across), numpy.nan)
    corners = points[triangles]
    normal = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= numpy.linalg.norm(normal, axis=1, keepdims=True) + 1e-20
    bright = 0.35 + 0.65 * numpy.clip(normal @ (LIGHT / numpy.linalg.norm(LIGHT)), 0, 1)
    for triangle in numpy.flatnonzero(normal[:, 0] > 1e-3):
        place = (corners[triangle, :, 1:] - low) * PIXELS_PER_METRE
        first = numpy.floor(place.min(axis=0)).astype(int)
        last = numpy.ceil(place.max(axis=0)).astype(int) + 1
        y, z = numpy.meshgrid(numpy.arange(first[0], last[0]), numpy.arange(first[1], last[1]))
        a, b = place[1] - place[0], place[2] - place[0]
        area = a[0] * b[1] - a[1] * b[0]
        u = ((y - place[0, 0]) * b[1] - (z - place[0, 1]) * b[0]) / area
        v = (a[0] * (z - place[0, 1]) - a[1] * (y - place[0, 0])) / area
        inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
        x = corners[triangle, :, 0] @ numpy.stack([1 - u - v, u, v]).reshape(3, -1)
        near = inside & (x.reshape(u.shape) > depth[first[1]:last[1], first[0]:last[0]])
        depth[first[1]:last[1], first[0]:last[0]][near] = x.reshape(u.shape)[near]
        shade[first[1]:last[1], first[0]:last[0]][near] = bright[triangle]
    picture = numpy.ones((up, across, 4))
    picture[..., :3] = shade[..., None] * numpy.array([0.93, 0.76, 0.68])
    picture[numpy.isnan(shade)] = 0
    axes.imshow(picture, origin="lower", extent=1e3 * numpy.array([low[0], high[0], low[1], high[1]]))


def draw_cut(axes, points, triangles, colour):
    """Section of the triangles with the plane x = 0."""
    corners = points[triangles]
    ends = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        xa, xb = corners[:, a, 0], corners[:, b, 0]
        meets = (xa < 0) != (xb < 0)
        part = numpy.where(meets, xa / numpy.where(meets, xa - xb, 1), numpy.nan)[:, None]
        ends.append(corners[:, a, 1:] + part * (corners[:, b, 1:] - corners[:, a, 1:]))
    ends = numpy.stack(ends, axis=1)
    meets = numpy.isfinite(ends).all(axis=2).sum(axis=1) == 2
    lines = ends[meets][numpy.isfinite(ends[meets]).all(axis=2)].reshape(-1, 2, 2)
    for line in lines:
        axes.plot(1e3 * line[:, 0], 1e3 * line[:, 1], color=colour, lw=0.8)


def main(folder, picture):
    surfaces, particles = State(folder / "surfaces.vtk"), State(folder / "particles.vtk")
    tissue = particles.values["tissue"].astype(int)
    of_object = {name: surfaces.triangles[surfaces.objects[surfaces.triangles[:, 0]] == name]
                 for name in dict.fromkeys(surfaces.objects)}
    figure, (side, cut) = pyplot.subplots(1, 2, figsize=(11, 6.2), sharex=True, sharey=True)

    draw_surface(side, surfaces.points, of_object["body"])
    side.set_title(f"{len(surfaces.points)} vertices of {len(of_object)} surfaces: the skin", fontsize=9)
    for name, triangles in of_object.items():
        bone = name in ("skull", "mandible", "spine", "hyoid")
        draw_cut(cut, surfaces.points, triangles, "0.55" if bone else "black")
    slice_ = numpy.abs(particles.points[:, 0]) < HALF_SLICE
    for number, (name, colour) in TISSUES.items():
        own = particles.points[slice_ & (tissue == number)]
        cut.scatter(1e3 * own[:, 1], 1e3 * own[:, 2], s=5, color=colour, label=f"{name} ({(tissue == number).sum()})")
    cut.set_title(f"midline section: surfaces, and particles within {1e3 * HALF_SLICE:.1f} mm, by tissue", fontsize=9)
    cut.legend(fontsize=7, loc="lower right", title="particles, of all", title_fontsize=7)
    for axes in (side, cut):
        axes.set_aspect("equal")
        axes.set_xlabel("posterior [mm]")
    low, high = 1e3 * surfaces.points[:, 1:].min(axis=0) - 5, 1e3 * surfaces.points[:, 1:].max(axis=0) + 5
    side.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    side.set_ylabel("superior [mm]")
    figure.suptitle(f"One state at {surfaces.time_ns / 1e9:.2f} s, read by another vendor's DDS", fontsize=10)
    figure.tight_layout()
    figure.savefig(picture, dpi=110, metadata={"Software": None})


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2])
