# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The reference program solves patch tests exactly, agrees with closed forms, and its records are complete."""

import itertools
import json
import math
import unittest
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import boxes
import table
from cases import CASES
from contact import Capsule, HalfSpace, RigidContact, Sphere, box_faces, quadrilateral_rule
from convergence import extrapolate
from finite_elements import (Box, ElementBlock, Material, Mesh, StaticProblem, gauss_cube, gauss_simplex,
                             hexahedron_basis, simplex_basis, simplex_lattice)
from run import summary, uncertainty_key

HERE = Path(__file__).resolve().parent
PAGE = HERE.parents[2] / "docs/solver/references.md"
OF_LIFT = {"lift_mm", "pitch_deg"}  # not in the record of tongue_press
SHEAR_AND_STRETCH = np.array([[1.2, 0.3, 0.0], [-0.1, 0.9, 0.2], [0.1, 0.0, 1.05]])


def distorted_box(order, projected):
    """Two by two by two hexahedra of order p whose inner corner is displaced."""
    box = Box([0, 1, 2], [0, 1, 2.5], [0, 0.8, 2], order, projected)
    place = box.nodes.copy()
    hat = np.prod([np.interp(place[:, a], [g[0], g[1], g[2]], [0, 1, 0]) for a, g in enumerate(box.lines)], axis=0)
    place += hat[:, None] * [0.15, -0.1, 0.12]
    points, weights = gauss_cube(order + 1)
    block = ElementBlock(place, box.blocks[0].conn, hexahedron_basis(order, points), weights,
                         order - 1 if projected else None)
    return Mesh(place, [block])


