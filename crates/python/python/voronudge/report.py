"""What a command found."""

from __future__ import annotations

import html
import json
import shutil
import weakref
from pathlib import Path
from tempfile import mkdtemp

import numpy as np


class Report:
    """Results of a command: the folder with report.json, report.html and arrays, read when asked for.

    Attributes
    ----------
    folder : pathlib.Path
        Where the results are. Unless ``out`` was given it is deleted with this object.
    exit_code : int
        0, or 1 if the command found no acceptable fit or a check failed.

    ``report["alpha"]`` is the entry of report.json; ``report.arrays["nudged_positions"]`` an array that was written.
    In a notebook the report shows itself.
    """

    def __init__(self, folder: Path, exit_code: int = 0, *, temporary: bool = False) -> None:
        self.folder = Path(folder)
        self.exit_code = exit_code
        self._entries: dict | None = None
        if temporary:
            self._finalizer = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)

    def __repr__(self) -> str:
        command = self.to_dict().get("command", "results")
        return f"<voronudge.Report of {command}: {self.folder}>"

    def to_dict(self) -> dict:
        """All entries of report.json, as docs/commands tells them."""
        if self._entries is None:
            path = self.folder / "report.json"
            self._entries = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        return self._entries

    def __getitem__(self, name: str):
        return self.to_dict()[name]

    def __contains__(self, name: str) -> bool:
        return name in self.to_dict()

    def get(self, name: str, default=None):
        """An entry of report.json, or the default."""
        return self.to_dict().get(name, default)

    @property
    def ok(self) -> bool:
        """Whether the command found what it looked for: an acceptable fit, a check that passed."""
        return self.exit_code == 0

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """Arrays that were written, by name without ``.npy``."""
        return {path.stem: np.load(path) for path in sorted(self.folder.glob("*.npy"))}

    @property
    def page(self) -> Path:
        """report.html, a single file that opens without a network."""
        return self.folder / "report.html"

    def rows(self, name: str = "parameters") -> list[dict]:
        """A table of report.json as rows for ``pandas.DataFrame``: an entry that is a list of objects, or an object of objects, whose
        names then stand under ``name``."""
        entry = self[name]
        if isinstance(entry, dict):
            return [
                {"name": key, **(value if isinstance(value, dict) else {"value": value})} for key, value in entry.items()
            ]
        return [row if isinstance(row, dict) else {"value": row} for row in entry]

    def save(self, folder) -> "Report":
        """Copies all results to a new folder."""
        return Report(Path(shutil.copytree(self.folder, folder)), self.exit_code)

    def _repr_html_(self) -> str:
        if not self.page.exists():
            return f"<pre>{html.escape(repr(self))}</pre>"
        page = html.escape(self.page.read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:48em;border:1px solid #8884" sandbox="allow-scripts"></iframe>'


def temporary_folder() -> Path:
    """A new folder that nobody else uses."""
    return Path(mkdtemp(prefix="voronudge-"))
