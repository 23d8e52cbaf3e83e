"""What may go wrong, with the text of the program."""

from __future__ import annotations

import json
from typing import Any


class FractumError(Exception):
    """A failure of the program.

    `diagnostics` lists the mistakes of a case one by one: dictionaries with `place` (file, line, column, key), `found`,
    `expected` and `remedy`. It is empty for other failures.
    """

    def __init__(self, text: str, diagnostics: str = "[]") -> None:
        super().__init__(text)
        self.diagnostics: list[dict[str, Any]] = json.loads(diagnostics)


class CaseError(FractumError, ValueError):
    """The case, its mesh or an argument is wrong."""


class StoppedError(FractumError, RuntimeError):
    """The run stopped itself: unstable, no equilibrium, energy balance. Its results are written."""


class MachineError(FractumError, OSError):
    """Disk, memory or threads failed."""
