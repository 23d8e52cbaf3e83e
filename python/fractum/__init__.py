"""Fracture of solids from Python: run cases, step simulations, read results.

>>> import fractum
>>> results = fractum.run("cases/patch/case.toml", set={"solver.safety": 0.5})
>>> results.summary["status"]

Everything is in SI units. `docs/python.md` of the repository has a recipe for each task.
"""

from ._core import __version__
from .errors import CaseError, FractumError, MachineError, StoppedError
from .results import Frame, Results
from .runs import run, study, sweep
from .simulation import Simulation

__all__ = [
    "CaseError",
    "FractumError",
    "Frame",
    "MachineError",
    "Results",
    "Simulation",
    "StoppedError",
    "__version__",
    "run",
    "study",
    "sweep",
]
