"""Whole runs: one, or one for each combination of values."""

import concurrent.futures
import itertools
import json
from pathlib import Path

from . import _core, tables
from .errors import FractumError
from .results import Results


def overrides(values):
    """Keys and values as `--set` takes them."""
    return [(str(name), _written(value)) for name, value in (values or {}).items()]


def _written(value):
    """A value as text of a case file; texts such as "2 mm/s" stay as they are."""
    if isinstance(value, str):
        return value
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(str(k))} = {_inner(v)}" for k, v in value.items()) + " }"
    return _inner(value)


def _inner(value):
    """A value within another one, where a text needs its quotes."""
    if isinstance(value, dict):
        return _written(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_inner(entry) for entry in value) + "]"
    return json.dumps(value)


def run(case, set=None, output=None, threads=None, resume=False, quiet=True, overwrite=False, strict=False):
    """Runs a case to its end, as `fractum run` does; its `Results`.

    - `set`: parameters or dotted keys with their values: `{"velocity": "2 mm/s", "solver.safety": 0.5}`
    - `output`: results folder; `results/<folder>/<case>` by default
    - `threads`: all cores by default; results do not depend on it
    - `resume`: go on from the last checkpoint
    - `overwrite`: replace results that the folder holds
    - `quiet`: no plan and no progress line; warnings are shown all the same
    - `strict`: warnings are errors

    Raises `CaseError`, `StoppedError`, `MachineError`. Ctrl-C saves the state and raises `KeyboardInterrupt`; the run goes
    on with `resume=True`.
    """
    folder, interrupted = _core.run(case, overrides(set), output, threads, (resume, overwrite), (quiet, strict))
    if interrupted:
        raise KeyboardInterrupt(f"state saved in {folder}")
    return Results(folder)


def sweep(case, vary, workers=1, set=None, output=None, threads=1, overwrite=False):
    """Runs a case with every combination of values; a table with a row for each run.

    - `vary`: keys with their values: `{"nu": [0.1, 0.2], "materials.rock.young_modulus": ["40 GPa", "50 GPa"]}`
    - `workers`: runs at the same time, each with `threads` threads
    - `output`: folder for the results folders of all runs; `results/sweep/<case>` by default
    - `overwrite`: replace results of earlier runs

    Columns: the varied keys, `status` (`completed`, `stopped`, `failed`), `folder`, `error`, and the last value of each
    probe. A run that fails is a row with the reason; the others go on. Ctrl-C ends all runs and raises
    `KeyboardInterrupt`.
    """
    output = Path(output) if output is not None else Path("results/sweep") / Path(case).stem
    keys = list(vary)
    points = list(itertools.product(*(list(values) for values in vary.values())))
    digits = len(str(len(points)))
    folders = [output / f"{index:0{digits}d}" for index in range(1, len(points) + 1)]

    def one(point, folder):
        values = {**(set or {}), **dict(zip(keys, point))}
        try:
            return run(case, values, folder, threads, overwrite=overwrite), ""
        except FractumError as error:
            return (Results(folder) if (folder / "summary.json").exists() else None), str(error)

    with concurrent.futures.ThreadPoolExecutor(max(1, workers)) as executor:
        pending = [executor.submit(one, point, folder) for point, folder in zip(points, folders)]
        try:
            while concurrent.futures.wait(pending, timeout=0.1).not_done:
                pass
        except KeyboardInterrupt:
            _end(pending)
            raise
    return _collect(keys, points, folders, [future.result() for future in pending])


def _end(pending):
    """Ends the runs of a sweep, with the state of each saved."""
    for future in pending:
        future.cancel()
    _core.interrupt()
    concurrent.futures.wait(pending)
    _core.clear_interrupt()


def _collect(keys, points, folders, ended):
    """The table of a sweep."""
    columns = {key: [point[index] for point in points] for index, key in enumerate(keys)}
    columns["status"] = [results.summary["status"] if results else "failed" for results, _ in ended]
    columns["folder"] = [str(folder) for folder in folders]
    columns["error"] = [error for _, error in ended]
    probes = [results.probes if results else {} for results, _ in ended]
    for name in sorted({name for values in probes for name in values}):
        found = [values.get(name) for values in probes]
        columns[name] = [float("nan") if value is None else value for value in found]
    return tables.table(columns)
