#!/usr/bin/env python3
"""Runs a cube of 511,104 smoothed tetrahedra by one process with two threads and by two processes with one thread each, in turn, and prints
the least time of their steps without output, the ratio, and what is sent; then the largest memory of each of 1, 2 and 4 processes.

Needs numpy, MPI and a build with it: `cargo build --release --features mpi --target-dir target/mpi`, then
`python3 cases/speed/ranks.py target/mpi/release/fractum`. With `particles` behind it the times alone, of a cube of 100,000 bonded particles that
vibrates, of the same that is torn, and of 91,125 loose beads that fall into a box. With `parts` the memory alone, of a cube of 3,072,000 tetrahedra (or
of six times the cube of a number behind it) whose mesh is in one file and in four; with `core` or `breaking` of the same, a tenth or all of which may break.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from table import ROOT

sys.path.append(str(ROOT / "python/examples"))
from box_mesh import write_box

CASE = """fractum = 1
mesh = { file = "cube.msh" }
bodies = [{ name = "cube", kind = "solid", group = "body", material = "rock", formulation = "smoothed" }]
supports = [{ group = "x-", fix = "xyz" }]
loads = [{ group = "x+", force = { x = "1 kN" } }]
solver = { kind = "explicit", end = "0.25 ms" }
output = { history = { every = "0.05 ms" }, fields = { every = "0.25 ms" } }
[materials.rock]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
"""
# A tenth of the cube may break, and is a body of its own.
CORE = CASE.replace(
    "bodies = [",
    'bodies = [{ name = "core", kind = "solid", group = "core", material = "weak", formulation = "smoothed" }, ',
)
DAMAGE = 'damage = { tensile_strength = "3 MPa", fracture_energy = "100 J/m^2" }\n'
CORE += """[materials.weak]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
""" + DAMAGE
# All of it may break.
BREAKING = CASE + DAMAGE
BONDED = """fractum = 1
bodies = [{ name = "cube", kind = "bonded", material = "glass", shape = "box", size = ["2 mm", "2 mm", "2 mm"], particles = 100000, coordination = 10, seed = 3,
  initial_velocity = { x = "rate*x/side", y = "-nu*rate*(y/side - 0.5)", z = "-nu*rate*(z/side - 0.5)" } }]
supports = [{ group = "cube.x-", fix = "x" }, { group = "cube.x+", velocity = { x = "rate" } }]
solver = { kind = "explicit", end = "0.86 us" }
output = { history = { every = "43 ns" }, fields = { every = "0.86 us" } }
[parameters]
side = "2 mm"
nu = 0.23
rate = "1.86 m/s"
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = "nu"
"""
STRENGTH = """
[materials.glass.fracture]
tensile_strength = "50 MPa"
"""
LOOSE = """fractum = 1
loads = [{ gravity = { z = "-9.81 m/s^2" } }]
solver = { kind = "explicit", end = "20 ms" }
output = { history = { every = "1 ms" }, fields = { every = "20 ms" } }
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "10 MPa"
poisson_ratio = 0.22
contact = { friction = 0.4, rolling_friction = 0.02, restitution = 0.5 }
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
shape = "box"
point = ["-60 mm", "-60 mm", "2 mm"]
size = ["120 mm", "120 mm", "120 mm"]
particle_radius = "1.1 mm"
dispersion = 0.2
[[bodies]]
name = "walls"
kind = "rigid"
shape = "box"
inside = true
point = ["-60 mm", "-60 mm", "0 mm"]
size = ["120 mm", "120 mm", "300 mm"]
contact = { friction = 0.4, rolling_friction = 0.02, restitution = 0.5 }
"""
MPIRUN = ["mpirun", "--oversubscribe", *(["--allow-run-as-root"] if os.geteuid() == 0 else []), "-n"]


def main(program, cells=44):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write_box(folder / "cube.msh", (cells,) * 3, (1.0,) * 3)
        compare(program, folder, CASE)
        memory = {count: peaks(program, folder, count) for count in (1, 2, 4)}
    for count, each in memory.items():
        print(f"{count} of one thread: {', '.join(f'{megabytes:.0f}' for megabytes in each)} MB")


def parts(program, case, cells=80):
    core = round(cells / 10 ** (1 / 3)) if case == CORE else 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for where, count in (("one file", None), ("four files", 4)):
            write_box(folder / "cube.msh", (cells,) * 3, (1.0,) * 3, count, core)
            mesh = 'mesh = { file = "cube.msh" }'
            in_files = mesh if count is None else mesh.replace(" }", f", parts = {count} }}")
            (folder / "case.toml").write_text(case.replace(mesh, in_files).replace("0.25 ms", "20 us").replace("0.05 ms", "10 us"))
            for processes in (1, 4, 8):
                each = peaks(program, folder, processes)
                state = json.loads((folder / "memory/summary.json").read_text())["state_hash"]
                print(f"{where}, {processes} of one thread: {', '.join(f'{megabytes:.0f}' for megabytes in each)} MB; state {state[:8]}")


def particles(program):
    for what, case in (("the cube vibrates", BONDED), ("the cube is torn", BONDED + STRENGTH), ("beads fall into a box", LOOSE)):
        with tempfile.TemporaryDirectory() as folder:
            print(what)
            compare(program, pathlib.Path(folder), case)


def compare(program, folder, case, rounds=5):
    """Runs a case by one process with two threads and by two processes in turn, and prints times, ratio and what is sent."""
    ways = {"one process, two threads": ([], 2), "two processes, one thread each": ([*MPIRUN, "2"], 1)}
    times = {way: [] for way in ways}
    (folder / "case.toml").write_text(case)
    hashes = set()
    for _ in range(rounds):
        for way, (start, threads) in ways.items():
            results = folder / "results"
            command = [*start, program, "run", folder / "case.toml", "-o", results, "--overwrite", "--quiet", "--threads", threads]
            subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
            summary = json.loads((results / "summary.json").read_text())
            phases = summary["wall"]["phases"]
            times[way].append(sum(phases.values()) - phases["output"])
            hashes.add(summary["state_hash"])
    steps = summary["time"]["steps"]
    for way, all_times in times.items():
        print(f"{way}: {1e3 * min(all_times) / steps:.1f} ms a step, least of {rounds} runs of {steps} steps")
    alone, shared = (min(all_times) for all_times in times.values())
    print(f"ratio {shared / alone:.2f}; states {'alike' if len(hashes) == 1 else 'DIFFERENT'}; {summary['counts']['broken_bonds']} bonds broken")
    log = (results / "run.log").read_text()
    print(next(line for line in log.splitlines() if "process 0 of 2" in line))


def peaks(program, folder, count):
    """Largest resident memory of each of several processes that run the case of a folder, the first of which writes frames [MB]."""
    alone = "import sys; from table import run; print(f'peak {run(sys.argv[1:])}')"
    command = [*MPIRUN, count, sys.executable, "-c", alone, program, "run", folder / "case.toml", "-o", folder / "memory", "--overwrite", "--quiet",
               "--threads", 1]
    here = pathlib.Path(__file__).parent
    out = subprocess.run([str(part) for part in command], cwd=here, check=True, capture_output=True, text=True).stdout
    # Lines of several processes may run into each other.
    return sorted(map(float, re.findall(r"peak (\d+\.\d+)", out)), reverse=True)


if __name__ == "__main__":
    program, what = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
    in_parts = {"parts": CASE, "core": CORE, "breaking": BREAKING}
    if what and what[0] in in_parts:
        parts(program, in_parts[what[0]], *map(int, what[1:]))
    else:
        (particles if "particles" in what else main)(program)
