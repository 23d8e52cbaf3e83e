"""The results folder of a run."""

from __future__ import annotations

import html
import json
import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from . import tables, view
from .vtk import Frame


#: Pictures of the last instant, those that say most first.
_PICTURES = ("damage", "cracks", "broken_bonds", "temperature", "stress", "particles")


class Parts(dict[str, Frame]):
    """The parts of a scene at one time, by name: `"solid"`, `"discrete elements"`, `"bonded particles"`, `"loose particles"`,
    `"rigid bodies"`, `"bonds"`, `"cracks"`, `"gas"`, `"interfaces"`, `"contacts"`. `time` [s]."""

    def __init__(self, time: float, files: dict[str, Path]) -> None:
        super().__init__({name: Frame(path) for name, path in files.items()})
        self.time = time

    def __missing__(self, name: str) -> Frame:
        raise KeyError(f"no part {name!r}; {tables.nearest(name, self)}")


class Frames(Sequence[Parts]):
    """All frames of a run in their order; each is read when it is asked for."""

    def __init__(self, index: list[tuple[float, dict[str, Path]]]) -> None:
        self._index = index

    @property
    def times(self) -> np.ndarray:
        """Their times [s]; steps of a static run."""
        return np.array([time for time, _ in self._index])

    def __len__(self) -> int:
        return len(self._index)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return Frames(self._index[index])
        return Parts(*self._index[index])

    def __repr__(self) -> str:
        of = f" from {self._index[0][0]:.4g} to {self._index[-1][0]:.4g}" if self._index else ""
        return f"<{len(self)} frames{of}>"


@dataclass(frozen=True, repr=False)
class Probe:
    """A probe over the run: `times` [s], `values` in `unit`, and `final`, `max`, `min`, `time_of_max` over all steps.

    `times` and `values` are the rows of the history, which may miss the largest value; `max` does not.
    """

    name: str
    unit: str
    times: np.ndarray
    values: np.ndarray
    final: float
    max: float
    min: float
    time_of_max: float

    def __repr__(self) -> str:
        at = f" at {self.time_of_max:.4g} s" if self.time_of_max is not None else ""
        numbers = [f"{word} {getattr(self, word):.6g}" for word in ("max", "min", "final") if getattr(self, word) is not None]
        return f"<probe {self.name!r} [{self.unit}]: {', '.join(numbers)}{at}>"


