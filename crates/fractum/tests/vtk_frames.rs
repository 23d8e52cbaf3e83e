//! Frames have one frame of reference: points where everything was at the start, moved by `displacement`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use fractum_output::frames::read_arrays;
use fractum_vtk::Arrays;

use crate::common::{BONDED_BAR, BREAKING_BAR, Workplace, files_below, resumed, run, summary};

/// Where points were at the start, and how far they have moved.
const PLACES: [&str; 2] = ["Points", "displacement"];

/// Arrays of a file, by name.
fn read(path: &Path, names: &[&str]) -> Arrays {
    let arrays = read_arrays(path, names).unwrap();
    assert!(names.iter().all(|name| !arrays.get(name).is_empty()), "{names:?} of {}", path.display());
    arrays
}

/// Arrays of the last frame of a part, by name.
fn last(place: &Workplace, folder: &str, stem: &str, names: &[&str]) -> Arrays {
    let files = files_below(&place.path("out").join(folder), "");
    let file = files.iter().rfind(|file| file.file_name().unwrap().to_string_lossy().starts_with(stem));
    read(file.unwrap_or_else(|| panic!("no {stem}")), names)
}

fn vectors(file: &Arrays, name: &str) -> Vec<[f64; 3]> {
    tuples(file, name)
}

fn tuples<const N: usize>(file: &Arrays, name: &str) -> Vec<[f64; N]> {
    file.get(name).chunks_exact(N).map(|vector| vector.try_into().unwrap()).collect()
}

