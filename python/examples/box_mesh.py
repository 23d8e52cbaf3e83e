"""A box of tetrahedra without a mesh generator: six per cell, with the groups body, x-, x+, y-, y+, z- and z+."""

from itertools import permutations

import numpy as np


def write_box(path, cells, size):
    """Writes a box [0, size] in MSH 2.2.

    - `cells`: number of cells along x, y and z; `size` [m]
    """
    counts = np.array(cells) + 1
    nodes = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    strides = np.array([counts[1] * counts[2], counts[2], 1])
    corners = (nodes[(nodes < cells).all(axis=1)] * strides).sum(axis=1)
    # Each order of the three axes is a way along the edges of a cell, and a tetrahedron (Kuhn).
    ways = [np.cumsum([0, *strides[list(way)]]) for way in permutations(range(3))]
    tetrahedra = np.concatenate([corners[:, None] + way for way in ways])
    groups = [(3, "body", tetrahedra)]
    for axis, name in enumerate("xyz"):
        for end, at in (("-", 0), ("+", cells[axis])):
            on = nodes[tetrahedra][:, :, axis] == at
            facets = tetrahedra[on.sum(axis=1) == 3]
            groups.append((2, name + end, facets[on[on.sum(axis=1) == 3]].reshape(-1, 3)))
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
        for tag, (dimension, name, _) in enumerate(groups, 1):
            file.write(f'{dimension} {tag} "{name}"\n')
        file.write(f"$EndPhysicalNames\n$Nodes\n{len(nodes)}\n")
        places = nodes * (np.array(size) / np.array(cells))
        file.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(places.tolist(), 1))
        file.write(f"$EndNodes\n$Elements\n{sum(len(elements) for _, _, elements in groups)}\n")
        number = 0
        for tag, (dimension, _, elements) in enumerate(groups, 1):
            kind = 4 if dimension == 3 else 2
            for element in (elements + 1).tolist():
                number += 1
                file.write(f"{number} {kind} 2 {tag} {tag} {' '.join(map(str, element))}\n")
        file.write("$EndElements\n")
