#!/usr/bin/env python3
"""Pulls a plate with a slit across its middle apart along a cohesive line, by finite elements of its own, and prints the largest load
(needs numpy and scipy).

The quarter x, y > 0 of the plate of `plate.toml`, by symmetry, in plane stress: bilinear squares, graded towards the tip of the slit. The line ahead of the
tip bears the strength until it opens, then falls exponentially with the opening. The opening at the tip is prescribed, so that the load may fall.

Its own checks: without a slit the load is the strength, and a long slit in a high plate runs at the stress intensity of linear elastic fracture mechanics,
K = s sqrt(pi a / cos(pi a / 2 W)) (Feddersen 1966).
"""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

E, NU, STRENGTH, ENERGY, THICKNESS = 30e9, 0.2, 3e6, 100.0, 0.1
ZONE = E * ENERGY / STRENGTH**2


def graded(parts):
    """Coordinates from [begin, end, first step, last step] of each part."""
    points = [parts[0][0]]
    for begin, end, first, last in parts:
        mean = first if first == last else (last - first) / np.log(last / first)
        steps = np.geomspace(first, last, max(2, round((end - begin) / mean)))
        points.extend(begin + np.cumsum(steps) * (end - begin) / steps.sum())
    return np.array(points)


class Quarter:
    """The quarter of a plate of half length `a` of the slit, half width W, half height H [m], with squares of `h` at the tip, condensed to its line."""

    def __init__(self, a, width, height, h):
        far = width / 12
        slit = [[0.0, a, min(far, a / 3), h]] if a > 0 else []
        fine = min(a + 60 * h, 0.5 * (a + width))
        self.x = x = graded(slit + [[a, fine, h, h], [fine, width, h, far]])
        y = graded([[0.0, 12 * h, h, h], [12 * h, height, h, far]])
        nx, ny = len(x), len(y)
        node = np.arange(nx * ny).reshape(nx, ny)
        plane = E / (1 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
        corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], -1).reshape(-1, 4)
        dx = np.repeat(np.diff(x), ny - 1)
        dy = np.tile(np.diff(y), nx - 1)
        stiffness = np.zeros((len(corners), 8, 8))
        for s in (-1, 1):
            for t in (-1, 1):
                s_, t_ = s / 3**0.5, t / 3**0.5
                along = np.array([-(1 - t_), 1 - t_, 1 + t_, -(1 + t_)]) / 4
                across = np.array([-(1 - s_), -(1 + s_), 1 + s_, 1 - s_]) / 4
                b = np.zeros((len(corners), 3, 8))
                b[:, 0, 0::2] = b[:, 2, 1::2] = along * (2 / dx)[:, None]
                b[:, 1, 1::2] = b[:, 2, 0::2] = across * (2 / dy)[:, None]
                stiffness += np.einsum("eki,kl,elj,e->eij", b, plane, b, dx * dy / 4 * THICKNESS)
        unknown = np.stack([2 * corners, 2 * corners + 1], -1).reshape(-1, 8)
        rows, columns = np.repeat(unknown, 8, 1).ravel(), np.tile(unknown, 8).ravel()
        whole = coo_matrix((stiffness.ravel(), (rows, columns))).tocsc()
        # The line's opening and the motion of the top are given; the left side keeps its x.
        line = 2 * node[x >= a - 1e-9 * width, 0] + 1
        top = 2 * node[:, -1] + 1
        given = np.concatenate([line, top])
        fixed = 2 * node[0, :]
        free = np.setdiff1d(np.arange(2 * nx * ny), np.concatenate([given, fixed]))
        inner = splu(whole[free][:, free])
        shape = np.zeros((len(given), len(line) + 1))
        shape[: len(line), : len(line)] = np.eye(len(line))
        shape[len(line) :, -1] = 1.0
        coupling = whole[free][:, given] @ shape
        self.stiffness = shape.T @ (whole[given][:, given] @ shape) - coupling.T @ inner.solve(coupling)
        position = x[x >= a - 1e-9 * width]
        share = np.zeros(len(position))
        share[:-1] += 0.5 * np.diff(position)
        share[1:] += 0.5 * np.diff(position)
        self.area = share * THICKNESS

    def largest_load(self, last, steps=1000):
        """Load on the whole plate [N] for openings at the tip up to `last` [m]."""
        count = len(self.area)
        half_opening, top = np.zeros(count), 0.0
        stiff = 1e3 * E / self.x[-1]
        loads = []
        onset = 0.5 * STRENGTH / stiff
        for tip in np.append(onset, np.linspace(onset, 0.5 * last, steps + 1)[1:]):
            half_opening[0] = tip
            for _ in range(100):
                motion = np.append(half_opening, top)
                bears, slope = traction(2 * half_opening, stiff)
                residual = (self.stiffness @ motion)[:count] + bears * self.area
                if np.abs(residual).max() < 1e-9 * STRENGTH * self.area.max():
                    break
                matrix = self.stiffness[:count].copy()
                matrix[:, :count] += np.diag(2 * slope * self.area)
                # The tip is given; the motion of the top is unknown in its place.
                matrix[:, 0] = matrix[:, count]
                change = np.linalg.solve(matrix[:, :count], -residual)
                top += change[0]
                half_opening[1:] += change[1:]
            else:
                raise RuntimeError(f"no equilibrium at {2 * tip} m")
            loads.append(2 * (self.stiffness @ np.append(half_opening, top))[-1])
            if loads[-1] < 0.99 * max(loads):
                break
        return max(loads)


def traction(opening, stiff):
    """What the line bears [Pa], stiff until its strength, and its slope."""
    onset = STRENGTH / stiff
    beyond = np.maximum(opening - onset, 0.0)
    fallen = STRENGTH * np.exp(-STRENGTH * beyond / (ENERGY - 0.5 * STRENGTH * onset))
    slope = -fallen * STRENGTH / (ENERGY - 0.5 * STRENGTH * onset)
    return np.where(opening < onset, stiff * opening, fallen), np.where(opening < onset, stiff, slope)


def main():
    whole = Quarter(0.0, ZONE, ZONE, 0.05 * ZONE).largest_load(150e-6) / (2 * ZONE * THICKNESS * STRENGTH)
    a = 300 * ZONE
    long = Quarter(a, 3 * a, 9 * a, 0.05 * ZONE).largest_load(150e-6) / (6 * a * THICKNESS)
    elastic = (E * ENERGY * np.cos(np.pi / 6) / (np.pi * a)) ** 0.5
    print(f"checks: no slit {whole - 1:+.2%} of the strength; slit of 300 process zones {long / elastic - 1:+.2%} of elastic fracture")
    for a in (0.5, 2.0, 8.0):
        for h in (0.05, 0.025):
            load = 0.5 * Quarter(a * ZONE, 3 * a * ZONE, 3 * a * ZONE, h * ZONE).largest_load(150e-6)
            print(f"half slit {a:g} process zones, squares of {h:g}: {load / 1e3:.2f} kN on half a plate", flush=True)


if __name__ == "__main__":
    main()
