use super::*;

fn of(text: &str) -> ParticleFile<'_> {
    ParticleFile { bytes: text.as_bytes(), unit: 1e-3, velocity_unit: None, frame: None, species: None }
}

fn wrong(asked: &ParticleFile<'_>) -> String {
    let fault = read(asked).expect_err("a mistake");
    format!("{}; expected {}", fault.found, fault.expected)
}

/// Two particles at (1, 1, 1) and (3, 1, 1) mm of radius 0.5 mm.
fn check(text: &str, format: &str) -> FileParticles {
    let found = read(&of(text)).unwrap_or_else(|fault| panic!("{format}: {}", fault.found));
    assert!(found.told().contains(format), "{}", found.told());
    assert_eq!(found.radius, [0.5e-3; 2], "{format}");
    let places = [[1e-3; 3], [3e-3, 1e-3, 1e-3]].map(Vec3::from);
    for (found, right) in found.position.iter().zip(places) {
        assert!((found - right).norm() < 1e-15, "{format}: {found:?}");
    }
    found
}

const DATA: &str = "LAMMPS data file via write_data

2 atoms
1 bonds
1 atom types

0 10 xlo xhi
0 10 ylo yhi
0 10 zlo zhi

Atoms # sphere

2 1 1.0 2500 3.0 1.0 1.0 0 0 0
1 1 1.0 2500 1.0 1.0 1.0 0 0 0

Velocities

1 1 2 3 4 5 6
2 -1 0 0 0 0 0

Bonds

1 1 1 2
";

const DUMP: &str = "ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp pp ff
0 10
0 10
0 10
ITEM: ATOMS id type x y z radius vx vy vz
2 2 9 9 9 0.5 0 0 1
1 1 8 8 8 0.5 0 0 1
ITEM: TIMESTEP
100
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp pp ff
0 10
0 10
0 10
ITEM: ATOMS id type x y z radius vx vy vz
2 2 3 1 1 0.5 0 0 1
1 1 1 1 1 0.5 0 0 2
";

const XYZ: &str = "2
Properties=species:S:1:pos:R:3:radius:R:1:velo:R:3 Time=0.0
fine 1 1 1 0.5 0 0 1
coarse 3 1 1 0.5 0 0 2
";

#[test]
fn every_format_gives_the_same_particles() {
    check("x,y,z,radius\n1,1,1,0.5\n3,1,1,0.5\n", "a table");
    check("1 1 1 0.5\n3; 1; 1; 0.5 # the other\n", "a table");
    check("id,x [mm],y [mm],z [mm],diameter\n7,1,1,1,1\n9,3,1,1,1\n", "a table");
    check("#format x_y_z_r\n1.0\t1.0\t1.0\t0.5\n3.0\t1.0\t1.0\t0.5\n", "YADE");
    check("#format x_y_z_r_matId\n1.0\t1.0\t1.0\t0.5\t0\n3.0\t1.0\t1.0\t0.5\t0\n", "YADE");
    let data = check(DATA, "LAMMPS data file");
    assert!(data.told().contains("without its velocities"), "{}", data.told());
    assert_eq!(data.bonds, [[0, 1]]);
    check(&DATA.replace("# sphere", "# bpm/sphere").replace(" 1 1.0 2500", " 1 1 1.0 2500"), "LAMMPS data file");
    assert!(check(DUMP, "LAMMPS dump").told().contains("frame 1 of 2, step 100"));
    check(
        &DUMP
            .replace("id type x y z radius", "id type xs ys zs diameter")
            .replace(" 3 1 1 0.5", " 0.3 0.1 0.1 1.0")
            .replace(" 1 1 1 0.5", " 0.1 0.1 0.1 1.0"),
        "LAMMPS dump",
    );
    check(XYZ, "extended xyz");
}

