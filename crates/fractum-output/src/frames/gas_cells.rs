//! The gas in cracks as cells for ParaView.

use fractum_scene::{Gas, GasCell, Scene};
use fractum_vtk::{CellBlock, CellKind, Compression, Field, PendingFile, UnstructuredGrid};

use crate::OutputError;

/// The file of the removed elements that gas has reached, without load and with their displacement: pressure, temperature and
/// density of the gas, and the opening of the crack.
///
/// # Errors
/// Arrays that do not fit together.
pub(crate) fn file(scene: &Scene, gas: &Gas) -> Result<PendingFile, OutputError> {
    let solid = &scene.solid;
    let of_crack = |cell: GasCell| cell.element().map(|(body, element)| (body, element, cell));
    let cells: Vec<(usize, u32, GasCell)> = gas.cells().filter_map(of_crack).collect();
    let corners = |body: usize| solid.body(body).shape.node_count();
    let of_element = |body: usize, element: u32| &solid.body(body).elements[element as usize][..corners(body)];
    let mut nodes: Vec<u32> = cells.iter().flat_map(|&(body, element, _)| of_element(body, element)).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |node: &u32| nodes.binary_search(node).map_or(0, |place| place as u32);
    let kind = if solid.is_plane() { CellKind::Triangle } else { CellKind::Tetrahedron };
    let connected: Vec<u32> =
        cells.iter().flat_map(|&(body, element, _)| of_element(body, element)).map(place).collect();
    let points: Vec<[f64; 3]> = nodes.iter().map(|&n| solid.reference[n as usize].into()).collect();
    let displacement: Vec<[f64; 3]> = nodes.iter().map(|&n| solid.displacement_from_start(n as usize).into()).collect();
    let column = |of: fn(&GasCell) -> f64| cells.iter().map(|(_, _, cell)| of(cell)).collect::<Vec<f64>>();
    let (pressure, temperature) = (column(|cell| cell.pressure), column(|cell| cell.temperature));
    let (density, opening) = (column(|cell| cell.amount.mass / cell.volume), column(|cell| cell.opening));
    let bodies: Vec<i32> = cells.iter().map(|&(body, ..)| body as i32).collect();
    let grid = UnstructuredGrid {
        points: &points,
        cells: &[CellBlock { kind, nodes: &connected }],
        point_data: &[Field::vector("displacement", &displacement)],
        cell_data: &[
            Field::scalar("pressure", &pressure),
            Field::scalar("temperature", &temperature),
            Field::scalar("density", &density),
            Field::scalar("opening", &opening),
            Field::integer("body", &bodies),
        ],
        time: Some(scene.clock.time),
    };
    grid.pending(Compression::Fast).map_err(OutputError::from)
}
