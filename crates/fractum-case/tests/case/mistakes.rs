//! Wrong cases, and what is said about them.

use std::path::Path;

use fractum_case::model::Motion;
use fractum_case::{Severity, read_case};

use crate::{SMALL, folder, parse};

/// Everything wrong with `text`, each without the name of the file.
pub(crate) fn mistakes(text: &str) -> Vec<String> {
    let errors = parse(text, &[]).expect_err(text);
    let file = format!("{}:", folder().join("case.toml").display());
    let errors = errors.0.iter().filter(|found| found.severity == Severity::Error);
    errors.map(|error| error.to_string().replacen(&file, "", 1)).collect()
}

/// A case without a mesh.
const BONDED: &str = r#"fractum = 1
[materials.glass]
density = 2500
young_modulus = 72e9
poisson_ratio = 0.23
[[bodies]]
name = "bar"
kind = "bonded"
material = "glass"
shape = "box"
size = [3, 1, 1]
[solver]
end = 1e-3
"#;

#[test]
fn rigid_bodies_alone_are_told_what_is_missing() {
    let ball = |name: &str, x: u8| {
        format!(
            "[[bodies]]\nname = \"{name}\"\nkind = \"rigid\"\nshape = \"sphere\"\npoint = [{x}, 0, 0]\nradius = 1\n"
        )
    };
    let found = mistakes(&format!("fractum = 1\n{}{}[solver]\nend = 1e-3\n", ball("a", 0), ball("b", 5)));
    let [only] = found.as_slice() else { panic!("{found:?}") };
    assert!(only.contains("bodies: all are rigid, and rigid bodies do not touch each other"), "{only}");
}

#[test]
fn each_mistake_about_a_bonded_body_has_one_clear_message() {
    assert_eq!(parse(BONDED, &[]).unwrap().mesh, None);
    let beams = "poisson_ratio = 0.23\nbonds = { coordination = 8, convention = \"all\", radius_ratio = 0.4, young_modulus = 1e9 }";
    let cases: &[(&str, &str, &str)] = &[
        (
            "fractum = 1",
            "fractum = 1\n[mesh]\nfile = \"bar.msh\"",
            "2:2: mesh has no effect where no body is made of a mesh group; remove it",
        ),
        (
            "shape = \"box\"",
            "shape = \"bx\"",
            "10:9: bodies[0].shape = \"bx\"; expected \"box\", \"cylinder\", \"sphere\", \"group\" or \"stl\"; did you mean \
             \"box\"?",
        ),
        (
            "size = [3, 1, 1]",
            "",
            "6:1: bodies[0].size is missing; expected three numbers, of discs two, each a length such as \"12 mm\"",
        ),
        ("size = [3, 1, 1]", "size = [3, 0, 1]", "11:8: bodies[0].size = [3, 0, 1]; expected three lengths above 0"),
        (
            "size = [3, 1, 1]",
            "size = [3, 1, 1]\nradius = 1",
            "12:1: bodies[0].radius has no effect on the shape \"box\"; remove it",
        ),
        (
            "size = [3, 1, 1]",
            "size = [3, 1, 1]\ngroups = { \"a\\u0007\" = \"x > 1\" }",
            "12:12: bodies[0].groups.a\\u{7} is a name with control characters",
        ),
        (
            "size = [3, 1, 1]",
            "size = [3, 1, 1]\ndispersion = 1.2",
            "12:14: bodies[0].dispersion = 1.2; expected from 0 to 1 (0.25 is usual; packings below 0.15 tend to order)",
        ),
        (
            "size = [3, 1, 1]",
            "size = [3, 1, 1]\nparticles = 3",
            "12:13: bodies[0].particles = 3; expected 20 to 20 million",
        ),
        (
            "size = [3, 1, 1]",
            "size = [3, 1, 1]\nparticles = 300\nparticle_radius = 0.1",
            "12:1: bodies[0].particles has no effect beside particle_radius, from which the number follows; remove it",
        ),
        (
            "size = [3, 1, 1]",
            "size = [3, 1, 1]\nformulation = \"smoothed\"",
            "12:1: bodies[0].formulation has no effect on a bonded body; remove it",
        ),
        (
            "shape = \"box\"\nsize = [3, 1, 1]",
            "packing = \"no.fpk\"",
            "10:11: bodies[0].packing = \"no.fpk\" cannot be opened: No such file or directory (os error 2); paths are taken \
             from the folder of the case file",
        ),
        (
            "shape = \"box\"\nsize = [3, 1, 1]",
            "packing = \"old.fpk\"\nseed = 3",
            "11:1: bodies[0].seed has no effect beside a packing made before; remove it",
        ),
        (
            "[solver]",
            "[solver]\nkind = \"static\"\nlinear_solver = \"direct\"",
            "14:1: solver.linear_solver has no effect where no body is a solid: bonds are solved by conjugate gradients; \
             remove it",
        ),
        (
            "poisson_ratio = 0.23",
            "poisson_ratio = 0.23\nbonds = { coordination = 8 }",
            "6:9: materials.glass.bonds.convention is missing; expected \"interior\" or \"all\"",
        ),
    ];
    for (from, to, message) in cases {
        let found = mistakes(&BONDED.replacen(from, to, 1));
        assert!(found.iter().any(|found| found == message), "{to}:\n{message}\n{found:#?}");
    }
    let twice = BONDED.replacen("poisson_ratio = 0.23", beams, 1).replacen("size", "coordination = 7\nsize", 1);
    let found = mistakes(&twice);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0].ends_with("coordination has no effect beside the bonds of its material, which have one; remove it")
    );
}

