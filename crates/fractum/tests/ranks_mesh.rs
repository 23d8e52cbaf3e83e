//! A mesh in parts, which several ranks read side by side: none of them has all of its elements.

use std::fs;

use fractum::{Options, run};
use fractum_math::Vec3;
use fractum_mesh::generate::structured_box;
use fractum_mesh::{Group, Mesh, MshFormat};
use fractum_output::frames::{read_arrays, read_collection};
use fractum_vtk::Arrays;

use crate::common::{Workplace, files_below, mesh_bytes};
use crate::ranks::{interrupted_on_ranks, on_ranks, options};

/// A block of two bodies that is pushed at one end, and absorbs waves at the other.
const BLOCK: &str = r#"fractum = 1
title = "A block in parts"
[mesh]
file = "bar.msh"
parts = 3
[materials.rock]
density = "2600 kg/m^3"
young_modulus = "50 GPa"
poisson_ratio = 0.25
[[bodies]]
name = "left"
kind = "solid"
group = "left"
material = "rock"
[[bodies]]
name = "right"
kind = "solid"
group = "right"
material = "rock"
formulation = "standard"
[[supports]]
group = "x+"
absorbing = true
[[supports]]
group = "z-"
fix = "z"
[[loads]]
group = "x-"
pressure = { ramp = [["0 s", "0 MPa"], ["20 us", "5 MPa"], ["60 us", "0 MPa"]] }
[damping]
bulk_linear = 0.06
bulk_quadratic = 1.2
[[probes]]
name = "u"
displacement = { group = "x-", along = "x" }
[[probes]]
name = "p"
momentum = { along = "x" }
[[probes]]
name = "support"
reaction = { group = "z-", along = "z" }
[solver]
kind = "explicit"
end = "0.1 ms"
[output]
history = { every = "5 us" }
fields = { every = "50 us", principal = true, strain = true }
"#;

/// The block, of which the left body breaks while its end is pulled and gas pushes on its top, also in cracks.
fn breaking() -> String {
    let damage = "[materials.weak]\ndensity = \"2600 kg/m^3\"\nyoung_modulus = \"50 GPa\"\npoisson_ratio = 0.25\n\
        [materials.weak.damage]\ntensile_strength = \"3 MPa\"\nfracture_energy = \"60 J/m^2\"\n\
        [[bodies]]\nname = \"left\"\nkind = \"solid\"\ngroup = \"left\"\nmaterial = \"weak\"\n";
    let left = "[[bodies]]\nname = \"left\"\nkind = \"solid\"\ngroup = \"left\"\nmaterial = \"rock\"\n";
    let pull = "[[supports]]\ngroup = \"x-\"\nvelocity.x = { ramp = [[\"0 s\", \"0 m/s\"], [\"20 us\", \"-8 m/s\"]] }\n\
        [[loads]]\ngroup = \"z+\"\npressure = \"0.5 MPa\"\nin_cracks = true\n[damping]";
    let probes = "[[probes]]\nname = \"removed\"\ncount = \"removed_elements\"\n\
        [[probes]]\nname = \"area\"\ncrack_area = true\n\
        [[probes]]\nname = \"front\"\ncrack = { measure = \"front\", along = \"z\" }\n\
        [[probes]]\nname = \"damaged\"\ndamaged = { measure = \"volume\", group = \"left\" }\n\
        [[probes]]\nname = \"stress\"\nstress = { group = \"left\", component = \"xx\" }\n\
        [[probes]]\nname = \"size\"\nfragment_size = 0.5\n[solver]";
    let gauges = "principal = true, strain = true, fragment = true }\n[[output.gauges]]\nname = \"top\"\ngroup = \"z+\"\n\
        from = [\"0.1 m\", \"0.2 m\", \"0.4 m\"]\nto = [\"0.7 m\", \"0.2 m\", \"0.4 m\"]\n\
        spacing = \"0.1 m\"\nlength = \"0.15 m\"\n";
    let loads = &BLOCK[BLOCK.find("[[loads]]").unwrap()..BLOCK.find("[damping]").unwrap()];
    let case = BLOCK.replace(left, damage).replace(loads, "").replace("[damping]", pull);
    case.replace("[solver]", probes).replace("principal = true, strain = true }\n", gauges)
}

/// The block, with its elements in two groups.
fn mesh() -> Mesh {
    let mut mesh = structured_box([16, 8, 8], Vec3::new(0.8, 0.4, 0.4), None);
    let body = mesh.groups.pop().unwrap();
    let middle = |e: &u32| mesh.tetrahedra[*e as usize].iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() / 4.0;
    let (left, right) = body.tetrahedra.iter().partition(|e| middle(e) < 0.4);
    for (name, tag, tetrahedra) in [("left", 1, left), ("right", 2, right)] {
        mesh.groups.push(Group { name: name.to_owned(), tag, tetrahedra, ..body.clone() });
    }
    mesh
}

