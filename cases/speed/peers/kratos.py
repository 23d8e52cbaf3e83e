"""The three jobs of solids in Kratos: kratos.py JOB MESH, after the cases that each function names."""

import json
import sys

import KratosMultiphysics as KM
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.StructuralMechanicsApplication as SMA
import meshio
import numpy as np
from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis

KM.Logger.GetDefaultOutput().SetSeverity(KM.Logger.Severity.WARNING)
MOTION = {
    "solver_type": "dynamic", "time_integration_method": "explicit", "scheme_type": "central_differences", "time_step_prediction_level": 0,
    "fraction_delta_time": 0.8, "rayleigh_alpha": 0.0, "rayleigh_beta": 0.0,
}


def write(path, groups, weak=lambda middles: np.zeros(len(middles), int)):
    """Writes the mesh as solid.mdpa: its elements in the parts solid0 and solid1, nodes and facets of groups by where they are."""
    mesh = meshio.read(path)
    nodes, cells = mesh.points, mesh.cells_dict["tetra"]
    facets, kinds = mesh.cells_dict["triangle"], weak(nodes[cells].mean(axis=1))
    chosen = {name: facets[where(nodes)[facets].all(axis=1)] for name, where in groups.items()}
    with open("solid.mdpa", "w") as out:

        def block(head, rows):
            out.write(f"Begin {head}\n")
            out.writelines(" ".join(map(str, row)) + "\n" for row in rows)
            out.write("End " + head.split()[0] + "\n")

        def part(name, nodes, elements, conditions):
            out.write(f"Begin SubModelPart {name}\n")
            for kind, ids in (("Nodes", nodes), ("Elements", elements), ("Conditions", conditions)):
                block(f"SubModelPart{kind}", ([i] for i in ids))
            out.write("End SubModelPart\n")

        block("Properties 0", [])
        block("Properties 1", [])
        block("Nodes", ([n, *map(float, p)] for n, p in enumerate(nodes, 1)))
        block("Elements SmallDisplacementElement3D4N", ([n, k, *c] for n, (k, c) in enumerate(zip(kinds, cells + 1), 1)))
        block("Conditions SurfaceLoadCondition3D3N", ([n, 0, *c] for n, c in enumerate(np.vstack(list(chosen.values())) + 1, 1)))
        for k in (0, 1):
            part(f"solid{k}", np.unique(cells[kinds == k]) + 1, np.flatnonzero(kinds == k) + 1, [])
        first = 1
        for name, where in groups.items():
            part(name, np.flatnonzero(where(nodes)) + 1, [], range(first, first + len(chosen[name])))
            first += len(chosen[name])


class Job(StructuralMechanicsAnalysis):
    def __init__(self, solver, end, law, values, weak={}):
        parts = [{"model_part_name": f"Structure.solid{n}", "properties_id": n,
                  "Material": {"constitutive_law": {"name": law}, "Variables": values | (weak if n else {}), "Tables": {}}} for n in (0, 1)]
        with open("materials.json", "w") as out:
            json.dump({"properties": parts}, out)
        settings = {
            "problem_data": {"problem_name": "job", "parallel_type": "OpenMP", "echo_level": 0, "start_time": 0.0, "end_time": end},
            "solver_settings": {"model_part_name": "Structure", "domain_size": 3, "echo_level": 0,
                                "model_import_settings": {"input_type": "mdpa", "input_filename": "solid"},
                                "material_import_settings": {"materials_filename": "materials.json"}} | solver,
        }
        super().__init__(KM.Model(), KM.Parameters(json.dumps(settings)))

    def nodes(self, name):
        return self.model["Structure." + name].Nodes

    def move(self, name, axis, value):
        for node in self.nodes(name):
            node.Fix(axis)
            node.SetSolutionStepValue(axis, value)


