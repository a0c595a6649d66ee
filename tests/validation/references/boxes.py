# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Reference cases on boxes of tissue. Each solve(nu, level, projected, coarse) returns the count of unknowns, rows of
results, the solutions, which start the next finer mesh, and entries for the record; `level` is the count of cells across the finest part, so that
the cell size is 1 / level."""
import numpy as np

from contact import Capsule, HalfSpace, RigidContact, Sphere, box_faces, quadrilateral_rule
from finite_elements import Box, Material, NotConverged, StaticProblem

MM = 1e-3


def follow(problem, targets, advance, step, coarse=None):
    """Equilibria at each of the increasing `targets`, as {target: (mesh, x)}. advance(value, x) sets the problem to `value`
    and may move prescribed nodes in x. A solution on a coarser mesh, of the same form, is a start for each target. Without
    one, or where Newton fails from it, steps are at most `step`, start from a linear prediction, and are halved where
    Newton fails. Targets that are not reached are left out."""
    at, now, found = 0.0, problem.mesh.nodes.copy(), {}
    slope = np.zeros_like(now)
    for target in targets:
        if coarse and target in coarse:
            mesh, x = coarse[target]
            guess = problem.mesh.nodes + problem.mesh.interpolated(mesh, x)
            advance(target, guess)
            try:
                at, now, slope = target, problem.solve(guess, iterations=15), 0 * slope
            except NotConverged:
                pass
        while at < target - 1e-12:
            size = min(step, target - at)
            while True:
                try:
                    guess = now + size * slope
                    advance(at + size, guess)
                    before, now = now, problem.solve(guess)
                    break
                except NotConverged as failure:
                    slope, size = 0 * slope, size / 2
                    if size < step / 16:
                        print(f"    stopped at {at:g} of {target:g}: {failure}", flush=True)
                        return found
            slope = (now - before) / size
            at += size
        found[target] = problem.mesh, now
    return found


def graded(length, cells, power):
    """Grid lines of [0, length], finer towards `length` for a power above 1."""
    return length * (1 - np.linspace(1, 0, cells + 1) ** power)


def contact_lines(near, far, cells):
    """Grid lines of [0, far]: `cells` equal ones to `near`, half as many growing ones beyond."""
    outer = near + (far - near) * np.linspace(0, 1, max(cells // 2, 1) + 1)[1:] ** 1.25
    return np.concatenate([np.linspace(0, near, cells + 1), outer])


def held(mesh, bottom=True, symmetric=(0, 1)):
    """Fixed components: the face z = 0 whole, and the normal component on planes of symmetry through the origin."""
    fixed = np.zeros(mesh.nodes.shape, bool)
    if bottom:
        fixed[mesh.nodes[:, 2] < 1e-9] = True
    for axis in symmetric:
        fixed[mesh.nodes[:, axis] < 1e-9, axis] = True
    return fixed


def bar(nu, level, projected, coarse=None):
    """Half of a bar of 40 x 10 x 10 mm, clamped at x = 0, under its own weight."""
    s, r, q = np.linspace(0, 1, 4 * level + 1), np.linspace(-1, 1, 2 * level + 1), np.linspace(0, 1, level + 1)
    towards_side = lambda t: 0.5 * (np.sin(np.pi / 2 * t) + t)
    mesh = Box(40 * MM * (0.35 * s + 0.65 * s ** 1.8), 5 * MM * towards_side(q), 5 * MM * (1 + towards_side(r)),
               projected=projected)
    fixed = held(mesh, bottom=False, symmetric=(1,))
    fixed[mesh.nodes[:, 0] < 1e-9] = True
    problem = StaticProblem(mesh, Material(15e3, nu), fixed)
    weight = 1000 * 9.81 * mesh.volume_shares()

    def advance(share, _x):
        problem.load[:, 2] = -share * weight
    found = follow(problem, [1.0], advance, 0.25, coarse)
    x = found[1.0][1]
    tip = mesh.displacement(x, np.array([[40 * MM, 0, 5 * MM]]))[0]
    row = {"sag_mm": -tip[2] / MM, "shortening_mm": -tip[0] / MM}
    return problem.system.size, [row | volume(mesh, x)], found, {}


def volume(mesh, x):
    least, mean, _ = mesh.determinants(x)
    return {"least_j": least, "volume_ratio": mean}


def indentation(mesh, body_at, depths, step, material, coarse, sides=(), points=None):
    """Force of a quarter model on a body pressed into its top, times four, at depths [mm]."""
    top = mesh.nodes[:, 2].max()
    faces = np.concatenate([box_faces(mesh, 2, top)] + [box_faces(mesh, axis, value) for axis, value in sides])
    contact = RigidContact(mesh.nodes, faces, quadrilateral_rule(mesh.order))
    problem = StaticProblem(mesh, material, held(mesh), [contact])

    def advance(depth, _x):
        contact.body = body_at(depth * MM)
    rows = []
    found = follow(problem, depths, advance, step, coarse)
    for depth, (_, x) in found.items():
        advance(depth, x)
        row = {"depth_mm": depth, "force_n": 4 * contact.force(x)[2]}
        if points is not None:
            row["displacements_mm"] = (mesh.displacement(x, points) / MM).round(5).tolist()
        rows.append(row | volume(mesh, x))
    described = {} if points is None else {"points_mm": (points / MM).tolist()}
    return problem.system.size, rows, found, described


def sphere(nu, level, projected, coarse=None):
    """Quarter of a block of 40 x 40 x 20 mm, bonded below, and a frictionless sphere of 10 mm radius."""
    lines = contact_lines(9 * MM, 20 * MM, level)
    mesh = Box(lines, lines, graded(20 * MM, level, 1.4), projected=projected)
    body = lambda depth: Sphere([0, 0, 30 * MM - depth], 10 * MM)
    return indentation(mesh, body, [1.0, 2.0, 3.0, 4.0, 5.0], 0.5, Material(15e3, nu), coarse)


def blade(nu, level, projected, coarse=None):
    """Quarter of a block of 20 x 20 x 10 mm, bonded below, and a frictionless capsule of 5 mm radius along x that is
    longer than the block. The block's ends x = +-10 mm may also touch it."""
    mesh = Box(graded(10 * MM, level, 1.3), contact_lines(6.5 * MM, 10 * MM, level), graded(10 * MM, level, 1.3),
               projected=projected)
    body = lambda depth: Capsule([-40 * MM, 0, 15 * MM - depth], [40 * MM, 0, 15 * MM - depth], 5 * MM)
    return indentation(mesh, body, [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0], 0.5, Material(8e3, nu), coarse, sides=[(0, 10 * MM)],
                       points=np.array([[x, y, 10.0] for x in (0.0, 5.0, 10.0) for y in (0.0, 2.0, 4.0, 6.0, 8.0, 10.0)]) * MM)