/// Elements `begin..end` of a mesh, with all boundary elements, as a file of its own.
fn part(mesh: &Mesh, begin: u32, end: u32) -> Vec<u8> {
    let mut part = mesh.clone();
    part.tetrahedra = mesh.tetrahedra[begin as usize..end as usize].to_vec();
    part.tetrahedron_tags = mesh.tetrahedron_tags[begin as usize..end as usize].to_vec();
    for group in &mut part.groups {
        group.tetrahedra.retain(|element| (begin..end).contains(element));
        group.tetrahedra.iter_mut().for_each(|element| *element -= begin);
    }
    // Nodes that no element of it uses are not read back.
    mesh_bytes(&part, MshFormat::V4_1Binary)
}

/// A folder with the block in one file, `whole.msh`, and in three.
fn workplace(case: &str) -> Workplace {
    let mesh = mesh();
    let place = Workplace::with_mesh(case, &[]);
    fs::write(place.path("whole.msh"), mesh_bytes(&mesh, MshFormat::V4_1Binary)).unwrap();
    let count = mesh.tetrahedra.len() as u32;
    for (number, [begin, end]) in [[0, 700], [700, 4000], [4000, count]].into_iter().enumerate() {
        fs::write(place.path(&format!("bar_{}.msh", number + 1)), part(&mesh, begin, end)).unwrap();
    }
    place
}

#[test]
fn ranks_that_read_a_part_each_have_the_state_of_one_process() {
    let place = workplace(BLOCK);
    let case = place.path("case.toml");
    let alone = run(&case, &options(&place, "alone")).unwrap().summary;
    let whole = BLOCK.replace("parts = 3\n", "").replace("bar.msh", "whole.msh");
    fs::write(place.path("whole.toml"), whole).unwrap();
    let of_one_file = run(&place.path("whole.toml"), &options(&place, "whole")).unwrap().summary;
    assert_eq!(alone.hashes.state_hash, of_one_file.hashes.state_hash);
    let history = |folder: &str| fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
    for ranks in [2, 3, 5] {
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{ranks} ranks");
        }
        assert_eq!(history(&folder), history("alone"), "{ranks} ranks");
        let log = fs::read_to_string(place.path(&folder).join("run.log")).unwrap();
        assert!(log.contains("of the 6144 tetrahedra of the mesh\n"), "{log}");
        assert!(place.path(&folder).join("pictures/stress.png").is_file());
        assert_same_elements(&place, &folder);
    }
}

/// Every element of a frame is in one of the pieces.
fn assert_same_elements(place: &Workplace, folder: &str) {
    let is_solid = |file: &str| file.contains("solid");
    let frames = |folder: &str| {
        let entries = read_collection(&place.path(folder).join("fields.pvd")).unwrap().entries;
        entries.into_iter().map(|entry| entry.file).filter(|file| is_solid(file)).collect::<Vec<_>>()
    };
    assert_eq!(frames(folder).len(), 3);
    for (ours, expected) in frames(folder).iter().zip(frames("alone")) {
        assert_eq!(*ours, expected.replace(".v", ".pv"));
        let read = |folder: &str, file: &str| {
            let names = ["Points", "connectivity", "von_mises_stress", "strain"];
            elements(&read_arrays(&place.path(folder).join(file), &names).unwrap())
        };
        assert!(read(folder, ours) == read("alone", &expected), "{folder}: {ours}");
    }
}

/// Corners, stress and strain of all elements, in an order that does not depend on that of the file.
fn elements(arrays: &Arrays) -> Vec<(Vec<[u64; 3]>, u64, Vec<u64>)> {
    let points: Vec<[f64; 3]> = arrays.vectors("Points");
    let corner = |node: &u32| points[*node as usize].map(f64::to_bits);
    let corners = arrays.cells::<4>().into_iter().map(|nodes| nodes.iter().map(corner).collect());
    let strains = arrays.get("strain").chunks(6).map(|strain| strain.iter().map(|e| e.to_bits()).collect());
    let stresses = arrays.get("von_mises_stress").iter().map(|stress| stress.to_bits());
    let mut elements: Vec<_> =
        corners.zip(stresses).zip(strains).map(|((at, stress), strain)| (at, stress, strain)).collect();
    elements.sort_unstable();
    elements
}

