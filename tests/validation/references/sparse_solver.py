# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Assembly and direct solution of symmetric sparse systems: MUMPS by petsc4py, or SciPy's SuperLU where that is absent."""
import glob
import sys

import numpy as np
import scipy
import scipy.sparse as sp
import scipy.sparse.linalg

# Debian's python3-petsc4py lies here, and reaches the default path only where PETSc's development files are installed.
sys.path += glob.glob("/usr/lib/petscdir/*/*-real/lib/python3/dist-packages")
try:
    import petsc4py
    petsc4py.init(["references", "-mat_mumps_icntl_14", "60"])
    from petsc4py import PETSc
except ImportError:
    PETSc = None


def versions():
    """Programs on which a result depends, for its record."""
    found = {"python3-numpy": np.__version__, "python3-scipy": scipy.__version__}
    if PETSc:
        found["python3-petsc4py"] = petsc4py.__version__
    found["solver"] = "MUMPS, L D L^T" if PETSc else "SuperLU"
    return found


class SymmetricSystem:
    """Sum of dense symmetric matrices over lists of degrees of freedom, restricted to the free ones."""

    def __init__(self, dof_lists, free):
        self.free = np.flatnonzero(free)
        number = np.full(len(free), -1, np.int64)
        number[self.free] = np.arange(len(self.free))
        size = len(self.free)
        self.taken, keys = [], []
        for dofs in dof_lists:
            local = number[dofs]
            rows, columns = local[:, :, None], local[:, None, :]
            upper = (rows >= 0) & (columns >= rows)
            self.taken.append(np.flatnonzero(upper.ravel()))
            keys.append((rows * size + columns)[upper])
        lengths = np.cumsum([0] + [len(k) for k in keys])
        unique, slots = np.unique(np.concatenate(keys), return_inverse=True)
        self.slots = [slots[a:b] for a, b in zip(lengths, lengths[1:])]
        rows = (unique // size).astype(np.int32)
        self.columns = (unique % size).astype(np.int32)
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=size))]).astype(np.int32)
        self.size = size
        self.solver = None

    def upper(self, matrices):
        """Values of the upper triangle in compressed rows."""
        values = np.zeros(len(self.columns))
        for matrix, taken, slots in zip(matrices, self.taken, self.slots):
            values += np.bincount(slots, matrix.ravel()[taken], len(values))
        return values

    def solve(self, matrices, right):
        """Solution on all degrees of freedom, zero where they are fixed, and the count of negative pivots (0 where
        the solver does not tell)."""
        values = self.upper(matrices)
        out = np.zeros(len(right))
        solve = self._mumps if PETSc else self._superlu
        out[self.free], negative = solve(values, right[self.free])
        return out, negative

    def _superlu(self, values, right):
        upper = sp.csr_matrix((values, self.columns, self.starts), shape=(self.size, self.size))
        whole = upper + sp.triu(upper, 1).T
        return scipy.sparse.linalg.spsolve(whole.tocsc(), right, permc_spec="MMD_AT_PLUS_A"), 0

    def _mumps(self, values, right):
        if self.solver is None:
            self.matrix = PETSc.Mat().createSBAIJ(self.size, 1, csr=(self.starts, self.columns, values))
            self.solver = PETSc.KSP().create()
            self.solver.setType("preonly")
            self.solver.getPC().setType("cholesky")
            self.solver.getPC().setFactorSolverType("mumps")
        else:
            self.matrix.zeroEntries()
            self.matrix.setValuesCSR(self.starts, self.columns, values)
            self.matrix.assemble()
        self.solver.setOperators(self.matrix)
        answer = self.matrix.createVecRight()
        given = PETSc.Vec().createWithArray(right.copy())
        self.solver.solve(given, answer)
        reason = self.solver.getConvergedReason()
        if reason < 0:
            raise RuntimeError(f"MUMPS failed (PETSc reason {reason}); raise -mat_mumps_icntl_14 where memory was short")
        return answer.getArray().copy(), self.solver.getPC().getFactorMatrix().getMumpsInfog(12)