#[test]
fn frames_types_and_velocities_are_chosen() {
    let first = read(&ParticleFile { frame: Some(0), ..of(DUMP) }).unwrap_or_else(|f| panic!("{}", f.found));
    assert!((first.position[0].x - 8e-3).abs() < 1e-15);
    let one = read(&ParticleFile { species: Some("coarse"), ..of(XYZ) }).unwrap_or_else(|f| panic!("{}", f.found));
    assert_eq!((one.position.len(), one.velocity.len()), (1, 0));
    let moving = ParticleFile { velocity_unit: Some(1e-3), ..of(DATA) };
    let moving = read(&moving).unwrap_or_else(|f| panic!("{}", f.found));
    // Numbers of the file decide the order.
    assert_eq!(moving.velocity, [Vec3::new(1e-3, 2e-3, 3e-3), Vec3::new(-1e-3, 0.0, 0.0)]);
    assert_eq!(moving.spin[0], Vec3::new(4.0, 5.0, 6.0));
    let dump = ParticleFile { velocity_unit: Some(1.0), ..of(DUMP) };
    let dump = read(&dump).unwrap_or_else(|f| panic!("{}", f.found));
    assert_eq!((dump.velocity[0].z, dump.spin.len()), (2.0, 0));
}

#[test]
fn mistakes_are_named_with_their_lines() {
    let line = |text: &str, words: &[&str]| {
        let found = wrong(&of(text));
        assert!(words.iter().all(|word| found.contains(word)), "{found}");
    };
    line("1 1 1 0.5\n3 1 1\n", &["line 2: `3 1 1`", "rows of x, y, z, radius"]);
    line("1 1 1 -0.5\n", &["line 1"]);
    line("1 1 a 0.5\n", &["line 1"]);
    line("", &["holds no particle"]);
    line(&DATA.replace("3.0 1.0 1.0", "3.0 1.0 a"), &["line 13: `a`", "a number"]);
    line(&DATA.replace("# sphere", "# molecular"), &["line 13: atoms of the style molecular", "bpm/sphere"]);
    line(&DATA.replace("2 atoms", "3 atoms"), &["after 2 of 3 atoms"]);
    line(&DATA.replace("1 1 1.0 2500 1", "2 1 1.0 2500 1"), &["lines 13 and 14: both are particle 2"]);
    line(&DATA.replace("1 1 1.0 2500", "1 1 0.0 2500"), &["line 14: an atom without a diameter"]);
    line(&DATA.replace("1 1 1 2\n", "1 1 1 7\n"), &["line 23: a bond of particle 7, which is not there"]);
    line(&DATA.replace("1 1 1 2\n", "1 1 1\n"), &["line 23: `1 1 1`", "the numbers of two atoms"]);
    line(&DUMP.replace(" radius", " mass"), &["line 20: has no column radius or diameter"]);
    line(&DUMP[..DUMP.len() - 20], &["the file ends here", "as many atoms"]);
    line(&XYZ.replace("radius:R:1", "mass:R:1"), &["line 2: has no radius"]);
    line("2\nplain\nA 1 1 1\nA 3 1 1\n", &["line 2: names no properties"]);
    line(&XYZ.replace("coarse 3 1 1 0.5 0 0 2\n", ""), &["the file ends here"]);
    assert!(wrong(&ParticleFile { frame: Some(4), ..of(DUMP) }).contains("has 2 frames, no frame 4"));
    assert!(wrong(&ParticleFile { frame: Some(0), ..of(DATA) }).contains("which has no frames"));
    assert!(wrong(&ParticleFile { species: Some("sand"), ..of(XYZ) }).contains("it has coarse, fine"));
    assert!(wrong(&ParticleFile { species: Some("1"), ..of("1 1 1 0.5") }).contains("have no types"));
    assert!(wrong(&ParticleFile { velocity_unit: Some(1.0), ..of("1 1 1 0.5") }).contains("without velocities"));
    assert!(wrong(&ParticleFile { bytes: b"\xff\xfe", ..of("") }).contains("is not text"));
}