def slabs(nu, level, projected, coarse=None):
    """Two slabs of 20 x 20 x 10 mm, bonded behind and pressed together without friction. By symmetry each meets a rigid
    plane at half the approach; a quarter of one slab is solved."""
    mesh = Box(graded(10 * MM, level, 1.5), graded(10 * MM, level, 1.5), graded(10 * MM, level, 1.3),
               projected=projected)
    body = lambda approach: HalfSpace([0, 0, 10 * MM - approach / 2], [0, 0, -1.0])
    unknowns, rows, *more = indentation(mesh, body, [1.0, 2.0, 4.0, 6.0], 0.5, Material(8e3, nu), coarse, sides=[(0, 10 * MM), (1, 10 * MM)],
                                 points=np.array([[10.0, 0.0, 5.0], [10.0, 10.0, 5.0], [10.0, 0.0, 10.0]]) * MM)
    return unknowns, [{"approach_mm": row.pop("depth_mm")} | row for row in rows], *more


def squeeze(nu, level, projected, coarse=None):
    """Cube of 20 mm between two bonded plates of its own size, squeezed to half its height; an eighth is solved.
    Strains at the bonded edges are singular, and this material has no barrier against inversion: beyond some 30 percent a finer
    mesh inverts more of the edge, and the force does not converge."""
    lines = np.linspace(0, 10 * MM, level + 1)
    mesh = Box(lines, lines, lines, projected=projected)
    plate = mesh.nodes[:, 2] > 10 * MM - 1e-9
    fixed = held(mesh, bottom=False, symmetric=(0, 1, 2))
    fixed[plate] = True
    problem = StaticProblem(mesh, Material(15e3, nu), fixed)

    def advance(share, x):
        if np.ptp(x[plate, 2] - mesh.nodes[plate, 2]) == 0 and (x == mesh.nodes).all():
            x[:, 2] *= 1 - share  # the first step starts from a homogeneous strain, later ones from a prediction
        x[plate] = mesh.nodes[plate] * [1, 1, 1 - share]
    rows = []
    found = follow(problem, [0.1, 0.2, 0.3, 0.4, 0.5], advance, 0.05, coarse)
    for share, (_, x) in found.items():
        # The eighth's plate holds a quarter of the area.
        row = {"squeezed_share": share, "force_n": -4 * problem.reaction(x, plate)[2]}
        row["bulge_mm"] = mesh.displacement(x, np.array([[10 * MM, 0, 0]]))[0, 0] / MM
        rows.append(row | volume(mesh, x))
    return problem.system.size, rows, found, {}


