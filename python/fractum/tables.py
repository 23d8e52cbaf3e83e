"""Tables: pandas where it is installed, else structured numpy arrays."""

import csv
import re

import numpy as np

try:
    import pandas
except ImportError:
    pandas = None

_HEADER = re.compile(r"^(.*?) \[(.*)\]$")


def table(columns):
    """A table of columns: a `pandas.DataFrame`, or a structured array with the same names."""
    if pandas is not None:
        return pandas.DataFrame(columns)
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    rows = max((len(array) for array in arrays.values()), default=0)
    made = np.empty(rows, dtype=[(name, _kind(array)) for name, array in arrays.items()])
    for name, array in arrays.items():
        made[name] = array
    return made


def _kind(array):
    """Texts of any length are objects in a structured array."""
    return object if array.dtype.kind in "US" else array.dtype


def read(path):
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


def _values(cells):
    """Whole numbers, numbers or texts, whatever all cells are."""
    for kind in (int, float):
        try:
            return np.array([kind(cell) for cell in cells], dtype=kind)
        except ValueError:
            pass
    return np.array(cells, dtype=object)
