#!/usr/bin/env python3
"""Crack loads with error bars against exact ones (needs numpy and scipy): the scenes of scenes.csv on coarse rows of triangles, with solver.accuracy.

    python passes.py PROGRAM [FOLDER] [--phase-field] [NAME ...]

Each scene begins on squares of its `size` that are cut into triangles. A line tells how far the estimate is from the exact load, half of its bar, whether the
bar holds the truth, the time of all passes, and how far each pass is off; an L stands before passes along a line.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from exact import table

HERE = Path(__file__).parent

CASE = """fractum = 1
title = "{name}"
[mesh]
file = "rows.msh"
[materials.m]
density = "2400 kg/m^3"
young_modulus = {young_modulus}
poisson_ratio = {poisson_ratio}
[materials.m.damage]
tensile_strength = {tensile_strength}
fracture_energy = {fracture_energy}
softening = "{softening}"
regularisation = "{regularisation}"
[[bodies]]
name = "body"
kind = "solid"
group = "body"
material = "m"
plane = "{plane}"
thickness = "0.1 m"
damage_where = "x > {begin} && abs(y) < {near}"
{supports}
[solver]
kind = "static"
end = "1 s"
accuracy = "3 %"
stop_when = {{ probe = "load", below = 0.7, lasting = "0 s" }}
[[probes]]
name = "load"
reaction = {{ group = "{pulled}", along = "{along}" }}
"""


def cut(low, high, size):
    return np.linspace(low, high, max(2, round((high - low) / size)) + 1)


def support(group, text):
    return f'[[supports]]\ngroup = "{group}"\n{text}\n'


def begun(scene, size, folder, regularisation):
    """Writes mesh and case: x along the crack, y across it."""
    is_beam, a, width, half = scene["kind"] == "beam", scene["notch"], scene["width"], scene["height"]
    x = np.concatenate([cut(0, a, size)[:-1], cut(a, width, size)]) if a > 0 else cut(0, width, size)
    side = np.concatenate([cut(0, half, size)[:-1], cut(half, half + width / 4, size)]) if is_beam else cut(0, half, size)
    y = np.concatenate([-side[:0:-1], side])
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    nodes = [[px, py] for px in x for py in y]
    corners = [part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])]
    triangles = np.concatenate([np.stack([corners[i] for i in own], 1) for own in ([0, 1, 2], [0, 2, 3])])
    # Nodes of the notch have a twin below it.
    twin = {}
    for node in number[x < a - 1e-9, len(side) - 1]:
        twin[int(node)] = len(nodes)
        nodes.append(list(nodes[node]))
    nodes = np.array(nodes)
    below = nodes[triangles][:, :, 1].mean(1) < 0
    triangles[below] = np.vectorize(lambda node: twin.get(node, node))(triangles[below])
    at = lambda axis, value: set(np.flatnonzero(abs(nodes[:, axis] - value) < 1e-9 * width))
    edges = np.concatenate([triangles[:, own] for own in ([0, 1], [1, 2], [2, 0])])
    lines = lambda own: [edge for edge in edges.tolist() if set(edge) <= own]
    if is_beam:
        points = {"low": at(0, 0) & at(1, -half), "high": at(0, 0) & at(1, half), "middle": at(0, width) & at(1, 0)}
        groups = {name: (0, [list(own)]) for name, own in points.items()}
        supports, pulled, along = support("low", 'fix = "xy"') + support("high", 'fix = "x"'), "middle", "-x"
    else:
        sides = {"top": at(1, half), "bottom": at(1, -half)}
        # The middle of the plate, or a corner that keeps it where it is.
        middle = {"centre": at(0, 0), "double": at(0, width)}.get(scene["kind"])
        groups = {name: (1, lines(own)) for name, own in sides.items()}
        groups["held"] = (1, lines(middle)) if middle else (0, [list(at(0, 0) & at(1, -half))])
        supports, pulled, along = support("held", 'fix = "x"'), "top", "y"
    groups["body"] = (2, triangles.tolist())
    write(folder / "rows.msh", nodes, groups)
    # Far enough for the peak, since the run ends when the load has fallen.
    strain = scene["tensile_strength"] / scene["young_modulus"]
    way = 6 * strain * half + 4 * scene["fracture_energy"] / scene["tensile_strength"]
    if is_beam:
        supports += support("middle", f'displacement = {{ x = "-{way:.6g} m*t/1 s" }}')
    else:
        supports += "".join(support(name, f'displacement = {{ y = "{sign}{way / 2:.6g} m*t/1 s" }}') for name, sign in (("top", ""), ("bottom", "-")))
    near = max(0.25 * (width - a), 4 * size) if a > 0 else 0.5 * half
    places = {"begin": f"{a - 2.5 * size:.6g}" if a > 0 else "-1", "near": f"{near:.6g}"}
    (folder / "case.toml").write_text(CASE.format(**scene, **places, regularisation=regularisation, supports=supports, pulled=pulled, along=along))


def write(path, nodes, groups):
    kinds = {0: 15, 1: 1, 2: 2}
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    text += [f'{dimension} {tag} "{name}"' for tag, (name, (dimension, _)) in enumerate(groups.items(), 1)]
    text += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    text += [f"{number} {x:.15g} {y:.15g} 0" for number, (x, y) in enumerate(nodes, 1)]
    elements = [(kinds[dimension], tag, own) for tag, (dimension, all) in enumerate(groups.values(), 1) for own in all]
    text += ["$EndNodes", "$Elements", str(len(elements))]
    text += [f"{number} {kind} 2 {tag} {tag} {' '.join(str(node + 1) for node in own)}" for number, (kind, tag, own) in enumerate(elements, 1)]
    path.write_text("\n".join([*text, "$EndElements", ""]))


def main():
    field = "--phase-field"
    regularisation = "phase-field" if field in sys.argv else "none"
    program, *rest = [argument for argument in sys.argv[1:] if argument != field]
    program, results, only = Path(program).resolve(), Path(rest[0] if rest else "passes"), rest[1:]
    held = []
    for scene in table(HERE / "scenes.csv"):
        name = scene["name"]
        if only and name not in only:
            continue
        folder = results / name
        folder.mkdir(parents=True, exist_ok=True)
        zone = scene["young_modulus"] * scene["fracture_energy"] / scene["tensile_strength"] ** 2
        begun(scene, scene["size"] * zone, folder, regularisation)
        started = time.time()
        ended = subprocess.run([program, "run", "case.toml", "-o", "out", "--overwrite", "--quiet", "--threads", "1"], cwd=folder, capture_output=True, text=True)
        took = time.time() - started
        if ended.returncode != 0:
            print(f"{name}: {ended.stderr.strip().splitlines()[-1]}", flush=True)
            continue
        accuracy = json.loads((folder / "out/summary.json").read_text())["accuracy"]
        # Loads of the table are those of the whole body, of which plates with a plane of symmetry have one half here.
        exact = scene["load"] / (2 if scene["kind"] in ("centre", "double") else 1)
        load = accuracy["probes"]["load"]
        off, half = load["value"] / exact - 1, load["half"] / exact
        held.append(abs(off) <= half)
        passes = " ".join(f"{'L' if one['line'] else ''}{one['size'] / accuracy['length']:.3f}:{one['peaks']['load'] / exact - 1:+.1%}" for one in accuracy["passes"])
        print(f"{name:10} {off:+.1%}, bar {half:.1%}, {'held' if held[-1] else 'MISSED'}, {took:.0f} s; {passes}", flush=True)
    print(f"{sum(held)} of {len(held)} bars hold the exact load")


if __name__ == "__main__":
    main()
