"""A cylinder of 100 x 100 mm about z with a ring-shaped notch in each end face, as an ASCII STL file in millimetres: `python3 specimen.py`."""

from math import cos, pi, sin
from pathlib import Path

RADIUS, HEIGHT, INNER, OUTER, DEPTH, AROUND = 50, 100, 23, 27, 22, 48

LOW = [(0, 0), (INNER, 0), (INNER, DEPTH), (OUTER, DEPTH), (OUTER, 0), (RADIUS, 0)]
PROFILE = LOW + [(radius, HEIGHT - height) for radius, height in reversed(LOW)]


def place(point, step):
    (radius, height), angle = point, 2 * pi * (step % AROUND) / AROUND
    return f"{radius * cos(angle):.6f} {radius * sin(angle):.6f} {height}" if radius else f"0 0 {height}"


def triangles():
    for low, high in zip(PROFILE, PROFILE[1:]):
        for step in range(AROUND):
            a, b = place(low, step), place(low, step + 1)
            c, d = place(high, step + 1), place(high, step)
            if low[0]:
                yield a, b, c
            if high[0]:
                yield a, c, d


def main():
    lines = ["solid specimen"]
    for corners in triangles():
        lines += [" facet normal 0 0 0", "  outer loop"]
        lines += [f"   vertex {corner}" for corner in corners]
        lines += ["  endloop", " endfacet"]
    lines += ["endsolid specimen", ""]
    Path(__file__).with_name("specimen.stl").write_text("\n".join(lines))


if __name__ == "__main__":
    main()
