"""Whole runs: one, or one for each combination of values; what a run would do, and what the keys of a case mean."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _core, tables
from .results import Results

#: Where a file or a folder is.
Place = str | os.PathLike[str]


def overrides(values: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """Keys and values as `--set` takes them."""
    return [(str(name), _written(value)) for name, value in (values or {}).items()]


def _written(value: Any) -> str:
    """A value as text of a case file; texts such as "2 mm/s" stay as they are."""
    if isinstance(value, str):
        return value
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(str(k))} = {_inner(v)}" for k, v in value.items()) + " }"
    return _inner(value)


def _inner(value: Any) -> str:
    """A value within another one, where a text needs its quotes."""
    if isinstance(value, dict):
        return _written(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_inner(entry) for entry in value) + "]"
    return json.dumps(value)


def run(
    case: Place,
    set: Mapping[str, Any] | None = None,
    output: Place | None = None,
    threads: int | None = None,
    resume: bool = False,
    quiet: bool = True,
    overwrite: bool = False,
    strict: bool = False,
) -> Results:
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


@dataclass(frozen=True, repr=False)
class Check:
    """What `fractum check` says of a case: its plan, and what is doubtful, as `Results.warnings` has it."""

    plan: str
    warnings: list[dict[str, str]]

    def __repr__(self) -> str:
        told = [f"{w['where']}: {w['text']}" + (f"; {w['remedy']}" if w["remedy"] else "") for w in self.warnings]
        return "\n".join([self.plan, *(f"warning: {line}" for line in told)])

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(repr(self))}</pre>"


def check(case: Place, set: Mapping[str, Any] | None = None) -> Check:
    """What a run of the case would do, and what is doubtful, as `fractum check` says it; nothing is written.

    Raises `CaseError` where the case is wrong.
    """
    plan, warnings = _core.check(case, overrides(set))
    return Check(plan, [dict(zip(("code", "text", "where", "remedy"), warning)) for warning in warnings])


@dataclass(frozen=True, repr=False)
class Key:
    """A key of the case file: its `path`, `meaning`, `type`, `default`, and the keys right `below` it."""

    path: str
    meaning: str
    type: str
    default: str
    below: tuple[Key, ...] = ()

    def __repr__(self) -> str:
        default = f", default: {self.default}" if self.default else ""
        text = f"{self.path}\n  {self.meaning}\n  type: {self.type}{default}"
        return "\n\n".join([text, *map(repr, self.below)])

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(repr(self))}</pre>"


def explain(key: str | None = None) -> Any:
    """What a key of the case file means, with the keys right below it; a table of all keys without a name.

    Raises `CaseError` with the nearest key where there is none of that name.
    """
    found = [Key(*row) for row in _core.explain(key)]
    if key is None:
        return tables.table({name: [getattr(row, name) for row in found] for name in ("path", "meaning", "type", "default")})
    return Key(found[0].path, found[0].meaning, found[0].type, found[0].default, tuple(found[1:]))


def new(template: str | None = None, folder: Place | None = None, overwrite: bool = False) -> Any:
    """Writes a case that runs as it stands, with its mesh, as `fractum new` does; the path of its case.

    - `template`: its name; without one a table of all comes back, and nothing is written
    - `folder`: where to; a folder of that name by default
    - `overwrite`: replace a case that the folder has

    The template `study` has a `study.toml` beside its case, for `fractum.study`. Raises `CaseError` with the nearest name where there is
    no such template, and for a folder that has a case.
    """
    if template is None:
        names, whats = zip(*_core.templates())
        return tables.table({"name": list(names), "what": list(whats)})
    return Path(_core.new(template, folder, overwrite))


def study(
    case: Place,
    vary: Mapping[str, Sequence[Any]] | None = None,
    workers: int = 1,
    set: Mapping[str, Any] | None = None,
    output: Place | None = None,
    threads: int | None = 1,
    overwrite: bool = False,
    compare: Iterable[str] | Mapping[str, str | Callable[[Results], float]] = (),
) -> Any:
    """Runs a case with every combination of values, as `fractum study` does; a table with a row for each run.

    - `case`: a case file, a study file or a list of runs
    - `vary`: keys with their values: `{"nu": [0.1, 0.2], "materials.rock.young_modulus": ["40 GPa", "50 GPa"]}`
    - `workers`: runs at the same time, each with `threads` threads
    - `output`: folder of the study; `results/sweep/<case>` by default
    - `overwrite`: run again what has finished there before
    - `compare`: what else is compared: `["max(load)", "strength = max(load) / (10 mm * 1 m)"]`; or by names of columns, also with functions of
      the `Results` of a run: `{"strength": "max(load) / (10 mm * 1 m)", "mean": lambda results: results.history["load"].mean()}`

    Columns: what differs from run to run, `status` (`completed`, `stopped`, `failed`), `folder`, `error`, the last value of
    each probe, and what is compared. A run that fails is a row with the reason; the others go on. Ctrl-C ends all runs,
    saves their states and raises `KeyboardInterrupt`; the same call goes on with them.
    """
    output = Path(output) if output is not None else Path("results/sweep") / Path(case).stem
    vary = {str(key): {_written(value): value for value in values} for key, values in (vary or {}).items()}
    if not isinstance(compare, Mapping):
        compare = dict.fromkeys([compare] if isinstance(compare, str) else compare, "")
    texts = [f"{name} = {of}" if of else name for name, of in compare.items() if isinstance(of, str)]
    functions = {name: of for name, of in compare.items() if not isinstance(of, str)}
    given = overrides(set), [(key, list(values)) for key, values in vary.items()]
    runs = _core.study(case, given, texts, output, (max(1, workers), threads, overwrite))
    places = [dict(coordinates) for _, _, _, coordinates, _ in runs]
    written = {key: {text.strip('"'): value for text, value in values.items()} for key, values in vary.items()}
    columns = {}
    for axis in dict.fromkeys(axis for place in places for axis in place):
        values = [place.get(axis, "") for place in places]
        if axis in vary or any(value != values[0] for value in values):
            columns[axis] = [written.get(axis, {}).get(value, value) for value in values]
    columns["status"] = [status for _, status, _, _, _ in runs]
    columns["folder"] = [str(folder) for folder, _, _, _, _ in runs]
    columns["error"] = [error for _, _, error, _, _ in runs]
    finished = [status in ("completed", "stopped") for status in columns["status"]]
    results = [Results(folder) if has else None for folder, has in zip(columns["folder"], finished)]
    own = [run.probes | {name: of(run) for name, of in functions.items()} if run else {} for run in results]
    found = [{**last, **dict(values)} for last, (_, _, _, _, values) in zip(own, runs)]
    for name in sorted({name for values in found for name in values}):
        values = [values.get(name) for values in found]
        columns[name] = [float("nan") if value is None else value for value in values]
    return tables.table(columns)


#: Another word for the same.
sweep = study
