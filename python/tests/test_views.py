"""PyVista opens the results of every kind of body, and warping moves all parts alike."""

import numpy as np
import pytest

import fractum
from conftest import ROOT

pyvista = pytest.importorskip("pyvista")


def frames(results):
    """Times and reader of the frames."""
    reader = pyvista.get_reader(str(results.folder / "fields.pvd"))
    assert np.all(np.diff(reader.time_values) > 0)
    return reader


def last_frame(results):
    """The parts of the last frame: files and data sets."""
    reader = frames(results)
    reader.set_active_time_value(reader.time_values[-1])
    files = [dataset.path for dataset in reader.active_datasets]
    return {str(file).split("/")[0]: part for file, part in zip(files, reader.read())}


def test_vtk_reads_frames_in_pieces(breaking, tmp_path):
    # PyVista itself has no reader of PVTP.
    from vtkmodules.vtkIOXML import vtkXMLPPolyDataReader, vtkXMLPUnstructuredGridReader

    results = [fractum.run(breaking, output=tmp_path / str(n), set={"output.fields.pieces": n}) for n in (1, 4)]
    whole, cut = (result.fields() for result in results)
    for name, reader in (("solid", vtkXMLPUnstructuredGridReader()), ("discrete elements", vtkXMLPPolyDataReader())):
        reader.SetFileName(str(cut[name].path))
        reader.Update()
        expected, read = pyvista.read(whole[name].path), pyvista.wrap(reader.GetOutput())
        numbers = read.point_data["GlobalNodeId"]
        assert expected.n_cells == read.n_cells and (expected.points[numbers] == read.points).all()
        assert (expected.point_data["velocity"][numbers] == read.point_data["velocity"]).all()
        assert cut[name].to_pyvista().n_cells == expected.n_cells
    cloud = cut["discrete elements"].to_pyvista()
    assert (cloud.points == pyvista.read(whole["discrete elements"].path).points).all() and "radius" in cloud.point_data


def moved(part, factor):
    """Points of a part warped by a factor."""
    return np.asarray(part.warp_by_vector("displacement", factor=factor).points)


def run(case, tmp_path, **changes):
    return fractum.run(case, set=changes, output=tmp_path / "out", threads=1)


def test_discrete_elements_move_with_the_solid(breaking, tmp_path):
    parts = last_frame(run(breaking, tmp_path))
    solid, discrete = parts["fields"], parts["particles"]
    assert discrete.n_points > 0 and solid.n_cells > 0
    # A discrete element sits on a node: together before, together after.
    distances = np.linalg.norm(np.asarray(solid.points)[None] - np.asarray(discrete.points)[:, None], axis=2)
    nodes = distances.argmin(axis=1)
    assert distances.min(axis=1).max() < 1e-12
    for factor in (1.0, 30.0):
        assert np.allclose(moved(solid, factor)[nodes], moved(discrete, factor), rtol=0.0, atol=1e-9 * factor)


def test_a_falling_block_lies_on_its_floor(tmp_path):
    parts = last_frame(run(ROOT / "cases" / "falling-block" / "block.toml", tmp_path, **{"solver.end": "2 ms"}))
    floor, block = moved(parts["rigid"], 1.0), moved(parts["fields"], 1.0)
    assert np.ptp(floor[:, 2]) == 0.0
    # It began on its edge at the floor and moved down by 4 mm; contact lets in a small part of that.
    assert abs(block[:, 2].min() - floor[0, 2]) < 1e-3


def test_loose_particles_and_rigid_bodies(ball, tmp_path):
    parts = last_frame(run(ball, tmp_path))
    assert {"particles", "rigid"} <= set(parts)
    assert np.abs(parts["particles"]["displacement"]).max() > 0.0
    assert np.array_equal(moved(parts["rigid"], 10.0), parts["rigid"].points)


def test_bonds_move_with_their_particles(tmp_path):
    case = ROOT / "cases" / "bonded-box" / "compression.toml"
    parts = last_frame(run(case, tmp_path, **{"bodies[0].particles": 300, "ramp": "side*sqrt(rho/E)"}))
    particles, bonds = moved(parts["particles"], 100.0), moved(parts["bonds"], 100.0)
    assert bonds.shape == particles.shape
    assert np.array_equal(bonds, particles)
    assert np.abs(particles - np.asarray(parts["particles"].points)).max() > 0.0
