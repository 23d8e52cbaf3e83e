"""Cantilever under an end load, after cases/cantilever-static/depth-8-standard.toml."""

import sys

import akantu as aka
import numpy as np
from scipy.sparse.linalg import spsolve

with open("beam.dat", "w") as file:
    file.write("material elastic [ \n name = concrete \n rho = 2400 \n E = 30e9 \n nu = 0 \n]\n")
aka.parseInput("beam.dat")
mesh = aka.Mesh(3)
mesh.read(sys.argv[1])
model = aka.SolidMechanicsModel(mesh)
model.initFull(_analysis_method=aka._static)
for axis in (aka._x, aka._y, aka._z):
    model.applyBC(aka.FixedValue(0.0, axis), "clamp")
# aka.FromTraction ends the wheel's program: each facet of the tip gives a third of its force to its corners.
nodes, force = mesh.getNodes(), np.zeros((mesh.getNbNodes(), 3))
facets = mesh.getConnectivity(aka._triangle_3)
facets = facets[(nodes[facets, 0] > 1 - 1e-9).all(axis=1)]
sides = nodes[facets[:, 1:]] - nodes[facets[:, :1]]
areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
for corner in facets.T:
    np.add.at(force, (corner, 1), 1e5 / 2**0.5 * areas / 3)
force[:, 2] = force[:, 1]
# The wheel has no linear solver: scipy solves its matrix.
model.assembleStiffnessMatrix()
stiffness = aka.AkantuSparseMatrix(model.getDOFManager().getMatrix("K")).tocsr()
free = np.flatnonzero(~model.getBlockedDOFs().ravel())
moved = np.zeros(force.size)
moved[free] = spsolve(stiffness[free][:, free], force.ravel()[free])
print(moved.reshape(-1, 3)[nodes[:, 0] > 1 - 1e-9, 1:].sum(axis=1).mean() / 2**0.5)
