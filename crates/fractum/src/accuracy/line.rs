//! A pass whose crack runs along a line of its mesh: the ridge of the damage that passes before it have left, as an interface with the strength of the material.
//!
//! Damage is spread over elements whose rows the crack has to cross, which makes loads too high by more than the size of the elements; faces along the line have
//! no such excess. A line beside the true path still gives a load that is too high: twice as far beside it, by four times as much.

use std::fs;

use fractum_case::model::CRACK_LINE;
use fractum_mesh::{Mesh, RefineOptions, Ridge, Spot, read_mesh, refined, ridge};
use fractum_output::number::percent;

use super::zone::Zone;
use super::{FIRST, Kind, MESH, Passes, SIZE_OF_EDGE};
use crate::error::Failure;
use crate::kept::is_of_case;
use crate::simulation::Damaged;
use crate::tell;

/// The load along a line over the mean of passes with damage, above which the line is wrong: those are too high by more, and scatter.
const ABOVE: f64 = 1.03;

/// How much wider the zone of fine elements beside a line is than that around damage: the body is bent there, and the elements are coarse otherwise.
const BESIDE: f64 = 2.0;

/// Passes whose damage tells of the line have elements at most this much larger than the last one.
const LIKE: f64 = 2.5;

impl Passes<'_> {
    /// Adds a pass along the line of the crack, if the case may have one and the last pass tells where it runs.
    ///
    /// # Errors
    /// What cannot be read or written.
    pub(super) fn add_line(&mut self, base: &Mesh) -> Result<(), Failure> {
        let last = self.done.len() - 1;
        let (pass, summary, _) = &self.done[last];
        let Some(peak) = summary.probes.get(&self.load.0).map(|probe| probe.time_of_max) else { return Ok(()) };
        let is_known = self.case.line_law().is_some() && base.is_plane();
        if !is_known || last == 0 || !pass.left_out.is_empty() || peak <= 0.0 {
            return Ok(());
        }
        let size = pass.size.min(FIRST * self.length());
        let found = match self.line_mesh(base, size) {
            Ok(mesh) => mesh,
            Err(why) => {
                self.tell_no_line(&why);
                return Ok(());
            }
        };
        let (file, name) = self.write_mesh(found, "line")?;
        match self.add(&name, Some(&file), Kind::Line { peak, size }) {
            Err(failure) if is_of_case(&failure) => self.tell_no_line(&failure.to_string()),
            Err(failure) => return Err(failure),
            Ok(()) => self.tell_last(),
        }
        Ok(())
    }

    fn tell_no_line(&self, why: &str) {
        if !self.options.quiet {
            tell!("no pass along the line of the crack: {why}");
        }
    }

    /// The mesh whose edges follow the crack of the last passes, fine beside it; or why there is none.
    fn line_mesh(&self, base: &Mesh, size: f64) -> Result<Mesh, String> {
        let Ridge { line, .. } = self.ridge(base)?;
        let seed = self.done.len() as u64;
        let zone = Zone::around(std::iter::once(&along(&line, BESIDE * size)));
        let wanted = |at| if zone.contains(at) { size / SIZE_OF_EDGE } else { f64::INFINITY };
        let options = RefineOptions { seed: &|_| Some(seed), most: self.most_elements(base) };
        let mut mesh = refined(base, &wanted, options).map_err(|error| error.to_string())?.mesh;
        mesh.follow(&line, CRACK_LINE).map_err(|error| error.to_string())?;
        Ok(mesh)
    }

    /// The ridge of the damage of all passes like the last one.
    fn ridge(&self, base: &Mesh) -> Result<Ridge, String> {
        let counted = || self.done.iter().skip(1).filter(|(pass, ..)| !pass.line && pass.left_out.is_empty());
        let (last, ..) = counted().next_back().ok_or("no pass has seen the crack")?;
        let like = counted().filter(|(pass, ..)| pass.size < LIKE * last.size);
        let spots: Vec<Spot> = like.flat_map(|(_, _, damaged)| damaged.elements.iter().map(spot)).collect();
        let file = self.folder.join(&last.name).join(MESH);
        let bytes = fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let mut mesh = read_mesh(&bytes).map_err(|error| format!("{}: {error:?}", file.display()))?;
        let scale = self.scale();
        mesh.nodes.iter_mut().for_each(|node| *node *= scale);
        debug_assert_eq!(mesh.is_plane(), base.is_plane());
        ridge(&mesh, &spots).map_err(|error| error.to_string())
    }

    /// Why the peak of a pass along a line does not count.
    pub(super) fn wrong_line(&self, peak: f64) -> String {
        let loads: Vec<f64> = self.counted(false).filter_map(|pass| pass.peaks.get(&self.load.0)).copied().collect();
        let share = peak.abs() / (loads.iter().sum::<f64>() / loads.len() as f64).abs();
        match share > ABOVE {
            true => format!("{} above passes with damage: the crack runs elsewhere", percent(share - 1.0)),
            false => String::new(),
        }
    }
}

/// Places along a line as elements of that size.
fn along(line: &[[f64; 2]], size: f64) -> Damaged {
    let mut elements = Vec::new();
    for pair in line.windows(2) {
        let [dx, dy] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
        let count = ((dx * dx + dy * dy).sqrt() / size).ceil().max(1.0) as usize;
        elements.extend((0..=count).map(|step| {
            let share = step as f64 / count as f64;
            [pair[0][0] + share * dx, pair[0][1] + share * dy, 0.0, size, 1.0]
        }));
    }
    Damaged { length: f64::INFINITY, elements }
}

fn spot(&[x, y, _, size, damage]: &[f64; 5]) -> Spot {
    Spot { at: [x, y], size, damage }
}
