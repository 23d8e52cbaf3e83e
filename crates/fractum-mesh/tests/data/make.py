"""Makes the mesh files of this folder and prints what meshio and Gmsh find in them.

    python3 make.py         (gmsh 4.15, meshio 5.3, numpy)

The table that it prints is the one in tests/gmsh_files.rs.
"""

import os
import struct

import gmsh
import meshio
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
VERSIONS = {"22": 2.2, "41": 4.1}


def option(name, value):
    gmsh.option.setNumber("Mesh." + name, value)


def save(name, version="41", binary=False, **options):
    option("MshFileVersion", VERSIONS[version])
    option("Binary", int(binary))
    for key, value in options.items():
        option(key, value)
    gmsh.write(os.path.join(HERE, name + ".msh"))
    for key in options:
        option(key, 0)


def everywhere(name, **options):
    """All four formats."""
    for version in VERSIONS:
        for binary in (False, True):
            save(f"{name}-{version}-{'binary' if binary else 'ascii'}", version, binary, **options)


def start(size):
    gmsh.clear()
    gmsh.model.add("model")
    option("MeshSizeMin", size)
    option("MeshSizeMax", size)


def two_boxes(size=1.0):
    """Two boxes with a common face: overlapping groups, a nameless one, a reversed surface, a point, a curve; the
    second box is in no group."""
    start(size)
    boxes = [gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1), gmsh.model.occ.addBox(1, 0, 0, 1, 1, 1)]
    gmsh.model.occ.fragment([(3, boxes[0])], [(3, boxes[1])])
    gmsh.model.occ.synchronize()
    inside = gmsh.model.getEntitiesInBoundingBox

    def tags(box, dimension):
        return [tag for _, tag in inside(*(x - 0.01 for x in box[:3]), *(x + 0.01 for x in box[3:]), dimension)]

    gmsh.model.addPhysicalGroup(3, [1], 1, "left")
    gmsh.model.addPhysicalGroup(3, [1], 2, "left too")
    gmsh.model.addPhysicalGroup(2, tags((0, 0, 0, 0, 1, 1), 2), 7)
    face = tags((1, 0, 0, 1, 1, 1), 2)
    gmsh.model.addPhysicalGroup(2, face, 8, "interface é")
    gmsh.model.addPhysicalGroup(2, [-face[0]], 9, "reversed")
    gmsh.model.addPhysicalGroup(1, tags((0, 0, 0, 1, 0, 0), 1), 1, "left")
    gmsh.model.addPhysicalGroup(0, tags((0, 0, 0, 0, 0, 0), 0), 4, "corner")
    gmsh.model.mesh.generate(3)


def plane():
    """A plane mesh whose surface is seen from below, in triangles and quadrilaterals."""
    start(0.5)
    for x, recombine in ((0, False), (1, True)):
        points = [gmsh.model.geo.addPoint(x + a, b, 0.25) for a, b in ((0, 0), (0, 1), (1, 1), (1, 0))]
        curves = [gmsh.model.geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
        surface = gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(curves)])
        gmsh.model.geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [surface], name="quads" if recombine else "triangles")
        if recombine:
            for curve in curves:
                gmsh.model.mesh.setTransfiniteCurve(curve, 3)
            gmsh.model.mesh.setTransfiniteSurface(surface)
            gmsh.model.mesh.setRecombine(2, surface)
    gmsh.model.mesh.generate(2)


def layers(grouped):
    """Prisms and hexahedra by extrusion, pyramids and tetrahedra above."""
    start(1.0)
    for x, recombine in ((0, False), (2, True)):
        base = gmsh.model.occ.addRectangle(x, 0, 0, 1, 1)
        volume = gmsh.model.occ.extrude([(2, base)], 0, 0, 1, [1], recombine=True)[1][1]
        gmsh.model.occ.synchronize()
        if recombine:
            gmsh.model.mesh.setTransfiniteSurface(base)
            gmsh.model.mesh.setRecombine(2, base)
        if grouped:
            gmsh.model.addPhysicalGroup(3, [volume], name="blocks" if recombine else "layers")
    box = gmsh.model.occ.addBox(4, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [box], name="simplices")
    gmsh.model.mesh.generate(3)


