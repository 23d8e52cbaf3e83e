"""A quarter of a plane ring of radii 50 and 100 mm: 20 layers of 48 cells, each cut by one of its diagonals in turn. MSH 4.1 text.

`ring` is all of it, `lining` the two inner layers. Needs no gmsh: `python3 ring.py`.
"""

from math import cos, pi, sin
from pathlib import Path

INNER, OUTER, LAYERS, AROUND, LINING = 0.05, 0.1, 20, 48, 2


def node(layer, step):
    return 1 + layer * (AROUND + 1) + step


def place(layer, step):
    radius, angle = INNER + (OUTER - INNER) * layer / LAYERS, 0.5 * pi * step / AROUND
    return f"{radius * cos(angle):.9f} {radius * sin(angle):.9f} 0"


def triangles(layer):
    for step in range(AROUND):
        a, b = node(layer, step), node(layer + 1, step)
        c, d = node(layer + 1, step + 1), node(layer, step + 1)
        yield from ((a, b, c), (a, c, d)) if (layer + step) % 2 else ((a, b, d), (b, c, d))


def main():
    parts = [[t for layer in layers for t in triangles(layer)] for layers in (range(LINING), range(LINING, LAYERS))]
    nodes = [(layer, step) for layer in range(LAYERS + 1) for step in range(AROUND + 1)]
    count = sum(map(len, parts))
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '2 1 "ring"', '2 2 "lining"', "$EndPhysicalNames"]
    lines += ["$Entities", "0 0 2 0", "1 0 0 0 0.055 0.055 0 2 1 2 0", "2 0 0 0 0.1 0.1 0 1 1 0", "$EndEntities"]
    lines += ["$Nodes", f"1 {len(nodes)} 1 {len(nodes)}", f"2 1 0 {len(nodes)}"]
    lines += [str(node(*n)) for n in nodes] + [place(*n) for n in nodes]
    lines += ["$EndNodes", "$Elements", f"2 {count} 1 {count}"]
    tag = 0
    for entity, part in enumerate(parts, 1):
        lines.append(f"2 {entity} 2 {len(part)}")
        for corners in part:
            tag += 1
            lines.append(" ".join(map(str, (tag, *corners))))
    lines.append("$EndElements")
    Path(__file__).with_name("ring-plane").joinpath("ring.msh").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