#[test]
fn solids_discrete_elements_and_cracks_are_moved_by_one_field() {
    let place = Workplace::new(BREAKING_BAR);
    run(&place, "out", "2");
    let solid = last(&place, "fields", "solid", &PLACES);
    let bits = |x: &[f64; 3]| x.map(f64::to_bits);
    let nodes: BTreeMap<[u64; 3], [f64; 3]> =
        vectors(&solid, "Points").iter().map(bits).zip(vectors(&solid, "displacement")).collect();
    for (folder, name) in [("particles", "particles"), ("cracks", "cracks")] {
        let part = last(&place, folder, name, &PLACES);
        let (points, displacement) = (vectors(&part, "Points"), vectors(&part, "displacement"));
        assert!(!points.is_empty(), "{name}");
        for (point, moved) in points.iter().zip(displacement) {
            assert_eq!(nodes.get(&bits(point)), Some(&moved), "{name} at {point:?}");
        }
    }
    let floor = last(&place, "rigid", "rigid", &PLACES);
    assert!(vectors(&floor, "Points").iter().all(|point| (point[1] + 5e-6).abs() < 1e-12), "the plane");
    let listed = fs::read_to_string(place.path("out/fields.pvd")).unwrap();
    for name in ["solid", "discrete elements", "rigid bodies", "cracks"] {
        assert!(listed.contains(&format!("name=\"{name}\"")), "{name}: {listed}");
    }
    let head = fs::read(&files_below(&place.path("out/fields"), ".vtu")[0]).unwrap();
    let head = String::from_utf8_lossy(&head[..4000.min(head.len())]).into_owned();
    assert!(
        head.contains("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">m/s</InformationKey>"),
        "{head}"
    );
}

#[test]
fn facets_of_cracks_say_when_they_opened_and_whose_they_are() {
    let place = Workplace::new(BREAKING_BAR);
    run(&place, "out", "2");
    let table = fs::read_to_string(place.path("out/cracks.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("body,element,removed,time [s],x [m],y [m],z [m],nx,ny,nz,area [m^2],opening [m],fragment")
    );
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let number = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
    assert!(!rows.is_empty() && rows.iter().all(|row| row[0] == "bar"));
    let end = summary(&place, "out")["time"]["end"].as_f64().unwrap();
    assert!(rows.iter().all(|row| number(row, 3) > 0.0 && number(row, 3) <= end));
    // The bar is pulled apart along x: most of the area faces that way, and opens.
    let facing: f64 = rows.iter().map(|row| number(row, 10) * number(row, 7).abs()).sum();
    let area: f64 = rows.iter().map(|row| number(row, 10)).sum();
    assert!(facing > 0.5 * area, "{facing} of {area}");
    let names = ["time", "fragment", "opening"];
    let file = read(&place.path("out/cracks.vtp"), &names);
    assert!(names.iter().all(|name| file.get(name).len() == rows.len()));
}

#[test]
fn further_fields_are_written_where_they_are_asked_for() {
    let place = Workplace::new(BREAKING_BAR);
    let names = ["principal", "strain", "reaction", "fragment"];
    let mut arguments = vec!["run", "case.toml", "-o", "out", "--quiet", "--set", "end=0.3 ms"];
    let set = names.map(|name| format!("output.fields.{name}=true"));
    set.iter().for_each(|set| arguments.extend(["--set", set]));
    let ended = place.fractum(&arguments);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let arrays = [
        "stress",
        "principal_stresses",
        "principal_direction_1",
        "principal_direction_3",
        "von_mises_stress",
        "strain",
        "reaction",
        "fragment",
        "material",
    ];
    let solid = last(&place, "fields", "solid", &arrays);
    let stress: Vec<[f64; 6]> = tuples(&solid, "stress");
    let largest = stress.iter().flatten().fold(0.0, |m: f64, s| m.max(s.abs()));
    let principal: Vec<[f64; 3]> = vectors(&solid, "principal_stresses");
    let direction: Vec<[f64; 3]> = vectors(&solid, "principal_direction_1");
    let von_mises: Vec<[f64; 1]> = tuples(&solid, "von_mises_stress");
    for (((s, p), n), v) in stress.iter().zip(&principal).zip(&direction).zip(&von_mises) {
        // The stress vector across the first direction is the first principal stress along it.
        let [xx, yy, zz, xy, yz, zx] = *s;
        let across =
            [xx * n[0] + xy * n[1] + zx * n[2], xy * n[0] + yy * n[1] + yz * n[2], zx * n[0] + yz * n[1] + zz * n[2]];
        for axis in 0..3 {
            assert!((across[axis] - p[0] * n[axis]).abs() < 1e-5 * largest, "{s:?} {p:?} {n:?}");
        }
        let [a, b, c] = *p;
        let expected = (0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))).sqrt();
        assert!((v[0] - expected).abs() < 1e-5 * largest, "{v:?} {expected}");
    }
    assert_eq!(tuples::<3>(&solid, "principal_direction_3").len(), stress.len());
    assert_eq!(tuples::<6>(&solid, "strain").len(), stress.len());
    let reaction: Vec<[f64; 3]> = vectors(&solid, "reaction");
    assert_eq!(reaction.len(), solid.get("fragment").len());
    assert!(reaction.iter().any(|force| force[0] != 0.0) && reaction.iter().all(|force| force[1] == 0.0));
    assert!(solid.get("material").iter().all(|&material| material == 0.0));
    assert!(solid.get("fragment").contains(&1.0));
}

const COLUMN: &str = r#"fractum = 1
title = "Beads in a column, by twos and ones"
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = 0.22
contact = { friction = 0, restitution = 0.2 }
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
file = "beads.csv"
[[bodies]]
name = "box"
kind = "rigid"
shape = "box"
inside = true
point = ["-20 mm", "-10 mm", "0 mm"]
size = ["40 mm", "20 mm", "200 mm"]
contact = { friction = 0, restitution = 0.2 }
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[solver]
end = "0.2 s"
[output]
fields = { every = "10 ms", contacts = true }
"#;

