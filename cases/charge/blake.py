#!/usr/bin/env python3
"""Largest displacements by Blake (1952) for elastic.toml: `python3 blake.py`, or with another rise [s] behind it (needs numpy)."""

import sys

import numpy as np

E, NU, DENSITY, A, PRESSURE = 50e9, 0.25, 2600.0, 0.02, 10e6
RISE = float(sys.argv[1]) if len(sys.argv) > 1 else 12e-6
G = E / (2 * (1 + NU))
C = np.sqrt(E * (1 - NU) / ((1 + NU) * (1 - 2 * NU)) / DENSITY)
ALPHA = (1 - 2 * NU) / (1 - NU) * C / A
OMEGA = np.sqrt(1 - 2 * NU) / (1 - NU) * C / A

tau, step = np.linspace(0, 60e-6, 12001, retstep=True)
s = np.clip(tau / RISE, 0, 1)
ramp = s**3 * (10 - 15 * s + 6 * s * s)
to_a_step = 1 - np.exp(-ALPHA * tau) * (np.cos(OMEGA * tau) + ALPHA / OMEGA * np.sin(OMEGA * tau))
psi = PRESSURE * A**3 / (4 * G) * np.convolve(np.gradient(ramp, step), to_a_step)[: len(tau)] * step
for r in (0.02, 0.04, 0.08):
    u = psi / r**2 + np.gradient(psi, step) / (C * r)
    print(f"r = {1e3 * r:.0f} mm: at most {1e6 * u.max():.4f} um, at rest {1e6 * PRESSURE * A**3 / (4 * G * r**2):.4f} um")