#[test]
fn mistakes_in_blasts_are_told_where_they_stand() {
    let pulses = "end = 1e-3\n[pulses]\ncut = 1e6\n[[loads]]\n";
    let cases: &[(&str, &str)] = &[
        (
            "firing = [[\"a\", 0, \"cot\"]]",
            "18:20: loads[0].firing[0][2] = \"cot\"; expected the name of a pulse of [pulses]; did you mean \"cut\"?",
        ),
        ("firing = [[\"a\", -1, \"cut\"]]", "18:17: loads[0].firing[0][1] = -1; expected a delay of at least 0"),
        (
            "firing = [[\"a\", 0]]",
            "18:11: loads[0].firing[0] = [\"a\", 0]; expected a row such as [\"hole-1\", \"25 ms\", \"contour\"]: group, delay, pulse",
        ),
        (
            "firing = []",
            "18:10: loads[0].firing = []; expected rows of group, delay and pulse, or the name of a CSV file of them",
        ),
        (
            "firing = [[\"a\", 0, \"cut\"]]\ngroup = \"a\"",
            "19:1: loads[0].group has no effect with firing, whose rows name the groups; remove it",
        ),
        (
            "firing = [[\"a\", 0, \"cut\"]]\nscatter = {}",
            "19:11: loads[0].scatter scatters nothing; expected a deviation, such as \"1 ms\", or relative, such as \"2 %\"",
        ),
        (
            "firing = [[\"a\", 0, \"cut\"]]\ndetonation = { velocity = 4000 }",
            "19:14: loads[0].detonation does not say where the front begins; expected along, the direction in which it runs through the hole, or primer, \
             the point where it begins",
        ),
        (
            "firing = [[\"a\", 0, \"cut\"]]\nin_cracks = true\ndetonation = { velocity = 4000, along = \"x\" }",
            "20:1: loads[0].detonation has no effect with in_cracks, whose cracks have the pressure of all facets; remove it",
        ),
        (
            "group = \"a\"\npressure = 1\nscatter = { deviation = 1 }",
            "20:1: loads[0].scatter has no effect without firing, whose delays it is of; remove it",
        ),
        (
            "gravity = { x = 1 }\n[in_situ]\nstress = {}",
            "20:10: in_situ.stress has no component; expected at least one of xx, yy, zz, xy, yz, zx",
        ),
        (
            "gravity = { x = 1 }\n[in_situ]\ngroups = [\"a\"]",
            "19:1: in_situ.stress is missing; expected a table such as { xx = \"-5 MPa\", yy = \"-8 MPa\" }",
        ),
        (
            "gravity = { x = 1 }\n[in_situ]\nstress = { xx = 1 }\nsettle = true",
            "21:10: in_situ.settle has no effect without layers; expected in_situ.layers; the stress of a far field is always that of solids that have settled",
        ),
        (
            "gravity = { x = 1 }\n[in_situ]\nstress = { xx = 1 }\ngroups = \"a\"",
            "21:10: in_situ.groups = \"a\"; expected a list of names of mesh groups",
        ),
        (
            "gravity = { x = 1 }\n[[supports]]\ngroup = \"a\"\nabsorbing = true\nfix = \"x\"",
            "19:1: supports[0].absorbing stands beside fix; give each its own [[supports]]",
        ),
        (
            "gravity = { x = 1 }\n[[supports]]\ngroup = \"a\"\nelastic = { normal = 0 }",
            "21:11: supports[0].elastic has no stiffness; expected normal or tangential above 0",
        ),
    ];
    for (to, message) in cases {
        assert_eq!(mistakes(&SMALL.replacen("end = 1e-3", &format!("{pulses}{to}"), 1)), [*message], "{to}");
    }
}

