"""Meshes of triangles drawn out into space: every triangle becomes prisms, every prism three tetrahedra; written through gmsh."""

import gmsh


def extrude(path, plane, depth, layers, body, lines):
    """Writes `plane`, a mesh of triangles in the xy-plane, drawn out from z = -depth/2 to depth/2 [m].

    - `body`: name of its group of triangles, and of the volume
    - `lines`: groups of points of the mesh, which become groups of lines along z
    """
    gmsh.open(str(plane))
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    at = {int(tag): tuple(coordinates[3 * i : 3 * i + 2]) for i, tag in enumerate(tags)}
    groups = {gmsh.model.getPhysicalName(*group): group for group in gmsh.model.getPhysicalGroups()}
    triangles = [int(node) for entity in gmsh.model.getEntitiesForPhysicalGroup(*groups[body]) for node in gmsh.model.mesh.getElementsByType(2, entity)[1]]
    used = sorted(set(triangles))
    ends = {name: int(gmsh.model.mesh.getNodesForPhysicalGroup(*groups[name])[0][0]) for name in lines}
    gmsh.clear()

    number = {node: i for i, node in enumerate(used)}
    tag = lambda node, layer: 1 + number[node] + layer * len(used)
    gmsh.model.add(body)
    gmsh.model.addDiscreteEntity(3, 1)
    points = [(*at[node], depth * (layer / layers - 0.5)) for layer in range(layers + 1) for node in used]
    gmsh.model.mesh.addNodes(3, 1, range(1, len(points) + 1), [x for point in points for x in point])
    tetrahedra = []
    for layer in range(layers):
        for i in range(0, len(triangles), 3):
            # Diagonals leave the smaller node of each side downwards, so that prisms fit.
            a, b, c = sorted(triangles[i : i + 3], key=number.get)
            low, high = [[tag(node, layer + k) for node in (a, b, c)] for k in (0, 1)]
            tetrahedra += [[*low, high[2]], [low[0], low[1], high[1], high[2]], [low[0], *high]]
    place = lambda node: points[node - 1]
    gmsh.model.mesh.addElementsByType(1, 4, [], [node for t in tetrahedra for node in upright(t, place)])
    gmsh.model.addPhysicalGroup(3, [1], name=body)
    for entity, (name, node) in enumerate(ends.items(), 1):
        gmsh.model.addDiscreteEntity(1, entity)
        along = [(tag(node, layer), tag(node, layer + 1)) for layer in range(layers)]
        gmsh.model.mesh.addElementsByType(entity, 1, [], [node for line in along for node in line])
        gmsh.model.addPhysicalGroup(1, [entity], name=name)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.write(str(path))


def upright(nodes, place):
    """The nodes of a tetrahedron in the order of positive volume."""
    o, *rest = [place(node) for node in nodes]
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = [[p[k] - o[k] for k in range(3)] for p in rest]
    volume = ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
    return nodes if volume > 0 else [nodes[0], nodes[2], nodes[1], nodes[3]]
