"""Bar pulled apart, after cases/tension-bar/gmsh-coarse.toml; cohesive elements come in where the strength of its weak slab is met."""

import sys

import akantu as aka
import numpy as np

AREA, END, SLAB = 400e-6, 6e-3, 2.1e-3
TIMES, SPEEDS = [0, 0.5e-3, 2.2e-3, 3e-3], [0, 5e-3, 5e-3, 50e-3]

with open("bar.dat", "w") as file:
    file.write("""model solid_mechanics_model_cohesive [
  material elastic [ \n name = concrete \n rho = 2400 \n E = 30e9 \n nu = 0.2 \n ]
  material cohesive_linear [ \n name = crack \n sigma_c = 2.7e6 \n G_c = 100 \n beta = 1 \n ]
]
""")
aka.parseInput("bar.dat")
mesh = aka.Mesh(3)
mesh.read(sys.argv[1])
model = aka.SolidMechanicsModelCohesive(mesh)
model.initFull(_analysis_method=aka._explicit_lumped_mass, _is_extrinsic=True)
step = 0.2 * model.getStableTimeStep()
model.setTimeStep(step)
for side in ("left", "right"):
    model.applyBC(aka.FixedValue(0.0, aka._x), side)
model.getElementInserter().setLimit(aka._x, -SLAB, SLAB)
model.updateAutomaticInsertion()
right = np.flatnonzero(mesh.getNodes()[:, 0] > 0.05 - 1e-9)


def speed(t):
    n = np.searchsorted(TIMES, t) - 1
    if n == 3:
        return SPEEDS[3]
    s = (t - TIMES[n]) / (TIMES[n + 1] - TIMES[n])
    return SPEEDS[n] + (SPEEDS[n + 1] - SPEEDS[n]) * s * s * (3 - 2 * s)


place, peak, steps = 0.0, 0.0, int(END / step) + 1
for n in range(steps):
    place += step * speed((n + 0.5) * step)
    model.getDisplacement()[right, 0] = place
    model.checkCohesiveStress()
    model.solveStep()
    if n % 20 == 0:
        peak = max(peak, abs(model.getInternalForce()[right, 0].sum()))
print(peak / AREA, model.getEnergy("dissipated") / AREA, steps)
