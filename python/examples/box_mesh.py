"""A box of tetrahedra without a mesh generator: six per cell, with the groups body, x-, x+, y-, y+, z- and z+."""

from itertools import permutations

import numpy as np


def write_box(path, cells, size, parts=None, core=0):
    """Writes a box [0, size] in MSH 2.2, whole or in slabs along x, which are files of their own: PATH_1.msh and so on.

    - `cells`: number of cells along x, y and z; `size` [m]; `parts`: number of files; `core`: number of cells along each axis from the origin on
      that are a group `core` of their own instead of `body`
    """
    counts = np.array(cells) + 1
    nodes = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    strides = np.array([counts[1] * counts[2], counts[2], 1])
    corners = (nodes[(nodes < cells).all(axis=1)] * strides).sum(axis=1)
    # Each order of the three axes is a way along the edges of a cell, and a tetrahedron (Kuhn).
    ways = [np.cumsum([0, *strides[list(way)]]) for way in permutations(range(3))]
    tetrahedra = np.concatenate([corners[:, None] + way for way in ways])
    is_core = (nodes[tetrahedra] <= core).all(axis=(1, 2))
    groups = [(3, "core", tetrahedra[is_core])] if core else []
    groups.append((3, "body", tetrahedra[~is_core]))
    for axis, name in enumerate("xyz"):
        for end, at in (("-", 0), ("+", cells[axis])):
            on = nodes[tetrahedra][:, :, axis] == at
            facets = tetrahedra[on.sum(axis=1) == 3]
            groups.append((2, name + end, facets[on[on.sum(axis=1) == 3]].reshape(-1, 3)))
    places = nodes * (np.array(size) / np.array(cells))
    if parts is None:
        write_part(path, places, groups, [np.full(len(elements), True) for _, _, elements in groups])
        return
    for part in range(parts):
        # An element belongs to the slab of its cells; a facet of x+ to the last.
        first, end = (np.array([part, part + 1]) * cells[0]) // parts
        low = [nodes[elements][:, :, 0].min(axis=1) for _, _, elements in groups]
        kept = [(first <= x) & ((x < end) | (part == parts - 1)) for x in low]
        write_part(path.with_name(f"{path.stem}_{part + 1}{path.suffix}"), places, groups, kept)


def write_part(path, places, groups, kept):
    """Writes the elements of each group that are kept, with the nodes that they use."""
    numbers = np.cumsum([0, *(len(elements) for _, _, elements in groups)])
    used = np.unique(np.concatenate([elements[keep].ravel() for (_, _, elements), keep in zip(groups, kept)]))
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
        for tag, (dimension, name, _) in enumerate(groups, 1):
            file.write(f'{dimension} {tag} "{name}"\n')
        file.write(f"$EndPhysicalNames\n$Nodes\n{len(used)}\n")
        file.writelines(f"{i + 1} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in zip(used.tolist(), places[used].tolist()))
        file.write(f"$EndNodes\n$Elements\n{sum(keep.sum() for keep in kept)}\n")
        for tag, ((dimension, _, elements), keep, first) in enumerate(zip(groups, kept, numbers), 1):
            kind = 4 if dimension == 3 else 2
            for number, element in zip((np.flatnonzero(keep) + first + 1).tolist(), (elements[keep] + 1).tolist()):
                file.write(f"{number} {kind} 2 {tag} {tag} {' '.join(map(str, element))}\n")
        file.write("$EndElements\n")
