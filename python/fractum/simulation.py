"""A simulation that is driven from Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from .results import Results
from .runs import Place, overrides
from .tables import nearest

_NO_LIMIT = 2**63 - 1


class _State:
    """Arrays over one kind of points; each is read when it is asked for, and is a copy that cannot be written to."""

    _arrays: dict[str, tuple[Any, ...]] = {}

    def __init__(self, read: Callable[[str], bytes]) -> None:
        self._read = read

    def __getattr__(self, name: str) -> np.ndarray:
        if name not in self._arrays:
            raise AttributeError(f"{type(self).__name__} has no array {name!r}; {nearest(name, self._arrays)}")
        return _array(self._read(name), *self._arrays[name])

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]


def _array(content: bytes, columns: int, kind: str = "f8") -> np.ndarray:
    values = np.frombuffer(content, dtype=kind)
    return values if columns == 1 else values.reshape(-1, columns)


class Nodes(_State):
    """Nodes of solids in the order of the mesh file.

    `reference`, `position`, `displacement` [m], `velocity` [m/s] at the half step before, `force` [N] of the last step:
    arrays (n, 3). `mass` [kg]: array (n).
    """

    _arrays = {
        "reference": (3,),
        "position": (3,),
        "displacement": (3,),
        "velocity": (3,),
        "force": (3,),
        "mass": (1,),
    }


class Particles(_State):
    """Particles of bonded bodies and loose ones.

    `reference`, `position` [m], `velocity` [m/s] and `spin` [rad/s] at the half step before, `force` [N] and `moment`
    [N m] of the last step: arrays (n, 3). `mass` [kg], `radius` [m]: arrays (n).
    """

    _arrays = {
        "reference": (3,),
        "position": (3,),
        "velocity": (3,),
        "spin": (3,),
        "force": (3,),
        "moment": (3,),
        "mass": (1,),
        "radius": (1,),
    }


class DiscreteElements(_State):
    """Discrete elements that removed elements have left, in the order of their birth.

    `node`: the node that each sits on; `attached`: whether an element still holds it; `position` [m], `velocity` [m/s],
    `spin` [rad/s], `radius` [m].
    """

    _arrays = {
        "node": (1, "u4"),
        "attached": (1, "?"),
        "position": (3,),
        "velocity": (3,),
        "spin": (3,),
        "radius": (1,),
    }


class Body(_State):
    """A solid body: `name`, `connectivity` (elements by nodes).

    `damage` (0 to 1), `alive` (not removed): arrays (n). `stress` [Pa]: array (n, 6), xx yy zz xy yz zx.
    """

    _arrays = {"damage": (1,), "stress": (6,), "alive": (1, "?")}

    def __init__(self, name: str, connectivity: np.ndarray, read: Callable[[str], bytes]) -> None:
        super().__init__(read)
        self.name = name
        self.connectivity = connectivity


class Bodies(dict[str, Body]):
    """Solid bodies by name."""

    def __missing__(self, name: str) -> Body:
        raise KeyError(f"no solid body {name!r}; {nearest(name, self)}")


def _shared(function: Callable[..., Any], count: int) -> tuple[Callable[[float], None], list[np.ndarray]]:
    """What the simulation calls with the time [s] for a load, and the arrays that it fills before and reads after."""
    arrays = [np.empty((count, 3)) for _ in range(3)]
    seen = [array.view() for array in arrays[:2]]
    for array in seen:
        array.flags.writeable = False
    forces = arrays[2]

    def call(time: float) -> None:
        # A single force acts on every point.
        forces[...] = function(time, *seen)

    return call, arrays


class Simulation:
    """A case under way, stepped from Python.

    Arguments are those of `fractum.run`. Use it in a `with` block, or call `finish()`, which writes the results:

    >>> with Simulation("case.toml") as simulation:
    ...     simulation.run(stop=lambda s: s.nodes.displacement[:, 0].max() > 1e-4)
    >>> simulation.results.history
    """

    def __init__(
        self,
        case: Place,
        set: Mapping[str, Any] | None = None,
        output: Place | None = None,
        threads: int | None = None,
        resume: bool = False,
        quiet: bool = True,
        overwrite: bool = False,
        strict: bool = False,
    ) -> None:
        self._core = _core.Core(case, overrides(set), output, threads, (resume, overwrite), (quiet, strict))
        self.results: Results | None = None
        self.nodes = Nodes(self._core.nodes)
        self.particles = Particles(self._core.particles)
        self.discrete_elements = DiscreteElements(self._core.discrete)

    @property
    def bodies(self) -> Bodies:
        """The solid bodies by name."""
        found = Bodies()
        for index, (name, corners, nodes) in enumerate(self._core.bodies()):
            connectivity = _array(nodes, corners, "u4")
            found[name] = Body(name, connectivity, lambda array, index=index: self._core.elements(index, array))
        return found

    @property
    def time(self) -> float:
        """Present time [s]; the load factor of a static run."""
        return self._core.progress()[0]

    @property
    def dt(self) -> float:
        """The next time step [s]."""
        return self._core.progress()[1]

    @property
    def steps(self) -> int:
        """Steps done."""
        return self._core.progress()[2]

    @property
    def is_over(self) -> bool:
        """Whether the run has ended: its end is reached, `stop()` was called, it was interrupted, or a step failed."""
        return self._core.progress()[3]

    @property
    def status(self) -> str | None:
        """How the run ended: `"completed"`, `"interrupted"` or `"stopped"` (a step failed); `None` before that."""
        return self._core.progress()[4]

    @property
    def folder(self) -> Path:
        """Results folder."""
        return Path(self._core.progress()[5])

    @property
    def energies(self) -> dict[str, float]:
        """The energy ledger at the last row of the history [J]."""
        return self._core.ledger()[0]

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of nodes, elements, removed elements, damaged and broken edges, particles, contacts and bonds."""
        return self._core.ledger()[1]

    @property
    def state_hash(self) -> str:
        """Hash of everything that changes, as `summary.json` has it for the end of a run."""
        return self._core.state_hash()

    @property
    def warnings(self) -> list[dict[str, str]]:
        """All warnings so far, as those of `Results`."""
        names = ("code", "text", "where", "remedy")
        return [dict(zip(names, warning)) for warning in self._core.warnings()]

    @property
    def probes(self) -> dict[str, str]:
        """Names of the probes that are columns of the history, with their units."""
        return dict(self._core.probes())

    def probe(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and values of a probe so far."""
        times, values = self._core.probe(name)
        return _array(times, 1), _array(values, 1)

    @property
    def groups(self) -> list[str]:
        """Names of the groups of the mesh."""
        return self._core.groups()

    def group(self, name: str) -> np.ndarray:
        """Nodes of a group of the mesh: indices into the arrays of `nodes`."""
        return _array(self._core.group(name), 1, "u4")

    def add_load(
        self,
        function: Callable[[float, np.ndarray, np.ndarray], Any],
        group: str | None = None,
        nodes: Sequence[int] | np.ndarray | None = None,
        particles: Sequence[int] | np.ndarray | None = None,
    ) -> None:
        """Adds a load that a function gives.

        Before every step `function(time, position, velocity)` is called with the time [s] and the arrays (n, 3) of the
        points that the load pushes; it returns their forces [N] as an array (n, 3), or three numbers for the same force on
        each. The arrays are the same in every step: copy what is to be kept. The function is called on a thread of the
        simulation. Name the points by one of

        - `group`: the nodes of a group of the mesh
        - `nodes`: indices into the arrays of `nodes`
        - `particles`: indices into the arrays of `particles`

        The run must have `solver.kind = "explicit"`. The work of the load is part of the energy balance. The stable step
        knows nothing of it: a stiff force needs a smaller `solver.safety`. A checkpoint holds no such loads: add them
        again after `resume=True`.
        """
        if sum(given is not None for given in (group, nodes, particles)) != 1:
            raise TypeError("name the points of a load by one of group, nodes and particles")
        points = self.group(group) if group is not None else nodes if nodes is not None else particles
        points = np.asarray(points)
        if points.dtype == bool:
            points = np.flatnonzero(points)
        if points.size and points.min() < 0:
            raise IndexError("points of a load count from 0")
        points = np.ascontiguousarray(points, dtype="u4")
        self._core.add_load(particles is None, points.tobytes(), *_shared(function, len(points)))

    def step(self, count: int = 1) -> bool:
        """Steps `count` times; whether the run goes on."""
        return self._advance(count, float("inf"))

    def run(self, until: float = float("inf"), stop: Callable[[Simulation], bool] | None = None, every: int = 1) -> None:
        """Steps to the end of the case, to a time, or until `stop(simulation)` is true.

        - `until`: time [s] at which the stepping ends, and can go on
        - `stop`: looked at after every `every` steps; once it is true the run is over, as if its end were reached
        """
        self._advance(_NO_LIMIT, until, stop and (lambda: stop(self)), every)

    def _advance(self, count: int, until: float, stop: Callable[[], bool] | None = None, every: int = 1) -> bool:
        """Whether the run goes on after `count` steps or the time `until`."""
        goes_on = self._core.step(count, until, stop, every)
        if not goes_on and self.status == "interrupted":
            # By another thread.
            raise KeyboardInterrupt(f"state saved in {self.folder}")
        return goes_on

    def stop(self) -> None:
        """Ends the run as if its end were reached."""
        self._core.stop()

    def finish(self) -> Results | None:
        """Writes the results and returns them; a run that is not over ends as if interrupted, with its state saved.

        Raises `StoppedError` where a step failed, with the results written all the same.
        """
        if self.results is None:
            folder = self.folder
            try:
                self._core.finish()
            finally:
                if (folder / "summary.json").exists():
                    self.results = Results(folder)
        return self.results

    def __repr__(self) -> str:
        if self.results is not None:
            return f"<Simulation that has ended: {self.results!r}>"
        return f"<Simulation at {self.time:.6g} s after {self.steps} steps of {self.dt:.4g} s: {self.status or 'under way'}>"

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: Any, trace: Any) -> bool:
        if kind is None or not issubclass(kind, Exception):
            self.finish()
        return False
