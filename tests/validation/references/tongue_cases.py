# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Reference cases on the term newborn's tongue. `level` is the order of the elements, 1 to 3, on the model's cells."""
import numpy as np

from boxes import follow, volume
from contact import Capsule, RigidContact, triangle_rule
from finite_elements import Material, StaticProblem
from tongue_mesh import MM, TongueMesh, TongueModel

ALONG, DOWN = np.array([0, 0.8, -0.6]), np.array([0, -0.6, -0.8])  # the expert's blade in the lift, patient frame
RADIUS, HALF_LENGTH = 3.5 * MM, 30 * MM  # distal capsule of a Miller 1 blade; chosen longer than the tongue
YOUNG = 8e3
# The lift, chosen: at share s of the path the axis has gone `LIFT` s along DOWN and its tip has turned by `PITCH` s
# towards DOWN about its middle.
LIFT, PITCH = 8 * MM, np.radians(10)
OBSERVED = 12 * MM  # surface corners that near to the blade's axis at first contact are reported


def first_contact(model):
    """The blade's axis as it touches the highest free corner of the mid plane."""
    middle = np.flatnonzero(~model.held & (np.abs(model.place[:, 0]) < 1e-3))
    top = middle[np.argmax(-model.place[middle] @ DOWN)]
    return np.array([0, *model.place[top, 1:]]) - RADIUS * DOWN


def capsule(touching, depth, angle):
    centre, along = touching + depth * DOWN, np.cos(angle) * ALONG + np.sin(angle) * DOWN
    return Capsule(centre - HALF_LENGTH * along, centre + HALF_LENGTH * along, RADIUS)


def observed_nodes(model, mesh, touching):
    """Surface nodes at free corners of the model near the blade, on lattice planes x = 0, 4, 8 mm."""
    surface = np.unique(mesh.surface)
    surface = surface[(mesh.corner[surface] >= 0) & ~mesh.held[surface]]
    offset = mesh.nodes[surface] - touching
    distance = np.linalg.norm(offset - np.outer(offset @ ALONG, ALONG), axis=1)
    nodes = surface[(distance < OBSERVED) & (model.plane[mesh.corner[surface]] % 2 == 0)]
    return nodes[np.argsort(mesh.corner[nodes])]


def follow_blade(path, nu, order, coarse, targets, step, place):
    """Equilibria with the capsule at place(target) = (depth [m], angle [rad])."""
    model = TongueModel(path)
    touching = first_contact(model)
    mesh = TongueMesh(model, order)
    contact = RigidContact(mesh.nodes, mesh.surface, triangle_rule(order))
    fixed = np.repeat(mesh.held[:, None], 3, axis=1)
    fixed[mesh.nodes[:, 0] < 1e-9, 0] = True
    problem = StaticProblem(mesh, Material(YOUNG, nu), fixed, [contact])

    def advance(value, _x):
        contact.body = capsule(touching, *place(value))
    nodes = observed_nodes(model, mesh, touching)
    found = follow(problem, targets, advance, step, coarse)
    rows = []
    for value, (_, x) in found.items():
        advance(value, x)
        force = 2 * contact.force(x)
        rows.append({"target": value, "force_n": -float(force @ DOWN), "force_along_n": float(force @ ALONG),
                     "displacements_mm": ((x - mesh.nodes)[nodes] / MM).round(4).tolist(), **volume(mesh, x)})
    extra = {"points_mm": (mesh.nodes[nodes] / MM).round(4).tolist(), "first_contact_mm": (touching / MM).round(4).tolist(),
             "along": ALONG.tolist(), "down": DOWN.tolist(), "radius_mm": RADIUS / MM, "half_length_mm": HALF_LENGTH / MM}
    return problem.system.size, rows, found, extra


def press(nu, level, _projected, coarse=None, model=None):
    """The term newborn's tongue in the scenario's posture, and a frictionless capsule along the expert's blade pressed into
    its back. Held as attached to bone and floor of the mouth; half of it is solved."""
    size, rows, found, extra = follow_blade(model, nu, level, coarse, [2.0, 4.0, 6.0], 0.5,
                                            lambda depth: (depth * MM, 0.0))
    return size, [{"depth_mm": row.pop("target")} | row for row in rows], found, extra


def lift(nu, level, _projected, coarse=None, model=None):
    """The same tongue lifted by the capsule: at share s of the path its axis has gone 8 mm s along `down`, and its tip has
    turned by 10 degrees s from `along` towards `down`, about its middle. Without friction, shell and self-contact."""
    size, rows, found, extra = follow_blade(model, nu, level, coarse, [0.5, 1.0], 0.0625,
                                            lambda share: (LIFT * share, PITCH * share))
    extra |= {"lift_mm": LIFT / MM, "pitch_deg": float(np.degrees(PITCH))}
    return size, [{"share": row.pop("target")} | row for row in rows], found, extra
