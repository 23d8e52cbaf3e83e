//! Every key of the case file: kind, default, meaning.
//!
//! The reader takes dimensions from here, so that the documentation, `explain`, the schema and the reading agree.

use std::collections::HashMap;
use std::sync::LazyLock;

use fractum_dem::Batch;
use fractum_dem::FractureCriterion;
use fractum_dem::criterion::EndMoments;
use fractum_fem::{CriterionKind, Formulation, Kinematics, Plane};
use fractum_pack::Convention;
use fractum_scene::statics::{LinearSolver, NoEquilibrium};
use fractum_scene::{CountKind, CrackMeasure, EnergyProbe};

use super::key_kind::{KeyDoc, KeyKind};
use super::model::*;
use super::tree::{Node, Value, join};
use super::unit::Dimension;
use super::{Choice, Diagnostic, nearest};

fn names<T: Choice>() -> Vec<&'static str> {
    T::NAMES.iter().map(|(name, _)| *name).collect()
}

/// Pattern of the table form of a time function, which may stand at many keys.
pub(super) const TIME_FUNCTION: &str = "TIME_FUNCTION";

const fn key(path: &'static str, kind: KeyKind, default: &'static str, doc: &'static str) -> KeyDoc {
    KeyDoc { path, kind, default, doc }
}

/// Every key of the case file, parents before children.
pub fn keys() -> &'static [KeyDoc] {
    KEYS
}

/// The description of a key: a pattern as in [`KeyDoc::path`], or a path of a case such as `supports[0].group`.
///
/// # Errors
/// The nearest known path, if any resembles.
pub fn explain(path: &str) -> Result<&'static KeyDoc, Option<&'static str>> {
    if let Some(key) = fitting(path) {
        return Ok(key);
    }
    let (parent, last) = path.rsplit_once('.').unwrap_or(("", path));
    if matches!(fitting(parent), Some(KeyDoc { kind: KeyKind::TimeFunction(_), .. }))
        && let Some(key) = describe(&join(TIME_FUNCTION, last))
    {
        return Ok(key);
    }
    let paths = || KEYS.iter().map(|key| key.path);
    let whole = nearest(&without_indices(path), paths());
    Err(whole.or_else(|| paths().find(|path| path.rsplit('.').next() == Some(last))))
}

/// The key whose pattern a path of a case, or itself, fits.
fn fitting(path: &str) -> Option<&'static KeyDoc> {
    let plain = without_indices(path);
    let fits = |key: &&KeyDoc| {
        let pattern = without_indices(key.path);
        let same = |(part, name): (&str, &str)| part == name || (part == "NAME" && !name.is_empty());
        pattern.split('.').count() == plain.split('.').count() && pattern.split('.').zip(plain.split('.')).all(same)
    };
    describe(path).or_else(|| KEYS.iter().find(fits))
}

/// A path without what stands in square brackets.
fn without_indices(path: &str) -> String {
    path.split('.').map(|part| part.split('[').next().unwrap_or_default()).collect::<Vec<_>>().join(".")
}

/// The description of a key by its pattern.
pub(super) fn describe(pattern: &str) -> Option<&'static KeyDoc> {
    static BY_PATH: LazyLock<HashMap<&str, &KeyDoc>> =
        LazyLock::new(|| KEYS.iter().map(|key| (key.path, key)).collect());
    BY_PATH.get(pattern).copied()
}

/// Names of the keys directly below a pattern.
pub(super) fn children(pattern: &str) -> impl Iterator<Item = &'static str> {
    let below = KEYS.iter().filter_map(move |key| match pattern {
        "" => Some(key.path),
        _ => key.path.strip_prefix(pattern)?.strip_prefix('.'),
    });
    below
        .filter(|name| !name.contains('.') && !["NAME", TIME_FUNCTION].contains(name))
        .map(|name| name.trim_end_matches("[]"))
}

/// An unknown key, and the path of the key that was probably meant.
pub(super) struct Unknown {
    pub(super) diagnostic: Diagnostic,
    pub(super) meant: Option<String>,
}

