#!/usr/bin/env python3
"""Runs cases by equilibrium and by motion on one thread, and prints their times (docs/performance.md).

Needs the release build and the meshes: `cargo build --release`, `python3 meshes/make.py --large`. About ten minutes. Times are those of
the processor, which other work on the machine hardly changes.
"""

import json
import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("FRACTUM", ROOT / "target/release/fractum"))
ELASTIC = ["speed/56k-static", "speed/500k-static"]
# Compact first, then slender.
PAIRS = [
    ("brazilian-static/coarse", "brazilian-plane/coarse"),
    ("notched-beam/tilt-10-phase", "notched-beam/tilt-10-phase-explicit"),
]


def main():
    print("| elastic solution | elements | seconds | memory [MB] |")
    print("|---|---|---|---|")
    for case in ELASTIC:
        summary, seconds, memory = run(case)
        print(f"| {case} | {summary['counts']['elements']:,} | {seconds:.2f} | {memory:,.0f} |", flush=True)
    print()
    print("| case | solver | elements | steps | seconds | error |")
    print("|---|---|---|---|---|---|")
    for case in (case for pair in PAIRS for case in pair):
        summary, seconds, _ = run(case)
        expect, elements, steps = summary["expect"][0], summary["counts"]["elements"], summary["time"]["steps"]
        solver = "equilibrium" if "explicit" not in case and "brazilian-plane" not in case else "motion"
        print(f"| {case} | {solver} | {elements:,} | {steps:,} | {seconds:.1f} | {100 * expect['error']:+.1f} % |", flush=True)


def run(case):
    """Runs a case: its summary, the time of its process [s], its largest resident memory [MB]."""
    with tempfile.TemporaryDirectory() as folder:
        command = [PROGRAM, "run", ROOT / f"cases/{case}.toml", "--quiet", "--threads", 1, "-o", folder]
        child = os.posix_spawn(command[0], [str(word) for word in command], os.environ)
        _, status, usage = os.wait4(child, 0)
        if status != 0:
            sys.exit(f"{case}: failed; are the large meshes there? python3 meshes/make.py --large")
        summary = json.loads(pathlib.Path(folder, "summary.json").read_text())
    return summary, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


if __name__ == "__main__":
    main()