class Results:
    """What a run left in its folder; files are read when they are asked for."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise FileNotFoundError(f"{self.folder}: no results folder")

    def __repr__(self) -> str:
        if not (self.folder / "summary.json").exists():
            return f"<Results {str(self.folder)!r}: no summary.json, the run has not ended>"
        peaks = [f"{name} up to {probe['max']:.4g} {probe['unit']}" for name, probe in self._measured()]
        count = len(self.warnings)
        told = f"; {count} warning{'s' if count > 1 else ''}" if count else ""
        return f"<Results {str(self.folder)!r}: {self.summary['status']}; {', '.join(peaks) or 'no probes'}{told}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: status, probes, warnings."""
        if not (self.folder / "summary.json").exists():
            return html.escape(repr(self))
        cell = lambda value: "<td>" + ("" if value is None else f"{value:.6g}" if isinstance(value, (int, float)) else html.escape(str(value))) + "</td>"
        heads = "".join(f"<th>{head}</th>" for head in ("probe", "unit", "final", "max", "min", "time of max [s]"))
        rows = "".join(
            "<tr>" + "".join(map(cell, (name, *(probe.get(key) for key in ("unit", "final", "max", "min", "time_of_max"))))) + "</tr>"
            for name, probe in self.summary["probes"].items()
        )
        told = "".join(f"<li><b>{html.escape(w['code'] or '')}</b> {html.escape(w['text'])}</li>" for w in self.warnings)
        status = f"<p>{html.escape(str(self.folder))}: <b>{html.escape(str(self.summary['status']))}</b></p>"
        return f"{status}<table><tr>{heads}</tr>{rows}</table>" + (f"<ul>{told}</ul>" if told else "")

    def _measured(self) -> list[tuple[str, dict[str, Any]]]:
        return [(name, probe) for name, probe in self.summary["probes"].items() if probe.get("max") is not None]

    @cached_property
    def summary(self) -> dict[str, Any]:
        """`summary.json` as a dictionary: status, probes, energies, counts, expectations, hashes."""
        path = self.folder / "summary.json"
        if not path.exists():
            raise FileNotFoundError(f"{self.folder}: no summary.json: a run has not ended here; name its results folder")
        return json.loads(path.read_text(encoding="utf-8"))

    @property
    def warnings(self) -> list[dict[str, str]]:
        """All warnings of case and run: dictionaries with `code`, `text`, `where` and `remedy`."""
        return self.summary["warnings"]

    @property
    def probes(self) -> dict[str, float]:
        """Last values of the probes by name."""
        return tables.Named("probe", {name: probe["final"] for name, probe in self.summary["probes"].items()})

    def probe(self, name: str) -> Probe:
        """A probe with its values over the run and their largest, least and last.

        Raises `KeyError` with the nearest name where there is none of that name.
        """
        known = self.summary["probes"]
        if name not in known:
            raise KeyError(f"no probe {name!r}; {tables.nearest(name, known)}")
        columns, found = self._history[0], known[name]
        values = columns.get(name, np.array([]))
        times = columns["time"] if len(values) else np.array([])
        return Probe(name, found["unit"], times, values, *(found.get(key) for key in ("final", "max", "min", "time_of_max")))

    @cached_property
    def _history(self) -> tuple[dict[str, np.ndarray], dict[str, str]]:
        # A run under way, or one that was killed, has an unfinished one.
        for name in ("history.csv", "history.csv.part"):
            if (self.folder / name).exists():
                return tables.read(self.folder / name)
        raise FileNotFoundError(f"{self.folder}: no history.csv; name the results folder of a run")

    @property
    def history(self) -> Any:
        """The history, a row for each record: time, energies, counts and probes. `attrs["units"]` of a data frame has the units."""
        return tables.table(*self._history)

    @property
    def units(self) -> dict[str, str]:
        """Units of the columns of the history; `-` and `1` are pure numbers."""
        return tables.Named("column", self._history[1])

    @property
    def cracks(self) -> Any:
        """Broken bonds, a row for each; none (`None`) where nothing could break."""
        return self._table("cracks.csv")

    @property
    def fragments(self) -> Any:
        """Pieces of at least two nodes or particles, heaviest first; `None` without that file."""
        return self._table("fragments.csv")

    @property
    def velocities(self) -> Any:
        """Largest velocities at the stations of `[[output.ppv]]`; `None` where none were asked for."""
        return self._table("ppv.csv")

    def _table(self, name: str) -> Any:
        path = self.folder / name
        return tables.table(*tables.read(path)) if path.exists() else None

    @cached_property
    def frames(self) -> Frames:
        """All frames in the order of `fields.pvd`: `for parts in results.frames: parts.time, parts["solid"]`."""
        path = self.folder / "fields.pvd"
        frames: list[tuple[float, dict[str, Path]]] = []
        for entry in ElementTree.parse(path).getroot().iter("DataSet") if path.exists() else ():
            time, name = float(entry.get("timestep")), entry.get("name")
            if not frames or frames[-1][0] != time or name in frames[-1][1]:
                frames.append((time, {}))
            frames[-1][1][name] = self.folder / entry.get("file")
        return Frames(frames)

    @property
    def times(self) -> np.ndarray:
        """Times of the frames [s]; steps of a static run."""
        return self.frames.times

    def fields(self, time: float | None = None, nearest: bool = False) -> Parts:
        """The frame at a time [s], the last one without a time: a dictionary of its parts, each a `Frame`.

        A frame is at a time if it is within a tenth of the distance to its neighbours, since steps seldom end at round times. Elsewhere
        `ValueError` names the frames around it; with `nearest` the nearest one is taken wherever it is.
        """
        if not len(self.frames):
            raise FileNotFoundError(f"{self.folder}: no frames; output.fields of the case says when they are written")
        if time is None:
            return self.frames[-1]
        if not isinstance(time, (int, float, np.number)):
            raise TypeError(f"time is {time!r}; expected a number, in s")
        away = np.abs(self.times - time)
        index = int(np.argmin(away))
        others = np.abs(np.delete(self.times, index) - self.times[index])
        if not nearest and away[index] > 0.1 * others.min(initial=np.inf):
            near = ", ".join(f"{self.times[i]:.6g}" for i in sorted(np.argsort(away)[:2]))
            raise ValueError(f"no frame at {time:.6g} s; the nearest are at {near}: ask for one, or take it with nearest=True")
        return self.frames[index]

    def show(self, name: str | None = None, ax: Any = None) -> Any:
        """Draws a picture of the last instant with matplotlib, as the report has it; its axes.

        - `name`: `"damage"`, `"cracks"`, `"broken_bonds"`, `"temperature"`, `"stress"` or `"particles"`; by default the first of these that there is
        - `ax`: axes to draw into

        `KeyError` names the nearest picture where there is none of a name.
        """
        import matplotlib.pyplot as plt

        known = {path.stem: path for path in (self.folder / "pictures").glob("*.png") if not path.stem.startswith("strip-")}
        name = name or next((usual for usual in _PICTURES if usual in known), "damage")
        if name not in known:
            raise KeyError(f"no picture {name!r}; {tables.nearest(name, known)}")
        ax = ax or plt.subplots(figsize=(8, 7))[1]
        ax.imshow(plt.imread(known[name]))
        ax.set_axis_off()
        return ax

    def view(
        self, path: str | os.PathLike[str] | None = None, time: float | None = None, field: str | None = None, magnify: float = 1.0
    ) -> Any:
        """An interactive view of a frame, which turns and zooms in a notebook or in any browser; a figure of plotly.

        - `path`: page to write (`"view.html"`), which needs no network and no other file
        - `time` [s]: as of `fields`; the last frame by default
        - `field`: array that colours it, vectors by their size; damage, temperature, broken bonds or displacement by default
        - `magnify`: factor on displacements

        `KeyError` names the nearest array where there is none of a name.
        """
        figure = view.figure(self.fields(time), field, magnify)
        if path is not None:
            figure.write_html(path, include_plotlyjs=True, default_height="95vh")
        return figure

    def plot(self, *names: str, x: str = "time", ax: Any = None) -> Any:
        """Plots columns of the history over another one with matplotlib; its axes.

        - `names`: probes, energies or counts; all probes by default
        - `x`: another column, as `opening`
        - `ax`: axes to plot into

        Columns of one unit share an axis of that name. `KeyError` names the nearest column where there is none of a name.
        """
        import matplotlib.pyplot as plt

        columns, units = self._history
        names = names or tuple(name for name in self.summary["probes"] if name in columns)
        for name in (x, *names):
            if name not in columns:
                raise KeyError(f"no column {name!r}; {tables.nearest(name, columns)}")
        ax = ax or plt.subplots()[1]
        for name in names:
            ax.plot(columns[x], columns[name], label=name)
        shared = {units[name] for name in names}
        ax.set_xlabel(f"{x} [{units[x]}]")
        ax.set_ylabel(f"{names[0]} [{units[names[0]]}]" if len(names) == 1 else " and ".join(f"[{unit}]" for unit in sorted(shared)))
        if len(names) > 1:
            ax.legend()
        return ax