def periodic():
    start(1.0)
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.setPeriodic(2, [2], [1], [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    gmsh.model.addPhysicalGroup(3, [1], name="body")
    gmsh.model.addPhysicalGroup(2, [2], name="right")
    gmsh.model.mesh.generate(3)


def sparse():
    """Tags far apart, beyond 32 bits in MSH 4.1."""
    start(1.0)
    for file, step in (("sparse-22-ascii", 99_999_937), ("sparse-41-ascii", 1 << 40), ("sparse-41-binary", 1 << 40)):
        gmsh.clear()
        gmsh.model.add("model")
        volume = gmsh.model.addDiscreteEntity(3)
        corners = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1]
        nodes = [5 + step * k for k in (4, 0, 2, 1, 3)]
        gmsh.model.mesh.addNodes(3, volume, nodes, corners)
        elements = [nodes[i] for i in (0, 1, 2, 3, 1, 2, 3, 4)]
        gmsh.model.mesh.addElementsByType(volume, 4, [3, 3 + 99_999_937], elements)
        gmsh.model.addPhysicalGroup(3, [volume], name="body")
        save(file, file.split("-")[1], file.endswith("binary"))


def variants_of_storage():
    """The same mesh with other word sizes and byte orders, as machines other than this one would write it."""
    mesh = meshio.read(os.path.join(HERE, "periodic-41-ascii.msh"))
    points = mesh.points
    tetrahedra = np.vstack([block.data for block in mesh.cells if block.type == "tetra"]) + 1
    for order, order_name in (("<", "little"), (">", "big")):
        for word in (4, 8) if order == ">" else (4,):
            size = "Q" if word == 8 else "I"

            def pack(kinds, *values):
                return struct.pack(order + kinds.replace("W", size), *values)

            body = b"$MeshFormat\n4.1 1 %d\n" % word + pack("i", 1) + b"\n$EndMeshFormat\n"
            body += b'$PhysicalNames\n1\n3 3 "body"\n$EndPhysicalNames\n'
            body += b"$Entities\n" + pack("WWWW", 0, 0, 0, 1) + pack("i6d", 1, 0, 0, 0, 1, 1, 1)
            body += pack("WiW", 1, 3, 0) + b"\n$EndEntities\n$Nodes\n"
            body += pack("WWWWiiiW", 1, len(points), 1, len(points), 3, 1, 0, len(points))
            body += pack("W" * len(points), *range(1, len(points) + 1))
            body += pack("d" * points.size, *points.ravel()) + b"\n$EndNodes\n$Elements\n"
            count = len(tetrahedra)
            body += pack("WWWWiiiW", 1, count, 1, count, 3, 1, 4, count)
            for tag, nodes in enumerate(tetrahedra, 1):
                body += pack("WWWWW", tag, *nodes)
            with open(os.path.join(HERE, f"storage-41-{order_name}-{word}.msh"), "wb") as file:
                file.write(body + b"\n$EndElements\n")

        # MSH 2.2, one header for every element, as older versions of Gmsh wrote
        body = b"$MeshFormat\n2.2 1 8\n" + struct.pack(order + "i", 1) + b"\n$EndMeshFormat\n"
        body += b'$PhysicalNames\n1\n3 3 "body"\n$EndPhysicalNames\n$Nodes\n%d\n' % len(points)
        for tag, point in enumerate(points, 1):
            body += struct.pack(order + "i3d", tag, *point)
        body += b"\n$EndNodes\n$Elements\n%d\n" % len(tetrahedra)
        for tag, nodes in enumerate(tetrahedra, 1):
            body += struct.pack(order + "3i3i4i", 4, 1, 2, tag, 3, 1, *nodes)
        with open(os.path.join(HERE, f"storage-22-{order_name}.msh"), "wb") as file:
            file.write(body + b"\n$EndElements\n")


def by_meshio():
    for version in VERSIONS:
        mesh = meshio.read(os.path.join(HERE, f"boxes-{version}-ascii.msh"))
        for binary in (False, True):
            path = os.path.join(HERE, f"meshio-{version}-{'binary' if binary else 'ascii'}.msh")
            meshio.write(path, mesh, file_format="gmsh" + ("22" if version == "22" else ""), binary=binary)


SHAPES = {15: 1, 1: 2, 2: 3, 3: 4, 4: 4, 8: 2, 9: 3, 10: 4, 11: 4, 26: 2, 21: 3, 29: 4}
FAMILY = {8: 1, 26: 1, 9: 2, 21: 2, 10: 3, 11: 4, 29: 4}
FAMILIES = {1: "vertex", 2: "line", 3: "triangle", 4: "quad", 5: "tetra"}


def describe(file):
    """One row of the table: elements of each shape, volume or area, groups with their numbers of elements."""
    path = os.path.join(HERE, file)
    gmsh.finalize()
    gmsh.initialize()  # a file that Gmsh refuses would spoil those after it
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        gmsh.open(path)
    except Exception as error:
        print(f"// gmsh refuses {file}: {error}")
        return
    position = {tag: xyz for tag, xyz in zip(*(lambda n, x: (n, x.reshape(-1, 3)))(*gmsh.model.mesh.getNodes()[:2]))}
    entity_elements = {}
    for entity in gmsh.model.getEntities():
        found = {}
        for code, _, nodes in zip(*gmsh.model.mesh.getElements(*entity)):
            if code not in SHAPES:
                found[code] = True
                continue
            per_element = gmsh.model.mesh.getElementProperties(code)[3]
            name = "vertex line triangle quad tetra".split()[[15, 1, 2, 3, 4].index(FAMILY.get(code, code))]
            for element in nodes.reshape(-1, per_element)[:, : SHAPES[code]]:
                found[(name, tuple(sorted(int(n) for n in element)))] = element
        entity_elements[entity] = found
    every = {}
    for found in entity_elements.values():
        every.update(found)
    counts = [sum(1 for key in every if isinstance(key, tuple) and key[0] == name) for name in FAMILIES.values()]
    volume = 0.0
    for key, element in every.items():
        if isinstance(key, tuple) and key[0] == "tetra":
            a, b, c, d = (position[n] for n in element)
            volume += abs(np.dot(b - a, np.cross(c - a, d - a))) / 6
    groups = []
    for dimension, tag in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, tag) or f"physical-{tag}"
        members = {}
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
            members.update(entity_elements[(dimension, abs(entity))])
        nodes = {n for key in members if isinstance(key, tuple) for n in key[1]}
        groups.append((dimension, tag, name, len(members), len(nodes)))
    print(f'    ("{file[:-4]}", {counts}, {volume:.12g}, &{[g for g in groups]}),'.replace("'", '"'))
    try:
        mesh = meshio.read(path)
    except (Exception, SystemExit) as error:
        print(f"// meshio refuses it: {type(error).__name__} {error}")
        return
    distinct = {}
    for block in mesh.cells:
        family = next((f for f in FAMILIES.values() if block.type.startswith(f)), block.type)
        corners = {"vertex": 1, "line": 2, "triangle": 3, "quad": 4, "tetra": 4}.get(family, 99)
        distinct.setdefault(family, set()).update(tuple(sorted(row)) for row in block.data[:, :corners].tolist())
    of_meshio = [len(distinct.get(name, ())) for name in FAMILIES.values()]
    if of_meshio != counts:
        print(f"// meshio finds {of_meshio}")
    lengths = {name: sum(len(x) for x in lists if x is not None) for name, lists in mesh.cell_sets.items()}
    print("//", {name: length for name, length in lengths.items() if "gmsh:" not in name})


