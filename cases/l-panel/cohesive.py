#!/usr/bin/env python3
"""Crack of an L-shaped panel as a discrete cohesive crack: `pip install gmsh==4.15.2 numpy scipy`, then `python3 cohesive.py [SEGMENT] [GF]`.

The crack grows from the corner by straight segments (SEGMENT m, 0.02 by default), each normal to the largest principal stress ahead of its tip: the mean over a
half disc of 1.5 segments, weighted by a bell curve. Its faces carry a normal traction that falls exponentially with their opening, and no shear. For each
length the panel is meshed anew with quadratic triangles, and the lift is found at which the principal stress ahead reaches the strength. Prints tip, lift, load and direction.
"""

import sys

import gmsh
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linear

E, NU, FT, THICKNESS = 25.85e9, 0.18, 2.7e6, 0.1
CONTACT = 2e13  # stiffness of the faces before they open and when they close [N/m³]
D = E / (1 - NU * NU) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
CORNER, LOAD = (0.25, 0.25), (0.47, 0.25)
POINTS = [(1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)]
LINE = [(0.5 - 0.15**0.5, 5 / 18), (0.5, 8 / 18), (0.5 + 0.15**0.5, 5 / 18)]


def mesh(path, segment):
    """Nodes and six-node triangles of the panel, with two faces along the path."""
    gmsh.initialize(["gmsh"], readConfigFiles=False)
    gmsh.option.setNumber("General.Verbosity", 1)
    gmsh.option.setNumber("General.NumThreads", 1)
    geo, field = gmsh.model.geo, gmsh.model.mesh.field
    corners = [(0, 0), (0.25, 0), CORNER, LOAD, (0.5, 0.25), (0.5, 0.5), (0, 0.5)]
    tags = [geo.addPoint(x, y, 0) for x, y in corners]
    lines = [geo.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1])]
    panel = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    along = [tags[2]] + [geo.addPoint(x, y, 0) for x, y in path[1:]]
    crack = [geo.addLine(a, b) for a, b in zip(along, along[1:])]
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [panel], 1)
    size, (x, y) = segment / 2, path[-1]
    sizes = [f"{size}+0.22*Max(0,Sqrt((x-{x})^2+(y-({y}))^2)-{4.5 * segment})", "0.04"]
    if crack:
        gmsh.model.mesh.embed(1, crack, 2, panel)
        gmsh.model.addPhysicalGroup(1, crack, 2)
        gmsh.model.addPhysicalGroup(0, [tags[2]], 3)
        field.add("Distance", 1)
        field.setNumbers(1, "CurvesList", crack)
        field.setNumber(1, "Sampling", 50)
        sizes.append(f"{size}+0.25*F1")
    for tag, text in enumerate(sizes, 2):
        field.add("MathEval", tag)
        field.setString(tag, "F", text)
    field.add("Min", 9)
    field.setNumbers(9, "FieldsList", range(2, 2 + len(sizes)))
    field.setAsBackgroundMesh(9)
    for option, value in {"MeshSizeExtendFromBoundary": 0, "MeshSizeFromPoints": 0, "Algorithm": 5}.items():
        gmsh.option.setNumber(f"Mesh.{option}", value)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    if crack:
        for option, value in {"Dimension": 1, "PhysicalGroup": 2, "OpenBoundaryPhysicalGroup": 3}.items():
            gmsh.plugin.setNumber("Crack", option, value)
        gmsh.plugin.run("Crack")
    names, coordinates, _ = gmsh.model.mesh.getNodes()
    number = {int(name): index for index, name in enumerate(names)}
    triangles = [number[int(name)] for name in gmsh.model.mesh.getElements(2)[2][0]]
    gmsh.finalize()
    return coordinates.reshape(-1, 3)[:, :2], np.array(triangles).reshape(-1, 6)


def faces(nodes, triangles, path):
    """Pairs of sides that lie on each other: the nodes of both, the normal of the first, the length."""
    sides = {}
    for triangle in triangles:
        for a, b, middle in [(0, 1, 3), (1, 2, 4), (2, 0, 5)]:
            a, b, middle = triangle[[a, b, middle]]
            sides.setdefault(tuple(np.round(nodes[middle], 9)), []).append((a, middle, b))
    found = []
    for pair in sides.values():
        if len(pair) == 2 and pair[0][1] != pair[1][1]:
            (a, middle, b), other = pair
            along = nodes[b] - nodes[a]
            length = np.linalg.norm(along)
            found.append(((a, middle, b), other[::-1], np.array([along[1], -along[0]]) / length, length))
    # The two sides at the tip share its node but not their middle.
    assert bool(found) == (len(path) > 1)
    return found


