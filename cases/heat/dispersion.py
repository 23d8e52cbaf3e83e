#!/usr/bin/env python3
"""Heats five sheets of bonded particles of each number, and prints how far their temperatures lie apart (docs/validation/heat-2015.md).

Jebahi et al. (2015), eq. 3.15: the mean over the run of (largest - smallest)/largest of the five temperatures [deg C] at a point, here of the
particles within a mean diameter of it. Packings are used also where they miss their certificate, as in the source. Needs the release build: `cargo build --release`.
"""

import csv
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).parents[2]
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/fractum"
CASE = ROOT / "cases/heat/sheet-bonded.toml"
PACKINGS = range(1, 6)
PARAMETERS = 'particles = 20000\nthickness = "6 mm"\n'
SHAPE = 'shape = "box"\nsize = ["50 mm", "30 mm", "thickness"]\nparticles = "particles"\n'


def main():
    print("| particles | A | B | C |")
    print("|---|---|---|---|")
    for count in (1000, 5000, 20000):
        with tempfile.TemporaryDirectory() as folder:
            runs = [temperatures(pathlib.Path(folder), count, seed) for seed in PACKINGS]
        dispersions = (dispersion([run[point] for run in runs]) for point in "ABC")
        print(f"| {count:,} | " + " | ".join(f"{100 * e:.1f} %" for e in dispersions) + " |", flush=True)


def temperatures(folder, count, seed):
    """Temperatures [deg C] of the points over time."""
    packing = folder / f"packing-{seed}"
    shape = ["--box", "50 mm, 30 mm, 6 mm", "--count", str(count), "--seed", str(seed), "--keep"]
    subprocess.run([PROGRAM, "pack", *shape, "-o", packing], capture_output=True)
    text = CASE.read_text()
    assert PARAMETERS in text and SHAPE in text and text.count("< 1 mm") == 3
    diameter = (6 * 0.58 * 9000 / (math.pi * count)) ** (1 / 3)
    case = folder / "sheet.toml"
    text = text.replace(PARAMETERS, "").replace("< 1 mm", f"< {diameter:.2f} mm")
    case.write_text(text.replace(SHAPE, f'packing = "{packing.name}/packing.fpk"\n'))
    results = folder / "results"
    subprocess.run([PROGRAM, "run", case, "--quiet", "--overwrite", "-o", results], check=True)
    with open(results / "history.csv") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    columns = {name: next(key for key in rows[0] if key.split(" ")[0] == name) for name in "ABC"}
    return {name: [float(row[key]) - 273.15 for row in rows] for name, key in columns.items()}


def dispersion(runs):
    instants = list(zip(*runs))
    return sum((max(now) - min(now)) / max(now) for now in instants) / len(instants)


if __name__ == "__main__":
    main()
