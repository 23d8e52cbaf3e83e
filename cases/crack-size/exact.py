#!/usr/bin/env python3
"""Largest loads of cohesive cracks on known straight paths, by finite elements of its own (needs numpy and scipy).

    python exact.py                  checks, the plate of plate.toml, and the cylinder of penny.toml
    python exact.py scenes.csv      the scenes of a table, each with squares of two sizes

Plates with a slit across their middle, an edge notch or two edge notches are pulled apart by ends that stay straight; beams, notched or not, are bent by
three points. One half or quarter is meshed with bilinear squares, graded towards the root of the notch. The line ahead of it bears the strength until it
opens, then falls with the opening, exponentially or linearly. The opening at the root is prescribed, so that the load may fall.

Its own checks print the distance from: the strength of a plate without a slit; linear elastic fracture mechanics, for notches of hundreds of process zones
(Feddersen 1966, Srawley 1976, Tada et al. 1973, also those of revolution); the load of a fully plastic ligament, for a beam far smaller than a process zone; the modulus of rupture of
beams without a notch by Planas, Guinea & Elices (1995), with the stress under a point load by Timoshenko & Goodier (1951).
"""

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu


@dataclass
class Material:
    young: float = 30e9
    poisson: float = 0.2
    strength: float = 3e6
    energy: float = 100.0
    softening: str = "exponential"
    plane: str = "stress"

    def zone(self):
        """Length of the process zone [m]."""
        return self.young * self.energy / self.strength**2

    def matrix(self, round=False):
        """Stress along, across, in shear, and around if the body is one of revolution, from strain."""
        e, nu = self.young, self.poisson
        if round:
            volume = e * nu / ((1 + nu) * (1 - 2 * nu))
            return np.array([[1, 1, 0, 1], [1, 1, 0, 1], [0, 0, 0, 0], [1, 1, 0, 1]]) * volume + np.diag([1, 1, 0.5, 1]) * e / (1 + nu)
        if self.plane == "strain":
            e, nu = e / (1 - nu**2), nu / (1 - nu)
        return e / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])

    def traction(self, opening, stiff):
        """What the line bears [Pa], stiff until its strength, and its slope."""
        onset = self.strength / stiff
        energy = self.energy - 0.5 * self.strength * onset
        beyond = np.maximum(opening - onset, 0.0)
        if self.softening == "exponential":
            fallen = self.strength * np.exp(-self.strength * beyond / energy)
            slope = -fallen * self.strength / energy
        else:
            slope = -(self.strength**2) / (2 * energy)
            fallen = np.maximum(self.strength + slope * beyond, 0.0)
            slope = np.where(fallen > 0, slope, 0.0)
        return np.where(opening < onset, stiff * opening, fallen), np.where(opening < onset, stiff, slope)


def graded(parts):
    """Coordinates from [begin, end, first step, last step] of each part."""
    points = [parts[0][0]]
    for begin, end, first, last in parts:
        mean = first if first == last else (last - first) / np.log(last / first)
        steps = np.geomspace(first, last, max(2, round((end - begin) / mean)))
        points.extend(begin + np.cumsum(steps) * (end - begin) / steps.sum())
    return np.array(points)


