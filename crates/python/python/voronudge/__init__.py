"""Which forces move these cells, and what does the model of them miss?

>>> import voronudge
>>> report = voronudge.infer("path/to/data-set")        # doctest: +SKIP
>>> report["parameters"]["alpha"]                       # doctest: +SKIP

`Tissue` has velocities, stress, polygons and exact derivatives on NumPy arrays. Commands of the program are functions: `infer`,
`discover`, `simulate`, `spectrum`, `import_tracks`, … `verdict` leads from a file of another program to what the model misses.
"""

from ._native import __version__, effects as EFFECTS, mean_field
from .commands import FUNCTIONS as _FUNCTIONS, info, run
from .errors import Error
from .jacobian import Jacobian
from .report import Report
from .tissue import Tissue
from .verdict import verdict

globals().update(_FUNCTIONS)

__all__ = [
    "EFFECTS",
    "Error",
    "Jacobian",
    "Report",
    "Tissue",
    "__version__",
    "info",
    "mean_field",
    "run",
    "verdict",
    *_FUNCTIONS,
]
