#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Writes the outer shape of a newborn's whole body as C++ source, from MakeHuman's data (CC0).

Output: vertices of a term newborn and displacements to one of 28 weeks, in the generator's model coordinates (x left,
y anterior, z superior; millimetres of a 3.5 kg newborn), lying on the back with flexed limbs, lids and mouth closed; a
closed surface. Body proportions were fitted once to published ones: length 50 and 37 cm, weight 3.4 and 1.1 kg,
circumference of head 35 and 26 cm and of chest 33 and 22.5 cm, crown to rump 34 and 25 cm, hands 64 and 45 mm, feet 78
and 53 mm.
"""
import argparse
import hashlib
import pathlib
import sys

import numpy as np

from makehuman import BODY, Base, mirrored, rotation

UNIT_MM = 0.0125  # of the written integers


class Newborn:
    """Fitted shape. `cranium`: circumference of the head, as placed, relative to 35.2 cm, the standard cranium's.

    The last five scale bones: head, legs, trunk across, arms, and the trunk's depth.
    """

    def __init__(self, weight_kg, cranium, muscle, height, fat, size, head, legs, shoulders, arms, depth):
        self.weight_kg, self.cranium = weight_kg, cranium
        self.muscle, self.height, self.fat, self.size = muscle, height, fat, size
        self.head, self.legs, self.shoulders, self.arms, self.depth = head, legs, shoulders, arms, depth


TERM = Newborn(3.4, 1.05, 0.5, 0.024, 0.465, 1.124, 0.937, 1.011, 0.991, 0.991, 0.983)
PRETERM = Newborn(1.1, 1.134, 0.1, 0.159, 0.322, 0.759, 0.997, 0.908, 0.951, 0.931, 0.952)

FACE = {  # targets, on top of the youngest face that MakeHuman has
    "eyes/{}-eye-trans-in": 0.75,
    "mouth/mouth-scale-horiz-decr": 0.75,
    "mouth/mouth-trans-down": 0.35,
    "ears/{}-ear-scale-incr": 0.45,
    "chin/chin-prognathism-decr": 0.3,
}

# Midpoints of the inner edge of the upper and lower lip, and a vertex of the mouth's interior.
UPPER_LIP, LOWER_LIP, IN_MOUTH = 474, 493, 554
LIP_RING = 38  # vertices of the closed loop of edges through both

# Where the body lies in model coordinates: centre between the lips, pitch, and size relative to a newborn of equal
# weight. Found by keeping bones and airway of the generator beneath the skin.
STOMION = np.array([0.0, 53.0, -9.8])
PITCH_DEG, SIZE = 2.5, 1.04
EAR_MM = 0.5  # added on either side


def face_bones(base):
    prefixes = ("levator", "oris", "special", "orbic", "oculi", "tempo", "risor", "tongue", "eye")
    return [b for b in base.bones if b in ("head", "jaw") or b.startswith(prefixes)]


def shape_of(base, newborn):
    shape = base.baby(newborn.height, newborn.fat, newborn.muscle)
    head = base.share(face_bones(base))[:BODY] > 0.5
    # Face targets are made for an adult's head.
    size = np.ptp(shape[:BODY][head][:, 1]) / np.ptp(base.vertices[:BODY][head][:, 1])
    for name, amount in FACE.items():
        for side in "lr" if "{}" in name else " ":
            shape = shape + amount * size * base.target(name.format(side))
    factors = {"root": (1, 1, 1), "head": (newborn.head,) * 3, "neck01": (1, 1, 1)}
    for side in (".L", ".R"):
        factors["upperleg01" + side] = (newborn.legs,) * 3
        factors["upperarm01" + side] = (newborn.arms,) * 3
        factors["clavicle" + side] = (newborn.shoulders, 1, 1)
    for bone in ("spine05", "spine04", "spine03", "spine02"):
        factors[bone] = (newborn.depth, 1, newborn.depth)
    factors["spine01"] = (newborn.shoulders, 1, newborn.depth)
    shape = base.scaled(shape, factors) * newborn.size
    size = np.ptp(shape[:BODY][head][:, 1]) / np.ptp(base.vertices[:BODY][head][:, 1])
    for lid in ("eyeBlinkLeft", "eyeBlinkRight"):
        shape = shape + size * base.target(lid)
    return shape


def unit(v):
    return v / np.linalg.norm(v)


def supine(base, shape):
    """Flexed limbs: thighs apart, feet on the table, forearms raised beside the chest, loose fists."""
    heads, turns = base.heads(shape), {}
    for end, side in ((".L", 1.0), (".R", -1.0)):
        turns["upperleg01" + end] = mirrored(
            rotation((0, 1, 0), 42) @ rotation((0, 0, 1), 14) @ rotation((1, 0, 0), -58), side
        )
        turns["lowerleg01" + end] = mirrored(rotation((1, 0, 0), 92), side)
        turns["foot" + end] = mirrored(rotation((1, 0, 0), 18), side)
        turns["upperarm01" + end] = mirrored(rotation((0, 0, 1), -14) @ rotation((0, 1, 0), 22), side)
        forearm = unit(np.diag([side, 1, 1]) @ (heads["wrist" + end] - heads["lowerarm01" + end]))
        raised = np.array([0.45, 0.7, 0.3])
        turns["lowerarm01" + end] = mirrored(rotation(np.cross(forearm, raised), 74), side)
        for finger in range(1, 6):
            bones = [f"finger{finger}-{k}{end}" for k in (1, 2, 3)]
            axis = np.cross(unit(heads[bones[1]] - heads[bones[0]]), unit(heads[bones[2]] - heads[bones[1]]))
            angles = (6, 22, 25) if finger == 1 else np.array((38, 48, 34)) + 4 * (finger - 3)
            for bone, angle in zip(bones, angles):
                turns[bone] = rotation(axis, angle)
    return base.posed(shape, turns)


def lip_ring(base):
    """Vertices of the loop of quad edges around the inner lips, and those behind it."""
    faces_of, next_to = {}, {}
    for face, quad in enumerate(base.quads):
        corners = list(dict.fromkeys(quad))
        for a, b in zip(corners, corners[1:] + corners[:1]):
            next_to.setdefault(a, set()).add(b)
            next_to.setdefault(b, set()).add(a)
            faces_of.setdefault(frozenset((a, b)), set()).add(face)
    for second in sorted(v for v in next_to[UPPER_LIP] if base.vertices[v, 0] > 1e-3):
        ring = [UPPER_LIP, second]
        while len(next_to[ring[-1]]) == 4:
            before, last = ring[-2:]
            beside = faces_of[frozenset((before, last))]
            onward = [v for v in next_to[last] if v != before and not faces_of[frozenset((last, v))] & beside]
            if len(onward) != 1 or onward[0] == UPPER_LIP:
                break
            ring.append(onward[0])
        if len(ring) == LIP_RING and LOWER_LIP in ring:
            break
    else:
        sys.exit("bake.py: the base mesh has no loop of edges through both lips: another mesh than expected")
    inside, border = {IN_MOUTH}, [IN_MOUTH]
    while border:
        for v in next_to[border.pop()]:
            if v not in inside and v not in ring:
                inside.add(v)
                border.append(v)
    return ring, inside


def closed_triangles(base):
    """Triangles [m, 3] of the body, without the mouth's interior, which a fan about vertex `BODY` closes."""
    ring, inside = lip_ring(base)
    quads = base.quads[~np.isin(base.quads, list(inside)).any(1)]
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    triangles = triangles[(triangles[:, 1] != triangles[:, 2]) & (triangles[:, 0] != triangles[:, 2])]
    edges = {(a, b) for t in triangles for a, b in zip(t, np.roll(t, -1))}
    fan = []
    for a, b in zip(ring, ring[1:] + ring[:1]):
        # Opposite to the edge's direction in the remaining triangle.
        fan.append([b, a, BODY] if (a, b) in edges else [a, b, BODY])
    return np.concatenate([triangles, fan]), ring


