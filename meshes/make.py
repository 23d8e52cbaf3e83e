#!/usr/bin/env python3
"""Makes the meshes of this folder: `pip install gmsh==4.15.2`, then `python3 make.py`.

    make.py [NAME...]     make the meshes whose names begin with one of NAME (all of those in git by default)
    make.py --large       make the large ones for timing, in large/ (not in git)
    make.py --table       print what the files hold, as the table of README.md

One thread and fixed seeds: the same gmsh makes the same files. Another version of gmsh makes other, equally good ones;
then the expected counts in README.md no longer hold.
"""

import argparse
import sys
from pathlib import Path

import gmsh

import beams
import boxes
import extrude
import quality
import tunnel

HERE = Path(__file__).resolve().parent
GMSH = "4.15.2"

ROD = {"A": 0, "B": 0.01, "H": 0.05, "h": 0.002, "algorithm": 5}

# name: (geometry, its parameters, binary). Small meshes are text, to be read by eye; the finest is text too, because
# binary MSH writes every tag with 8 bytes and grows above 2.5 MiB.
UNSTRUCTURED = {
    "brazilian/coarse": ("brazilian/brazilian.geo", {"bulk": 0.0153, "across": 3}, True),
    "brazilian/medium": ("brazilian/brazilian.geo", {"bulk": 0.0098, "across": 4}, True),
    "brazilian/fine": ("brazilian/brazilian.geo", {"bulk": 0.00775, "across": 5}, False),
    "tension-bar/gmsh-coarse": ("tension-bar/bar.geo", {"h": 0.0044}, False),
    "tension-bar/gmsh-fine": ("tension-bar/bar.geo", {"h": 0.0025}, True),
    "tension-bar/half": ("tension-bar/bar.geo", {"L": 0.05, "H": 0.01, "h": 0.0033}, False),
    "tension-bar-plane/aligned-coarse": ("tension-bar-plane/bar.geo", {"h": 0.004, "algorithm": 0}, False),
    "tension-bar-plane/aligned-fine": ("tension-bar-plane/bar.geo", {"h": 0.002, "algorithm": 0}, False),
    "tension-bar-plane/rows-coarse": ("tension-bar-plane/bar.geo", {"h": 0.004, "algorithm": 6}, False),
    "tension-bar-plane/rows-fine": ("tension-bar-plane/bar.geo", {"h": 0.002, "algorithm": 6}, False),
    "tension-bar-plane/delaunay-coarse": ("tension-bar-plane/bar.geo", {"h": 0.004, "algorithm": 5}, False),
    "tension-bar-plane/delaunay-fine": ("tension-bar-plane/bar.geo", {"h": 0.002, "algorithm": 5}, False),
    "tension-bar-plane/double": ("tension-bar-plane/bar.geo", {"L": 0.2, "H": 0.04, "h": 0.004, "algorithm": 5}, False),
    "patch/cube": ("patch/cube.geo", {}, False),
    "falling-block/block": ("falling-block/block.geo", {}, False),
    "ball-on-edge/scene": ("ball-on-edge/scene.geo", {}, False),
    "tied/bar": ("tied/bar.geo", {}, False),
    "tied/column": ("tied/column.geo", {}, True),
    "tied/block": ("tied/block.geo", {}, True),
    "brazilian-plane/coarse": ("brazilian-plane/disc.geo", {"bulk": 0.006, "across": 4}, False),
    "brazilian-plane/medium": ("brazilian-plane/disc.geo", {"bulk": 0.004, "across": 6}, False),
    "brazilian-plane/fine": ("brazilian-plane/disc.geo", {"bulk": 0.0026, "across": 9}, False),
    "crack-size-plane/delaunay-50": ("crack-size-plane/plate.geo", {"h": 0.5, "line": 0}, False),
    "crack-size-plane/delaunay-20": ("crack-size-plane/plate.geo", {"h": 0.2, "line": 0}, False),
    "crack-size-plane/delaunay-10": ("crack-size-plane/plate.geo", {"h": 0.1, "line": 0}, False),
    "crack-size-plane/delaunay-5": ("crack-size-plane/plate.geo", {"h": 0.05, "line": 0}, False),
    "crack-size-plane/rows-50": ("crack-size-plane/plate.geo", {"h": 0.5, "algorithm": 6, "line": 0}, False),
    "crack-size-plane/rows-20": ("crack-size-plane/plate.geo", {"h": 0.2, "algorithm": 6, "line": 0}, False),
    "crack-size-plane/rows-10": ("crack-size-plane/plate.geo", {"h": 0.1, "algorithm": 6, "line": 0}, False),
    "crack-size-plane/rows-5": ("crack-size-plane/plate.geo", {"h": 0.05, "algorithm": 6, "line": 0}, False),
    "crack-size/penny": ("crack-size/penny.geo", {"h": 0.4}, True),
    "crack-size-plane/notch-30": ("crack-size-plane/notch.geo", {"h": 0.15, "algorithm": 6, "angle": 30}, False),
    "crack-size-plane/line": ("crack-size-plane/plate.geo", {"h": 0.1, "line": 1}, False),
    "double-notched-plane/coarse": ("double-notched-plane/beam.geo", {"h": 0.0097}, False),
    "double-notched-plane/medium": ("double-notched-plane/beam.geo", {"h": 0.0074}, False),
    "double-notched-plane/fine": ("double-notched-plane/beam.geo", {"h": 0.0039}, False),
    "excavation/cavity": ("excavation/cavity.geo", {}, True),
    "excavation-plane/hole": ("excavation-plane/hole.geo", {}, False),
    "excavation-plane/hole-delaunay": ("excavation-plane/hole.geo", {"algorithm": 5}, False),
    "excavation-plane/tunnel": ("excavation-plane/tunnel.geo", {}, False),
    "cantilever-plane/depth-2": ("cantilever-plane/beam.geo", {"depth": 2}, False),
    "cantilever-plane/depth-4": ("cantilever-plane/beam.geo", {"depth": 4}, False),
    "cantilever-plane/depth-8": ("cantilever-plane/beam.geo", {"depth": 8}, False),
    "cantilever-plane/delaunay-2": ("cantilever-plane/delaunay.geo", {"depth": 2}, False),
    "cantilever-plane/delaunay-4": ("cantilever-plane/delaunay.geo", {"depth": 4}, False),
    "cantilever-plane/delaunay-8": ("cantilever-plane/delaunay.geo", {"depth": 8}, False),
    "notched-beam-plane/delaunay-10": ("notched-beam-plane/beam.geo", {"h": 0.01}, False),
    "notched-beam-plane/delaunay-5": ("notched-beam-plane/beam.geo", {"h": 0.005}, False),
    "kirsch-plane/coarse": ("kirsch-plane/plate.geo", {"h": 0.002}, False),
    "kirsch-plane/medium": ("kirsch-plane/plate.geo", {"h": 0.001}, False),
    "kirsch-plane/fine": ("kirsch-plane/plate.geo", {"h": 0.0005}, False),
    "pressurised-crack-plane/elements-10": ("pressurised-crack-plane/plate.geo", {"elements": 10}, False),
    "pressurised-crack-plane/elements-20": ("pressurised-crack-plane/plate.geo", {"elements": 20}, False),
    "gas-blast-plane/coarse": ("gas-blast-plane/plate.geo", {"h": 0.0012, "far": 0.0022}, False),
    "spall-plane/coarse": ("spall-plane/bar.geo", {"h": 0.0005}, False),
    "spall-plane/fine": ("spall-plane/bar.geo", {"h": 0.00035}, True),
    "borehole-plane/half": ("borehole-plane/half.geo", {}, False),
    "blast-plane/shale": ("blast-plane/hole.geo", {"h": 0.02, "band": 0.06, "L": 30}, False),
    "blast-plane/granite": ("blast-plane/disc.geo", {"h": 0.0006, "far": 0.0011, "length": 0}, False),
    "blast-plane/bench": ("blast-plane/bench.geo", {"h": 0.06}, False),
    "blast/bench": ("blast/bench.geo", {"h": 0.1}, True),
    "blast/granite": ("blast-plane/disc.geo", {"h": 0.0025, "far": 0.009, "length": 0.15}, True),
    "absorbing-plane/p-30": ("absorbing-plane/channel.geo", {"angle": 30, "W": 0.1, "L": 0.03}, False),
    "absorbing-plane/p-60": ("absorbing-plane/channel.geo", {"angle": 60, "W": 0.1, "L": 0.03}, False),
    "l-panel-plane/delaunay-10": ("l-panel-plane/panel.geo", {"h": 0.01, "algorithm": 5}, False),
    "l-panel-plane/delaunay-5": ("l-panel-plane/panel.geo", {"h": 0.005, "algorithm": 5}, False),
    "l-panel-plane/rows-10": ("l-panel-plane/panel.geo", {"h": 0.01, "algorithm": 6}, False),
    "l-panel-plane/rows-5": ("l-panel-plane/panel.geo", {"h": 0.005, "algorithm": 6}, False),
    "branching-plane/delaunay": ("branching-plane/plate.geo", {"h": 0.0007, "algorithm": 5}, False),
    "branching-plane/rows": ("branching-plane/plate.geo", {"h": 0.0005, "algorithm": 6}, False),
    "branching-plane/plugged": ("branching-plane/plate.geo", {"h": 0.0005, "algorithm": 5, "plug": 1}, False),
    "graded-plate-plane/plate": ("graded-plate-plane/plate.geo", {"h": 0.0025}, False),
    "heat-plane/sheet": ("heat-plane/plate.geo", {"L": 0.05, "H": 0.03, "h": 0.001}, False),
    "heat-plane/strip": ("heat-plane/plate.geo", {"L": 0.01, "H": 0.005, "h": 0.00012}, False),
    "axisymmetric-plane/tube": ("axisymmetric-plane/tube.geo", {"A": 0.05, "B": 0.1, "H": 0.05, "h": 0.004, "algorithm": 5}, False),
    "axisymmetric-plane/shell": ("axisymmetric-plane/shell.geo", {"h": 0.004}, False),
    "axisymmetric-plane/rod": ("axisymmetric-plane/tube.geo", ROD, False),
    "axisymmetric-plane/rod-aligned": ("axisymmetric-plane/tube.geo", {**ROD, "algorithm": 0}, False),
    "axisymmetric-plane/block": ("axisymmetric-plane/block.geo", {}, False),
    "bending-plane/plain": ("bending/beam.geo", {"h": 0.005, "far": 0.012, "notch": 0, "layers": 0}, False),
    "bending-plane/notched": ("bending/beam.geo", {"h": 0.005, "far": 0.012, "notch": 0.03, "layers": 0}, False),
    "bending-plane/notched-10": ("bending/beam.geo", {"h": 0.01, "far": 0.02, "notch": 0.03, "layers": 0}, False),
    "bending/plain": ("bending/beam.geo", {"h": 0.01, "far": 0.02, "notch": 0, "layers": 6}, True),
    "bending/notched": ("bending/beam.geo", {"h": 0.01, "far": 0.02, "notch": 0.03, "layers": 6}, True),
}

