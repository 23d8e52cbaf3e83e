//! Cracks as data: broken bonds in a table for scripts and as lines for ParaView, and the facets that removal has exposed.

use std::fmt::Write as _;

use fractum_dem::Crack;
use fractum_dem::criterion::BreakMode;
use fractum_fem::{CrackSurface, Solid};
use fractum_math::{Vec3, rotation_between};
use fractum_vtk::{Compression, Field, PendingFile, PolyCells, PolyData};

use crate::OutputError;
use crate::history::quoted;

/// What stands in the columns of a table of cracks that differ between the tests of the laboratory and a run.
#[derive(Clone, Copy, Debug)]
pub struct Columns {
    /// Name of the column of [`Crack::time`], with its unit.
    pub time: &'static str,
    /// Name of the column of [`Crack::load`], with its unit, and the factor to that unit.
    pub load: Option<(&'static str, f64)>,
}

/// The text of `cracks.csv`: one line per broken bond, with the name of its body where there is one.
pub fn table<'a>(cracks: impl Iterator<Item = (Option<&'a str>, &'a Crack)>, columns: Columns) -> String {
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
        // Writing into a string has no way to fail.
        if let Some(body) = body {
            let _ = write!(text, "{},", quoted(body));
        }
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
    text
}

/// Broken bonds as the facets that they stand for: regular hexagons of their area, across the bond, where it was in the
/// undeformed body; with mode, event, time, area, normal, load and energy.
///
/// - `displacement`: how far a particle has moved [m]; with it the hexagons have their displacement and opening
///
/// # Errors
/// Fields that do not fit together.
pub fn polygons<'a>(
    cracks: impl Iterator<Item = &'a Crack> + Clone,
    displacement: Option<&dyn Fn(u32) -> Vec3>,
) -> Result<PendingFile, OutputError> {
    let points: Vec<[f64; 3]> = cracks.clone().flat_map(hexagon).map(Into::into).collect();
    let hexagons: Vec<[u32; 6]> = (0..cracks.clone().count() as u32)
        .map(|facet| std::array::from_fn(|corner| 6 * facet + corner as u32))
        .collect();
    let code = |mode: BreakMode| BreakMode::ALL.iter().position(|&m| m == mode).unwrap_or_default() as i32;
    let modes: Vec<i32> = cracks.clone().map(|c| code(c.mode)).collect();
    let events: Vec<i32> = cracks.clone().map(|c| c.event as i32).collect();
    let column = |f: &dyn Fn(&Crack) -> f64| cracks.clone().map(f).collect::<Vec<f64>>();
    let (time, load) = (column(&|c| c.time), column(&|c| c.load));
    let (area, energy) = (column(&|c| c.area), column(&|c| c.energy));
    let normal: Vec<[f64; 3]> = cracks.clone().map(|c| c.normal.into()).collect();
    let moved = displacement.map(|of| {
        let pair = |c: &Crack| c.pair.map(of);
        let mean: Vec<[f64; 3]> =
            cracks.clone().map(pair).flat_map(|[a, b]| [(a + b) * 0.5; 6]).map(Into::into).collect();
        (mean, column(&|c| (pair(c)[1] - pair(c)[0]).dot(&c.normal)))
    });
    let mut cell_data = vec![
        Field::integer("mode", &modes),
        Field::integer("event", &events),
        Field::scalar("time", &time),
        Field::scalar("load", &load),
        Field::scalar("area", &area),
        Field::scalar("energy", &energy),
        Field::vector("normal", &normal),
    ];
    let mut point_data = Vec::new();
    if let Some((displacement, opening)) = &moved {
        point_data.push(Field::vector("displacement", displacement));
        cell_data.push(Field::scalar("opening", opening));
    }
    let cells = PolyCells::Hexagons(&hexagons);
    let data = PolyData { points: &points, cells, point_data: &point_data, cell_data: &cell_data, time: None };
    data.pending(Compression::default()).map_err(OutputError::from)
}

/// Corners of a regular hexagon of the area of a crack, across its normal. With side a, the area is 3√3/2 a².
fn hexagon(crack: &Crack) -> [Vec3; 6] {
    let side = (crack.area * 2.0 / (3.0 * 3.0f64.sqrt())).sqrt();
    let turn = rotation_between(&Vec3::z(), &crack.normal);
    let (half, height) = (0.5 * side, 0.5 * 3.0f64.sqrt() * side);
    let flat = [(side, 0.0), (half, height), (-half, height), (-side, 0.0), (-half, -height), (half, -height)];
    flat.map(|(x, y)| crack.position + turn * Vec3::new(x, y, 0.0))
}

/// The facets that the removal of elements has exposed, without load and with their displacement, normal, opening and body.
///
/// - `history`: when the element before each facet was removed, and the fragment that each facet belongs to
///
/// # Errors
/// Fields that do not fit together.
pub fn facets_file(
    solid: &Solid,
    crack: &CrackSurface,
    history: Option<&FacetHistory>,
) -> Result<PendingFile, OutputError> {
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
    let mut cell_data =
        vec![Field::vector("normal", &normal), Field::scalar("opening", &opening), Field::integer("body", &bodies)];
    if let Some(FacetHistory { time, fragment }) = history {
        cell_data.extend([Field::scalar("time", time), Field::integer("fragment", fragment)]);
    }
    let point_data = [Field::vector("displacement", &displacement)];
    let data = PolyData { points: &points, cells, point_data: &point_data, cell_data: &cell_data, time: None };
    data.pending(Compression::default()).map_err(OutputError::from)
}

/// What is known of every facet of a crack at the end of a run.
pub struct FacetHistory {
    /// When the element before it was first missing in a row of the history, else now [s]; the load factor at rest.
    pub time: Vec<f64>,
    /// Number of its fragment; 0 for single nodes.
    pub fragment: Vec<i32>,
}

/// A table of the facets that the removal of elements has exposed: one line each, where it is now.
pub fn facets_table(solid: &Solid, crack: &CrackSurface, history: &FacetHistory) -> String {
    let mut text =
        "body,element,removed,time [s],x [m],y [m],z [m],nx,ny,nz,area [m^2],opening [m],fragment\n".to_owned();
    for ((facet, time), fragment) in crack.facets.iter().zip(&history.time).zip(&history.fragment) {
        let (body, x, n) = (&solid.body(facet.body).name, facet.centre, facet.normal);
        // Writing into a string has no way to fail.
        let _ = writeln!(
            text,
            "{},{},{},{time:e},{:e},{:e},{:e},{:.6},{:.6},{:.6},{:e},{:e},{fragment}",
            quoted(body),
            facet.element,
            facet.removed.1,
            x.x,
            x.y,
            x.z,
            n.x,
            n.y,
            n.z,
            facet.area,
            facet.opening
        );
    }
    text
}

/// Bonds that every particle has lost.
pub fn lost_bonds<'a>(particles: usize, cracks: impl Iterator<Item = &'a Crack>) -> Vec<f64> {
    let mut lost = vec![0.0; particles];
    cracks.flat_map(|crack| crack.pair).for_each(|i| lost[i as usize] += 1.0);
    lost
}
