#!/usr/bin/env python3
"""Makes a mesh of a geometry and cuts it into files of a part each, for `mesh.parts`: `pip install gmsh==4.15.2`, then
`python3 parts.py charge/charge.geo 3 charge/parts.msh`. A mesh instead of the geometry is cut as it is."""

import sys

import gmsh


def cut(mesh, count, to):
    """Has Gmsh (METIS) partition a mesh, and write NAME_1.msh, NAME_2.msh and so on."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.open(mesh)
    if mesh.endswith(".geo"):
        gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.PartitionSplitMeshFiles", 1)
    gmsh.model.mesh.partition(count)
    gmsh.write(to)
    gmsh.finalize()


if __name__ == "__main__":
    cut(sys.argv[1], int(sys.argv[2]), sys.argv[3])
