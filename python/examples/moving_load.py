"""A load that no case file knows: a force that travels along a beam.

python3 python/examples/moving_load.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

import fractum
from box_mesh import write_box

CASE = """fractum = 1
mesh = { file = "beam.msh" }
bodies = [{ name = "beam", kind = "solid", group = "body", material = "timber" }]
supports = [{ group = "x-", fix = "xyz" }, { group = "x+", fix = "xyz" }]
solver = { kind = "explicit", end = "4 ms" }
probes = [{ name = "middle", displacement = { where = "abs(x - 50 cm) < 3 cm", along = "z" } }]
output = { history = { every = "0.1 ms" } }
[materials.timber]
density = "500 kg/m^3"
young_modulus = "10 GPa"
poisson_ratio = 0.3
"""

SPEED = 250.0  # m/s
FORCE = 1000.0  # N
WIDTH = 0.05  # m


def travelling(time, position, velocity):
    """The force, spread over the nodes of the upper side around its present place."""
    weight = np.exp(-(((position[:, 0] - SPEED * time) / WIDTH) ** 2))
    forces = np.zeros_like(position)
    forces[:, 2] = -FORCE * weight / weight.sum()
    return forces


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    write_box(folder / "beam.msh", cells=(20, 2, 2), size=(1.0, 0.1, 0.1))
    (folder / "case.toml").write_text(CASE)
    with fractum.Simulation(folder / "case.toml", output=folder / "results", threads=1, overwrite=True) as simulation:
        simulation.add_load(travelling, group="z+")
        simulation.run()
    history = simulation.results.history
    deepest = int(np.argmin(history["middle"]))
    print(f"deepest at t = {history['time'][deepest]:.2e} s: {history['middle'][deepest]:.3e} m")
    print(f"energy balance: {simulation.results.summary['energy']['residual_max_relative']:.1e}")
    return simulation.results


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/python/moving-load"))
