#!/usr/bin/env python3
"""Where a bar first bears its strength if it also moves sideways: `python3 sideways.py [WIDTH_MM]`, with NumPy and SciPy.

The bar of coarse.toml after Love (A Treatise on the Mathematical Theory of Elasticity, art. 278): each section contracts by Poisson's
ratio times the strain, and its inertia sideways adds rho (nu r)^2 to the kinetic energy of strain rates, with r = width/sqrt(12).
The front of the pulse then overshoots, and its tension reaches the strength nearer to the end. Bulk viscosity acts on the change of
area, (1 - nu) times the rate of strain, and its pressure along the bar after both sides have given way is (1 - nu) of it.
"""

import sys

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

E, RHO, LENGTH, STRENGTH, PEAK, DURATION, RISE = 30e9, 2400.0, 0.4, 4e6, 12e6, 60e-6, 2e-6
ELEMENT, LINEAR, CELL = 0.5e-3, 0.06, 0.25e-3


def first_spall(nu, width):
    """Distance from the free end [m] at which the tension first reaches the strength."""
    speed, count = np.sqrt(E / RHO), round(LENGTH / CELL)
    sideways = nu**2 * width**2 / 12
    band = np.zeros((2, count + 1))
    band[1] = RHO * CELL
    band[1, [0, -1]] /= 2
    band[1, :-1] += RHO * sideways / CELL
    band[1, 1:] += RHO * sideways / CELL
    band[0, 1:] = -RHO * sideways / CELL
    mass = cholesky_banded(band)
    places = (np.arange(count) + 0.5) * CELL
    step, time = 0.4 * CELL / speed, 0.0
    u, v = np.zeros(count + 1), np.zeros(count + 1)
    while time < 150e-6:
        stress = E * np.diff(u) / CELL
        rate = np.minimum(np.diff(v) / CELL, 0)
        total = stress + LINEAR * RHO * speed * ELEMENT * (1 - nu) ** 2 * rate
        force = np.zeros(count + 1)
        force[:-1] += total
        force[1:] -= total
        force[0] += PEAK * (time / RISE if time < RISE else max(0, (DURATION - time) / (DURATION - RISE)))
        v += step * cho_solve_banded((mass, False), force)
        u += step * v
        time += step
        where = np.argmax(np.where(places > 0.25, stress, -np.inf))
        if stress[where] >= STRENGTH:
            return LENGTH - places[where]
    return np.nan


width = float(sys.argv[1]) / 1e3 if len(sys.argv) > 1 else 4e-3
for nu in (0, 0.1, 0.3, 0.4):
    print(f"nu = {nu}: {1e3 * first_spall(nu, width):.1f} mm")
