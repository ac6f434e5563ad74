"""What goes wrong, with advice."""

from __future__ import annotations


class Error(ValueError):
    """A fault of what was given, or of a command that did not run to its end.

    Attributes
    ----------
    message : str
        What is wrong, and where.
    hint : str or None
        What to change.
    exit_code : int
        That of the command: 2 for a fault, 130 after an interruption.
    """

    def __init__(self, message: str, hint: str | None = None, exit_code: int = 2) -> None:
        super().__init__(f"{message}\n\nhint: {hint}" if hint else message)
        self.message = message
        self.hint = hint
        self.exit_code = exit_code
