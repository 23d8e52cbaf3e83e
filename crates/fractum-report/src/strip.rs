//! The strip over time of the report.

use std::path::Path;

use fractum_output::atomic::Group;
use fractum_output::notes::{PictureNote, STRIP_FILE};

use crate::movie::{FrameIndex, Frames};
use crate::picture::ColourMap;
use crate::sight::{HEIGHT, magnified};

/// Width and largest height of the pictures of the strip [pixels].
const STRIP: [usize; 2] = [368, 312];
/// Pictures of the strip, with that at the peak.
const IN_STRIP: usize = 5;

/// Pixels of the strip of a run with that many frames.
pub fn expected_pixels(frames: f64) -> f64 {
    frames.min(IN_STRIP as f64) * (STRIP[0] * STRIP[1]) as f64
}

/// The body at some instants and at the peak of its load, from the frames in the folder of a run; none where there is one frame
/// only, or none can be drawn.
///
/// - `peak`: when the load was largest [s]
/// - `instant`: an instant in words
/// - `files`: takes the pictures
pub fn strip(
    folder: &Path,
    peak: Option<f64>,
    instant_text: &dyn Fn(f64) -> String,
    files: &mut Group,
) -> Vec<PictureNote> {
    let Some(index) = FrameIndex::open(folder).ok().filter(|index| index.len() > 1) else { return Vec::new() };
    let last = index.len() - 1;
    let times: Vec<f64> = (0..=last).map(|instant| index.time(instant)).collect();
    let distance = |time: f64, instant: &usize| (times[*instant] - time).abs();
    let at_peak = peak.and_then(|time| (0..=last).min_by(|a, b| distance(time, a).total_cmp(&distance(time, b))));
    let mut wanted: Vec<usize> = (1..IN_STRIP).map(|k| k * last / (IN_STRIP - 1)).chain(at_peak).collect();
    wanted.sort_unstable();
    wanted.dedup();
    let Ok(frames) = Frames::survey(index, &wanted) else { return Vec::new() };
    let (label, unit) = frames.label();
    let size = [STRIP[0], STRIP[1] * frames.view.height / HEIGHT];
    let note = |instant: usize| {
        let file = format!("{STRIP_FILE}{instant:05}.png");
        let image = frames.draw(instant, 1.0, size[0], size[1]).ok()?;
        files.add(&folder.join("pictures").join(&file), &image.to_png().ok()?);
        let peak = if Some(instant) == at_peak { " (nearest to the peak)" } else { "" };
        Some(PictureNote {
            file,
            title: format!("{}{peak}", instant_text(times[instant])),
            magnified: magnified(frames.scale),
            label: label.to_owned(),
            unit: unit.to_owned(),
            damage: frames.map() == ColourMap::Damage,
            range: frames.range,
            size,
            in_strip: true,
            ..PictureNote::default()
        })
    };
    wanted.into_iter().filter_map(note).collect()
}
