# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The tongue of a model file as a mesh of its tetrahedra, with elements of any order on them.

The posture moves the mesh, which has no stress in it. Corners without mass or at a link's end are held, as are nodes on
edges and faces between held corners. Lattice, posture and bodies are symmetric in x, and half of them is solved: x >= 0.
Hexahedra in whole cells would be cheaper, but a quadrilateral face and the two triangles of a cut cell beside it have
different shape functions, and fail the patch test.
"""
import h5py
import numpy as np

from finite_elements import ElementBlock, Mesh, gauss_simplex, simplex_basis, simplex_lattice

MM = 1e-3
TONGUE = 1  # Tissue::tongue in a model file
HEAD_ELEVATION, JAW_OPENING = np.radians(26), np.radians(29)  # of the scenario `term`


def posed(model):
    """Posed positions [m] of all particles: the linear blend of trunk, skull and mandible (docs/anatomy)."""
    particles, skeleton = model["particles"], model["skeleton"]
    rest, weights = particles["rest"][:].astype(float), particles["bones"][:].astype(float)

    def about(centre, angle):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        return turn, centre - turn @ centre
    skull, skull_offset = about(skeleton["neck_joint"][:].astype(float), -HEAD_ELEVATION)
    jaw, jaw_offset = about(skeleton["jaw_joint"][:].astype(float), JAW_OPENING)
    jaw_offset = jaw_offset - [0, skeleton.attrs["jaw_slide_m_per_rad"] * JAW_OPENING, 0]
    poses = [rest, rest @ skull.T + skull_offset, (rest @ jaw.T + jaw_offset) @ skull.T + skull_offset]
    return sum(weights[:, b:b + 1] * pose for b, pose in enumerate(poses))


class TongueModel:
    """Half of the tongue's lattice: posed corners [m], which are held, and right-handed tetrahedra."""

    def __init__(self, path):
        with h5py.File(path) as model:
            tissue = model["particles/tissue"][:]
            mine = np.flatnonzero(tissue == TONGUE)
            number = np.full(len(tissue), -1)
            number[mine] = np.arange(len(mine))
            self.place = posed(model)[mine]
            rest = model["particles/rest"][:].astype(float)[mine]
            spacing = 2 * float(model["particles/radius"][mine[0]])
            self.held = model["particles/mass"][:][mine] == 0
            ends = number[model["links/ends"][:].ravel()]
            self.held[ends[ends >= 0]] = True
            corners = model["tetrahedra/corners"][:]
        corners = number[corners[(tissue[corners] == TONGUE).all(axis=1)]]
        self.held[np.setdiff1d(np.arange(len(mine)), corners)] = True
        self.plane = np.rint(rest[:, 0] / spacing).astype(int)  # of the lattice in x
        if np.abs(rest[:, 0] / spacing - self.plane).max() > 1e-3:
            raise ValueError(f"{path}: the tongue's particles lie on no lattice with a plane at x = 0")
        self.place[self.plane == 0, 0] = 0
        corners = corners[self.plane[corners].min(axis=1) >= 0]
        edges = self.place[corners[:, 1:]] - self.place[corners[:, :1]]
        left = np.linalg.det(edges) < 0
        corners[left] = corners[left][:, [0, 1, 3, 2]]
        self.tetrahedra = corners


class TongueMesh(Mesh):
    """Elements of order p on a TongueModel. `corner` [n] is the model's corner at a node, or -1; `held` [n]; `surface`
    [f, a] are the faces that belong to one tetrahedron, and neither lie on the mid plane nor are held."""

    def __init__(self, model, order):
        self.order = order
        lattice = simplex_lattice(order, 3)
        found, weights = {}, []
        conn = np.empty((len(model.tetrahedra), len(lattice)), int)
        for e, corners in enumerate(model.tetrahedra):
            for a, share in enumerate(lattice):
                key = tuple(sorted((c, s) for c, s in zip(corners, share) if s))
                if key not in found:
                    found[key] = len(weights)
                    weights.append(key)
                conn[e, a] = found[key]
        place = np.array([sum(s * model.place[c] for c, s in key) / order for key in weights])
        self.held = np.array([all(model.held[c] for c, _ in key) for key in weights])
        self.corner = np.array([key[0][0] if len(key) == 1 else -1 for key in weights])
        points, scale = gauss_simplex(order, 3)
        # Pairs of continuous displacements and discontinuous pressures on tetrahedra are unstable or of low order.
        block = ElementBlock(place, conn, simplex_basis(order, points), scale, None)
        super().__init__(place, [block])
        faces = np.concatenate([conn[:, lattice[:, v] == 0] for v in range(4)])
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        faces = faces[first[count == 1]]
        self.surface = faces[(place[faces, 0] > 1e-9).any(axis=1) & ~self.held[faces].all(axis=1)]

    def interpolated(self, coarse, x):
        """Displacement [n, 3] at this mesh's nodes of a solution of lower order on the same tetrahedra."""
        moved = np.zeros_like(self.nodes)
        basis, _ = simplex_basis(coarse.order, simplex_lattice(self.order, 3)[:, 1:] / self.order)
        moved[self.blocks[0].conn] = np.einsum("ac,eci->eai", basis, (x - coarse.nodes)[coarse.blocks[0].conn])
        return moved
