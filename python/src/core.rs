//! A simulation that Python drives.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use fractum::{Failure, Input, Options, Simulation, cache_of_user, load};
use fractum_case::model::ProbeKind;
use fractum_fem::fields;
use fractum_math::Vec3;
use fractum_output::summary::hash_text;
use fractum_output::warning::Warning;
use fractum_scene::{CountKind, EnergyKind, Population, Scene};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyBytes, PyDict};
use rayon::ThreadPool;

use crate::arrays::{flags, indices, numbers, to_indices, vectors};
use crate::errors::{raise, wrong};
use crate::given_load::GivenLoad;
use crate::watch::{pool, watch};

/// A case under way. After `finish` it is gone, and every call is refused.
#[pyclass(module = "fractum._core")]
pub(crate) struct Core {
    simulation: Mutex<Option<Simulation>>,
    pool: ThreadPool,
    /// As many threads for what is computed from a state between steps.
    looks: ThreadPool,
    numbering: Numbering,
    /// Whether a step is under way.
    stepping: AtomicBool,
    loads: Vec<GivenLoad>,
}

/// Nodes of solids in the order of the mesh file.
struct Numbering {
    /// Nodes of the scene.
    order: Vec<u32>,
    /// Place of every node of the scene in that order.
    place: Vec<u32>,
    /// Nodes of the groups of the mesh, as places in that order.
    groups: BTreeMap<String, Vec<u32>>,
}

impl Numbering {
    fn new(input: &Input) -> Self {
        let order = input.built.file_order.clone();
        let mut place = vec![0; order.len()];
        for (at, &node) in (0..).zip(&order) {
            place[node as usize] = at;
        }
        let scene_node = &input.built.scene_node;
        let nodes = |name: &str| {
            let all = input.mesh.group_nodes(name).into_iter().map(|n| scene_node[n as usize]);
            all.filter(|&n| n != u32::MAX).map(|n| place[n as usize]).collect()
        };
        let groups = input.mesh.group_names().into_iter().map(|name| (name.to_owned(), nodes(name))).collect();
        Numbering { groups, order, place }
    }
}

/// Code, text, place and remedy of a warning.
pub(crate) fn parts(warning: &Warning) -> [String; 4] {
    [warning.code.name(), &warning.text, &warning.place, &warning.remedy].map(str::to_owned)
}

/// A value of everything in a scene that has places and velocities.
fn no_array(py: Python<'_>, name: &str) -> PyErr {
    wrong(py, format!("no array is called \"{name}\""))
}

impl Core {
    /// Does something with the simulation where Python's lock is free.
    fn look<T>(&self, act: impl FnOnce(&mut Simulation) -> Result<T, Failure>) -> PyResult<T> {
        let mut simulation = self.simulation.lock().unwrap_or_else(PoisonError::into_inner);
        let finished = || Failure::input("the simulation has been finished");
        let ended = simulation.as_mut().ok_or_else(finished).and_then(act);
        drop(simulation);
        ended.map_err(|failure| Python::attach(|py| raise(py, &failure)))
    }

    /// As [`Core::look`] where Python's lock is held. What it does must not wait for other threads: one of them may wait for
    /// the simulation.
    fn with<T>(&self, py: Python<'_>, act: impl FnOnce(&mut Simulation) -> PyResult<T>) -> PyResult<T> {
        let mut simulation = self.simulation.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        simulation.as_mut().map_or_else(|| Err(wrong(py, "the simulation has been finished")), act)
    }

    fn with_scene<T>(&self, py: Python<'_>, act: impl FnOnce(&Scene) -> PyResult<T>) -> PyResult<T> {
        self.with(py, |simulation| act(simulation.scene()))
    }

    /// Makes a step unless the time has come [s], with Python's lock free; whether there may be another one.
    fn advance(&self, until: f64) -> PyResult<bool> {
        self.look(|run| {
            if run.is_over() || run.time() >= until {
                return Ok(false);
            }
            run.step()?;
            run.record()?;
            Ok(!run.is_over())
        })
    }

