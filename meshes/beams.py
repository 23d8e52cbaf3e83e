"""Notched beams in the plane whose mesh lines around the ligament run in a given direction, written through gmsh."""

import math
import random

import gmsh


def notched_beam(path, h, lattice="triangles", tilt=0.0, jitter=0.0, zone=0.06, far=0.04, shift=(0.0, 0.0), pointed=False):
    """Beam of 2 x 0.2 m for three-point bending with a slot notch, half the depth and one element wide.

    - `h`: element size within `zone` [m] of the middle; it grows to `far` at the ends
    - `lattice`: points inside that part, of equilateral "triangles" or of "squares" (cut by Delaunay's diagonals)
    - `tilt`: angle of the lattice against the beam [deg]
    - `jitter`: amplitude in h by which the points leave the lattice; the same numbers on every run
    - `shift`: of the lattice, in distances of points along its rows and in distances of rows
    - `pointed`: the notch ends in a point instead of a side
    """
    length, depth, notch, w = 1.0, 0.2, 0.1, h / 2
    tip = [(-w, notch - w, h), (0, notch, h), (w, notch - w, h)] if pointed else [(-w, notch, h), (w, notch, h)]
    outline = [
        (-length, 0, far), (-zone, 0, h), (-w, 0, h), *tip, (w, 0, h), (zone, 0, h),
        (length, 0, far), (length, depth, far), (zone, depth, h), (0, depth, h), (-zone, depth, h),
        (-length, depth, far),
    ]  # fmt: skip
    gmsh.model.add("beam")
    geo = gmsh.model.geo
    corners = [geo.addPoint(x, y, 0, size) for x, y, size in outline]
    lines = [geo.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1])]
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    inside = [geo.addPoint(x, y, 0, h) for x, y in points(h, lattice, tilt, jitter, zone, depth, notch, shift)]
    geo.synchronize()
    gmsh.model.mesh.embed(0, inside, 2, surface)
    gmsh.model.addPhysicalGroup(2, [surface], name="beam")
    names = {"left": (-length, 0), "right": (length, 0), "load": (0, depth), "mouth_left": (-w, 0), "mouth_right": (w, 0)}
    at = {(x, y): corner for (x, y, _), corner in zip(outline, corners)}
    for name, place in names.items():
        gmsh.model.addPhysicalGroup(0, [at[place]], name=name)
    gmsh.option.setNumber("Mesh.Algorithm", 5)
    gmsh.option.setNumber("Mesh.Optimize", 0)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(path))


def points(h, lattice, tilt, jitter, zone, depth, notch, shift):
    """Lattice points around the ligament, none nearer than 0.6 h to the outline."""
    noise = random.Random(1)
    angle = math.radians(tilt)
    rise = h * math.sqrt(3) / 2 if lattice == "triangles" else h
    count = math.ceil(3 * depth / h)
    found = []
    for j in range(-count, count + 1):
        for i in range(-count, count + 1):
            # A column of squares, or a row of points and gaps, stands on the notch.
            u = (i + shift[0]) * h + (h / 2 if lattice == "squares" or j % 2 else 0)
            v = (j + shift[1]) * rise
            x = u * math.cos(angle) - v * math.sin(angle) + jitter * h * noise.uniform(-1, 1)
            y = 0.75 * depth + u * math.sin(angle) + v * math.cos(angle) + jitter * h * noise.uniform(-1, 1)
            free = 0.6 * h
            if abs(x) > zone - free or not notch - 3 * h < y < depth - free or (abs(x) < 1.1 * h and y < notch + free):
                continue
            found.append((round(x, 6), round(y, 6)))
    return found
