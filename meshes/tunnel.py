"""The face of a horseshoe tunnel with its blast holes, and the firing sequence that belongs to it."""

import math
from pathlib import Path

import gmsh

HALF_WIDTH, WALL, RISE = 5.0, 6.0, 4.0  # of the horseshoe [m]
LOADED, EMPTY = 0.048, 0.102  # diameters of holes [m]
RING_DELAY = 0.005  # between rings [s]


def holes():
    """(x, y, diameter, ring) of every hole; ring None for the empty holes of the cut."""
    found = [(x, y, EMPTY, None) for x in (-0.15, 0.15) for y in (2.85, 3.15)]
    found += [(x, 3.0, LOADED, 0) for x in (-0.4, 0.0, 0.4)]
    for ring, radius, count, y, squeeze in ((1, 0.8, 4, 3.0, 1.0), (2, 1.6, 8, 3.0, 1.0), (3, 2.6, 16, 3.2, 0.95)):
        for i in range(count):
            t = 2 * math.pi * (i + 0.5) / count
            found.append((radius * math.cos(t), y + squeeze * radius * math.sin(t), LOADED, ring))
    for i in range(13):
        t = math.pi * (0.08 + 0.84 * i / 12)
        found.append((3.9 * math.cos(t), 4.4 + 4.2 * math.sin(t), LOADED, 4))
    found += [(side * 3.9, 1.1 + 0.95 * i, LOADED, 4) for i in range(4) for side in (-1, 1)]
    radius = (HALF_WIDTH**2 + RISE**2) / (2 * RISE)
    centre = WALL + RISE - radius
    begin = math.asin((WALL - centre) / radius)
    steps = round(radius * (math.pi - 2 * begin) / 0.7)
    for i in range(steps + 1):
        t = begin + i * (math.pi - 2 * begin) / steps
        found.append((radius * math.cos(t), centre + radius * math.sin(t), LOADED, 5))
    found += [(side * HALF_WIDTH, WALL - 0.7 * i, LOADED, 5) for i in range(1, 8) for side in (-1, 1)]
    found += [(-HALF_WIDTH + 0.1 + i * (2 * HALF_WIDTH - 0.2) / 12, 0.0, LOADED, 6) for i in range(13)]
    return found


def tunnel(path, sequence, half=16.0, size=0.016, near=0.125, far=1.5):
    """Writes the mesh and, beside the case, the firing sequence (group, delay, pulse).

    - `half`: half the side of the square of rock; `size`, `near`, `far`: elements at holes, within the tunnel, outside [m]
    """
    gmsh.model.add("tunnel")
    geo = gmsh.model.geo
    corners = [geo.addPoint(x, y + 4, 0) for x, y in ((-half, -half), (half, -half), (half, half), (-half, half))]
    outer = [geo.addLine(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    loops, groups, rows = [geo.addCurveLoop(outer)], [], []
    for x, y, diameter, ring in holes():
        centre = geo.addPoint(x, y, 0)
        r = diameter / 2
        around = [geo.addPoint(x + dx * r, y + dy * r, 0) for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1))]
        arcs = [geo.addCircleArc(around[i], centre, around[(i + 1) % 4]) for i in range(4)]
        loops.append(geo.addCurveLoop(arcs))
        groups.append((arcs, ring))
    rock = geo.addPlaneSurface(loops)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [rock], name="rock")
    gmsh.model.addPhysicalGroup(1, outer, name="outer")
    for number, (arcs, ring) in enumerate(groups, 1):
        name = f"hole_{number}"
        gmsh.model.addPhysicalGroup(1, arcs, name=name)
        if ring is not None:
            pulse = "contour" if ring == 5 else "inner"
            rows.append(f"{name}, {1e3 * RING_DELAY * ring:g} ms, {pulse}")

    field = gmsh.model.mesh.field
    field.add("Distance", 1)
    field.setNumbers(1, "CurvesList", [arc for arcs, _ in groups for arc in arcs])
    field.setNumber(1, "Sampling", 10)
    field.add("MathEval", 2)
    field.setString(2, "F", f"{size} + 0.35*F1")
    field.add("Box", 3)
    limits = {"XMin": -5.6, "XMax": 5.6, "YMin": -0.6, "YMax": 10.6, "VIn": near, "VOut": far, "Thickness": 6}
    for name, value in limits.items():
        field.setNumber(3, name, value)
    field.add("Min", 4)
    field.setNumbers(4, "FieldsList", [2, 3])
    field.setAsBackgroundMesh(4)
    for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(path))
    geometry = Path(path).with_suffix(".geo_unrolled")
    gmsh.write(str(geometry))
    geometry.rename(Path(path).with_suffix(".geo"))
    Path(sequence).parent.mkdir(parents=True, exist_ok=True)
    text = "# Firing sequence of meshes/blast-plane/tunnel.msh, made by meshes/tunnel.py\ngroup, delay, pulse\n"
    Path(sequence).write_text(text + "\n".join(rows) + "\n")
    gmsh.model.remove()
