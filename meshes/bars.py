"""Three plane bars of 10 mm in height end to end along x: `striker` and `trap` of 100 mm, `bar` of 300 mm between them. MSH 4.1 text.

Each is cut into squares, and these by one of their diagonals in turn; the bars have nodes of their own. Needs no gmsh: `python3 bars.py`.
"""

from pathlib import Path

HEIGHT = 10
# Name, ends along x [mm], squares across.
BARS = (("striker", -100, 0, 4), ("bar", 0, 300, 5), ("trap", 300, 400, 4))


def main():
    names, nodes, parts = [], [], []
    for name, start, end, across in BARS:
        size, first = HEIGHT / across, len(nodes) + 1
        along = round((end - start) / size)
        nodes += [(start + i * size, j * size - HEIGHT / 2) for i in range(along + 1) for j in range(across + 1)]
        triangles = []
        for i in range(along):
            for j in range(across):
                a, b = first + i * (across + 1) + j, first + (i + 1) * (across + 1) + j
                c, d = b + 1, a + 1
                triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
        names.append(name)
        parts.append((f"{start / 1000} -0.005 0 {end / 1000} 0.005 0", triangles))
    count = sum(len(part) for _, part in parts)
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'2 {tag} "{name}"' for tag, name in enumerate(names, 1)] + ["$EndPhysicalNames"]
    lines += ["$Entities", f"0 0 {len(parts)} 0"]
    lines += [f"{tag} {extent} 1 {tag} 0" for tag, (extent, _) in enumerate(parts, 1)] + ["$EndEntities"]
    lines += ["$Nodes", f"1 {len(nodes)} 1 {len(nodes)}", f"2 1 0 {len(nodes)}"]
    lines += [str(tag) for tag in range(1, len(nodes) + 1)] + [f"{x / 1000:.6g} {y / 1000:.6g} 0" for x, y in nodes]
    lines += ["$EndNodes", "$Elements", f"{len(parts)} {count} 1 {count}"]
    tag = 0
    for entity, (_, triangles) in enumerate(parts, 1):
        lines.append(f"2 {entity} 2 {len(triangles)}")
        for corners in triangles:
            tag += 1
            lines.append(" ".join(map(str, (tag, *corners))))
    lines.append("$EndElements")
    Path(__file__).with_name("bars-plane").joinpath("line.msh").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