LARGE = {
    "large/56k": ("cube.geo", {"h": 0.0436}, True),
    "large/500k": ("cube.geo", {"h": 0.0211}, True),
    "large/2M": ("cube.geo", {"h": 0.0131}, True),
    "large/graded-plate": ("graded-plate-plane/plate.geo", {"h": 0.00125, "far": 0.01, "radius": 0.012}, True),
    "large/granite": ("blast-plane/disc.geo", {"h": 0.0018, "far": 0.0040, "length": 0.15}, True),
}

ENDS = {"left": ["x_min"], "right": ["x_max"]}
BAR = {"corner": (-0.05, -0.01, -0.01), "size": (0.1, 0.02, 0.02), "body": "bar", "groups": ENDS}
BEAM = {
    "corner": (0.0, -0.05, -0.05),
    "size": (1.0, 0.1, 0.1),
    "body": "beam",
    "groups": {"clamp": ["x_min"], "tip": ["x_max"]},
}
WAVE_BAR = {
    "corner": (0.0, -0.001, -0.001),
    "size": (0.4, 0.002, 0.002),
    "cells": (400, 2, 2),
    "binary": False,
    "body": "bar",
    "groups": {
        **ENDS,
        "y_faces": ["y_min", "y_max"],
        "z_faces": ["z_min", "z_max"],
        "lateral": ["y_min", "y_max", "z_min", "z_max"],
    },
}