def standard_cranium(points, size):
    """As to_standard_cranium() of head.cpp: the generator lets the cranium grow again."""
    floor, axis_y = 26.0, -18.0
    above = np.maximum(points[:, 2] - floor, 0.0)
    share = np.clip(above / 22.0, 0.0, 1.0)
    wide = 1 + (size - 1) * share * share * (3 - 2 * share)
    lower = (1 - 1 / size) * above * above / (above + 12.0)
    return np.stack([points[:, 0] / wide, axis_y + (points[:, 1] - axis_y) / wide, points[:, 2] - lower], 1)


def to_model(base, newborn, shape, ring):
    """Model coordinates [mm] of the body's vertices and of the centre between the lips; eyes as (centre, radius)."""
    axes = shape[:, [0, 2, 1]] * 100.0 * (3.5 / newborn.weight_kg) ** (1 / 3)
    lips = 0.5 * (axes[UPPER_LIP] + axes[LOWER_LIP])
    placed = SIZE * (axes - lips) @ rotation((1, 0, 0), PITCH_DEG).T + STOMION
    eyes = []
    for eye in base.helpers.values():
        centre = 0.5 * (placed[eye].min(0) + placed[eye].max(0))
        # Less than the eyeball, so that it stays behind the line between the lids.
        eyes.append((centre, 0.47 * np.ptp(placed[eye][:, 0])))
    skin = np.vstack([placed[:BODY], placed[ring].mean(0)])
    return standard_cranium(skin, newborn.cranium), eyes