def main():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    two_boxes()
    everywhere("boxes")
    save("all-22-ascii", "22", SaveAll=1)
    save("all-41-binary", "41", True, SaveAll=1)
    everywhere("parametric", SaveParametric=1, SaveAll=1)
    gmsh.model.mesh.partition(3)
    everywhere("parts")
    option("PartitionCreateTopology", 0)
    option("PartitionCreateGhostCells", 1)
    two_boxes()
    gmsh.model.mesh.partition(2)
    save("ghosts-22-ascii", "22")
    save("ghosts-41-binary", "41", True)
    option("PartitionCreateTopology", 1)
    option("PartitionCreateGhostCells", 0)
    two_boxes()
    gmsh.model.mesh.setOrder(2)
    save("quadratic-22-ascii", "22")
    save("quadratic-41-binary", "41", True)
    gmsh.model.mesh.setOrder(3)
    save("order3-22-ascii", "22")
    two_boxes()
    nodes, _, _ = gmsh.model.mesh.getNodes()
    gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
    view = gmsh.view.add("field")
    gmsh.view.addModelData(view, 0, "model", "NodeData", nodes, [[0.5 * tag] for tag in nodes])
    for version in VERSIONS:
        save(f"data-{version}-binary", version, True)
        gmsh.view.write(view, os.path.join(HERE, f"data-{version}-binary.msh"), append=True)
    gmsh.view.remove(view)
    plane()
    everywhere("plane")
    layers(False)
    save("layers-22-binary", "22", True, SaveAll=1)
    save("layers-41-binary", "41", True, SaveAll=1)
    layers(True)
    save("blocks-41-ascii")
    save("blocks-22-binary", "22", True)
    periodic()
    save("periodic-41-ascii")
    save("periodic-41-binary", "41", True)
    sparse()
    variants_of_storage()
    by_meshio()
    for file in sorted(os.listdir(HERE)):
        if file.endswith(".msh"):
            describe(file)


if __name__ == "__main__":
    main()
