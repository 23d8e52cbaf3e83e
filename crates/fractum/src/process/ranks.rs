//! The ranks that run one case together: the first one writes results and speaks, all of them decide alike.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use fractum_case::model::{BodyKind, BondLawKind, Case, Output, Probe, ProbeKind, SolverKind};
use fractum_case::{Diagnostic, Diagnostics, Place, read_case};
use fractum_dem::ParticleSubdomainSize;
use fractum_fem::neighbours::{self, SubdomainSize};
use fractum_output::number::grouped;
use fractum_parallel::{Exchange, gather};
use fractum_scene::{Scene, Watched, ranks};
use fractum_vtk::Cut;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{ExitCode, Failure};
use crate::process::last_words::LastWords;

/// Processes that run a case together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Processes {
    /// All of them: they share the cells of solids.
    pub(crate) all: usize,
    /// Those on this machine: they share its memory.
    pub(crate) here: usize,
    /// Number of this one, from 0.
    pub(crate) rank: usize,
}

impl Processes {
    /// The same as far as memory goes, each of which does all by itself.
    pub(crate) fn alike(self) -> Self {
        Processes { all: 1, rank: 0, ..self }
    }

    /// Which of some items this process takes: each takes some that follow each other.
    pub(crate) fn own(self, items: usize) -> Range<usize> {
        items * self.rank / self.all..items * (self.rank + 1) / self.all
    }
}

impl Default for Processes {
    /// One by itself.
    fn default() -> Self {
        Processes { all: 1, here: 1, rank: 0 }
    }
}

/// This process among those that run a case together, or alone.
#[derive(Debug, Default)]
pub struct Ranks {
    exchange: Option<Arc<dyn Exchange>>,
    processes: Processes,
    /// Where a rank that does not write keeps what others write; removed with it.
    scratch: Option<PathBuf>,
}

/// Ranks of this process so far, for names of their own.
static STARTED: AtomicUsize = AtomicUsize::new(0);

impl Ranks {
    /// One process by itself.
    pub fn alone() -> Self {
        Ranks::default()
    }

    /// One of those that an exchange joins; alone if there is no other.
    pub fn new(exchange: Arc<dyn Exchange>) -> Self {
        if exchange.size() == 1 {
            return Ranks::alone();
        }
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let name = format!("fractum-rank-{}-{}-{number}", exchange.rank(), std::process::id());
        let scratch = (exchange.rank() > 0).then(|| std::env::temp_dir().join(name));
        let machines = gather(&*exchange, &exchange.machine());
        let here = machines.iter().filter(|machine| **machine == machines[exchange.rank()]).count();
        let processes = Processes { all: exchange.size(), here, rank: exchange.rank() };
        Ranks { exchange: Some(exchange), processes, scratch }
    }

    /// How many there are.
    pub(crate) fn processes(&self) -> Processes {
        self.processes
    }

    /// Number of this one, from 0.
    pub(crate) fn rank(&self) -> usize {
        self.exchange.as_ref().map_or(0, |exchange| exchange.rank())
    }

    pub(crate) fn exchange(&self) -> Option<&Arc<dyn Exchange>> {
        self.exchange.as_ref()
    }

    /// Whether this process writes the results.
    pub fn leads(&self) -> bool {
        self.scratch.is_none()
    }

    /// Speaks where a signal ends several processes with a state that is older than their last step.
    ///
    /// - `command`: the one that goes on
    pub(crate) fn last_words(&self, results: &Path, command: impl FnOnce() -> String) -> Option<LastWords> {
        self.exchange.as_ref().map(|_| LastWords::new(results, command(), self.leads()))
    }

    /// Folder into which this process writes.
    pub(crate) fn folder(&self, results: &Path) -> PathBuf {
        self.scratch.as_deref().unwrap_or(results).to_owned()
    }

    /// Which pieces of a frame this process writes.
    ///
    /// - `is_divided`: whether it has no other elements than those of its own piece
    pub(crate) fn cut(&self, output: &Output, is_divided: bool) -> Cut {
        let [first, step] = self.exchange.as_ref().map_or([0, 1], |exchange| [exchange.rank(), exchange.size()]);
        Cut { count: if is_divided { step } else { output.frame_pieces }, first, step, is_divided }
    }