    /// Sets the forces that functions give for the next step.
    fn push(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, |run| {
            run.clear_forces();
            Ok(())
        })?;
        for load in &self.loads {
            let time = self.with_scene(py, |scene| {
                load.show(py, scene)?;
                Ok(scene.clock.time)
            })?;
            load.function.call1(py, (time,))?;
            self.with(py, |run| load.push(py, run))?;
        }
        Ok(())
    }
}

#[pymethods]
impl Core {
    /// Opens a case; arguments as those of `run`.
    #[new]
    fn new(
        py: Python<'_>,
        case: PathBuf,
        set: Vec<(String, String)>,
        output: Option<PathBuf>,
        threads: Option<usize>,
        begin: (bool, bool),
        told: (bool, bool),
    ) -> PyResult<Self> {
        let ((resume, overwrite), (quiet, strict)) = (begin, told);
        let options = Options {
            output,
            threads,
            overrides: set,
            resume,
            overwrite,
            quiet,
            strict,
            cache: cache_of_user(),
            ..Options::default()
        };
        let (pool, looks) = (pool(py, threads)?, pool(py, threads)?);
        let opened = watch(py, &pool, || {
            let started = Instant::now();
            let input = load(&case, &options.overrides, &options.cache)?;
            let numbering = Numbering::new(&input);
            Ok((Simulation::start(input, &case, &options, started)?, numbering))
        })?;
        let (simulation, numbering) = opened.map_err(|failure| raise(py, &failure))?;
        let simulation = Mutex::new(Some(simulation));
        Ok(Core { simulation, pool, looks, numbering, stepping: AtomicBool::new(false), loads: Vec::new() })
    }

