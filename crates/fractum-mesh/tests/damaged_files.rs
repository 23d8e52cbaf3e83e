//! Files damaged at random are read into a sound mesh or refused; nothing panics or runs away.

use fractum_mesh::{Mesh, MshFormat, quality, read_mesh, read_msh, write_msh};
use proptest::prelude::*;

const FILES: [&str; 20] = [
    "all-22-ascii",
    "boxes-22-binary",
    "boxes-41-ascii",
    "boxes-41-binary",
    "data-22-binary",
    "layers-41-binary",
    "parametric-22-binary",
    "parametric-41-ascii",
    "parts-41-ascii",
    "plane-41-binary",
    "quadratic-22-ascii",
    "sparse-41-ascii",
    "storage-22-big",
    "storage-41-big-4",
    "box.inp",
    "part.inp",
    "plane.inp",
    "grid-ascii.vtu",
    "grid-inline-zlib.vtu",
    "grid-appended-raw.vtu",
];

fn bytes_of(file: usize) -> Vec<u8> {
    let ending = if FILES[file].contains('.') { "" } else { ".msh" };
    let path = format!("{}/tests/data/{}{ending}", env!("CARGO_MANIFEST_DIR"), FILES[file]);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// One damage; places are fractions of the length of the file.
#[derive(Clone, Debug)]
enum Damage {
    Byte(f64, u8),
    Bit(f64, u8),
    Number(f64, u64, usize),
    Field(f64, &'static str),
    Remove(f64, usize),
    Repeat(f64, usize),
    Move(f64, f64, usize),
    Cut(f64),
}

fn damage() -> impl Strategy<Value = Damage> {
    let numbers = prop_oneof![
        Just(0u64),
        Just(1),
        Just(u64::MAX),
        Just(i64::MIN as u64),
        Just(0x7fff_ffff),
        Just(0x8000_0000),
        Just(f64::NAN.to_bits()),
        Just(1u64 << 40),
        any::<u64>(),
        0u64..200,
    ];
    let fields = prop::sample::select(vec![
        "",
        "0",
        "-1",
        "1",
        "4",
        "15",
        "nan",
        "1e308",
        "99999999999",
        "18446744073709551615",
        "$Nodes",
        "\"",
        "\n",
        "$EndElements",
        "\u{fffd}",
        "1 1",
        "0x10",
        "+5",
        "-0",
        "*ELSET, ELSET=part\n1, 18446744073709551615, 1",
        "*NSET, NSET=a, GENERATE\n0, 18446744073709551615, 0\n*NSET, NSET=left\na, a,\n",
        "**",
        ",",
    ]);
    prop_oneof![
        (0.0..1.0, any::<u8>()).prop_map(|(at, value)| Damage::Byte(at, value)),
        (0.0..1.0, 0u8..8).prop_map(|(at, bit)| Damage::Bit(at, bit)),
        (0.0..1.0, numbers, prop::sample::select(vec![4usize, 8]))
            .prop_map(|(at, n, size)| Damage::Number(at, n, size)),
        (0.0..1.0, fields).prop_map(|(at, text)| Damage::Field(at, text)),
        (0.0..1.0, 1usize..40).prop_map(|(at, length)| Damage::Remove(at, length)),
        (0.0..1.0, 1usize..400).prop_map(|(at, length)| Damage::Repeat(at, length)),
        (0.0..1.0, 0.0..1.0, 1usize..100).prop_map(|(from, to, length)| Damage::Move(from, to, length)),
        (0.0..1.0).prop_map(Damage::Cut),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    let length = bytes.len();
    let place = |at: f64| ((at * length as f64) as usize).min(length.saturating_sub(1));
    if length < 8 {
        return;
    }
    match *damage {
        Damage::Byte(at, value) => bytes[place(at)] = value,
        Damage::Bit(at, bit) => bytes[place(at)] ^= 1 << bit,
        Damage::Number(at, value, size) => {
            let start = place(at).min(length - 8);
            bytes[start..start + size].copy_from_slice(&value.to_le_bytes()[..size]);
        }
        Damage::Field(at, text) => {
            let is_blank = |byte: &u8| byte.is_ascii_whitespace();
            let start = bytes[..place(at)].iter().rposition(is_blank).map_or(0, |blank| blank + 1);
            let end = bytes[start..].iter().position(is_blank).map_or(length, |blank| start + blank);
            bytes.splice(start..end, text.bytes());
        }
        Damage::Remove(at, count) => drop(bytes.drain(place(at)..(place(at) + count).min(length))),
        Damage::Repeat(at, count) => {
            let copy = bytes[place(at)..(place(at) + count).min(length)].to_vec();
            bytes.splice(place(at)..place(at), copy);
        }
        Damage::Move(from, to, count) => {
            let piece: Vec<u8> = bytes.drain(place(from)..(place(from) + count).min(length)).collect();
            let to = place(to).min(bytes.len());
            bytes.splice(to..to, piece);
        }
        Damage::Cut(at) => bytes.truncate(place(at)),
    }
}

/// What the reader promises of every mesh.
fn check(mesh: &Mesh) {
    let count = mesh.nodes.len();
    assert!(mesh.element_count() > 0 && mesh.node_tags.len() == count);
    assert!(mesh.nodes.iter().all(|node| node.iter().all(|x| x.is_finite())));
    let mut used = vec![false; count];
    let mut mark = |nodes: &[u32]| nodes.iter().for_each(|&node| used[node as usize] = true);
    mark(mesh.points.as_flattened());
    mark(mesh.lines.as_flattened());
    mark(mesh.triangles.as_flattened());
    mark(mesh.tetrahedra.as_flattened());
    assert!(used.iter().all(|&used| used));
    assert!(mesh.tetrahedra.iter().all(|e| quality::signed_volume(e.map(|n| mesh.nodes[n as usize])) > 0.0));
    let mut tags: Vec<u64> = [&mesh.point_tags, &mesh.line_tags, &mesh.triangle_tags, &mesh.tetrahedron_tags]
        .into_iter()
        .flatten()
        .copied()
        .collect();
    assert_eq!(tags.len(), mesh.element_count());
    tags.sort_unstable();
    assert!(tags.windows(2).all(|pair| pair[0] < pair[1]), "element tags are unique");
    assert!(mesh.groups.windows(2).all(|pair| (pair[0].dimension, pair[0].tag) < (pair[1].dimension, pair[1].tag)));
    for group in &mesh.groups {
        for (members, length) in [
            (&group.points, mesh.points.len()),
            (&group.lines, mesh.lines.len()),
            (&group.triangles, mesh.triangles.len()),
            (&group.tetrahedra, mesh.tetrahedra.len()),
        ] {
            assert!(members.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(members.last().is_none_or(|&last| (last as usize) < length));
        }
    }
}

/// Reads; what is accepted is sound and survives being written, unless its groups cannot be written.
fn read_or_refuse(bytes: &[u8]) {
    let mut mesh = match read_mesh(bytes) {
        Ok(mesh) => mesh,
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with("line ") || text.starts_with("byte "), "{text}");
            assert!(text.len() < 1000 && !text.contains('\n'), "{text}");
            return;
        }
    };
    check(&mesh);
    mesh.notices.clear();
    let mut written = Vec::new();
    match write_msh(&mesh, MshFormat::V4_1Binary, &mut written) {
        Ok(()) => {
            let mut back = read_msh(&written).expect("what was accepted is written soundly");
            back.notices.clear();
            assert_eq!(back, mesh);
        }
        Err(error) => assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_read_soundly_or_refused(
        file in 0..FILES.len(),
        damages in prop::collection::vec(damage(), 1..4),
    ) {
        let mut bytes = bytes_of(file);
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        read_or_refuse(&bytes);
    }

    #[test]
    fn random_bytes_behind_a_header_are_refused_or_read(
        header in prop::sample::select(vec![
            &b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"[..],
            b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n",
            b"$MeshFormat\n4.1 1 4\n\0\0\0\x01\n$EndMeshFormat\n$Entities\n",
            b"$MeshFormat\n2.2 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n$Elements\n7\n",
            b"",
            b"*NODE\n1,0,0\n*ELEMENT, TYPE=C3D10, ELSET=a\n",
        ]),
        noise in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        read_or_refuse(&[header, &noise].concat());
    }
}

#[test]
fn every_beginning_of_a_file_is_read_soundly_or_refused() {
    for file in 0..FILES.len() {
        let bytes = bytes_of(file);
        let step = bytes.len() / 200 + 1;
        (0..bytes.len()).step_by(step).for_each(|end| read_or_refuse(&bytes[..end]));
    }
}
