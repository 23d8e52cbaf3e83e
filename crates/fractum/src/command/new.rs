//! `fractum new`: the templates, or one of them in a folder.

use std::path::PathBuf;

use fractum::{ExitCode, Failure, for_shell, say, template};

/// Lists the templates, or writes one into a folder.
///
/// # Errors
/// As [`template::write`].
pub(crate) fn new(name: Option<&str>, folder: Option<PathBuf>) -> Result<ExitCode, Failure> {
    let Some(name) = name else {
        for (name, what) in template::all() {
            say!("{name:<12} {what}");
        }
        say!(
            "\nfractum new NAME [FOLDER] writes case.toml with its mesh, part.msh, and the Gmsh geometry of another one, part.geo"
        );
        return Ok(ExitCode::Done);
    };
    let written = template::write(name, folder, false)?;
    let folder = written.case.parent().unwrap_or(&written.case);
    say!("{}: {}", folder.display(), written.what);
    let (command, file) = written.study.map_or(("run", written.case.clone()), |study| ("study", study));
    say!("next: fractum {command} {}", for_shell(&file.display().to_string()));
    Ok(ExitCode::Done)
}
