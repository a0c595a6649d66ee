# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Value and uncertainty of a quantity from its values on meshes of decreasing cell size."""
import numpy as np
from scipy.optimize import brentq

RATES = (0.5, 4.0)  # of convergence by cell size: energies of quadratic elements reach 4, contact and corners less


def observed_rate(sizes, values):
    """Rate r of v = v0 + C h^r through three points, or None where none in RATES fits."""
    (h0, h1, h2), (v0, v1, v2) = sizes, values
    if (v0 - v1) * (v1 - v2) <= 0:
        return None
    mismatch = lambda r: (v0 - v1) / (v1 - v2) - (h0 ** r - h1 ** r) / (h1 ** r - h2 ** r)
    return brentq(mismatch, *RATES) if mismatch(RATES[0]) * mismatch(RATES[1]) < 0 else None


def extrapolate(sizes, values, by_size=True):
    """(value, uncertainty) of a scalar or an array over meshes of cell sizes, coarsest first. One mesh gives no uncertainty.

    The last three scalars are extrapolated where they converge at a rate within RATES. The uncertainty is the distance to
    the finest mesh, and at least half of that between the finest two. Otherwise the value is that of the finest mesh, and the uncertainty the greatest distance
    among the last three. An array (displacements [..., 3]) has the values of the finest mesh, and the greatest distance to
    the second finest as its uncertainty.
    """
    values = [np.asarray(v, float) for v in values]
    if len(values) < 2:
        return values[-1], None
    if values[-1].ndim:
        return values[-1], float(np.linalg.norm(values[-1] - values[-2], axis=-1).max())
    if not by_size:
        return float(values[-1]), float(abs(values[-1] - values[-2]))
    rate = observed_rate(sizes[-3:], values[-3:]) if len(values) >= 3 else None
    if rate is None:
        return float(values[-1]), float(np.ptp(values[-3:]))
    h1, h2 = sizes[-2:]
    value = values[-1] + (values[-1] - values[-2]) * h2 ** rate / (h1 ** rate - h2 ** rate)
    return float(value), float(max(abs(value - values[-1]), abs(values[-1] - values[-2]) / 2))
