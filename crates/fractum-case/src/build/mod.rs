//! From a case and its mesh to a scene: names become numbers here, and every mistake that only the mesh can show is
//! reported with its place in the case file.

mod across_plane;
mod axisymmetric;
mod bodies;
mod body_doubts;
mod bonded;
mod clumps;
mod conditions;
mod contact_pairs;
mod contacts;
mod discs;
mod division;
mod doubts;
mod excavation;
mod gas;
mod gauges;
mod heat;
mod heat_doubts;
mod holes;
mod idle_doubts;
mod in_situ;
mod in_situ_doubts;
mod in_situ_layers;
mod inlets;
mod inner_facets;
mod interfaces;
mod liquid;
mod load_doubts;
mod meeting_doubts;
mod model_doubts;
mod network;
mod notches;
mod periodic;
mod ppv;
mod precheck;
mod probes;
mod rate;
mod refine;
mod shown_areas;
mod statics;
mod strength;
mod subcycling;
mod surface_supports;
mod ties;
mod tool_overlaps;
mod turns;

pub use contacts::PreparedFacets;
pub use division::{Replication, SolidDivision, cannot_divide, divide, replicated_bodies, replication};
pub use doubts::doubts;
pub use in_situ_layers::Settled;
pub use interfaces::{cut_mesh, process_zone};
pub use network::cut_network;
pub use notches::is_notched;
pub use ppv::PpvStations;
pub use refine::{refine_bytes, refine_mesh, remedy as refine_remedy, told as refine_told};
pub use statics::may_rest;
pub use strength::WeibullReport;
pub use ties::TieReport;

use std::sync::Arc;

use fractum_fem::{LocalDamping, Solid, Viscosity, motion, neighbours};
use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_output::frames::BuiltGauges;
use fractum_parallel::Exchange;
use fractum_prepare::PreparedBody;
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{ModesSettings, StaticSettings};
use fractum_scene::{
    BondedStaticSettings, FlatFaces, Inlet, Loads, Probe, Scene, SceneError, SceneSettings, Supports, SurfaceSupports,
    TimeStepSettings, with_inlets,
};

use crate::model::{Case, GroupUse, Selection, SolverKind, Support, TimeStep};
use crate::{Diagnostic, Diagnostics, Place, Spanned, TimeFunction};
use bodies::{Numbering, Part};
use bonded::ParticleSets;
use conditions::{LoadedPoints, Surface};

/// A scene with what is needed to speak of it in the user's terms.
pub struct BuiltScene {
    /// The simulation at t = 0.
    pub scene: Scene,
    /// Settings of the quasi-static solver, where the case asks for it.
    pub statics: Option<StaticSettings>,
    /// Settings of the solver that brings a bonded body from break to break; none for other runs.
    pub bonded_statics: Option<BondedStaticSettings>,
    /// Settings of the search for natural vibrations, where the case asks for them.
    pub modes: Option<ModesSettings>,
    /// The probes of the case that are measured, in the order of `Case::probes`; none for expressions.
    pub probes: Vec<Option<Box<dyn Probe>>>,
    /// Stations at which the largest velocity is kept.
    pub ppv: Vec<PpvStations>,
    /// Grids of places with displacement and strain.
    pub gauges: Vec<BuiltGauges>,
    /// Nodes of the mesh in the scene's numbering, or `u32::MAX` for nodes of no solid body.
    pub scene_node: Vec<u32>,
    /// Nodes of the scene in the order of the mesh file: outputs follow it.
    pub file_order: Vec<u32>,
    /// For each solid body, the mesh elements that it is made of (tetrahedra or triangles).
    pub elements: Vec<Vec<u32>>,
    /// Outward boundary facets of the solids at the start, in scene nodes; edges repeat their second node.
    pub boundary: Vec<[u32; 3]>,
    /// Ties of bonded bodies to solids.
    pub ties: Vec<TieReport>,
    /// Bodies with Weibull's strength, solids first.
    pub weibull: Vec<WeibullReport>,
    /// How far the bodies have settled from the in-situ stress that is written; empty where they do not.
    pub settled: Vec<Settled>,
    /// Whether heat is conducted alone.
    pub conducts_alone: bool,
    /// Doubts that building it has shown, which do not keep the scene from running; not those of [`doubts`] about the case.
    pub warnings: Vec<Diagnostic>,
}