    /// Steps at most `count` times and not beyond `until` [s]; whether the run goes on.
    ///
    /// Functions are called on a thread of the simulation, so that no step waits for one thread to wake another.
    ///
    /// - `stop`: a function that ends the run where it is true, looked at after every `every` steps
    fn step(&self, py: Python<'_>, count: u64, until: f64, stop: Option<Py<PyAny>>, every: u64) -> PyResult<bool> {
        if self.stepping.swap(true, Ordering::Acquire) {
            return Err(wrong(
                py,
                "the simulation is being stepped already; a load or a condition may look at it only",
            ));
        }
        let every = every.max(1);
        // Attached once: Python sets up much for a thread that it sees for the first time.
        let with_functions = |py: Python<'_>| -> PyResult<()> {
            for done in 1..=count {
                if !self.loads.is_empty() && self.with(py, |run| Ok(!run.is_over() && run.time() < until))? {
                    self.push(py)?;
                }
                if !py.detach(|| self.advance(until))? {
                    break;
                }
                if let Some(stop) = stop.as_ref().filter(|_| done.is_multiple_of(every))
                    && stop.call0(py)?.is_truthy(py)?
                {
                    self.stop(py)?;
                }
            }
            Ok(())
        };
        let work = || -> PyResult<()> {
            if self.loads.is_empty() && stop.is_none() {
                for _ in 0..count {
                    if !self.advance(until)? {
                        break;
                    }
                }
                return Ok(());
            }
            Python::attach(with_functions)
        };
        let ended = watch(py, &self.pool, work);
        self.stepping.store(false, Ordering::Release);
        ended??;
        self.with(py, |run| Ok(!run.is_over()))
    }

    /// Ends the run as if its end were reached.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, |simulation| simulation.stop().map_err(|failure| raise(py, &failure)))
    }

    /// Writes the results; their folder.
    fn finish(&self, py: Python<'_>) -> PyResult<PathBuf> {
        let taken = self.simulation.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner).take();
        let Some(simulation) = taken else { return Err(wrong(py, "the simulation has been finished")) };
        let outcome = watch(py, &self.pool, || simulation.finish())?.map_err(|failure| raise(py, &failure))?;
        Ok(outcome.folder)
    }

    /// Time [s], step [s], steps done, whether the run is over, how it ended, and the results folder.
    fn progress(&self, py: Python<'_>) -> PyResult<(f64, f64, u64, bool, Option<String>, PathBuf)> {
        self.with(py, |run| {
            let status = run.status().map(|status| format!("{status:?}").to_lowercase());
            let dt = run.scene().clock.dt_after;
            Ok((run.time(), dt, run.steps(), run.is_over(), status, run.folder().to_owned()))
        })
    }

    /// Hash of everything that changes.
    fn state_hash(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |simulation| Ok(hash_text(simulation.state_hash())))
    }

    /// All warnings so far: code, text, place and remedy of each.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<[String; 4]>> {
        self.with(py, |simulation| Ok(simulation.warnings().iter().map(parts).collect()))
    }

    /// The energies at the last row of the history [J], and the counts of everything.
    fn ledger<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        self.with_scene(py, |scene| {
            let (energies, all) = (PyDict::new(py), PyDict::new(py));
            let ledger = scene.ledger();
            EnergyKind::ALL.into_iter().try_for_each(|kind| energies.set_item(kind.name(), ledger[kind]))?;
            let counts = scene.counts();
            for (name, count) in [
                ("nodes", counts.nodes),
                ("elements", counts.elements),
                ("removed_elements", counts.removed_elements),
                ("crushed_elements", counts.crushed_elements),
                ("damaged_edges", scene.count(CountKind::DamagedEdges)),
                ("broken_edges", scene.count(CountKind::BrokenEdges)),
                ("particles", counts.particles),
                ("entered_particles", counts.entered_particles),
                ("waiting_particles", counts.waiting_particles),
                ("left_pieces", counts.left_pieces),
                ("contacts", counts.contacts),
                ("bonds", counts.bonds),
                ("broken_bonds", counts.broken_bonds),
            ] {
                all.set_item(name, count)?;
            }
            Ok((energies, all))
        })
    }

    /// Names and units of the probes that are columns of the history.
    fn probes(&self, py: Python<'_>) -> PyResult<Vec<(String, String)>> {
        self.with(py, |simulation| {
            let column = |probe: &&fractum_case::model::Probe| match &probe.kind {
                ProbeKind::Expression(expression) => !expression.scalar,
                _ => true,
            };
            let probes = simulation.case().probes.iter().filter(column);
            Ok(probes.map(|probe| (probe.name.value.clone(), probe.unit.clone())).collect())
        })
    }

    /// Times [s] and values of a probe so far.
    fn probe<'py>(&self, py: Python<'py>, name: &str) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
        self.with(py, |simulation| {
            let Some((times, values)) = simulation.probe(name) else {
                let names: Vec<&str> = simulation.case().probes.iter().map(|p| p.name.value.as_str()).collect();
                return Err(wrong(py, format!("no probe is called \"{name}\"; probes here: {}", names.join(", "))));
            };
            let bytes = |values: &[f64]| numbers(py, values.len(), |i| [values[i]]);
            Ok((bytes(times)?, bytes(values)?))
        })
    }

    /// Names of the groups of the mesh.
    fn groups(&self) -> Vec<String> {
        self.numbering.groups.keys().cloned().collect()
    }

    /// Nodes of a group of the mesh that belong to solids.
    fn group<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let Some(nodes) = self.numbering.groups.get(name) else {
            let text = format!("no group is called \"{name}\"; groups here: {}", self.groups().join(", "));
            return Err(wrong(py, text));
        };
        Ok(indices(py, nodes.iter().copied()))
    }

    /// An array over the nodes of solids.
    fn nodes<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let order = &self.numbering.order;
        self.with_scene(py, |scene| {
            let solid = &scene.solid;
            let of = |values: &dyn Fn(usize) -> Vec3| vectors(py, order.len(), |i| values(order[i] as usize));
            match name {
                "reference" => of(&|n| solid.reference[n]),
                "position" => of(&|n| solid.position(n)),
                "displacement" => of(&|n| solid.displacement_from_start(n)),
                "velocity" => of(&|n| solid.velocity[n]),
                "force" => of(&|n| solid.force[n]),
                "mass" => numbers(py, order.len(), |i| [solid.mass[order[i] as usize]]),
                _ => Err(no_array(py, name)),
            }
        })
    }

    /// An array over the particles of bonded bodies and loose ones.
    fn particles<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        self.with_scene(py, |scene| {
            let particles = &scene.bonded.particles;
            let of = |values: &[Vec3]| vectors(py, values.len(), |i| values[i]);
            let scalar = |values: &[f64]| numbers(py, values.len(), |i| [values[i]]);
            match name {
                "reference" => of(scene.bonded.reference()),
                "position" => of(&particles.position),
                "velocity" => of(&particles.velocity),
                "spin" => of(&particles.spin),
                "force" => of(&particles.force),
                "moment" => of(&particles.moment),
                "mass" => scalar(&particles.mass),
                "radius" => scalar(&particles.radius),
                _ => Err(no_array(py, name)),
            }
        })
    }

    /// An array over the discrete elements that solids have left.
    fn discrete<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let place = &self.numbering.place;
        self.with_scene(py, |scene| {
            let (debris, state, solid) = (&scene.debris, scene.debris.state(), &scene.solid);
            let nodes = &state.nodes;
            match name {
                "node" => Ok(indices(py, nodes.iter().map(|&n| place[n as usize]))),
                "attached" => Ok(flags(py, state.attached.iter().copied())),
                "radius" => numbers(py, nodes.len(), |i| [debris.radius(nodes[i])]),
                "position" => vectors(py, nodes.len(), |i| solid.position(nodes[i] as usize)),
                "velocity" => vectors(py, nodes.len(), |i| solid.velocity[nodes[i] as usize]),
                "spin" => vectors(py, nodes.len(), |i| state.spin[i]),
                _ => Err(no_array(py, name)),
            }
        })
    }

    /// The solid bodies: name, nodes of an element, and the nodes of all elements.
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, usize, Bound<'py, PyBytes>)>> {
        let place = &self.numbering.place;
        self.with_scene(py, |scene| {
            let body = |index: usize| {
                let body = scene.solid.body(index);
                let corners = body.shape.node_count();
                let nodes = body.elements.iter().flat_map(|element| &element[..corners]);
                (body.name.clone(), corners, indices(py, nodes.map(|&n| place[n as usize])))
            };
            Ok((0..scene.solid.body_count()).map(body).collect())
        })
    }

    /// An array over the elements of a solid body.
    fn elements<'py>(&self, py: Python<'py>, body: usize, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let computed = matches!(name, "damage" | "stress");
        let (alive, fields) = py.detach(|| {
            self.look(|run| {
                let solid = &run.scene().solid;
                if body >= solid.body_count() {
                    return Err(Failure::input(format!("no solid body {body}")));
                }
                // On threads of their own: those of the steps may wait for what holds the simulation here.
                let fields = if computed {
                    self.looks.install(|| fields::element_fields(solid, body, None))
                } else {
                    Vec::new()
                };
                let alive = if computed { Vec::new() } else { solid.alive(body).to_vec() };
                Ok((alive, fields))
            })
        })?;
        match name {
            "alive" => Ok(flags(py, alive.into_iter())),
            "damage" => numbers(py, fields.len(), |i| [fields[i].1]),
            "stress" => numbers(py, fields.len(), |i| fields[i].0.0),
            _ => Err(no_array(py, name)),
        }
    }

    /// Adds a load that a function gives.
    ///
    /// - `nodes`: whether its points are nodes of solids, in the order of the mesh file, or particles
    /// - `function`: called with the time [s] before every step, once the arrays hold the positions and velocities of the
    ///   points; the forces are in their array when it returns
    /// - `arrays`: positions, velocities and forces, three numbers for every point
    fn add_load(
        &mut self,
        py: Python<'_>,
        nodes: bool,
        points: &[u8],
        function: Py<PyAny>,
        arrays: [PyBuffer<f64>; 3],
    ) -> PyResult<()> {
        let mut points = to_indices(points);
        let count = if nodes {
            self.numbering.order.len()
        } else {
            self.with_scene(py, |scene| Ok(scene.bonded.particles.len()))?
        };
        if let Some(wrong_one) = points.iter().find(|&&point| point as usize >= count) {
            return Err(wrong(py, format!("no point {wrong_one}; expected less than {count}")));
        }
        if nodes {
            points.iter_mut().for_each(|point| *point = self.numbering.order[*point as usize]);
        }
        let population = if nodes { Population::Nodes } else { Population::Particles };
        match GivenLoad::new(population, points, function, arrays) {
            Some(load) => self.loads.push(load),
            None => return Err(wrong(py, "the arrays of a load need three numbers for every point")),
        }
        Ok(())
    }
}
