# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Static finite elements of stable neo-Hookean tissue, independent of the simulator: no code, mesh or element in common.

Energy per rest volume, with F the deformation gradient and J = det F:

    W = mu/2 (tr(F^T F) - 3) + la/2 (J - gamma)^2,   la = mu + lame,   gamma = 1 + mu/la
    mu = E / (2 (1 + nu)),   lame = E nu / ((1 + nu) (1 - 2 nu))

(Smith, de Goes & Kim 2018 without the logarithm; Macklin & Müller 2021.) At rest it linearises to Hooke's law with E and nu.

The volumetric term is, but for a constant, lame/2 (J - 1)^2 + mu (J - 1)^2/2 - mu (J - 1). Elements are Lagrange
hexahedra of any order p on (p+1)^3 Gauss points. In the part with lame, which grows without bound as nu approaches 1/2,
J is projected onto discontinuous polynomials of degree p - 1 in each element, Q_p/P_(p-1): for p = 2 the inf-sup stable
pair of 27 displacement nodes and a linear pressure. The part with mu is integrated at every point; projected as well, it
would leave volume changes that the pressure does not see with a negative stiffness. With `projected=False` every part is
taken at every point, as an independent check.
Tetrahedra of order p fill the cells that a surface cuts. SI units throughout.
"""
import itertools

import numpy as np
from scipy.special import roots_jacobi

from sparse_solver import SymmetricSystem

# d cof(F)_ij / dF_kl = e_ikm e_jln F_mn
_LEVI_CIVITA = np.zeros((3, 3, 3))
for _i, _j, _k in itertools.permutations(range(3)):
    _LEVI_CIVITA[_i, _j, _k] = np.linalg.det(np.eye(3)[[_i, _j, _k]])
_COFACTOR_DERIVATIVE = np.einsum("ikm,jln->ijklmn", _LEVI_CIVITA, _LEVI_CIVITA)
CHUNK = 128  # elements whose matrices are computed together; bounds the memory to some 100 MB


class Material:
    """Stable neo-Hookean solid of Young's modulus `young` [Pa] and Poisson's ratio `nu`."""

    def __init__(self, young, nu):
        self.young, self.nu = young, nu
        self.mu = young / (2 * (1 + nu))
        self.lame = young * nu / ((1 + nu) * (1 - 2 * nu))


def cofactor(f):
    """Cofactor matrix det(F) F^-T of matrices [..., 3, 3]; also defined where F is singular."""
    rows = [np.cross(f[..., (i + 1) % 3, :], f[..., (i + 2) % 3, :]) for i in range(3)]
    return np.stack(rows, axis=-2)


def line_basis(order, t):
    """Values and derivatives [len(t), order + 1] of the Lagrange polynomials on order + 1 equispaced nodes of [-1, 1]."""
    nodes = np.linspace(-1, 1, order + 1)
    coefficients = np.linalg.inv(np.vander(nodes, increasing=True))
    powers = np.vander(t, order + 1, increasing=True)
    slopes = np.zeros_like(powers)
    slopes[:, 1:] = powers[:, :-1] * np.arange(1, order + 1)
    return powers @ coefficients, slopes @ coefficients


def hexahedron_basis(order, points):
    """Shape functions [q, a] and local gradients [q, a, 3]; node (i, j, k) has index (i (p+1) + j) (p+1) + k."""
    (n0, d0), (n1, d1), (n2, d2) = (line_basis(order, points[:, axis]) for axis in range(3))
    product = lambda a, b, c: np.einsum("qi,qj,qk->qijk", a, b, c).reshape(len(points), -1)
    return product(n0, n1, n2), np.stack([product(d0, n1, n2), product(n0, d1, n2), product(n0, n1, d2)], axis=-1)


def gauss_cube(count, dimension=3):
    points, weights = np.polynomial.legendre.leggauss(count)
    grid = np.stack(np.meshgrid(*[points] * dimension, indexing="ij"), -1).reshape(-1, dimension)
    return grid, np.prod(np.stack(np.meshgrid(*[weights] * dimension, indexing="ij"), -1).reshape(-1, dimension), axis=1)


def simplex_lattice(order, dimension):
    """Barycentric nodes [a, dimension + 1] of a simplex of order p, as integers that add up to p."""
    return np.array([b for b in itertools.product(range(order + 1), repeat=dimension + 1) if sum(b) == order])


def simplex_basis(order, points):
    """Shape functions [q, a] and gradients [q, a, d] by the local coordinates (barycentric ones but the first)."""
    dimension = points.shape[1]
    powers = np.array([e for e in itertools.product(range(order + 1), repeat=dimension) if sum(e) <= order])
    monomials = lambda x, e: np.prod(x[:, None, :] ** e[None], axis=-1)
    coefficients = np.linalg.inv(monomials(simplex_lattice(order, dimension)[:, 1:] / order, powers))
    gradients = []
    for axis in range(dimension):
        lowered = powers.copy()
        lowered[:, axis] = np.maximum(powers[:, axis] - 1, 0)
        gradients.append((monomials(points, lowered) * powers[:, axis]) @ coefficients)
    return monomials(points, powers) @ coefficients, np.stack(gradients, axis=-1)


def gauss_simplex(count, dimension):
    """Points of a cube collapsed onto the unit simplex, and weights: Gauss-Jacobi, exact to degree 2 count - 1."""
    points, weights = np.zeros((1, 0)), np.ones(1)
    for axis in range(dimension):
        # A section at u is a simplex of dimension k shrunk by 1 - u.
        power = dimension - 1 - axis
        roots, share = roots_jacobi(count, power, 0)
        left = 1 - points.sum(axis=1)
        step = (left[:, None] * (1 + roots) / 2).ravel()
        points = np.column_stack([np.repeat(points, count, axis=0), step])
        weights = (weights[:, None] * share / 2 ** (power + 1)).ravel()
    return points, weights


class ElementBlock:
    """Elements of one kind. conn [e, a]; gradient [e, a, 3q], by rest coordinates; weight [e, q], rest volume;
    pressure [e, q, m], orthonormal modes of J in each element, or None."""

    def __init__(self, nodes, conn, basis, weights, pressure_degree):
        self.conn = np.asarray(conn)
        self.shape, local = basis
        e, a = self.conn.shape
        q = len(weights)
        corner = nodes[self.conn]
        jacobian = np.einsum("eai,qaj->eqij", corner, local)
        determinant = np.linalg.det(jacobian)
        if determinant.min() <= 0:
            raise ValueError(f"element {determinant.min(axis=1).argmin()} of {e} is inverted at rest; order its corners")
        self.gradient = np.einsum("qaj,eqji->eaqi", local, np.linalg.inv(jacobian)).reshape(e, a, 3 * q)
        self.weight = determinant * weights
        self.pressure = None
        if pressure_degree is not None:
            self.pressure = self._pressure_modes(corner, pressure_degree)
        self.dofs = (3 * self.conn[:, :, None] + np.arange(3)).reshape(e, -1)

    def _pressure_modes(self, corner, degree):
        at = np.einsum("qa,eai->eqi", self.shape, corner)
        middle = corner.mean(axis=1, keepdims=True)
        at = (at - middle) / np.ptp(corner, axis=1)[:, None, :]
        powers = np.array([p for p in itertools.product(range(degree + 1), repeat=3) if sum(p) <= degree])
        modes = np.prod(at[:, :, None, :] ** powers, axis=-1)
        mass = np.einsum("eqm,eq,eqn->emn", modes, self.weight, modes)
        return modes @ np.swapaxes(np.linalg.inv(np.linalg.cholesky(mass)), -1, -2)

    def deformation(self, x):
        """Deformation gradient [e, q, 3, 3] of node positions x [n, 3]."""
        f = np.swapaxes(x[self.conn], -1, -2) @ self.gradient
        return f.reshape(len(f), 3, -1, 3).transpose(0, 2, 1, 3)

    def evaluate(self, x, material, tangent, positive):
        """Energy [J], force gradient [e, 3a] and, with `tangent`, stiffness [e, 3a, 3a]; `positive` projects the
        stiffness onto positive semidefinite matrices."""
        energy, forces, matrices = 0.0, [], []
        for start in range(0, len(self.conn), CHUNK):
            piece = slice(start, start + CHUNK)
            w, g, k = self._evaluate(x[self.conn[piece]], piece, material, tangent, positive)
            energy += w
            forces.append(g)
            matrices.append(k)
        return energy, np.concatenate(forces), np.concatenate(matrices) if tangent else None

    def _evaluate(self, corner, piece, material, tangent, positive):
        gradient, weight = self.gradient[piece], self.weight[piece]
        e, a, q = len(gradient), gradient.shape[1], weight.shape[1]
        f = (np.swapaxes(corner, -1, -2) @ gradient).reshape(e, 3, q, 3).transpose(0, 2, 1, 3)
        c = cofactor(f)
        j = np.einsum("eqij,eqij->eq", f, c) / 3
        energy = material.mu / 2 * np.sum(weight * (np.einsum("eqij,eqij->eq", f, f) - 3))
        excess = j - 1
        smooth = excess
        if self.pressure is not None:
            modes = self.pressure[piece]
            amplitude = np.einsum("eq,eqm->em", weight * excess, modes)
            smooth = np.einsum("em,eqm->eq", amplitude, modes)
        energy += np.sum(weight * (material.lame / 2 * smooth ** 2 + material.mu * (excess ** 2 / 2 - excess)))
        p = material.lame * smooth + material.mu * (excess - 1)
        stress = (material.mu * f + p[..., None, None] * c) * weight[..., None, None]
        force = (gradient @ stress.transpose(0, 1, 3, 2).reshape(e, 3 * q, 3)).reshape(e, -1)
        if not tangent:
            return energy, force, None
        moduli = np.tensordot(f * p[..., None, None], _COFACTOR_DERIVATIVE, axes=([2, 3], [4, 5])).reshape(e, q, 9, 9)
        moduli += material.mu * np.eye(9)
        if positive:
            values, vectors = np.linalg.eigh(moduli)
            moduli = (vectors * np.maximum(values, 0)[..., None, :]) @ np.swapaxes(vectors, -1, -2)
        flat = c.reshape(e, q, 9)
        bulk = material.mu + (material.lame if self.pressure is None else 0.0)
        moduli += bulk * flat[..., :, None] * flat[..., None, :]
        moduli *= weight[..., None, None]
        # K[a i, b j] = sum over q, I, J of gradient[a, q I] moduli[q, i I, j J] gradient[b, q J]
        at_points = gradient.reshape(e, a, q, 3).transpose(0, 2, 3, 1)
        right = (moduli.reshape(e, q, 27, 3) @ at_points).reshape(e, q, 3, 3, 3, a)
        right = right.transpose(0, 1, 3, 2, 4, 5).reshape(e, 3 * q, 9 * a)
        stiffness = (gradient @ right).reshape(e, a, 3, 3, a).transpose(0, 1, 2, 4, 3).reshape(e, 3 * a, 3 * a)
        if self.pressure is not None:
            weighted = np.einsum("eq,eqm,eqij->eqjmi", weight, modes, c).reshape(e, 3 * q, -1)
            volume = (gradient @ weighted).reshape(e, a, -1, 3).transpose(0, 2, 1, 3).reshape(e, -1, 3 * a)
            stiffness += material.lame * np.swapaxes(volume, -1, -2) @ volume
        return energy, force, stiffness


class Mesh:
    """Nodes [n, 3] at rest [m] and their blocks of elements."""

    def __init__(self, nodes, blocks):
        self.nodes, self.blocks = np.asarray(nodes, float), blocks

    def volume_shares(self):
        """Rest volume [n] lumped at nodes consistently: the integral of each shape function."""
        shares = np.zeros(len(self.nodes))
        for block in self.blocks:
            np.add.at(shares, block.conn, np.einsum("qa,eq->ea", block.shape, block.weight))
        return shares

    def determinants(self, x):
        """Least, mean (over volume) and greatest det F over the quadrature points."""
        j = np.concatenate([np.linalg.det(b.deformation(x)).ravel() for b in self.blocks])
        w = np.concatenate([b.weight.ravel() for b in self.blocks])
        return float(j.min()), float(j @ w / w.sum()), float(j.max())


class Box(Mesh):
    """Hexahedra of order p on the grid lines xs, ys, zs [m]."""

    def __init__(self, xs, ys, zs, order=2, projected=True):
        self.lines = [np.asarray(lines, float) for lines in (xs, ys, zs)]
        self.order = order
        fine = [np.interp(np.arange(order * (len(g) - 1) + 1) / order, np.arange(len(g)), g) for g in self.lines]
        nodes = np.stack(np.meshgrid(*fine, indexing="ij"), -1).reshape(-1, 3)
        number = np.arange(len(nodes)).reshape([len(g) for g in fine])
        cells = [range(len(g) - 1) for g in self.lines]
        take = lambda i: slice(order * i, order * i + order + 1)
        conn = np.array([number[take(i), take(j), take(k)].ravel() for i, j, k in itertools.product(*cells)])
        points, weights = gauss_cube(order + 1)
        degree = order - 1 if projected else None
        super().__init__(nodes, [ElementBlock(nodes, conn, hexahedron_basis(order, points), weights, degree)])

    def displacement(self, x, points):
        """Displacement [n, 3] at rest points [n, 3]."""
        index, local = 0, []
        for axis, lines in enumerate(self.lines):
            cell = np.clip(np.searchsorted(lines, points[:, axis], side="right") - 1, 0, len(lines) - 2)
            local.append(2 * (points[:, axis] - lines[cell]) / (lines[cell + 1] - lines[cell]) - 1)
            index = index * (len(lines) - 1) + cell
        shape, _ = hexahedron_basis(self.order, np.stack(local, axis=-1))
        return np.einsum("na,nai->ni", shape, (x - self.nodes)[self.blocks[0].conn[index]])


    def interpolated(self, coarse, x):
        """Displacement [n, 3] at this mesh's nodes of a solution on another mesh of the same body."""
        return coarse.displacement(x, self.nodes)


