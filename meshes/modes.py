"""Meshes for natural vibrations (cases/modes), MSH 4.1 text. Needs no gmsh: `python3 modes.py`.

- `modes/ring.msh`: plane ring of radii 95 and 105 mm, 8 layers of 360 cells, each cut by one of its diagonals in turn;
- `modes/ball.msh`: eighth of a ball of radius 0.1 m, 12 cells along its edges, each cut into six tetrahedra; `x`, `y` and `z` are its planes
  of symmetry;
- `modes/plate.msh`: square plate of 1 x 1 x 0.1 m, 24 x 24 x 6 cells of six tetrahedra; `x_sides` and `y_sides` are its sides across x and y;
- `modes/strut.msh`: plane strut of 1 m x 20 mm about y = 0, 400 x 8 cells, each cut by one of its diagonals in turn; `left` and `right` are its ends.
"""

from itertools import permutations, product
from math import cos, pi, sin, tan
from pathlib import Path

HERE = Path(__file__).resolve().parent / "modes"


def kuhn(cells, node):
    """Six tetrahedra for each cell, mirrored from cell to cell, so that the mesh has the symmetry of its halves."""
    for at in product(*map(range, cells)):
        for order in permutations(range(3)):
            corner, walk = [0, 0, 0], []
            walk.append(tuple(corner))
            for axis in order:
                corner[axis] = 1
                walk.append(tuple(corner))
            # Every other cell is the mirror image of its neighbour.
            corners = [tuple(i + (c if i % 2 == 0 else 1 - c) for i, c in zip(at, step)) for step in walk]
            yield tuple(node(*c) for c in corners)


def positive(tetrahedron, points):
    a, b, c, d = (points[n - 1] for n in tetrahedron)
    u, v, w = ([q - p for p, q in zip(a, e)] for e in (b, c, d))
    volume = sum(u[i] * (v[(i + 1) % 3] * w[(i + 2) % 3] - v[(i + 2) % 3] * w[(i + 1) % 3]) for i in range(3))
    return tetrahedron if volume > 0 else (tetrahedron[0], tetrahedron[1], tetrahedron[3], tetrahedron[2])


def facets(tetrahedra, side):
    """Triangles all of whose corners lie on a side."""
    for t in tetrahedra:
        for left in range(4):
            corners = [n for k, n in enumerate(t) if k != left]
            if all(side(n) for n in corners):
                yield tuple(corners)


def write(name, points, body, elements, sides):
    """- `sides`: name of a group of facets -> its facets; all parts have entities of their own."""
    solid = len(elements[0]) == 4
    dimension = 3 if solid else 2
    names = [(dimension, 1, body)] + [(dimension - 1, 2 + k, side) for k, side in enumerate(sides)]
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{d} {tag} "{name}"' for d, tag, name in names] + ["$EndPhysicalNames"]
    low = [min(p[a] for p in points) for a in range(3)]
    high = [max(p[a] for p in points) for a in range(3)]
    box = " ".join(f"{x:.9g}" for x in low + high)
    lines += ["$Entities", f"0 0 {len(sides)} 1" if solid else f"0 {len(sides)} 1 0"]
    lines += [f"{k} {box} 1 {1 + k} 0" for k in range(1, len(sides) + 1)]
    lines += [f"1 {box} 1 1 0", "$EndEntities"]
    lines += ["$Nodes", f"1 {len(points)} 1 {len(points)}", f"{dimension} 1 0 {len(points)}"]
    lines += [str(n + 1) for n in range(len(points))] + [" ".join(f"{x:.9g}" for x in p) for p in points]
    kind, side = (4, 2) if solid else (2, 1)
    blocks = [(dimension, 1, kind, elements)] + [(dimension - 1, k + 1, side, own) for k, own in enumerate(sides.values())]
    count = sum(len(own) for *_, own in blocks)
    lines += ["$EndNodes", "$Elements", f"{len(blocks)} {count} 1 {count}"]
    tag = 0
    for d, entity, kind, own in blocks:
        lines.append(f"{d} {entity} {kind} {len(own)}")
        for corners in own:
            tag += 1
            lines.append(" ".join(map(str, (tag, *corners))))
    lines.append("$EndElements")
    HERE.mkdir(exist_ok=True)
    (HERE / name).write_text("\n".join(lines) + "\n")