def thicker_ears(base, points, triangles):
    """Moves the skin of the auricles outwards, to cartilage of a newborn's thickness."""
    normals = np.zeros_like(points)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    for k in range(3):
        np.add.at(normals, triangles[:, k], np.cross(b - a, c - a))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    moved = sum(np.linalg.norm(base.target(f"ears/{side}-ear-wing-incr"), axis=1)[:BODY] for side in "lr")
    share = np.append(np.clip(2.0 * moved / moved.max(), 0.0, 1.0), 0.0)
    return points + EAR_MM * share[:, None] * normals


def numbers(values, per_line=24):
    text = [str(int(v)) for v in np.asarray(values).ravel()]
    return ",\n".join(",".join(text[i : i + per_line]) for i in range(0, len(text), per_line))


def bake(archive):
    base = Base(archive)
    triangles, ring = closed_triangles(base)
    # The order of the axes is another than MakeHuman's, which mirrors: turn the triangles round.
    triangles = triangles[:, ::-1]
    (term, eyes), (preterm, _) = (
        to_model(base, n, supine(base, shape_of(base, n)), ring) for n in (TERM, PRETERM)
    )
    # The generator's bones and lips keep a term newborn's proportions at every age, and so does the head.
    face = np.append(base.share(face_bones(base))[:BODY], 1.0)[:, None]
    preterm = preterm + face * (term - preterm)
    term, preterm = (thicker_ears(base, points, triangles) for points in (term, preterm))
    used, triangles = np.unique(triangles, return_inverse=True)
    return term[used], preterm[used], triangles.reshape(-1, 3), eyes


def source(term, preterm, triangles, eyes):
    quantised = np.rint(term / UNIT_MM)
    change = np.rint(preterm / UNIT_MM) - quantised
    if max(np.abs(quantised).max(), np.abs(change).max()) > 32767 or len(term) > 65535:
        sys.exit("bake.py: the body does not fit into 16-bit integers")
    rows = ["{{%s}, %.4ff}" % (", ".join("%.4ff" % x for x in centre), radius) for centre, radius in eyes]
    return f"""// SPDX-License-Identifier: CC0-1.0
// Made by server/patient/newborn/body/bake.py from MakeHuman's base mesh and targets (CC0).
#include "server/patient/newborn/body/body_data.hpp"
namespace eti::patient {{
namespace {{
constexpr std::int16_t term[] = {{{numbers(quantised)}}};
constexpr std::int16_t preterm_change[] = {{{numbers(change)}}};
constexpr std::uint16_t triangles[] = {{{numbers(triangles)}}};
constexpr BodyEye eyes[] = {{{", ".join(rows)}}};
}}  // namespace
BodyData body_data() {{ return {{term, preterm_change, triangles, eyes}}; }}
}}  // namespace eti::patient
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("archive", type=pathlib.Path, help="wheel with MakeHuman's data")
    parser.add_argument("output", type=pathlib.Path, help="C++ source to write")
    parser.add_argument("--sha256", help="digest that the archive must have")
    options = parser.parse_args()
    digest = hashlib.sha256(options.archive.read_bytes()).hexdigest()
    if options.sha256 and digest != options.sha256:
        sys.exit(f"bake.py: {options.archive} has SHA-256 {digest}, expected {options.sha256}: remove it, and configure again")
    options.output.write_text(source(*bake(options.archive)))


if __name__ == "__main__":
    main()
