//! `fractum pack`: a shape in, a checked packing out.

use std::path::PathBuf;

use clap::Args;
use fractum::{ExitCode, Failure, say, tell};
use fractum_calibrate::{Micro, Sample, lab};
use fractum_output::atomic;
use fractum_pack::{Certificate, Convention, Packing, bond};

use super::shape::{ShapeArguments, choice};

/// Arguments of `fractum pack`.
#[derive(Args)]
pub(crate) struct PackArguments {
    #[command(flatten)]
    shape: ShapeArguments,
    /// Also bond neighbours to this coordination; the bonds are lines of the VTP file.
    #[arg(long)]
    coordination: Option<f64>,
    /// How the coordination is counted.
    #[arg(long, value_parser = choice::<Convention>(), default_value = "interior")]
    convention: Convention,
    /// Write a packing that misses its targets too, such as one in a part only a few particles thick.
    #[arg(long)]
    keep: bool,
    /// Folder for packing.vtp, packing.csv, packing.fpk and certificate.json.
    #[arg(short, long, default_value = "packing")]
    output: PathBuf,
}

/// Packs, measures, refuses what misses its targets, and writes.
pub(crate) fn run(arguments: &PackArguments) -> Result<ExitCode, Failure> {
    let wrong = |error: &dyn std::fmt::Display| Failure::input(error.to_string());
    let packing = if arguments.keep { arguments.shape.packing()? } else { arguments.shape.certified_packing()? };
    let mut certificate = Certificate::of(&packing);
    certificate.elastic_isotropy = elastic_isotropy(&packing).map_err(|error| wrong(&error))?;
    show(&certificate);
    match certificate.check() {
        Err(error) if arguments.keep => tell!("kept although {error}"),
        Err(error) => return Err(Failure::input(format!("{error}; --keep writes it all the same"))),
        Ok(()) => {}
    }
    let bonds = match arguments.coordination {
        Some(asked) => {
            let network = bond(&packing, asked, arguments.convention).map_err(|error| wrong(&error))?;
            say!(
                "{} bonds up to {:.4} times the touching distance: coordination {:.3} (all), {:.3} (interior)",
                network.pairs.len(),
                network.factor,
                network.coordination_all,
                network.coordination_interior
            );
            network.pairs
        }
        None => Vec::new(),
    };
    let folder = &arguments.output;
    atomic::create_folder(folder)?;
    atomic::write(&folder.join("packing.fpk"), &packing.to_bytes())?;
    atomic::write_with(&folder.join("packing.csv"), |out| packing.write_csv(out))?;
    atomic::write_with(&folder.join("packing.vtp"), |out| packing.write_vtp(&bonds, out))?;
    let json = serde_json::to_string_pretty(&certificate).unwrap_or_default();
    atomic::write(&folder.join("certificate.json"), json.as_bytes())?;
    say!("packing in {}", folder.display());
    Ok(ExitCode::Done)
}

/// E along x, y, z over their mean, of a box bonded to coordination 8 with beams of half the mean radius.
fn elastic_isotropy(packing: &Packing) -> Result<Option<[f64; 3]>, fractum_calibrate::CalibrateError> {
    if !matches!(packing.domain, fractum_pack::Domain::Box { .. }) {
        return Ok(None);
    }
    let mut sample = Sample::new(packing.clone(), 8.0, Convention::Interior)?;
    sample.set_micro(Micro { radius_ratio: 0.5, young_modulus: 1.0 })?;
    let mut young = [0.0; 3];
    for (axis, value) in young.iter_mut().enumerate() {
        *value = lab::tension(&sample, axis, None, Default::default())?.0.young_modulus;
    }
    let mean = young.iter().sum::<f64>() / 3.0;
    Ok(Some(young.map(|e| e / mean)))
}

fn show(c: &Certificate) {
    say!(
        "particles            {}, mean radius {:.4e} m, dispersion {:.3}, seed {}",
        c.particles,
        c.mean_radius,
        c.dispersion,
        c.seed
    );
    let core = c.fraction_core.map_or("no core".into(), |f| format!("{f:.4} core"));
    say!("volume fraction      {:.4} box, {core}", c.fraction_box);
    say!(
        "contacts             {:.3} all, {:.3} interior; {:.1} % rattlers",
        c.contacts.coordination_all,
        c.contacts.coordination_interior,
        100.0 * c.contacts.rattlers
    );
    say!(
        "overlap / radius     {:.1e} mean, {:.1e} largest ({:.1e} mean before the walls were released)",
        c.overlap.mean,
        c.overlap.max,
        c.overlap.compacted
    );
    let i = &c.isotropy;
    say!(
        "contact isotropy     {:.4} against {:.4} of random directions ({} contacts); mean square as printed in the book {:.2e}",
        i.deviation,
        i.shot_noise,
        i.contacts,
        i.mean_square
    );
    if let Some([x, y, z]) = c.elastic_isotropy {
        say!("elastic isotropy     E/mean {x:.4} {y:.4} {z:.4} along x, y, z");
    }
    let walls: Vec<String> = c.walls.iter().map(|(name, n)| format!("{name} {n}")).collect();
    say!("wall sets            {}", walls.join(", "));
}
