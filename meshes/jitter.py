"""Moves the inner nodes of a plane gmsh file (4.1, ASCII) at random: a mesh without the symmetry of the first.

python3 meshes/jitter.py double-notched-plane/medium double-notched-plane/medium-uneven 0.2 1
"""

import math
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).parent


def jitter(source, target, share, seed):
    """Moves every node inside a surface by up to `share` of its shortest edge."""
    lines = (HERE / f"{source}.msh").read_text().split("\n")
    points, inner = nodes(lines)
    shortest = {}
    for a, b in edges(lines):
        length = math.dist(points[a][1], points[b][1])
        for node in (a, b):
            shortest[node] = min(length, shortest.get(node, math.inf))
    draw = random.Random(seed)
    for node in sorted(inner):
        at, (x, y, z) = points[node]
        radius = share * shortest[node] * math.sqrt(draw.random())
        angle = 2 * math.pi * draw.random()
        lines[at] = f"{x + radius * math.cos(angle)!r} {y + radius * math.sin(angle)!r} {z!r}"
    (HERE / f"{target}.msh").write_text("\n".join(lines))


def nodes(lines):
    """Line and place of every node, and the nodes inside surfaces."""
    start = lines.index("$Nodes")
    at, points, inner = start + 2, {}, set()
    for _ in range(int(lines[start + 1].split()[0])):
        dimension, _, _, count = map(int, lines[at].split())
        for k in range(count):
            node, place = int(lines[at + 1 + k]), at + 1 + count + k
            points[node] = (place, tuple(map(float, lines[place].split()[:3])))
            if dimension == 2:
                inner.add(node)
        at += 1 + 2 * count
    return points, inner


def edges(lines):
    """Edges of the triangles."""
    start = lines.index("$Elements")
    at, found = start + 2, set()
    for _ in range(int(lines[start + 1].split()[0])):
        dimension, _, _, count = map(int, lines[at].split())
        for line in lines[at + 1 : at + 1 + count] if dimension == 2 else []:
            a, b, c = map(int, line.split()[1:4])
            found |= {(a, b), (b, c), (a, c)}
        at += 1 + count
    return found


if __name__ == "__main__":
    jitter(sys.argv[1], sys.argv[2], float(sys.argv[3]), int(sys.argv[4]))
