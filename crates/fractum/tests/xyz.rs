//! Particles as extended xyz, read by rules of that format alone; and sizes of particles in a run.

use std::fs;
use std::path::Path;

use crate::common::{Workplace, run};

const FALL: &str = r#"fractum = 1
title = "Gravel falls"
[materials.soft]
density = "2500 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.25
[[bodies]]
name = "fine gravel"
kind = "particles"
material = "soft"
shape = "box"
size = ["20 mm", "20 mm", "20 mm"]
sizes = { passing = [["1 mm", 0], ["2 mm", "40 %"], ["4 mm", 1]] }
seed = SEED
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[solver]
end = "2 ms"
[output]
fields = { every = "1 ms", xyz = true }
"#;

/// A file: its properties with their numbers of columns, and its rows.
fn read(path: &Path) -> (Vec<(String, usize)>, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let count: usize = lines.next().unwrap().parse().unwrap();
    let comment = lines.next().unwrap();
    let list = comment.split_whitespace().find_map(|word| word.strip_prefix("Properties=")).unwrap();
    let words: Vec<&str> = list.split(':').collect();
    let properties = words.chunks(3).map(|p| (p[0].to_owned(), p[2].parse().unwrap())).collect();
    let rows: Vec<Vec<String>> = lines.map(|line| line.split_whitespace().map(str::to_owned).collect()).collect();
    assert_eq!(rows.len(), count);
    (properties, rows)
}

#[test]
fn frames_of_particles_are_extended_xyz_at_their_present_positions() {
    let place = Workplace::new(&FALL.replace("SEED", "1"));
    let one = run(&place, "one", "1");
    let count = one["counts"]["particles"].as_u64().unwrap() as usize;
    let at = |frame: u64| read(&place.path(&format!("one/particles/particles-{frame:05}.xyz")));
    let ((properties, first), (_, last)) = (at(0), at(2));
    let columns: usize = properties.iter().map(|(_, count)| count).sum();
    assert_eq!(first.len(), count);
    let start = |name: &str| properties.iter().take_while(|(own, _)| own != name).map(|(_, n)| n).sum::<usize>();
    let number = |row: &[String], column: usize| row[column].parse::<f64>().unwrap();
    for (row, later) in first.iter().zip(&last) {
        assert_eq!((row.len(), later.len(), row[0].as_str()), (columns, columns, "fine_gravel"));
        assert_eq!(row[start("id")], later[start("id")]);
        let [z, before] = [later, row].map(|row| number(row, start("pos") + 2));
        // A particle that nothing touches falls by g t²/2.
        assert!(z - before < 1e-6 && z - before > -1e-3);
        assert!(number(row, start("radius")) >= 0.5e-3);
    }
    let fallen = first.iter().zip(&last).map(|(a, b)| number(b, start("pos") + 2) - number(a, start("pos") + 2));
    let most = fallen.fold(0.0f64, |most, way| most.max(-way));
    assert!((most / (0.5 * 9.81 * 4e-6) - 1.0).abs() < 1e-3, "{most}");
}

/// The mass below the sieves is that of the curve, within the mass of the largest particle.
#[test]
fn sizes_are_those_of_the_sieve_curve() {
    for seed in 1..4 {
        let place = Workplace::new(&FALL.replace("SEED", &seed.to_string()));
        run(&place, "one", "1");
        let (properties, rows) = read(&place.path("one/particles/particles-00000.xyz"));
        let radius = properties.iter().take_while(|(own, _)| own != "radius").map(|(_, n)| n).sum::<usize>();
        let diameters: Vec<f64> = rows.iter().map(|row| 2.0 * row[radius].parse::<f64>().unwrap()).collect();
        let mass = |below: f64| diameters.iter().filter(|d| **d < below).map(|d| d.powi(3)).sum::<f64>();
        let largest = 4e-3f64.powi(3) / mass(1.0);
        for (sieve, share) in [(1e-3, 0.0), (1.5e-3, 0.2), (2e-3, 0.4), (3e-3, 0.7), (4.001e-3, 1.0)] {
            let found = mass(sieve) / mass(1.0);
            assert!((found - share).abs() < 1.5 * largest, "seed {seed}, {sieve} m: {found}");
        }
        let filled = mass(1.0) * std::f64::consts::PI / 6.0 / 8e-6;
        assert!((filled / 0.25 - 1.0).abs() < 0.05, "{filled}");
    }
}
