//! Frames have one frame of reference: points where everything was at the start, moved by `displacement`.

mod common;
#[allow(dead_code)] // the reader that the tests of the writers use
#[path = "../../fractum-io/src/output/vtk/decode.rs"]
mod decode;

use std::collections::BTreeMap;
use std::fs;

use common::{BONDED_BAR, BREAKING_BAR, Workplace, files_below, run, summary};
use decode::{Decoded, decode};

/// The last frame of a part.
fn last(place: &Workplace, folder: &str, name: &str) -> Decoded {
    let files = files_below(&place.path("out").join(folder), "");
    let file = files.iter().rfind(|file| file.file_name().unwrap().to_string_lossy().starts_with(name));
    decode(&fs::read(file.unwrap_or_else(|| panic!("no {name}"))).unwrap())
}

fn vectors(file: &Decoded, name: &str) -> Vec<[f64; 3]> {
    file.f64(name).chunks_exact(3).map(|vector| vector.try_into().unwrap()).collect()
}

fn singles<const N: usize>(file: &Decoded, name: &str) -> Vec<[f64; N]> {
    let values = file.bytes(name).chunks_exact(4).map(|bytes| f64::from(f32::from_ne_bytes(bytes.try_into().unwrap())));
    values.collect::<Vec<f64>>().chunks_exact(N).map(|part| part.try_into().unwrap()).collect()
}

#[test]
fn solids_discrete_elements_and_cracks_are_moved_by_one_field() {
    let place = Workplace::new(BREAKING_BAR);
    run(&place, "out", "2");
    let solid = last(&place, "fields", "solid");
    let bits = |x: &[f64; 3]| x.map(f64::to_bits);
    let nodes: BTreeMap<[u64; 3], [f64; 3]> =
        vectors(&solid, "Points").iter().map(bits).zip(vectors(&solid, "displacement")).collect();
    for (folder, name) in [("particles", "particles"), ("cracks", "cracks")] {
        let part = last(&place, folder, name);
        let (points, displacement) = (vectors(&part, "Points"), vectors(&part, "displacement"));
        assert!(!points.is_empty(), "{name}");
        for (point, moved) in points.iter().zip(displacement) {
            assert_eq!(nodes.get(&bits(point)), Some(&moved), "{name} at {point:?}");
        }
    }
    let floor = last(&place, "rigid", "rigid");
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
    let file = decode(&fs::read(place.path("out/cracks.vtp")).unwrap());
    assert_eq!(file.f64("time").len(), rows.len());
    assert_eq!(file.i32("fragment").len(), rows.len());
    assert_eq!(file.f64("opening").len(), rows.len());
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
    let solid = last(&place, "fields", "solid");
    let stress: Vec<[f64; 6]> = singles(&solid, "stress");
    let largest = stress.iter().flatten().fold(0.0, |m: f64, s| m.max(s.abs()));
    let principal: Vec<[f64; 3]> = singles(&solid, "principal_stresses");
    let direction: Vec<[f64; 3]> = singles(&solid, "principal_direction_1");
    let von_mises: Vec<[f64; 1]> = singles(&solid, "von_mises_stress");
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
    assert_eq!(singles::<3>(&solid, "principal_direction_3").len(), stress.len());
    assert_eq!(singles::<6>(&solid, "strain").len(), stress.len());
    let reaction: Vec<[f64; 3]> = singles(&solid, "reaction");
    assert_eq!(reaction.len(), solid.i32("fragment").len());
    assert!(reaction.iter().any(|force| force[0] != 0.0) && reaction.iter().all(|force| force[1] == 0.0));
    assert!(solid.i32("material").iter().all(|&material| material == 0));
    assert!(solid.i32("fragment").contains(&1));
}

#[test]
fn bonds_and_broken_bonds_lie_where_their_particles_were() {
    let place = Workplace::new(BONDED_BAR);
    run(&place, "out", "2");
    let [particles, bonds] = [last(&place, "particles", "bonded"), last(&place, "bonds", "bonds")];
    for name in ["Points", "displacement"] {
        assert_eq!(particles.f64(name), bonds.f64(name), "{name}");
    }
    // As large as the box that was packed, wherever the halves have gone.
    let (points, radius) = (vectors(&particles, "Points"), particles.f64("radius"));
    for (axis, size) in [2e-3, 1e-3, 1e-3].into_iter().enumerate() {
        let extent = |f: fn(f64, f64) -> f64, from: f64| points.iter().map(|point| point[axis]).fold(from, f);
        let length = extent(f64::max, f64::NEG_INFINITY) - extent(f64::min, f64::INFINITY);
        assert!(length > 0.8 * size && length < size, "{axis}: {length}");
    }
    let facets = decode(&fs::read(place.path("out/cracks.vtp")).unwrap());
    let (corners, area) = (vectors(&facets, "Points"), facets.f64("area"));
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
    assert!(facets.f64("opening").iter().any(|&opening| opening > 0.0));
    let stress: Vec<[f64; 6]> = singles(&particles, "stress");
    assert_eq!(stress.len(), radius.len());
}
