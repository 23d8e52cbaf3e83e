//! `fragments.csv`: the pieces that a body broke into, one line each.

use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atomic;
use crate::error::{ReadError, WriteError};
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
    /// Whether an absorbing or elastic boundary holds it, so that it counts for no size distribution.
    pub stays: bool,
}

/// Writes `fragments` to `path` (usually `fragments.csv`), in the order given.
///
/// # Errors
/// [`WriteError`].
pub fn write(path: &Path, fragments: &[Fragment]) -> Result<(), WriteError> {
    atomic::write(path, to_csv(fragments).as_bytes())
}

/// Reads the pieces back.
///
/// # Errors
/// [`ReadError`] with the line that is not as [`write`] writes it.
pub fn read(path: &Path) -> Result<Vec<Fragment>, ReadError> {
    let text = fs::read_to_string(path).map_err(|source| ReadError::Refused { path: path.to_path_buf(), source })?;
    parse(&text).map_err(|(line, expected)| {
        let found = text.lines().nth(line - 1).unwrap_or("the end of the file").to_owned();
        ReadError::Malformed { path: path.to_path_buf(), line, found, expected }
    })
}

/// The pieces; or the line that is wrong, from 1, and what it should be.
fn parse(text: &str) -> Result<Vec<Fragment>, (usize, String)> {
    let mut lines = text.lines();
    if lines.next() != Some(HEADER) {
        return Err((1, HEADER.to_owned()));
    }
    let fragment = |(index, line): (usize, &str)| {
        let wrong = |_| (index + 2, "14 numbers".to_owned());
        let cells: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().map_err(wrong)?;
        let [id, mass, volume, nodes, elements, x, y, z, vx, vy, vz, largest_extent, size, stays] = cells[..] else {
            return Err((index + 2, "14 numbers".to_owned()));
        };
        let [id, nodes, elements] = [id, nodes, elements].map(|count| count as u64);
        let (centroid, velocity) = ([x, y, z], [vx, vy, vz]);
        let stays = stays != 0.0;
        Ok(Fragment { id, mass, volume, nodes, elements, centroid, velocity, largest_extent, size, stays })
    };
    lines.enumerate().map(fragment).collect()
}

const HEADER: &str = "id,mass [kg],volume [m^3],nodes,elements,x [m],y [m],z [m],\
     velocity_x [m/s],velocity_y [m/s],velocity_z [m/s],largest_extent [m],size [m],stays";

/// The text of `fragments.csv`, in the order given.
pub fn to_csv(fragments: &[Fragment]) -> String {
    let mut text = format!("{HEADER}\n");
    for fragment in fragments {
        let Fragment { id, mass, volume, nodes, elements, centroid, velocity, largest_extent, size, stays } = fragment;
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
        text.push_str(if *stays { ",1\n" } else { ",0\n" });
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
            stays: true,
        };
        let text = to_csv(std::slice::from_ref(&fragment));
        assert_eq!(parse(&text).unwrap(), [fragment]);
        assert_eq!(parse("id\n").unwrap_err().0, 1);
        assert_eq!(parse(&text.replace("2.5", "two")).unwrap_err().0, 2);
        assert_eq!(parse(&text.replace("0.25,", "")).unwrap_err().0, 2);
        let mut lines = text.lines();
        let columns = lines.next().unwrap().split(',').count();
        let line = lines.next().unwrap();
        assert_eq!(line, "1,2.5,0.001,40,120,0,0.1,-0.2,1,2,3,0.25,0.125,1");
        assert_eq!(line.split(',').count(), columns);
        assert_eq!(lines.next(), None);
    }
}
