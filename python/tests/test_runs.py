"""Whole runs, their errors, sweeps and interrupts."""

import os
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import fractum
from fractum import _core, runs, tables

SHORT = {"solver.end": "0.3 ms"}


def program():
    """The program, where it has been built."""
    built = ROOT / "target" / "release" / "fractum"
    return str(built) if built.exists() else shutil.which("fractum")


@pytest.mark.skipif(program() is None, reason="the program has not been built")
def test_a_run_has_the_state_hash_of_the_program(breaking, tmp_path):
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out", threads=2)
    command = [program(), "run", breaking, "--quiet", "-o", tmp_path / "direct", "--set", "solver.end=0.3 ms"]
    subprocess.run(command, check=True)
    direct = fractum.Results(tmp_path / "direct")
    assert results.summary["state_hash"] == direct.summary["state_hash"]
    assert results.summary["counts"] == direct.summary["counts"]


def test_mistakes_of_a_case_are_exceptions_with_their_place(breaking, tmp_path):
    breaking.write_text(breaking.read_text().replace("poisson_ratio = 0.2", "poisson_ratio = 0.7"))
    with pytest.raises(fractum.CaseError, match=r"case.toml:\d+.*poisson_ratio = 0.7; expected") as caught:
        fractum.run(breaking, output=tmp_path / "out")
    (mistake,) = caught.value.diagnostics
    assert mistake["place"]["key"].endswith("poisson_ratio") and mistake["place"]["line"] > 0
    assert isinstance(caught.value, ValueError)
    with pytest.raises(fractum.CaseError, match="cannot be opened"):
        fractum.run(tmp_path / "none.toml")


def test_a_run_that_stops_itself_says_why(breaking, tmp_path):
    with pytest.raises(fractum.StoppedError, match="step"):
        fractum.run(breaking, set={"solver.safety": 1.5}, output=tmp_path / "out")
    assert fractum.Results(tmp_path / "out").summary["status"] == "stopped"


def test_a_template_is_a_case_that_can_be_checked(tmp_path, monkeypatch):
    case = fractum.new("plate", tmp_path / "mine")
    assert case == tmp_path / "mine" / "case.toml" and "load factor" in fractum.check(case).plan
    with pytest.raises(fractum.CaseError, match="exists already"):
        fractum.new("plate", tmp_path / "mine")
    case.write_text("")
    assert fractum.new("plate", tmp_path / "mine", overwrite=True).read_text()
    with pytest.raises(fractum.CaseError, match="did you mean quench?"):
        fractum.new("quenched")
    monkeypatch.chdir(tmp_path)
    assert fractum.new("study").with_name("study.toml").exists()
    assert "tunnel" in list(fractum.new()["name"])


def test_a_study_takes_any_statistic(breaking, tmp_path):
    compare = {"peak": "max(load)", "mean": lambda results: results.history["load"].mean(), "load": lambda results: 7}
    table = fractum.study(breaking, {"strength": ["2 MPa"]}, set=SHORT, output=tmp_path / "runs", compare=compare)
    history = fractum.Results(table["folder"][0]).history["load"]
    assert table["mean"][0] == pytest.approx(np.mean(history)) and table["load"][0] == 7
    assert table["peak"][0] >= max(history)
    with pytest.raises(fractum.CaseError, match="of a probe: max, min"):
        fractum.study(breaking, {"strength": ["2 MPa"]}, set=SHORT, output=tmp_path / "runs", compare="mean(load)")


def test_wrong_names_say_the_nearest_everywhere(breaking, tmp_path):
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out")
    solid = results.fields()["solid"]
    for of, name in [(results.probes, "lod"), (results.units, "lod"), (solid.cell_data, "damge"), (solid.units, "stres")]:
        with pytest.raises(KeyError, match="did you mean"):
            of[name]
    if tables.pandas:
        with pytest.raises(KeyError, match="no column 'lod'; did you mean 'load'?"):
            results.history["lod"]
        assert type(results.history[["time", "load"]]) is tables.pandas.DataFrame
        assert fractum.with_units(results.history).columns[0] == "time [s]"
    with pytest.raises(TypeError, match="expected a number, in s"):
        results.fields("3 ms")
    empty = fractum.Results(tmp_path)
    for look in (lambda: empty.summary, lambda: empty.probes, lambda: empty.history):
        with pytest.raises(FileNotFoundError, match="results folder"):
            look()


