//! The strip over time of the report.

use std::path::Path;

use fractum_io::number::quantity;
use fractum_io::picture::ColourMap;

use crate::frame_pictures::Frames;
use crate::report::PictureNote;

/// Width and height of the pictures of the strip [pixels].
const STRIP: [usize; 2] = [460, 390];
/// Pictures of the strip, with that at the peak.
const IN_STRIP: usize = 5;

/// The body at some instants and at the peak of its load, from the frames in the folder of a finished run; none where there is
/// one frame only, or none can be drawn.
///
/// - `peak`: when the load was largest [s]
pub(crate) fn strip(folder: &Path, peak: Option<f64>) -> Vec<PictureNote> {
    let Ok(frames) = Frames::open(folder) else { return Vec::new() };
    let last = frames.len() - 1;
    if last == 0 {
        return Vec::new();
    }
    let distance = |time: f64, index: &usize| (frames.times[*index] - time).abs();
    let at_peak = peak.and_then(|time| (0..=last).min_by(|a, b| distance(time, a).total_cmp(&distance(time, b))));
    let mut wanted: Vec<usize> = (1..IN_STRIP).map(|k| k * last / (IN_STRIP - 1)).chain(at_peak).collect();
    wanted.sort_unstable();
    wanted.dedup();
    let (label, unit) = frames.label();
    let scale = frames.magnification();
    let magnified = if scale > 1.0 { format!(", displacements x {scale:.0}") } else { String::new() };
    let note = |index: usize| {
        let file = format!("strip-{index:05}.png");
        let image = frames.draw(index, STRIP[0], STRIP[1]).ok()?;
        image.write(&frames.folder().join("pictures").join(&file)).ok()?;
        let peak = if Some(index) == at_peak { " (nearest to the peak)" } else { "" };
        Some(PictureNote {
            file,
            title: format!("{}{peak}{magnified}", quantity(frames.times[index], "s")),
            label: label.to_owned(),
            unit: unit.to_owned(),
            damage: frames.map() == ColourMap::Damage,
            range: frames.range,
            pixels_per_metre: None,
            axes: [[0.0; 2]; 3],
            size: STRIP,
            in_strip: true,
        })
    };
    wanted.into_iter().filter_map(note).collect()
}
