"""What a results folder holds: curves, energies, fields of a time, fragments.

python3 python/examples/read_results.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

import fractum
from stop_at_crack import write_case


def main(folder):
    results = fractum.run(write_case(folder), set={"solver.end": "1 ms"}, output=folder / "results", threads=1, overwrite=True)

    history = results.history
    peak = int(np.argmax(history["load"]))
    print(f"{results.summary['status']}; peak {history['load'][peak]:.4g} {results.units['load']}", end=" ")
    print(f"at t = {history['time'][peak]:.3e} s; damage has taken {results.summary['energy']['damage']:.3g} J")

    solid = results.fields()["solid"]  # the last frame; fields(time) takes another
    kind, elements = solid.cells[0]
    middle = solid.points[elements].mean(axis=1)
    damaged = middle[solid.cell_data["damage"] > 0.5, 0]
    print(f"frame at t = {solid.time:.3e} s: {len(elements)} {kind}, {len(damaged)} with damage above one half")
    moved = solid.points + solid.point_data["displacement"]
    print(f"length: {np.ptp(moved[:, 0]):.5f} m; crack at x = {damaged.mean():.3f} m" if len(damaged) else "no crack")

    for piece in range(len(results.fragments["mass"])):
        print(f"fragment of {results.fragments['mass'][piece]:.3f} kg at x = {results.fragments['x'][piece]:.3f} m")
    return results


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/python/read-results"))
