"""Whole runs: one, or one for each combination of values."""

import json
from pathlib import Path

from . import _core, tables
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


def study(case, vary=None, workers=1, set=None, output=None, threads=1, overwrite=False, compare=()):
    """Runs a case with every combination of values, as `fractum study` does; a table with a row for each run.

    - `case`: a case file, a study file or a list of runs
    - `vary`: keys with their values: `{"nu": [0.1, 0.2], "materials.rock.young_modulus": ["40 GPa", "50 GPa"]}`
    - `workers`: runs at the same time, each with `threads` threads
    - `output`: folder of the study; `results/sweep/<case>` by default
    - `overwrite`: run again what has finished there before
    - `compare`: what else is compared: `["max(load)", "strength = max(load) / (10 mm * 1 m)"]`

    Columns: what differs from run to run, `status` (`completed`, `stopped`, `failed`), `folder`, `error`, the last value of
    each probe, and what is compared. A run that fails is a row with the reason; the others go on. Ctrl-C ends all runs,
    saves their states and raises `KeyboardInterrupt`; the same call goes on with them.
    """
    output = Path(output) if output is not None else Path("results/sweep") / Path(case).stem
    vary = {str(key): {_written(value): value for value in values} for key, values in (vary or {}).items()}
    given = overrides(set), [(key, list(values)) for key, values in vary.items()]
    runs = _core.study(case, given, list(compare), output, (max(1, workers), threads, overwrite))
    places = [dict(coordinates) for _, _, _, coordinates, _ in runs]
    texts = {key: {text.strip('"'): value for text, value in values.items()} for key, values in vary.items()}
    columns = {}
    for axis in dict.fromkeys(axis for place in places for axis in place):
        values = [place.get(axis, "") for place in places]
        if axis in vary or any(value != values[0] for value in values):
            columns[axis] = [texts.get(axis, {}).get(value, value) for value in values]
    columns["status"] = [status for _, status, _, _, _ in runs]
    columns["folder"] = [str(folder) for folder, _, _, _, _ in runs]
    columns["error"] = [error for _, _, error, _, _ in runs]
    finished = [status in ("completed", "stopped") for status in columns["status"]]
    probes = [Results(folder).probes if has else {} for folder, has in zip(columns["folder"], finished)]
    found = [{**last, **dict(values)} for last, (_, _, _, _, values) in zip(probes, runs)]
    for name in sorted({name for values in found for name in values}):
        values = [values.get(name) for values in found]
        columns[name] = [float("nan") if value is None else value for value in values]
    return tables.table(columns)


#: Another word for the same.
sweep = study
