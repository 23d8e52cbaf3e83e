"""Thrusts of all lines of thrust within a half circle of voussoirs under its own weight, by its thickness (limit analysis, Heyman 1969).

python3 cases/interfaces/arch.py
"""

from math import cos, pi, sin

RADIUS, VOUSSOIRS, WEIGHT = 10.0, 27, 2400 * 9.81


def thrusts(thickness):
    """The smallest and the largest thrust per width [N/m], to 100 N/m; none where the arch falls."""
    inner, outer = RADIUS - thickness / 2, RADIUS + thickness / 2
    joints = [pi * joint / VOUSSOIRS for joint in range(VOUSSOIRS // 2, -1, -1)]

    def load(angle):
        """Weight from the crown to a joint, and its moment about the crown."""
        return WEIGHT * (outer**2 - inner**2) / 2 * (pi / 2 - angle), WEIGHT * (outer**3 - inner**3) / 3 * (1 - sin(angle))

    def stands(thrust):
        # The line cuts a joint at r (W cos + H sin) = H y + M, with its height y at the crown.
        low, high = [], []
        for angle in joints:
            weight, moment = load(angle)
            across = weight * cos(angle) + thrust * sin(angle)
            low.append((inner * across - moment) / thrust)
            high.append((outer * across - moment) / thrust)
        return max(low) <= min(high)

    found = [thrust for thrust in range(100_000, 250_000, 100) if stands(thrust)]
    return (found[0], found[-1]) if found else None


if __name__ == "__main__":
    for ratio in (0.105, 0.107, 0.1075, 0.108, 0.112, 0.13):
        between = thrusts(ratio * RADIUS)
        print(f"{ratio:.4f} of the radius:", "{} to {} N/m".format(*between) if between else "falls")
