//! Stations at which the largest velocity is kept.

use fractum_dem::crack_shape::Axis;
use fractum_fem::Solid;
use fractum_math::Vec3;
use fractum_math::elementary::cbrt;
use fractum_scene::{StationPlace, VelocityStation};

use super::Context;
use super::bodies::Numbering;
use crate::model::{Ppv, Scaling, StationLine};

/// Stations of one table, by their distance from a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct PpvStations {
    /// Name of the table.
    pub name: String,
    /// What a distance is divided by: metres, or metres times the root of a mass.
    pub scale: f64,
    /// Unit of a scaled distance; `-` for radii of the hole.
    pub unit: &'static str,
    /// The stations, nearest first.
    pub stations: Vec<VelocityStation>,
}

impl Context<'_> {
    /// Stations of all tables of the case.
    pub(super) fn ppv_stations(&mut self, numbering: &Numbering, solid: &Solid) -> Vec<PpvStations> {
        let case = self.case;
        case.output.ppv.iter().filter_map(|ppv| self.stations(ppv, numbering, solid)).collect()
    }

    fn stations(&mut self, ppv: &Ppv, numbering: &Numbering, solid: &Solid) -> Option<PpvStations> {
        let wall = self.group_nodes(&ppv.hole, numbering);
        let place =
            |nodes: &[u32]| nodes.iter().map(|&node| solid.reference[node as usize]).sum::<Vec3>() / nodes.len() as f64;
        let centre = ppv.centre.unwrap_or_else(|| place(&wall));
        let axis = ppv.axis.or(solid.is_plane().then(Vec3::z));
        let distance = |place: &Vec3| match axis {
            Some(direction) => Axis { point: centre, direction }.cylindrical(*place).0,
            None => (place - centre).norm(),
        };
        let mut sets = ppv.line.as_ref().map_or_else(Vec::new, |line| nearest_nodes(solid, line));
        sets.extend(ppv.groups.iter().map(|group| self.group_nodes(group, numbering)));
        if wall.is_empty() || sets.iter().any(Vec::is_empty) {
            return None;
        }
        let station = |nodes: Vec<u32>| {
            let of = |node: u32| {
                let place = solid.reference[node as usize];
                StationPlace { node, place, distance: distance(&place) }
            };
            let mut places: Vec<StationPlace> = nodes.into_iter().map(of).collect();
            places.sort_by(|a, b| a.distance.total_cmp(&b.distance));
            VelocityStation { places }
        };
        let mut stations: Vec<VelocityStation> = sets.into_iter().map(station).collect();
        stations.sort_by(|a, b| a.places[0].distance.total_cmp(&b.places[0].distance));
        let radius =
            wall.iter().map(|&node| distance(&solid.reference[node as usize])).sum::<f64>() / wall.len() as f64;
        if stations.iter().any(|station| station.places[0].distance < 1e-6 * radius) || radius == 0.0 {
            let found = format!("= \"{}\": a station lies on the axis or centre of the hole", ppv.hole.value);
            self.error(&ppv.hole.place.clone(), found, "stations at a distance from it");
        }
        let (scale, unit) = match (ppv.charge, ppv.scaling) {
            (None, _) => (radius, "-"),
            (Some(charge), Scaling::SquareRoot) => (charge.sqrt(), "m/kg^(1/2)"),
            (Some(charge), Scaling::CubeRoot) => (cbrt(charge), "m/kg^(1/3)"),
        };
        Some(PpvStations { name: ppv.name.value.clone(), scale, unit, stations })
    }
}

/// The nodes of solids nearest to the stations of a line, each once.
fn nearest_nodes(solid: &Solid, line: &StationLine) -> Vec<Vec<u32>> {
    let last = line.stations.saturating_sub(1).max(1) as f64;
    let place = |station: u64| line.from + (line.to - line.from) * (station as f64 / last);
    let nearest = |place: Vec3| {
        let away = |node: &u32| (solid.reference[*node as usize] - place).norm_squared();
        (0..solid.reference.len() as u32).min_by(|a, b| away(a).total_cmp(&away(b)))
    };
    let mut nodes: Vec<u32> = (0..line.stations).filter_map(|station| nearest(place(station))).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes.into_iter().map(|node| vec![node]).collect()
}