class Piece:
    """The part above the line of the crack, y = 0, along which x runs from the mouth of the notch (or the middle of a slit) to `width`.

    The notch ends at `a`; squares at its root have the size `h` [m]. `kind` is "centre" (a quarter: the middle of the slit at x = 0), "edge" (a half),
    "double" (a quarter: the middle of the ligament at x = `width`) or "beam" (a half: y runs along the beam, a support at x = 0 and y = `height`).
    Bodies of revolution are "penny" (a disc-shaped crack, its axis at x = 0) and "ring" (a notch around a rod, its axis at x = `width`).
    """

    def __init__(self, kind, a, width, height, h, material=None, thickness=0.1, far=None):
        self.material = material or Material()
        beam = kind == "beam"
        far = far or width / (24 if beam else 12)
        slit = [[0.0, a, min(far, a / 3), h]] if a > 0 else []
        fine = min(a + 60 * h, 0.5 * (a + width))
        self.x = x = graded(slit + [[a, fine, h, h], [fine, width, h, far]])
        y = graded([[0.0, 12 * h, h, h], [12 * h, height, h, far]] + ([[height, height + width / 4, far, far]] if beam else []))
        nx, ny = len(x), len(y)
        node = np.arange(nx * ny).reshape(nx, ny)
        axis = {"penny": 0.0, "ring": width}.get(kind)
        elastic = self.material.matrix(axis is not None)
        radius = lambda at: at if axis is None else abs(at - axis)
        weight = lambda at: thickness + 0 * at if axis is None else 2 * np.pi * radius(at)
        corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], -1).reshape(-1, 4)
        dx = np.repeat(np.diff(x), ny - 1)
        dy = np.tile(np.diff(y), nx - 1)
        stiffness = np.zeros((len(corners), 8, 8))
        for s in (-1, 1):
            for t in (-1, 1):
                s_, t_ = s / 3**0.5, t / 3**0.5
                along = np.array([-(1 - t_), 1 - t_, 1 + t_, -(1 + t_)]) / 4
                across = np.array([-(1 - s_), -(1 + s_), 1 + s_, 1 - s_]) / 4
                b = np.zeros((len(corners), len(elastic), 8))
                b[:, 0, 0::2] = b[:, 2, 1::2] = along * (2 / dx)[:, None]
                b[:, 1, 1::2] = b[:, 2, 0::2] = across * (2 / dy)[:, None]
                at = np.repeat(x[:-1], ny - 1) + (1 + s_) * dx / 2
                if axis is not None:
                    # Motion is along x, away from the axis of a penny and towards that of a ring.
                    values = np.array([(1 - s_) * (1 - t_), (1 + s_) * (1 - t_), (1 + s_) * (1 + t_), (1 - s_) * (1 + t_)]) / 4
                    b[:, 3, 0::2] = values / (at - axis)[:, None]
                stiffness += np.einsum("eki,kl,elj,e->eij", b, elastic, b, dx * dy / 4 * weight(at))
        unknown = np.stack([2 * corners, 2 * corners + 1], -1).reshape(-1, 8)
        rows, columns = np.repeat(unknown, 8, 1).ravel(), np.tile(unknown, 8).ravel()
        whole = coo_matrix((stiffness.ravel(), (rows, columns))).tocsc()
        # The line's opening and the motion of the end or the support are given.
        ahead = x >= a - 1e-9 * width
        line = 2 * node[ahead, 0] + 1
        if beam:
            moved = np.array([2 * node[0, np.argmin(abs(y - height))]])
            fixed = np.array([2 * node[-1, 0]])
        else:
            moved = 2 * node[:, -1] + 1
            fixed = 2 * {"centre": node[0, :], "penny": node[0, :], "double": node[-1, :], "ring": node[-1, :], "edge": node[-1:, -1]}[kind]
        given = np.concatenate([line, moved])
        free = np.setdiff1d(np.arange(2 * nx * ny), np.concatenate([given, fixed]))
        inner = splu(whole[free][:, free])
        shape = np.zeros((len(given), len(line) + 1))
        shape[: len(line), : len(line)] = np.eye(len(line))
        shape[len(line) :, -1] = 1.0
        coupling = whole[free][:, given] @ shape
        self.stiffness = shape.T @ (whole[given][:, given] @ shape) - coupling.T @ inner.solve(coupling)
        position = x[ahead]
        # What a shape function of the line weighs: its own end of an interval counts twice.
        begin, end = weight(position[:-1]), weight(position[1:])
        self.area = np.zeros(len(position))
        self.area[:-1] += np.diff(position) * (2 * begin + end) / 6
        self.area[1:] += np.diff(position) * (begin + 2 * end) / 6
        # Reactions on one piece to the load on the whole body.
        self.pieces = 2 if kind in ("centre", "double", "beam") else 1

    def largest_load(self):
        """Load on the whole body [N]; for a beam that of the middle."""
        material = self.material
        count = len(self.area)
        stiff = 1e3 * material.young / min(self.x[-1], 30 * material.zone())
        tip = 0.5 * material.strength / stiff
        motion = self.equilibrium(np.zeros(count + 1), tip, stiff)
        largest = 0.0
        while 2 * tip < 5 * material.energy / material.strength:
            step = min(0.03 * tip, 0.003 * material.energy / material.strength)
            while (found := self.equilibrium(motion, tip + step, stiff)) is None:
                step *= 0.5
                if step < 1e-6 * tip:
                    raise RuntimeError(f"no equilibrium beyond {2 * tip} m")
            motion, tip = found, tip + step
            load = self.pieces * abs((self.stiffness @ motion)[-1])
            if load < 0.99 * largest:
                return largest
            largest = max(load, largest)
        if load == largest:
            raise RuntimeError("the load does not fall")
        return largest

    def equilibrium(self, motion, tip, stiff):
        """Half openings and the motion of the end from those of the step before, or None."""
        count = len(self.area)
        motion = motion.copy()
        motion[0] = tip
        for _ in range(30):
            bears, slope = self.material.traction(2 * motion[:count], stiff)
            residual = (self.stiffness @ motion)[:count] + bears * self.area
            if np.abs(residual).max() < 1e-9 * self.material.strength * self.area.max():
                return motion
            matrix = self.stiffness[:count].copy()
            matrix[:, :count] += np.diag(2 * slope * self.area)
            # The root is given; the motion of the end is unknown in its place.
            matrix[:, 0] = matrix[:, count]
            change = np.linalg.solve(matrix[:, :count], -residual)
            motion[count] += change[0]
            motion[1:count] += change[1:]
        return None


