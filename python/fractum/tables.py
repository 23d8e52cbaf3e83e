"""Tables: pandas where it is installed, else structured numpy arrays."""

import csv
import difflib
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

try:
    import pandas
except ImportError:
    pandas = None

if pandas is not None:

    class _Frame(pandas.DataFrame):
        """A data frame whose error of a wrong column says the nearest one; what is made of it is a plain one."""

        def __getitem__(self, key: Any) -> Any:
            try:
                return super().__getitem__(key)
            except KeyError:
                if not isinstance(key, str):
                    raise
                raise KeyError(f"no column {key!r}; {nearest(key, self.columns)}") from None


class Named(dict[str, Any]):
    """Values by name, whose error of a wrong one says the nearest.

    - `what`: what the names are, as `probe`
    """

    def __init__(self, what: str, values: Any = ()) -> None:
        super().__init__(values)
        self._what = what

    def __missing__(self, name: str) -> Any:
        raise KeyError(f"no {self._what} {name!r}; {nearest(name, self)}")


_HEADER = re.compile(r"^(.*?) \[(.*)\]$")


def table(columns: dict[str, Any], units: dict[str, str] | None = None) -> Any:
    """A table of columns: a `pandas.DataFrame`, or a structured array with the same names.

    - `units`: unit of each column, kept in `attrs["units"]` of a data frame
    """
    if pandas is not None:
        frame = _Frame(columns)
        frame.attrs["units"] = dict(units or {})
        return frame
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    rows = max((len(array) for array in arrays.values()), default=0)
    made = np.empty(rows, dtype=[(name, _kind(array)) for name, array in arrays.items()])
    for name, array in arrays.items():
        made[name] = array
    return made


def with_units(table: Any) -> Any:
    """A data frame whose column heads name the units: `load [N]`. `table` is one of `Results`, which knows them."""
    units = getattr(table, "attrs", {}).get("units", {})
    return table.rename(columns={name: f"{name} [{unit}]" for name, unit in units.items() if unit})


def nearest(name: str, names: Iterable[str]) -> str:
    """What is said of a name that there is not: the nearest one, or all."""
    names = list(names)
    near = difflib.get_close_matches(str(name), map(str, names), n=1)
    return f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(map(str, names)) or 'none'}"


def _kind(array: np.ndarray) -> Any:
    """Texts of any length are objects in a structured array."""
    return object if array.dtype.kind in "US" else array.dtype


def read(path: Path) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """The columns of a CSV file, and the units that its header gives in brackets."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(csv.reader(file))
    header = lines[0] if lines else []
    # A run that was killed may leave a last line without its end.
    rows = [line for line in lines[1:] if len(line) == len(header)]
    columns, units = {}, {}
    for index, title in enumerate(header):
        named = _HEADER.match(title)
        name, unit = named.groups() if named else (title, "")
        columns[name] = _values([row[index] for row in rows])
        units[name] = unit
    return columns, units


def _values(cells: list[str]) -> np.ndarray:
    """Whole numbers, numbers or texts, whatever all cells are."""
    for kind in (int, float):
        try:
            return np.array([kind(cell) for cell in cells], dtype=kind)
        except ValueError:
            pass
    return np.array(cells, dtype=object)
