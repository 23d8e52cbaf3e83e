"""A condition that ends a run: a bar is pulled until a tenth of its elements has damage above one half.

python3 python/examples/stop_at_crack.py [FOLDER]
"""

import sys
from pathlib import Path

import fractum
from box_mesh import write_box

CASE = """fractum = 1
mesh = { file = "bar.msh" }
bodies = [{ name = "bar", kind = "solid", group = "body", material = "concrete" }]
supports = [
    { group = "x-", velocity = { x = { ramp = [["0 s", "0 m/s"], ["0.1 ms", "-0.2 m/s"]] } } },
    { group = "x+", velocity = { x = { ramp = [["0 s", "0 m/s"], ["0.1 ms", "0.2 m/s"]] } } },
]
solver = { kind = "explicit", end = "2 ms" }
probes = [{ name = "load", reaction = { group = "x+", along = "x" } }]
output = { history = { every = "5 us" }, fields = { every = "0.1 ms" } }
[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
tensile_strength = "strength"
fracture_energy = "100 J/m^2"
[parameters]
strength = "3 MPa"
"""


def write_case(folder):
    """The mesh and the case, which other recipes use too."""
    folder.mkdir(parents=True, exist_ok=True)
    write_box(folder / "bar.msh", cells=(10, 3, 3), size=(0.4, 0.1, 0.1))
    (folder / "case.toml").write_text(CASE)
    return folder / "case.toml"


def is_cracked(simulation):
    """Whether a tenth of the elements has damage above one half."""
    return (simulation.bodies["bar"].damage > 0.5).mean() > 0.1


def main(folder):
    with fractum.Simulation(write_case(folder), output=folder / "results", threads=1, overwrite=True) as simulation:
        simulation.run(stop=is_cracked, every=20)
        print(f"ended at t = {simulation.time:.3e} s after {simulation.steps} steps: {simulation.counts}")
    _, load = simulation.results.history["time"], simulation.results.history["load"]
    print(f"largest load: {max(load):.4g} N")
    return simulation.results


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/python/stop-at-crack"))
