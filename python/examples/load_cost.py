"""What a load written in Python costs: 50,400 tetrahedra pulled at one side, by the case and by a function.

The simulations with and without the function take turns every few steps, each on one thread. Printed is the median over
the turns of the ratio of processor times. On all nodes a second function returns forces that it has ready: what is left is the
call itself, which hands positions and velocities over and takes forces back.

python3 python/examples/load_cost.py [FOLDER]
"""

import sys
import time
from pathlib import Path
from statistics import median

import numpy as np

import fractum
from box_mesh import write_box

CASE = """fractum = 1
mesh = { file = "box.msh" }
bodies = [{ name = "box", kind = "solid", group = "body", material = "rock", formulation = "FORMULATION" }]
supports = [{ group = "x-", fix = "xyz" }]
solver = { kind = "explicit", end = "10 ms" }
output = { history = { every = "1 ms" }, fields = { every = "10 ms" } }
[materials.rock]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
"""
PULL = 'loads = [{ group = "x+", force = { x = "1 kN" } }]\n'


def seconds(simulation, steps):
    """Processor time of some steps, of all threads."""
    start = time.process_time()
    simulation.step(steps)
    return time.process_time() - start


def on_side(simulation):
    """The force of the case, on the nodes of the side."""
    share = np.array([1000.0 / len(simulation.group("x+")), 0.0, 0.0])
    simulation.add_load(lambda time, position, velocity: share, group="x+")


def on_all(simulation):
    """Gravity and air resistance on every node, from positions and velocities."""
    mass = simulation.nodes.mass[:, None]
    gravity = np.array([0.0, 0.0, -9.81])
    function = lambda time, position, velocity: mass * (gravity - 0.1 * velocity)
    simulation.add_load(function, nodes=np.arange(len(mass)))


def call_alone(simulation):
    """The same call, with positions and velocities, whose forces cost no arithmetic."""
    nodes = np.arange(len(simulation.nodes.mass))
    forces = np.zeros((len(nodes), 3))
    simulation.add_load(lambda time, position, velocity: forces, nodes=nodes)


def main(folder, cells=(21, 20, 20), steps=10, rounds=60):
    folder.mkdir(parents=True, exist_ok=True)
    write_box(folder / "box.msh", cells, size=(1.05, 1.0, 1.0))
    found = {}
    for formulation in ("standard", "smoothed"):
        text = CASE.replace("FORMULATION", formulation)
        (folder / "case.toml").write_text(text.replace("[materials", PULL + "[materials"))
        (folder / "bare.toml").write_text(text)
        ways = {"case": ("case", None), "side": ("bare", on_side), "all nodes": ("bare", on_all), "all nodes, call alone": ("bare", call_alone)}
        runs = {}
        for way, (name, add) in ways.items():
            runs[way] = fractum.Simulation(folder / f"{name}.toml", output=folder / "results" / way, threads=1, overwrite=True)
            if add is not None:
                add(runs[way])
        turns = [{way: seconds(run, steps) for way, run in runs.items()} for _ in range(rounds)]
        own = median(turn["case"] for turn in turns) / steps
        for way in list(ways)[1:]:
            cost = median(turn[way] / turn["case"] for turn in turns) - 1.0
            found[formulation, way] = cost
            print(f"{formulation}, function on {way}: {100 * cost:+.1f} % of {1e3 * own:.2f} ms")
    return found


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/python/load-cost"))
