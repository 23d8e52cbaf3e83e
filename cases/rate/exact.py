#!/usr/bin/env python3
"""Spall of the bars of this folder in one dimension: where tension first reaches the strength of its rate, and that strength.

A half sine of pressure runs along the bar and comes back from its free end as tension. The stress at the distance d from that end is the sum of both waves; every
place watches its own rate as the program does (docs/theory/damage.md), and the one that reaches its strength first parts. Prints place, rate, factor on the strength, and the speed
of the piece, which takes the momentum of what is trapped in it.
"""
import math
import sys

E, RHO, STRENGTH, DURATION = 30e9, 2400.0, 4e6, 60e-6
C = math.sqrt(E / RHO)


def fib(rate):
    """fib Model Code 2010 in tension, up to 300 per second."""
    relative = min(max(rate, 1e-6), 300.0) / 1e-6
    return max(relative**0.018, 0.0062 * relative ** (1 / 3))


def pulse(peak, t):
    return peak * math.sin(math.pi * t / DURATION) if 0 < t < DURATION else 0.0


def stress(peak, d, t):
    """Tension at the distance d from the free end, t after the pulse has reached this end."""
    return pulse(peak, t - d / C) - pulse(peak, t + d / C)


def onset(peak, d, dt=2e-8):
    """Time, rate and factor with which the place d begins to part; none if it does not."""
    since = None
    t = 0.0
    while t < DURATION + 4 * d / C:
        q = stress(peak, d, t)
        if q > 0.5 * STRENGTH:
            if since is None:
                since, low = (t, q), q
            low = min(low, q)
            rate = 0.0 if q <= low + 0.05 * STRENGTH else (q - since[1]) / (t - since[0]) / E
            if q <= low + 0.05 * STRENGTH:
                since = (t, q)
            if q > fib(rate) * STRENGTH:
                return t, rate, fib(rate)
        else:
            since = None
        t += dt
    return None


def first(peak):
    """The place that parts first: distance from the free end [m], time [s], rate [1/s], factor."""
    best = None
    for d in (0.5e-3 * k for k in range(4, 300)):
        found = onset(peak, d)
        if found and (best is None or found[0] < best[1]):
            best = (d, *found)
    return best


def speed(peak, d, t, steps=4000):
    """Mean velocity of the piece beyond d at the instant of parting [m/s]."""
    total = 0.0
    for k in range(steps):
        x = d * (k + 0.5) / steps
        total += pulse(peak, t - x / C) + pulse(peak, t + x / C)
    return total / steps / (RHO * C)


if __name__ == "__main__":
    peaks = [float(peak) for peak in sys.argv[1:]] or [10e6, 14e6, 20e6, 30e6]
    print("peak [MPa]  place [mm]  rate [1/s]  factor  strength [MPa]  speed at parting [m/s]")
    for peak in peaks:
        found = first(peak)
        if found is None:
            print(f"{peak / 1e6:10.1f}  does not part")
            continue
        d, t, rate, factor = found
        print(f"{peak / 1e6:10.1f} {d * 1e3:11.1f} {rate:11.1f} {factor:7.3f} {factor * STRENGTH / 1e6:15.2f} {speed(peak, d, t):14.3f}")
