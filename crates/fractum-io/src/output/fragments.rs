//! `fragments.csv`: the pieces that a body broke into, one line each.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atomic;
use crate::error::WriteError;
use crate::number::push_shortest;

/// One connected piece.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fragment {
    /// Number of the piece; the caller chooses the order (largest first reads best).
    pub id: u64,
    /// Mass [kg].
    pub mass: f64,
    /// Volume [m³].
    pub volume: f64,
    /// Nodes (or particles) in it.
    pub nodes: u64,
    /// Elements in it; 0 for a lone particle.
    pub elements: u64,
    /// Centre of mass [m].
    pub centroid: [f64; 3],
    /// Velocity of the centre of mass [m/s].
    pub velocity: [f64; 3],
    /// Largest distance across the piece [m].
    pub largest_extent: f64,
    /// Diameter of the sphere of its volume, in the plane of the circle of its area [m].
    pub size: f64,
}

/// Writes `fragments` to `path` (usually `fragments.csv`), in the order given.
///
/// # Errors
/// [`WriteError`].
pub fn write(path: &Path, fragments: &[Fragment]) -> Result<(), WriteError> {
    atomic::write(path, table(fragments).as_bytes())
}

fn table(fragments: &[Fragment]) -> String {
    let mut text = String::from(
        "id,mass [kg],volume [m^3],nodes,elements,x [m],y [m],z [m],\
         velocity_x [m/s],velocity_y [m/s],velocity_z [m/s],largest_extent [m],size [m]\n",
    );
    for fragment in fragments {
        let Fragment { id, mass, volume, nodes, elements, centroid, velocity, largest_extent, size } = fragment;
        text.push_str(&id.to_string());
        for value in [*mass, *volume] {
            text.push(',');
            push_shortest(&mut text, value);
        }
        text.push_str(&format!(",{nodes},{elements}"));
        for value in centroid.iter().chain(velocity).chain([largest_extent, size]) {
            text.push(',');
            push_shortest(&mut text, *value);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_has_the_columns_of_the_header() {
        let fragment = Fragment {
            id: 1,
            mass: 2.5,
            volume: 1e-3,
            nodes: 40,
            elements: 120,
            centroid: [0.0, 0.1, -0.2],
            velocity: [1.0, 2.0, 3.0],
            largest_extent: 0.25,
            size: 0.125,
        };
        let text = table(&[fragment]);
        let mut lines = text.lines();
        let columns = lines.next().unwrap().split(',').count();
        let line = lines.next().unwrap();
        assert_eq!(line, "1,2.5,0.001,40,120,0,0.1,-0.2,1,2,3,0.25,0.125");
        assert_eq!(line.split(',').count(), columns);
        assert_eq!(lines.next(), None);
    }
}
