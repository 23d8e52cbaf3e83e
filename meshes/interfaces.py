"""Plane blocks with lines inside, for cases/interfaces and cases/liquid. Writes MSH 2.2 as text; needs no gmsh.

python3 meshes/interfaces.py
"""

import math
import random
from pathlib import Path

FOLDER = Path(__file__).parent / "interfaces"


def write(path, points, groups):
    """- `groups`: name -> (dimension, elements by their nodes)"""
    kinds = {2: 1, 3: 2, 4: 4}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    lines += [f'{dimension} {tag} "{name}"' for tag, (name, (dimension, _)) in enumerate(groups.items(), 1)]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(points))]
    lines += [f"{n} {x:.12g} {y:.12g} {z:.12g}" for n, (x, y, z) in enumerate(points, 1)]
    elements = []
    for tag, (_, members) in enumerate(groups.values(), 1):
        for nodes in members:
            corners = " ".join(str(node + 1) for node in nodes)
            elements.append(f"{len(elements) + 1} {kinds[len(nodes)] if len(nodes) != 3 else 2} 2 {tag} {tag} {corners}")
    lines += ["$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements", ""]
    path.write_text("\n".join(lines))


def rectangle(name, xs, ys, regions, lines, jitter=0.0, seed=1, turn=0.0, place=None):
    """A rectangle of triangles.

    - `regions`: name -> condition on the middle of an element; `lines`: name -> condition on a point of both ends of an edge
    - `jitter`: share of a cell by which nodes off all lines move; `turn`: angle by which all of it turns [deg]; `place`: where its points lie in truth
    """
    noise = random.Random(seed)
    columns = len(xs)
    points = []
    for j, y in enumerate(ys):
        for i, x in enumerate(xs):
            inner = 0 < i < columns - 1 and 0 < j < len(ys) - 1
            free = inner and not any(on(x, y) for on in lines.values())
            dx, dy = noise.uniform(-jitter, jitter), noise.uniform(-jitter, jitter)
            if free:
                x, y = x + dx * (xs[i + 1] - xs[i]), y + dy * (ys[j + 1] - ys[j])
            points.append((x, y))
    triangles = []
    for j in range(len(ys) - 1):
        for i in range(columns - 1):
            a, b = j * columns + i, j * columns + i + 1
            c, d = b + columns, a + columns
            triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    edges = {tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3)}
    groups = {}
    for region, holds in regions.items():
        groups[region] = (2, [t for t in triangles if holds(*middle(points, t))])
    for line, holds in lines.items():
        groups[line] = (1, sorted(e for e in edges if all(holds(*points[n]) for n in e)))
    angle = math.radians(turn)
    c, s = math.cos(angle), math.sin(angle)
    points = [place(*point) for point in points] if place else points
    write(FOLDER / f"{name}.msh", [(c * x - s * y, s * x + c * y, 0.0) for x, y in points], groups)


def arch(name, radius, thickness, voussoirs, along=3, across=4):
    """A half circle of voussoirs on two straight blocks, by its mean radius: joints between all of them, and where the blocks begin."""
    length = math.pi * radius
    block = spaced((thickness, across))
    xs = [x - thickness for x in block[:-1]] + spaced((length, voussoirs * along)) + [length + x for x in block[1:]]
    ys = [y - thickness / 2 for y in block]
    joints = [length * joint / voussoirs for joint in range(voussoirs + 1)]

    def place(x, y):
        if x < 0:
            return radius + y, x
        if x > length:
            return -radius - y, length - x
        return (radius + y) * math.cos(x / radius), (radius + y) * math.sin(x / radius)

    lines = {
        "joints": lambda x, y: any(near(x, joint) for joint in joints),
        "right": lambda x, y: near(x, xs[0]),
        "left": lambda x, y: near(x, xs[-1]),
    }
    rectangle(name, xs, ys, {"stone": lambda x, y: True}, lines, jitter=0.1, place=place)


def middle(points, triangle):
    return [sum(points[n][axis] for n in triangle) / 3 for axis in range(2)]


def near(a, b):
    return abs(a - b) < 1e-9


def spaced(*parts):
    """Places from (end, cells) after the start 0."""
    places, at = [0.0], 0.0
    for end, cells in parts:
        places += [at + (end - at) * k / cells for k in range(1, cells + 1)]
        at = end
    return places


def growing(size, even, end, ratio):
    """Places from 0 to `end`: steps of one size up to `even`, then growing by a ratio."""
    places, step = [0.0], size
    while places[-1] < end - 1e-9:
        if places[-1] > even - 1e-9:
            step *= ratio
        last = places[-1]
        places.append(end if last + 1.5 * step > end else last + step)
    return places