/// Reports keys that do not exist, with the nearest that does, and takes them out of the tree.
pub(super) fn remove_unknown(node: &mut Node, pattern: &str, report: &mut dyn FnMut(Unknown)) {
    let Value::Table(entries) = &mut node.value else { return };
    let table = &node.place.key;
    entries.retain_mut(|entry| {
        let exact = join(pattern, &entry.name);
        let named = join(pattern, "NAME");
        let key = describe(&exact).or_else(|| describe(&format!("{exact}[]"))).or_else(|| describe(&named));
        let Some(key) = key.filter(|key| key.path != TIME_FUNCTION) else {
            let known: Vec<_> = children(pattern).collect();
            let diagnostic = Diagnostic::error(&entry.key_place, "is not a key");
            report(match nearest(&entry.name, known.iter().copied()) {
                Some(near) => Unknown {
                    diagnostic: diagnostic.remedy(format!("did you mean {near}?")),
                    meant: Some(join(table, near)),
                },
                None if known.is_empty() => Unknown { diagnostic, meant: None },
                None => {
                    Unknown { diagnostic: diagnostic.remedy(format!("keys here: {}", known.join(", "))), meant: None }
                }
            });
            return false;
        };
        let below = match key.kind {
            KeyKind::TimeFunction(_) => TIME_FUNCTION,
            _ => key.path,
        };
        match &mut entry.node.value {
            Value::Array(items) if matches!(key.kind, KeyKind::Tables) => {
                items.iter_mut().for_each(|item| remove_unknown(item, below, report));
            }
            Value::Table(_) if children(below).next().is_some() || describe(&join(below, "NAME")).is_some() => {
                remove_unknown(&mut entry.node, below, report);
            }
            _ => {}
        }
        true
    });
}

use Dimension as D;
use KeyKind as K;