# name: arguments of boxes.box; text is also the shorter form of round coordinates
STRUCTURED = {
    "tension-bar/aligned-coarse": {**BAR, "cells": (25, 5, 5), "binary": False},
    "tension-bar/aligned-fine": {**BAR, "cells": (45, 9, 9), "binary": False},
    "tension-bar/jittered-coarse": {**BAR, "cells": (25, 5, 5), "jitter": 0.2, "binary": False},
    "tension-bar/jittered-fine": {**BAR, "cells": (45, 9, 9), "jitter": 0.2},
    "wave-bar/bar": WAVE_BAR,
    "cantilever/depth-2": {**BEAM, "cells": (20, 2, 2), "binary": False},
    "cantilever/depth-4": {**BEAM, "cells": (40, 4, 4), "binary": False},
    "cantilever/depth-8": {**BEAM, "cells": (80, 8, 8), "binary": False},
}


# name: arguments of beams.notched_beam
NOTCHED = {
    "notched-beam-plane/straight-10": {"h": 0.01, "lattice": "squares"},
    "notched-beam-plane/straight-5": {"h": 0.005, "lattice": "squares"},
    "notched-beam-plane/jittered-10": {"h": 0.01, "lattice": "squares", "jitter": 0.2},
    "notched-beam-plane/jittered-5": {"h": 0.005, "lattice": "squares", "jitter": 0.2},
    "notched-beam-plane/tilt-10": {"h": 0.01, "tilt": 10},
    "notched-beam-plane/tilt-20": {"h": 0.01, "tilt": 20},
    "notched-beam-plane/tilt-20-5": {"h": 0.005, "tilt": 20},
    "notched-beam-plane/tilt-30": {"h": 0.01, "tilt": 30},
}


