#!/usr/bin/env python3
"""Draws the tables of this folder: `python3 docs/validation/curves/curves.py` writes an SVG beside each CSV file.

The first column is the abscissa. A column whose name ends in "source" is drawn as points, every other one as a line.
"""

import csv
from pathlib import Path

HERE = Path(__file__).resolve().parent
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 320, 60, 190, 20, 45
COLOURS = ["#1f5fa8", "#c04a1a", "#2f7d4f"]

# file: axes, and the limits and steps of both
CHARTS = {
    "elasticity": ("coordination", "Young's modulus, difference in %", (6, 13, 1), (-4, 4, 1)),
    "strength": ("coordination", "Brazilian strength, difference in %", (6, 13, 1), (-8, 8, 2)),
    "particle-size": ("particle diameters across the section", "strength, difference in %", (6, 20, 2), (0, 40, 10)),
}


def read(path):
    """Columns of a table by name: lists of (abscissa, value), without empty cells."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    header, *rows = csv.reader(lines)
    return {
        name: [(float(row[0]), float(row[k])) for row in rows if row[k]] for k, name in enumerate(header) if k > 0
    }


def line(x0, y0, x1, y1, colour):
    return f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{colour}"/>'


def text(x, y, words, extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" {extra}>{words}</text>'


def ticks(limits):
    low, high, step = limits
    return [low + step * k for k in range(round((high - low) / step) + 1)]


def frame(across, upwards, x_limits, y_limits, x_of, y_of):
    """Grid, numbers and names of the axes."""
    end, floor = WIDTH - RIGHT, HEIGHT - BOTTOM
    parts = []
    for x in ticks(x_limits):
        parts += [line(x_of(x), TOP, x_of(x), floor, "#e4e4e4"), text(x_of(x), floor + 16, x, 'text-anchor="middle"')]
    for y in ticks(y_limits):
        colour = "#999" if y == 0 else "#e4e4e4"
        parts += [line(LEFT, y_of(y), end, y_of(y), colour), text(LEFT - 6, y_of(y) + 4, y, 'text-anchor="end"')]
    middle = (TOP + floor) / 2
    parts.append(text((LEFT + end) / 2, HEIGHT - 8, across, 'text-anchor="middle"'))
    parts.append(text(16, middle, upwards, f'text-anchor="middle" transform="rotate(-90 16 {middle:.0f})"'))
    return parts


def draw(name, columns):
    across, upwards, x_limits, y_limits = CHARTS[name]

    def x_of(x):
        return LEFT + (x - x_limits[0]) / (x_limits[1] - x_limits[0]) * (WIDTH - RIGHT - LEFT)

    def y_of(y):
        return HEIGHT - BOTTOM - (y - y_limits[0]) / (y_limits[1] - y_limits[0]) * (HEIGHT - BOTTOM - TOP)

    parts = frame(across, upwards, x_limits, y_limits, x_of, y_of)
    subjects = list(dict.fromkeys(label.removesuffix(" source") for label in columns))
    for row, (label, points) in enumerate(columns.items()):
        colour = COLOURS[subjects.index(label.removesuffix(" source"))]
        place = [(x_of(x), y_of(y)) for x, y in points]
        key = (WIDTH - RIGHT + 14, TOP + 12 + 20 * row)
        if label.endswith("source"):
            dots = [*place, (key[0] + 12, key[1] - 4)]
            parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="none" stroke="{colour}"/>' for x, y in dots]
        else:
            path = " ".join(f"{x:.1f},{y:.1f}" for x, y in place)
            parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
            parts.append(line(key[0], key[1] - 4, key[0] + 24, key[1] - 4, colour))
        parts.append(text(key[0] + 32, key[1], label))
    style = 'font-family="sans-serif" font-size="12" fill="#222"'
    size = f'width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}"'
    body = "\n".join(['<rect width="100%" height="100%" fill="white"/>', *parts])
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {style}>\n{body}\n</svg>\n'


def main():
    for name in CHARTS:
        (HERE / f"{name}.svg").write_text(draw(name, read(HERE / f"{name}.csv")))


if __name__ == "__main__":
    main()