#[rustfmt::skip] // a table reads best with one row per line
static KEYS: &[KeyDoc] = &[
    key("fractum", K::Integer, "required", "Version of the case format: 1"),
    key("title", K::Text, "", "Title of reports"),

    key("parameters", K::NamedTables, "", "Named quantities for use in any quantity or expression; `--set NAME=value` overrides them"),
    key("parameters.NAME", K::AnyQuantity, "", "A quantity, or an expression of parameters above it"),

    key("mesh", K::Table, "", "The mesh; required by bodies of mesh groups"),
    key("mesh.file", K::Text, "required", "Gmsh file, relative to the case file"),
    key("mesh.unit", K::Unit(Some(D::LENGTH)), "\"m\"", "Unit of the mesh's coordinates"),

    key("materials", K::NamedTables, "", "Materials by name"),
    key("materials.NAME", K::Table, "", "A material"),
    key("materials.NAME.density", K::Quantity(D::DENSITY), "required", "Mass density, > 0"),
    key("materials.NAME.young_modulus", K::Quantity(D::PRESSURE), "required", "Young's modulus, > 0"),
    key("materials.NAME.poisson_ratio", K::Quantity(D::NONE), "required", "Poisson's ratio, between -1 and 0.5, both excluded"),
    key("materials.NAME.damage", K::Table, "", "Softening damage; without this table the material stays elastic"),
    key("materials.NAME.damage.criterion", K::Choice(names::<CriterionKind>), "\"rankine\"", "Equivalent stress that damage answers to"),
    key("materials.NAME.damage.tension_cutoff", K::Flag, "true", "Mohr-Coulomb only: cut off by the largest principal stress; false loses about a fifth of the Brazilian strength"),
    key("materials.NAME.damage.tensile_strength", K::Quantity(D::PRESSURE), "required", "Uniaxial tensile strength ft, > 0"),
    key("materials.NAME.damage.fracture_energy", K::Quantity(D::FRACTURE_ENERGY), "required", "Energy per area of a full crack Gf, > 0"),
    key("materials.NAME.damage.compressive_strength", K::Quantity(D::PRESSURE), "10 ft", "Uniaxial compressive strength, above ft, with mohr-coulomb at least ft (1 + sin φ)/(1 - sin φ); for mohr-coulomb with cut-off, drucker-prager, modified-mohr-coulomb"),
    key("materials.NAME.damage.friction_angle", K::Angle, "\"35 deg\"", "Angle of internal friction, from 0 to below 90 deg; for mohr-coulomb, modified-mohr-coulomb"),
    key("materials.NAME.damage.softening", K::Choice(softenings), "\"exponential\"", "Stress against crack opening, by name or as a table"),
    key("materials.NAME.damage.softening.kind", K::Choice(softenings), "required", "Stress against crack opening"),
    key("materials.NAME.damage.softening.kink_stress", K::Quantity(D::NONE), "1/3", "Bilinear only: stress at the kink over ft, within 0 and 1 (Petersson 1981)"),
    key("materials.NAME.damage.softening.kink_opening", K::Quantity(D::NONE), "2/9", "Bilinear only: opening at the kink over the last opening, within 0 and 1 (Petersson 1981)"),
    key("materials.NAME.damage.residual", K::Quantity(D::NONE), "0.02", "Stress over strength at which an edge is broken, within 0 and 1"),
    key("materials.NAME.damage.scatter", K::Table, "", "Random scatter of the tensile strength, drawn per edge"),
    key("materials.NAME.damage.scatter.distribution", K::Choice(distributions), "required", "Distribution of the factor on the strength"),
    key("materials.NAME.damage.scatter.modulus", K::Quantity(D::NONE), "", "Weibull only, required there: modulus, > 0"),
    key("materials.NAME.damage.scatter.width", K::Quantity(D::NONE), "", "Uniform only, required there: half width around 1, within 0 and 1"),
    key("materials.NAME.damage.scatter.seed", K::Integer, "1", "Seed of the random numbers, ≥ 0"),
    key("materials.NAME.damage.reduce_strength_to_fit", K::Flag, "false", "Lower ft where an element is too large for Gf, instead of refusing it"),
    key("materials.NAME.damage.crack_plane_gate", K::Flag, "false", "Smoothed formulation only: near a crack, damage begins only where the plane of the crack goes on; for few, separate cracks"),
    key("materials.NAME.damage.unilateral", K::Flag, "false", "Stiffness recovers where cracks close"),
    key("materials.NAME.damage.rate_time", K::Quantity(D::TIME), "\"0 s\"", "Time constant of the damage-rate limiter, ≥ 0; 0 is off"),
    key("materials.NAME.bonds", K::Table, "", "Beams of bonded bodies, as `fractum calibrate` writes them; without this table they are calibrated"),
    key("materials.NAME.bonds.coordination", K::Quantity(D::NONE), "required", "Coordination that the beams hold for"),
    key("materials.NAME.bonds.convention", K::Choice(names::<Convention>), "required", "Which particles the coordination counts"),
    key("materials.NAME.bonds.radius_ratio", K::Quantity(D::NONE), "required", "Beam radius over mean particle radius, within 0 and 2"),
    key("materials.NAME.bonds.young_modulus", K::Quantity(D::PRESSURE), "required", "Young's modulus of the beams, > 0"),
    key("materials.NAME.fracture", K::Table, "", "When the bonds of bonded bodies break; without this table they hold"),
    key("materials.NAME.fracture.criterion", K::Choice(bond_criteria), "\"principal\"", "Largest principal virial stress of a particle with its neighbours; largest principal stress in the beam; mean virial stress of a particle, which loses all its bonds; Mohr-Coulomb with tension cut-off or Drucker-Prager on the virial stress"),
    key("materials.NAME.fracture.tensile_strength", K::Quantity(D::PRESSURE), "required", "Tensile strength of the material, > 0; the criterion's own strengths are found by breaking two boxes in tension"),
    key("materials.NAME.fracture.criterion_strength", K::Quantity(D::PRESSURE), "", "Instead: strength of the criterion itself in tension, > 0, as `fractum calibrate --strength` writes it"),
    key("materials.NAME.fracture.compressive_strength", K::Quantity(D::PRESSURE), "none with principal, else 10 times that in tension", "In compression, above that in tension and of the same kind; for principal, mohr-coulomb, drucker-prager"),
    key("materials.NAME.fracture.friction_angle", K::Angle, "\"35 deg\"", "mohr-coulomb only: angle of internal friction, from 0 to below 90 deg"),
    key("materials.NAME.fracture.level", K::Integer, "1", "Over which particles stress is taken: 0 the particle, 1 those bonded to it too, 2 their partners too; not for beam and hydrostatic"),
    key("materials.NAME.fracture.moments", K::Choice(names::<EndMoments>), "\"mean\"", "beam only: which bending moment counts"),
    key("materials.NAME.contact", K::Table, "", "Contact of particles of this material, and of the discrete elements it leaves behind"),
    key("materials.NAME.contact.friction", K::Quantity(D::NONE), "0.5", "Coulomb friction coefficient, ≥ 0"),
    key("materials.NAME.contact.rolling_friction", K::Quantity(D::NONE), "0", "Coefficient of rolling friction, ≥ 0: couple over normal force and reduced radius"),
    key("materials.NAME.contact.damping_ratio", K::Quantity(D::NONE), "0.1", "Fraction of critical damping, 0 to 1"),
    key("materials.NAME.contact.restitution", K::Quantity(D::NONE), "", "Coefficient of restitution, above 0 to 1, instead of the damping ratio"),
    key("materials.NAME.contact.young_modulus", K::Quantity(D::PRESSURE), "", "Young's modulus that contacts of its particles take instead, > 0: particles of a bonded body stand for a continuum that yields by itself, and a stiff contact adds little to it"),

    key("bodies[]", K::Tables, "required", "Bodies, at least one"),
    key("bodies[].name", K::Text, "required", "Name, unique among bodies"),
    key("bodies[].kind", K::Choice(body_kinds), "required", "What the body is"),
    key("bodies[].group", K::Text, "", "Solid, required there: mesh group of its elements; bonded group: mesh group whose volume its particles fill; rigid group: its facets"),
    key("bodies[].material", K::Text, "", "Name of its material; required but for rigid bodies, which deform in contact with it, and not at all without"),
    key("bodies[].formulation", K::Choice(names::<Formulation>), "\"smoothed\" with damage, else \"standard\"", "Solid: strain and damage on edges, or the plain element"),
    key("bodies[].kinematics", K::Choice(names::<Kinematics>), "\"small\"", "Solid: small rotations, or a frame that turns with each element"),
    key("bodies[].plane", K::Choice(names::<Plane>), "\"strain\"", "Solid in 2D only: plane strain or plane stress"),
    key("bodies[].thickness", K::Quantity(D::LENGTH), "\"1 m\"", "Solid in 2D only: thickness, > 0"),
    key("bodies[].initial_velocity", K::Table, "", "Velocity at the start, by components; of a rigid body along its free axes"),
    key("bodies[].initial_velocity.x", K::Field(D::VELOCITY), "0", "Component along x"),
    key("bodies[].initial_velocity.y", K::Field(D::VELOCITY), "0", "Component along y"),
    key("bodies[].initial_velocity.z", K::Field(D::VELOCITY), "0", "Component along z"),
    key("bodies[].damage", K::Flag, "true", "Solid: false keeps the body elastic whatever its material says"),
    key("bodies[].damage_where", K::Condition, "", "Solid: where damage may occur; absent means everywhere"),
    key("bodies[].strength_factor", K::Field(D::NONE), "1", "Solid: factor on the tensile strength, > 0"),
    key("bodies[].shape", K::Choice(shapes), "", "Rigid, required there; bonded: any but plane, filled with particles; particles: box, cylinder or sphere, filled with a loose cloud"),
    key("bodies[].point", K::Point(D::LENGTH), "[0, 0, 0]", "Plane: a point on it; box: its lower corner; cylinder: centre of the face where it begins; sphere: its centre; rigid group and stl: point about which it turns"),
    key("bodies[].normal", K::Direction, "", "Rigid plane, required there: normal out of the tool"),
    key("bodies[].axis", K::Direction, "\"x\"", "Cylinder, rigid or of loose particles: direction from its beginning to its end"),
    key("bodies[].inside", K::Flag, "false", "Rigid box, cylinder and sphere: true holds the particles inside, as a container"),
    key("bodies[].velocity", K::Table, "", "Rigid: prescribed velocity, by components; the others are held, or free"),
    key("bodies[].velocity.x", K::TimeFunction(D::VELOCITY), "", "Along x"),
    key("bodies[].velocity.y", K::TimeFunction(D::VELOCITY), "", "Along y"),
    key("bodies[].velocity.z", K::TimeFunction(D::VELOCITY), "", "Along z"),
    key("bodies[].spin", K::Table, "", "Rigid: prescribed angular velocity about axes through its centre or point, by components"),
    key("bodies[].spin.x", K::TimeFunction(D::RATE), "", "About x"),
    key("bodies[].spin.y", K::TimeFunction(D::RATE), "", "About y"),
    key("bodies[].spin.z", K::TimeFunction(D::RATE), "", "About z"),
    key("bodies[].free", K::Text, "", "Rigid: axes along which it moves under contacts, gravity and its force, such as \"z\""),
    key("bodies[].free_rotation", K::Flag, "false", "Rigid box, cylinder and sphere: true lets it turn under contacts"),
    key("bodies[].mass", K::Quantity(D::MASS), "", "Rigid, required where it is free: mass, > 0"),
    key("bodies[].force", K::Table, "", "Rigid: force on it along its free axes, by components"),
    key("bodies[].force.x", K::TimeFunction(D::FORCE), "0", "Along x"),
    key("bodies[].force.y", K::TimeFunction(D::FORCE), "0", "Along y"),
    key("bodies[].force.z", K::TimeFunction(D::FORCE), "0", "Along z"),
    key("bodies[].size", K::Point(D::LENGTH), "", "Box, required there: lengths of its edges along x, y, z, > 0"),
    key("bodies[].length", K::Quantity(D::LENGTH), "", "Cylinder, required there: length, > 0; that of a bonded body lies along x"),
    key("bodies[].radius", K::Quantity(D::LENGTH), "", "Cylinder and sphere, required there: radius, > 0"),
    key("bodies[].file", K::Text, "", "Stl, required there: STL file, that of a bonded body closed; loose particles, instead of a shape: CSV file of x, y, z, radius; relative to the case file"),
    key("bodies[].unit", K::Unit(Some(D::LENGTH)), "\"m\"", "Unit of the coordinates in the file"),
    key("bodies[].particles", K::Integer, "10000", "Bonded: number of particles, 20 to 20 million; loose: at most so many, without it as many as there is room for"),
    key("bodies[].particle_radius", K::Quantity(D::LENGTH), "", "Mean particle radius, > 0; bonded: instead of their number; loose, required with a shape"),
    key("bodies[].replaces", K::Text, "", "Bonded: solid body whose tetrahedra wholly within the shape (of the group) it takes the place of; its particles fill the region that they leave, and are tied to the rest"),
    key("bodies[].dispersion", K::Quantity(D::NONE), "0.25", "(largest - smallest)/mean of the particle radii, 0 to 1; 0 where loose particles say nothing"),
    key("bodies[].seed", K::Integer, "1", "Bonded and particles: seed of the packing"),
    key("bodies[].packing", K::Text, "", "Bonded: packing made by `fractum pack` (.fpk), relative to the case file, instead of a shape"),
    key("bodies[].coordination", K::Quantity(D::NONE), "chosen to suit Poisson's ratio", "Bonded: mean number of bonds of a particle"),
    key("bodies[].convention", K::Choice(names::<Convention>), "\"interior\"", "Bonded: which particles the coordination counts: those that touch no wall, or all"),
    key("bodies[].groups", K::NamedTables, "", "Bonded and particles: further sets of its particles by name"),
    key("bodies[].groups.NAME", K::Condition, "", "Condition on the centre of a particle; the set is called BODY.NAME"),
    key("bodies[].contact", K::Table, "", "Rigid: contact with it"),
    key("bodies[].contact.friction", K::Quantity(D::NONE), "0.5", "Coulomb friction coefficient, ≥ 0"),
    key("bodies[].contact.rolling_friction", K::Quantity(D::NONE), "0", "Coefficient of rolling friction, ≥ 0: couple over normal force and reduced radius"),
    key("bodies[].contact.damping_ratio", K::Quantity(D::NONE), "0.1", "Fraction of critical damping, 0 to 1"),
    key("bodies[].contact.restitution", K::Quantity(D::NONE), "", "Coefficient of restitution, above 0 to 1, instead of the damping ratio"),

    key("ties[]", K::Tables, "", "Particles of a bonded body that follow the surface of a solid where they touch it at the start, and give it their forces"),
    key("ties[].solid", K::Text, "required", "Solid body, or mesh group of facets on the surface of one"),
    key("ties[].bonded", K::Text, "required", "Bonded body, or set of its particles"),
    key("ties[].within", K::Quantity(D::LENGTH), "a tenth of the mean particle radius", "Largest gap between particle and facet, > 0"),

    key("supports[]", K::Tables, "", "Prescribed motion of groups; one of fix, velocity, displacement per axis"),
    key("supports[].name", K::Text, "", "Name, unique among supports"),
    key("supports[].group", K::Text, "", "Mesh group of the nodes, or set of particles; required without `where`"),
    key("supports[].stages", K::Names, "all", "Stages in which it acts"),
    key("supports[].where", K::Condition, "", "Which of them, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("supports[].fix", K::Text, "", "Axes held at rest: any of x, y, z, such as \"xy\""),
    key("supports[].fix_rotation", K::Text, "", "Sets of particles only: axes about which they do not turn, such as \"xyz\""),
    key("supports[].velocity", K::Table, "", "Velocity, by components"),
    key("supports[].velocity.x", K::TimeFunction(D::VELOCITY), "", "Along x; absent leaves it free"),
    key("supports[].velocity.y", K::TimeFunction(D::VELOCITY), "", "Along y; absent leaves it free"),
    key("supports[].velocity.z", K::TimeFunction(D::VELOCITY), "", "Along z; absent leaves it free"),
    key("supports[].displacement", K::Table, "", "Displacement from the initial position, by components"),
    key("supports[].displacement.x", K::TimeFunction(D::LENGTH), "", "Along x; absent leaves it free"),
    key("supports[].displacement.y", K::TimeFunction(D::LENGTH), "", "Along y; absent leaves it free"),
    key("supports[].displacement.z", K::TimeFunction(D::LENGTH), "", "Along z; absent leaves it free"),

    key("loads[]", K::Tables, "", "Loads; one of force, traction, pressure, gravity each"),
    key("loads[].name", K::Text, "", "Name, unique among loads"),
    key("loads[].stages", K::Names, "all", "Stages in which it acts"),
    key("loads[].group", K::Text, "", "Mesh group or set of particles; required without `where`, but for gravity, which acts on the whole scene"),
    key("loads[].where", K::Condition, "", "Which nodes or particles, by their positions at the start, and which facets, by all of their nodes; without `group`: which of all solid bodies"),
    key("loads[].force", K::Table, "", "Total force over the group, by components; particles share it by their cross-sections"),
    key("loads[].force.x", K::TimeFunction(D::FORCE), "0", "Component along x"),
    key("loads[].force.y", K::TimeFunction(D::FORCE), "0", "Component along y"),
    key("loads[].force.z", K::TimeFunction(D::FORCE), "0", "Component along z"),
    key("loads[].traction", K::Table, "", "Force per area over the group's facets, by components"),
    key("loads[].traction.x", K::TimeFunction(D::PRESSURE), "0", "Component along x"),
    key("loads[].traction.y", K::TimeFunction(D::PRESSURE), "0", "Component along y"),
    key("loads[].traction.z", K::TimeFunction(D::PRESSURE), "0", "Component along z"),
    key("loads[].pressure", K::TimeFunction(D::PRESSURE), "", "Pressure that follows the group's facets; positive pushes into the solid"),
    key("loads[].gravity", K::Table, "", "Acceleration of the whole scene, by components"),
    key("loads[].gravity.x", K::TimeFunction(D::ACCELERATION), "0", "Component along x"),
    key("loads[].gravity.y", K::TimeFunction(D::ACCELERATION), "0", "Component along y"),
    key("loads[].gravity.z", K::TimeFunction(D::ACCELERATION), "0", "Component along z"),

    key("damping", K::Table, "", "Damping of solids and particles"),
    key("damping.local", K::Quantity(D::NONE), "0", "Fraction a of the unbalanced force that opposes motion, from 0 to below 1; for quasi-static runs; divides the stable step by √(1 + a)"),
    key("damping.mass", K::Quantity(D::RATE), "\"0 1/s\"", "Mass-proportional damping, ≥ 0"),
    key("damping.stiffness", K::Quantity(D::TIME), "\"0 s\"", "Stiffness-proportional damping, ≥ 0"),
    key("damping.bulk_linear", K::Quantity(D::NONE), "0", "Linear bulk viscosity, ≥ 0; for shocks"),
    key("damping.bulk_quadratic", K::Quantity(D::NONE), "0", "Quadratic bulk viscosity, ≥ 0; for shocks"),
    key("damping.tchamwa_wielgosz", K::Quantity(D::NONE), "", "φ of the scheme of Tchamwa and Wielgosz on bodies of particles, between 1 and 2: damps their highest frequencies; 1.05 to 1.3 are usual"),

    key("stages[]", K::Tables, "", "Parts of a run, one after the other, instead of [solver]: stages at rest first, then in motion"),
    key("stages[].name", K::Text, "required", "Name, unique among stages"),
    key("stages[].solver", K::Table, "required", "As [solver]; end is the time at which the stage ends, on the one clock of the run"),
    key("solver", K::Table, "", "Time and its steps; required where there are no stages"),
    key("solver.kind", K::Choice(names::<SolverKind>), "\"explicit\"", "Kind of solver: motion over time, equilibrium under a load that grows slowly, or whichever suits the scene and its loads"),
    key("solver.end", K::Quantity(D::TIME), "required", "End of the run, > 0"),
    key("solver.safety", K::Quantity(D::NONE), "0.8", "Factor on the stable time step, > 0 and at most 2; above 1 is unstable"),
    key("solver.time_step", K::Choice(names::<TimeStep>), "\"power-iteration\"", "How the stable step is found: for the whole mesh or all bonds, or rigorously by the worst element or particle"),
    key("solver.step", K::Quantity(D::TIME), "", "Explicit: fixed time step, > 0, instead of safety times the stable one; static: largest step, by default the whole run where nothing may break, else 1/50 of it"),
    key("solver.initial_overlap", K::Choice(names::<InitialOverlap>), "\"push\"", "Explicit: what touches and overlaps at the start pushes apart at once, or gives no force and touches no nearer than it starts until it has parted"),
    key("solver.control", K::Choice(names::<Control>), "\"path\" where something may break, else \"time\"", "Static only: steps of time, or of damage or a crack's opening, along the path of equilibrium through snap-back"),
    key("solver.opening", K::Table, "", "With control = \"opening\", required there: how far two groups have moved apart"),
    key("solver.opening.group", K::Text, "required", "Mesh group on one side"),
    key("solver.opening.against", K::Text, "required", "Mesh group on the other side"),
    key("solver.opening.along", K::Direction, "required", "Direction in which group moves away from against"),
    key("solver.opening.step", K::Quantity(D::LENGTH), "required", "Growth of the opening in a step, > 0"),
    key("solver.opening.end", K::Quantity(D::LENGTH), "required", "Opening at which the run ends, > 0"),
    key("solver.linear_solver", K::Choice(names::<LinearSolver>), "\"auto\"", "Static with a solid: Cholesky factorisation, conjugate gradients, or by size and reuse"),
    key("solver.tolerance", K::Quantity(D::NONE), "1e-4", "Static only: unbalanced force over the internal forces at which a step is accepted, > 0"),
    key("solver.batch", K::Choice(names::<Batch>), "\"site\"", "Static with a bonded body: what breaks between two equilibria, the bonds that every overloaded particle releases, or those of the most overloaded one"),
    key("solver.no_equilibrium", K::Choice(names::<NoEquilibrium>), "\"stop\"", "Static only: what happens where a step has no equilibrium: the run ends, or the scene moves until it has come to rest"),
    key("solver.max_steps", K::Integer, "10000", "Static only: steps after which the run ends in any case"),
    key("solver.stop_when", K::Table, "", "Ends the run once a probe has fallen below a fraction of its largest value so far"),
    key("solver.stop_when.probe", K::Text, "required", "Name of the probe"),
    key("solver.stop_when.below", K::Quantity(D::NONE), "required", "Fraction of the largest value so far, within 0 and 1"),
    key("solver.stop_when.after", K::Quantity(D::TIME), "\"0 s\"", "Not before this time"),
    key("solver.balance_warning", K::Quantity(D::NONE), "1e-3", "Energy imbalance over external work at which to warn, > 0"),
    key("solver.balance_stop", K::Quantity(D::NONE), "1e-2", "Energy imbalance over external work at which to stop, ≥ balance_warning"),

    key("probes[]", K::Tables, "", "Numbers to record; one quantity each"),
    key("probes[].name", K::Text, "required", "Name, unique among probes: letters, digits, underscores"),
    key("probes[].reaction", K::Table, "", "Sum of the support reactions on a group, or force of a rigid body on particles, in N"),
    key("probes[].reaction.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
    key("probes[].reaction.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("probes[].reaction.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
    key("probes[].reaction.about", K::Table, "", "radial and tangential only: the axis"),
    key("probes[].reaction.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].reaction.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].displacement", K::Table, "", "Mean displacement of a group's nodes or particles, in m"),
    key("probes[].displacement.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
    key("probes[].displacement.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("probes[].displacement.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
    key("probes[].displacement.about", K::Table, "", "radial and tangential only: the axis"),
    key("probes[].displacement.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].displacement.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].velocity", K::Table, "", "Mean velocity of a group's nodes or particles, in m/s"),
    key("probes[].velocity.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
    key("probes[].velocity.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("probes[].velocity.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
    key("probes[].velocity.about", K::Table, "", "radial and tangential only: the axis"),
    key("probes[].velocity.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].velocity.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].rotation", K::Table, "", "Rotation of a set of particles as a whole about an axis through its centre, for small angles, in rad"),
    key("probes[].rotation.group", K::Text, "", "Set of particles; required"),
    key("probes[].rotation.where", K::Condition, "", "Which of its particles, by their positions at the start"),
    key("probes[].rotation.along", K::Direction, "required", "Direction of the axis"),
    key("probes[].stress", K::Table, "", "Volume mean of a stress component, in Pa"),
    key("probes[].stress.group", K::Text, "required", "Mesh group of elements"),
    key("probes[].stress.component", K::Choice(names::<StressComponent>), "required", "Component; tension is positive"),
    key("probes[].stress.about", K::Table, "", "radial, tangential and radial_tangential only: the axis"),
    key("probes[].stress.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].stress.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].energy", K::Choice(names::<EnergyProbe>), "", "An entry of the energy ledger, in J"),
    key("probes[].count", K::Choice(names::<CountKind>), "", "A count"),
    key("probes[].momentum", K::Table, "", "Linear momentum of the scene, in kg m/s"),
    key("probes[].momentum.along", K::Direction, "required", "Direction"),
    key("probes[].angular_momentum", K::Table, "", "Angular momentum of the scene about the origin, in kg m^2/s"),
    key("probes[].angular_momentum.along", K::Direction, "required", "Direction"),
    key("probes[].crack_area", K::Flag, "", "true records the area of the cracks, in m^2"),
    key("probes[].crack", K::Table, "", "How a crack lies: its edges that have lost half of their strength, and its broken bonds; not a number before there are any"),
    key("probes[].crack.measure", K::Choice(names::<CrackMeasure>), "required", "Angle between the direction and the plane of the crack (its line in 2D), in rad; or position of its centre or its foremost edge or bond along the direction, in m; or the angle of the helix to its axis, or of the cone's flank to the plane across its axis, in rad; or the part of the crack that lies on that cone"),
    key("probes[].crack.along", K::Direction, "required", "Direction"),
    key("probes[].crack.point", K::Point(D::LENGTH), "[0, 0, 0]", "helix, cone and cone_share only: a point of the axis; for a cone the one in the surface, with the direction out of it"),
    key("probes[].crack.where", K::Condition, "", "Which edges and bonds count, by their middles; absent means all"),
    key("probes[].expression", K::ProbeExpression, "", "Expression of t and probes above it; max, min, absmax, mean, final, time_of_max, front_speed (of a probe) and at(probe, time) make it one number at the end of the run"),
    key("probes[].unit", K::Unit(None), "from the expression", "Expression only: its SI unit; required where a factor without unit leaves it open"),

    key("output", K::Table, "", "What is written, and how often"),
    key("output.fields", K::Table, "", "Fields for ParaView"),
    key("output.fields.every", K::Quantity(D::TIME), "1/50 of the run", "Time between fields, > 0"),
    key("output.history", K::Table, "", "Rows of history.csv"),
    key("output.history.every", K::Quantity(D::TIME), "1/1000 of the run", "Time between rows, > 0"),
    key("output.checkpoint", K::Table, "", "Checkpoints to resume from"),
    key("output.checkpoint.every", K::Quantity(D::TIME), "\"10 min\"", "Wall time between checkpoints, > 0"),
    key("output.fragments", K::Table, "", "What counts as a fragment"),
    key("output.fragments.joined_below", K::Quantity(D::NONE), "0.95", "Edges join a fragment while the share of their strength that they have lost is below this, within 0 and 1"),

    key("expect[]", K::Tables, "", "Reference values for `fractum verify`: value and tolerance, or above and below"),
    key("expect[].quantity", K::Text, "required", "A probe, or a path into summary.json such as energy.residual_max_relative"),
    key("expect[].value", K::AnyQuantity, "", "Reference value"),
    key("expect[].tolerance", K::AnyQuantity, "", "Required with value: \"5 %\" of it, or a difference in its unit"),
    key("expect[].above", K::AnyQuantity, "", "Lower limit, instead of value"),
    key("expect[].below", K::AnyQuantity, "", "Upper limit, instead of value"),
    key("expect[].source", K::Text, "required", "Where the reference comes from"),
    key("expect[].note", K::Text, "", "Remark"),

    key("verify", K::Table, "", "How `fractum verify` takes this case"),
    key("verify.quick", K::Flag, "false", "Run with --quick too"),

    key("TIME_FUNCTION", K::Table, "", "Table form of any time function: one of ramp, smooth_ramp, table, pulse"),
    key("TIME_FUNCTION.ramp", K::Points, "", "Pairs of time and value joined by straight lines, constant outside"),
    key("TIME_FUNCTION.smooth_ramp", K::Points, "", "Pairs of time and value joined by quintic steps, smooth to the second derivative"),
    key("TIME_FUNCTION.table", K::Text, "", "CSV file of two columns, time and value, relative to the case file; joined by straight lines"),
    key("TIME_FUNCTION.time_unit", K::Unit(Some(D::TIME)), "\"s\"", "Table only: unit of the first column"),
    key("TIME_FUNCTION.value_unit", K::Unit(None), "SI", "Table only: unit of the second column"),
    key("TIME_FUNCTION.pulse", K::Choice(pulses), "", "A pulse by name"),
    key("TIME_FUNCTION.peak", K::AnyQuantity, "", "Pulse, required there: largest value"),
    key("TIME_FUNCTION.start", K::Quantity(D::TIME), "\"0 s\"", "Pulse: its begin; zero before"),
    key("TIME_FUNCTION.duration", K::Quantity(D::TIME), "", "Triangle and half-sine, required there: time from begin to end, > 0"),
    key("TIME_FUNCTION.rise", K::Quantity(D::TIME), "half the duration", "Triangle only: time from begin to peak, 0 to duration"),
    key("TIME_FUNCTION.rise_time", K::Quantity(D::TIME), "", "Double-exponential, required there: time from begin to peak, > 0"),
    key("TIME_FUNCTION.decay_time", K::Quantity(D::TIME), "", "Double-exponential, required there: time from the peak to 1/e of it, above 2.1462 rise_time"),
];

fn bond_criteria() -> Vec<&'static str> {
    FractureCriterion::KINDS.iter().map(|kind| kind.name).collect()
}

fn softenings() -> Vec<&'static str> {
    vec!["exponential", "linear", "bilinear"]
}

fn distributions() -> Vec<&'static str> {
    vec!["weibull", "uniform"]
}

fn body_kinds() -> Vec<&'static str> {
    vec!["solid", "bonded", "particles", "rigid"]
}

fn shapes() -> Vec<&'static str> {
    vec!["plane", "box", "cylinder", "sphere", "group", "stl"]
}

fn pulses() -> Vec<&'static str> {
    vec!["triangle", "half-sine", "double-exponential"]
}