#[test]
fn each_mistake_has_one_clear_message() {
    let cases: &[(&str, &str, &str)] = &[
        // what is replaced, by what, message
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.62",
            "7:17: materials.steel.poisson_ratio = 0.62; expected between -1 and 0.5",
        ),
        ("density = 7800", "densty = 7800", "5:1: materials.steel.densty is not a key; did you mean density?"),
        ("density = 7800", "", "4:1: materials.steel.density is missing; expected a density such as \"2400 kg/m^3\""),
        ("density = 7800", "density = -1", "5:11: materials.steel.density = -1; expected more than 0"),
        (
            "density = 7800",
            "density = 1e-300",
            "5:11: materials.steel.density = 1e-300; expected from 1e-30 to 1e30 in SI units",
        ),
        (
            "name = \"bar\"",
            "name = \"a\\u001b[31m\"",
            "9:8: bodies[0].name = \"a\\u001b[31m\"; expected a text of one line without control characters",
        ),
        (
            "fractum = 1",
            "fractum = 1\ntitle = \"a\\tb\"",
            "2:9: title = \"a\\tb\"; expected a text of one line without control characters",
        ),
        ("density = 7800", "density = inf", "5:11: materials.steel.density = inf; expected a finite number"),
        (
            "density = 7800",
            "density = true",
            "5:11: materials.steel.density = true; expected a density such as \"2400 kg/m^3\"",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"210 mm\"",
            "6:17: materials.steel.young_modulus = \"210 mm\", which is a length; expected a pressure such as \"21 \
             GPa\"",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"210 Gpa\"",
            "6:22: materials.steel.young_modulus = \"210 Gpa\": \"Gpa\" is not a unit; did you mean \"GPa\"?",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"2*E1\"",
            "6:20: materials.steel.young_modulus = \"2*E1\": unknown name \"E1\"; names here: pi",
        ),
        ("end = 1e-3", "end = 1e-3\nsafty = 0.5", "15:1: solver.safty is not a key; did you mean safety?"),
        (
            "end = 1e-3",
            "end = 1e-3\ndomain = { min = [0, 0, 0], max = [1, 0, 1] }",
            "15:10: solver.domain has a min that is not below its max; expected min < max on every axis",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\nqqqqqq = 0.5",
            "15:1: solver.qqqqqq is not a key; keys here: kind, end, safety, time_step, step, subcycling, initial_overlap, domain, control, \
             opening, linear_solver, tolerance, batch, no_equilibrium, max_steps, count, stop_when, \
             accuracy, accuracy_runs, balance_warning, balance_stop",
        ),
        (
            "kind = \"solid\"",
            "kind = \"sold\"",
            "10:8: bodies[0].kind = \"sold\"; expected \"solid\", \"bonded\", \"particles\" or \
             \"rigid\"; did you mean \"solid\"?",
        ),
        (
            "material = \"steel\"",
            "material = \"stel\"",
            "12:12: bodies[0].material = \"stel\" is not a material of this case; did you mean \"steel\"?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\", \"stel\"]\nfriction = 0.3",
            "16:21: contact_pairs[0].between[1] = \"stel\" is not a material of this case; did you mean \"steel\"?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\"]\nfriction = 0.3",
            "16:11: contact_pairs[0].between names 1 material; expected two materials, or one twice for bodies of the same material",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nfriction = 0.3",
            "15:1: contact_pairs[0].between is missing; expected two materials, or one twice for bodies of the same material",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\", \"steel\"]",
            "15:1: contact_pairs[0].friction is missing; expected one at least of friction, rolling_friction, restitution, damping_ratio, work_of_adhesion",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\", \"steel\"]\nfricton = 0.3",
            "17:1: contact_pairs[0].fricton is not a key; did you mean friction?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\", \"steel\"]\nfriction = -0.3",
            "17:12: contact_pairs[0].friction = -0.3; expected at least 0",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\", \"steel\"]\nrestitution = 0.9\ndamping_ratio = 0.1",
            "18:1: contact_pairs[0].damping_ratio has no effect beside restitution, from which it follows; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[contact_pairs]]\nbetween = [\"steel\", \"steel\"]\nfriction = 0.3\n[[contact_pairs]]\nbetween = [\"steel\", \"steel\"]\nrestitution = 0.9",
            "18:1: contact_pairs[1]: \"steel\" and \"steel\" have their coefficients at line 15, in whatever order; write them into one table",
        ),
        ("fractum = 1", "fractum = 2", "1:11: fractum = 2; expected 1, the version this program reads"),
        ("fractum = 1", "", "fractum is missing; expected a whole number"),
        ("end = 1e-3", "", "13:1: solver.end is missing; expected a time such as \"0.2 ms\""),
        ("file = \"bar.msh\"", "file = \"bar.msh\"\nparts = 0", "4:9: mesh.parts = 0; expected 1 to 65536"),
        ("file = \"bar.msh\"", "file = \"\"", "3:8: mesh.file = \"\"; expected a text that is not empty"),
        (
            "end = 1e-3",
            "end = 1e-3\n[[suports]]\ngroup = \"a\"\nfix = \"x\"",
            "15:3: suports is not a key; did you mean supports?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nfix = \"xx\"",
            "17:7: supports[0].fix = \"xx\"; expected each of x, y, z at most once, such as \"xy\"",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nfix = \"xy\"\nvelocity = { y = 1 }",
            "18:18: supports[0].velocity.y moves an axis that this support already moves; name each axis once among \
             fix, velocity, displacement",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"",
            "15:1: supports[0] prescribes no motion; expected one of fix, velocity, displacement, absorbing, elastic",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nfix = \"x\"\n[[supports]]\ngroup = \"a\"\nfix = \"xy\"",
            "20:7: supports[1].fix moves group \"a\" along x too; the support at line 17 already does",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nvelocity.x = { ramp = [[0, 0], [0, 1]] }",
            "17:32: supports[0].velocity.x.ramp[1] = [0, 1]; expected a time after 0 s, that of the pair before it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nvelocity.x = { ramp = [[0, 0]], peak = 1 }",
            "17:33: supports[0].velocity.x.peak has no effect with ramp; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\npressure = 1\nforce.x = 1",
            "17:12: loads[0].pressure stands beside force; expected exactly one of force, traction, pressure, gravity, firing",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\ngravity.x = 1",
            "16:1: loads[0].group has no effect with gravity, which acts on the whole scene; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\npressure = \"1 MPa + 2 N\"",
            "17:19: loads[0].pressure = \"1 MPa + 2 N\": a pressure and a force cannot be added or compared",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\npressure = \"1000*9.81*y\"",
            "17:12: loads[0].pressure = \"1000*9.81*y\", which is a length; expected a pressure such as \"21 GPa\"; \
             in a product a number without a unit is a pure number; give it its unit",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, friction_angle = 0.5 }",
            "8:55: materials.steel.damage.friction_angle has no effect with this criterion; remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, tension_cutoff = true }",
            "8:55: materials.steel.damage.tension_cutoff has no effect with this criterion, only with mohr-coulomb; \
             remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, criterion = \"mohr-coulomb\", \
             friction_angle = \"30 deg\", compressive_strength = 2.9 }",
            "8:133: materials.steel.damage.compressive_strength is 2.9 Pa as compressive strength, too low for its \
             friction angle; expected at least 3 Pa; raise compressive_strength or lower friction_angle",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, length = 1 }",
            "8:55: materials.steel.damage.length has no effect without regularisation; remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, rate_time = 1, \
             regularisation = \"phase-field\" }",
            "8:55: materials.steel.damage.rate_time has no effect with a phase field, whose energy it would raise; remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, rate = { strength = 2 }, \
             regularisation = \"phase-field\" }",
            "8:55: materials.steel.damage.rate has no effect with a phase field, whose edges have no strength of their own; remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, rate = { strength = [[1, 1], [1, 2]] } }",
            "8:84: materials.steel.damage.rate.strength[1] = [1, 2]; expected a rate above that of the pair before it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, rate = { strength = \"fib-2010\", fracture_energy = \"fib-2010\" } }",
            "8:105: materials.steel.damage.rate.fracture_energy = \"fib-2010\"; expected pairs of rate and factor, or an expression of rate; \
             the standard gives strengths alone; without the key the energy stays as it is",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, rate = { strength = 2, compressive_strength = 2 } }",
            "8:78: materials.steel.damage.rate.compressive_strength has no effect with this criterion, which has no strength in compression; \
             remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, crack_plane_gate = true }",
            "8:55: materials.steel.damage.crack_plane_gate is not a key; the crack-plane gate is gone; remove the key, and where \
             cracks follow rows of the mesh take another one or set regularisation = \"phase-field\"",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"2*GPa\"",
            "6:20: materials.steel.young_modulus = \"2*GPa\": unknown name \"GPa\"; a unit stands right behind its \
             number, as in 2 mm",
        ),
        (
            "material = \"steel\"",
            "material = \"steel\"\ndamage_where = \"x < 1\"",
            "13:1: bodies[0].damage_where has no effect without damage; remove it",
        ),
        (
            "material = \"steel\"",
            "material = \"steel\"\nshape = \"plane\"",
            "13:1: bodies[0].shape has no effect on a solid body; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[probes]]\nname = \"a\"\nexpression = \"b\"\n[[probes]]\nname = \"b\"\nexpression = \"a\"",
            "17:15: probes[0].expression = \"b\": probe \"b\" must be declared above this one",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[probes]]\nname = \"a\"\ncount = \"fragment\"",
            "17:9: probes[0].count = \"fragment\"; expected \"removed_elements\", \"broken_edges\", \"damaged_edges\", \
             \"particles\", \"fragments\", \"contacts\", \"bonds\", \"broken_bonds\", \"entered_particles\", \
             \"waiting_particles\" or \"left_pieces\"; did you mean \"fragments\"?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[probes]]\nname = \"a b\"\ncrack_area = true",
            "16:8: probes[0].name is not a name an expression can use; begin with a letter and go on with letters, \
             digits and underscores",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[expect]]\nquantity = \"energy.resid_max_relative\"\nbelow = 1\nsource = \"s\"",
            "16:12: expect[0].quantity = \"energy.resid_max_relative\" is neither a probe nor a path of \
             summary.json; did you mean \"energy.residual_max_relative\"?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[expect]]\nquantity = \"time.end\"\nvalue = \"1 mm\"\ntolerance = \"1 %\"\nsource = \"s\"",
            "17:9: expect[0].value = \"1 mm\", which is a length; expected a time such as \"0.2 ms\"",
        ),
        (
            "kind = \"solid\"\ngroup = \"bar\"\nmaterial = \"steel\"",
            "kind = \"rigid\"\nshape = \"plane\"\nnormal = [0, 0, 0]",
            "12:10: bodies[0].normal = [0, 0, 0]; \
             expected an axis such as \"x\" or \"-y\", or three numbers that are not all zero",
        ),
        (
            "[solver]",
            "[damping]\nlocal = 0.5\n[solver]\nkind = \"static\"",
            "14:1: damping.local has no effect with solver.kind = \"static\", where nothing moves fast; remove it",
        ),
        (
            "[solver]",
            "[solver]\nkind = \"static\"\nbatch = \"one\"",
            "15:1: solver.batch has no effect where no body is bonded; remove it",
        ),
        (
            "[solver]",
            "[solver]\nbatch = \"one\"",
            "14:1: solver.batch has no effect with kind = \"explicit\"; remove it",
        ),
        (
            "kind = \"solid\"\ngroup = \"bar\"\nmaterial = \"steel\"",
            "kind = \"particles\"\nmaterial = \"steel\"",
            "8:1: bodies[0] has none of shape, file and centre; expected a shape to fill with particles, a file of particles, or the centre of a single one",
        ),
    ];
    for (old, new, expected) in cases {
        assert!(SMALL.contains(old), "{old}");
        let found = mistakes(&SMALL.replacen(old, new, 1));
        let found: Vec<_> = found.iter().map(|message| message.trim_start_matches(' ').to_string()).collect();
        assert_eq!(found, [expected.to_string()], "{new}");
    }
}