/// What all parts of the construction share.
struct Context<'a> {
    case: &'a Case,
    mesh: &'a Mesh,
    /// Of several ranks that share the cells of solids.
    exchange: Option<Arc<dyn Exchange>>,
    /// What this rank has of the solids, where none has all of them.
    division: Option<&'a SolidDivision>,
    /// Sets of particles of the bonded bodies.
    particle_sets: Vec<ParticleSets>,
    /// Faces of each body of particles as rigid bodies feel them.
    flat_faces: Vec<Option<FlatFaces>>,
    /// Where particles of bodies come into the run.
    inlets: Vec<Inlet>,
    weibull: Vec<WeibullReport>,
    /// Displacements of the far field of an in-situ stress, from which supports hold their nodes [m].
    held_by_far_field: Option<Vec<Vec3>>,
    diagnostics: Vec<Diagnostic>,
}

/// Checks what case and mesh tell without the bodies of particles, which may take long to make.
///
/// # Errors
/// Groups and sets of particles that are missing or empty, loads and motions that are not finite numbers.
pub fn check_before_particles(case: &Case, mesh: &Mesh) -> Result<(), Diagnostics> {
    let mut context = Context {
        case,
        mesh,
        exchange: None,
        division: None,
        particle_sets: Vec::new(),
        flat_faces: Vec::new(),
        inlets: Vec::new(),
        weibull: Vec::new(),
        held_by_far_field: None,
        diagnostics: Vec::new(),
    };
    precheck::check_before_particles(&mut context);
    if context.diagnostics.is_empty() { Ok(()) } else { Err(Diagnostics::of_many(context.diagnostics)) }
}

/// Builds the scene of a case on its mesh (coordinates already in metres; an empty one where the case has none).
///
/// - `prepared`: the bodies of particles in the order of the case; `facets`: those of the rigid bodies from STL files
///
/// # Errors
/// Everything that does not fit: groups that are missing or of the wrong kind, overlapping bodies, contradictory
/// supports, elements too large for their fracture energy.
pub fn build_scene(
    case: &Case,
    mesh: &Mesh,
    prepared: Vec<PreparedBody>,
    facets: Vec<PreparedFacets>,
) -> Result<BuiltScene, Diagnostics> {
    build_shared_scene(case, mesh, prepared, facets, (None, None))
}

/// The same, as one of the ranks of an exchange, which all build it: with the cells alone that this rank evaluates, where no other are
/// needed. With a division the mesh is that of [`divide`].
///
/// # Errors
/// As [`build_scene`].
pub fn build_shared_scene(
    case: &Case,
    mesh: &Mesh,
    prepared: Vec<PreparedBody>,
    facets: Vec<PreparedFacets>,
    (exchange, division): (Option<Arc<dyn Exchange>>, Option<&SolidDivision>),
) -> Result<BuiltScene, Diagnostics> {
    // The equilibrium with which in-situ stress begins is found by every rank, and bodies leave as wholes.
    let exchange = exchange.filter(|_| case.in_situ.is_none() && !case.excavates());
    let (particle_sets, flat_faces, inlets, weibull, diagnostics) = Default::default();
    let mut context = Context {
        case,
        mesh,
        exchange,
        division,
        particle_sets,
        flat_faces,
        inlets,
        weibull,
        held_by_far_field: None,
        diagnostics,
    };
    precheck::check_before_particles(&mut context);
    let built = context.build(prepared, facets);
    match built {
        Some(built) if context.diagnostics.is_empty() => Ok(built),
        _ => Err(Diagnostics::of_many(context.diagnostics)),
    }
}