#[test]
fn one_rank_reads_a_mesh_in_one_file_and_deals_it_out() {
    let case = BLOCK.replace("bar.msh", "whole.msh");
    let place = workplace(&case.replace("parts = 3", "parts = 1"));
    fs::write(place.path("whole.toml"), case.replace("parts = 3\n", "")).unwrap();
    let alone = run(&place.path("whole.toml"), &options(&place, "alone")).unwrap().summary;
    for ranks in [1, 3] {
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{ranks} ranks");
        }
    }
    let log = fs::read_to_string(place.path("of-3/run.log")).unwrap();
    assert!(log.contains("of the 6144 tetrahedra of the mesh\n"), "{log}");
}

#[test]
fn a_state_of_parts_is_taken_up_by_any_number_of_ranks() {
    let place = workplace(BLOCK);
    let case = place.path("case.toml");
    let alone = run(&case, &options(&place, "alone")).unwrap().summary;
    for (from, to) in [(1, 3), (3, 2), (2, 1)] {
        let folder = format!("from-{from}-to-{to}");
        let options = options(&place, &folder);
        interrupted_on_ranks(&place, from, &options, 4e-5);
        for hash in on_ranks(&place, to, &Options { resume: true, ..options.clone() }) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{folder}");
        }
    }
}

#[test]
fn every_rank_has_the_elements_of_a_body_that_breaks_and_not_the_rest() {
    let place = workplace(&breaking());
    let case = place.path("case.toml");
    let alone = run(&case, &options(&place, "alone")).unwrap().summary;
    let counts = &alone.counts;
    assert!(counts.removed_elements > 20 && counts.particles > 20, "{counts:?}");
    let read = |folder: &str, file: &str| fs::read_to_string(place.path(folder).join(file)).unwrap();
    for ranks in [2, 3, 5] {
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{ranks} ranks");
        }
        for file in ["history.csv", "gauges/top-00002.csv", "fragments.csv"] {
            assert!(read(&folder, file) == read("alone", file), "{ranks} ranks: {file}");
        }
        let cracks = |folder: &str| files_below(&place.path(folder), ".vtp").into_iter();
        let cracks = |folder: &str| cracks(folder).filter(|file| file.display().to_string().contains("cracks-"));
        assert!(cracks("alone").count() > 0 && cracks(&folder).count() == cracks("alone").count());
        for (ours, expected) in cracks(&folder).zip(cracks("alone")) {
            assert!(fs::read(&ours).unwrap() == fs::read(expected).unwrap(), "{}", ours.display());
        }
        let log = read(&folder, "run.log");
        assert!(log.contains("every process has all elements of body \"left\", because of damage\n"), "{log}");
        assert!(log.contains("of the 6144 tetrahedra of the mesh\n"), "{log}");
        assert_same_elements(&place, &folder);
    }
    let folder = "from-3-to-2";
    let options = options(&place, folder);
    interrupted_on_ranks(&place, 3, &options, 7e-5);
    for hash in on_ranks(&place, 2, &Options { resume: true, ..options.clone() }) {
        assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{folder}");
    }
}

/// What falls onto the block: a rigid ball where its bodies meet, which turns, and spheres.
const FALLING: &str = r#"[[bodies]]
name = "ball"
kind = "rigid"
shape = "sphere"
point = ["0.38 m", "0.21 m", "0.501 m"]
radius = "100 mm"
free = "xyz"
free_rotation = true
mass = "20 kg"
initial_velocity = { x = "8 m/s", z = "-40 m/s" }
contact = { friction = 0.4, damping_ratio = 0.1 }
[[bodies]]
name = "spheres"
kind = "particles"
material = "rock"
shape = "box"
point = ["0.5 m", "0.05 m", "0.401 m"]
size = ["0.25 m", "0.3 m", "0.06 m"]
particle_radius = "15 mm"
initial_velocity = { z = "-80 m/s" }
[[supports]]
group = "x+""#;

#[test]
fn what_touches_divided_bodies_is_known_to_every_rank() {
    let falling = |case: &str| case.replace("[[supports]]\ngroup = \"x+\"", FALLING);
    for (name, case) in [("elastic", falling(BLOCK)), ("breaking", falling(&breaking()))] {
        let place = workplace(&case);
        let alone = run(&place.path("case.toml"), &options(&place, "alone")).unwrap().summary;
        assert!(alone.counts.contacts > 5, "{name}: {:?}", alone.counts);
        let read = |folder: &str| fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
        for ranks in [2, 3, 5] {
            let folder = format!("of-{ranks}");
            for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
                assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{name}: {ranks} ranks");
            }
            assert!(read(&folder) == read("alone"), "{name}: {ranks} ranks");
            let log = fs::read_to_string(place.path(&folder).join("run.log")).unwrap();
            assert!(!log.contains("every process has the whole mesh"), "{log}");
        }
    }
}