# name: mesh of triangles in this folder, and further arguments of extrude.extrude
EXTRUDED = {
    "notched-beam/tilt-10": (
        "notched-beam-plane/tilt-10.msh",
        {"depth": 0.025, "layers": 2, "body": "beam", "lines": ["left", "right", "load", "mouth_left", "mouth_right"]},
    ),
}


# name: firing sequence that belongs to the mesh
TUNNEL = {"blast-plane/tunnel": "../cases/tunnel-front/sequence.csv"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="*")
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()

    known = [*LARGE] if arguments.large else [*UNSTRUCTURED, *STRUCTURED, *NOTCHED, *EXTRUDED, *TUNNEL]
    chosen = [name for name in known if not arguments.name or name.startswith(tuple(arguments.name))]
    if not chosen:
        sys.exit(f"no mesh begins with {' or '.join(arguments.name)}; there are {', '.join(known)}")
    if arguments.table:
        for header, row, plane in (quality.HEADER, quality.row, False), (quality.PLANE_HEADER, quality.plane_row, True):
            print(header)
            for name in sorted(name for name in chosen if is_plane(name) == plane):
                with_gmsh({}, lambda: print(row(name, HERE / f"{name}.msh")))
        return
    for name in sorted(chosen):
        make(name, HERE / f"{name}.msh")


def is_plane(name):
    return "-plane/" in name


def make(name, path):
    if gmsh.__version__ != GMSH:
        print(f"gmsh is {gmsh.__version__}; the meshes in git were made by {GMSH}", file=sys.stderr)
    path.parent.mkdir(exist_ok=True)
    if name in STRUCTURED:
        with_gmsh({}, lambda: boxes.box(path, **STRUCTURED[name]))
    elif name in NOTCHED:
        with_gmsh({}, lambda: beams.notched_beam(path, **NOTCHED[name]))
    elif name in EXTRUDED:
        plane, arguments = EXTRUDED[name]
        with_gmsh({}, lambda: extrude.extrude(path, HERE / plane, **arguments))
    elif name in TUNNEL:
        with_gmsh({}, lambda: tunnel.tunnel(path, HERE / TUNNEL[name]))
    else:
        geometry, parameters, binary = (UNSTRUCTURED | LARGE)[name]
        with_gmsh(parameters, lambda: unstructured(path, geometry, binary))
    print(f"{name}.msh: {path.stat().st_size / 1024:,.0f} KiB")


def unstructured(path, geometry, binary):
    gmsh.open(str(HERE / geometry))
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.Binary", int(binary))
    gmsh.write(str(path))


def with_gmsh(parameters, work):
    """Runs `work` in a fresh gmsh, so that no option of one mesh reaches the next."""
    settings = [text for name, value in parameters.items() for text in ("-setnumber", name, str(value))]
    gmsh.initialize(["gmsh", *settings], readConfigFiles=False)
    gmsh.option.setNumber("General.Verbosity", 2)
    gmsh.option.setNumber("General.NumThreads", 1)
    try:
        work()
    finally:
        gmsh.onelab.clear()  # else its parameters become those of the next geometry
        gmsh.finalize()


if __name__ == "__main__":
    main()
