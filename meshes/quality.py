"""Counts, sizes and shapes of the tetrahedra, or of the triangles of a plane mesh, of a gmsh file."""

import math

import gmsh

PAIRS = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))

HEADER = (
    "| mesh | nodes | tetrahedra | shortest / mean / longest edge [mm] | dihedral angles, all [deg] "
    "| smallest / largest of an element: mean, worst 1 % [deg] | groups (facets) | file |\n"
    "|---|---|---|---|---|---|---|---|"
)

PLANE_HEADER = (
    "| mesh | nodes | triangles | shortest / mean / longest edge [mm] | angles, all [deg] "
    "| smallest / largest of an element: mean, worst 1 % [deg] | groups (lines) | file |\n"
    "|---|---|---|---|---|---|---|---|"
)


def plane_row(name, path):
    """One line of the table under PLANE_HEADER; raises if a triangle is inverted or a node belongs to none."""
    gmsh.open(str(path))
    tags, flat, _ = gmsh.model.mesh.getNodes()
    points = {int(tag): tuple(flat[3 * n : 3 * n + 3]) for n, tag in enumerate(tags)}
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    triangles = [tuple(int(node) for node in nodes[n : n + 3]) for n in range(0, len(nodes), 3)]

    smallest, largest, edges = [], [], {}
    for element in triangles:
        corners = [points[node] for node in element]
        if cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))[2] <= 0:
            raise ValueError(f"{path}: inverted element {element}")
        angles = [corner_angle(corners[k], corners[k - 1], corners[k - 2]) for k in range(3)]
        smallest.append(min(angles))
        largest.append(max(angles))
        for a, b in ((0, 1), (1, 2), (0, 2)):
            edges[min(element[a], element[b]), max(element[a], element[b])] = math.dist(corners[a], corners[b])
    if len(points) != len({node for element in triangles for node in element}):
        raise ValueError(f"{path}: nodes that belong to no triangle")
    return line(name, path, len(points), len(triangles), list(edges.values()), smallest, largest, groups(1))


def corner_angle(at, one, two):
    """Angle at a corner, in degrees."""
    a, b = sub(one, at), sub(two, at)
    return math.degrees(math.acos(max(-1.0, min(1.0, dot(a, b) / math.sqrt(dot(a, a) * dot(b, b))))))


def row(name, path):
    """One line of the table under HEADER; raises if an element is inverted or a node belongs to none."""
    gmsh.open(str(path))
    tags, flat, _ = gmsh.model.mesh.getNodes()
    points = {int(tag): tuple(flat[3 * n : 3 * n + 3]) for n, tag in enumerate(tags)}
    _, nodes = gmsh.model.mesh.getElementsByType(4)
    tetrahedra = [tuple(int(node) for node in nodes[n : n + 4]) for n in range(0, len(nodes), 4)]

    smallest, largest, edges = [], [], {}
    for element in tetrahedra:
        corners = [points[node] for node in element]
        if dot(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])), sub(corners[3], corners[0])) <= 0:
            raise ValueError(f"{path}: inverted element {element}")
        angles = dihedral_angles(corners)
        smallest.append(min(angles))
        largest.append(max(angles))
        for a, b in PAIRS:
            edge = (min(element[a], element[b]), max(element[a], element[b]))
            edges[edge] = math.dist(corners[a], corners[b])
    if len(points) != len({node for element in tetrahedra for node in element}):
        raise ValueError(f"{path}: nodes that belong to no tetrahedron")

    return line(name, path, len(points), len(tetrahedra), list(edges.values()), smallest, largest, groups(2))


def line(name, path, nodes, elements, length, smallest, largest, groups):
    length.sort()
    smallest.sort()
    largest.sort()
    percent = elements // 100
    return (
        f"| `{name}` | {nodes:,} | {elements:,} "
        f"| {1e3 * length[0]:.2f} / {1e3 * sum(length) / len(length):.2f} / {1e3 * length[-1]:.2f} "
        f"| {smallest[0]:.1f} to {largest[-1]:.1f} "
        f"| {mean(smallest):.1f}, {smallest[percent]:.1f} / {mean(largest):.1f}, {largest[-1 - percent]:.1f} "
        f"| {groups} | {path.stat().st_size / 1024:,.0f} KiB |"
    )


def groups(facet_dimension):
    counts = []
    for dimension, tag in gmsh.model.getPhysicalGroups(facet_dimension):
        facets = sum(
            len(gmsh.model.mesh.getElementsByType(facet_dimension, entity)[0])
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        )
        counts.append(f"{gmsh.model.getPhysicalName(dimension, tag)} {facets}")
    return ", ".join(counts)


def dihedral_angles(corners):
    """The six angles between facets, in degrees."""
    angles = []
    for a, b in PAIRS:
        c, d = (k for k in range(4) if k not in (a, b))
        along = sub(corners[b], corners[a])
        one = cross(along, sub(corners[c], corners[a]))
        two = cross(along, sub(corners[d], corners[a]))
        cosine = dot(one, two) / math.sqrt(dot(one, one) * dot(two, two))
        angles.append(math.degrees(math.acos(max(-1.0, min(1.0, cosine)))))
    return angles


def mean(values):
    return sum(values) / len(values)


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
