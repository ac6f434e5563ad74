"""The derivative of all velocities by all positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Jacobian:
    """Sparse matrix ∂v_i/∂r_j in blocks of 2 × 2, in the block-row format of SciPy.

    Attributes
    ----------
    data : ndarray (blocks, 2, 2)
        The first index of a block is the component of the velocity.
    indices : ndarray (blocks,)
        Cell whose position is moved.
    indptr : ndarray (N + 1,)
        The blocks of cell i are those from ``indptr[i]`` to ``indptr[i + 1]``.

    A cell without a velocity, at the rim of an open field, has no blocks.
    """

    data: np.ndarray
    indices: np.ndarray
    indptr: np.ndarray

    @property
    def shape(self) -> tuple[int, int]:
        """(2N, 2N)."""
        side = 2 * (len(self.indptr) - 1)
        return side, side

    def _rows(self) -> np.ndarray:
        """The cell whose velocity each block is about."""
        return np.repeat(np.arange(len(self.indptr) - 1), np.diff(self.indptr.astype(np.int64)))

    def to_scipy(self):
        """The same as ``scipy.sparse.bsr_array``."""
        from scipy.sparse import bsr_array

        return bsr_array((self.data, self.indices, self.indptr), shape=self.shape)

    def toarray(self) -> np.ndarray:
        """The dense matrix (2N, 2N), in the order x₀, y₀, x₁, y₁, …"""
        cells = len(self.indptr) - 1
        dense = np.zeros((cells, 2, cells, 2))
        dense[self._rows(), :, self.indices, :] = self.data
        return dense.reshape(self.shape)

    def __matmul__(self, displacements) -> np.ndarray:
        """Change of the velocities (N, 2) for displacements (N, 2) of the cells."""
        displacements = np.asarray(displacements, dtype=float)
        cells = len(self.indptr) - 1
        changes = np.zeros((cells, 2))
        np.add.at(changes, self._rows(), np.einsum("bij,bj->bi", self.data, displacements[self.indices]))
        return changes
