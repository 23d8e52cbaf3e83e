//! Interfaces between elements as faces for ParaView.

use fractum_math::Vec3;
use fractum_scene::{FaceReading, Gas, GasCell, GasRoom, InterfaceFace, LiquidReading, Scene, liquid_of};
use fractum_vtk::{Compression, Field, PendingFile, PolyCells, PolyData};

use crate::OutputError;

/// The faces of interfaces beside elements that are left, without load and with the mean displacement of both sides: opening, slip, tractions, the share of
/// the strength that is left, and the number of the interface; with liquid its pressure, the aperture and the part that is filled; with gas its pressure,
/// temperature and opening.
///
/// # Errors
/// Arrays that do not fit together.
pub(crate) fn file(scene: &Scene) -> Result<PendingFile, OutputError> {
    let (solid, interfaces) = (&scene.solid, scene.interfaces());
    let readings = (0..interfaces.faces().len()).map(|face| (face, interfaces.reading(face)));
    let readings: Vec<(usize, FaceReading)> = readings.filter(|(_, is)| is.area > 0.0).collect();
    let faces: Vec<(&InterfaceFace, FaceReading)> =
        readings.iter().map(|&(face, is)| (&interfaces.faces()[face], is)).collect();
    let plane = faces.iter().all(|(face, _)| face.corners() == 2);
    // Corners of faces stand for themselves: both sides may open differently on either side of an edge.
    let (mut points, mut displacement) = (Vec::new(), Vec::new());
    for (face, _) in &faces {
        for corner in 0..face.corners() {
            let [a, b] = face.sides.map(|side| side[corner] as usize);
            points.push(<[f64; 3]>::from(solid.reference[a]));
            let mean = (solid.displacement_from_start(a) + solid.displacement_from_start(b)) * 0.5;
            displacement.push(<[f64; 3]>::from(mean));
        }
    }
    let lines: Vec<[u32; 2]> = (0..faces.len() as u32).map(|face| [2 * face, 2 * face + 1]).collect();
    let triangles: Vec<[u32; 3]> = (0..faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let cells = if plane { PolyCells::Lines(&lines) } else { PolyCells::Triangles(&triangles) };
    let column = |of: fn(&FaceReading) -> f64| faces.iter().map(|(_, is)| of(is)).collect::<Vec<f64>>();
    let (opening, residual) = (column(|is| is.opening), column(|is| is.residual));
    let (normal, shear) = (column(|is| is.normal_traction), column(|is| is.shear_traction));
    let slip: Vec<[f64; 3]> = faces.iter().map(|(_, is)| <[f64; 3]>::from(is.slip as Vec3)).collect();
    let kinds: Vec<i32> = faces.iter().map(|(face, _)| face.kind as i32).collect();
    let liquid = |face: usize| liquid_of(scene).and_then(|liquid| liquid.reading(interfaces, face)).unwrap_or_default();
    let wet: Vec<LiquidReading> = readings.iter().map(|(face, _)| liquid(*face)).collect();
    let of_liquid = [
        ("liquid_pressure", (|is| is.pressure) as fn(&LiquidReading) -> f64),
        ("aperture", |is| is.aperture),
        ("filled", |is| is.filled),
    ];
    let of_liquid = of_liquid.map(|(name, of)| (name, wet.iter().map(of).collect::<Vec<f64>>()));
    let mut cell_data = vec![
        Field::scalar("opening", &opening),
        Field::vector("slip", &slip),
        Field::scalar("normal_traction", &normal),
        Field::scalar("shear_traction", &shear),
        Field::scalar("strength_left", &residual),
        Field::integer("interface", &kinds),
    ];
    if liquid_of(scene).is_some() {
        cell_data.extend(of_liquid.iter().map(|(name, values)| Field::scalar(name, values)));
    }
    let of_gas: Vec<GasCell> =
        scene.gas().into_iter().flat_map(Gas::cells).filter(|cell| matches!(cell.room, GasRoom::Face(_))).collect();
    let of_gas = [
        ("gas_pressure", (|cell| cell.pressure) as fn(&GasCell) -> f64),
        ("gas_temperature", |cell| cell.temperature),
        ("gas_opening", |cell| cell.opening),
    ]
    .map(|(name, of)| (name, readings.iter().filter_map(|&(face, _)| of_gas.get(face).map(of)).collect::<Vec<f64>>()));
    cell_data.extend(
        of_gas.iter().filter(|(_, values)| !values.is_empty()).map(|(name, values)| Field::scalar(name, values)),
    );
    let point_data = [Field::vector("displacement", &displacement)];
    let time = Some(scene.clock.time);
    let data = PolyData { points: &points, cells, point_data: &point_data, cell_data: &cell_data, time };
    data.pending(Compression::Fast).map_err(OutputError::from)
}
