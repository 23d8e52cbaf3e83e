//! Particles as extended xyz, a text file per frame that OVITO, ASE and others read: at their present positions.

use std::fmt::Write as _;

use fractum_scene::{PeriodicCell, Scene, into_periodic_box, periodic_cell_of};
use fractum_vtk::PendingFile;

use crate::frames::cracks::lost_bonds;
use crate::number::push_shortest;

/// Name of the files, below the folder of the results.
pub(super) const FILES: &str = "particles/particles.xyz";

/// Columns: name and kind of each property, as OVITO calls them, with the number of its values.
const PROPERTIES: &str = "species:S:1:id:I:1:pos:R:3:radius:R:1:mass:R:1:velo:R:3:angular_velocity:R:3:\
                          orientation:R:4:force:R:3:torque:R:3:broken_bonds:I:1";

/// The particles of all bodies that are in the run; none where there are no bodies of particles.
pub(super) fn file(scene: &Scene) -> Option<PendingFile> {
    let (bonded, all) = (&scene.bonded, &scene.bonded.particles);
    if all.is_empty() {
        return None;
    }
    let present: Vec<usize> = (0..all.len()).filter(|&i| !all.is_out(i)).collect();
    let mut text = String::new();
    // Writing to a String cannot fail.
    // Only scenes with clumps have the column; -1 for particles of none.
    let (clumps, mass) = (bonded.clumps().of_particles(all.len()), bonded.clumps().masses(all));
    let of_clumps = if clumps.is_empty() { "" } else { ":clump:I:1" };
    let _ = write!(text, "{}\nProperties={PROPERTIES}{of_clumps} Time=", present.len());
    push_shortest(&mut text, scene.clock.time);
    let _ = write!(text, " Step={}", scene.clock.step);
    match periodic_cell_of(scene) {
        Some(cell) => push_cell(&mut text, cell),
        None => text.push_str(" pbc=\"F F F\"\n"),
    }
    let lost = lost_bonds(all.len(), bonded.bodies().iter().flat_map(|body| body.cracks()));
    let mut bodies = bonded.bodies().iter();
    let mut body = bodies.next();
    for i in present {
        while body.is_some_and(|own| own.range.end <= i) {
            body = bodies.next();
        }
        let name = body.map_or("", |own| own.name.as_str());
        // A blank would begin the next column.
        text.extend(name.chars().map(|c| if c.is_whitespace() { '_' } else { c }));
        let _ = write!(text, " {i}");
        let turn = all.orientation[i].coords;
        let [beyond, faster] = into_periodic_box(scene, &all.position[i]);
        let vectors = |of: &fractum_math::Vec3| [of.x, of.y, of.z];
        let columns = [
            &vectors(&(all.position[i] + beyond))[..],
            &[all.radius[i], mass[i]],
            &vectors(&(all.velocity[i] + faster)),
            &vectors(&all.spin[i]),
            &[turn.x, turn.y, turn.z, turn.w],
            &vectors(&all.force[i]),
            &vectors(&all.moment[i]),
        ];
        for value in columns.into_iter().flatten() {
            text.push(' ');
            push_shortest(&mut text, *value);
        }
        let _ = write!(text, " {}", lost[i]);
        if let Some(clump) = clumps.get(i) {
            let _ = write!(text, " {}", *clump as i32);
        }
        text.push('\n');
    }
    Some(PendingFile::of_text(text))
}

/// The box that repeats, by edges and corner, as OVITO reads them.
fn push_cell(text: &mut String, cell: &PeriodicCell) {
    let repeats = cell.repeats.map(|repeats| if repeats { "T" } else { "F" }).join(" ");
    let _ = write!(text, " pbc=\"{repeats}\" Lattice=\"");
    let (edges, corner) = (cell.least_oblique(), cell.corner);
    for (index, value) in edges.iter().enumerate() {
        if index > 0 {
            text.push(' ');
        }
        push_shortest(text, *value);
    }
    text.push_str("\" Origin=\"");
    for (index, value) in corner.iter().enumerate() {
        if index > 0 {
            text.push(' ');
        }
        push_shortest(text, *value);
    }
    text.push_str("\"\n");
}
