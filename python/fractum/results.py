"""The results folder of a run."""

import json
import xml.etree.ElementTree as ElementTree
from functools import cached_property
from pathlib import Path

import numpy as np

from . import tables
from .vtk import Frame


class Results:
    """What a run left in its folder; files are read when they are asked for."""

    def __init__(self, folder):
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise FileNotFoundError(f"{self.folder}: no results folder")

    def __repr__(self):
        return f"Results({str(self.folder)!r})"

    @cached_property
    def summary(self):
        """`summary.json` as a dictionary: status, probes, energies, counts, expectations, hashes."""
        with open(self.folder / "summary.json", encoding="utf-8") as file:
            return json.load(file)

    @property
    def warnings(self):
        """All warnings of case and run: dictionaries with `code`, `text`, `where` and `remedy`."""
        return self.summary["warnings"]

    @property
    def probes(self):
        """Last values of the probes by name."""
        return {name: probe["final"] for name, probe in self.summary["probes"].items()}

    @cached_property
    def _history(self):
        path = self.folder / "history.csv"
        # A run under way, or one that was killed.
        return tables.read(path if path.exists() else path.with_suffix(".csv.part"))

    @property
    def history(self):
        """The history, a row for each record: time, energies, counts and probes."""
        return tables.table(self._history[0])

    @property
    def units(self):
        """Units of the columns of the history; `-` and `1` are pure numbers."""
        return self._history[1]

    @property
    def cracks(self):
        """Broken bonds, a row for each; none (`None`) where nothing could break."""
        return self._table("cracks.csv")

    @property
    def fragments(self):
        """Pieces of at least two nodes or particles, heaviest first; `None` without that file."""
        return self._table("fragments.csv")

    @property
    def velocities(self):
        """Largest velocities at the stations of `[[output.ppv]]`; `None` where none were asked for."""
        return self._table("ppv.csv")

    def _table(self, name):
        path = self.folder / name
        return tables.table(tables.read(path)[0]) if path.exists() else None

    @cached_property
    def _frames(self):
        """Times and files of the frames, in the order of `fields.pvd`."""
        path = self.folder / "fields.pvd"
        frames = []
        for entry in ElementTree.parse(path).getroot().iter("DataSet") if path.exists() else ():
            time, name = float(entry.get("timestep")), entry.get("name")
            if not frames or frames[-1][0] != time or name in frames[-1][1]:
                frames.append((time, {}))
            frames[-1][1][name] = self.folder / entry.get("file")
        return frames

    @property
    def times(self):
        """Times of the frames [s]."""
        return np.array([time for time, _ in self._frames])

    def fields(self, time=None):
        """The frame that is nearest to a time [s], the last one without a time.

        Returns a dictionary: name of the part (`"solid"`, `"discrete elements"`, `"bonded particles"`,
        `"loose particles"`, `"rigid bodies"`, `"bonds"`, `"cracks"`, `"gas"`) to a `Frame`. `Frame.to_meshio()` and `Frame.to_pyvista()` hand it to these libraries.
        """
        if not self._frames:
            raise FileNotFoundError(f"{self.folder}: no frames; output.fields of the case says when they are written")
        index = -1 if time is None else int(np.argmin(np.abs(self.times - time)))
        return {name: Frame(path) for name, path in self._frames[index][1].items()}