    /// What all processes have, that of this one among it.
    pub(crate) fn gather<T: Serialize + DeserializeOwned>(&self, own: T) -> Vec<T> {
        match &self.exchange {
            Some(exchange) => gather(&**exchange, &own),
            None => vec![own],
        }
    }

    /// The wishes that any process has.
    pub(crate) fn any(&self, wishes: [bool; 2]) -> [bool; 2] {
        let Some(exchange) = &self.exchange else { return wishes };
        let bits = exchange.any(u64::from(wishes[0]) | u64::from(wishes[1]) << 1);
        [bits & 1 != 0, bits & 2 != 0]
    }

    /// What all processes have done, or the failure that ends them all: that of the first that has one.
    ///
    /// # Errors
    /// [`Failure::Elsewhere`] where it is not that of this process.
    pub(crate) fn together<T>(&self, done: Result<T, Failure>) -> Result<T, Failure> {
        let Some(exchange) = &self.exchange else { return done };
        let code = done.as_ref().err().map_or(0, |failure| failure.exit_code() as u64);
        let mut codes = vec![0.0; exchange.size()];
        exchange.gather(&[code as f64], &vec![1; exchange.size()], &mut codes);
        match (codes.iter().position(|&code| code != 0.0), done) {
            (None, done) => done,
            (Some(first), Err(failure)) if first == exchange.rank() => Err(failure),
            (Some(first), _) => Err(Failure::Elsewhere(ExitCode::from_code(codes[first] as u64))),
        }
    }

    /// Refuses what several processes cannot do, before anything is made ready for it.
    ///
    /// # Errors
    /// [`Failure::Input`] with everything of the case that they cannot do.
    pub(crate) fn check(&self, path: &Path, overrides: &[(String, String)]) -> Result<(), Failure> {
        if self.exchange.is_none() {
            return Ok(());
        }
        let case = read_case(path, overrides)?;
        let found = std::iter::once(&case).chain(&case.later).flat_map(not_for_ranks);
        let error = |(place, what): (&Place, &str)| {
            Diagnostic::error(place, format!(": {what} cannot be run by several processes yet"))
                .remedy("run the case without mpirun, or with one process")
        };
        let errors: Vec<Diagnostic> = found.map(error).collect();
        if errors.is_empty() { Ok(()) } else { Err(Failure::Input(Diagnostics(errors))) }
    }

    /// Leaves each process its share of a scene.
    ///
    /// - `watched`: what is looked at after every step
    ///
    /// # Errors
    /// [`Failure::Input`] for a scene that cannot be shared.
    pub(crate) fn distribute(&self, scene: &mut Scene, watched: impl FnOnce(&Scene) -> Watched) -> Result<(), Failure> {
        let Some(exchange) = &self.exchange else { return Ok(()) };
        let refuse =
            |what| Failure::input(format!("{what} cannot be run by several processes yet; run without mpirun"));
        self.together(ranks::cannot_be_distributed(scene).map_or(Ok(()), |what| Err(refuse(what))))?;
        let watched = watched(scene);
        ranks::distribute(scene, Arc::clone(exchange), &watched);
        Ok(())
    }

    /// What this process does of the work, in words; nothing of a process by itself.
    pub(crate) fn share(&self, scene: &Scene) -> Vec<String> {
        let Some(exchange) = &self.exchange else { return Vec::new() };
        let number = |count: usize| grouped(&count.to_string());
        let process = format!("process {} of {}", exchange.rank(), exchange.size());
        let of_cells = |share: SubdomainSize| {
            let SubdomainSize { blocks, nodes, shared_nodes, bytes, memory, keeps_all } = share;
            format!(
                "{process}: {} blocks of cells, {} nodes, {} of them shared; {} bytes of forces sent per step; {} bytes of cells{}",
                number(blocks),
                number(nodes),
                number(shared_nodes),
                number(bytes),
                number(memory),
                if keeps_all { ", those of all processes: damage in the standard formulation needs them" } else { "" }
            )
        };
        let of_particles = |share: ParticleSubdomainSize| {
            let ParticleSubdomainSize { particles, ghosts, everywhere } = share;
            format!(
                "{process}: {} particles, and the motion of {} others; {} particles moved by every process",
                number(particles),
                number(ghosts),
                number(everywhere)
            )
        };
        let alike = ranks::keeps_particles_whole(scene).filter(|_| !scene.bonded.is_empty());
        let alike =
            alike.map(|what| format!("every process moves all particles and computes all bonds, because of {what}"));
        let cells = neighbours::subdomain_size(&scene.solid).filter(|_| scene.solid.body_count() > 0).map(of_cells);
        cells.into_iter().chain(scene.bonded.share().map(of_particles)).chain(alike).collect()
    }

