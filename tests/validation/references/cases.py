# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Table of the reference cases."""
import boxes
import tongue_cases


class Case:
    """A case of run.py.

    solve       (nu, level, projected, coarse) -> (unknowns, rows, solutions, description)
    levels      of its meshes: cells across the finest part, or with `orders` the order of elements on one mesh
    quantities  columns of a row that are extrapolated; those of `checks` are kept by mesh, the others identify a row
    described   keys of the record that the solver describes, such as the rest points of displacements
    """

    checks = ["least_j", "volume_ratio"]

    def __init__(self, solve, levels, quantities, young, units, described=(), orders=False):
        self.solve, self.levels, self.quantities, self.young = solve, levels, quantities, young
        self.units = units | {"least_j": "least det F at a Gauss point", "volume_ratio": "volume over that at rest"}
        self.described, self.orders = described, orders
        self.elements = ("the model's tetrahedra with nodes of order `level`, J at every Gauss point" if orders else
                         "27-node hexahedra, discontinuous linear pressure")


DEPTH = {"depth_mm": "mm", "force_n": "N, of the whole body"}
DISPLACEMENTS = {"displacements_mm": "mm, by points_mm; uncertainty: greatest distance to the second finest mesh"}
TONGUE = DISPLACEMENTS | {"force_n": "N, against `down`, of the whole tongue", "force_along_n": "N, along `along`"}
PATH = ("points_mm", "first_contact_mm", "along", "down", "radius_mm", "half_length_mm", "lift_mm", "pitch_deg")
CASES = {
    "sphere": Case(boxes.sphere, (4, 6, 8), ["force_n"], 15e3, DEPTH),
    "blade": Case(boxes.blade, (4, 6, 8), ["force_n", "displacements_mm"], 8e3, DEPTH | DISPLACEMENTS, ["points_mm"]),
    "bar": Case(boxes.bar, (2, 4, 6), ["sag_mm", "shortening_mm"], 15e3,
                {"sag_mm": "mm, centre of the end face", "shortening_mm": "mm, the same point"}),
    "squeeze": Case(boxes.squeeze, (3, 4, 5), ["force_n", "bulge_mm"], 15e3,
                    {"force_n": "N", "squeezed_share": "share of the height", "bulge_mm": "mm, middle of a side"}),
    "plate": Case(boxes.plate, (1, 2, 3), ["bending_n_per_m", "twist_nm_per_rad", "bending_over_beam",
                                           "twist_over_saint_venant"], 8e3,
                  {"bending_n_per_m": "N/m", "twist_nm_per_rad": "N m/rad", "bending_over_beam": "over 3 E I / L^3",
                   "twist_over_saint_venant": "over G J / L"}),
    "slabs": Case(boxes.slabs, (4, 6, 8), ["force_n", "displacements_mm"], 8e3,
                  DISPLACEMENTS | {"approach_mm": "mm, of both backs", "force_n": "N"}, ["points_mm"]),
    "tongue_press": Case(tongue_cases.press, (1, 2, 3), ["force_n", "force_along_n", "displacements_mm"], 8e3,
                         TONGUE | {"depth_mm": "mm"}, PATH, orders=True),
    "tongue_lift": Case(tongue_cases.lift, (1, 2, 3), ["force_n", "force_along_n", "displacements_mm"], 8e3,
                        TONGUE | {"share": "of the path"}, PATH, orders=True),
}