#[test]
fn a_parameter_named_like_a_unit_never_changes_a_quantity() {
    let with = |text: &str| SMALL.replace("[mesh]", "[parameters]\nm = \"3 m\"\n[mesh]").replace("end = 1e-3", text);
    let use_of_unit = "end = 1e-3\n[[loads]]\ngroup = \"a\"\nforce.x = ";
    for quantity in ["\"2 kN m/m\"", "\"2 kN*m/m\"", "\"2 kN/(m/m)\""] {
        let found = mistakes(&with(&format!("{use_of_unit}{quantity}")));
        let refused = |found: &String| found.contains("\"m\" is a unit and also a name of this case; rename");
        assert!(found.iter().any(refused), "{found:?}");
    }
    let rate = mistakes(&with("end = 1e-3\n[damping]\nmass = \"50 1/m\""));
    assert!(rate.iter().any(|found| found.contains("\"m\" is a unit and also a name of this case")), "{rate:?}");
    let case = parse(&with("end = 1e-3\n[[supports]]\ngroup = \"a\"\ndisplacement.x = \"2*m*t/1 s\""), &[]).unwrap();
    let Some(Motion::Displacement(moved)) = case.supports[0].motion[0].as_ref().map(|motion| &motion.value) else {
        panic!()
    };
    assert_eq!(moved.value(1.0, fractum_math::Vec3::zeros()), 6.0, "outside of quantities it is the parameter");
}