#[test]
fn stresses_are_measured_in_divided_bodies_too() {
    let probes = "stress = { where = \"hypot(x - 0.4 m, z - 0.2 m) < 0.12 m\", component = \"xx\" }\n\
        [[probes]]\nname = \"right\"\nstress = { group = \"right\", component = \"zz\" }\n\
        [[probes]]\nname = \"some\"\nstress = { group = \"left\", where = \"x < 0.1 m\", component = \"zx\" }";
    let smoothed = "material = \"rock\"\nformulation = \"smoothed\"\n[[bodies]]\nname = \"right\"";
    let case = BLOCK.replace("momentum = { along = \"x\" }", probes);
    let place = workplace(&case.replace("material = \"rock\"\n[[bodies]]\nname = \"right\"", smoothed));
    let alone = run(&place.path("case.toml"), &options(&place, "alone")).unwrap().summary;
    let history = |folder: &str| fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
    assert!(["p", "right", "some"].iter().all(|name| alone.probes[*name].r#final.abs() > 1e4), "{:?}", alone.probes);
    for ranks in [2, 3, 5] {
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash);
        }
        assert!(history(&folder) == history("alone"), "{ranks} ranks");
        let log = fs::read_to_string(place.path(&folder).join("run.log")).unwrap();
        assert!(!log.contains("every process has"), "{log}");
        assert_same_elements(&place, &folder);
    }
}

#[test]
fn where_all_may_break_every_rank_has_its_cells_alone() {
    let scatter = "60 J/m^2\"\nscatter = { distribution = \"weibull\", modulus = 8, reference_volume = \"1 L\", correlation_length = \"10 cm\", seed = 3 }\n";
    let case = breaking().replace("60 J/m^2\"\n", scatter);
    let partly = "material = \"weak\"\ndamage_where = \"z < 0.3 m\"";
    let place = workplace(&case.replace("material = \"rock\"\nformulation = \"standard\"", partly));
    let alone = run(&place.path("case.toml"), &options(&place, "alone")).unwrap().summary;
    assert!(alone.counts.removed_elements > 20, "{:?}", alone.counts);
    let read = |folder: &str, file: &str| fs::read_to_string(place.path(folder).join(file)).unwrap();
    for ranks in [2, 3, 5] {
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{ranks} ranks");
        }
        for file in ["history.csv", "fragments.csv"] {
            assert!(read(&folder, file) == read("alone", file), "{ranks} ranks: {file}");
        }
        let log = read(&folder, "run.log");
        assert!(log.contains("every process has all elements of body \"right\", because of damage\n"), "{log}");
        assert_same_elements(&place, &folder);
    }
    for (from, to) in [(3, 2), (2, 1), (1, 3)] {
        let folder = format!("from-{from}-to-{to}");
        let options = options(&place, &folder);
        interrupted_on_ranks(&place, from, &options, 7e-5);
        for hash in on_ranks(&place, to, &Options { resume: true, ..options.clone() }) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{folder}");
        }
    }
}

#[test]
fn where_every_body_is_whole_every_rank_reads_all_parts() {
    let damage = "poisson_ratio = 0.25\n[materials.rock.damage]\ntensile_strength = \"9 MPa\"\n\
        fracture_energy = \"900 J/m^2\"\nregularisation = \"phase-field\"\n";
    let place = workplace(&BLOCK.replace("poisson_ratio = 0.25\n", damage));
    let alone = run(&place.path("case.toml"), &options(&place, "alone")).unwrap().summary;
    for hash in on_ranks(&place, 2, &options(&place, "shared")) {
        assert_eq!(hash.unwrap(), alone.hashes.state_hash);
    }
    let log = fs::read_to_string(place.path("shared/run.log")).unwrap();
    let reason = "a phase field of body \"left\", damage in the standard formulation of body \"right\"\n";
    assert!(log.contains(&format!("every process has the whole mesh, because of {reason}")), "{log}");
}

#[test]
fn a_part_that_is_missing_or_of_another_mesh_is_named() {
    let place = workplace(BLOCK);
    let other = structured_box([2, 2, 2], Vec3::new(2.0, 2.0, 2.0), None);
    fs::write(place.path("bar_2.msh"), mesh_bytes(&other, MshFormat::V4_1Binary)).unwrap();
    let said = |ranks: usize| {
        let results = on_ranks(&place, ranks, &options(&place, "refused"));
        results.into_iter().map(|result| result.unwrap_err().to_string()).next().unwrap()
    };
    for ranks in [1, 3] {
        let text = said(ranks);
        assert!(text.contains("case.toml:4:8: mesh.file: ") && text.contains("parts of one mesh"), "{text}");
    }
    fs::remove_file(place.path("bar_2.msh")).unwrap();
    let text = said(1);
    assert!(text.contains("bar_2.msh\": cannot read the mesh") && text.contains("-part_split"), "{text}");
    assert!(!place.path("refused").exists());
}