def cantilever(path):
    """cases/cantilever-static/depth-8-standard.toml"""
    write(path, {"clamp": lambda p: p[:, 0] < 1e-9, "tip": lambda p: p[:, 0] > 1 - 1e-9})

    class Cantilever(Job):
        def ApplyBoundaryConditions(self):
            for axis in (KM.DISPLACEMENT_X, KM.DISPLACEMENT_Y, KM.DISPLACEMENT_Z):
                self.move("clamp", axis, 0.0)
            for condition in self.model["Structure.tip"].Conditions:
                condition.SetValue(SMA.SURFACE_LOAD, [0.0, 1e5 / 2**0.5, 1e5 / 2**0.5])

    job = Cantilever({"solver_type": "static", "analysis_type": "linear", "time_stepping": {"time_step": 1.1}}, 1.0,
                     "LinearElastic3DLaw", {"DENSITY": 2400.0, "YOUNG_MODULUS": 30e9, "POISSON_RATIO": 0.0})
    job.Run()
    moved = np.array([node.GetSolutionStepValue(KM.DISPLACEMENT) for node in job.nodes("tip")])
    print(moved[:, 1:].sum(axis=1).mean() / 2**0.5)


def wave(path):
    """cases/wave-bar/p.toml"""
    length, rise, step = 0.4, 20e-6, 1.1e-7
    write(path, {"left": lambda p: p[:, 0] < 1e-9, "right": lambda p: p[:, 0] > length - 1e-9,
                 "lateral": lambda p: np.maximum(abs(p[:, 1]), abs(p[:, 2])) > 1e-3 - 1e-9})
    times, arrival = [], []

    class Wave(Job):
        place = 0.0

        def ApplyBoundaryConditions(self):
            s = 1 - abs((self.time - step / 2) / rise - 1)
            self.place += step * 1e-3 * s * s * (3 - 2 * s) if s > 0 else 0.0
            self.move("left", KM.DISPLACEMENT_X, self.place)
            if not times:
                for axis in (KM.DISPLACEMENT_Y, KM.DISPLACEMENT_Z):
                    self.move("lateral", axis, 0.0)

        def FinalizeSolutionStep(self):
            super().FinalizeSolutionStep()
            times.append(self.time)
            arrival.append(np.mean([n.GetSolutionStepValue(KM.VELOCITY_X) for n in self.nodes("right")]))

    Wave(MOTION | {"max_delta_time": step, "time_stepping": {"time_step": step}}, 150e-6,
         "LinearElastic3DLaw", {"DENSITY": 2400.0, "YOUNG_MODULUS": 30e9, "POISSON_RATIO": 0.2}).Run()
    print(length / (np.dot(times, arrival) / np.sum(arrival) - rise), len(times))


def bar(path):
    """cases/tension-bar/gmsh-coarse.toml"""
    area, step = 400e-6, 2.5e-7
    times, speeds = [0, 0.5e-3, 2.2e-3, 3e-3, 1.0], [0, 5e-3, 5e-3, 50e-3, 50e-3]
    write(path, {"left": lambda p: p[:, 0] < -0.05 + 1e-9, "right": lambda p: p[:, 0] > 0.05 - 1e-9}, lambda m: (abs(m[:, 0]) < 2.1e-3).astype(int))
    extension, load = [0.0], [0.0]

    class Bar(Job):
        place = 0.0

        def ApplyBoundaryConditions(self):
            t = self.time - step / 2
            n = np.searchsorted(times, t) - 1
            s = (t - times[n]) / (times[n + 1] - times[n])
            self.place += step * (speeds[n] + (speeds[n + 1] - speeds[n]) * s * s * (3 - 2 * s))
            self.move("left", KM.DISPLACEMENT_X, 0.0)
            self.move("right", KM.DISPLACEMENT_X, self.place)

        def FinalizeSolutionStep(self):
            super().FinalizeSolutionStep()
            extension.append(self.place)
            load.append(-sum(n.GetSolutionStepValue(KM.FORCE_RESIDUAL)[0] for n in self.nodes("right")))

    concrete = {"DENSITY": 2400.0, "YOUNG_MODULUS": 30e9, "POISSON_RATIO": 0.2, "YIELD_STRESS": 3e6, "FRACTURE_ENERGY": 100.0, "SOFTENING_TYPE": 1}
    Bar(MOTION | {"max_delta_time": step, "time_stepping": {"time_step": step}}, 6e-3, "SmallStrainIsotropicDamage3DRankine", concrete, {"YIELD_STRESS": 2.7e6}).Run()
    load = np.array(load)
    print(load.max() / area, ((load[1:] + load[:-1]) / 2 * np.diff(extension)).sum() / area, len(load))


{"cantilever": cantilever, "wave": wave, "bar": bar}[sys.argv[1]](sys.argv[2])