def test_pictures_are_shown_by_name(breaking, tmp_path):
    pytest.importorskip("matplotlib").use("Agg")
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out")
    assert results.show().images and results.show("stress").images
    with pytest.raises(KeyError, match="did you mean 'stress'?"):
        results.show("stresses")


def test_a_view_is_one_page_with_the_outside_of_the_solid(breaking, tmp_path):
    pytest.importorskip("plotly")
    results = fractum.run(breaking, output=tmp_path / "run")
    magnify = 50.0
    figure = results.view(tmp_path / "view.html", magnify=magnify)
    solid = results.fields()["solid"]
    drawn = next(part for part in figure.data if part.name == "solid")
    places = np.transpose([drawn.x, drawn.y, drawn.z])
    assert np.allclose(places, solid.points + magnify * solid.point_data["displacement"], rtol=0, atol=1e-12)
    # The outside is closed, and encloses what the elements fill.
    a, b, c = (places[np.array(corner)] for corner in (drawn.i, drawn.j, drawn.k))
    tetrahedra = places[solid.cells[0][1]]
    edges = tetrahedra[:, 1:] - tetrahedra[:, :1]
    filled = np.abs(np.linalg.det(edges)).sum() / 6
    assert np.allclose(np.cross(b - a, c - a).sum(axis=0), 0, atol=1e-12 * np.ptp(places) ** 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(filled, rel=1e-9)
    assert len(drawn.intensity) == len(drawn.i) and max(drawn.intensity) <= 1
    page = (tmp_path / "view.html").read_text(encoding="utf-8")
    assert "Plotly.newPlot" in page and 'src="http' not in page
    with pytest.raises(KeyError, match="damage"):
        results.view(field="damge")


def test_values_are_written_as_a_case_file_has_them():
    values = {"a": 0.5, "b": "2 mm/s", "c": ["1 mm", 2], "d": {"x": "1 m"}, "e": True, "f": np.float64(0.25)}
    written = dict(runs.overrides(values))
    assert written["a"] == "0.5" and written["b"] == "2 mm/s" and written["c"] == '["1 mm", 2]'
    assert written["d"] == '{ "x" = "1 m" }' and written["e"] == "true" and written["f"] == "0.25"


def test_a_sweep_is_a_table_with_failures(breaking, tmp_path):
    vary = {"strength": ["2 MPa", "3 MPa"], "materials.concrete.poisson_ratio": [0.2, 0.7]}
    table = fractum.sweep(breaking, vary, workers=2, set=SHORT, output=tmp_path / "runs")
    assert list(table["status"]) == ["completed", "failed"] * 2
    assert "poisson_ratio" in table["error"][1] and table["error"][0] == ""
    peak = [fractum.Results(table["folder"][run]).summary["probes"]["load"]["max"] for run in (0, 2)]
    # Strength times 0.01 m².
    assert peak == pytest.approx([2e4, 3e4], rel=0.02)
    assert np.isnan(table["load"][1]) and np.isfinite(table["load"][2])
    again = fractum.study(breaking, vary, set=SHORT, output=tmp_path / "runs", compare=["area = max(load) / (1 MPa)"])
    assert list(again["folder"]) == list(table["folder"]) and again["area"][0] == pytest.approx(peak[0] / 1e6)
    assert (tmp_path / "runs" / "study.md").exists()
    direct = fractum.run(breaking, set={**SHORT, "strength": "3 MPa"}, output=tmp_path / "direct")
    assert direct.summary["state_hash"] == fractum.Results(table["folder"][2]).summary["state_hash"]


def test_python_goes_on_while_a_run_computes(breaking, tmp_path):
    moments = []
    worker = threading.Thread(target=lambda: fractum.run(breaking, output=tmp_path / "out", threads=1))
    worker.start()
    while worker.is_alive():
        moments.append(time.monotonic())
        time.sleep(0.001)
    assert len(moments) > 5 and np.diff(moments).max() < 0.5 * (moments[-1] - moments[0])


def test_ctrl_c_saves_the_state_and_other_runs_may_follow(breaking, tmp_path):
    script = f"""
        import os, signal, threading, time
        import fractum
        # A shell starts what runs in the background with Ctrl-C ignored.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        case, out = {str(breaking)!r}, {str(tmp_path / "out")!r}
        long = {{"solver.end": "3 ms"}}
        def interrupt():
            while not os.path.exists(out + "/history.csv.part"):
                time.sleep(0.001)
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        try:
            fractum.run(case, set=long, output=out, threads=1)
            print("not interrupted")
        except KeyboardInterrupt:
            print(fractum.Results(out).summary["status"])
        print(fractum.run(case, set={SHORT}, output=out + "-next", threads=1).summary["status"])
        print(fractum.run(case, set=long, output=out, threads=1, resume=True).summary["state_hash"])
    """
    ended = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=100)
    said = ended.stdout.split()
    assert said[:2] == ["interrupted", "completed"], ended.stdout + ended.stderr
    whole = fractum.run(breaking, set={"solver.end": "3 ms"}, output=tmp_path / "whole")
    assert said[2] == whole.summary["state_hash"]


