"""Cohesive cracks on both sides of a pressurised circular hole in an infinite plane, without finite elements.

A crack is a row of dislocations beside the hole, whose stresses on its line follow from the complex potentials of Muskhelishvili. Traction falls linearly with the
opening, and the liquid presses on all of the crack, the process zone included. For each length of the process zone and crack the pressure and the openings follow
from one linear system: python3 cases/liquid/borehole.py
"""

import numpy as np

RADIUS, YOUNG, POISSON, STRENGTH = 0.1, 30e9, 0.2, 5e6
ACROSS, ALONG = 10e6, 15e6  # compression of the far field across and along the crack
MODULUS = YOUNG / (1 - POISSON**2)


def stress(x, s):
    """Stress across the line y = 0 at x of a dislocation at s, 2/(x - s) plus what the hole without traction makes of it."""
    z = x.astype(complex)
    w, dw, d2w = RADIUS**2 / z, -(RADIUS**2) / z**2, 2 * RADIUS**2 / z**3
    f, df, d2f = 1 / (w - s), -1 / (w - s) ** 2, 2 / (w - s) ** 3
    g, dg = 1 / (w - s) + s / (w - s) ** 2, -1 / (w - s) ** 2 - 2 * s / (w - s) ** 3
    phi = -(f + z * df * dw + g * dw) - 1 / s
    dphi = -(2 * df * dw + z * (d2f * dw**2 + df * d2w) + dg * dw**2 + g * d2w)
    psi = -f * dw - dw * phi - w * dphi + dw / s
    return 2 / (x - s) + (2 * phi + z.conjugate() * dphi + psi).real


def path(energy, reach=6.0, count=500, growth=1.01):
    """Length, pressure, opening at the wall, and volume put in per depth and wing, for cracks that grow piece by piece."""
    ends = RADIUS + reach * RADIUS * (growth ** np.arange(count + 1) - 1) / (growth**count - 1)
    middle, size = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
    unit = MODULUS / (8 * np.pi)
    of_end = np.zeros((count, count + 1))
    for j in range(1, count + 1):  # one at the wall does nothing
        of_end[:, j] = unit * (stress(middle, ends[j]) + stress(-middle, ends[j]))
    of_piece = of_end[:, 1:] - of_end[:, :-1]
    of_hole = RADIUS**2 / middle**2
    far = -0.5 * (ALONG + ACROSS) * (1 + of_hole) + 0.5 * (ALONG - ACROSS) * (1 + 3 * of_hole**2)
    last_opening, broken, found = 2 * energy / STRENGTH, 0, []
    for length in range(1, count - 1):
        here = slice(0, length + 1)
        for gone in range(broken, length + 1):
            softens = np.arange(length) >= gone
            matrix, right = np.zeros((length + 1, length + 1)), -far[here]
            matrix[:, :length], matrix[:, length] = of_piece[here, :length], of_hole[here] + 1
            right[:length] += np.where(softens, STRENGTH, 0)
            right[length] += STRENGTH
            matrix[np.arange(length)[softens], np.arange(length)[softens]] += STRENGTH / last_opening
            solution = np.linalg.solve(matrix, right)
            opening, pressure = solution[:length], solution[length]
            if (opening[softens] < last_opening).all() and (opening[~softens] > 0.98 * last_opening).all():
                broken = gone
                wall = np.pi * RADIUS**2 * (1 + POISSON) / YOUNG * pressure
                volume = wall + (opening * size[:length] * (1 + of_hole[:length])).sum()
                found.append((ends[length] - RADIUS, pressure, opening[0], volume))
                break
    return np.array(found)


def main():
    print(f"strength at the wall met at {(3 * ACROSS - ALONG + STRENGTH) / 1e6:.3f} MPa without liquid in the crack, at half of that with it")
    for energy in (32.0, 128.0):
        found = path(energy)
        most = found[found[:, 1].argmax()]
        print(f"{energy:.0f} J/m2: largest pressure {most[1] / 1e6:.3f} MPa as the crack is {most[0]:.3f} m long")
        for volume in (4e-5,):
            length, pressure, opening = (np.interp(volume, found[:, 3], found[:, k]) for k in range(3))
            print(f"  after {volume:.1e} m2 per wing {pressure / 1e6:.3f} MPa, {opening:.4e} m at the wall, {length:.3f} m long")


if __name__ == "__main__":
    main()
