"""What the compiled module offers to the package; not for users."""

import os
from collections.abc import Callable
from typing import Any

__version__: str

_Place = str | os.PathLike[str]
_Set = list[tuple[str, str]]

class Core:
    def __init__(self, case: _Place, set: _Set, output: _Place | None, threads: int | None, begin: tuple[bool, bool], told: tuple[bool, bool], /) -> None: ...
    def __getattr__(self, name: str) -> Callable[..., Any]: ...

def run(case: _Place, set: _Set, output: _Place | None, threads: int | None, begin: tuple[bool, bool], told: tuple[bool, bool]) -> tuple[str, bool]: ...
def study(
    case: _Place,
    given: tuple[_Set, list[tuple[str, list[str]]]],
    compare: list[str],
    output: _Place,
    begin: tuple[int, int | None, bool],
) -> list[tuple[str, str, str, list[tuple[str, str]], list[tuple[str, float]]]]: ...
def check(case: _Place, set: _Set) -> tuple[str, list[list[str]]]: ...
def explain(key: str | None = None) -> list[tuple[str, str, str, str]]: ...
def interrupt() -> None: ...
def clear_interrupt() -> None: ...
