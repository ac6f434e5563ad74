"""The commands of the program as functions.

Each takes what its command line takes: an option ``--remove-mean per-frame`` is ``remove_mean="per-frame"``. Values that are arrays
are handed over as files. A command runs in a process of its own, so that it can be interrupted and other threads go on.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ._native import options as _options
from .errors import Error
from .report import Report, temporary_folder

_COMMANDS = {
    tuple(words): {
        name: (by_place, values, repeated, help)
        for name, by_place, values, repeated, help in entries
        # It has no results to read.
        if name != "dry-run"
    }
    for words, _, entries in _options()
}
_HELP = {tuple(words): help for words, help, _ in _options()}


def _words(words: tuple[str, ...], options: Mapping, folder: Path) -> list[str]:
    """The command line of these options; arrays are written to the folder."""
    known = {name.replace("-", "_"): name for name in _COMMANDS[words]}
    line: list[str] = []
    for keyword, value in options.items():
        if keyword not in known:
            near = _nearest(keyword, known)
            raise Error(f"{' '.join(words)} has no option {keyword!r}", f"did you mean {near}?" if near else None)
        name = known[keyword]
        _, values, repeated, _ = _COMMANDS[words][name]
        flag = f"--{name}"
        if value is None or (value is False and not values):
            continue
        if not values:
            if value is not True:
                raise Error(f"{keyword} is either True or False", None)
            line.append(flag)
        elif isinstance(value, np.ndarray) and values == ["FILE"]:
            path = folder / f"{keyword}.npy"
            np.save(path, value)
            line += [flag, str(path)]
        elif isinstance(value, Mapping):
            for key, own in value.items():
                line += [flag, f"{key}={_joined(own)}"]
        elif isinstance(value, (list, tuple, np.ndarray)):
            if repeated and len(values) == 1:
                for own in value:
                    line += [flag, _text(own)]
            elif len(values) > 1:
                line += [flag, *(_text(own) for own in value)]
            else:
                line += [flag, _joined(value)]
        else:
            line += [flag, _text(value)]
    return line


def _text(value) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def _joined(value) -> str:
    return ",".join(map(_text, value)) if isinstance(value, (list, tuple, np.ndarray)) else _text(value)


def _nearest(typed: str, known) -> str | None:
    from difflib import get_close_matches

    return next(iter(get_close_matches(typed, known, 1)), None)


def _call(line: list[str], quiet: bool, capture: bool) -> subprocess.CompletedProcess:
    """Runs the program. Its messages of progress go to stderr unless it shall be quiet; faults are raised."""
    child = subprocess.Popen(
        [sys.executable, "-m", "voronudge", *line],
        stdout=subprocess.PIPE if capture else subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
    )
    try:
        if quiet:
            out, err = child.communicate()
        else:
            out, err = _told(child)
    except KeyboardInterrupt:
        child.send_signal(signal.SIGINT)
        child.communicate()
        raise
    if child.returncode not in (0, 1):
        message, _, hint = err.rpartition("error: ")[2].partition("\n\nhint: ")
        raise Error(message.strip() or f"voronudge ended with {child.returncode}", hint.strip() or None, child.returncode)
    return subprocess.CompletedProcess(line, child.returncode, out, err)


def _told(child: subprocess.Popen) -> tuple[str, str]:
    """What the child writes, of which lines of progress are shown as they come."""
    from threading import Thread

    seen: list[str] = []

    def show() -> None:
        for text in child.stderr:
            seen.append(text)
            if not text.startswith(("error: ", "hint: ")):
                sys.stderr.write(text)

    reader = Thread(target=show, daemon=True)
    reader.start()
    out = child.stdout.read() if child.stdout else ""
    child.wait()
    reader.join()
    return out, "".join(seen)


def run(*command: str, inputs=(), out=None, quiet: bool = False, **options) -> Report:
    """Runs a command that writes results.

    Parameters
    ----------
    *command : str
        Its words: ``run("import", "tracks", …)``.
    inputs : path or list of paths
        What the command line has by place: data sets, files.
    out : path, optional
        Folder for the results. Without it they are kept as long as the report.
    quiet : bool
        Shows no progress.
    **options
        What the command line has, see ``help(voronudge.infer)``.

    Raises
    ------
    Error
        With the message and the hint of the program.
    """
    if command not in _COMMANDS:
        raise Error(f"there is no command {' '.join(command)!r}", f"commands: {', '.join(map(' '.join, _COMMANDS))}")
    inputs = [inputs] if isinstance(inputs, (str, os.PathLike)) else list(inputs)
    folder = Path(out) if out is not None else temporary_folder()
    arrays = temporary_folder()
    try:
        line = [*command, *map(os.fspath, inputs), "--out", str(folder), *_words(command, options, arrays)]
        done = _call(line, quiet, capture=False)
    except BaseException:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    finally:
        shutil.rmtree(arrays, ignore_errors=True)
    return Report(folder, done.returncode, temporary=out is None)


def info(path) -> dict:
    """What is in a data set or in a file of another program: kind, shape, units, what was guessed, and the command that reads it."""
    return json.loads(_call(["info", os.fspath(path), "--json"], True, capture=True).stdout)


def _function(words: tuple[str, ...]):
    def command(*inputs, out=None, quiet: bool = False, **options) -> Report:
        return run(*words, inputs=inputs, out=out, quiet=quiet, **options)

    name = "_".join(words).replace("-", "_")
    command.__name__ = command.__qualname__ = name
    lines = [_HELP[words].strip(), "", "Parameters", "----------"]
    for option, (by_place, values, repeated, help) in _COMMANDS[words].items():
        if option in ("help", "version", "out"):
            continue
        if by_place:
            lines += [f"*inputs : {option}", f"    {help}"]
            continue
        kind = " ".join(values).lower() if values else "bool"
        lines += [f"{option.replace('-', '_')} : {kind}{', may be a list or a dict' if repeated else ''}", f"    {help}"]
    lines += [
        "out : path, optional",
        "    Folder for the results; without it they are kept as long as the report.",
        "quiet : bool",
        "    Show no progress.",
        "",
        "Returns",
        "-------",
        "Report",
    ]
    command.__doc__ = "\n".join(lines)
    return command


#: All commands that write a folder of results, by the name of their function.
FUNCTIONS = {
    "_".join(words).replace("-", "_"): _function(words) for words in _COMMANDS if "out" in _COMMANDS[words]
}