def shapes(r, s):
    a = 1 - r - s
    values = [a * (2 * a - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * a * r, 4 * r * s, 4 * s * a]
    slopes = [[1 - 4 * a] * 2, [4 * r - 1, 0], [0, 4 * s - 1], [4 * (a - r), -4 * r], [4 * s, 4 * r], [-4 * s, 4 * (a - s)]]
    return np.array(values), np.array(slopes)


class Panel:
    def __init__(self, path, segment, energy):
        self.energy, self.reach, self.tip = energy, 1.5 * segment, np.array(path[-1])
        self.ahead = self.tip - path[-2] if len(path) > 1 else np.array([-1, 0.5])
        nodes, triangles = mesh(path, segment)
        self.faces = [self.face(*face) for face in faces(nodes, triangles, path)]
        self.freedoms = np.stack([2 * triangles, 2 * triangles + 1], 2).reshape(-1, 12)
        self.samples, matrix = [], 0
        for r, s in POINTS:
            values, slopes = shapes(r, s)
            jacobian = np.einsum("eik,il->ekl", nodes[triangles], slopes)
            g = np.einsum("il,elk->eik", slopes, np.linalg.inv(jacobian))
            b = np.zeros((len(triangles), 3, 12))
            b[:, 0, 0::2], b[:, 1, 1::2], b[:, 2, 0::2], b[:, 2, 1::2] = g[..., 0], g[..., 1], g[..., 1], g[..., 0]
            weight = np.linalg.det(jacobian) / 6 * THICKNESS
            matrix = matrix + np.einsum("eki,kl,elj,e->eij", b, D, b, weight)
            self.samples.append((b, weight, np.einsum("i,eik->ek", values, nodes[triangles])))
        self.size = 2 * len(nodes)
        self.matrix = self.assemble(self.freedoms, matrix)
        base = np.where(nodes[:, 1] < 1e-9)[0]
        self.load = 2 * np.argmin(np.hypot(*(nodes - LOAD).T)) + 1
        self.free = np.setdiff1d(np.arange(self.size), np.concatenate([2 * base, 2 * base + 1, [self.load]]))

    def assemble(self, freedoms, matrices):
        count = freedoms.shape[1]
        places = (np.repeat(freedoms, count, 1).ravel(), np.tile(freedoms, (1, count)).ravel())
        return sparse.csr_matrix((matrices.ravel(), places), shape=(self.size, self.size))

    def face(self, first, second, normal, length):
        freedoms = np.array([2 * node + axis for node in (*first, *second) for axis in (0, 1)])
        rows = []
        for x, weight in LINE:
            n = np.array([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)])
            rows.append((np.concatenate([-np.outer(n, normal).ravel(), np.outer(n, normal).ravel()]), weight * length * THICKNESS))
        return freedoms, rows

    def traction(self, opening):
        onset = FT / CONTACT
        if opening <= onset:
            return CONTACT * opening, CONTACT
        traction = FT * np.exp(-FT * (opening - onset) / self.energy)
        return traction, -FT / self.energy * traction

    def solve(self, lift, u):
        """Equilibrium at a lift of the load, from a guess; the load with it."""
        u = u.copy()
        u[self.load] = lift
        for step in range(60):
            force, tangent = self.matrix @ u, self.matrix
            if self.faces:
                stiffness = np.zeros((len(self.faces), 12, 12))
                for own, (freedoms, rows) in zip(stiffness, self.faces):
                    for row, weight in rows:
                        traction, slope = self.traction(row @ u[freedoms])
                        force[freedoms] += traction * weight * row
                        own += slope * weight * np.outer(row, row)
                tangent = tangent + self.assemble(np.array([face[0] for face in self.faces]), stiffness)
            if step and np.linalg.norm(force[self.free]) < 1e-7 * abs(force[self.load]):
                return u, force[self.load]
            u[self.free] -= linear.splu(tangent[self.free][:, self.free].tocsc()).solve(force[self.free])
        raise SystemExit(f"no equilibrium at a lift of {lift} m")

    def stress_ahead(self, u):
        """Largest principal stress ahead of the tip, and its direction."""
        total, weights = np.zeros(3), 0
        for b, weight, places in self.samples:
            r = places - self.tip
            distance = np.hypot(*r.T)
            near = (distance < self.reach) & (r @ self.ahead > 0)
            stress = np.einsum("kl,elj,ej->ek", D, b[near], u[self.freedoms[near]])
            bell = weight[near] * np.exp(-4.5 * (distance[near] / self.reach) ** 2)
            total, weights = total + bell @ stress, weights + bell.sum()
        xx, yy, xy = total / weights
        return (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy), 0.5 * np.arctan2(2 * xy, xx - yy)

    def grow(self, lift):
        """Lift and load at which the crack grows, and the direction in which it does."""
        u, last = np.zeros(self.size), (0, 0)
        for _ in range(25):
            u, load = self.solve(lift, u)
            stress, angle = self.stress_ahead(u)
            if abs(stress / FT - 1) < 2e-3:
                break
            step = (FT - stress) * (lift - last[0]) / (stress - last[1])
            last, lift = (lift, stress), min(max(lift + step, 0.5 * lift), 1.6 * lift)
        direction = np.array([-np.sin(angle), np.cos(angle)])
        return lift, load, direction * np.sign(direction @ self.ahead)


def main():
    segment = float(sys.argv[1]) if len(sys.argv) > 1 else 0.02
    energy = float(sys.argv[2]) if len(sys.argv) > 2 else 90
    path, lift = [CORNER], 1e-4
    print("tip x [mm]   y [mm]   lift [mm]   load [N]   angle [deg]")
    while path[-1][0] > 0.11:  # further on the stress ahead is nearly the same in all directions, and the crack goes to and fro
        lift, load, direction = Panel(path, segment, energy).grow(lift)
        (x, y), angle = path[-1], np.degrees(np.arctan2(direction[1], -direction[0]))
        print(f"{1e3 * x:10.1f} {1e3 * y:8.1f} {1e3 * lift:11.4f} {load:10.0f} {angle:13.1f}", flush=True)
        path.append(tuple(path[-1] + segment * direction))


if __name__ == "__main__":
    main()
