//! One count of fragments in the probe, the summary, the table and the history.

use std::fs;

use crate::common::{BREAKING_BAR, Workplace, bar, history, mesh_bytes, run, summary};
use fractum_math::Vec3;
use fractum_mesh::generate::structured_box;
use fractum_mesh::{Group, Mesh, MshFormat};

/// The breaking bar with a probe of the number of fragments.
fn counted(output: &str) -> String {
    BREAKING_BAR
        .replace("[output]", &format!("[[probes]]\nname = \"pieces\"\ncount = \"fragments\"\n\n[output]\n{output}"))
}

#[test]
fn probe_summary_and_table_count_the_same_fragments() {
    let place = Workplace::new(&counted(""));
    let summary = run(&place, "results", "1");
    let table = fs::read_to_string(place.path("results/fragments.csv")).unwrap();
    let listed = table.lines().count() as u64 - 1;
    assert!(summary["counts"]["particles"].as_u64() > Some(0) && listed >= 2, "{}", summary["counts"]);
    assert_eq!(summary["counts"]["fragments"].as_u64(), Some(listed));
    assert_eq!(summary["probes"]["pieces"]["final"].as_f64(), Some(listed as f64));
    assert!(table.lines().skip(1).all(|line| line.split(',').nth(3).unwrap().parse::<u64>().unwrap() > 1), "{table}");
}

#[test]
fn a_body_in_single_nodes_is_warned_of() {
    // Strong enough for its own weight, and no more: the pull damages every edge.
    let case = counted("fragments = { joined_below = 1e-9 }").replace("if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)", "0.01");
    let place = Workplace::new(&case);
    let ended = place.fractum(&["run", "case.toml", "-o", "results"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("body \"bar\": warning: ") && ended.stderr.contains("single nodes"),
        "{}",
        ended.stderr
    );
}

#[test]
fn a_phase_field_whose_bands_leave_no_fragments_is_told() {
    // All of the bar is stretched at once, so that it breaks nearly everywhere.
    let mut case = BREAKING_BAR
        .replace("fracture_energy", "regularisation = \"phase-field\"\nreduce_strength_to_fit = true\nfracture_energy")
        .replace("{ y = \"-0.1 m/s\" }", "{ x = \"(x/30 cm - 1)*50 m/s\" }");
    for (slow, fast) in [("-0.2 m/s", "-50 m/s"), ("0.2 m/s", "50 m/s")] {
        case = case.replace(
            &format!("[[\"0 s\", \"0 m/s\"], [\"0.2 ms\", \"{slow}\"]]"),
            &format!("[[\"0 s\", \"{fast}\"], [\"0.2 ms\", \"{fast}\"]]"),
        );
    }
    let place = Workplace::new(&case);
    let ended = place.fractum(&["run", "case.toml", "-o", "results"]);
    assert_ne!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("leave no fragments") && ended.stderr.contains("phase field"), "{}", ended.stderr);
    assert!(summary(&place, "results")["status"] == "stopped", "{}", ended.stderr);
}

/// The bar with a block of its own beyond its end.
fn bar_and_chip() -> Mesh {
    let (mut mesh, chip) = (bar(), structured_box([2, 3, 3], Vec3::new(0.1, 0.12, 0.12), None));
    let (nodes, tags) = (mesh.nodes.len() as u32, (mesh.triangles.len() + mesh.tetrahedra.len()) as u64);
    let before = mesh.tetrahedra.len() as u32;
    mesh.nodes.extend(chip.nodes.iter().map(|x| x + Vec3::new(0.6, 0.0, 0.0)));
    mesh.node_tags = (1..=mesh.nodes.len() as u64).collect();
    mesh.tetrahedra.extend(chip.tetrahedra.iter().map(|element| element.map(|node| node + nodes)));
    mesh.tetrahedron_tags.extend((1..).map(|tag| tags + tag).take(chip.tetrahedra.len()));
    let tetrahedra = (before..mesh.tetrahedra.len() as u32).collect();
    mesh.groups.push(Group { name: "chip".into(), dimension: 3, tag: 2, tetrahedra, ..Group::default() });
    mesh
}

#[test]
fn cracks_have_their_times_also_after_a_piece_has_left_the_domain() {
    let chip = "[[bodies]]\nname = \"chip\"\nkind = \"solid\"\ngroup = \"chip\"\nmaterial = \"concrete\"\n\
                kinematics = \"corotational\"\ninitial_velocity = { x = \"500 m/s\" }\n\n[[supports]]";
    // The chip counts in the stable step, so that another step would follow once it has left.
    let case =
        BREAKING_BAR.replacen("[[supports]]", chip, 1).replace("end = \"end\"", "end = \"end\"\nstep = \"1 us\"");
    let within = "step = \"1 us\"\ndomain = { min = [-1, -1, -1], max = [0.72, 1, 1] }";
    let tables = [case.clone(), case.replace("step = \"1 us\"", within)].map(|case| {
        let place = Workplace::with_mesh(&case, &mesh_bytes(&bar_and_chip(), MshFormat::V4_1Binary));
        let summary = run(&place, "results", "2");
        let rows = history(&place, "results", &["time", "removed_elements"]);
        let text = fs::read_to_string(place.path("results/cracks.csv")).unwrap();
        let times: Vec<String> =
            text.lines().skip(1).map(|line| line.split(',').take(4).collect::<Vec<_>>().join(",")).collect();
        (summary["domain"].clone(), rows, times)
    });
    let [(_, rows, whole), (left, _, cut)] = tables;
    assert!(rows.len() > 50 && whole.len() > 20, "{rows:?}");
    assert_eq!(cut, whole, "{left}");
}
