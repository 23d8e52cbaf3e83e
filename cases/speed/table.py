#!/usr/bin/env python3
"""Runs the cubes on one thread and on two, and prints time and memory, of which docs/performance.md has the range.

Needs the release build and the meshes: `cargo build --release`, `python3 meshes/make.py --large`.
"""

import json
import os
import pathlib
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target/release/fractum"


def main():
    print("| tetrahedra | elements | threads | ns per tetrahedron and step | set up [s] | memory [MB] |")
    print("|---|---|---|---|---|---|")
    for mesh in ("56k", "500k", "2M"):
        for kind in ("plain", "armed"):
            for threads in (1, 2):
                print(row(mesh, kind, threads), flush=True)


def row(mesh, kind, threads):
    with tempfile.TemporaryDirectory() as folder:
        case = ROOT / f"cases/speed/{mesh}-{kind}.toml"
        memory = run([PROGRAM, "run", case, "--quiet", "--threads", threads, "-o", folder])
        summary = json.loads(pathlib.Path(folder, "summary.json").read_text())
    elements, steps, wall = summary["counts"]["elements"], summary["time"]["steps"], summary["wall"]
    loop = sum(seconds for name, seconds in wall["phases"].items() if name != "output")
    set_up = wall["total"] - sum(wall["phases"].values())
    return f"| {elements:,} | {kind} | {threads} | {1e9 * loop / elements / steps:.1f} | {set_up:.1f} | {memory:,.0f} |"


def run(command):
    """Runs a command to its end; its largest resident memory in MB."""
    child = os.posix_spawn(command[0], [str(word) for word in command], os.environ)
    _, status, usage = os.wait4(child, 0)
    if status != 0:
        raise SystemExit(f"{command[2]}: failed; are the large meshes there? python3 meshes/make.py --large")
    return usage.ru_maxrss / 1024


if __name__ == "__main__":
    main()
