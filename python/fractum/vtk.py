"""Reader of the VTK files that the program writes (XML with raw appended arrays)."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from .tables import Named

_KINDS = {
    "Float64": "f8",
    "Float32": "f4",
    "Int64": "i8",
    "Int32": "i4",
    "Int8": "i1",
    "UInt8": "u1",
    "UInt32": "u4",
    "UInt64": "u8",
}

#: Names of cells as meshio has them, by the number that VTK gives them.
_CELLS = {1: "vertex", 3: "line", 5: "triangle", 7: "polygon", 10: "tetra"}

_DATA = b'<AppendedData encoding="raw">'


class Frame:
    """Points, cells and fields of one part of a scene at one time.

    - `points`: array (n, 3) [m], without displacement
    - `cells`: list of pairs of a name (`"tetra"`, `"triangle"`, `"vertex"`, `"line"`) and an array of point numbers
    - `point_data`, `cell_data`, `field_data`: dictionaries of arrays
    - `units`: unit of each array that has one
    - `path`: the file; `time` [s]
    """

    time: float | None
    points: np.ndarray
    cells: list[tuple[str, np.ndarray]]
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, np.ndarray]
    field_data: dict[str, np.ndarray]
    units: dict[str, str]

    def __init__(self, path: str | Path) -> None:
        self.path = path
        if str(path).endswith((".pvtu", ".pvtp")):
            self._read_pieces()
        else:
            self._read()

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(nodes)} {kind}" for kind, nodes in self.cells)
        at = "" if self.time is None else f" at {self.time:.4g} s"
        data = [f"{name} on {where}" for where, arrays in (("points", self.point_data), ("cells", self.cell_data)) for name in arrays]
        return f"<Frame{at}: {len(self.points)} points, {cells or 'no cells'}; {', '.join(data) or 'no arrays'}>"

    def _read_pieces(self) -> None:
        """The pieces that a file lists, put together by the numbers of their points."""
        root = ElementTree.parse(self.path).getroot()
        pieces = [Frame(Path(self.path).parent / tag.get("Source")) for tag in root[0].iter("Piece")]
        numbers = [piece.point_data.pop("GlobalNodeId") for piece in pieces]
        self.time, self.field_data, self.units = pieces[0].time, pieces[0].field_data, pieces[0].units
        self.points = _put([piece.points for piece in pieces], numbers)
        names = pieces[0].point_data
        self.point_data = Named("array", {name: _put([piece.point_data[name] for piece in pieces], numbers) for name in names})
        names = pieces[0].cell_data
        self.cell_data = Named("array", {name: np.concatenate([piece.cell_data[name] for piece in pieces]) for name in names})
        self.cells = []
        for piece, own in zip(pieces, numbers):
            for kind, nodes in piece.cells:
                same = self.cells and self.cells[-1][0] == kind
                before = [self.cells.pop()[1]] if same else []
                self.cells.append((kind, np.concatenate([*before, own[nodes]])))

    def _read(self) -> None:
        path = self.path
        with open(path, "rb") as file:
            content = file.read()
        head, mark, rest = content.partition(_DATA)
        if not mark:
            raise ValueError(f"{path}: no raw appended data; expected a VTK file of fractum")
        data = memoryview(rest)[rest.index(b"_") + 1 :]
        root = ElementTree.fromstring(head + b"</VTKFile>")
        arrays = _Appended(root, data)
        self.units = arrays.units
        grid = root[0]
        piece = grid.find("Piece")
        self.field_data = arrays.of(grid.find("FieldData"))
        time = self.field_data.get("TimeValue")
        self.time = None if time is None else float(time.ravel()[0])
        self.points = arrays.of(piece.find("Points"))["Points"]
        self.point_data = arrays.of(piece.find("PointData"))
        self.cell_data = arrays.of(piece.find("CellData"))
        self.cells = []
        if grid.tag == "UnstructuredGrid":
            cells = arrays.of(piece.find("Cells"))
            self.cells = _blocks(cells["connectivity"], cells["offsets"], cells["types"])
        else:
            for section, kind in (("Verts", 1), ("Lines", 3), ("Polys", 7)):
                cells = arrays.of(piece.find(section))
                if len(cells.get("offsets", ())):
                    kinds = np.full(len(cells["offsets"]), kind)
                    self.cells += _blocks(cells["connectivity"], cells["offsets"], kinds)

    def to_meshio(self) -> Any:
        """As a `meshio.Mesh`."""
        import meshio

        ends = np.cumsum([len(nodes) for _, nodes in self.cells])[:-1]
        cell_data = {name: np.split(values, ends) for name, values in self.cell_data.items()}
        return meshio.Mesh(self.points, self.cells, point_data=self.point_data, cell_data=cell_data)

    def to_pyvista(self) -> Any:
        """As a data set of PyVista."""
        import pyvista

        if not str(self.path).endswith(".pvtp"):
            return pyvista.read(self.path)
        # Only points are cut into such pieces, of which PyVista has no reader.
        cloud = pyvista.PolyData(self.points)
        for name, values in self.point_data.items():
            cloud.point_data[name] = values
        return cloud


def _put(parts: list[np.ndarray], numbers: list[np.ndarray]) -> np.ndarray:
    """Rows of pieces at their places in the whole."""
    count = max((int(own.max()) + 1 for own in numbers if len(own)), default=0)
    whole = np.zeros((count, *parts[0].shape[1:]), dtype=parts[0].dtype)
    for part, own in zip(parts, numbers):
        whole[own] = part
    return whole


class _Appended:
    """The arrays of a file, and the units that it names."""

    def __init__(self, root: ElementTree.Element, data: memoryview) -> None:
        self.units: dict[str, str] = Named("array with a unit")
        self.data = data
        self.order = "<" if root.get("byte_order") == "LittleEndian" else ">"
        self.compressed = root.get("compressor") is not None

    def of(self, section: ElementTree.Element | None) -> dict[str, np.ndarray]:
        """The arrays of a section, by name."""
        found = Named("array")
        for tag in () if section is None else section.iter("DataArray"):
            kind = np.dtype(self.order + _KINDS[tag.get("type")])
            values = np.frombuffer(self._bytes(int(tag.get("offset"))), dtype=kind)
            components = int(tag.get("NumberOfComponents", 1))
            name = tag.get("Name")
            found[name] = values.reshape(-1, components) if components > 1 else values
            unit = next((key.text for key in tag.iter("InformationKey") if key.get("name") == "UNITS_LABEL"), None)
            if unit:
                self.units[name] = unit
        return found

    def _numbers(self, at: int, count: int) -> list[int]:
        return np.frombuffer(self.data, dtype=self.order + "u8", count=count, offset=at).tolist()

    def _bytes(self, at: int) -> bytes:
        if not self.compressed:
            (length,) = self._numbers(at, 1)
            return bytes(self.data[at + 8 : at + 8 + length])
        blocks, _, _ = self._numbers(at, 3)
        lengths = self._numbers(at + 24, blocks)
        at += 8 * (3 + blocks)
        parts = []
        for length in lengths:
            parts.append(zlib.decompress(self.data[at : at + length]))
            at += length
        return b"".join(parts)


def _blocks(nodes: np.ndarray, ends: np.ndarray, kinds: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Runs of cells of one kind and size."""
    sizes = np.diff(ends, prepend=0)
    breaks = np.flatnonzero((np.diff(kinds) != 0) | (np.diff(sizes) != 0)) + 1
    starts = [0, *breaks.tolist(), len(kinds)]
    blocks = []
    for first, last in zip(starts[:-1], starts[1:]):
        if last > first:
            part = nodes[ends[first] - sizes[first] : ends[last - 1]]
            name = _CELLS.get(int(kinds[first]), f"VTK {int(kinds[first])}")
            blocks.append((name, part.reshape(last - first, -1)))
    return blocks
