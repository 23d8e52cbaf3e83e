"""Pressure wave along a bar, after cases/wave-bar/p-standard."""

import sys

import akantu as aka
import numpy as np

LENGTH, RISE, END = 0.4, 20e-6, 150e-6

with open("wave.dat", "w") as file:
    file.write("material elastic [ \n name = concrete \n rho = 2400 \n E = 30e9 \n nu = 0.2 \n]\n")
aka.parseInput("wave.dat")
mesh = aka.Mesh(3)
mesh.read(sys.argv[1])
model = aka.SolidMechanicsModel(mesh)
model.initFull(_analysis_method=aka._explicit_lumped_mass)
step = 0.8 * model.getStableTimeStep()
model.setTimeStep(step)
for axis in (aka._y, aka._z):
    model.applyBC(aka.FixedValue(0.0, axis), "lateral")
model.applyBC(aka.FixedValue(0.0, aka._x), "left")
nodes = mesh.getNodes()
left, right = np.flatnonzero(nodes[:, 0] < 1e-9), np.flatnonzero(nodes[:, 0] > LENGTH - 1e-9)
displacement, velocity = model.getDisplacement(), model.getVelocity()


def speed(t):
    s = 1 - abs(t / RISE - 1)
    return 1e-3 * s * s * (3 - 2 * s) if s > 0 else 0.0


arrival, place = np.zeros(int(END / step) + 1), 0.0
for n in range(len(arrival)):
    place += step * speed((n + 0.5) * step)
    displacement[left, 0] = place
    model.solveStep()
    arrival[n] = velocity[right, 0].mean()
t = step * (np.arange(len(arrival)) + 1)
print(LENGTH / ((t * arrival).sum() / arrival.sum() - RISE), len(arrival))
