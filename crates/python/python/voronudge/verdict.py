"""From a file of another program to a verdict."""

from __future__ import annotations

import shutil
from pathlib import Path

from .commands import info, run
from .errors import Error
from .report import Report, temporary_folder


def verdict(path, *, out=None, quiet: bool = False, importing: dict | None = None, **options) -> Report:
    """What moves these cells, and what the model misses: imports a file if it is no data set, and calls `discover`.

    Parameters
    ----------
    path : path
        A data set, tracks of TrackMate or napari, masks of Cellpose, label images: whatever `info` knows.
    out : path, optional
        Folder for the results; without it they are kept as long as the report.
    importing : dict, optional
        Options of the import, such as ``{"pixel_size": 0.65, "frame_interval": 10, "length_unit": "um"}``, for what the file does not say.
        Cells of label images are followed by their overlap unless ``link`` says otherwise.
    **options
        Those of `discover`.

    Returns
    -------
    Report
        That of `discover`; its page has the sentence, the candidates and the figures.
    """
    path = Path(path)
    found = info(path)
    if found["kind"] == "data set":
        return run("discover", inputs=path, out=out, quiet=quiet, **options)
    command, kind, *link = found["arguments"]
    if command != "import":
        raise Error(f"{path} is {found['kind']}, which no command reads", "voronudge.info(path) says more")
    # Pages tell the name of the folder.
    data = temporary_folder() / path.name.split(".")[0]
    importing = dict(importing or {})
    if link:
        importing.setdefault("link", link[-1])
    try:
        run("import", kind, inputs=path, out=data, quiet=quiet, **importing)
        return run("discover", inputs=data, out=out, quiet=quiet, **options)
    finally:
        shutil.rmtree(data.parent, ignore_errors=True)