def tetrahedra(order):
    """Four tetrahedra about a point inside a tetrahedron."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1.2, 0], [0, 0, 0.9], [0.3, 0.2, 0.25]])
    cells = np.array([[4, 1, 2, 3], [0, 4, 2, 3], [0, 1, 4, 3], [0, 1, 2, 4]])
    lattice = simplex_lattice(order, 3)
    found = {}
    conn = [[found.setdefault(tuple(sorted((c, s) for c, s in zip(cell, share) if s)), len(found)) for share in lattice]
            for cell in cells]
    place = np.array([sum(s * corners[c] for c, s in key) / order for key in found])
    points, weights = gauss_simplex(order, 3)
    return Mesh(place, [ElementBlock(place, conn, simplex_basis(order, points), weights, None)])


def on_hull(nodes):
    """Nodes of the boundary: those on a face of the box, or of the tetrahedron, that encloses them."""
    low = np.abs(nodes - nodes.min(axis=0)).min(axis=1) < 1e-9
    high = np.abs(nodes - nodes.max(axis=0)).min(axis=1) < 1e-9
    return low | high | (np.abs(nodes @ [1, 1 / 1.2, 1 / 0.9] - 1) < 1e-9)


class References(unittest.TestCase):
    def solves_patch(self, mesh):
        inner = ~on_hull(mesh.nodes)
        self.assertGreater(inner.sum(), 0)
        problem = StaticProblem(mesh, Material(8e3, 0.49), np.repeat(~inner[:, None], 3, axis=1))
        exact = mesh.nodes @ SHEAR_AND_STRETCH.T
        start = exact.copy()
        start[inner] += 0.01 * np.random.default_rng(1).standard_normal((inner.sum(), 3))
        found = problem.solve(start, tolerance=1e-10)
        self.assertLess(np.abs(found - exact).max(), 1e-8)  # rounding, times the residual's tolerance over stiffness

    def test_hexahedra_solve_the_patch_exactly(self):
        for order in (1, 2, 3):
            for projected in (True, False):
                with self.subTest(order=order, projected=projected):
                    self.solves_patch(distorted_box(order, projected))

    def test_tetrahedra_solve_the_patch_exactly(self):
        for order in (1, 2, 3):
            with self.subTest(order=order):
                self.solves_patch(tetrahedra(order))

    def test_simplex_rule_integrates_polynomials(self):
        """The integral of x^a y^b z^c over the unit tetrahedron is a! b! c! / (a + b + c + 3)!."""
        for count in (1, 2, 3):
            points, weights = gauss_simplex(count, 3)
            for a, b, c in itertools.product(range(2 * count), repeat=3):
                if a + b + c < 2 * count:
                    exact = math.factorial(a) * math.factorial(b) * math.factorial(c) / math.factorial(a + b + c + 3)
                    self.assertAlmostEqual(np.prod(points ** [a, b, c], axis=1) @ weights / exact, 1, delta=1e-12)
        self.assertAlmostEqual(gauss_simplex(4, 2)[1].sum(), 0.5, delta=1e-12)

    def test_stiffness_is_derivative_of_energy(self):
        random = np.random.default_rng(2)
        for projected in (True, False):
            mesh = Box([0, 1, 2.2], [0, 0.8], [0, 1, 1.5], projected=projected)
            top = box_faces(mesh, 2, 1.5)
            for body in (Sphere([1, 0.4, 2.1], 0.7), Capsule([0.3, 0.4, 2], [1.5, 0.4, 2], 0.6),
                         HalfSpace([0, 0, 1.48], [0, 0, -1])):
                contact = RigidContact(mesh.nodes, top, quadrilateral_rule(2), body, stiffness=20)
                problem = StaticProblem(mesh, Material(3, 0.45), np.zeros(mesh.nodes.shape), [contact])
                x = mesh.nodes + 0.03 * random.standard_normal(mesh.nodes.shape)
                step = random.standard_normal(x.shape)
                _, gradient, matrices = problem.evaluate(x, True)
                ahead, behind = (problem.evaluate(x + h * step) for h in (1e-6, -1e-6))
                self.assertGreater(contact.force(x) @ contact.force(x), 0)
                slope = gradient @ step.ravel()
                self.assertAlmostEqual((ahead[0] - behind[0]) / 2e-6 / slope, 1, delta=1e-6)
                product = np.zeros(x.size)
                for part, k in zip(mesh.blocks + [contact], matrices):
                    turned = np.einsum("eij,ej->ei", k, step.ravel()[part.dofs])
                    product += np.bincount(part.dofs.ravel(), turned.ravel(), x.size)
                difference = (ahead[1] - behind[1]) / 2e-6
                self.assertLess(np.abs(difference - product).max(), 1e-6 * np.abs(product).max())

    def test_bar_stretches_as_in_closed_form(self):
        """Uniaxial stress: the sides' stretch b follows from mu b + la (a b^2 - gamma) a b = 0."""
        for nu in (0.3, 0.45, 0.49):
            material = Material(8e3, nu)
            la = material.mu + material.lame
            gamma = 1 + material.mu / la
            mesh = Box([0, 1, 2], [0, 1], [0, 1])
            fixed = boxes.held(mesh, bottom=False, symmetric=(0, 1, 2))
            end = mesh.nodes[:, 0] > 2 - 1e-9
            fixed[end, 0] = True
            problem = StaticProblem(mesh, material, fixed)
            a = 1.4
            b = brentq(lambda b: material.mu * b + la * (a * b * b - gamma) * a * b, 0.5, 1.2)
            x = problem.solve(mesh.nodes * [a, 0.9, 0.9])
            self.assertAlmostEqual(x[:, 1].max(), b, delta=1e-6)
            stress = material.mu * a + la * (a * b * b - gamma) * b * b
            self.assertAlmostEqual(problem.reaction(x, end)[0] / stress, 1, delta=1e-6)

    def test_slender_beam_bends_as_in_closed_form(self):
        """A cantilever of 20 : 1 : 1 under an end load: Timoshenko's F L^3 / 3EI + F L / (k G A), k = 10 (1 + nu) / (12 +
        11 nu) by Cowper 1966. The clamp keeps the section from contracting, which stiffens it: by 0.8 % here."""
        length, young, nu = 20.0, 8e3, 0.45
        mesh = Box(length * np.linspace(0, 1, 21) ** 1.2, [-0.5, 0.5], [-0.5, 0.5])
        fixed = np.repeat(mesh.nodes[:, :1] < 1e-9, 3, axis=1)
        problem = StaticProblem(mesh, Material(young, nu), fixed)
        faces = box_faces(mesh, 0, length)
        end = RigidContact(mesh.nodes, faces, quadrilateral_rule(2), HalfSpace([0, 0, 0], [0, 0, 1]))
        load = np.zeros(mesh.nodes.shape)
        np.add.at(load[:, 2], faces, np.einsum("fq,qa->fa", end.area, end.shape))
        _, _, matrices = problem.evaluate(mesh.nodes, True)
        moved, negative = problem.system.solve(matrices, load.ravel())
        self.assertEqual(negative, 0)
        shear = young / (2 * (1 + nu)) * 10 * (1 + nu) / (12 + 11 * nu)
        self.assertAlmostEqual(moved @ load.ravel() / (length ** 3 / (3 * young / 12) + length / shear), 1, delta=0.012)

    def test_square_bar_has_its_torsion_constant(self):
        """0.1406 a^4 of a square, 0.2287 a b^3 of a rectangle of 2 : 1 (Timoshenko & Goodier, table 10.1)."""
        self.assertAlmostEqual(boxes.torsion_constant(1, 1), 0.1406, delta=5e-5)
        self.assertAlmostEqual(boxes.torsion_constant(2, 1) / 2, 0.2287, delta=1e-4)

    def test_known_rate_is_extrapolated(self):
        sizes = [1 / 4, 1 / 6, 1 / 8]
        value, uncertainty = extrapolate(sizes, [3 + 2 * h ** 2.5 for h in sizes])
        self.assertAlmostEqual(value, 3, delta=1e-9)
        self.assertAlmostEqual(uncertainty, 2 * sizes[-1] ** 2.5, delta=1e-9)
        self.assertEqual(extrapolate(sizes, [1.0, 1.2, 1.1]), (1.1, 0.19999999999999996))

    def test_records_state_how_they_were_made(self):
        for name, case in CASES.items():
            with self.subTest(case=name):
                record = json.loads((HERE / f"{name}.json").read_text())
                self.assertEqual(record["case"], name)
                self.assertIn(f"run.py {name}", record["command"])
                self.assertTrue({"unit", "versions", "elements", "date", *case.described} <= {*record, *OF_LIFT})
                self.assertEqual({row["nu"] for row in record["results"]}, {0.45, 0.48, 0.49})
                for nu in (0.45, 0.48, 0.49):
                    self.assertGreaterEqual(len([m for m in record["meshes"] if m["nu"] == nu]), 2)
                for row in record["results"]:
                    self.assertTrue({*case.quantities, uncertainty_key(case.quantities[0], True)} <= set(row))

    def test_summary_follows_from_the_meshes(self):
        for name, case in CASES.items():
            with self.subTest(case=name):
                record = json.loads((HERE / f"{name}.json").read_text())
                self.assertEqual(summary(case, record["meshes"]), record["results"])

    def test_page_shows_the_records(self):
        self.assertIn("\n".join(table.lines()), PAGE.read_text(), "run table.py, and put its output into the page")

    def test_bending_and_torsion_agree_with_plate_theory(self):
        """A clamped plate of 20 x 10 x 2 mm is stiffer than a beam, and softer than a plate that stays flat across, which has
        E / (1 - nu^2); torsion exceeds Saint-Venant's, which lets the clamped section warp."""
        for row in json.loads((HERE / "plate.json").read_text())["results"]:
            self.assertGreater(row["bending_over_beam"], 1)
            self.assertLess(row["bending_over_beam"], 1 / (1 - row["nu"] ** 2))
            self.assertGreater(row["twist_over_saint_venant"], 1)
            self.assertLess(row["twist_over_saint_venant"], 1.2)


if __name__ == "__main__":
    unittest.main()