def test_an_interrupt_is_forgotten_after_a_sweep(breaking, tmp_path):
    _core.interrupt()
    try:
        with pytest.raises(KeyboardInterrupt):
            fractum.run(breaking, output=tmp_path / "out")
    finally:
        _core.clear_interrupt()
    assert fractum.run(breaking, set=SHORT, output=tmp_path / "next").summary["status"] == "completed"


def test_tables_without_pandas_are_arrays_with_the_same_columns(breaking, tmp_path, monkeypatch):
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out")
    with_pandas = results.history
    monkeypatch.setattr(tables, "pandas", None)
    plain = results.history
    assert isinstance(plain, np.ndarray) and plain["time"][-1] == pytest.approx(0.3e-3)
    assert list(plain.dtype.names) == list(with_pandas.dtype.names if tables.pandas else results.units)
    assert results.units["load"] == "N" and results.units["time"] == "s"
    table = fractum.sweep(breaking, {"strength": ["3 MPa"]}, set=SHORT, output=tmp_path / "runs")
    assert table["status"][0] == "completed" and fractum.Results(table["folder"][0]).probes


def test_results_speak_for_themselves(breaking, tmp_path):
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out")
    load = results.probe("load")
    assert load.unit == "N" and load.max >= load.values.max() and len(load.times) == len(load.values)
    assert "completed; load up to" in repr(results) and "<td>load</td><td>N</td>" in results._repr_html_()
    with pytest.raises(KeyError, match="did you mean 'load'"):
        results.probe("laod")
    with pytest.raises(KeyError, match="did you mean 'solid'"):
        results.fields()["solids"]
    solid = results.fields()["solid"]
    assert solid.units["stress"] == "Pa" and "tetra" in repr(solid)
    with pytest.raises(KeyError, match="did you mean 'displacement'"):
        solid.point_data["displacements"]
    if tables.pandas:
        assert results.history.attrs["units"]["load"] == "N" and "load [N]" in fractum.with_units(results.history)


def test_a_frame_is_taken_at_its_time_only(breaking, tmp_path):
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out")
    times = [parts.time for parts in results.frames]
    assert times == pytest.approx([0, 1e-4, 2e-4, 3e-4], abs=2e-6) and len(results.frames[1:]) == 3
    assert results.fields(1e-4).time == times[1]
    with pytest.raises(ValueError, match="the nearest are at 0.0001"):
        results.fields(1.4e-4)
    assert results.fields(1.4e-4, nearest=True).time == times[1]


def test_a_plot_has_the_units_of_its_columns(breaking, tmp_path):
    pytest.importorskip("matplotlib").use("Agg")
    results = fractum.run(breaking, set=SHORT, output=tmp_path / "out")
    axes = results.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "load [N]")
    assert results.plot("elastic", "damage", ax=axes) is axes and len(axes.lines) == 3
    with pytest.raises(KeyError, match="did you mean 'elastic'"):
        results.plot("elastics")


def test_check_says_what_a_run_would_do(breaking):
    found = fractum.check(breaking, set={"solver.end": "1 us"})
    assert "explicit" in found.plan and repr(found).startswith(found.plan)
    assert all(set(warning) == {"code", "text", "where", "remedy"} for warning in found.warnings)
    assert not (breaking.parent / "results").exists()
    with pytest.raises(fractum.CaseError, match="poisson_ratio"):
        fractum.check(breaking, set={"materials.concrete.poisson_ratio": 0.7})


def test_keys_are_explained():
    key = fractum.explain("solver.end")
    assert key.path == "solver.end" and key.type and key.meaning in repr(key)
    assert "solver.safety" in [below.path for below in fractum.explain("solver").below]
    with pytest.raises(fractum.CaseError, match='did you mean "solver.end"'):
        fractum.explain("solver.ends")
    assert "solver.end" in list(fractum.explain()["path"])


def test_the_package_has_types():
    assert (Path(fractum.__file__).parent / "py.typed").exists()