#[test]
fn contacts_of_a_column_of_beads_bear_what_lies_above() {
    // Rows of two and of one, 9 beads in 6 rows: the contacts of a bead with the row below lean by 30 degrees, and the walls take what they push outwards.
    let place = Workplace::new(COLUMN);
    let (radius, mut rows, mut beads) = (0.01, [2, 1, 2, 1, 2, 1].into_iter().zip(0..), String::new());
    rows.by_ref().for_each(|(count, row)| {
        let z = radius * (1.0 + f64::from(row) * 3f64.sqrt());
        let across: &[f64] = if count == 2 { &[-radius, radius] } else { &[0.0] };
        across.iter().for_each(|x| beads += &format!("{x},0,{z},{radius}\n"));
    });
    fs::write(place.path("beads.csv"), beads).unwrap();
    let one = run(&place, "out", "1");
    let names = [
        "Points",
        "displacement",
        "normal_force",
        "tangential_force",
        "force",
        "overlap",
        "first_particle",
        "second_particle",
        "first_body",
        "second_body",
        "second_kind",
    ];
    let file = last(&place, "contacts", "contacts", &names);
    let weight = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 9.81;
    let (normal, force) = (file.get("normal_force"), vectors(&file, "force"));
    let (points, displacement) = (vectors(&file, "Points"), vectors(&file, "displacement"));
    // Beads above each row, from the lowest row on.
    let above = [7.0, 6.0, 4.0, 3.0, 1.0];
    let row = |particle: f64| (particle / 3.0) as usize * 2 + usize::from(particle % 3.0 == 2.0);
    let (mut carried, mut inclined) = (0.0, 0);
    for (line, &second) in file.get("second_particle").iter().enumerate() {
        let ends = [2 * line, 2 * line + 1].map(|p| [0, 2].map(|axis| points[p][axis] + displacement[p][axis]));
        let apart = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
        let length = apart[0].hypot(apart[1]);
        assert!(file.get("tangential_force")[line] < 1e-9 * weight && file.get("first_body")[line] == 0.0);
        let first = file.get("first_particle")[line];
        if second >= 0.0 {
            assert_eq!((file.get("second_kind")[line], row(second)), (0.0, row(first) + 1));
            let right = above[row(first)] * weight / (2.0 * 30f64.to_radians().cos());
            assert!((normal[line] / right - 1.0).abs() < 0.01, "row {}: {} for {right}", row(first), normal[line]);
            assert!((length / (2.0 * radius - file.get("overlap")[line]) - 1.0).abs() < 1e-6);
            inclined += 1;
        } else {
            assert_eq!((file.get("second_kind")[line], file.get("second_body")[line]), (1.0, 0.0));
            assert!((length / (radius - file.get("overlap")[line]) - 1.0).abs() < 1e-4, "{length}");
            carried += force[line][2];
        }
    }
    assert_eq!(inclined, 10);
    assert!((carried / (9.0 * weight) - 1.0).abs() < 0.01, "{carried} N of {}", 9.0 * weight);
    fs::write(place.path("case.toml"), COLUMN.replace(", contacts = true", "")).unwrap();
    let without = run(&place, "without", "1");
    assert_eq!(without["state_hash"], one["state_hash"]);
    assert!(!place.path("without/contacts").exists());
}

#[test]
fn files_of_contacts_have_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let case = COLUMN.replace("end = \"0.2 s\"", "end = \"10 ms\"").replace("every = \"10 ms\"", "every = \"0.2 ms\"");
    let place = Workplace::new(&(case + "checkpoint = { steps = 1400 }\n"));
    fs::write(place.path("beads.csv"), "-0.01,0,0.01,0.01\n0.01,0,0.01,0.01\n0,0,0.0275,0.01\n").unwrap();
    let of = |folder: &str| {
        let files = files_below(&place.path(folder).join("contacts"), ".vtp");
        files.iter().map(|file| fs::read(file).unwrap()).collect::<Vec<_>>()
    };
    let one = run(&place, "one", "1");
    run(&place, "two", "2");
    assert!(of("one").len() > 20 && of("one") == of("two"));
    assert_eq!(resumed(&place, "two")["state_hash"], one["state_hash"]);
    assert!(of("one") == of("two"), "after a checkpoint");
}

