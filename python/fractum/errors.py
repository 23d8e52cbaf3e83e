"""What may go wrong, with the text of the program."""

import json


class FractumError(Exception):
    """A failure of the program.

    `diagnostics` lists the mistakes of a case one by one: dictionaries with `place` (file, line, column, key), `found`,
    `expected` and `remedy`. It is empty for other failures.
    """

    def __init__(self, text, diagnostics="[]"):
        super().__init__(text)
        self.diagnostics = json.loads(diagnostics)


class CaseError(FractumError, ValueError):
    """The case, its mesh or an argument is wrong."""


class StoppedError(FractumError, RuntimeError):
    """The run stopped itself: unstable, no equilibrium, energy balance. Its results are written."""


class MachineError(FractumError, OSError):
    """Disk, memory or threads failed."""