#[test]
fn a_wrong_key_of_a_body_has_no_second_message() {
    let particles = "kind = \"particles\"\nmaterial = \"steel\"\nshape = \"box\"\nsize = [1, 1, 1]\nparticle_radius = 0.1\n\
                     initial_velocity.x = 1\nparticles = 10\ndispersion = 0.1\nseed = 3";
    let rigid = "kind = \"rigid\"\nshape = \"box\"\nsize = [1, 1, 1]\npoint = [0, 0, 0]\nfree = \"x\"\nmass = 1\ninitial_velocity.x = 1";
    for body in [particles, rigid] {
        let text = SMALL.replace("kind = \"solid\"\ngroup = \"bar\"\nmaterial = \"steel\"", body);
        for line in body.lines().filter(|line| !line.starts_with("kind")) {
            let key = line.split(' ').next().unwrap();
            let found = mistakes(&text.replacen(line, &format!("{key} = \"?\""), 1));
            assert!(
                found.len() == 1 && found[0].contains(&format!("bodies[0].{}", key.trim_end_matches(".x"))),
                "{key}: {found:#?}"
            );
        }
    }
    let both = rigid.replace("point = [0, 0, 0]", "point = [0, 0, 0]\nvelocity.x = 1\nforce.y = 2");
    let found = mistakes(&SMALL.replace("kind = \"solid\"\ngroup = \"bar\"\nmaterial = \"steel\"", &both));
    assert!(
        found.iter().any(|found| found.contains("bodies[0].velocity.x prescribes what free releases")),
        "{found:#?}"
    );
    assert!(
        found.iter().any(|found| found.contains("bodies[0].force.y acts along an axis that is held")),
        "{found:#?}"
    );
}

