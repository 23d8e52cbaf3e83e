"""A table of runs: the largest load of a bar for three strengths and two safety factors of the time step.

python3 python/examples/sweep_strength.py [FOLDER]
"""

import sys
from pathlib import Path

import fractum
from stop_at_crack import write_case


def main(folder):
    case = write_case(folder)
    vary = {"strength": ["2 MPa", "3 MPa", "4 MPa"], "solver.safety": [0.5, 0.9]}
    settings = {"set": {"solver.end": "0.4 ms"}, "output": folder / "runs", "overwrite": True}
    table = fractum.study(case, vary, workers=2, compare=["peak = max(load)"], **settings)
    for strength, safety, peak in zip(table["strength"], table["solver.safety"], table["peak"]):
        print(f"{strength}, safety {safety}: largest load {peak:.4g} N")
    return table


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/python/sweep-strength"))
