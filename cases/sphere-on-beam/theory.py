#!/usr/bin/env python3
"""Hertz' contact of a sphere with odd modes of a simply supported beam: `python3 theory.py [MODES]`.

Prints contacts of both cases for a beam of Euler and Bernoulli, which the references of the cases are, and for one of Timoshenko,
which shears and whose sections have inertia, as a body of finite elements does. Each mode is w = q sin(n pi x/L), and with shear a
rotation p cos(n pi x/L); velocity Verlet.
"""

import sys
from math import pi, sqrt

E, NU, RHO, SIDE, SPEED = 215.82e9, 0.289, 7960.0, 0.01, 0.01


def contacts(span, radius, end, shear, modes, dt=5e-8):
    area, second = SIDE**2, SIDE**4 / 12
    stiffness = 5 / 6 * E / (2 * (1 + NU)) * area
    mass = RHO * 4 / 3 * pi * radius**3
    hertz = 4 / 3 * E / (2 * (1 - NU**2)) * sqrt(radius)
    waves = [(2 * k + 1) * pi / span for k in range(modes)]
    sign = [(-1) ** k for k in range(modes)]
    q, v = [0.0] * modes, [0.0] * modes
    p, r = [0.0] * modes, [0.0] * modes
    z, speed = 0.0, SPEED
    found, force, time = [], 0.0, 0.0
    top = 2 / (RHO * area * span)
    while time < end:
        for k, wave in enumerate(waves):
            if shear:
                slope = wave * q[k] - p[k]
                a = sign[k] * force * top - stiffness * wave * slope / (RHO * area)
                b = (stiffness * slope - E * second * wave**2 * p[k]) / (RHO * second)
                r[k] += dt * b
                p[k] += dt * r[k]
            else:
                a = sign[k] * force * top - E * second * wave**4 / (RHO * area) * q[k]
            v[k] += dt * a
            q[k] += dt * v[k]
        speed -= dt * force / mass
        z += dt * speed
        time += dt
        overlap = z - sum(s * x for s, x in zip(sign, q))
        force = hertz * overlap**1.5 if overlap > 0 else 0.0
        if force > 0:
            if not found or found[-1]["open"]:
                found.append({"start": time, "end": 0, "peak": 0, "at": 0, "impulse": 0, "open": False})
            last = found[-1]
            last["end"], last["impulse"] = time, last["impulse"] + force * dt
            if force > last["peak"]:
                last["peak"], last["at"] = force, time
        elif found:
            found[-1]["open"] = True
    return found, speed


for case, span, radius, end in [(1, 0.1535, 0.01, 0.3e-3), (2, 0.307, 0.02, 3.4e-3)]:
    for beam, shear in [("Euler-Bernoulli", False), ("Timoshenko", True)]:
        modes = int(sys.argv[1]) if len(sys.argv) > 1 else 30
        # Euler-Bernoulli's frequencies grow with the square of the wave number: the step follows them.
        wave = (2 * modes - 1) * pi / span
        fastest = sqrt(E / RHO) * (SIDE / sqrt(12) * wave**2 if not shear else sqrt(12) / SIDE + wave)
        found, speed = contacts(span, radius, end, shear, modes, min(1e-7, 0.5 / fastest))
        print(f"case {case}, {beam}: sphere leaves at {-speed * 1e3:.3f} mm/s")
        for one in found:
            print(
                f"  {one['start'] * 1e6:7.1f} to {one['end'] * 1e6:7.1f} us, peak {one['peak']:.3f} N at {one['at'] * 1e6:.1f} us,"
                f" impulse {one['impulse']:.4e} N s"
            )
