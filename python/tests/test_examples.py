"""The recipes and notebooks run as they stand."""

import ast
import json

import numpy as np
import pytest

import load_cost
import moving_load
import read_results
import stop_at_crack
import sweep_strength
from conftest import ROOT


def test_moving_load(tmp_path):
    results = moving_load.main(tmp_path)
    assert results.summary["status"] == "completed"
    assert results.summary["energy"]["residual_max_relative"] < 1e-9
    # The static deflection of a clamped beam under F at its middle is F L^3 / (192 E I) = 6.3e-5 m in the theory of slender beams.
    assert -3e-4 < results.probes["middle"] and -3e-4 < min(results.history["middle"]) < -1e-5


def test_stop_at_crack(tmp_path):
    results = stop_at_crack.main(tmp_path)
    assert results.summary["time"]["end"] < 1e-3
    assert max(results.history["load"]) == pytest.approx(3e4, rel=0.05)


def test_sweep_strength(tmp_path):
    table = sweep_strength.main(tmp_path)
    assert list(table["status"]) == ["completed"] * 6


def test_read_results(tmp_path, capsys):
    results = read_results.main(tmp_path)
    assert len(results.fragments["mass"]) == 2 and "crack at x" in capsys.readouterr().out


def test_load_cost(tmp_path):
    found = load_cost.main(tmp_path, cells=(4, 4, 4), steps=5, rounds=1)
    assert len(found) == 6 and all(np.isfinite(cost) for cost in found.values())


NOTEBOOKS = ROOT / "python" / "examples"


@pytest.mark.parametrize("name", sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb")))
def test_notebook(name, tmp_path, monkeypatch):
    """Cell after cell, where the last expression of each is shown."""
    pytest.importorskip("matplotlib").use("Agg")
    pytest.importorskip("pandas")
    # In a folder with examples two above, as that of the notebooks.
    folder = tmp_path / "python" / "examples"
    folder.mkdir(parents=True)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(folder)
    cells = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text())["cells"]
    names, shown = {}, []
    for cell in (cell for cell in cells if cell["cell_type"] == "code"):
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, name, "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), name, "eval"), names)
            shown.append(getattr(value, "_repr_html_", value.__repr__)())
    assert len(shown) >= 2 and all(shown)
    for value, low, high in FOUND[name](names):
        assert low < value < high, f"{value} not from {low} to {high}"


def _near(value, expected, share):
    """A value with bounds around what is expected."""
    return value, *sorted((expected * (1 - share), expected * (1 + share)))


#: Values of each notebook, between bounds that are a formula's or a law's.
FOUND = {
    "first_crack": lambda n: [(n["load"].max / n["brittle"], 1, 2), (n["taken"], 70, 100)],
    # The finest mesh with smoothed elements.
    "mesh_study": lambda n: [_near(list(n["study"]["tip"])[-1], n["theory"], 0.02)],
    "job_beam": lambda n: [(n["taken"], 20, 40)],
    "job_tunnel": lambda n: [_near(n["before"], n["kirsch"], 0.03), (n["half"] - n["wave"], 0, 0.1e-3)],
    "job_tile": lambda n: [(n["stiffness"] / n["plate"], 0.8, 1)],
    "job_cylinder": lambda n: [_near(n["modulus"], 50e9, 0.03), _near(n["stress"].max, 100e6, 0.1)],
    "job_quench": lambda n: [_near(n["face"].values[-1], n["theory"][-1], 0.01)],
    "job_study": lambda n: [(n["found"].mean(), n["mean"] - 2 * n["deviation"] / 12**0.5, n["mean"] + 2 * n["deviation"] / 12**0.5)],
}
