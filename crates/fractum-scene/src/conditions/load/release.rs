use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

/// Forces of bodies that have left on the nodes that stay; they fade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Release {
    /// Nodes, and what acted on each [N].
    pub(crate) forces: Vec<(u32, Vec3)>,
    /// From when to when they fade [s].
    pub(crate) time: [f64; 2],
    /// Part of them that acts then.
    pub(crate) part: [f64; 2],
    /// Whether they fade as a smooth step 3 s² − 2 s³, and not as s, the part of the time that has passed.
    pub(crate) is_smooth: bool,
}

impl Release {
    /// Part of the forces that acts at a time.
    pub(crate) fn part_at(&self, time: f64) -> f64 {
        let ([begin, end], [first, last]) = (self.time, self.part);
        if time >= end {
            return last;
        }
        let passed = ((time - begin) / (end - begin)).max(0.0);
        let passed = if self.is_smooth { passed * passed * (3.0 - 2.0 * passed) } else { passed };
        first + (last - first) * passed
    }

    pub(super) fn apply(&self, time: f64, forces: &mut Vec<(u32, Vec3)>) {
        let part = self.part_at(time);
        if part != 0.0 {
            forces.extend(self.forces.iter().map(|&(node, force)| (node, force * part)));
        }
    }

    /// Goes on from the part that acts at the first of two times to none at the second.
    pub(super) fn go_on(&mut self, time: [f64; 2], is_smooth: bool) {
        self.part = [self.part_at(time[0]), 0.0];
        (self.time, self.is_smooth) = (time, is_smooth);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_fade_in_two_stages() {
        let mut release = Release { forces: Vec::new(), time: [1.0, 3.0], part: [1.0, 0.6], is_smooth: false };
        assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|time| release.part_at(time)), [1.0, 1.0, 0.8, 0.6, 0.6]);
        release.go_on([5.0, 7.0], true);
        assert_eq!([5.0, 6.0, 7.0].map(|time| release.part_at(time)), [0.6, 0.3, 0.0]);
        // At once.
        release.go_on([8.0, 8.0], true);
        assert_eq!(release.part_at(8.0), 0.0);
    }
}
