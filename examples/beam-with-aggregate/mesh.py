"""Makes mesh.msh, a notched beam of mortar with round aggregate in its middle: python mesh.py [SEED] (pip install gmsh numpy)"""

import sys

import gmsh
import numpy as np

LENGTH, DEPTH, SPAN = 200.0, 50.0, 160.0  # mm
NOTCH = (3.0, 15.0)  # width and depth
ZONE = 35.0  # half width of the part with aggregate
SHARE = 0.35  # of aggregate in it
DIAMETERS = (12.0, 5.0)  # largest and smallest
GAP = 1.2  # least distance of two grains, and of a grain from sides
FINE, COARSE = 1.3, 10.0  # sizes of elements


def grains(random):
    """Centres and radii, the largest first, by Fuller's curve: the share of the area below a diameter grows with its root."""
    largest, smallest = np.sqrt(DIAMETERS)
    diameters, area = [], 0.0
    while area < SHARE * 2 * ZONE * DEPTH:
        diameters.append(random.uniform(smallest, largest) ** 2)
        area += np.pi * diameters[-1] ** 2 / 4
    placed = []
    for diameter in sorted(diameters, reverse=True):
        radius = diameter / 2
        for _ in range(5000):
            x = random.uniform(-ZONE, ZONE)
            y = random.uniform(radius + GAP, DEPTH - radius - GAP)
            clear = abs(x) > NOTCH[0] / 2 + radius + GAP or y > NOTCH[1] + radius + GAP
            if clear and all(np.hypot(x - a, y - b) > radius + r + GAP for a, b, r in placed):
                placed.append((x, y, radius))
                break
        else:
            raise SystemExit("the grains do not fit: lower SHARE")
    return placed


def main(seed):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    kernel = gmsh.model.occ
    beam = kernel.addRectangle(-LENGTH / 2, 0, 0, LENGTH, DEPTH)
    notch = kernel.addRectangle(-NOTCH[0] / 2, 0, 0, *NOTCH)
    cut, _ = kernel.cut([(2, beam)], [(2, notch)])
    placed = grains(np.random.default_rng(seed))
    discs = [(2, kernel.addDisk(x, y, 0, radius, radius)) for x, y, radius in placed]
    points = [(0, kernel.addPoint(x, y, 0)) for x, y in [(-SPAN / 2, 0), (SPAN / 2, 0), (-2, DEPTH), (2, DEPTH)]]
    parts, of = kernel.fragment(cut, discs + points)
    kernel.synchronize()
    aggregate = {tag for entities in of[len(cut) : len(cut) + len(discs)] for dim, tag in entities if dim == 2}
    mortar = [tag for dim, tag in parts if dim == 2 and tag not in aggregate]
    gmsh.model.addPhysicalGroup(2, sorted(aggregate), name="aggregate")
    gmsh.model.addPhysicalGroup(2, mortar, name="mortar")
    supports = [entities[0][1] for entities in of[len(cut) + len(discs) :]]
    gmsh.model.addPhysicalGroup(0, supports[:1], name="left")
    gmsh.model.addPhysicalGroup(0, supports[1:2], name="right")
    top = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(-2.1, DEPTH - 0.1, -1, 2.1, DEPTH + 0.1, 1, 1)]
    gmsh.model.addPhysicalGroup(1, top, name="nose")
    field = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", f"{FINE} + 0.2*Max(0, Abs(x) - {ZONE * 0.6})")
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    for option, value in [("SizeMax", COARSE), ("SizeExtendFromBoundary", 0), ("SizeFromPoints", 0)]:
        gmsh.option.setNumber(f"Mesh.Mesh{option}", value)
    gmsh.option.setNumber("Mesh.Algorithm", 5)  # no rows that cracks could follow
    gmsh.model.mesh.generate(2)
    gmsh.write("mesh.msh")
    print(f"{len(placed)} grains, {sum(np.pi * r**2 for *_, r in placed) / (2 * ZONE * DEPTH):.0%} of their zone")
    gmsh.finalize()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
