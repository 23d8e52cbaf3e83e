#!/usr/bin/env python3
"""How far the regularised crack leans by where the rows of the mesh lie: `python3 cases/notched-beam/places.py PROGRAM`, a minute; README.md has the results.

Needs gmsh (`pip install gmsh==4.15.2`). Runs `tilt-20-phase.toml` on other meshes."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
MESHES = HERE.parent.parent / "meshes"
sys.path.insert(0, str(MESHES))

import gmsh  # noqa: E402
from beams import notched_beam  # noqa: E402

QUARTERS, HALVES = [0, 0.25, 0.5, 0.75], [0, 0.5]
# What it is, element size [m], angle of the rows [deg], shifts along the rows, and whether the notch is pointed.
SETS = [
    ("rows at 20 deg, 10 mm", 0.01, 20, QUARTERS, False),
    ("rows at 20 deg, 5 mm", 0.005, 20, HALVES, False),
    ("rows at 10 deg, 10 mm", 0.01, 10, HALVES, False),
    ("rows at 20 deg, 10 mm, pointed notch", 0.01, 20, HALVES, True),
]


def lean(program, folder, h, tilt, shift, pointed):
    """Angle of the crack [deg]."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    notched_beam(folder / "beam.msh", h, tilt=tilt, shift=shift, pointed=pointed)
    gmsh.finalize()
    case = (HERE / "tilt-20-phase.toml").read_text()
    (folder / "case.toml").write_text(case.replace("../../meshes/notched-beam-plane/tilt-20.msh", "beam.msh"))
    subprocess.run([program, "run", folder / "case.toml", "-o", folder / "out", "--quiet", "--overwrite"], check=True)
    summary = json.loads((folder / "out/summary.json").read_text())
    return math.degrees(summary["probes"]["lean"]["final"])


def main(program):
    for name, h, tilt, along, pointed in SETS:
        with tempfile.TemporaryDirectory() as folder:
            shifts = [(u, v) for u in along for v in HALVES]
            found = [lean(program, pathlib.Path(folder), h, tilt, shift, pointed) for shift in shifts]
        angles = ", ".join(f"{angle:.1f}" for angle in found)
        print(f"{name}: {angles} deg; mean {sum(found) / len(found):.1f}", flush=True)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