class NotConverged(RuntimeError):
    """Newton's method did not reach its tolerance."""


class StaticProblem:
    """Equilibrium of a mesh: fixed [n, 3] marks prescribed components, whose values stand in the x handed to solve();
    load [n, 3] are dead forces [N]; contacts add energies of surfaces."""

    def __init__(self, mesh, material, fixed, contacts=()):
        self.mesh, self.material, self.contacts = mesh, material, list(contacts)
        self.fixed = np.asarray(fixed, bool).ravel()
        self.load = np.zeros_like(mesh.nodes)
        self.system = SymmetricSystem([b.dofs for b in mesh.blocks] + [c.dofs for c in self.contacts], ~self.fixed)

    def evaluate(self, x, tangent=False, positive=False):
        """Energy, its gradient [3n] and the matrices of all blocks."""
        energy, gradient, matrices = -float(np.sum(self.load * x)), -self.load.ravel(), []
        for part in self.mesh.blocks + self.contacts:
            w, g, k = part.evaluate(x, self.material, tangent, positive)
            energy += w
            gradient = gradient + np.bincount(part.dofs.ravel(), g.ravel(), len(gradient))
            matrices.append(k)
        return energy, gradient, matrices

    def reaction(self, x, nodes):
        """Force [N] that holds the marked nodes in place."""
        return self.evaluate(x)[1].reshape(-1, 3)[nodes].sum(axis=0)

    def solve(self, x, tolerance=1e-6, iterations=60, verbose=False):
        """Positions at equilibrium by Newton's method with a line search on the energy, from x."""
        x = x.copy()
        positive = False
        for iteration in range(iterations):
            energy, gradient, matrices = self.evaluate(x, True, positive)
            free = ~self.fixed
            residual = np.linalg.norm(gradient[free])
            scale = max(np.linalg.norm(gradient[self.fixed]), np.linalg.norm(self.load), 1e-9)
            if verbose:
                print(f"    {iteration}: energy {energy:.9g} J, residual {residual / scale:.2e}"
                      f"{', positive' if positive else ''}", flush=True)
            if residual < tolerance * scale:
                self.iterations = iteration
                return x
            step, negative = self.system.solve(matrices, -gradient)
            slope = gradient @ step
            if (negative or slope >= 0) and not positive:
                # An indefinite stiffness leads to a saddle; the projected one always descends.
                energy, gradient, matrices = self.evaluate(x, True, True)
                step, negative = self.system.solve(matrices, -gradient)
                slope = gradient @ step
            share = self._line_search(x, step, energy, slope, residual)
            x += share * step.reshape(-1, 3)
            positive = share < 0.1
        raise NotConverged(f"residual {residual / scale:.1e} after {iterations} iterations; take smaller load steps")

    def _line_search(self, x, step, energy, slope, residual):
        share = 1.0
        while share > 1e-4:
            moved, gradient, _ = self.evaluate(x + share * step.reshape(-1, 3))
            if np.isfinite(moved) and (moved <= energy + 1e-4 * share * slope
                                       or np.linalg.norm(gradient[~self.fixed]) < 0.5 * residual):
                break
            share *= 0.5
        return share
