"""The cells of one moment, with exact derivatives."""

from __future__ import annotations

import numpy as np

from ._native import Tissue as _Tissue
from .errors import Error
from .jacobian import Jacobian


def _floats(name: str, values) -> np.ndarray:
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise Error(f"{name} are no array of numbers: {error}", "give an array of shape (cells, 2)") from None
    if array.ndim != 2:
        raise Error(f"{name} have shape {array.shape}, but it must be (cells, 2)", "give x and y of each cell")
    return array


class Tissue:
    """Cells at given positions and their Voronoi tessellation.

    Parameters
    ----------
    positions : array_like (N, 2)
        Centres of the cells, in any unit, y up.
    box : (Lx, Ly), optional
        Sides of a periodic box. Without it the field is open: cells at its rim have open polygons and no velocity (NaN).
    shear : float
        Simple shear of the box: its upper image is displaced by ``shear * Ly`` along x.

    Notes
    -----
    Methods take the parameters of the model as keywords: ``K_A`` (default 0.1; 1/length²/time), ``K_P`` (1; 1/time), ``P_0``
    (4; length), ``A_0`` (1; length²), ``alpha`` (0), and ``effects``, a dict from the id of an effect (`voronudge.EFFECTS`) to
    its coefficients. Friction is absorbed, so stiffnesses are rates.

    Examples
    --------
    >>> import numpy as np, voronudge
    >>> positions = np.random.default_rng(1).uniform(0, 10, (100, 2))
    >>> tissue = voronudge.Tissue(positions, (10, 10))
    >>> v = tissue.velocities(P_0=3.8, alpha=0.5)
    >>> bool(np.abs(v.sum(axis=0)).max() < 1e-12)
    True
    """

    def __init__(self, positions, box=None, *, shear: float = 0.0) -> None:
        box = None if box is None else [float(side) for side in box]
        if box is not None and len(box) != 2:
            raise Error(f"box has {len(box)} sides, but it must have two", "give box=(Lx, Ly)")
        self._native = _Tissue(_floats("positions", positions), box, shear=shear)

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        where = "open field" if self.box is None else f"box {self.box[0]:g} × {self.box[1]:g}"
        return f"<voronudge.Tissue: {len(self)} cells, {where}>"

    @property
    def positions(self) -> np.ndarray:
        """Positions (N, 2) as given."""
        return self._native.positions

    @property
    def box(self) -> tuple[float, float] | None:
        """Sides of the periodic box; None of an open field."""
        box = self._native.box
        return None if box is None else tuple(box)

    @property
    def areas(self) -> np.ndarray:
        """Areas (N,) of the cells; not a number where a polygon is open."""
        return self._native.areas

    @property
    def perimeters(self) -> np.ndarray:
        """Perimeters (N,) of the cells; not a number where a polygon is open."""
        return self._native.perimeters

    @property
    def counts(self) -> np.ndarray:
        """Whether the velocity of each cell (N,) depends on nothing beyond the field of view. All cells of a periodic box count."""
        return self._native.counts

    @property
    def neighbours(self) -> tuple[np.ndarray, np.ndarray]:
        """(indices, indptr): the neighbours of cell i, counter-clockwise, are ``indices[indptr[i]:indptr[i + 1]]``."""
        return self._native.neighbours

    def polygons(self) -> list[np.ndarray]:
        """Vertices (sides, 2) of each cell's polygon, counter-clockwise, around its centre; none where it is open."""
        return self._native.polygons()

    def velocities(self, **parameters) -> np.ndarray:
        """Velocities of the cells.

        Returns
        -------
        ndarray (N, 2)
            In length/time; not a number for cells of an open field whose polygon, or that of a neighbour, is open.
        """
        return self._native.velocities(**parameters)

    def jacobian(self, **parameters) -> Jacobian:
        """Derivatives ∂v_i/∂r_j at frozen topology, exact to rounding, as a sparse `Jacobian` (1/time)."""
        return Jacobian(*self._native._jacobian(**parameters))

    def jvp(self, displacements, **parameters) -> np.ndarray:
        """Change of the velocities (N, 2) for displacements (N, 2) of the cells, to first order."""
        return self._native.jvp(_floats("displacements", displacements), **parameters)

    def vjp(self, w, **parameters) -> tuple[np.ndarray, dict]:
        """The derivative of ``Σ_i w_i·v_i``, for a loss of one's own: ``w`` is the derivative of the loss by the velocities.

        Parameters
        ----------
        w : array_like (N, 2)
            Rows of cells without a velocity do not matter.

        Returns
        -------
        by_position : ndarray (N, 2)
        by_parameter : dict
            By ``K_A``, ``K_P``, ``P_0``, ``alpha`` and by the coefficients of the effects given.
        """
        return self._native.vjp(_floats("w", w), **parameters)

    def stress(self, **parameters) -> np.ndarray:
        """Mean stress (2, 2) of the cells that count, force index first (1/time: friction is absorbed)."""
        return self._native.stress(**parameters)