#[test]
fn contacts_with_the_floor_carry_beads_and_bonded_bodies() {
    // A bonded plate of 9 particles on a floor, and a bead on its middle.
    let case = COLUMN.replace("restitution = 0.2 }\n[[loads]]", "restitution = 0.2 }\nPLATE[[loads]]");
    let plate = "[[bodies]]\nname = \"plate\"\nkind = \"bonded\"\nmaterial = \"glass\"\nfile = \"plate.csv\"\nbond_gap = \"1 mm\"\n";
    let beams = "\n[materials.glass.bonds]\ncoordination = 3\nconvention = \"all\"\nradius_ratio = 0.5\nyoung_modulus = \"1 GPa\"\n";
    let place = Workplace::new(
        &case.replace("PLATE", &(beams.to_owned() + plate)).replace("end = \"0.2 s\"", "end = \"0.3 s\""),
    );
    let cells = [-1, 0, 1]
        .map(|x| [-1, 0, 1].map(|y| format!("{},{},0.003,0.003\n", 0.006 * f64::from(x), 0.006 * f64::from(y))));
    fs::write(place.path("plate.csv"), cells.concat().concat()).unwrap();
    fs::write(place.path("beads.csv"), "0,0,0.016,0.01\n").unwrap();
    run(&place, "out", "1");
    let file = last(&place, "contacts", "contacts", &["force", "second_kind", "first_body", "second_body"]);
    let particles = [("bonded", 9), ("loose", 1)].map(|(stem, count)| {
        let mass = last(&place, "particles", stem, &["mass"]).get("mass").to_vec();
        assert_eq!(mass.len(), count);
        mass.iter().sum::<f64>() * 9.81
    });
    let force = vectors(&file, "force");
    let carried = |kind: f64| {
        let lines = (0..force.len()).filter(|&line| file.get("second_kind")[line] == kind);
        lines.map(|line| force[line][2]).sum::<f64>()
    };
    let weight = particles[0] + particles[1];
    assert!((carried(1.0) / weight - 1.0).abs() < 0.01, "{} N of {weight} on the floor", carried(1.0));
    // The bead is the first body: the force on it.
    assert!((carried(0.0) / particles[1] - 1.0).abs() < 0.01, "{} N of {}", carried(0.0), particles[1]);
}

#[test]
fn bonds_and_broken_bonds_lie_where_their_particles_were() {
    let place = Workplace::new(BONDED_BAR);
    run(&place, "out", "2");
    let particles = last(&place, "particles", "bonded", &["Points", "displacement", "radius", "stress"]);
    let bonds = last(&place, "bonds", "bonds", &PLACES);
    for name in ["Points", "displacement"] {
        assert_eq!(particles.get(name), bonds.get(name), "{name}");
    }
    // As large as the box that was packed, wherever the halves have gone.
    let (points, radius) = (vectors(&particles, "Points"), particles.get("radius"));
    for (axis, size) in [2e-3, 1e-3, 1e-3].into_iter().enumerate() {
        let extent = |f: fn(f64, f64) -> f64, from: f64| points.iter().map(|point| point[axis]).fold(from, f);
        let length = extent(f64::max, f64::NEG_INFINITY) - extent(f64::min, f64::INFINITY);
        assert!(length > 0.8 * size && length < size, "{axis}: {length}");
    }
    let facets = read(&place.path("out/cracks.vtp"), &["Points", "area", "normal", "opening"]);
    let (corners, area) = (vectors(&facets, "Points"), facets.get("area"));
    assert_eq!(corners.len(), 6 * area.len());
    for (hexagon, (area, normal)) in corners.chunks(6).zip(area.iter().zip(vectors(&facets, "normal"))) {
        let mean: [f64; 3] = std::array::from_fn(|axis| hexagon.iter().map(|x| x[axis]).sum::<f64>() / 6.0);
        let mut sum = [0.0; 3];
        for (a, b) in hexagon.iter().zip(hexagon.iter().cycle().skip(1)) {
            let [p, q]: [[f64; 3]; 2] = [a, b].map(|x| std::array::from_fn(|axis| x[axis] - mean[axis]));
            for axis in 0..3 {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                sum[axis] += 0.5 * (p[i] * q[j] - p[j] * q[i]);
            }
        }
        for axis in 0..3 {
            assert!((sum[axis] - area * normal[axis]).abs() < 1e-9 * area, "{sum:?} {area} {normal:?}");
        }
    }
    // The halves part along x: what broke last stands open.
    assert!(facets.get("opening").iter().any(|&opening| opening > 0.0));
    let stress: Vec<[f64; 6]> = tuples(&particles, "stress");
    assert_eq!(stress.len(), radius.len());
}
