"""Columns of triangles and tetrahedra for triaxial tests, and a plate with an inclined crack. MSH 4.1 text, without gmsh.

python3 meshes/closed_cracks.py                              writes the files in closed-cracks/
python3 meshes/closed_cracks.py column 16 32 3.125e-3 7 x.msh        16 x 32 cells of 3.125 mm, nodes moved by the seed 7
python3 meshes/closed_cracks.py block 6 12 8e-3 7 x.msh              6 x 6 x 12 cells of 8 mm
python3 meshes/closed_cracks.py plate 20 10 4e-4 7 x.msh             a crack along 40 diagonals of cells of 0.4 mm, as many cells as large around its tips
"""

import random
import sys
from itertools import permutations, product
from pathlib import Path

JITTER = 0.18


def write(path, points, groups):
    """- `groups`: name -> (dimension, entity's elements as lists of nodes from 1 on)"""
    names = list(groups)
    dimension = {name: groups[name][0] for name in names}
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{dimension[name]} {k} "{name}"' for k, name in enumerate(names, 1)]
    lines += ["$EndPhysicalNames", "$Entities"]
    lines.append(" ".join(str(sum(dimension[name] == d for name in names)) for d in range(4)))
    low, high = ([f(point[axis] for point in points) for axis in range(3)] for f in (min, max))
    box = " ".join(map(str, low + high))
    for d in range(4):
        lines += [f"{k} {box} 1 {k} 0" for k, name in enumerate(names, 1) if dimension[name] == d]
    top = max(dimension.values())
    entity = next(k for k, name in enumerate(names, 1) if dimension[name] == top)
    lines += ["$EndEntities", "$Nodes", f"1 {len(points)} 1 {len(points)}", f"{top} {entity} 0 {len(points)}"]
    lines += [str(node) for node in range(1, len(points) + 1)]
    lines += [" ".join(f"{x:.9g}" for x in point) for point in points]
    count = sum(len(elements) for _, elements in groups.values())
    lines += ["$EndNodes", "$Elements", f"{len(names)} {count} 1 {count}"]
    kind, tag = {1: 1, 2: 2, 3: 4}, 0
    for k, name in enumerate(names, 1):
        d, elements = groups[name]
        lines.append(f"{d} {k} {kind[d]} {len(elements)}")
        for corners in elements:
            tag += 1
            lines.append(" ".join(map(str, (tag, *corners))))
    lines.append("$EndElements")
    Path(path).write_text("\n".join(lines) + "\n")


def square(xs, ys, seed, held=lambda i, j: False, diagonal=lambda i, j: (i + j) % 2):
    """Points and triangles between lines; nodes on the rim and those held stay in their place."""
    noise = random.Random(seed)
    nx, ny = len(xs) - 1, len(ys) - 1
    node = lambda i, j: 1 + j * (nx + 1) + i
    moved = lambda at, k: at[k] + noise.uniform(-JITTER, JITTER) * min(at[k] - at[k - 1], at[k + 1] - at[k])
    points = []
    for j, i in product(range(ny + 1), range(nx + 1)):
        stays = not (0 < i < nx and 0 < j < ny) or held(i, j)
        points.append((xs[i], ys[j], 0.0) if stays else (moved(xs, i), moved(ys, j), 0.0))
    triangles = []
    for j, i in product(range(ny), range(nx)):
        a, b, c, d = node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)
        triangles += [(a, b, c), (a, c, d)] if diagonal(i, j) else [(a, b, d), (b, c, d)]
    return points, triangles, node


def column(path, nx, ny, size, seed):
    points, triangles, node = square([size * i for i in range(nx + 1)], [size * j for j in range(ny + 1)], seed)
    row = lambda j: [(node(i, j), node(i + 1, j)) for i in range(nx)]
    side = lambda i: [(node(i, j), node(i, j + 1)) for j in range(ny)]
    groups = {"rock": (2, triangles), "bottom": (1, row(0)), "top": (1, row(ny)), "left": (1, side(0)), "right": (1, side(nx))}
    write(path, points, groups)


def block(path, n, nz, size, seed):
    noise = random.Random(seed)
    node = lambda i, j, k: 1 + (k * (n + 1) + j) * (n + 1) + i
    points = []
    for k, j, i in product(range(nz + 1), range(n + 1), range(n + 1)):
        moved = []
        for at, last in ((i, n), (j, n), (k, nz)):
            shift = noise.uniform(-JITTER, JITTER)
            inner = 0 < at < last and 0 < k < nz
            moved.append(size * (at + (shift if inner else 0.0)))
        points.append(tuple(moved))
    tetrahedra, facets = [], {}
    for k, j, i in product(range(nz), range(n), range(n)):
        for order in permutations(range(3)):
            at, corners = [i, j, k], [node(i, j, k)]
            for axis in order:
                at[axis] += 1
                corners.append(node(*at))
            even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
            tetrahedra.append(tuple(corners if even else [corners[0], corners[2], corners[1], corners[3]]))
            for without in range(4):
                facet = tuple(corners[c] for c in range(4) if c != without)
                facets.setdefault(tuple(sorted(facet)), []).append(facet)
    at = lambda number: ((number - 1) % (n + 1), (number - 1) // (n + 1) % (n + 1), (number - 1) // (n + 1) ** 2)
    free = [same[0] for same in facets.values() if len(same) == 1]
    on = lambda facet, axis, value: all(at(corner)[axis] == value for corner in facet)
    bottom, top = ([f for f in free if on(f, 2, value)] for value in (0, nz))
    sides = [f for f in free if any(on(f, axis, value) for axis in (0, 1) for value in (0, n))]
    write(path, points, {"rock": (3, tetrahedra), "bottom": (2, bottom), "top": (2, top), "sides": (2, sides)})


def plate(path, crack, around, size, seed):
    """A square of 80 mm around the origin; the crack runs along the diagonals from -crack to crack cells, and cells grow from `around` cells beyond it."""
    core, outer, step = [size * k for k in range(crack + around + 1)], [0.0], size
    while core[-1] + outer[-1] < 0.04 - 1e-9:
        step *= 1.2
        outer.append(outer[-1] + step)
    lines = core + [core[-1] + x * (0.04 - core[-1]) / outer[-1] for x in outer[1:]]
    lines = [-x for x in reversed(lines[1:])] + lines
    n, half = len(lines) - 1, len(lines) // 2
    on = lambda i, j: i == j and abs(i - half) <= crack
    along = lambda i, j: i == j or (i + j) % 2
    points, triangles, node = square(lines, lines, seed, on, along)
    row = lambda j: [(node(i, j), node(i + 1, j)) for i in range(n)]
    side = lambda i: [(node(i, j), node(i, j + 1)) for j in range(n)]
    slit = [(node(half + k, half + k), node(half + k + 1, half + k + 1)) for k in range(-crack, crack)]
    groups = {"rock": (2, triangles), "crack": (1, slit), "bottom": (1, row(0)), "top": (1, row(n))}
    groups |= {"left": (1, side(0)), "right": (1, side(n))}
    write(path, points, groups)


def main(arguments):
    if arguments:
        kind, first, second, size, seed, path = arguments
        {"column": column, "block": block, "plate": plate}[kind](path, int(first), int(second), float(size), int(seed))
        return
    folder = Path(__file__).with_name("closed-cracks")
    folder.mkdir(exist_ok=True)
    column(folder / "column.msh", 16, 32, 3.125e-3, 1)
    plate(folder / "plate.msh", 20, 10, 4e-4, 1)


if __name__ == "__main__":
    main(sys.argv[1:])
