"""A simulation that is driven from Python."""

from pathlib import Path

import numpy as np

from . import _core
from .results import Results
from .runs import overrides

_NO_LIMIT = 2**63 - 1


class _State:
    """Arrays over one kind of points; each is read when it is asked for, and is a copy that cannot be written to."""

    _arrays = {}

    def __init__(self, read):
        self._read = read

    def __getattr__(self, name):
        if name not in self._arrays:
            raise AttributeError(f"{type(self).__name__} has no array {name!r}; arrays: {', '.join(self._arrays)}")
        return _array(self._read(name), *self._arrays[name])

    def __dir__(self):
        return [*super().__dir__(), *self._arrays]


def _array(content, columns, kind="f8"):
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

    def __init__(self, name, connectivity, read):
        super().__init__(read)
        self.name = name
        self.connectivity = connectivity


def _shared(function, count):
    """What the simulation calls with the time [s] for a load, and the arrays that it fills before and reads after."""
    arrays = [np.empty((count, 3)) for _ in range(3)]
    seen = [array.view() for array in arrays[:2]]
    for array in seen:
        array.flags.writeable = False
    forces = arrays[2]

    def call(time):
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

    def __init__(self, case, set=None, output=None, threads=None, resume=False, quiet=True, overwrite=False, strict=False):
        self._core = _core.Core(case, overrides(set), output, threads, (resume, overwrite), (quiet, strict))
        self.results = None
        self.nodes = Nodes(self._core.nodes)
        self.particles = Particles(self._core.particles)
        self.discrete_elements = DiscreteElements(self._core.discrete)

    @property
    def bodies(self):
        """The solid bodies by name."""
        found = {}
        for index, (name, corners, nodes) in enumerate(self._core.bodies()):
            connectivity = _array(nodes, corners, "u4")
            found[name] = Body(name, connectivity, lambda array, index=index: self._core.elements(index, array))
        return found

    @property
    def time(self):
        """Present time [s]; the load factor of a static run."""
        return self._core.progress()[0]

    @property
    def dt(self):
        """The next time step [s]."""
        return self._core.progress()[1]

    @property
    def steps(self):
        """Steps done."""
        return self._core.progress()[2]

    @property
    def is_over(self):
        """Whether the run has ended: its end is reached, `stop()` was called, it was interrupted, or a step failed."""
        return self._core.progress()[3]

    @property
    def status(self):
        """How the run ended: `"completed"`, `"interrupted"` or `"stopped"` (a step failed); `None` before that."""
        return self._core.progress()[4]

    @property
    def folder(self):
        """Results folder."""
        return Path(self._core.progress()[5])

    @property
    def energies(self):
        """The energy ledger at the last row of the history [J]."""
        return self._core.ledger()[0]

    @property
    def counts(self):
        """Numbers of nodes, elements, removed elements, damaged and broken edges, particles, contacts and bonds."""
        return self._core.ledger()[1]

    @property
    def state_hash(self):
        """Hash of everything that changes, as `summary.json` has it for the end of a run."""
        return self._core.state_hash()

    @property
    def warnings(self):
        """All warnings so far, as those of `Results`."""
        names = ("code", "text", "where", "remedy")
        return [dict(zip(names, warning)) for warning in self._core.warnings()]

    @property
    def probes(self):
        """Names of the probes that are columns of the history, with their units."""
        return dict(self._core.probes())

    def probe(self, name):
        """Times [s] and values of a probe so far."""
        times, values = self._core.probe(name)
        return _array(times, 1), _array(values, 1)

    @property
    def groups(self):
        """Names of the groups of the mesh."""
        return self._core.groups()

    def group(self, name):
        """Nodes of a group of the mesh: indices into the arrays of `nodes`."""
        return _array(self._core.group(name), 1, "u4")

    def add_load(self, function, group=None, nodes=None, particles=None):
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

    def step(self, count=1):
        """Steps `count` times; whether the run goes on."""
        return self._advance(count, float("inf"))

    def run(self, until=float("inf"), stop=None, every=1):
        """Steps to the end of the case, to a time, or until `stop(simulation)` is true.

        - `until`: time [s] at which the stepping ends, and can go on
        - `stop`: looked at after every `every` steps; once it is true the run is over, as if its end were reached
        """
        self._advance(_NO_LIMIT, until, stop and (lambda: stop(self)), every)

    def _advance(self, count, until, stop=None, every=1):
        """Whether the run goes on after `count` steps or the time `until`."""
        goes_on = self._core.step(count, until, stop, every)
        if not goes_on and self.status == "interrupted":
            # By another thread.
            raise KeyboardInterrupt(f"state saved in {self.folder}")
        return goes_on

    def stop(self):
        """Ends the run as if its end were reached."""
        self._core.stop()

    def finish(self):
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

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is None or not issubclass(kind, Exception):
            self.finish()
        return False