def ring(inner=0.095, outer=0.105, layers=8, around=360):
    def node(layer, step):
        return 1 + layer * around + step % around

    def place(layer, step):
        radius, angle = inner + (outer - inner) * layer / layers, 2 * pi * step / around
        return radius * cos(angle), radius * sin(angle), 0.0

    points = [place(layer, step) for layer in range(layers + 1) for step in range(around)]
    triangles = []
    for layer, step in product(range(layers), range(around)):
        a, b = node(layer, step), node(layer + 1, step)
        c, d = node(layer + 1, step + 1), node(layer, step + 1)
        triangles += ((a, b, c), (a, c, d)) if (layer + step) % 2 else ((a, b, d), (b, c, d))
    write("ring.msh", points, "ring", triangles, {})


def ball(radius=0.1, n=12):
    """A cube in [0, 1]^3 whose shells of the largest coordinate become spherical: nodes go out along rays of equal angles."""
    def place(i, j, k):
        shell = max(i, j, k)
        if shell == 0:
            return 0.0, 0.0, 0.0
        ray = [tan(0.25 * pi * x / shell) for x in (i, j, k)]
        size = sum(x * x for x in ray) ** 0.5
        return tuple(radius * shell / n * x / size for x in ray)

    def node(i, j, k):
        return 1 + i + (n + 1) * (j + (n + 1) * k)

    points = [place(i, j, k) for k, j, i in product(range(n + 1), repeat=3)]
    tetrahedra = [positive(t, points) for t in kuhn((n, n, n), node)]
    sides = {name: list(facets(tetrahedra, lambda m, a=axis: points[m - 1][a] == 0.0)) for axis, name in enumerate("xyz")}
    write("ball.msh", points, "ball", tetrahedra, sides)


def plate(size=(1.0, 1.0, 0.1), cells=(24, 24, 6)):
    def node(i, j, k):
        return 1 + i + (cells[0] + 1) * (j + (cells[1] + 1) * k)

    order = product(*(range(c + 1) for c in reversed(cells)))
    points = [tuple(round(s * x / c, 9) for s, x, c in zip(size, (i, j, k), cells)) for k, j, i in order]
    tetrahedra = [positive(t, points) for t in kuhn(cells, node)]
    sides = {}
    for axis, name in enumerate(("x_sides", "y_sides")):
        ends = (0.0, size[axis])
        sides[name] = [f for end in ends for f in facets(tetrahedra, lambda m: points[m - 1][axis] == end)]
    write("plate.msh", points, "plate", tetrahedra, sides)


def strut(size=(1.0, 0.02), cells=(400, 8)):
    def node(i, j):
        return 1 + i + (cells[0] + 1) * j

    points = [
        (round(size[0] * i / cells[0], 9), round(size[1] * (j / cells[1] - 0.5), 9), 0.0)
        for j, i in product(range(cells[1] + 1), range(cells[0] + 1))
    ]
    triangles = []
    for j, i in product(range(cells[1]), range(cells[0])):
        a, b, c, d = node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)
        triangles += ((a, b, c), (a, c, d)) if (i + j) % 2 else ((a, b, d), (b, c, d))
    ends = {"left": 0, "right": cells[0]}
    sides = {name: [(node(i, j), node(i, j + 1)) for j in range(cells[1])] for name, i in ends.items()}
    write("strut.msh", points, "strut", triangles, sides)


if __name__ == "__main__":
    ring()
    ball()
    plate()
    strut()
