#!/usr/bin/env python3
"""Spall of the bar of this folder in one dimension, exact but for the smoothing of the pulse.

Waves go one cell per step, so that they neither spread nor disperse; between cells stand cohesive planes with the
exponential softening of the cases. The bulk viscosity b of a mesh of size l rounds the pulse on its way as a Gaussian of
variance b l c t would (Kelvin's solid). Prints place and speed of the piece over those of the brittle bar without
viscosity, d = c (T - rise) ft/(2 s0) and v = (2 s0 - ft)/(rho c).
"""
import math

E, RHO, STRENGTH, PEAK, DURATION, RISE, LENGTH = 30e9, 2400.0, 4e6, 12e6, 60e-6, 2e-6, 0.4
ARMED = 0.25  # damage beyond this place [m]
C = math.sqrt(E / RHO)
Z = RHO * C
PLACE = C * (DURATION - RISE) * STRENGTH / (2 * PEAK)
SPEED = (2 * PEAK - STRENGTH) / Z


def pulse(t):
    """Pressure on the struck end [Pa]."""
    if not 0 < t < DURATION:
        return 0.0
    return PEAK * t / RISE if t < RISE else PEAK * (DURATION - t) / (DURATION - RISE)


def rounded(viscosity, size, dt):
    """The pulse as it reaches the place of the spall, in steps of dt, some steps late."""
    late = 0
    if viscosity > 0:
        width = math.sqrt(viscosity * size * (LENGTH + PLACE)) / C
        late = int(4 * width / dt) + 1
        kernel = [math.exp(-0.5 * (k * dt / width) ** 2) for k in range(-late, late + 1)]
    else:
        kernel = [1.0]
    total = sum(kernel)
    steps = int(DURATION / dt) + 2 * late + 2
    middle = len(kernel) // 2
    return [sum(w * pulse((n + 0.5 - late + k - middle) * dt) for k, w in enumerate(kernel)) / total for n in range(steps)]


def law(opening, largest, energy):
    """Stress of a cohesive plane; it unloads towards the origin."""
    if opening >= largest:
        return STRENGTH * math.exp(-STRENGTH * opening / energy)
    return STRENGTH * math.exp(-STRENGTH * largest / energy) * opening / largest


def open_plane(stress, opening, largest, energy, rate):
    """Stress and opening of a plane after a step in which it would have borne `stress` unbroken."""
    if opening + rate * stress <= 0:
        return stress + opening / rate, 0.0
    low, high = 0.0, opening + rate * max(stress, 0.0) + 1e-12
    for _ in range(60):
        middle = 0.5 * (low + high)
        if middle - opening > rate * (stress - law(middle, largest, energy)):
            high = middle
        else:
            low = middle
    return law(low, largest, energy), low


def spall(energy, viscosity, size, cell=0.5e-3, end=150e-6):
    """Place [m] and speed [m/s] of the piece at the free end, and the energy dissipated over Gf."""
    cells, dt = round(LENGTH / cell), cell / C
    pressure = rounded(viscosity, size, dt)
    right, left = [0.0] * cells, [0.0] * cells
    opening, largest = [0.0] * cells, [0.0] * cells
    for step in range(int(end / dt)):
        new_right, new_left = [0.0] * cells, [0.0] * cells
        new_right[0] = -(pressure[step] if step < len(pressure) else 0.0) - left[0]
        new_left[-1] = -right[-1]
        for i in range(cells - 1):
            stress = right[i] + left[i + 1]
            if (i + 1) * cell > ARMED and (opening[i] > 0 or stress > STRENGTH):
                stress, opening[i] = open_plane(stress, opening[i], largest[i], energy, 2 * dt / Z)
                largest[i] = max(largest[i], opening[i])
            new_right[i + 1], new_left[i] = stress - left[i + 1], stress - right[i]
        right, left = new_right, new_left
    ratio = [math.exp(-STRENGTH * w / energy) for w in largest]
    last = max(i for i in range(cells) if ratio[i] < 0.02)
    piece = [(left[i] - right[i]) / Z for i in range(last + 1, cells)]
    spent = sum(1 - r * (1 - math.log(r)) for r in ratio)
    return LENGTH - (last + 1) * cell, sum(piece) / len(piece), spent


if __name__ == "__main__":
    print(f"brittle: place {PLACE * 1e3:.2f} mm, speed {SPEED:.4f} m/s")
    print("Gf [J/m2]  viscosity  size [mm]   place [mm]          speed [m/s]         dissipated/Gf")
    for energy, viscosity, size in [
        (0.1, 0, 0), (0.3, 0, 0), (0.6, 0, 0), (1.2, 0, 0),
        (0.3, 0.03, 0.5e-3), (0.3, 0.06, 0.5e-3), (0.3, 0.12, 0.5e-3), (0.6, 0.06, 0.5e-3), (1.2, 0.06, 0.5e-3),
        (0.3, 0.06, 0.35e-3),
    ]:
        place, speed, spent = spall(energy, viscosity, size)
        print(
            f"{energy:9} {viscosity:10} {size * 1e3:10.2f}   {place * 1e3:6.2f} ({100 * (place / PLACE - 1):+5.1f} %)   "
            f"{speed:.4f} ({100 * (speed / SPEED - 1):+5.2f} %)   {spent:5.1f}"
        )