impl<'a> Context<'a> {
    /// A place for mistakes of the whole case.
    fn whole_case(&self) -> Place {
        Place { file: self.case.source.path.display().to_string(), line: 0, column: 0, key: String::new() }
    }

    fn error(&mut self, place: &Place, found: impl Into<String>, expected: impl Into<String>) {
        self.diagnostics.push(Diagnostic::error(place, found).expected(expected));
    }

    fn build(&mut self, prepared: Vec<PreparedBody>, facets_of_tools: Vec<PreparedFacets>) -> Option<BuiltScene> {
        self.without_mistakes()?;
        let taken = ties::taken(self, &prepared);
        let sizes = bonded::doubts_of_size(self.case, &prepared);
        let mut bonded = self.bonded(prepared)?;
        let mut parts = bodies::solid_parts(self)?;
        ties::take_out(self, &mut parts, &taken);
        across_plane::check(self, &parts);
        axisymmetric::check(self, &parts);
        self.without_mistakes()?;
        let numbering = bodies::number_nodes(self, &parts);
        let mut boundary = bodies::boundary(self, &parts, &numbering, &[]);
        let inner = interfaces::inner_facets(self, &numbering);
        boundary.retain(|facet| !inner.contains(&interfaces::by_nodes(*facet)));
        let mut solid = self.solid(&parts, &numbering, &boundary)?;
        let mut warnings = bodies::length_warnings(self.case, &solid, &parts, &boundary);
        warnings.extend(bodies::weibull_warnings(self, &solid, &parts));
        warnings.extend(sizes);
        bodies::set_initial_velocity(self, &mut solid, &parts, &numbering);
        let mut boundary_of_parts = contacts::facets_of_parts(self, &parts, &numbering);
        boundary_of_parts.iter_mut().for_each(|own| own.retain(|facet| !inner.contains(&interfaces::by_nodes(*facet))));
        if neighbours::is_divided(&solid) {
            boundary_of_parts
                .iter()
                .enumerate()
                .for_each(|(body, facets)| neighbours::note_skin(&mut solid, body, facets));
        }
        let surface = Surface::new(&boundary, &solid, &numbering.positions);
        let left = excavation::what_is_left(self, &parts, &numbering);
        let (loaded, facets) = left.as_ref().map_or((&numbering, &boundary), |(numbering, facets)| (numbering, facets));
        let bare = Surface::new(facets, &solid, &numbering.positions);
        warnings.extend(excavation::doubts(self, &parts, loaded));
        warnings.extend(inner_facets::doubts(self, &numbering, &surface));
        let (supports, surface_supports, loads) =
            self.supports_and_loads(&solid, &parts, loaded, &bare, &boundary_of_parts)?;
        let statics = statics::statics(self, &solid, &numbering);
        let ties = ties::ties(self, &solid, &bonded, &taken, &parts, &numbering, &boundary_of_parts);
        warnings.extend(ties.warnings.iter().cloned());
        // Facets under tied particles matter to what breaks off only.
        let breaks = bonded.can_break();
        let touched = |facet: &[u32; 3]| breaks || !ties.covered.contains(&ties::sorted(*facet));
        boundary_of_parts.iter_mut().for_each(|facets| facets.retain(touched));
        self.condition_particles(&mut bonded, &ties.attachments, &mut warnings);
        let bonded_statics = statics::bonded_statics(self, &bonded);
        let modes = statics::modes(self);
        let probes = self.probes(&parts, &numbering, &surface, &solid, &supports, &bonded);
        let ppv = self.ppv_stations(&numbering, &solid);
        let gauges = self.gauges(&numbering, &solid, &bonded);
        self.without_mistakes()?;
        let surfaces = parts.iter().map(|part| part.body.surface(&self.case.materials)).collect();
        let pairs = contact_pairs::contact_pairs(self.case, &parts);
        let debris = Debris::new(&solid, surfaces).with_pairs(pairs.clone());
        let surface_nodes = nodes_of(&boundary);
        let rigid_bodies = contacts::rigid_bodies(self, facets_of_tools);
        let shapes = contacts::shape_contacts(&rigid_bodies);
        let scene = Scene::new(solid, supports, loads, debris, shapes, &surface_nodes, self.settings())
            .with_bonded(bonded)
            .with_ties(&ties.attachments)
            .with_surface_supports(surface_supports);
        let scene = with_inlets(scene, std::mem::take(&mut self.inlets));
        let scene = interfaces::with_interfaces(self, scene, &parts, &numbering);
        let scene = liquid::with_liquid(self, scene, (&numbering, &surface), &mut warnings);
        warnings.extend(interfaces::doubts(self, &scene));
        let tied: Vec<u32> = if breaks { ties.attachments.iter().map(|a| a.particle).collect() } else { Vec::new() };
        let scene = contacts::with_contacts(
            self,
            scene,
            &parts,
            &boundary_of_parts,
            &surface_nodes,
            rigid_bodies,
            &pairs,
            &tied,
            &mut warnings,
        )?;
        let scene = heat::with_heat(self, scene, &parts, &numbering, &surface, &mut warnings)?;
        let scene = excavation::with_excavation(self.case, scene, &parts);
        let scene = self.made_ready(scene, &probes, &mut warnings)?;
        let first = self.case.is_first_stage();
        let settled = if first { in_situ_layers::settled(self.case, &scene.solid) } else { Vec::new() };
        warnings.extend(in_situ_layers::settled_far(self.case, &settled));
        Some(BuiltScene {
            statics: statics.filter(|_| statics::is_held(self, &scene)),
            scene,
            bonded_statics,
            modes,
            probes,
            ppv,
            gauges,
            file_order: numbering.file_order(),
            scene_node: numbering.scene_node,
            elements: parts.into_iter().map(|part| part.elements).collect(),
            boundary,
            ties: ties.reports,
            weibull: std::mem::take(&mut self.weibull),
            settled,
            conducts_alone: self.case.solver.kind == SolverKind::Heat,
            warnings,
        })
    }

