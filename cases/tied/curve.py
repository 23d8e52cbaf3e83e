#!/usr/bin/env python3
"""Sends pulses of several lengths into the bonded region, and prints the table of README.md.

Needs the release build: `cargo build --release`.
"""

import json
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/fractum"
DIAMETER = 0.1009  # mean, of 3300 particles [mm]


def main():
    print("| particles per wavelength | pressure pulse | shear pulse |")
    print("|---|---|---|")
    for count in (6, 8, 10, 14, 20, 30, 40):
        reflected = [run(kind, count) for kind in ("p", "s")]
        print(f"| {count} | " + " | ".join(f"{100 * value:.3g} %" for value in reflected) + " |", flush=True)


def run(kind, count):
    """The part of the energy of a pulse that comes back."""
    with tempfile.TemporaryDirectory() as folder:
        case = ROOT / f"cases/tied/{kind}-pulse.toml"
        length = f"wavelength={count * DIAMETER} mm"
        subprocess.run([PROGRAM, "run", case, "--quiet", "--set", length, "-o", folder], check=True, capture_output=True)
        return json.loads(pathlib.Path(folder, "summary.json").read_text())["probes"]["reflected"]["final"]


if __name__ == "__main__":
    main()
