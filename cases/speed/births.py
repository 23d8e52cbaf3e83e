#!/usr/bin/env python3
"""Runs cubes that fly apart into discrete elements on one thread, and prints what births and removals cost (docs/performance.md).

Needs the release build and the meshes: `cargo build --release`, `python3 meshes/make.py --large large/56k large/500k`.
"""

import json
import pathlib
import re
import subprocess
import tempfile

from table import PROGRAM, ROOT, run

CASE = ROOT / "cases/speed/births.toml"


def main():
    print("| nodes | born | elements removed | steps | removal [us per element] | contact [us per birth] | memory [MB] | by `check` [MB] |")
    print("|---|---|---|---|---|---|---|---|")
    for mesh in ("56k", "500k"):
        print(row(f'mesh.file="../../meshes/large/{mesh}.msh"'), flush=True)


def row(mesh):
    with tempfile.TemporaryDirectory() as folder:
        memory = run([PROGRAM, "run", CASE, "--quiet", "--threads", 1, "-o", folder, "--set", mesh])
        summary = json.loads(pathlib.Path(folder, "summary.json").read_text())
    check = subprocess.run([PROGRAM, "check", CASE, "--set", mesh], check=True, capture_output=True, text=True)
    said = re.search(r"memory ([\d,]+) MB", check.stdout + check.stderr).group(1)
    counts, phases = summary["counts"], summary["wall"]["phases"]
    born, removed = counts["particles"], counts["removed_elements"]
    removal, contact = 1e6 * phases["transition"] / removed, 1e6 * phases["contact"] / born
    steps = summary["time"]["steps"]
    return f"| {counts['nodes']:,} | {born:,} | {removed:,} | {steps} | {removal:.1f} | {contact:.0f} | {memory:.0f} | {said} |"


if __name__ == "__main__":
    main()
