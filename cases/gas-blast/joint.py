"""Volume of joints on both sides of a hole, with one pressure in hole and joints, in the middle of a disc.

A row of dislocations beside the hole, as in cases/liquid/borehole.py, gives the volume V of one joint in an infinite plane. Far from both joints their stress is that of the
potentials Phi = A/z^2 and Psi = 2 A/z^2 with A = E' V/(4 pi). What takes it off the edge of a disc of the radius R is at its middle a tension of 6 A/R^2 across the joints, which
opens them as the pressure does: python3 cases/gas-blast/joint.py
"""

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1] / "liquid"))
from borehole import RADIUS, stress  # noqa: E402

REACH, EDGE = 0.8, 4.0  # end of the joint and of the disc, from the middle of the hole [m]


def volume(count):
    """Volume of one joint per depth over pressure/E' [m^2], E' = E/(1 - nu^2)."""
    # Pieces become small towards the tip as well as at the wall.
    ends = RADIUS + (REACH - RADIUS) * 0.5 * (1 - np.cos(np.pi * np.arange(count + 1) / count))
    middle = 0.5 * (ends[1:] + ends[:-1])
    of_end = np.zeros((count, count + 1))
    for j in range(1, count + 1):
        of_end[:, j] = (stress(middle, ends[j]) + stress(-middle, ends[j])) / (8 * np.pi)
    solution = np.linalg.solve(of_end[:, 1:] - of_end[:, :-1], -(RADIUS**2 / middle**2 + 1))
    return solution @ np.diff(ends)


if __name__ == "__main__":
    for count in (100, 200, 400, 800):
        found = volume(count)
        print(f"{count} pieces: {found:.4f} p/E', in the disc {found * (1 + 1.5 * found / (np.pi * EDGE**2)):.4f} p/E'")
