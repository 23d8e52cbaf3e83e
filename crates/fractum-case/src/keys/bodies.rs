//! Mesh, materials, bodies, ties.

use fractum_dem::criterion::EndMoments;
use fractum_dem::{FractureCriterion, InterfaceFailure};
use fractum_fem::{CriterionKind, Formulation, Kinematics, Plane};
use fractum_pack::{Arrangement, Convention};

use super::{key, names};
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::model::{BondLawKind, Rows};
use crate::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("fractum", K::Integer, "required", "Version of the case format: 1"),
    key("title", K::Text, "", "Title of reports"),
    key("parameters", K::NamedTables, "", "Named quantities for use in any quantity or expression; `--set NAME=value` overrides them"),
    key("parameters.NAME", K::AnyQuantity, "", "A quantity, or an expression of parameters above it"),
    key("mesh", K::Table, "", "The mesh; required by bodies of mesh groups"),
    key("mesh.file", K::Text, "required", "Gmsh (.msh), Abaqus (.inp) or VTK (.vtu) file, relative to the case file"),
    key("mesh.parts", K::Integer, "", "Number of files of the mesh, one for each partition of Gmsh (`Mesh.PartitionSplitMeshFiles`): with file = \"rock.msh\" rock_1.msh, rock_2.msh and so on. Several processes read some files each. With parts = 1 one process reads the file itself and distributes it"),
    key("mesh.unit", K::Unit(Some(D::LENGTH)), "\"m\"", "Unit of the mesh's coordinates"),
    key("mesh.join", K::AllOrNames, "false", "Solids share nodes at the same positions: all solids, or the named ones. Nodes are joined on faces that conform, if they are nearer than a thousandth of the shortest edge"),
    key("mesh.halvings", K::Integer, "0", "How often every edge is halved after reading, 0 to 6: each time a triangle becomes 4, a tetrahedron 8; curved sides stay those of the file"),
    key("mesh.scramble", K::Table, "", "Moves inner nodes at random, which gives another mesh of the same size. It comes before refine and halvings"),
    key("mesh.scramble.share", K::Quantity(D::NONE), "required", "Largest move of a node over its shortest edge, above 0 and at most 0.5; nodes on sides, between groups and at poor elements stay"),
    key("mesh.scramble.seed", K::Integer, "1", "Seed of the random numbers, ≥ 0"),
    key("mesh.refine[]", K::Tables, "", "A zone of smaller elements, made by cutting the longest edges of triangles and tetrahedra in two; of several zones the smallest size holds. It comes before halvings, joints and grains"),
    key("mesh.refine[].where", K::Condition, "everywhere", "Condition on x, y, z: where elements become smaller. Elements around the zone are cut as far as they must be to fit"),
    key("mesh.refine[].size", K::Quantity(D::LENGTH), "required", "Longest edge in the zone, > 0; most edges become shorter, down to half of it"),
    key("mesh.refine[].rows", K::Choice(names::<Rows>), "\"break\"", "break: inner nodes of the zone then move at random and are smoothed, so that cracks find no rows of elements to follow. keep: no node moves"),
    key("mesh.refine[].seed", K::Integer, "1", "Seed of these moves, ≥ 0"),
    key("materials", K::NamedTables, "", "Materials by name"),
    key("materials.NAME", K::Table, "", "A material"),
    key("materials.NAME.density", K::Quantity(D::DENSITY), "required", "Mass density, > 0"),
    key("materials.NAME.young_modulus", K::Quantity(D::PRESSURE), "required", "Young's modulus, > 0"),
    key("materials.NAME.poisson_ratio", K::Quantity(D::NONE), "required", "Poisson's ratio, between -1 and 0.5, both excluded"),
    key("materials.NAME.bedding", K::Table, "", "Beds: young_modulus and poisson_ratio of the material hold within them, those of this table along their normal. Solids only; with damage in the smoothed formulation"),
    key("materials.NAME.bedding.normal", K::Direction, "", "Normal of the beds; required, or dip and dip_direction"),
    key("materials.NAME.bedding.dip", K::Angle, "", "Instead of normal, in space: angle of the beds against the horizontal xy-plane, from 0 to 90 deg; z points up"),
    key("materials.NAME.bedding.dip_direction", K::Angle, "", "With dip, required there: direction in which the beds go down, clockwise from y as seen from above; \"90 deg\" is x"),
    key("materials.NAME.bedding.young_modulus_normal", K::Quantity(D::PRESSURE), "required", "Young's modulus E' of a pull along the normal, > 0"),
    key("materials.NAME.bedding.poisson_ratio_normal", K::Quantity(D::NONE), "required", "Poisson's ratio ν' of a pull along the normal: contraction within the beds over stretch along the normal; between -√((1 - ν) E'/(2 E)) and +√((1 - ν) E'/(2 E))"),
    key("materials.NAME.bedding.shear_modulus_normal", K::Quantity(D::PRESSURE), "Saint-Venant's estimate", "Shear modulus G' between the beds, > 0; estimate: 1/G' = 1/E + (1 + 2 ν')/E'"),
    key("materials.NAME.bedding.tensile_strength", K::Quantity(D::PRESSURE), "that of the rock", "Tensile strength f_b across the beds, > 0 and at most damage.tensile_strength. With it cohesion and fracture_energy are required, and damage"),
    key("materials.NAME.bedding.cohesion", K::Quantity(D::PRESSURE), "", "Cohesion c_b of the planes of the beds, at least f_b tan φ; required beside tensile_strength"),
    key("materials.NAME.bedding.friction_angle", K::Angle, "\"35 deg\"", "Angle of friction φ of the planes of the beds, from 0 to below 90 deg; only beside tensile_strength"),
    key("materials.NAME.bedding.fracture_energy", K::Quantity(D::FRACTURE_ENERGY), "", "Energy per area of a crack that parts the beds, > 0 and at most damage.fracture_energy; required beside tensile_strength"),
    key("materials.NAME.damage", K::Table, "", "Softening damage; without this table the material stays elastic"),
    key("materials.NAME.damage.criterion", K::Choice(names::<CriterionKind>), "\"rankine\"", "Criterion that gives the equivalent stress, which drives damage"),
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
    key("materials.NAME.damage.scatter", K::Table, "", "Random scatter of the tensile strength"),
    key("materials.NAME.damage.scatter.distribution", K::Choice(distributions), "required", "weibull: flaws in the volume or on the free surface, the same on any mesh. weibull-per-edge, uniform-per-edge: every edge has a random factor of its own, so that finer meshes are weaker and scatter less"),
    key("materials.NAME.damage.scatter.modulus", K::Quantity(D::NONE), "", "weibull and weibull-per-edge, required there: modulus, > 0"),
    key("materials.NAME.damage.scatter.reference_volume", K::Quantity(D::VOLUME), "", "weibull, required there or reference_area: volume of the specimens of which 63 % are weaker than tensile_strength, > 0"),
    key("materials.NAME.damage.scatter.reference_area", K::Quantity(D::AREA), "", "weibull: instead, their free surface, on which all flaws lie (glass), > 0"),
    key("materials.NAME.damage.scatter.correlation_length", K::Quantity(D::LENGTH), "π E Gf/(2 f²) of a flaw of strength f", "weibull: diameter of the spot that a flaw weakens, the same for all flaws, > 0. A flaw weakens at least the element around it"),
    key("materials.NAME.damage.scatter.width", K::Quantity(D::NONE), "", "uniform-per-edge only, required there: half width around 1, within 0 and 1"),
    key("materials.NAME.damage.scatter.seed", K::Integer, "1", "Seed of the random numbers, ≥ 0"),
    key("materials.NAME.damage.reduce_strength_to_fit", K::Flag, "false", "Lower ft where an element is too large for Gf, instead of refusing it"),
    key("materials.NAME.damage.regularisation", K::Choice(regularisations), "\"none\"", "Damage as a cohesive phase field, whose cracks do not feel the mesh"),
    key("materials.NAME.damage.length", K::Quantity(D::LENGTH), "twice the element size where cracks are expected", "With regularisation: length b of the phase field, > 0, at most 0.320 (exponential), 0.353 (bilinear, default kink) or 0.455 (linear) E Gf/ft²; a crack is a band about 3 b wide"),
    key("materials.NAME.damage.unilateral", K::Flag, "by the scene", "Stiffness recovers where cracks close; default: true in smoothed bodies in motion under pressure pulses or gas whose criterion has a compressive strength, else false"),
    key("materials.NAME.damage.friction", K::Quantity(D::NONE), "", "Coefficient of friction of closed cracks, tan φ, from 0 to below 1: cracks open and close, and under pressure they slide. Without it nothing slides, and damage acts on compression too unless `unilateral`; explicit runs of smoothed bodies with local damage only"),
    key("materials.NAME.damage.rate", K::Table, "", "Strength and fracture energy by the rate of strain; explicit runs with local damage only"),
    key("materials.NAME.damage.rate.strength", K::RateCurve, "required", "Factor on tensile_strength: \"fib-2010\", \"fib-2010-first-branch\", an expression of rate, or pairs of rate and factor"),
    key("materials.NAME.damage.rate.compressive_strength", K::RateCurve, "", "Factor on compressive_strength; required where the criterion has this strength"),
    key("materials.NAME.damage.rate.fracture_energy", K::RateCurve, "1", "Factor on fracture_energy: an expression of rate, or pairs of rate and factor"),
    key("materials.NAME.damage.rate_time", K::Quantity(D::TIME), "\"0 s\"", "Time constant of the damage-rate limiter, ≥ 0; 0 is off"),
    key("materials.NAME.bonds", K::Table, "", "Beams of bonded bodies, as `fractum calibrate` writes them; without this table they are calibrated"),
    key("materials.NAME.bonds.coordination", K::Quantity(D::NONE), "required", "Coordination that the beams hold for"),
    key("materials.NAME.bonds.convention", K::Choice(names::<Convention>), "required", "Which particles the coordination counts"),
    key("materials.NAME.bonds.radius_ratio", K::Quantity(D::NONE), "required", "Beam radius over mean particle radius, within 0 and 2"),
    key("materials.NAME.bonds.young_modulus", K::Quantity(D::PRESSURE), "required", "Young's modulus of the beams, > 0"),
    key("materials.NAME.interface", K::Table, "", "Interfaces of bonded bodies with bond = \"local\" or \"local-nonlocal\"; without this table they are elastic and hold"),
    key("materials.NAME.interface.areas", K::Choice(areas), "\"cells\"", "Factor α on the area π min(r)² of an interface: by the number of neighbours, so that the cells of the particles fill the body; or 40 P/N for all, with porosity P and mean number of neighbours N"),
    key("materials.NAME.interface.area_factor", K::Quantity(D::NONE), "", "Instead: α, > 0"),
    key("materials.NAME.interface.tensile_strength", K::Quantity(D::PRESSURE), "unlimited", "Tensile strength of the interface, ≥ 0"),
    key("materials.NAME.interface.shear_strength", K::Quantity(D::PRESSURE), "unlimited", "Shear strength without pressure, ≥ 0"),
    key("materials.NAME.interface.internal_friction", K::Quantity(D::NONE), "0", "Coefficient by which pressure adds to the shear strength, ≥ 0"),
    key("materials.NAME.interface.friction", K::Quantity(D::NONE), "0.5", "Coulomb's coefficient of an interface that has separated, ≥ 0"),
    key("materials.NAME.interface.tension_softening", K::Quantity(D::NONE), "brittle", "Slope of softening in tension over that of elasticity, > 0; the energy per area is ft²d/2E (1 + 1/slope)"),
    key("materials.NAME.interface.shear_softening", K::Quantity(D::NONE), "brittle", "The same in shear, > 0"),
    key("materials.NAME.interface.failure", K::Choice(names::<InterfaceFailure>), "\"uncoupled\"", "Tension and shear damage an interface each for itself, or together"),
    key("materials.NAME.interface.crushing_stress", K::Point(D::PRESSURE), "", "Three ascending compressive stresses at which the curve of compression bends; elastic without them"),
    key("materials.NAME.interface.crushing_ratio", K::Point(D::NONE), "", "Young's modulus over the slope of the curve beyond each of them, ≥ 1"),
    key("materials.NAME.interface.damping_ratio", K::Quantity(D::NONE), "0", "Local viscous damping of the normal motion over the critical one, 0 to 1"),
    key("materials.NAME.fracture", K::Table, "", "When the bonds of bonded bodies break; without this table they hold"),
    key("materials.NAME.fracture.criterion", K::Choice(bond_criteria), "\"principal\", with a compressive_strength \"mohr-coulomb\"", "Fracture criterion: which stress is compared with the strength, and which bonds break; see the list below"),
    key("materials.NAME.fracture.tensile_strength", K::Quantity(D::PRESSURE), "required", "Tensile strength of the material, > 0; the criterion's own strengths are found by breaking three boxes in tension"),
    key("materials.NAME.fracture.criterion_strength", K::Quantity(D::PRESSURE), "", "Instead: strength of the criterion itself in tension, > 0, as `fractum calibrate --strength` writes it"),
    key("materials.NAME.fracture.compressive_strength", K::Quantity(D::PRESSURE), "none with principal, else 10 times that in tension", "In compression, above that in tension: with mohr-coulomb that of the material, for which three prisms are crushed in motion; with principal and drucker-prager that of the criterion, times the factor found in tension; with criterion_strength that of the criterion"),
    key("materials.NAME.fracture.friction_angle", K::Angle, "\"35 deg\"", "mohr-coulomb only: angle of internal friction, from 0 to below 90 deg"),
    key("materials.NAME.fracture.level", K::Integer, "1", "Over which particles stress is taken: 0 the particle, 1 those bonded to it too, 2 their partners too; not for beam and hydrostatic"),
    key("materials.NAME.fracture.moments", K::Choice(names::<EndMoments>), "\"mean\"", "beam only: which bending moment counts"),
    key("materials.NAME.fracture.scatter", K::Table, "", "Random scatter of the strength of particles by Weibull's flaws in the volume"),
    key("materials.NAME.fracture.scatter.modulus", K::Quantity(D::NONE), "required", "Weibull modulus, > 0"),
    key("materials.NAME.fracture.scatter.reference_volume", K::Quantity(D::VOLUME), "required", "Volume of the specimens of which 63 % are weaker than the strength given, > 0"),
    key("materials.NAME.fracture.scatter.correlation_length", K::Quantity(D::LENGTH), "4 particle diameters (s/f)² of a flaw of strength f, s the strength of places without a weak flaw", "Diameter of the spot that a flaw weakens, the same for all flaws, > 0. A flaw weakens at least the particle around it"),
    key("materials.NAME.fracture.scatter.seed", K::Integer, "1", "Seed of the random numbers, ≥ 0"),
    key("materials.NAME.contact", K::Table, "", "Contact of particles of this material, and of its discrete elements"),
    key("materials.NAME.contact.friction", K::Quantity(D::NONE), "0.5", "Coulomb friction coefficient, ≥ 0"),
    key("materials.NAME.contact.rolling_friction", K::Quantity(D::NONE), "0", "Coefficient of rolling friction, ≥ 0: couple over normal force and reduced radius"),
    key("materials.NAME.contact.damping_ratio", K::Quantity(D::NONE), "0.1", "Fraction of critical damping, 0 to 1"),
    key("materials.NAME.contact.restitution", K::Quantity(D::NONE), "", "Coefficient of restitution, above 0 to 1, instead of the damping ratio"),
    key("materials.NAME.contact.work_of_adhesion", K::Quantity(D::FRACTURE_ENERGY), "0", "Work of adhesion W of loose particles of the material, ≥ 0: the energy that separates a unit of area, twice the surface energy. They pull each other with 2πWR*, R* the reduced radius; of two materials the geometric mean counts"),
    key("materials.NAME.contact.young_modulus", K::Quantity(D::PRESSURE), "", "Young's modulus of the spheres in contact, > 0, instead of that of the material. Rigid bodies then feel the particles of a bonded body as spheres, too; without it, as parts of a flat face"),
    key("bodies[]", K::Tables, "required", "Bodies, at least one"),
    key("bodies[].name", K::Text, "required", "Name, unique among bodies"),
    key("bodies[].kind", K::Choice(body_kinds), "required", "Kind of the body"),
    key("bodies[].group", K::Text, "", "Solid: mesh group of its elements, may be left out where the mesh has one body; bonded group: mesh group whose volume its particles fill; rigid group: its facets"),
    key("bodies[].material", K::Text, "", "Name of its material; required except for rigid bodies. A rigid body with a material deforms in contact with particles, one without does not"),
    key("bodies[].formulation", K::Choice(names::<Formulation>), "\"smoothed\" with damage, else \"standard\"", "Solid: strain and damage on edges, or the plain element"),
    key("bodies[].kinematics", K::Choice(names::<Kinematics>), "\"auto\"", "Solid: small strains, a frame that turns with each element, or small until a part turns in motion"),
    key("bodies[].plane", K::Choice(names::<Plane>), "\"strain\"", "Solid in 2D only: plane strain, plane stress, or a section through the y axis, about which the body is turned"),
    key("bodies[].thickness", K::Quantity(D::LENGTH), "\"1 m\"", "Solid in plane strain or plane stress only: thickness, > 0"),
    key("bodies[].initial_velocity", K::Table, "", "Velocity at the start, by components; of a rigid body along its free axes"),
    key("bodies[].initial_velocity.x", K::Field(D::VELOCITY), "0", "Component along x"),
    key("bodies[].initial_velocity.y", K::Field(D::VELOCITY), "0", "Component along y"),
    key("bodies[].initial_velocity.z", K::Field(D::VELOCITY), "0", "Component along z"),
    key("bodies[].damage", K::Flag, "true", "Solid: false keeps the body elastic whatever its material says"),
    key("bodies[].damage_where", K::Condition, "", "Solid: condition on the edges that may be damaged; absent means all"),
    key("bodies[].strength_factor", K::Field(D::NONE), "1", "Solid: factor on the tensile strength, > 0"),
    key("bodies[].shape", K::Choice(shapes), "", "Rigid: the shape, required there. Bonded: the shape that particles fill, any but plane. Particles: box, cylinder or sphere, filled with a loose cloud"),
    key("bodies[].point", K::Point(D::LENGTH), "[0, 0, 0]", "Plane: a point on it; box: its lower corner; cylinder: centre of the face where it begins; sphere: its centre; rigid group and stl: point about which it turns"),
    key("bodies[].normal", K::Direction, "", "Rigid plane, required there: normal that points out of the body"),
    key("bodies[].axis", K::Direction, "\"x\"", "Cylinder, rigid or of loose particles: direction from its beginning to its end"),
    key("bodies[].ends", K::Choice(|| vec!["closed", "open"]), "\"closed\"", "Rigid cylinder: open takes the lids away. What is left is a wall without thickness, which particles feel from both sides and on its rims"),
    key("bodies[].inside", K::Flag, "false", "Rigid box, cylinder and sphere: true makes a container, which holds particles inside"),
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
    key("bodies[].servo", K::Table, "", "Rigid: it moves so that its contacts press with a given force or pressure; by one of force, pressure. Runs in motion only"),
    key("bodies[].servo.along", K::Direction, "the normal of a plane", "Direction in which it presses, along an axis; required but for planes"),
    key("bodies[].servo.force", K::TimeFunction(D::FORCE), "", "Force with which it presses, ≥ 0"),
    key("bodies[].servo.pressure", K::TimeFunction(D::PRESSURE), "", "Pressure with which it presses, ≥ 0"),
    key("bodies[].servo.area", K::Quantity(D::AREA), "the face of a box or cylinder across along", "With pressure: area that it acts on, > 0; required for other shapes without between"),
    key("bodies[].servo.between", K::Names, "", "With pressure, instead of an area: four rigid planes, each before the one opposite to it. The area is that between both pairs as they move"),
    key("bodies[].servo.speed", K::Quantity(D::VELOCITY), "required", "Largest speed, > 0"),
    key("bodies[].servo.slows_at", K::Quantity(D::NONE), "0.1", "Share of the force that is still missing where it slows down, above 0 and at most 1: the speed is proportional to what is missing from there on"),
    key("bodies[].size", K::Point(D::LENGTH), "", "Box, required there: lengths of its edges along x, y, z, > 0"),
    key("bodies[].length", K::Quantity(D::LENGTH), "", "Cylinder, required there: length, > 0; that of a bonded body lies along x"),
    key("bodies[].radius", K::Quantity(D::LENGTH), "", "Cylinder and sphere, required there: radius, > 0"),
    key("bodies[].file", K::Text, "", "Stl, required there: STL file, that of a bonded body closed; loose and bonded particles: file of particles (CSV, LAMMPS data or dump, extended xyz, YADE text), bonded ones beside the shape that they fill; relative to the case file"),
    key("bodies[].velocity_unit", K::Unit(Some(D::VELOCITY)), "", "Loose, with a file: takes the velocities of the file, in this unit, and its rotations, in 1/s; otherwise they are left out"),
    key("bodies[].frame", K::Integer, "the last", "With a file of particles, a dump or an xyz file: number of the frame, from 0 on"),
    key("bodies[].species", K::Text, "all", "With a file of particles: type or species of those that are taken"),
    key("bodies[].unit", K::Unit(Some(D::LENGTH)), "\"m\"", "Unit of the coordinates in the file"),
    key("bodies[].particles", K::Integer, "10000", "Bonded: number of particles, 20 to 20 million. Loose: largest number of particles; without it as many as fit"),
    key("bodies[].particle_radius", K::Quantity(D::LENGTH), "", "Mean particle radius, > 0; bonded: instead of their number; loose, required with a shape"),
    key("bodies[].replaces", K::Text, "", "Bonded: solid body of which it replaces the tetrahedra wholly within the shape (or group). Its particles fill the region of these tetrahedra and are tied to the rest"),
    key("bodies[].dispersion", K::Quantity(D::NONE), "0.25", "(largest - smallest)/mean of the particle radii, 0 to 1; 0 where loose particles say nothing"),
    key("bodies[].sizes", K::Table, "", "Loose: diameters of the particles of a shape, instead of particle_radius and dispersion; by one of passing, law"),
    key("bodies[].sizes.passing", K::Sieves, "", "Sieve curve: pairs of opening and share of the mass that passes, from 0 to 1; linear between them"),
    key("bodies[].sizes.law", K::Choice(size_laws), "", "uniform: as many particles of every diameter. log-normal: the logarithm of the diameter is normally distributed by mass"),
    key("bodies[].sizes.smallest", K::Quantity(D::LENGTH), "", "With a law, required there: smallest diameter, > 0"),
    key("bodies[].sizes.largest", K::Quantity(D::LENGTH), "", "With a law, required there: largest diameter, at most 100 times the smallest"),
    key("bodies[].sizes.median", K::Quantity(D::LENGTH), "", "log-normal only, required there: diameter below which half of the mass lies, before it is cut off at both ends"),
    key("bodies[].sizes.deviation", K::Quantity(D::NONE), "", "log-normal only, required there: standard deviation of the natural logarithm, above 0 and at most 2"),
    key("bodies[].solid_fraction", K::Quantity(D::NONE), "0.25", "Loose, with sizes: volume of the particles over that of the shape, above 0 and at most 0.5; instead of particles"),
    key("bodies[].seed", K::Integer, "1", "Bonded and particles: seed of the packing"),
    key("bodies[].packing", K::Text, "", "Bonded: packing made by `fractum pack` (.fpk), relative to the case file, instead of a shape"),
    key("bodies[].arrangement", K::Choice(names::<Arrangement>), "\"random\"", "Bonded box: arrangement of its particles. The regular ones have one radius, and 6 or 12 neighbours"),
    key("bodies[].bond_gap", K::Quantity(D::LENGTH), "", "Bonded, with a file of particles: joins those whose gap is below it, > 0, instead of the bonds of the file or of a coordination"),
    key("bodies[].bond", K::Choice(names::<BondLawKind>), "\"cohesive-beam\"", "Bonded: law of the bonds. cohesive-beam: beams calibrated on the packing. local: interfaces with the numbers of the material. local-nonlocal: such interfaces beside the mean strain of their particles, so that the body has the elasticity of the material"),
    key("bodies[].coordination", K::Quantity(D::NONE), "chosen to suit Poisson's ratio", "Bonded: mean number of bonds of a particle"),
    key("bodies[].convention", K::Choice(names::<Convention>), "\"interior\"", "Bonded: which particles the coordination counts: those that touch no wall, or all"),
    key("bodies[].groups", K::NamedTables, "", "Bonded and particles: further sets of its particles by name"),
    key("bodies[].groups.NAME", K::Condition, "", "Condition on the centre of a particle; the set is called BODY.NAME"),
    key("bodies[].contact", K::Table, "", "Rigid: contact with it. Keys that are absent have the values of its material, if it has one"),
    key("bodies[].contact.friction", K::Quantity(D::NONE), "0.5", "Coulomb friction coefficient, ≥ 0; that of its material where it has one"),
    key("bodies[].contact.rolling_friction", K::Quantity(D::NONE), "0", "Coefficient of rolling friction, ≥ 0: couple over normal force and reduced radius; that of its material where it has one"),
    key("bodies[].contact.damping_ratio", K::Quantity(D::NONE), "0.1", "Fraction of critical damping, 0 to 1; that of its material where it has one"),
    key("bodies[].contact.work_of_adhesion", K::Quantity(D::FRACTURE_ENERGY), "0", "Work of adhesion, ≥ 0, as in materials; that of its material where it has one"),
    key("bodies[].contact.restitution", K::Quantity(D::NONE), "", "Coefficient of restitution, above 0 to 1, instead of the damping ratio"),
    key("ties[]", K::Tables, "", "Particles of a bonded body that follow the surface of a solid where they touch it at the start, and give it their forces"),
    key("ties[].solid", K::Text, "required", "Solid body, or mesh group of facets on the surface of one"),
    key("ties[].bonded", K::Text, "required", "Bonded body, or set of its particles"),
    key("ties[].within", K::Quantity(D::LENGTH), "a tenth of the mean particle radius", "Largest gap between particle and facet, > 0"),
];

fn bond_criteria() -> Vec<&'static str> {
    FractureCriterion::KINDS.iter().map(|kind| kind.name).collect()
}

fn softenings() -> Vec<&'static str> {
    vec!["exponential", "linear", "bilinear"]
}

fn regularisations() -> Vec<&'static str> {
    vec!["none", "phase-field"]
}

fn areas() -> Vec<&'static str> {
    vec!["cells", "porosity"]
}

fn distributions() -> Vec<&'static str> {
    vec!["weibull", "weibull-per-edge", "uniform-per-edge"]
}

fn size_laws() -> Vec<&'static str> {
    super::SIZE_LAWS.to_vec()
}

fn body_kinds() -> Vec<&'static str> {
    vec!["solid", "bonded", "particles", "rigid"]
}

fn shapes() -> Vec<&'static str> {
    vec!["plane", "box", "cylinder", "sphere", "group", "stl"]
}
