//! Frames have one frame of reference: points where everything was at the start, moved by `displacement`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use fractum_output::frames::read_arrays;
use fractum_vtk::Arrays;

use crate::common::{BONDED_BAR, BREAKING_BAR, Workplace, files_below, run, summary};

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
