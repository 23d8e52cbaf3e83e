//! What is looked at in a scene: probes, gauges, stations of peak velocity, and whether its theory is still valid.

pub(crate) mod audit;
pub(crate) mod counts;
pub(crate) mod crack_extent;
pub(crate) mod crack_measure;
pub(crate) mod damaged;
pub(crate) mod gauges;
pub(crate) mod indentation;
mod momentum;
pub(crate) mod piece_probe;
pub(crate) mod points;
pub(crate) mod probe;
pub(crate) mod radial_cracks;
pub(crate) mod region_probe;
pub(crate) mod velocity_station;
