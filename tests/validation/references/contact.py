# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Frictionless contact of a mesh's surface with rigid bodies, as a penalty at Gauss points of the faces.

The energy is k/2 times the squared penetration per area at rest, k [Pa/m]. A pressure p lets the body in by p/k.
"""
import numpy as np

from finite_elements import gauss_cube, gauss_simplex, line_basis, simplex_basis

STIFFNESS = 4e9  # chosen: 10 kPa of pressure penetrates by 2.5 um


class Sphere:
    def __init__(self, centre, radius):
        self.centre, self.radius = np.asarray(centre, float), radius

    def distance(self, x):
        """Signed distance, its gradient and its second derivative at points [..., 3]."""
        return _round(x - self.centre, self.radius, np.eye(3))


class Capsule:
    """All points within `radius` of the segment a-b."""

    def __init__(self, a, b, radius):
        self.a, self.b, self.radius = np.asarray(a, float), np.asarray(b, float), radius

    def distance(self, x):
        along = self.b - self.a
        share = (x - self.a) @ along / (along @ along)
        nearest = self.a + np.clip(share, 0, 1)[..., None] * along
        across = np.eye(3) - np.outer(along, along) / (along @ along)
        beside = ((share > 0) & (share < 1))[..., None, None]
        return _round(x - nearest, self.radius, np.where(beside, across, np.eye(3)))


class HalfSpace:
    """All points below the plane through `point` with the unit `normal`."""

    def __init__(self, point, normal):
        self.point, self.normal = np.asarray(point, float), np.asarray(normal, float)

    def distance(self, x):
        return (x - self.point) @ self.normal, np.broadcast_to(self.normal, x.shape), np.zeros(x.shape + (3,))


def _round(offset, radius, across):
    length = np.linalg.norm(offset, axis=-1)
    normal = offset / length[..., None]
    curvature = (across - normal[..., :, None] * normal[..., None, :]) / length[..., None, None]
    return length - radius, normal, curvature


def box_faces(mesh, axis, value):
    """Faces [f, a] of a Box on the plane where the rest coordinate `axis` equals `value`."""
    block = mesh.blocks[0]
    side = mesh.order + 1
    local = np.arange(side ** 3).reshape(side, side, side)
    low, high = np.take(local, 0, axis).ravel(), np.take(local, mesh.order, axis).ravel()
    faces = [block.conn[:, corners] for corners in (low, high)]
    return np.concatenate([f[np.abs(mesh.nodes[f, axis] - value).max(axis=1) < 1e-9] for f in faces])


def quadrilateral_rule(order, count=None):
    """Shape functions [q, a], gradients by two local coordinates [q, a, 2] and weights of a face of order p."""
    points, weights = gauss_cube(count or order + 3, 2)
    (n0, d0), (n1, d1) = (line_basis(order, points[:, axis]) for axis in range(2))
    product = lambda a, b: np.einsum("qi,qj->qij", a, b).reshape(len(points), -1)
    return product(n0, n1), np.stack([product(d0, n1), product(n0, d1)], axis=-1), weights


def triangle_rule(order, count=None):
    """The same for triangles of order p."""
    points, weights = gauss_simplex(count or order + 3, 2)
    return *simplex_basis(order, points), weights


class RigidContact:
    """Contact of faces [f, a] with a body that has distance(), at the points of a rule for faces of their kind."""

    def __init__(self, nodes, faces, rule, body=None, stiffness=STIFFNESS):
        self.faces, self.body, self.stiffness = faces, body, stiffness
        self.shape, slopes, weights = rule
        tangents = np.einsum("qad,fai->dfqi", slopes, nodes[faces])
        self.area = np.linalg.norm(np.cross(*tangents), axis=-1) * weights
        self.dofs = (3 * faces[:, :, None] + np.arange(3)).reshape(len(faces), -1)

    def evaluate(self, x, _material, tangent, positive):
        """Energy, gradient [f, 3a] and stiffness [f, 3a, 3a], in the manner of ElementBlock.evaluate()."""
        distance, normal, curvature = self.body.distance(self.shape @ x[self.faces])
        depth = np.maximum(-distance, 0)
        pressure = self.stiffness * self.area * depth
        gradient = np.einsum("fqi,qa->fai", -pressure[..., None] * normal, self.shape).reshape(len(self.faces), -1)
        energy = 0.5 * np.sum(pressure * depth)
        if not tangent:
            return energy, gradient, None
        count = self.shape.shape[1]
        matrices = np.zeros((len(self.faces), 3 * count, 3 * count))
        touching = np.flatnonzero((depth > 0).any(axis=1))
        n = normal[touching]
        hessian = (self.stiffness * self.area * (depth > 0))[touching, :, None, None] * n[..., :, None] * n[..., None, :]
        if not positive:
            hessian -= pressure[touching, :, None, None] * curvature[touching]
        matrices[touching] = np.einsum("qa,fqij,qb->faibj", self.shape, hessian, self.shape,
                                       optimize=True).reshape(len(touching), 3 * count, 3 * count)
        return energy, gradient, matrices

    def force(self, x):
        """Force [N] of the surface on the body."""
        _, gradient, _ = self.evaluate(x, None, False, False)
        return gradient.reshape(-1, 3).sum(axis=0)
