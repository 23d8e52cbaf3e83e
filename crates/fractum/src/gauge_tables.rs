//! Tables of gauges: displacement and strain at the places of a grid, at the instant of a frame.

use fractum_io::number::push_shortest;
use fractum_io::vtk::PendingFile;
use fractum_scene::{GaugeGrid, Scene};

/// Folder of the tables in the results folder.
pub(crate) const FOLDER: &str = "gauges";

const HEAD: &str = "time [s],x [m],y [m],z [m],points,ux [m],uy [m],uz [m],exx,eyy,ezz,exy,eyz,ezx\n";

/// The table of the present instant, a line per place.
pub(crate) fn file(scene: &Scene, grid: &GaugeGrid) -> PendingFile {
    let mut text = String::from(HEAD);
    for reading in grid.readings(scene) {
        push_shortest(&mut text, scene.clock.time);
        let points = [reading.points as f64];
        for value in reading.place.iter().chain(&points).chain(&reading.displacement).chain(&reading.strain) {
            text.push(',');
            push_shortest(&mut text, *value);
        }
        text.push('\n');
    }
    PendingFile::of_text(text)
}