#[test]
fn all_mistakes_are_reported_at_once_and_in_order() {
    let text = SMALL.replace("7800", "\"7800 kg\"").replace("0.3", "0.7").replace("1e-3", "0").replace("bar.msh", " ");
    let lines: Vec<_> =
        parse(&text, &[]).unwrap_err().0.iter().map(|error| error.place.as_ref().unwrap().line).collect();
    assert_eq!(lines, [3, 5, 7, 14]);
}

#[test]
fn many_warnings_do_not_silence_the_suggestions_for_a_mistake() {
    let material = |i: usize| format!("[materials.m{i}]\ndensity = 2.4\nyoung_modulus = 210e9\npoisson_ratio = 0.3\n");
    let doubted: String = (0..25).map(material).collect();
    let text = SMALL
        .replace("[[bodies]]", &format!("{doubted}[[bodies]]"))
        .replace("material = \"steel\"", "material = \"stel\"");
    let found = mistakes(&text);
    assert!(found.len() == 2 && found[0].ends_with("did you mean \"steel\"?"), "{found:#?}");
}

#[test]
fn files_that_are_no_cases_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("case.toml");
    let message = |path: &Path| read_case(path, &[]).unwrap_err().to_string();
    assert!(message(&path).contains("cannot be opened"));
    assert!(message(dir.path()).contains("is a folder; expected a case file"));
    std::fs::write(&path, b"fractum = 1\n\xff").unwrap();
    assert!(message(&path).contains("line 2 is not UTF-8 text"));
    std::fs::write(&path, "").unwrap();
    assert!(message(&path).contains("fractum is missing"));
    std::fs::write(&path, "fractum = = 1").unwrap();
    assert!(message(&path).contains("case.toml:1:"), "{}", message(&path));
}