    /// Something as long as no mistake has been found.
    fn without_mistakes(&self) -> Option<()> {
        self.diagnostics.is_empty().then_some(())
    }

    /// The elements of all solid bodies.
    fn solid(&mut self, parts: &[Part<'a>], numbering: &Numbering, boundary: &[[u32; 3]]) -> Option<Solid> {
        let bodies = bodies::solid_bodies(self, parts, numbering, boundary)?;
        let nodes = numbering.positions.clone();
        let solid = match (&self.exchange, self.division) {
            (Some(exchange), Some(division)) => {
                neighbours::divided_solid(nodes, bodies, &division.bodies, Arc::clone(exchange))
            }
            _ if self.case.solver.subcycling.is_some() => Solid::subcycled(nodes, bodies),
            (Some(exchange), None) => neighbours::shared_solid(nodes, bodies, Arc::clone(exchange)),
            (None, _) => Solid::new(nodes, bodies),
        };
        let mut solid = match solid {
            Ok(solid) => solid,
            Err(error) => {
                let place = parts.first().map_or_else(|| self.whole_case(), |part| part.place.clone());
                self.error(&place, format!(": {error}"), "");
                // The reason may be another unit, of the material or of the mesh.
                self.diagnostics.extend(self.case.warnings().iter().cloned());
                self.diagnostics.extend(doubts(self.case, self.mesh));
                return None;
            }
        };
        let damping = self.case.damping;
        motion::set_viscosity(
            &mut solid,
            Viscosity {
                stiffness_time: damping.stiffness,
                bulk_linear: damping.bulk_linear,
                bulk_quadratic: damping.bulk_quadratic,
            },
        );
        Some(solid)
    }

    /// What holds the solids, and what loads them.
    fn supports_and_loads(
        &mut self,
        solid: &Solid,
        parts: &[Part],
        numbering: &Numbering,
        surface: &Surface,
        boundary_of_parts: &[Vec<[u32; 3]>],
    ) -> Option<(Supports, SurfaceSupports, Loads)> {
        let mut supports = self.supports(numbering);
        supports.extend(self.on_axis(parts, numbering, &supports));
        let (surface_supports, supported) = self.surface_supports(parts, numbering, surface, solid, boundary_of_parts);
        let in_situ = in_situ::in_situ_loads(self, numbering, surface, solid, supported);
        let points = LoadedPoints::Nodes(numbering, surface);
        let mut loads = self.loads(&points);
        loads.extend(in_situ);
        let gas = gas::gas(self, solid, &points, &supports, &loads);
        let supports = subcycling::by_step(supports, solid);
        let places: Vec<Vec3> = (0..solid.mass.len()).map(|node| solid.reference[solid.original(node)]).collect();
        match Supports::new(supports, &places) {
            Ok(supports) => Some((supports, surface_supports, Loads::new(loads, places.len()).with_gas(gas))),
            Err(error) => {
                let place = self.place_of_support(&error);
                self.error(&place, format!(": {error}"), "");
                None
            }
        }
    }

    /// The scene as its run begins: with its domain, the contacts that probes follow, and in-situ stress in equilibrium.
    fn made_ready(
        &mut self,
        mut scene: Scene,
        probes: &[Option<Box<dyn Probe>>],
        warnings: &mut Vec<Diagnostic>,
    ) -> Option<Scene> {
        if let Some(domain) = self.case.solver.domain.clone() {
            scene = precheck::with_domain(self, scene, &domain)?;
        }
        for probe in probes.iter().flatten() {
            if let Some(contact) = probe.contact() {
                scene.contacts.watch(contact);
            }
        }
        if let Some(far) = self.held_by_far_field.take() {
            let solid = &mut scene.solid;
            for node in 0..solid.displacement.len() {
                solid.displacement[node] = far[solid.original(node)];
            }
        }
        // Later stages begin with the state of those before.
        if let Some(stress) = self.case.in_situ.as_ref().filter(|_| self.case.is_first_stage()) {
            let as_written = in_situ_layers::begin_as_written(self.case, &mut scene.solid);
            if let Err(error) = scene.start_at_rest(as_written.filter(|_| !stress.settles)) {
                self.error(&stress.place.clone(), format!(": {error}"), "");
                return None;
            }
        }
        if self.exchange.is_none() && self.case.is_first_stage() {
            warnings.extend(in_situ::shared(self.case, &scene.solid));
        }
        if !matches!(self.case.solver.kind, SolverKind::Static | SolverKind::Heat | SolverKind::Modes) {
            precheck::check_time_step(self, &scene, warnings);
        }
        Some(scene)
    }

    /// The support that contradicts one above it.
    fn place_of_support(&self, error: &SceneError) -> Place {
        let SceneError::ContradictorySupports { second, .. } = error else { return self.whole_case() };
        let support = self.case.supports.iter().rev().find(|s: &&Support| s.label() == second);
        support.and_then(|s| s.on.place()).cloned().unwrap_or_else(|| self.whole_case())
    }

    fn settings(&self) -> SceneSettings {
        let solver = &self.case.solver;
        SceneSettings {
            time_step: TimeStepSettings {
                safety: solver.safety,
                // Without motion the step is of no use: its bound is cheap.
                element_bound: solver.time_step == TimeStep::Element
                    || matches!(solver.kind, SolverKind::Static | SolverKind::Heat | SolverKind::Modes),
                fixed: solver.step.as_ref().filter(|_| solver.statics.is_none()).map(|step| step.value),
                begin: solver.begin,
                end: solver.end,
            },
            damping: LocalDamping { local: self.case.damping.local, mass_rate: self.case.damping.mass },
            stiffness_time: self.case.damping.stiffness,
            balance_stop: solver.balance_stop,
            joined_below: self.case.output.joined_below,
        }
    }

    /// Nodes of a group that belong to solid bodies, in the scene's numbering, ascending.
    fn group_nodes(&mut self, group: &Spanned<String>, numbering: &Numbering) -> Vec<u32> {
        let nodes = self.nodes_of_group(&group.value, numbering);
        if nodes.is_empty() {
            self.error(&group.place, format!("= \"{}\"", group.value), "a group that touches a solid body");
        }
        nodes
    }

    /// The same, none where it touches no solid body.
    fn nodes_of_group(&self, group: &str, numbering: &Numbering) -> Vec<u32> {
        let in_file = self.mesh.group_nodes(group);
        let mut nodes: Vec<u32> =
            in_file.iter().map(|&n| numbering.scene_node[n as usize]).filter(|&n| n != u32::MAX).collect();
        nodes.sort_unstable();
        nodes
    }

    /// Nodes of solid bodies that are meant, in the scene's numbering, ascending.
    fn selected_nodes(&mut self, on: &Selection, numbering: &Numbering) -> Vec<u32> {
        if !numbering.gone.is_empty() {
            let whole = self.selected_nodes(on, &numbering.whole());
            let left: Vec<u32> = whole.iter().copied().filter(|&node| !numbering.has_left(node)).collect();
            if let (true, true, Some(place)) = (left.is_empty(), !whole.is_empty(), on.place()) {
                let meant = on.group.as_ref().map_or_else(String::new, |group| format!("= \"{}\"", group.value));
                let found = format!("{meant}: all its nodes have left in stage \"{}\"", self.case.source.stage);
                self.error(place, found, "stages = [...] with those before alone");
            }
            return left;
        }
        let nodes = match &on.group {
            Some(group) => self.group_nodes(group, numbering),
            None => (0..numbering.positions.len() as u32).collect(),
        };
        self.keep_within(on, nodes, |n| numbering.positions[n as usize])
    }

    /// Of these nodes or particles those where the condition holds; an error if it holds for none of them.
    fn keep_within(&mut self, on: &Selection, mut points: Vec<u32>, at: impl Fn(u32) -> Vec3) -> Vec<u32> {
        let Some(within) = &on.within else { return points };
        let count = points.len();
        points.retain(|&point| within.value.holds_at(at(point)));
        // A group without any has its own error.
        if points.is_empty() && (count > 0 || on.group.is_none()) {
            let found = format!("holds for none of {count} nodes or particles");
            self.error(&within.place, found, "a condition that holds for one at least");
        }
        points
    }
}

/// Nodes of facets, ascending.
fn nodes_of(facets: &[[u32; 3]]) -> Vec<u32> {
    let mut nodes: Vec<u32> = facets.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// A function of time and place as the scene takes it.
fn function(function: &TimeFunction) -> fractum_scene::TimeFunction {
    let function = function.clone();
    Arc::new(move |time, position: &Vec3| function.value(time, *position))
}

/// Whether a group is of use where the case puts it, in words.
fn use_in_words(group_use: GroupUse) -> &'static str {
    match group_use {
        GroupUse::Body => "elements of a body",
        GroupUse::Filled => "a volume to fill with particles",
        GroupUse::Tool => "facets of a rigid body",
        GroupUse::Support | GroupUse::ProbeNodes => "nodes of a solid body",
        GroupUse::Force => "nodes or facets of a solid body",
        GroupUse::Facets => "facets on the surface of a solid body",
        GroupUse::ProbeElements => "elements of a solid body",
    }
}