def checks():
    material = Material()
    zone, strength = material.zone(), material.strength
    toughness = (material.young * material.energy) ** 0.5
    whole = Piece("centre", 0.0, zone, zone, 0.05 * zone).largest_load() / (2 * zone * 0.1 * strength)
    print(f"no slit {whole - 1:+.2%} of the strength")
    a = 300 * zone
    slit = Piece("centre", a, 3 * a, 9 * a, 0.05 * zone).largest_load() / (6 * a * 0.1)
    print(f"slit of 300 process zones {slit / (toughness * (np.cos(np.pi / 6) / (np.pi * a)) ** 0.5) - 1:+.2%} of elastic fracture")
    s = 1 / 3
    shape = (1.122 - 0.561 * s - 0.205 * s**2 + 0.471 * s**3 - 0.190 * s**4) / (1 - s) ** 0.5
    pair = Piece("double", a, 3 * a, 9 * a, 0.05 * zone).largest_load() / (6 * a * 0.1)
    print(f"two edge notches of 300 process zones {pair / (toughness / (shape * (np.pi * a) ** 0.5)) - 1:+.2%} of elastic fracture")
    s, depth = 0.25, 1000 * zone
    shape = 3 * s**0.5 * (1.99 - s * (1 - s) * (2.15 - 3.93 * s + 2.7 * s**2)) / (2 * (1 + 2 * s) * (1 - s) ** 1.5)
    beam = Piece("beam", s * depth, depth, 2 * depth, 0.05 * zone, far=depth / 50).largest_load()
    print(f"notched beam of 1000 process zones {beam / (toughness * 0.1 * depth**0.5 / (4 * shape)) - 1:+.2%} of elastic fracture")
    # With linear softening, since a load that falls with the length of the crack has its peak before a long tail of softening is there.
    short, radius = Material(softening="linear"), 300 * zone
    stiffer = 1 / (1 - material.poisson**2) ** 0.5
    s = 2 / 3
    shape = 2 / np.pi * (1 - 0.5 * s + 0.148 * s**3) / (1 - s) ** 0.5
    penny = Piece("penny", s * radius, radius, 3 * radius, 0.05 * zone, short).largest_load() / (np.pi * radius**2)
    print(f"penny of 200 process zones {penny / (stiffer * toughness / (shape * (np.pi * s * radius) ** 0.5)) - 1:+.2%} of elastic fracture")
    s = 1 / 3
    shape = 0.5 * (1 - s) ** 0.5 * (1 + s / 2 + 3 / 8 * s**2 - 0.363 * s**3 + 0.731 * s**4)
    ring = Piece("ring", (1 - s) * radius, radius, 3 * radius, 0.05 * zone, short).largest_load() / (np.pi * (s * radius) ** 2)
    print(f"rod with a notch of 200 process zones around it {ring / (stiffer * toughness / (shape * (np.pi * s * radius) ** 0.5)) - 1:+.2%} of elastic fracture")
    s, depth = 0.25, 1e-5 * zone
    beam = Piece("beam", s * depth, depth, 2 * depth, 0.005 * depth, far=depth / 200).largest_load()
    print(f"notched beam of 0.00001 process zones {beam / (strength * 0.1 * (0.75 * depth) ** 2 / (2 * depth)) - 1:+.2%} of a plastic ligament")
    material = Material(softening="linear")
    for depth in (0.1, 0.3, 1.0, 3.0):
        rupture = (1 + 1 / (0.85 + 2.3 * depth)) / (1 - 0.1773 / 4)
        depth *= zone
        beam = Piece("beam", 0.0, depth, 2 * depth, 0.01 * min(depth, zone), material, far=depth / 50).largest_load()
        print(f"beam of {depth / zone:g} process zones {6 * beam / (strength * 0.1 * depth) / rupture - 1:+.2%} of the published modulus of rupture")


def plate():
    zone = Material().zone()
    for a in (0.5, 2.0, 8.0):
        for h in (0.05, 0.025):
            load = 0.5 * Piece("centre", a * zone, 3 * a * zone, 3 * a * zone, h * zone).largest_load()
            print(f"half slit {a:g} process zones, squares of {h:g}: {load / 1e3:.2f} kN on half a plate", flush=True)
    for h in (0.05, 0.025):
        load = 0.25 * Piece("penny", zone, 3 * zone, 3 * zone, h * zone).largest_load()
        print(f"penny of one process zone, squares of {h:g}: {load / 1e6:.4f} MN on a quarter of the cylinder", flush=True)


def table(path):
    """Scenes of a table, with numbers as such."""
    for row in csv.DictReader(path.read_text().splitlines()):
        number = lambda text: float(text) if text[0].isdigit() else text
        yield {name: value if name == "name" else number(value) for name, value in row.items()}


def scenes(path):
    for scene in table(path):
        names = ("young_modulus", "poisson_ratio", "tensile_strength", "fracture_energy", "softening", "plane")
        material = Material(*(scene[name] for name in names))
        a, width = scene["notch"], scene["width"]
        h = min(0.05 * material.zone(), (width - a) / 60)
        loads = [Piece(scene["kind"], a, width, scene["height"], h / part, material, far=width / (24 * part)).largest_load() for part in (1, 2)]
        held = f", {scene['load'] / loads[1] - 1:+.2%} in the table" if "load" in scene else ""
        print(f"{scene['name']}: {loads[1]:.5g} N, {loads[0] / loads[1] - 1:+.2%} with squares twice as large{held}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        scenes(Path(sys.argv[1]))
    else:
        checks()
        plate()