def plate(nu, level, projected, coarse=None):
    """Plate of 20 x 10 x 2 mm, clamped at x = 0, small displacements. Bending: a uniform shear traction on the end x = 20 mm.
    Twist: a traction on it that turns about the axis and grows with the distance from it. Both stiffnesses are
    work-conjugate: load over the load's mean displacement."""
    length, width, thick, young = 20 * MM, 10 * MM, 2 * MM, 8e3
    side = lambda cells, size: size * np.sin(np.pi / 4 * np.linspace(-1, 1, cells + 1)) / np.sqrt(2)
    mesh = Box(length * np.linspace(0, 1, 10 * level + 1) ** 1.3, side(5 * level, width), side(level, thick),
               projected=projected)
    fixed = np.zeros(mesh.nodes.shape, bool)
    fixed[mesh.nodes[:, 0] < 1e-9] = True
    problem = StaticProblem(mesh, Material(young, nu), fixed)
    faces = box_faces(mesh, 0, length)
    surface = RigidContact(mesh.nodes, faces, quadrilateral_rule(mesh.order))  # for its Gauss points only
    at = surface.shape @ mesh.nodes[faces]
    _, _, matrices = problem.evaluate(mesh.nodes, True)
    row = {}
    area = surface.area.sum()
    turning = np.stack([0 * at[..., 0], -at[..., 2], at[..., 1]], axis=-1)
    lift = np.broadcast_to([0, 0, 1.0], at.shape)
    for name, direction, scale in (("bending_n_per_m", lift, area),
                                   ("twist_nm_per_rad", turning, np.sum(surface.area * at[..., 1:].T[0].T ** 2
                                                                        + surface.area * at[..., 2] ** 2))):
        traction = surface.area[..., None] * direction / scale  # of a unit force or torque
        load = np.zeros(mesh.nodes.shape)
        np.add.at(load, faces, np.einsum("fqi,qa->fai", traction, surface.shape))
        moved, _ = problem.system.solve(matrices, load.ravel())
        row[name] = 1 / float(moved @ load.ravel())
    inertia = width * thick ** 3 / 12
    torsion = torsion_constant(width, thick)
    row["bending_over_beam"] = row["bending_n_per_m"] / (3 * young * inertia / length ** 3)
    row["twist_over_saint_venant"] = row["twist_nm_per_rad"] / (problem.material.mu * torsion / length)
    return problem.system.size, [row], None, {}


def torsion_constant(width, thick):
    """Saint-Venant's torsion constant of a rectangle [m^4] (Timoshenko & Goodier, Theory of Elasticity, section 109)."""
    odd = np.arange(1, 200, 2)
    series = np.sum(np.tanh(odd * np.pi * width / (2 * thick)) / odd ** 5)
    return width * thick ** 3 / 3 * (1 - 192 / np.pi ** 5 * thick / width * series)
