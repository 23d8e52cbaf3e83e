"""Simulations stepped from Python: their state, loads and conditions."""

import threading

import numpy as np
import pytest

import fractum


@pytest.mark.parametrize("which", ["breaking", "resting", "ball"])
def test_stepping_gives_the_state_hash_of_a_run(which, request, tmp_path):
    case = request.getfixturevalue(which)
    whole = fractum.run(case, output=tmp_path / "whole", threads=2)
    with fractum.Simulation(case, output=tmp_path / "stepped", threads=1) as simulation:
        while simulation.step():
            simulation.nodes.position  # looking changes nothing
        own = simulation.state_hash
    assert own == simulation.results.summary["state_hash"] == whole.summary["state_hash"]
    assert simulation.results.summary["counts"] == whole.summary["counts"]


def test_a_load_that_does_nothing_changes_no_bit(breaking, tmp_path):
    whole = fractum.run(breaking, output=tmp_path / "whole")
    with fractum.Simulation(breaking, output=tmp_path / "out", threads=1) as simulation:
        simulation.add_load(lambda time, position, velocity: (0, 0, 0), group="y+")
        simulation.run()
    assert simulation.results.summary["state_hash"] == whole.summary["state_hash"]


def test_a_load_in_python_is_that_of_the_case(elastic, tmp_path):
    text = elastic.read_text()
    weight = 'loads = [{ gravity = { y = "-9.81 m/s^2" } }]\n'
    (elastic.parent / "heavy.toml").write_text(text.replace("[materials", weight + "[materials", 1))
    last = {"solver.end": "0.5 ms"}
    with fractum.Simulation(elastic.parent / "heavy.toml", last, tmp_path / "case") as by_case:
        by_case.run()
        expected = by_case.nodes.displacement
    with fractum.Simulation(elastic, last, tmp_path / "python") as simulation:
        forces = simulation.nodes.mass[:, None] * np.array([0.0, -9.81, 0.0])
        simulation.add_load(lambda time, position, velocity: forces, nodes=np.arange(len(forces)))
        simulation.run()
        found = simulation.nodes.displacement
    assert np.abs(expected).max() > 1e-7
    assert found == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())
    energies = [s.results.summary["energy"] for s in (by_case, simulation)]
    assert energies[0]["external"] == pytest.approx(energies[1]["external"], rel=1e-10)
    assert energies[1]["residual_max_relative"] < 1e-9


def test_a_load_sees_position_and_velocity(ball, tmp_path):
    # A dashpot along x on a particle in free flight: v = v0 exp(-c t / m), in steps v0 Π (1 - c Δt / m).
    with fractum.Simulation(ball, {"solver.end": "0.1 us", "speed": "10 m/s", "angle": "90 deg"}, tmp_path / "out") as simulation:
        mass, dt = simulation.particles.mass[0], simulation.dt
        v0 = simulation.particles.velocity[0, 0]
        rate = 0.01 / dt
        seen = []

        def drag(time, position, velocity):
            seen.append((time, position[0, 0], velocity[0, 0]))
            return -rate * mass * velocity * [1, 0, 0]

        simulation.add_load(drag, particles=[0])
        simulation.step(10)
        found = simulation.particles.velocity[0, 0]
    times, places, speeds = np.array(seen).T
    assert times == pytest.approx(dt * np.arange(10)) and v0 > 1.0
    # The first kick is half a step.
    assert found == pytest.approx(v0 * (1 - 0.005) * (1 - 0.01) ** 9, rel=1e-3)
    assert np.diff(places) == pytest.approx(dt * speeds[1:], rel=1e-6)


def test_conditions_end_a_run_and_times_only_pause_it(breaking, tmp_path):
    with fractum.Simulation(breaking, output=tmp_path / "out") as simulation:
        simulation.run(until=0.1e-3)
        paused = simulation.time
        assert 0.1e-3 <= paused < 0.1e-3 + 2 * simulation.dt and not simulation.is_over
        calls = []

        def enough(one):
            calls.append(one.steps)
            return one.time > 0.15e-3

        simulation.run(stop=enough, every=3)
        assert simulation.is_over and simulation.status == "completed"
        assert set(np.diff(calls)) <= {3} and 0.15e-3 < simulation.time < 0.15e-3 + 4 * simulation.dt
        assert not simulation.step()
    assert simulation.results.summary["status"] == "completed"
    times, load = simulation.results.history["time"], simulation.results.history["load"]
    assert max(times) == pytest.approx(simulation.results.summary["time"]["end"]) and max(load) > 0


