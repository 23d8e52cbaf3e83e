"""An interactive view of a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import tables
from .vtk import Frame

if TYPE_CHECKING:
    from .results import Parts

#: What colours a view by itself, the first of these that there is.
_FIELDS = ("damage", "temperature", "broken_bonds", "strength_left", "displacement")
#: The colours of damage in the pictures of a report.
_DAMAGE = [[0.0, "#c9c8c2"], [0.5, "#e5946a"], [1.0, "#8f0f1c"]]
#: Parts that cover others, or lie inside them.
_HIDDEN = ("bonds", "contacts", "gas", "cracks")


def figure(parts: Parts, field: str | None, magnify: float) -> Any:
    """The parts of a frame at their places as a figure of plotly, see `Results.view`."""
    import plotly.graph_objects as plotly

    shown = {name: part for name, part in parts.items() if name not in _HIDDEN}
    known = {array for part in shown.values() for array in (*part.cell_data, *part.point_data)}
    field = field or next((usual for usual in _FIELDS if usual in known), "displacement")
    if field not in known:
        raise KeyError(f"no array {field!r}; {tables.nearest(field, known)}")
    drawn, ends = [], []
    for name, part in shown.items():
        places = part.points + magnify * part.point_data.get("displacement", 0.0)
        faces, cells = _outer_faces(part)
        by_cell = len(faces) > 0 and field in part.cell_data
        values = part.cell_data[field][cells] if by_cell else part.point_data.get(field)
        if values is not None and values.ndim > 1:
            values = np.linalg.norm(values, axis=1)
        x, y, z = places.T
        if len(faces):
            i, j, k = faces.T
            colours = {"color": "lightgrey"} if values is None else {
                "intensity": values, "intensitymode": "cell" if by_cell else "vertex", "coloraxis": "coloraxis"}
            drawn.append(plotly.Mesh3d(x=x, y=y, z=z, i=i, j=j, k=k, name=name, flatshading=True, showlegend=True, **colours))
        elif len(places):
            colours = {"color": "grey"} if values is None else {"color": values, "coloraxis": "coloraxis"}
            marker = {"size": 4, **colours}
            drawn.append(plotly.Scatter3d(x=x, y=y, z=z, mode="markers", name=name, marker=marker))
        if len(places):
            ends += [places.min(axis=0), places.max(axis=0)]
    result = plotly.Figure(drawn)
    unit = next((part.units[field] for part in shown.values() if field in part.units), "")
    title = f"{field} [{unit}]" if unit else field
    damage = {"colorscale": _DAMAGE, "cmin": 0.0, "cmax": 1.0}
    plain = {f"{axis}axis": {"showbackground": False} for axis in "xyz"}
    result.update_layout(
        scene={"aspectmode": "data", "camera": {"eye": {"x": 1.6, "y": -1.6, "z": 1.2}}, **plain},
        coloraxis={**(damage if field == "damage" else {"colorscale": "Viridis"}), "colorbar": {"title": title}},
        legend={"x": 0.0},
        margin={"l": 0, "r": 0, "b": 0, "t": 40},
        title=f"frame at {parts.time:.6g}",
    )
    width, height, depth = np.ptp(ends, axis=0) if ends else np.ones(3)
    if depth == 0.0:
        above = {"eye": {"x": 0, "y": 0, "z": 1.5}, "up": {"x": 0, "y": 1, "z": 0}, "projection": {"type": "orthographic"}}
        shape = {"x": 2 * width / max(width, height), "y": 2 * height / max(width, height), "z": 0.01}
        result.update_scenes(camera=above, aspectmode="manual", aspectratio=shape, zaxis={"visible": False})
        result.update_traces(lighting={"ambient": 1.0, "diffuse": 0.0}, selector={"type": "mesh3d"})
    return result


def _outer_faces(part: Frame) -> tuple[np.ndarray, np.ndarray]:
    """Triangles on the outside of a part, and the cell that each belongs to."""
    faces, owners, first = [np.empty((0, 3), dtype=int)], [np.empty(0, dtype=int)], 0
    for kind, nodes in part.cells:
        own = np.arange(first, first + len(nodes))
        first += len(nodes)
        if kind == "tetra":
            all_faces = np.concatenate([nodes[:, corners] for corners in ([0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2])])
            outside = _single(np.sort(all_faces, axis=1))
            faces.append(all_faces[outside])
            owners.append(np.tile(own, 4)[outside])
        elif nodes.shape[1] > 2:
            for last in range(2, nodes.shape[1]):
                faces.append(nodes[:, [0, last - 1, last]])
                owners.append(own)
    return np.concatenate(faces), np.concatenate(owners)


def _single(rows: np.ndarray) -> np.ndarray:
    """Which rows no other one equals."""
    order = np.lexsort(rows.T)
    same = (rows[order][1:] == rows[order][:-1]).all(axis=1)
    twice = np.zeros(len(rows), dtype=bool)
    twice[order[1:]] |= same
    twice[order[:-1]] |= same
    return ~twice