    /// In how many steps all processes moved all nodes, in words; nothing of a process by itself.
    pub(crate) fn steps(&self, scene: &Scene) -> Option<String> {
        let of_solids = neighbours::steps(&scene.solid).filter(|_| scene.solid.body_count() > 0);
        let [whole, all] = of_solids?.map(|steps| grouped(&steps.to_string()));
        Some(format!("every process moved all nodes in {whole} of {all} steps"))
    }
}

impl Drop for Ranks {
    fn drop(&mut self) {
        if let Some(scratch) = &self.scratch {
            // What cannot be removed is left to the system, as all temporary files are.
            let _ = std::fs::remove_dir_all(scratch);
        }
    }
}

/// What several processes cannot do of a stage, and where it stands.
fn not_for_ranks(case: &Case) -> Vec<(&Place, &'static str)> {
    let mut found = Vec::new();
    if case.solver.kind != SolverKind::Explicit {
        found.push((&case.solver.place, "a solver that is not explicit"));
    }
    if !case.bodies.iter().any(|body| matches!(body.kind, BodyKind::Solid(_))) {
        found
            .extend(case.bodies.iter().filter_map(|body| Some((&body.name.place, undivided_bonds(case, &body.kind)?))));
    }
    found.extend(case.solver.subcycling.iter().map(|place| (place, "subcycling")));
    found.extend(case.solver.accuracy.iter().map(|asked| (&asked.share.place, "passes to an accuracy")));
    let clumps = case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Particles(loose) => loose.clump.as_ref(),
        _ => None,
    });
    found.extend(clumps.map(|clump| (&clump.place, "clumps of spheres")));
    found.extend(case.periodic.iter().map(|periodic| (&periodic.place, "a periodic box")));
    found.extend(case.flows.heat.iter().map(|heat| (&heat.place, "heat")));
    let of_particles = |probe: &&Probe| match &probe.kind {
        ProbeKind::Moment(moment) => case.particle_group(moment.on.group_name()).is_some(),
        _ => false,
    };
    let moments = case.probes.iter().filter(of_particles);
    found.extend(moments.map(|probe| (&probe.name.place, "a moment of supports on particles")));
    found
}

/// Bonds of a body that processes cannot divide, where no solid gives them cells to share.
fn undivided_bonds(case: &Case, kind: &BodyKind) -> Option<&'static str> {
    let BodyKind::Bonded(body) = kind else { return None };
    let damps = || case.materials[body.material].interfaces.as_ref().is_some_and(|of| of.value.law.damping_ratio > 0.0);
    match body.law {
        BondLawKind::LocalNonlocal => Some("bond = \"local-nonlocal\" without a solid, whose cells they would share,"),
        BondLawKind::Local if damps() => {
            Some("bond = \"local\" with damping, without a solid whose cells they would share,")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use fractum_parallel::threads;

    use super::*;

    /// Also beyond as many ranks as a word has bits.
    #[test]
    fn one_rank_tells_what_went_wrong_and_all_end_with_its_code() {
        let outcome = |exchange: Arc<dyn Exchange>| {
            let fails = [35, 70].contains(&exchange.rank());
            Ranks::new(exchange).together(if fails { Err(Failure::input("no mesh")) } else { Ok(()) })
        };
        let outcomes: Vec<_> = std::thread::scope(|scope| {
            let started: Vec<_> = threads(80).into_iter().map(|own| scope.spawn(move || outcome(own))).collect();
            started.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        for (rank, outcome) in outcomes.into_iter().enumerate() {
            let failure = outcome.unwrap_err();
            assert_eq!(matches!(failure, Failure::Elsewhere(_)), rank != 35, "{rank}: {failure}");
            assert_eq!(failure.exit_code() as u64, ExitCode::Input as u64);
        }
    }
}