def test_the_state_is_that_of_the_results(breaking, tmp_path):
    with fractum.Simulation(breaking, output=tmp_path / "out") as simulation:
        simulation.run()
        body = simulation.bodies["bar"]
        state = {
            "points": simulation.nodes.reference,
            "displacement": simulation.nodes.displacement,
            "damage": body.damage[body.alive],
            "stress": body.stress[body.alive],
            "cells": body.connectivity[body.alive],
        }
        attached = np.ones(len(simulation.nodes.mass), dtype=bool)
        discrete = simulation.discrete_elements
        attached[discrete.node] = discrete.attached
        spheres = (discrete.position, discrete.radius)
        counts, (times, load) = simulation.counts, simulation.probe("load")
        with pytest.raises(ValueError):
            simulation.nodes.position[0, 0] = 1.0
    parts = simulation.results.fields()
    solid = parts["solid"]
    assert counts["removed_elements"] > 0 and len(spheres[1]) == counts["particles"] > 0
    assert (solid.points == state["points"]).all() and (solid.cells[0][1] == state["cells"]).all()
    assert (solid.point_data["displacement"] == state["displacement"]).all()
    assert (solid.point_data["attached"] == attached).all()
    assert solid.cell_data["damage"] == pytest.approx(state["damage"], rel=1e-6)
    assert solid.cell_data["stress"] == pytest.approx(state["stress"], rel=1e-6, abs=1.0)
    assert parts["discrete elements"].point_data["radius"] == pytest.approx(spheres[1])
    history = simulation.results.history
    assert list(history["load"])[: len(load)] == list(load) and list(history["time"])[: len(times)] == list(times)
    fragments = simulation.results.fragments
    assert sum(fragments["mass"]) == pytest.approx(2400 * 0.4 * 0.1 * 0.1, rel=0.05)


def test_frames_are_what_meshio_reads(breaking, tmp_path):
    meshio = pytest.importorskip("meshio")
    results = fractum.run(breaking, output=tmp_path / "out")
    frame = results.fields(time=0.25e-3, nearest=True)["solid"]
    assert frame.time == pytest.approx(results.times[np.argmin(abs(results.times - 0.25e-3))])
    read, own = meshio.read(frame.path), frame.to_meshio()
    assert (read.points == own.points).all()
    for mine, theirs in zip(own.cells, read.cells, strict=True):
        assert mine.type == theirs.type and (mine.data == theirs.data).all()
    assert set(own.point_data) == set(read.point_data) and set(own.cell_data) == set(read.cell_data)
    for name, values in read.point_data.items():
        assert (own.point_data[name] == values).all(), name


def test_frames_in_pieces_are_put_together(breaking, tmp_path):
    whole = fractum.run(breaking, output=tmp_path / "whole").fields()
    pieces = fractum.run(breaking, output=tmp_path / "pieces", set={"output.fields.pieces": 3}).fields()
    assert pieces["solid"].path.suffix == ".pvtu" and pieces["discrete elements"].path.suffix == ".pvtp"
    for name, part in whole.items():
        own = pieces[name]
        assert own.time == part.time and (own.points == part.points).all()
        for mine, theirs in zip(own.cells, part.cells, strict=True):
            assert mine[0] == theirs[0] and (mine[1] == theirs[1]).all()
        for mine, theirs in ((own.point_data, part.point_data), (own.cell_data, part.cell_data)):
            assert list(mine) == list(theirs)
            assert all((mine[field] == values).all() for field, values in theirs.items()), name


def test_mistakes_are_told(breaking, resting, tmp_path):
    simulation = fractum.Simulation(breaking, output=tmp_path / "out")
    with pytest.raises(fractum.CaseError, match="no probe is called \"lod\"; probes here: load"):
        simulation.probe("lod")
    with pytest.raises(fractum.CaseError, match="groups here: .*x-"):
        simulation.group("left")
    with pytest.raises(AttributeError, match="there are: reference"):
        simulation.nodes.colour
    with pytest.raises(TypeError, match="one of group, nodes and particles"):
        simulation.add_load(lambda *_: 0, group="x-", nodes=[1])
    with pytest.raises(fractum.CaseError, match="no point 100000"):
        simulation.add_load(lambda *_: 0, nodes=[100000])
    with pytest.raises(IndexError):
        simulation.add_load(lambda *_: 0, nodes=[-1])
    simulation.add_load(lambda time, position, velocity: np.zeros((2, 3)), group="x+")
    with pytest.raises(ValueError, match="broadcast"):
        simulation.step()
    assert simulation.steps == 0
    simulation.finish()
    with pytest.raises(fractum.CaseError, match="has been finished"):
        simulation.step()

    never = fractum.Simulation(breaking, output=tmp_path / "never")
    never.add_load(lambda time, position, velocity: (np.nan, 0, 0), group="x+")
    with pytest.raises(fractum.CaseError, match="finite numbers"):
        never.step()
    nested = fractum.Simulation(breaking, output=tmp_path / "nested")
    nested.add_load(lambda time, position, velocity: nested.step(), group="x+")
    with pytest.raises(fractum.CaseError, match="being stepped already"):
        nested.step()
    still = fractum.Simulation(resting, output=tmp_path / "still")
    still.add_load(lambda time, position, velocity: (0, 0, 0), group="x+")
    with pytest.raises(fractum.CaseError, match="solver.kind = \"explicit\""):
        still.step()


def test_a_simulation_may_be_looked_at_from_another_thread(breaking, tmp_path):
    with fractum.Simulation(breaking, output=tmp_path / "out", threads=1) as simulation:
        worker = threading.Thread(target=simulation.run)
        worker.start()
        seen, body = [], simulation.bodies["bar"]
        while worker.is_alive():
            seen.append(simulation.time)
            assert body.damage.max() <= 1.0
        worker.join()
        assert simulation.is_over and seen == sorted(seen)