#[test]
fn mistakes_about_changes_of_meshes_are_told_where_they_stand() {
    let cases: &[(&str, &str)] = &[
        ("[[mesh.joints]]\nspacing = 1", "4:1: mesh.joints[0] has none of table, angle, dip; expected exactly one"),
        (
            "[[mesh.joints]]\nangle = 0\nspacing = 1\nlength = 2",
            "7:1: mesh.joints[0].length has no effect without persistence: the joints of the set go through the body; remove it",
        ),
        (
            "[[mesh.joints]]\nangle = 0\nspacing = 1\npersistence = 1.5\nlength = 2",
            "7:15: mesh.joints[0].persistence = 1.5; expected above 0 and below 1",
        ),
        (
            "[[mesh.joints]]\ndip = \"30 deg\"\ndip_direction = 90\nspacing = 1",
            "6:17: mesh.joints[0].dip_direction = 90; expected an angle such as \"35 deg\"; without a unit it is in radians: write \"90 deg\"",
        ),
        ("[[mesh.joints]]\nangle = 0\nspacng = 1", "6:1: mesh.joints[0].spacng is not a key; did you mean spacing?"),
        (
            "[[mesh.joints]]\ndip = \"100 deg\"\ndip_direction = 0\nspacing = 1",
            "5:7: mesh.joints[0].dip = \"100 deg\"; expected from 0 to 90 deg",
        ),
        (
            "[[mesh.joints]]\ntable = [[0, 1, 2]]",
            "5:10: mesh.joints[0].table[0] = [0, 1, 2]; expected x, y, x, y of a trace, or x, y, z, dip, dip direction, diameter of a disc",
        ),
        ("[[mesh.joints]]\ntable = \"motion.csv\"", "motion.csv:2:1: 2 numbers; expected 4 of a trace, or 6 of a disc"),
        ("[mesh.grains]\nsize = 1\nshare = 2", "6:9: mesh.grains.share = 2; expected from 0.1 to 1"),
        ("[mesh.grains]\nseed = 1", "4:1: mesh.grains.size is missing"),
        ("[[mesh.refine]]\nwhere = \"x > 0\"", "4:1: mesh.refine[0].size is missing"),
        ("[[mesh.refine]]\nsize = 0", "5:8: mesh.refine[0].size = 0; expected"),
        ("[[mesh.refine]]\nsize = 1\nwhere = \"x + 1\"", "6:9: mesh.refine[0].where = \"x + 1\", which is a length"),
    ];
    for (network, message) in cases {
        let found = mistakes(&SMALL.replacen("[materials.steel]", &format!("{network}\n[materials.steel]"), 1));
        assert!(found.iter().any(|found| found.contains(message)), "{network}:\n{message}\n{found:#?}");
    }
}

#[test]
fn keys_beside_a_wrong_one_are_not_told_to_have_no_effect() {
    let interface =
        "end = 1e-3\n[[interfaces]]\ngroup = \"a\"\ntensile_strength = \"1 MPa\"\nfracture_energy = \"10 J/m^2\"\n";
    for (wrong, message) in [
        ("friction_angle = 35", "without a unit it is in radians: write \"35 deg\""),
        ("residual_friction_angle = \"95 deg\"", "expected from 0 to below 90 deg"),
        ("dilation_angle = \"5 deg\"", "is larger than the residual friction angle"),
    ] {
        let found = mistakes(&SMALL.replacen("end = 1e-3", &format!("{interface}{wrong}"), 1));
        assert!(found.len() == 1 && found[0].contains(message), "{wrong}: {found:#?}");
    }
    let of_material = SMALL.replacen("poisson_ratio = 0.3", "poisson_ratio = 0.7", 1);
    let found = mistakes(&of_material.replacen("material = \"steel\"", "material = \"steel\"\ndamage = false", 1));
    assert!(found.len() == 1 && found[0].contains("poisson_ratio"), "{found:#?}");
    let inert = format!("{interface}bonded = false\nfriction_angle = 0.5");
    let found = mistakes(&SMALL.replacen("end = 1e-3", &inert, 1));
    assert_eq!(found.len(), 3);
    assert!(found.iter().any(|mistake| mistake.contains("where residual_friction_angle is that of its sides")));
}
