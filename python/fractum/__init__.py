"""Fracture of solids from Python: run cases, step simulations, read results.

>>> import fractum
>>> results = fractum.run("cases/patch/case.toml", set={"solver.safety": 0.5})
>>> results.summary["status"]

Everything is in SI units. `docs/python.md` of the repository has a recipe for each task.
"""

from ._core import __version__
from .errors import CaseError, FractumError, MachineError, StoppedError
from .results import Frame, Frames, Parts, Probe, Results
from .runs import Check, Key, check, explain, new, run, study, sweep
from .simulation import Simulation
from .tables import with_units

__all__ = [
    "CaseError",
    "Check",
    "FractumError",
    "Frame",
    "Frames",
    "Key",
    "MachineError",
    "Parts",
    "Probe",
    "Results",
    "Simulation",
    "StoppedError",
    "__version__",
    "check",
    "explain",
    "new",
    "run",
    "study",
    "sweep",
    "with_units",
]
