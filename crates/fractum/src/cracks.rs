//! Cracks as data: broken bonds in a table for scripts and as lines for ParaView, and the facets that removal has exposed.

use std::fmt::Write as _;
use std::path::Path;

use fractum_dem::Crack;
use fractum_dem::criterion::BreakMode;
use fractum_fem::{CrackSurface, Solid};
use fractum_io::vtk::{Field, PendingFile, PolyCells, PolyData};
use fractum_io::{Compression, atomic};

use crate::error::Failure;

/// What stands in the columns of a table of cracks that differ between the tests of the laboratory and a run.
#[derive(Clone, Copy, Debug)]
pub struct Columns {
    /// Name of the column of [`Crack::time`], with its unit.
    pub time: &'static str,
    /// Name of the column of [`Crack::load`], with its unit, and the factor to that unit.
    pub load: Option<(&'static str, f64)>,
}

/// Writes `cracks.csv`: one line per broken bond, with the name of its body where there is one.
///
/// # Errors
/// A file that cannot be written.
pub fn write_table<'a>(
    path: &Path,
    cracks: impl Iterator<Item = (Option<&'a str>, &'a Crack)>,
    columns: Columns,
) -> Result<(), Failure> {
    let mut cracks = cracks.peekable();
    let named = cracks.peek().is_some_and(|(body, _)| body.is_some());
    let load = columns.load.map_or(String::new(), |(name, _)| format!("{name},"));
    let body = if named { "body," } else { "" };
    let mut text = format!(
        "{body}bond,first,second,event,{},{load}x [m],y [m],z [m],nx,ny,nz,area [m^2],mode,energy [J]\n",
        columns.time
    );
    for (body, c) in cracks {
        let ([i, j], x, n) = (c.pair, c.position, c.normal);
        if let Some(body) = body {
            text += &format!("\"{body}\",");
        }
        // Writing into a string has no way to fail.
        let _ = write!(text, "{},{i},{j},{},{:e},", c.bond, c.event, c.time);
        if let Some((_, factor)) = columns.load {
            let _ = write!(text, "{:e},", c.load * factor);
        }
        let _ = writeln!(
            text,
            "{:e},{:e},{:e},{:.6},{:.6},{:.6},{:e},{},{:e}",
            x.x,
            x.y,
            x.z,
            n.x,
            n.y,
            n.z,
            c.area,
            c.mode.word(),
            c.energy
        );
    }
    Ok(atomic::write(path, text.as_bytes())?)
}

/// Writes broken bonds as lines between the centres of their particles, with mode, event, time, area, load and energy.
///
/// # Errors
/// A file that cannot be written.
pub fn write_lines<'a>(
    path: &Path,
    points: &[[f64; 3]],
    cracks: impl Iterator<Item = &'a Crack> + Clone,
) -> Result<(), Failure> {
    let lines: Vec<[u32; 2]> = cracks.clone().map(|c| c.pair).collect();
    let code = |mode: BreakMode| BreakMode::ALL.iter().position(|&m| m == mode).unwrap_or_default() as i32;
    let modes: Vec<i32> = cracks.clone().map(|c| code(c.mode)).collect();
    let events: Vec<i32> = cracks.clone().map(|c| c.event as i32).collect();
    let column = |f: &dyn Fn(&Crack) -> f64| cracks.clone().map(f).collect::<Vec<f64>>();
    let (time, load) = (column(&|c| c.time), column(&|c| c.load));
    let (area, energy) = (column(&|c| c.area), column(&|c| c.energy));
    let data = PolyData {
        points,
        cells: PolyCells::Lines(&lines),
        point_data: &[],
        cell_data: &[
            Field::integer("mode", &modes),
            Field::integer("event", &events),
            Field::scalar("time", &time),
            Field::scalar("load", &load),
            Field::scalar("area", &area),
            Field::scalar("energy", &energy),
        ],
        time: None,
    };
    data.write(path, Compression::default()).map_err(|e| Failure::Output(e.into()))
}

/// The file of the facets that the removal of elements has exposed, without load and with their displacement, normal, opening and
/// body.
///
/// # Errors
/// Arrays that do not fit together.
pub(crate) fn facets_file(path: &Path, solid: &Solid, crack: &CrackSurface) -> Result<PendingFile, Failure> {
    let mut nodes: Vec<u32> = crack.facets.iter().flat_map(|facet| facet.nodes).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let points: Vec<[f64; 3]> = nodes.iter().map(|&n| solid.reference[n as usize].into()).collect();
    let displacement: Vec<[f64; 3]> = nodes.iter().map(|&n| solid.displacement_from_start(n as usize).into()).collect();
    let place = |node: u32| nodes.binary_search(&node).map_or(0, |place| place as u32);
    let triangles: Vec<[u32; 3]> = crack.facets.iter().map(|facet| facet.nodes.map(place)).collect();
    let lines: Vec<[u32; 2]> = triangles.iter().map(|&[a, b, _]| [a, b]).collect();
    let plane = triangles.iter().all(|[_, b, c]| b == c);
    let cells = if plane { PolyCells::Lines(&lines) } else { PolyCells::Triangles(&triangles) };
    let normal: Vec<[f64; 3]> = crack.facets.iter().map(|facet| facet.normal.into()).collect();
    let opening: Vec<f64> = crack.facets.iter().map(|facet| facet.opening).collect();
    let bodies: Vec<i32> = crack.facets.iter().map(|facet| facet.body as i32).collect();
    let data = PolyData {
        points: &points,
        cells,
        point_data: &[Field::vector("displacement", &displacement)],
        cell_data: &[
            Field::vector("normal", &normal),
            Field::scalar("opening", &opening),
            Field::integer("body", &bodies),
        ],
        time: None,
    };
    data.pending(path, Compression::default()).map_err(|e| Failure::Output(e.into()))
}

/// Bonds that every particle has lost.
pub fn lost_bonds<'a>(particles: usize, cracks: impl Iterator<Item = &'a Crack>) -> Vec<f64> {
    let mut lost = vec![0.0; particles];
    cracks.flat_map(|crack| crack.pair).for_each(|i| lost[i as usize] += 1.0);
    lost
}