def plate(name, core, cells, half, growth, jitter=0.12, seed=1):
    """A square of triangles that is fine in its middle: an even square core, and square rings around it whose cells grow with their distance.

    - `core`, `half`: half the sides of the core and of the plate; `cells`: along a side of the core; `growth`: of the rings
    """
    noise = random.Random(seed)
    step = 2 * core / cells
    index, points, squares = {}, [], []

    def node(key, x, y):
        if key not in index:
            index[key] = len(points)
            points.append((x, y))
        return index[key]

    def in_core(i, j):
        return node(("core", i, j), -core + step * i, -core + step * j)

    squares += [[in_core(i, j), in_core(i + 1, j), in_core(i + 1, j + 1), in_core(i, j + 1)] for i in range(cells) for j in range(cells)]
    rim = [(i, 0) for i in range(cells)] + [(cells, j) for j in range(cells)]
    rim += [(cells - i, cells) for i in range(cells)] + [(0, cells - j) for j in range(cells)]
    rings = round(math.log(half / core) / math.log(growth))
    for ring in range(rings):

        def at(ring, k):
            i, j = rim[k % len(rim)]
            scale = (half / core) ** (ring / rings)
            return in_core(i, j) if ring == 0 else node((ring, k % len(rim)), (-core + step * i) * scale, (-core + step * j) * scale)

        squares += [[at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)] for k in range(len(rim))]
    triangles = []
    for number, (a, b, c, d) in enumerate(squares):
        one, other = math.dist(points[a], points[c]), math.dist(points[b], points[d])
        first = number % 2 == 0 if near(one, other) else one < other
        triangles += [(a, b, c), (a, c, d)] if first else [(a, b, d), (b, c, d)]
    moved = []
    for x, y in points:
        size = step * max(1.0, max(abs(x), abs(y)) / core)
        dx, dy = noise.uniform(-jitter, jitter) * size, noise.uniform(-jitter, jitter) * size
        moved.append((x, y) if near(max(abs(x), abs(y)), half) else (x + dx, y + dy))
    edges = {tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3)}
    side = lambda y: sorted(e for e in edges if all(near(points[n][1], y) for n in e))
    groups = {"plate": (2, triangles), "bottom": (1, side(-half)), "top": (1, side(half))}
    write(FOLDER / f"{name}.msh", [(x, y, 0.0) for x, y in moved], groups)


def main():
    FOLDER.mkdir(exist_ok=True)
    # Double cantilever: 120 x 2 x 6 mm, bonded from 40 mm on.
    rectangle(
        "dcb",
        spaced((0.120, 120)),
        spaced((0.012, 12)),
        {"lower": lambda x, y: y < 0.006, "upper": lambda x, y: y > 0.006},
        {
            "seam": lambda x, y: near(y, 0.006) and x > 0.04 - 1e-9,
            "slit": lambda x, y: near(y, 0.006) and x < 0.04 + 1e-9,
            "end": lambda x, y: near(x, 0.120),
            "pull-lower": lambda x, y: near(x, 0.0) and y < 0.006 + 1e-9,
            "pull-upper": lambda x, y: near(x, 0.0) and y > 0.006 - 1e-9,
        },
    )
    # End-notched flexure: 100 x 2 x 3 mm, never joined up to 36 mm.
    rectangle(
        "enf",
        spaced((0.034, 48), (0.046, 48), (0.050, 8), (0.100, 60)),
        spaced((0.006, 20)),
        {"lower": lambda x, y: y < 0.003, "upper": lambda x, y: y > 0.003},
        {
            "seam": lambda x, y: near(y, 0.003) and x > 0.036 - 1e-9,
            "slit": lambda x, y: near(y, 0.003) and x < 0.036 + 1e-9,
        },
    )
    # Direct shear: two halves of 100 x 25 mm.
    rectangle(
        "shear",
        spaced((0.100, 20)),
        spaced((0.050, 10)),
        {"lower": lambda x, y: y < 0.025, "upper": lambda x, y: y > 0.025},
        {
            "bottom": lambda x, y: near(y, 0.0),
            "top": lambda x, y: near(y, 0.050),
            "joint": lambda x, y: near(y, 0.025),
        },
        jitter=0.2,
    )
    # A plate of 60 x 60 mm that is fine in its middle, where a crack meets an interface; cases cut both into it.
    plate("plate", 0.003, 40, 0.030, 1.08)
    # A patch: a square whose middle line is an interface, turned.
    rectangle(
        "patch",
        spaced((1.0, 8)),
        spaced((1.0, 8)),
        {"block": lambda x, y: True},
        {
            "left": lambda x, y: near(x, 0.0),
            "right": lambda x, y: near(x, 1.0),
            "bottom": lambda x, y: near(y, 0.0),
            "top": lambda x, y: near(y, 1.0),
            "joint": lambda x, y: near(x, 0.5),
        },
        jitter=0.25,
        turn=27,
    )
    # Half of a plane with a crack that liquid drives along y = 0: elements of 5 cm up to 3.2 m, then growing.
    across = growing(0.05, 0.2, 40.0, 1.2)
    rectangle(
        "liquid",
        growing(0.05, 3.2, 40.0, 1.2),
        [-y for y in reversed(across[1:])] + across,
        {"lower": lambda x, y: y < 0, "upper": lambda x, y: y > 0},
        {
            "crack": lambda x, y: near(y, 0.0) and x < 3.2 + 1e-9,
            "side": lambda x, y: near(x, 0.0),
            "top": lambda x, y: near(y, 40.0),
            "right": lambda x, y: near(x, 40.0),
            "bottom": lambda x, y: near(y, -40.0),
        },
    )
    # A masonry arch, a little thicker than it must be to stand.
    arch("arch", 10.0, 1.12, 27)


if __name__ == "__main__":
    main()
