"""Structured boxes of tetrahedra, six per cell around the diagonal of the cell (Kuhn), written through gmsh."""

import random
from itertools import permutations, product

import gmsh

# Sides of a box in the order x_min, x_max, y_min, y_max, z_min, z_max; side k lies at the end `k % 2` of axis `k // 2`.
SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")


def box(path, corner, size, cells, body, groups, jitter=0.0, binary=True):
    """Writes a box in MSH 4.1.

    - `corner`, `size` [m], `cells`: three numbers each
    - `body`: name of the volume group
    - `groups`: name of a surface group -> its sides, by the names in SIDES; sides in no group are not written
    - `jitter`: amplitude in cell sizes by which nodes leave the lattice, in the directions that keep the box a box,
      and never on its ends in x; the same numbers on every run
    """
    points = lattice(corner, size, cells, jitter)
    tetrahedra = kuhn(cells)
    sides = boundary(tetrahedra, cells)

    gmsh.model.add(body)
    for side in range(6):
        gmsh.model.addDiscreteEntity(2, side + 1)
    gmsh.model.addDiscreteEntity(3, 1, [side + 1 for side in range(6)])
    owned = {entity: [] for entity in range(7)}
    for node in range(len(points)):
        on = sides_of(node, cells)
        owned[on[0] + 1 if on else 0].append(node)
    for entity, nodes in owned.items():
        dimension, tag = (2, entity) if entity else (3, 1)
        flat = [x for node in nodes for x in points[node]]
        gmsh.model.mesh.addNodes(dimension, tag, [node + 1 for node in nodes], flat)
    for side in range(6):
        gmsh.model.mesh.addElementsByType(side + 1, 2, [], [node + 1 for facet in sides[side] for node in facet])
    gmsh.model.mesh.addElementsByType(1, 4, [], [node + 1 for element in tetrahedra for node in element])

    gmsh.model.addPhysicalGroup(3, [1], name=body)
    for name, named in groups.items():
        gmsh.model.addPhysicalGroup(2, [SIDES.index(side) + 1 for side in named], name=name)
    gmsh.option.setNumber("Mesh.Binary", int(binary))
    gmsh.write(str(path))


def lattice(corner, size, cells, jitter):
    """Node positions, x fastest."""
    step = [size[axis] / cells[axis] for axis in range(3)]
    noise = random.Random(1)
    points = []
    for k, j, i in product(*(range(n + 1) for n in reversed(cells))):
        at, point = (i, j, k), []
        for axis in range(3):
            x = corner[axis] + size[axis] * at[axis] / cells[axis]
            shift = noise.uniform(-jitter, jitter) * step[axis]
            free = 0 < at[axis] < cells[axis] and 0 < i < cells[0]
            point.append(round(x + shift * free, 12))
        points.append(point)
    return points


def node_at(i, j, k, cells):
    return i + (cells[0] + 1) * (j + (cells[1] + 1) * k)


def sides_of(node, cells):
    """Sides of the box on which a node lies, as indices into SIDES."""
    at = []
    for n in cells:
        node, i = divmod(node, n + 1)
        at.append(i)
    return [2 * axis + end for axis in range(3) for end in range(2) if at[axis] == end * cells[axis]]


def kuhn(cells):
    """Positively oriented tetrahedra: each walks along the three axes, in one of six orders, from corner to corner."""
    tetrahedra = []
    for k, j, i in product(*(range(n) for n in reversed(cells))):
        for order in permutations(range(3)):
            corner, path = [i, j, k], [node_at(i, j, k, cells)]
            for axis in order:
                corner[axis] += 1
                path.append(node_at(*corner, cells))
            odd = order in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
            tetrahedra.append((path[0], path[2], path[1], path[3]) if odd else tuple(path))
    return tetrahedra


def boundary(tetrahedra, cells):
    """Facets on each side of the box, outward."""
    sides = [[] for _ in range(6)]
    for a, b, c, d in tetrahedra:
        for facet in ((a, c, b), (a, b, d), (a, d, c), (b, c, d)):
            common = set.intersection(*(set(sides_of(node, cells)) for node in facet))
            for side in common:
                sides[side].append(facet)
    return sides
