//! When a run at rest writes frames: by progress along its path, and at its peak.

use serde::{Deserialize, Serialize};

use crate::frames::Frame;

/// Energy dissipated between two frames, over the largest elastic energy or all that was dissipated so far.
const SHARE: f64 = 0.05;

/// How far a path of equilibria has come since its last frame, and the frame of its peak.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PathFrames {
    /// Frames begun.
    frames: u64,
    /// Progress since the last frame; 1 makes a frame.
    progress: f64,
    /// Load factor [s] and energy dissipated [J] by now.
    time: f64,
    spent: f64,
    most_elastic: f64,
    /// Largest load so far.
    peak: f64,
    /// Frame of the largest load, as long as no frame has shown it.
    unseen: Option<Box<Frame>>,
}

impl PathFrames {
    /// Frames begun so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Whether a frame is due; the first one is.
    pub fn frame_is_due(&self) -> bool {
        self.frames == 0 || self.progress >= 1.0 - 1e-9
    }

    /// Goes on by a step: progress is the way of the load factor, forth and back, over `every`, and the energy dissipated over
    /// its share.
    ///
    /// - `spent`, `elastic`: energy dissipated so far and elastic energy [J]
    /// - `every`: way of the load factor between two frames [s]
    pub fn advance(&mut self, time: f64, spent: f64, elastic: f64, every: f64) {
        self.most_elastic = self.most_elastic.max(elastic);
        self.progress += (time - self.time).abs() / every;
        let portion = SHARE * self.most_elastic.max(spent);
        if spent > self.spent && portion > 0.0 {
            self.progress += (spent - self.spent) / portion;
        }
        (self.time, self.spent) = (time, spent);
    }

    /// Whether this load is the largest so far.
    pub fn is_peak(&mut self, load: f64) -> bool {
        let higher = load > self.peak;
        if higher {
            self.peak = load;
            self.unseen = None;
        }
        higher
    }

    /// Keeps the frame of the largest load.
    pub fn keep_peak(&mut self, frame: Frame) {
        self.unseen = Some(Box::new(frame));
    }

    /// Takes the frame of the largest load, where no frame has shown it.
    pub fn unseen_peak(&mut self) -> Option<Frame> {
        self.unseen.take().map(|frame| *frame)
    }

    /// Another frame has been begun.
    pub fn begin_frame(&mut self) {
        (self.frames, self.progress) = (self.frames + 1, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of the steps with a frame, of a path with these load factors, dissipated and elastic energies.
    fn frames(path: &[[f64; 3]]) -> Vec<usize> {
        let mut frames = PathFrames::default();
        let due = |(step, &[time, spent, elastic]): (usize, &[f64; 3])| {
            frames.advance(time, spent, elastic, 0.1);
            let due = frames.frame_is_due();
            if due {
                frames.begin_frame();
            }
            due.then_some(step)
        };
        path.iter().enumerate().filter_map(due).collect()
    }

    #[test]
    fn a_path_without_damage_has_frames_at_equal_loads() {
        let path: Vec<[f64; 3]> = (0..=40).map(|i| [f64::from(i) / 40.0, 0.0, f64::from(i * i)]).collect();
        assert_eq!(frames(&path), (0..=10).map(|i| 4 * i).collect::<Vec<_>>());
    }

    #[test]
    fn snap_back_and_growth_at_one_load_have_frames() {
        // Up to 0.5, and back along the way by which it came.
        let back: Vec<[f64; 3]> = (0..=50).chain((0..50).rev()).map(|i| [f64::from(i) / 100.0, 0.0, 1.0]).collect();
        assert_eq!(frames(&back).len(), 11);
        // All elastic energy is dissipated while the load factor stands.
        let mut fall: Vec<[f64; 3]> = vec![[0.5, 0.0, 1.0]];
        fall.extend((1..=100).map(|i| [0.5, f64::from(i) / 100.0, 1.0]));
        assert_eq!(frames(&fall).len(), 21);
        // A long tail: equal shares of what has been dissipated, not of the elastic energy.
        let tail: Vec<[f64; 3]> = (0..=10_000).map(|i| [0.5, f64::from(i) / 100.0, 1.0]).collect();
        let expected = 20.0 + 20.0 * 100.0f64.ln();
        assert!((frames(&tail).len() as f64 / expected - 1.0).abs() < 0.1, "{}", frames(&tail).len());
    }
}
